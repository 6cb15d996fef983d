// Whole files, read and written.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "prep/result.h"

namespace prep {

// The whole file. Errors: io, limit (over 2^40 bytes).
Result<std::vector<std::byte>> read_file(const std::filesystem::path& path);

// Writes to a temporary name beside `path`, then renames: complete or not at all. Links are
// followed; a pipe or a device is written in place. Errors: io.
Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

// For a process that is told to end: waits for files that are just getting their names, then
// removes the temporary files of writes that are under way in any thread. Their results are errors
// from now on, and so is every later write. Returns how many files there were.
std::size_t discard_unfinished_files();

}  // namespace prep
