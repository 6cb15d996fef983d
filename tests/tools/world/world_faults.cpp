// Loaded into the command before all other libraries (LD_PRELOAD): a file system that has troubles,
// and signals that arrive at a chosen moment. Only what lies under WORLD_DIR is concerned.
//
//   WORLD_SPACE=n    room for n bytes in all; a write that does not fit is taken in part, the next
//                    one fails (ENOSPC)
//   WORLD_PIECES=1   a write takes half of what it is given; every other one fails (EINTR)
//   WORLD_CLOSE=n    the n-th close of a file that was written fails (EIO), as on network disks
//   WORLD_RENAME=n   the n-th rename fails (EIO)
//   WORLD_LINKS=0    there are no hard links (EPERM)
//   WORLD_THREADS=n  room for n threads beside the first, ended ones too (EAGAIN)
//   WORLD_EDIT=file, WORLD_EDIT_AT=n
//                    before its n-th opening for reading a line is added to the file
//   WORLD_AT=what:n, WORLD_SIGNAL=s
//                    before the n-th write, rename, link or unlink the process gets the signal s.
//                    The write never returns: it is for the process to end. The others go on once
//                    the signal has been taken, and so do all with WORLD_GO_ON=1.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace {

const char* setting(const char* name) {
    const char* text = std::getenv(name);
    return text ? text : "";
}

long number(const char* name) {
    return std::atol(setting(name));
}

template <class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

bool concerned(const char* path) {
    const char* directory = setting("WORLD_DIR");
    const std::size_t length = std::strlen(directory);
    return length > 0 && std::strncmp(path, directory, length) == 0;
}

// The tests write no other files: what has been opened under the directory for writing is meant.
bool concerned(int file) {
    char link[32], path[4096];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t length = ::readlink(link, path, sizeof path - 1);
    if (length < 0) return false;
    path[length] = '\0';
    return concerned(path) && (::fcntl(file, F_GETFL) & O_ACCMODE) != O_RDONLY;
}

void wait_ms(long ms) {
    const timespec time{ms / 1000, ms % 1000 * 1000000};
    ::nanosleep(&time, nullptr);
}

std::atomic<long> writes{0}, renames{0}, links{0}, unlinks{0}, closes{0}, used{0}, threads{0},
    openings{0};

void edit_at(const char* path) {
    if (std::strcmp(path, setting("WORLD_EDIT")) != 0 || ++openings != number("WORLD_EDIT_AT"))
        return;
    const int file = int(::syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_APPEND | O_CLOEXEC));
    const char line[] = "v 0 0 9\nf 1 2 -1\n";
    (void)!::syscall(SYS_write, file, line, sizeof line - 1);
    ::syscall(SYS_close, file);
}

void signal_at(const char* what, std::atomic<long>& count) {
    const long now = ++count;
    const char* at = setting("WORLD_AT");
    const std::size_t length = std::strlen(what);
    if (std::strncmp(at, what, length) != 0 || at[length] != ':') return;
    if (std::atol(at + length + 1) != now) return;
    ::kill(::getpid(), int(number("WORLD_SIGNAL")));
    if (std::strcmp(what, "write") == 0 && number("WORLD_GO_ON") == 0) {
        wait_ms(30000);
        ::_exit(99);  // nothing ended the process
    }
    // Whoever waits for the signal has it before this call goes on, and some time to do harm.
    sigset_t pending;
    for (int k = 0; k < 1000; ++k) {
        ::sigpending(&pending);
        if (::sigismember(&pending, int(number("WORLD_SIGNAL"))) == 0) break;
        wait_ms(1);
    }
    wait_ms(20);
}

// What the disk takes of `size` bytes; −1 with errno where it takes nothing.
ssize_t taken(std::size_t size) {
    signal_at("write", writes);
    if (number("WORLD_PIECES") != 0) {
        if (writes % 2 == 1) {
            errno = EINTR;
            return -1;
        }
        size = (size + 1) / 2;
    }
    if (*setting("WORLD_SPACE")) {
        const long room = number("WORLD_SPACE") - used;
        if (room <= 0 && size > 0) {
            errno = ENOSPC;
            return -1;
        }
        size = std::min(size, std::size_t(room));
    }
    used += long(size);
    return ssize_t(size);
}

