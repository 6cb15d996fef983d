// Whether files are still what they were when reading began: a hash that is taken afterwards is
// otherwise not of what was read.
#pragma once

#include <sys/stat.h>
#include <time.h>

#include <filesystem>
#include <optional>

namespace meshprep {

class ReadWatch {
  public:
    // Before anything is read of `input` and what it names.
    explicit ReadWatch(const std::filesystem::path& input);

    // Whether nobody has changed the file since, as far as its size and the file system's times
    // tell. Times are as fine as the kernel's clock, some milliseconds: in the first of them only
    // the input is sure. Where a server's clock runs ahead, files that were just written count as
    // changed. False where there is no such file.
    bool unchanged(const std::filesystem::path& file) const;

  private:
    std::filesystem::path input_;
    std::optional<struct stat> before_;  // of the input
    timespec begin_{};
};

}  // namespace meshprep
