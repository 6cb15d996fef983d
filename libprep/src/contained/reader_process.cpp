#include "contained/reader_process.h"

#include <dlfcn.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <vector>

#include "contained/child.h"
#include "contained/messages.h"
#include "contained/picture_bytes.h"
#include "contained/scene_bytes.h"

namespace prep {
namespace {

namespace fs = std::filesystem;
using namespace detail;

constexpr std::size_t kept_text = 64 << 10;
// By the clock a file may take this many times its processor time: the machine may be busy.
constexpr double clock_factor = 4;

// Where this program has its libraries looked for. Programs of others are linked with our library
// for pictures, wherever that was installed, so its directory is among them.
std::vector<fs::path> library_directories() {
    std::vector<fs::path> list;
    void* const self = ::dlopen(nullptr, RTLD_LAZY);
    Dl_serinfo size{};
    if (!self || ::dlinfo(self, RTLD_DI_SERINFOSIZE, &size) != 0) return list;
    // The list, and behind it the texts that it points to.
    std::vector<std::max_align_t> memory(size.dls_size / sizeof(std::max_align_t) + 1);
    auto* const all = reinterpret_cast<Dl_serinfo*>(memory.data());
    if (::dlinfo(self, RTLD_DI_SERINFOSIZE, all) == 0 && ::dlinfo(self, RTLD_DI_SERINFO, all) == 0)
        for (unsigned i = 0; i < all->dls_cnt; ++i) list.push_back(all->dls_serpath[i].dls_name);
    ::dlclose(self);
    return list;
}

// Where the program may stand, in this order.
std::vector<fs::path> candidates() {
    if (const char* const named = std::getenv("MESHPREP_READER"); named && *named) return {named};
    std::vector<fs::path> list;
    std::error_code ec;
    const fs::path self = fs::read_symlink("/proc/self/exe", ec);
    if (!ec) {
        if (self.string().starts_with(MESHPREP_READER_PROGRAMS_BUILD "/"))
            list.push_back(fs::path(MESHPREP_READER_BUILT_IN) / MESHPREP_READER_FILE);
        list.push_back(self.parent_path() / MESHPREP_READER_FILE);
        list.push_back((self.parent_path() / MESHPREP_READER_FROM_BIN / MESHPREP_READER_FILE)
                           .lexically_normal());
    }
    for (const fs::path& libraries : library_directories())
        list.push_back(
            (libraries / MESHPREP_READER_FROM_LIB / MESHPREP_READER_FILE).lexically_normal());
    list.push_back(fs::path(MESHPREP_READER_INSTALLED_IN) / MESHPREP_READER_FILE);
    return list;
}

Result<fs::path> program_of(const ReaderProcessOptions& options) {
    const std::vector<fs::path> list =
        options.program.empty() ? candidates() : std::vector<fs::path>{options.program};
    std::string sought;
    for (const fs::path& path : list) {
        if (::access(path.c_str(), X_OK) == 0) return path;
        sought += (sought.empty() ? "" : ", ") + path.string();
    }
    return Error{ErrorCode::io,
                 "the program that reads files of other libraries is not there (sought: " + sought +
                     "): install meshprep anew, or name it in MESHPREP_READER",
                 MESHPREP_READER_FILE};
}

// The last bytes of what was printed.
class Printed {
  public:
    // What is there, a megabyte at most: one that prints without end must not hold us.
    void read_from(int pipe) {
        char block[4096];
        for (int i = 0; i < 256; ++i) {
            const ssize_t n = ::read(pipe, block, sizeof block);
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) break;
            text_.append(block, std::size_t(n));
            if (text_.size() > 2 * kept_text) text_.erase(0, text_.size() - kept_text);
        }
    }
    std::string_view text() const {
        return std::string_view(text_).substr(text_.size() - std::min(text_.size(), kept_text));
    }

  private:
    std::string text_;
};

// What came back of one request.
struct Answer {
    enum class End { whole, broken_off, late, of_another_build, too_large } end = End::broken_off;
    MessageKind kind = MessageKind::error;
    std::vector<std::byte> bytes;
};

// Takes what the child says until its message is whole, and what it prints meanwhile.
class AnswerFromChild {
  public:
    AnswerFromChild(const ChildProcess& child, Printed& printed, double seconds,
                    std::uint64_t most_bytes)
        : child_(child), printed_(printed), left_(seconds), most_bytes_(most_bytes) {}

    Answer take() {
        Answer answer;
        MessageHeader header;
        answer.end = receive(&header, sizeof header);
        if (answer.end != Answer::End::whole) return answer;
        if (!is_of_this_build(header))
            answer.end = Answer::End::of_another_build;
        else if (header.size > most_bytes_)
            answer.end = Answer::End::too_large;
        else
            receive_bytes(header, answer);
        return answer;
    }

