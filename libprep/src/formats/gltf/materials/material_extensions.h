// Materials in glTF's terms, beside what every material has (docs/materials.md).
#pragma once

#include <set>
#include <string>

#include "formats/gltf/document.h"
#include "prep/material.h"

namespace prep::detail {

// What a material reflects of light that falls straight in, and how widely: of metallic-roughness
// its own, of Blinn-Phong the inverse of blinn_phong().
struct GltfHighlight {
    glm::vec3 reflectance{0.04f};
    float roughness = 1;
    bool limited = false;  // to what the diffuse colour leaves
};
GltfHighlight gltf_highlight(const Material& material);

// KHR_materials_clearcoat, _sheen and _anisotropy, where the material has them; their names are
// added to `extensions`.
void write_layers(const Material& material, Json& out, std::set<std::string>& extensions);

}  // namespace prep::detail
