#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <iostream>

#include "meshprep/files/interrupt.h"
#include "meshprep/run.h"

// The next file that is opened would take the place of a standard stream that is closed, and what
// is said would land in it. Reading from the first and writing to the others stay the errors they
// were.
static void keep_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(stream, F_GETFD) < 0)
            (void)::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

int main(int argc, char** argv) {
    keep_standard_streams();
    meshprep::watch_interrupts();
    std::signal(SIGXFSZ, SIG_IGN);  // a file over the user's limit is an error, not the end
    std::signal(SIGPIPE, SIG_IGN);  // and so is a reader that has gone
    std::ios::sync_with_stdio(false);
    const int code = meshprep::run(argc, argv, std::cout, std::cerr, ::isatty(STDERR_FILENO) != 0);
    std::cout.flush();
    std::cerr.flush();
    meshprep::yield_to_interrupt();
    return code;
}