  private:
    // The list grows with what comes, not with what was announced.
    void receive_bytes(const MessageHeader& header, Answer& answer) {
        answer.kind = header.kind;
        for (std::size_t have = 0; have < header.size && answer.end == Answer::End::whole;) {
            const std::size_t more = std::size_t(
                std::min<std::uint64_t>(header.size - have, std::max<std::size_t>(have, 1 << 20)));
            answer.bytes.resize(have + more);
            answer.end = receive(answer.bytes.data() + have, more);
            have += more;
        }
    }

    Answer::End receive(void* to, std::size_t size) {
        auto* at = static_cast<std::byte*>(to);
        while (size > 0) {
            if (!wait()) return Answer::End::late;
            const ssize_t n = ::recv(child_.socket(), at, size, MSG_DONTWAIT);
            if (n < 0 && (errno == EINTR || errno == EAGAIN)) continue;
            if (n <= 0) return Answer::End::broken_off;
            at += n;
            size -= std::size_t(n);
        }
        return Answer::End::whole;
    }

    // Until there is something on the socket; false: there is no time left. In steps, each of which
    // counts for what it should have taken at most, so that time in which the whole job was stopped
    // (Ctrl-Z) does not count.
    bool wait() {
        using Clock = std::chrono::steady_clock;
        for (;;) {
            if (left_ <= 0) return false;
            const double step = std::min(left_, 1.0);
            pollfd states[2] = {{child_.socket(), POLLIN, 0}, {pipe_, POLLIN, 0}};
            const Clock::time_point start = Clock::now();
            const int ready = ::poll(states, 2, int(std::ceil(step * 1000)));
            const double took = std::chrono::duration<double>(Clock::now() - start).count();
            left_ -= ready == 0 ? step : std::min(took, step);
            if (ready <= 0) continue;
            if (states[1].revents & POLLIN)
                printed_.read_from(pipe_);
            else if (states[1].revents)
                pipe_ = -1;  // closed: poll() passes it over
            if (states[0].revents) return true;
        }
    }

    const ChildProcess& child_;
    Printed& printed_;
    double left_;
    std::uint64_t most_bytes_;
    int pipe_ = child_.printed();
};

}  // namespace

struct ReaderProcess::State {
    ReaderProcessOptions options;
    std::mutex mutex;  // of `idle`
    std::vector<ChildProcess> idle;
    std::atomic<std::size_t> started = 0;

    // One that waits for a request, or a new one.
    Result<ChildProcess> take() {
        {
            const std::lock_guard lock(mutex);
            while (!idle.empty()) {
                ChildProcess child = std::move(idle.back());
                idle.pop_back();
                if (child.is_there()) return child;
            }
        }
        return start();
    }
    Result<ChildProcess> start() {
        const Result<fs::path> program = program_of(options);
        if (!program) return program.error();
        auto child = ChildProcess::start(*program);
        if (child) ++started;
        return child;
    }
    void give_back(ChildProcess child) {
        const std::lock_guard lock(mutex);
        idle.push_back(std::move(child));
    }
};

ReaderProcess::ReaderProcess(ReaderProcessOptions options) : state_(std::make_unique<State>()) {
    state_->options = std::move(options);
}
ReaderProcess::~ReaderProcess() = default;

std::size_t ReaderProcess::started() const {
    return state_->started;
}

namespace {

std::string short_number(double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) text.pop_back();
    return text;
}

// What is asked for, in bytes; how answers become values, and how they are called in messages.
template <class T>
struct Request {
    MessageKind kind, answer;
    std::vector<std::byte> bytes;
    Result<T> (*value_of)(std::span<const std::byte>);
    std::string_view library, what;  // "scene"
    std::string_view instead;        // formats in which a file that is not damaged can be saved
};

// The request for one file, and what becomes of it.
template <class T>
class ContainedCall {
  public:
    using Log = std::function<void(const fs::path&, std::string_view)>;
    ContainedCall(ReaderProcess::State& state, const Log& log, RequestedFile file,
                  Request<T> request)
        : state_(state), log_(log), file_(std::move(file)), request_(std::move(request)) {}

    Result<T> run() {
        Result<ChildProcess> child = state_.take();
        if (!child) return std::move(child).error();
        const bool used = child->files_read > 0;
        Result<T> value = ask(*std::move(child));
        // What earlier files left behind in the process is no fault of this one.
        if (again_ && used) {
            child = state_.start();
            if (!child) return std::move(child).error();
            value = ask(*std::move(child));
        }
        return value;
    }

  private:
    using End = Answer::End;

