// What every subcommand has: its exit codes and its common options.
#pragma once

namespace meshprep {

enum ExitCode : int { exit_done = 0, exit_failed = 1, exit_usage = 2 };

struct CommonOptions {
    bool json = false;   // machine-readable results on stdout
    bool quiet = false;  // no results in words, no progress; errors still go to stderr
    int threads = 0;     // 0: all cores
};

}  // namespace meshprep
