#include <unistd.h>

#include <csignal>
#include <iostream>

#include "meshprep/commands.h"
#include "meshprep/interrupt.h"

int main(int argc, char** argv) {
    meshprep::watch_interrupts();
    std::signal(SIGXFSZ, SIG_IGN);  // a file over the user's limit is an error, not the end
    std::ios::sync_with_stdio(false);
    const int code = meshprep::run(argc, argv, std::cout, std::cerr, ::isatty(STDERR_FILENO) != 0);
    std::cout.flush();
    std::cerr.flush();
    return code;
}
