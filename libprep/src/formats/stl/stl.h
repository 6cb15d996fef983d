// STL in, by a parser of our own (ply/ply.h says why).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "prep/result.h"
#include "prep/scene.h"

namespace prep {
namespace detail {

// Whether the first word is "solid", in any case: of text, and of many binary files too.
bool says_solid(std::string_view text);

}  // namespace detail

// ASCII (several solids, each a part) and binary, told apart by the size that a binary header
// announces: many binary files begin with "solid". Facet normals are not read: they follow from the
// corners. Every triangle has vertices of its own. One mesh and one node; `name` and errors as in
// parse_ply().
Result<Scene> parse_stl(std::span<const std::byte> bytes, const std::string& name);
// On at most `threads` threads (0: all cores), which does not change the result.
Result<Scene> parse_stl(std::span<const std::byte> bytes, const std::string& name, int threads);

}  // namespace prep
