// What happens on Ctrl-C: temporary files of outputs being written are removed, then the process
// ends. Finished outputs and old ones are not touched, because writing is to a temporary name.
#pragma once

#include <filesystem>

namespace meshprep {

// Blocks SIGINT, SIGTERM and SIGHUP for this thread and those it starts, and waits for them in a
// thread of its own. Signals that are ignored already (nohup) stay so. Call once, before other
// threads start.
void watch_interrupts();

// While it lives, temporaries beside `output` are known to belong to this process: files in its
// directory, younger than this object, named <output's stem>.<anything>.<six letters or digits>.
class OutputGuard {
  public:
    explicit OutputGuard(const std::filesystem::path& output);
    ~OutputGuard();
    OutputGuard(const OutputGuard&) = delete;
    OutputGuard& operator=(const OutputGuard&) = delete;
};

// What watch_interrupts does to the files, without ending the process: how many were removed.
int remove_temporaries();

}  // namespace meshprep
