// What every subcommand has: its exit codes and its common options.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "prep/load.h"

namespace meshprep {

enum ExitCode : int { exit_done = 0, exit_failed = 1, exit_usage = 2 };

struct CommonOptions {
    bool json = false;         // machine-readable results on stdout
    bool json_lines = false;   // the same, a line for each file
    bool quiet = false;        // no results in words, no progress; errors still go to stderr
    bool verbose = false;      // also what readers of other libraries print, to stderr
    std::string input_format;  // the ending by which inputs are read; empty: their own
    int threads = 0;           // 0: all cores
    prep::LoadOptions load;    // but for threads and the process
    // One for all files: readers of other libraries never run in this process.
    std::shared_ptr<prep::ReaderProcess> reader_process = std::make_shared<prep::ReaderProcess>();
};

}  // namespace meshprep
