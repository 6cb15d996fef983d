// A file that is open already: what has no size, as a pipe, can be opened only once.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "prep/result.h"

namespace prep::detail {

// All that is left of it; `path` is for messages. Errors: io, limit (over 2^40 bytes).
Result<std::vector<std::byte>> read_open_file(int fd, const std::filesystem::path& path);

// For names that stand in files: a device or a pipe may never end. Errors: io, limit.
Result<std::vector<std::byte>> read_regular_file(const std::filesystem::path& path);

}  // namespace prep::detail
