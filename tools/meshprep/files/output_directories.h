// Directories of outputs: made when something is about to be written there, parents too, and
// removed again where nothing was.
#pragma once

#include <filesystem>
#include <mutex>
#include <vector>

#include "prep/result.h"

namespace meshprep {

// For any threads.
class OutputDirectories {
  public:
    OutputDirectories() = default;
    ~OutputDirectories();  // removes those it made that are empty
    OutputDirectories(const OutputDirectories&) = delete;
    OutputDirectories& operator=(const OutputDirectories&) = delete;

    // Errors: io (a file is in the way, no permission).
    prep::Result<void> make(const std::filesystem::path& directory);
    // The one that `file` stands in.
    prep::Result<void> make_for(const std::filesystem::path& file);

  private:
    std::mutex mutex_;
    std::vector<std::filesystem::path> made_;  // parents first
};

}  // namespace meshprep
