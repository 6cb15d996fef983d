// OFF in, by a parser of our own (ply/ply.h says why).
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "prep/result.h"
#include "prep/scene.h"

namespace prep {

// OFF with the prefixes ST, C, N and 4 (text); binary OFF is unsupported. Colours of faces are
// those of their corners where vertices have none. One mesh and one node; `name` and errors as in
// parse_ply().
Result<Scene> parse_off(std::span<const std::byte> bytes, const std::string& name);

}  // namespace prep
