// SHA-256 (FIPS 180-4), to tell whether a file is still what it was.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "prep/result.h"

namespace meshprep {

// 64 hexadecimal digits.
std::string sha256(std::span<const std::byte> bytes);
// Errors: io.
prep::Result<std::string> sha256_of_file(const std::filesystem::path& path);

}  // namespace meshprep
