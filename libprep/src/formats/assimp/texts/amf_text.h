// AMF (ISO/ASTM 52915) in words that Assimp 5.2 understands.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "prep/scene.h"

namespace prep::detail {

// Assimp reads the first volume of a mesh alone. Where a mesh has several: the text with all of a
// mesh's triangles in one, each with the colour of its volume, else of the object, else of the
// volume's material, where neither it nor the mesh's vertices have one. Nothing: the text as it is,
// or what is no XML.
std::optional<std::string> with_one_volume_a_mesh(std::string_view xml);

// A sentence for each statement that the reader passes over or misunderstands.
std::vector<std::string> misread_of_amf(std::string_view xml);

// Assimp gives every mesh colours, transparent black where the file says none: such sets go, and
// single ones become white. The others are decoded: AMF's are in sRGB.
void settle_amf_colors(Scene& scene);

}  // namespace prep::detail
