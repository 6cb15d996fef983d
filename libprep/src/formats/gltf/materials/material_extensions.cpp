#include "formats/gltf/materials/material_extensions.h"

#include <algorithm>

#include "formats/gltf/buffer.h"

namespace prep::detail {
namespace {

// Renderers of glTF take what is reflected from the diffuse light: a wide bright highlight would
// leave none of the colour. It may have what the colour leaves, and always a quarter: what Ks = 1
// reflects at Ns = 30.
constexpr float least_limit = 0.25f;

float unit(float x) {
    return std::clamp(x, 0.0f, 1.0f);
}

float largest(const glm::vec3& v) {
    return std::max({v.r, v.g, v.b});
}

}  // namespace

GltfHighlight gltf_highlight(const Material& m) {
    if (m.metallic_roughness)
        return {glm::clamp(m.reflectance, 0.0f, 1.0f), unit(m.roughness), false};
    GltfHighlight highlight;
    highlight.roughness = dielectric(m.specular, m.shininess).roughness;
    // Not cut off at 1 before it is limited: its hue stays.
    highlight.reflectance = glm::max(m.specular, 0.0f) / highlight_spread(m.shininess);
    const float left = 1 - largest(glm::vec3(m.diffuse));
    const float limit = std::max(left, least_limit);
    const float most = largest(highlight.reflectance);
    highlight.limited = most > limit;
    if (highlight.limited) highlight.reflectance *= limit / most;
    return highlight;
}

void write_layers(const Material& m, Json& out, std::set<std::string>& extensions) {
    const auto extension = [&](const char* name) -> Json& {
        extensions.insert(name);
        return out["extensions"][name];
    };
    if (m.clearcoat > 0) {
        Json& coat = extension("KHR_materials_clearcoat");
        coat["clearcoatFactor"] = unit(m.clearcoat);
        coat["clearcoatRoughnessFactor"] = unit(m.clearcoat_roughness);
    }
    if (m.sheen != glm::vec3(0.0f)) {
        Json& sheen = extension("KHR_materials_sheen");
        sheen["sheenColorFactor"] = array3(glm::clamp(m.sheen, 0.0f, 1.0f));
        sheen["sheenRoughnessFactor"] = unit(m.sheen_roughness);
    }
    if (m.anisotropy > 0) {
        Json& anisotropy = extension("KHR_materials_anisotropy");
        anisotropy["anisotropyStrength"] = unit(m.anisotropy);
        anisotropy["anisotropyRotation"] = m.anisotropy_rotation;
    }
}

}  // namespace prep::detail