    Result<T> ask(ChildProcess child) {
        again_ = false;
        const ReaderProcessOptions& options = state_.options;
        const MessageHeader header = message_header(request_.kind, request_.bytes.size());
        Printed printed;
        Answer answer;
        if (send_all(child.socket(), &header, sizeof header) &&
            send_all(child.socket(), request_.bytes.data(), request_.bytes.size()))
            answer = AnswerFromChild(child, printed,
                                     options.seconds > 0 ? clock_factor * options.seconds
                                                         : std::numeric_limits<double>::infinity(),
                                     options.memory > 0 ? options.memory : UINT64_MAX)
                         .take();
        printed.read_from(child.printed());
        if (log_ && !printed.text().empty()) log_(file_.path, printed.text());
        Result<T> value = result_of(answer, child);
        // A reader that met an error may have left anything behind: the next file gets a new one.
        if (value && answer.end == End::whole) {
            ++child.files_read;
            state_.give_back(std::move(child));
        }
        return value;
    }

    Result<T> result_of(const Answer& answer, ChildProcess& child) {
        switch (answer.end) {
            case End::whole:
                return whole(answer);
            case End::late:
                return over_time();
            case End::too_large:
                return over_memory();
            case End::of_another_build:
                return Error{ErrorCode::io,
                             "the program that reads files of other libraries is of another build: "
                             "install meshprep anew",
                             MESHPREP_READER_FILE};
            case End::broken_off:
                break;
        }
        const std::string how = child.end();
        if (how == "SIGXCPU") return over_time();
        again_ = true;
        return Error{ErrorCode::unsupported,
                     reader() + ", crashed on the file (" + how +
                         "); if the file is not damaged, save it in another format (" +
                         std::string(request_.instead) + ")",
                     place()};
    }

    Result<T> whole(const Answer& answer) {
        if (answer.kind == request_.answer) {
            Result<T> value = request_.value_of(answer.bytes);
            if (value) return value;
            again_ = true;
            return Error{ErrorCode::invalid,
                         reader() + ", made no usable " + std::string(request_.what) +
                             " of the file: " + value.error().text,
                         place()};
        }
        if (answer.kind == MessageKind::out_of_memory) {
            again_ = true;
            return over_memory();
        }
        Error error;
        if (answer.kind != MessageKind::error || !error_of_bytes(answer.bytes, error))
            return Error{ErrorCode::invalid, reader() + ", answered nonsense", place()};
        return error;
    }

    Error over_time() const {
        const double seconds = state_.options.seconds;
        return {ErrorCode::limit,
                reader() + ", was not done with the file in " + short_number(seconds) +
                    " s of processor time or " + short_number(clock_factor * seconds) +
                    " s by the clock; allow more if the file is not damaged",
                place()};
    }
    Error over_memory() const {
        return {ErrorCode::limit,
                reader() + ", needed more than " +
                    short_number(std::round(double(state_.options.memory) / double(1 << 20))) +
                    " MiB of memory for the file; allow more if the file is not damaged",
                place()};
    }
    std::string reader() const {
        return std::string(request_.library) + ", which reads this format";
    }
    std::string place() const { return file_.path.string(); }

    ReaderProcess::State& state_;
    const Log& log_;
    RequestedFile file_;
    Request<T> request_;
    bool again_ = false;
};

RequestedFile requested_file(const fs::path& path, const ReaderProcessOptions& limits) {
    RequestedFile file;
    file.path = path;
    if (path.is_relative()) {
        std::error_code ec;
        file.directory = fs::current_path(ec);  // empty where it is gone
    }
    file.seconds = limits.seconds;
    file.memory = limits.memory;
    return file;
}

}  // namespace

Result<Scene> detail::load_contained(std::string_view format, std::string_view library,
                                     const fs::path& path, const LoadOptions& options) {
    ReaderProcess::State& state = options.reader_process->state();
    ReadRequest request;
    request.format = format;
    request.file = requested_file(path, state.options);
    request.options = options;
    return ContainedCall<Scene>(state, options.reader_log, request.file,
                                {MessageKind::request, MessageKind::scene, request_bytes(request),
                                 scene_of_bytes, library, "scene", "glTF, OBJ"})
        .run();
}

Result<Image> detail::load_picture_contained(const fs::path& path, const ImageOptions& options) {
    ReaderProcess::State& state = options.reader_process->state();
    PictureRequest request;
    request.file = requested_file(path, state.options);
    request.all_channels = options.channels == ImageChannels::all;
    using Bytes = std::span<const std::byte>;
    Result<Image> (*const value_of)(Bytes) =
        request.all_channels
            ? [](Bytes bytes) { return picture_of_bytes(bytes, ImageChannels::all); }
            : [](Bytes bytes) { return picture_of_bytes(bytes, ImageChannels::color); };
    return ContainedCall<Image>(
               state, options.reader_log, request.file,
               {MessageKind::picture_request, MessageKind::picture, request_bytes(request),
                value_of, "OpenImageIO", "picture", "PNG, EXR"})
        .run();
}

}  // namespace prep
