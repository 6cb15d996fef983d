// Large files, read whole.
#pragma once

#include <cstddef>
#include <filesystem>

#include "base/unfilled_vector.h"
#include "prep/result.h"

namespace prep::detail {

using FileBytes = UnfilledVector<std::byte>;

// As read_file(), on at most `threads` threads (0: all cores), without a pass over memory that is
// written over at once.
Result<FileBytes> read_file_bytes(const std::filesystem::path& path, int threads);

}  // namespace prep::detail
