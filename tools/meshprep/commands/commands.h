// The subcommands: each does its work, says its results on the console and returns the exit code.
#pragma once

#include "meshprep/options/arguments.h"
#include "meshprep/output/console.h"

namespace meshprep {

int run_prepare(const PrepareCommand& command, Console& console);
int run_inspect(const InspectCommand& command, Console& console);
int run_render(const RenderCommand& command, Console& console);
int run_validate(const ValidateCommand& command, Console& console);
int run_diff(const DiffCommand& command, Console& console);

// Parses the command line and runs the subcommand.
int run(int argc, const char* const* argv, std::ostream& out, std::ostream& err,
        bool err_is_terminal);

}  // namespace meshprep
