// Materials: how surfaces answer to light, and the textures that vary it.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "prep/enum_names.h"
#include "prep/mesh.h"

namespace prep {

enum class Wrap : std::uint8_t { repeat, mirror, clamp, border };
constexpr auto names_of(Wrap) {
    return std::to_array<EnumName<Wrap>>({{"repeat", Wrap::repeat},
                                          {"mirror", Wrap::mirror},
                                          {"clamp", Wrap::clamp},
                                          {"border", Wrap::border}});
}

enum class Filter : std::uint8_t { nearest, linear };
constexpr auto names_of(Filter) {
    return std::to_array<EnumName<Filter>>(
        {{"nearest", Filter::nearest}, {"linear", Filter::linear}});
}

enum class MipFilter : std::uint8_t { none, nearest, linear };
constexpr auto names_of(MipFilter) {
    return std::to_array<EnumName<MipFilter>>({{"none", MipFilter::none},
                                               {"nearest", MipFilter::nearest},
                                               {"linear", MipFilter::linear}});
}

struct Texture {
    std::uint32_t image = no_index;
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    Filter mag = Filter::linear, min = Filter::linear;
    MipFilter mip = MipFilter::linear;
};

struct TextureRef {
    std::uint32_t texture = no_index;  // into Scene::textures
    std::uint32_t uv_set = 0;
    glm::vec2 offset{0}, scale{1};  // KHR_texture_transform; OBJ -o and -s
    float rotation = 0;             // radians, counter-clockwise as in KHR_texture_transform
    float strength = 1;             // normal scale, occlusion strength, OBJ -bm
    explicit operator bool() const { return texture != no_index; }
};

enum class AlphaMode : std::uint8_t { opaque, mask, blend };
constexpr auto names_of(AlphaMode) {
    return std::to_array<EnumName<AlphaMode>>(
        {{"opaque", AlphaMode::opaque}, {"mask", AlphaMode::mask}, {"blend", AlphaMode::blend}});
}

enum class NormalMapSpace : std::uint8_t { tangent, object };
constexpr auto names_of(NormalMapSpace) {
    return std::to_array<EnumName<NormalMapSpace>>(
        {{"tangent", NormalMapSpace::tangent}, {"object", NormalMapSpace::object}});
}

// Blinn-Phong parameters, linear colour. In a metallic-roughness material `diffuse` is the base
// colour and `diffuse_map` its map; the renderer derives diffuse, specular and shininess from
// metallic and roughness at each pixel (docs/conventions.md), so `specular` and `shininess` are not
// read.
struct Material {
    std::string name;
    glm::vec3 ambient{1.0f};  // multiplies the ambient light (times diffuse colour)
    glm::vec4 diffuse{0.8f, 0.8f, 0.8f, 1.0f};  // a = opacity
    glm::vec3 specular{0.2f};
    float shininess = 32;  // Blinn-Phong exponent
    glm::vec3 emissive{0.0f};
    TextureRef diffuse_map, specular_map, emissive_map, occlusion_map;
    TextureRef normal_map, bump_map, displacement_map;
    NormalMapSpace normal_map_space = NormalMapSpace::tangent;
    bool normal_map_flip_green = false;  // true for maps whose green points down
    bool unlit = false;

    bool metallic_roughness = false;
    float metallic = 1, roughness = 1;
    TextureRef metallic_roughness_map;

    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
};

// The maps of a material. Everything that goes over a material's maps goes over this table:
// requirements, checks, merging, scene files, plans, draws, listings. Readers and writers of files
// have their own words for each.
enum class MapKind : std::uint8_t {
    diffuse,
    specular,
    emissive,
    occlusion,
    normal,
    metallic_roughness,
    bump,
    displacement
};

// Which materials a map has an effect on when they are drawn.
enum class MapUse : std::uint8_t {
    always,
    lit,                 // not unlit ones
    blinn_phong,         // lit ones without metallic-roughness
    metallic_roughness,  // lit ones with it
    normals,             // lit ones, with normals as they are asked for
    not_drawn
};

struct MaterialMap {
    MapKind kind;
    const char* name;  // "diffuse": in texts "diffuse map"
    TextureRef Material::*ref;
    MapUse use;
    bool color;             // stored sRGB-encoded; else data
    const char* scene_key;  // in scene files; null: none
};

// In the order of MapKind; those that are drawn come first.
inline constexpr MaterialMap material_maps[] = {
    {MapKind::diffuse, "diffuse", &Material::diffuse_map, MapUse::always, true, "diffuse_map"},
    {MapKind::specular, "specular", &Material::specular_map, MapUse::blinn_phong, true,
     "specular_map"},
    {MapKind::emissive, "emissive", &Material::emissive_map, MapUse::always, true, "emissive_map"},
    {MapKind::occlusion, "occlusion", &Material::occlusion_map, MapUse::lit, false,
     "occlusion_map"},
    {MapKind::normal, "normal", &Material::normal_map, MapUse::normals, false, "normal_map"},
    {MapKind::metallic_roughness, "metallic-roughness", &Material::metallic_roughness_map,
     MapUse::metallic_roughness, false, nullptr},
    {MapKind::bump, "bump", &Material::bump_map, MapUse::not_drawn, false, "bump_map"},
    {MapKind::displacement, "displacement", &Material::displacement_map, MapUse::not_drawn, false,
     "displacement_map"},
};

// Metallic-roughness as Blinn-Phong, without 1/π as in MTL files (docs/conventions.md).
struct BlinnPhong {
    glm::vec3 diffuse{0.0f}, specular{0.0f};
    float shininess = 0;
};

// `base` linear, `metallic` and `roughness` 0…1. The exponent is that of the lobe as wide as the
// microfacet distribution of this roughness, 2/α² − 2 with α = roughness² (Karis 2013), at most
// 4998; the reflectance at normal incidence, 4 % for dielectrics and the base colour for metals, is
// spread over it by (shininess + 2)/8 + 1/(2 shininess + 4), so that the lobe as a whole reflects
// it: 0.931 to 1.013 times, whatever the roughness.
BlinnPhong blinn_phong(const glm::vec3& base, float metallic, float roughness);

}  // namespace prep
