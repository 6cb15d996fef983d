// Whole files, beyond prep/files.h: what is open already, as a pipe can be opened only once; what
// stands in a file's text; and large ones.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "base/unfilled_vector.h"
#include "prep/result.h"

namespace prep::detail {

// All that is left of it; `path` is for messages. Errors: io, limit (over 2^40 bytes).
Result<std::vector<std::byte>> read_open_file(int fd, const std::filesystem::path& path);

// For names that stand in files: a device or a pipe may never end. Errors: io, limit.
Result<std::vector<std::byte>> read_regular_file(const std::filesystem::path& path);

// As prep::read_file(), on at most `threads` threads (0: all cores), without a pass over memory
// that is written over.
using FileBytes = UnfilledVector<std::byte>;
Result<FileBytes> read_file_bytes(const std::filesystem::path& path, int threads);

}  // namespace prep::detail
