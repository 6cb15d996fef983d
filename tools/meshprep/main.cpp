#include <unistd.h>

#include <iostream>

#include "meshprep/commands.h"
#include "meshprep/interrupt.h"

int main(int argc, char** argv) {
    meshprep::watch_interrupts();
    std::ios::sync_with_stdio(false);
    const int code = meshprep::run(argc, argv, std::cout, std::cerr, ::isatty(STDERR_FILENO) != 0);
    std::cout.flush();
    std::cerr.flush();
    return code;
}
