// A glTF document for a scene that did not come from one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/gltf/buffer.h"
#include "prep/prepared_scene.h"

namespace prep::detail {

// Appends meshes, materials, nodes, … to the document and its buffer. Blinn-Phong parameters become
// KHR_materials_specular and a roughness of the same highlight width (roughness⁴ = 2 / (shininess +
// 2)); the exact values stand in extras, so that reading the file back restores them.
void build_gltf(const PreparedScene& prepared, Json& document, GltfBuffer& buffer,
                std::vector<std::string>& notes);

// Says that so many of what is named, in the singular, were not written.
inline std::string non_finite_note(std::uint64_t count, const char* what) {
    return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s") +
           " with a position that is not finite left out";
}

}  // namespace prep::detail
