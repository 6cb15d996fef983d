#include "contained/child.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "contained/messages.h"

extern char** environ;

namespace prep::detail {
namespace {

class FileDescriptor {
  public:
    explicit FileDescriptor(int number) : number_(number) {}
    ~FileDescriptor() {
        if (number_ >= 0) ::close(number_);
    }
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    int get() const { return number_; }
    int release() { return std::exchange(number_, -1); }
    // Out of the way of the numbers that the child gets.
    void move_up() {
        const int up = ::fcntl(number_, F_DUPFD_CLOEXEC, reader_socket + 1);
        ::close(number_);
        number_ = up;
    }

  private:
    int number_;
};

struct SpawnRules {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    SpawnRules() {
        ::posix_spawn_file_actions_init(&actions);
        ::posix_spawnattr_init(&attributes);
    }
    ~SpawnRules() {
        ::posix_spawn_file_actions_destroy(&actions);
        ::posix_spawnattr_destroy(&attributes);
    }
    SpawnRules(const SpawnRules&) = delete;
    SpawnRules& operator=(const SpawnRules&) = delete;
};

// Signals as a new program expects them, whatever the caller blocks or ignores.
void set_signals(posix_spawnattr_t& attributes) {
    sigset_t none, usual;
    sigemptyset(&none);
    sigemptyset(&usual);
    for (const int number : {SIGHUP, SIGINT, SIGQUIT, SIGILL, SIGTRAP, SIGABRT, SIGBUS, SIGFPE,
                             SIGSEGV, SIGSYS, SIGPIPE, SIGTERM, SIGCHLD, SIGXCPU, SIGXFSZ})
        sigaddset(&usual, number);
    ::posix_spawnattr_setsigmask(&attributes, &none);
    ::posix_spawnattr_setsigdefault(&attributes, &usual);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
}

Error not_started(const std::filesystem::path& program, int error) {
    return {ErrorCode::io,
            std::string("the reader's process cannot be started: ") + std::strerror(error),
            program.string()};
}

}  // namespace

Result<ChildProcess> ChildProcess::start(const std::filesystem::path& program) {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        return not_started(program, errno);
    FileDescriptor ours(ends[0]), theirs(ends[1]);
    if (::pipe2(ends, O_CLOEXEC) != 0) return not_started(program, errno);
    FileDescriptor printed(ends[0]), prints(ends[1]);
    theirs.move_up();
    prints.move_up();
    if (theirs.get() < 0 || prints.get() < 0 || ::fcntl(printed.get(), F_SETFL, O_NONBLOCK) != 0)
        return not_started(program, errno);

    SpawnRules rules;
    set_signals(rules.attributes);
    ::posix_spawn_file_actions_addopen(&rules.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&rules.actions, prints.get(), STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&rules.actions, prints.get(), STDERR_FILENO);
    ::posix_spawn_file_actions_adddup2(&rules.actions, theirs.get(), reader_socket);
    ::posix_spawn_file_actions_addclosefrom_np(&rules.actions, reader_socket + 1);
    std::string name = program.string();
    char* const arguments[] = {name.data(), nullptr};
    pid_t pid = -1;
    const int error =
        ::posix_spawn(&pid, name.c_str(), &rules.actions, &rules.attributes, arguments, environ);
    if (error != 0) return not_started(program, error);
    return ChildProcess(pid, ours.release(), printed.release());
}

ChildProcess::~ChildProcess() {
    if (pid_ > 0) end();
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : files_read(other.files_read),
      pid_(std::exchange(other.pid_, -1)),
      socket_(std::exchange(other.socket_, -1)),
      printed_(std::exchange(other.printed_, -1)) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
    if (this != &other) {
        if (pid_ > 0) end();
        files_read = other.files_read;
        pid_ = std::exchange(other.pid_, -1);
        socket_ = std::exchange(other.socket_, -1);
        printed_ = std::exchange(other.printed_, -1);
    }
    return *this;
}

bool ChildProcess::is_there() const {
    pollfd state{socket_, POLLIN, 0};
    return ::poll(&state, 1, 0) == 0;  // it says nothing unasked, so anything is its end
}

std::string ChildProcess::end() {
    // One that has just ended closes its socket before its status is there: a signal now could take
    // the place of the one that ended it.
    int status = 0;
    pollfd state{socket_, 0, 0};
    const bool hung_up = ::poll(&state, 1, 0) > 0 && (state.revents & POLLHUP) != 0;
    pid_t ended = 0;
    for (int wait = 0; hung_up && ended == 0 && wait < 1000; ++wait) {
        ended = ::waitpid(pid_, &status, WNOHANG);
        if (ended == 0) ::usleep(1000);
    }
    if (ended == 0) {
        ::kill(pid_, SIGKILL);
        do ended = ::waitpid(pid_, &status, 0);
        while (ended < 0 && errno == EINTR);
    }
    ::close(socket_);
    ::close(printed_);
    pid_ = socket_ = printed_ = -1;
    if (ended < 0) return "unknown";  // the caller waits for all its children
    if (WIFSIGNALED(status)) {
        const char* const name = ::sigabbrev_np(WTERMSIG(status));
        return name ? std::string("SIG") + name : "signal " + std::to_string(WTERMSIG(status));
    }
    return "exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace prep::detail
