// A process that was started with a socket to talk through, and a pipe for what it prints.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

#include "prep/result.h"

namespace prep::detail {

class ChildProcess {
  public:
    // Error: io (it cannot be started).
    static Result<ChildProcess> start(const std::filesystem::path& program);
    ~ChildProcess();  // ends it
    ChildProcess(ChildProcess&& other) noexcept;
    ChildProcess& operator=(ChildProcess&& other) noexcept;

    int socket() const { return socket_; }
    // The end of the pipe that is read; it never blocks.
    int printed() const { return printed_; }
    // Whether it waits for a request, as far as can be told from here.
    bool is_there() const;
    // Ends it and says how it had ended if it had: "SIGSEGV", "exit code 3".
    std::string end();

    int files_read = 0;

  private:
    ChildProcess(pid_t pid, int socket, int printed)
        : pid_(pid), socket_(socket), printed_(printed) {}

    pid_t pid_ = -1;
    int socket_ = -1, printed_ = -1;
};

}  // namespace prep::detail
