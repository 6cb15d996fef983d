#include "reader/serve.h"

#include <malloc.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <new>
#include <thread>

#include "contained/messages.h"
#include "contained/picture_bytes.h"
#include "contained/sanitized.h"
#include "contained/scene_bytes.h"

// A crash ends the process by its signal, as it does without a sanitizer; nobody calls this then.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
    return "handle_segv=0:handle_abort=0:handle_sigbus=0:handle_sigfpe=0:handle_sigill=0:"
           "detect_leaks=0:allocator_may_return_null=1:abort_on_error=1";
}

namespace reader {
namespace {

using namespace prep::detail;

std::atomic<bool> memory_ran_out = false;

void out_of_memory() {
    memory_ran_out = true;
    throw std::bad_alloc();
}

void set_limit(decltype(RLIMIT_AS) what, rlim_t value) {
    rlimit limit{};
    if (::getrlimit(what, &limit) != 0) return;
    limit.rlim_cur = limit.rlim_max == RLIM_INFINITY ? value : std::min(value, limit.rlim_max);
    ::setrlimit(what, &limit);
}

// Crashes are what this process is for: none leaves a core behind, in files or with a collector of
// them; nor does a reader write files.
void leave_nothing_behind() {
    set_limit(RLIMIT_CORE, 0);
    ::prctl(PR_SET_DUMPABLE, 0);
    set_limit(RLIMIT_FSIZE, 0);
}

// Ctrl-C goes to all processes of the terminal; whether it is the end is the caller's to say. A
// file that may not be written is an error of whoever writes it.
void ignore_signals() {
    for (const int number : {SIGINT, SIGQUIT, SIGHUP, SIGXFSZ}) std::signal(number, SIG_IGN);
}

// The reader may be busy, for good even, when the caller goes.
void end_with_the_caller() {
    std::thread([] {
        for (;;) {
            pollfd state{reader_socket, 0, 0};
            if (::poll(&state, 1, -1) > 0) ::_exit(0);
        }
    }).detach();
}

double processor_seconds() {
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    const auto seconds = [](const timeval& t) {
        return double(t.tv_sec) + double(t.tv_usec) / 1e6;
    };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

// Limits are whole seconds, of all that the process has used.
void set_limits(const RequestedFile& file) {
    set_limit(RLIMIT_CPU, file.seconds > 0 ? rlim_t(std::ceil(processor_seconds() + file.seconds))
                                           : RLIM_INFINITY);
    if (!sanitized) set_limit(RLIMIT_AS, file.memory > 0 ? rlim_t(file.memory) : RLIM_INFINITY);
}

void answer(MessageKind kind, const std::vector<std::byte>& bytes) {
    std::fflush(stdout);  // what was printed is in the pipe before the answer is
    std::cout.flush();
    const MessageHeader header = message_header(kind, bytes.size());
    if (!send_all(reader_socket, &header, sizeof header) ||
        !send_all(reader_socket, bytes.data(), bytes.size()))
        ::_exit(0);
}

// Answers with what `load` makes of the file, as bytes.
template <class LoadFile, class BytesOf>
void read_file(const RequestedFile& file, MessageKind kind, const LoadFile& load,
               const BytesOf& bytes_of) {
    memory_ran_out = false;
    set_limits(file);
    try {
        std::error_code ec;
        if (!file.directory.empty()) std::filesystem::current_path(file.directory, ec);
        if (ec) {
            const prep::Error error{
                prep::ErrorCode::io,
                "the reader cannot enter the directory that this is relative to: " + ec.message(),
                file.path.string()};
            return answer(MessageKind::error, error_bytes(error));
        }
        const auto value = load();
        if (value)
            answer(kind, bytes_of(*value));
        else if (memory_ran_out)
            answer(MessageKind::out_of_memory, {});
        else
            answer(MessageKind::error, error_bytes(value.error()));
    } catch (const std::bad_alloc&) {
        answer(MessageKind::out_of_memory, {});
    }
}

// False where the bytes are no request.
bool answer_to(MessageKind kind, const std::vector<std::byte>& bytes, Load load,
               LoadPicture load_picture) {
    if (kind == MessageKind::picture_request) {
        PictureRequest request;
        if (!request_of_bytes(bytes, request)) return false;
        const auto channels =
            request.all_channels ? prep::ImageChannels::all : prep::ImageChannels::color;
        read_file(
            request.file, MessageKind::picture,
            [&] { return load_picture(request.file.path, channels); }, picture_bytes);
        return true;
    }
    ReadRequest request;
    if (!request_of_bytes(bytes, request)) return false;
    read_file(
        request.file, MessageKind::scene,
        [&] { return load(request.format, request.file.path, request.options); }, scene_bytes);
    return true;
}

}  // namespace

void serve(Load load, LoadPicture load_picture) {
    leave_nothing_behind();
    ignore_signals();
    ::mallopt(M_ARENA_MAX, 1);  // one thread reads; a heap for the other would take addresses
    end_with_the_caller();
    std::set_new_handler(out_of_memory);
    for (;;) {
        MessageHeader header;
        if (!receive_all(reader_socket, &header, sizeof header)) ::_exit(0);
        std::vector<std::byte> bytes;
        if (is_of_this_build(header) && header.size <= 1 << 20) bytes.resize(header.size);
        if (bytes.empty() || !receive_all(reader_socket, bytes.data(), bytes.size()) ||
            !answer_to(header.kind, bytes, load, load_picture)) {
            answer(MessageKind::error, {});  // its header tells of which build this is
            ::_exit(1);
        }
    }
}

}  // namespace reader
