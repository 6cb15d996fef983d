// A directory of this run alone, for what is unpacked or passed through: no other user can read it,
// and it goes with all it holds, on Ctrl-C too (interrupt.h).
#pragma once

#include <filesystem>

#include "prep/result.h"

namespace meshprep {

class PrivateDirectory {
  public:
    // Where temporary files go (TMPDIR). Errors: io.
    static prep::Result<PrivateDirectory> make();
    PrivateDirectory(PrivateDirectory&& other) noexcept;
    PrivateDirectory& operator=(PrivateDirectory&&) = delete;
    ~PrivateDirectory();

    const std::filesystem::path& path() const { return path_; }

  private:
    explicit PrivateDirectory(std::filesystem::path path) : path_(std::move(path)) {}
    std::filesystem::path path_;  // empty: moved from
};

// Removes those there are; none can be made from then on. For a process that is told to end.
void remove_private_directories();

}  // namespace meshprep
