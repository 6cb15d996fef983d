// DXF in words that Assimp 5.2 understands, and what of it it does not.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "prep/scene.h"

namespace prep::detail {

// A corner of a polyface whose edge is not to be drawn has a negative number (DXF Reference,
// VERTEX, groups 71 to 74): Assimp loses it. The text with such numbers positive; nothing where
// there are none.
std::optional<std::string> with_positive_corners(std::string_view dxf);

// A sentence for each: references to blocks that are turned or scaled, those within blocks, other
// entities than it reads, colours that it does not know.
std::vector<std::string> misread_of_dxf(std::string_view dxf);

// Colours by the numbers 1 to 9, for which Assimp has others, are those of AutoCAD, where an entity
// has none those of its layer; all are opaque.
void settle_dxf_colors(std::string_view dxf, Scene& scene);

}  // namespace prep::detail