// Streams of the C library write below the functions that this file stands before.
ssize_t cookie_write(void* cookie, const char* bytes, std::size_t size) {
    const int file = int(reinterpret_cast<std::intptr_t>(cookie));
    std::size_t done = 0;
    while (done < size) {
        const ssize_t count = taken(size - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return ssize_t(done);
        const auto real = next<decltype(::write)>("write");
        if (real(file, bytes + done, std::size_t(count)) != count) return ssize_t(done);
        done += std::size_t(count);
    }
    return ssize_t(done);
}

int cookie_seek(void* cookie, off64_t* offset, int whence) {
    const int file = int(reinterpret_cast<std::intptr_t>(cookie));
    *offset = ::lseek64(file, *offset, whence);
    return *offset < 0 ? -1 : 0;
}

int cookie_close(void* cookie) {
    return ::close(int(reinterpret_cast<std::intptr_t>(cookie)));
}

FILE* open_stream(const char* name, const char* path, const char* mode) {
    if (mode[0] == 'r') edit_at(path);
    if (!concerned(path) || mode[0] != 'w') return next<decltype(::fopen)>(name)(path, mode);
    const int file = ::open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) return nullptr;
    return ::fopencookie(reinterpret_cast<void*>(std::intptr_t(file)), mode,
                         {nullptr, cookie_write, cookie_seek, cookie_close});
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* bytes, std::size_t size) {
    const auto real = next<ssize_t(int, const void*, std::size_t)>("write");
    if (!concerned(file)) return real(file, bytes, size);
    const ssize_t count = taken(size);
    return count < 0 ? count : real(file, bytes, std::size_t(count));
}

ssize_t pwrite64(int file, const void* bytes, std::size_t size, off64_t at) {
    const auto real = next<ssize_t(int, const void*, std::size_t, off64_t)>("pwrite64");
    if (!concerned(file)) return real(file, bytes, size, at);
    const ssize_t count = taken(size);
    return count < 0 ? count : real(file, bytes, std::size_t(count), at);
}

ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t at) {
    return pwrite64(file, bytes, size, at);
}

ssize_t writev(int file, const iovec* parts, int count) {
    if (!concerned(file))
        return next<ssize_t(int, const iovec*, int)>("writev")(file, parts, count);
    for (int k = 0; k < count; ++k)  // in part, as writev may
        if (parts[k].iov_len > 0) return write(file, parts[k].iov_base, parts[k].iov_len);
    return 0;
}

int close(int file) {
    const bool fails =
        *setting("WORLD_CLOSE") && concerned(file) && ++closes == number("WORLD_CLOSE");
    const int done = next<int(int)>("close")(file);
    if (!fails) return done;
    errno = EIO;
    return -1;
}

int open(const char* path, int flags, ...) {
    va_list more;
    va_start(more, flags);
    const unsigned mode = (flags & O_CREAT) != 0 ? va_arg(more, unsigned) : 0;
    va_end(more);
    if ((flags & O_ACCMODE) == O_RDONLY) edit_at(path);
    return next<int(const char*, int, ...)>("open")(path, flags, mode);
}

int rename(const char* from, const char* to) noexcept {
    if (concerned(to)) {
        signal_at("rename", renames);
        if (renames == number("WORLD_RENAME")) {
            errno = EIO;
            return -1;
        }
    }
    return next<int(const char*, const char*)>("rename")(from, to);
}

int link(const char* from, const char* to) noexcept {
    if (concerned(to)) {
        signal_at("link", links);
        if (std::strcmp(setting("WORLD_LINKS"), "0") == 0) {
            errno = ::access(from, F_OK) == 0 ? EPERM : ENOENT;
            return -1;
        }
    }
    return next<int(const char*, const char*)>("link")(from, to);
}

int unlink(const char* path) noexcept {
    if (concerned(path)) signal_at("unlink", unlinks);
    return next<int(const char*)>("unlink")(path);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*),
                   void* argument) noexcept {
    if (*setting("WORLD_THREADS") && ++threads > number("WORLD_THREADS")) return EAGAIN;
    return next<int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*)>("pthread_create")(
        thread, attributes, run, argument);
}

FILE* fopen(const char* path, const char* mode) {
    return open_stream("fopen", path, mode);
}

FILE* fopen64(const char* path, const char* mode) {
    return open_stream("fopen64", path, mode);
}

}  // extern "C"
