// The command: reads the command line and runs the subcommand.
#pragma once

#include <ostream>

namespace meshprep {

int run(int argc, const char* const* argv, std::ostream& out, std::ostream& err,
        bool err_is_terminal);

}  // namespace meshprep
