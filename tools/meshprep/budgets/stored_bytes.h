// What attributes take in a GLB file.
#pragma once

#include <cstdint>
#include <filesystem>

#include "prep/result.h"

namespace meshprep {

// Of all accessors that primitives have under this name ("NORMAL"), each once, with the padding
// between their elements; the file is not compressed. Errors: io, syntax (no GLB).
prep::Result<std::uint64_t> stored_bytes(const std::filesystem::path& glb, const char* attribute);

}  // namespace meshprep
