// Materials: how surfaces answer to light, and the textures that vary it.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

// What a displacement map holds: heights along the normal, or vectors in three channels, in the
// frame of the surface or in the mesh's own space (docs/displacement.md).
enum class DisplacementKind : std::uint8_t { height, vector_tangent, vector_object };
constexpr auto names_of(DisplacementKind) {
    return std::to_array<EnumName<DisplacementKind>>(
        {{"height", DisplacementKind::height},
         {"vector-tangent", DisplacementKind::vector_tangent},
         {"vector-object", DisplacementKind::vector_object}});
}

// Blinn-Phong parameters, linear colour. In a metallic-roughness material `diffuse` is the base
// colour and `diffuse_map` its map; the renderer derives diffuse, specular and shininess from
// metallic, roughness and reflectance at each pixel (docs/conventions.md), so `specular` and
// `shininess` are not read; `specular_map` multiplies the reflectance.
struct Material {
    std::string name;
    glm::vec3 ambient{1.0f};  // multiplies the ambient light (times diffuse colour)
    glm::vec4 diffuse{0.8f, 0.8f, 0.8f, 1.0f};  // a = opacity
    glm::vec3 specular{0.2f};
    float shininess = 32;  // Blinn-Phong exponent
    glm::vec3 emissive{0.0f};
    TextureRef diffuse_map, specular_map, emissive_map, occlusion_map;
    // bump_map: heights along the normal, its first channel times its strength in units of the
    // mesh, that light falls on and no silhouette shows (Blinn 1978); on top of a normal map, if
    // there is one.
    TextureRef normal_map, bump_map, displacement_map;
    NormalMapSpace normal_map_space = NormalMapSpace::tangent;
    bool normal_map_flip_green = false;  // true for maps whose green points down
    // Displacement in units of the mesh: (texel − midlevel) · scale · the map's strength.
    float displacement_scale = 1, displacement_midlevel = 0.5f;
    DisplacementKind displacement_kind = DisplacementKind::height;
    bool unlit = false;
    // glTF's, for renderers that draw such layers: a clearcoat's normal map, or that of another
    // extension; KHR_materials_anisotropy, whose directions are the tangents' too.
    TextureRef layer_normal_map, anisotropy_map;
    float anisotropy = 0;

    bool metallic_roughness = false;
    float metallic = 1, roughness = 1;
    TextureRef metallic_roughness_map;
    // What a dielectric of metallic-roughness reflects of light that falls straight in: F0.
    glm::vec3 reflectance{0.04f};
    // Layers for files that hold them (glTF's extensions, the PBR statements of MTL); not drawn.
    float clearcoat = 0, clearcoat_roughness = 0;
    glm::vec3 sheen{0.0f};
    float sheen_roughness = 0;
    float anisotropy_rotation = 0;  // radians, counter-clockwise from the tangent

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
    displacement,
    layer_normal,
    anisotropy
};

// Which materials a map has an effect on when they are drawn.
enum class MapUse : std::uint8_t {
    always,
    lit,                 // not unlit ones
    metallic_roughness,  // lit ones with it
    normals,             // lit ones, with normals as they are asked for
    not_drawn
};

struct MaterialMap {
    MapKind kind;
    const char* name;  // "diffuse": in texts "diffuse map"
    TextureRef Material::*ref;
    MapUse use;
    bool color;                     // stored sRGB-encoded; else data
    const char* scene_key;          // in scene files; null: none
    bool in_tangent_frame = false;  // what it says is relative to tangent, bitangent and normal
};

// In the order of MapKind; those that are drawn come first.
inline constexpr MaterialMap material_maps[] = {
    {MapKind::diffuse, "diffuse", &Material::diffuse_map, MapUse::always, true, "diffuse_map"},
    {MapKind::specular, "specular", &Material::specular_map, MapUse::lit, true, "specular_map"},
    {MapKind::emissive, "emissive", &Material::emissive_map, MapUse::always, true, "emissive_map"},
    {MapKind::occlusion, "occlusion", &Material::occlusion_map, MapUse::lit, false,
     "occlusion_map"},
    {MapKind::normal, "normal", &Material::normal_map, MapUse::normals, false, "normal_map", true},
    {MapKind::metallic_roughness, "metallic-roughness", &Material::metallic_roughness_map,
     MapUse::metallic_roughness, false, nullptr},
    {MapKind::bump, "bump", &Material::bump_map, MapUse::normals, false, "bump_map"},
    {MapKind::displacement, "displacement", &Material::displacement_map, MapUse::not_drawn, false,
     "displacement_map"},
    {MapKind::layer_normal, "layer normal", &Material::layer_normal_map, MapUse::not_drawn, false,
     nullptr, true},
    {MapKind::anisotropy, "anisotropy", &Material::anisotropy_map, MapUse::not_drawn, false,
     nullptr, true},
};

// Whether the material has this map and shading needs tangents for it.
inline bool calls_for_tangents(const Material& material, const MaterialMap& map) {
    return map.in_tangent_frame && material.*map.ref && !material.unlit &&
           (map.kind != MapKind::normal || material.normal_map_space == NormalMapSpace::tangent);
}

// Whether anything of the material does; anisotropy does without a map as well.
inline bool calls_for_tangents(const Material& material) {
    for (const MaterialMap& map : material_maps)
        if (calls_for_tangents(material, map)) return true;
    return material.anisotropy != 0 && !material.unlit;
}

// Metallic-roughness as Blinn-Phong, without 1/π as in MTL files (docs/conventions.md).
struct BlinnPhong {
    glm::vec3 diffuse{0.0f}, specular{0.0f};
    float shininess = 0;
};

// `base` linear, `metallic` and `roughness` 0…1. The exponent is that of the lobe as wide as the
// microfacet distribution of this roughness, 2/α² − 2 with α = roughness² (Karis 2013), at most
// 4998; the reflectance at normal incidence, 4 % for dielectrics unless told and the base colour
// for metals, is spread over it by highlight_spread(), so that the lobe as a whole reflects it:
// 0.931 to 1.013 times, whatever the roughness.
BlinnPhong blinn_phong(const glm::vec3& base, float metallic, float roughness,
                       const glm::vec3& reflectance = glm::vec3(0.04f));

// (shininess + 2)/8 + 1/(2 shininess + 4): what a highlight of reflectance 1 has for its colour.
// Exponents below 0 count as 0.
float highlight_spread(float shininess);

// The inverse of blinn_phong() for dielectrics: the reflectance is specular / spread, each channel
// at most 1, which highlights of small exponents would exceed; roughness⁴ = 2/(shininess + 2).
struct Dielectric {
    glm::vec3 reflectance{0.04f};
    float roughness = 1;
};
Dielectric dielectric(const glm::vec3& specular, float shininess);

// The specular colour of an ordinary dielectric, which reflects 4 %: for files that do not say
// theirs. At most 1.
glm::vec3 usual_specular(float shininess);

struct Scene;

// Extensions of materials in the document that the scene came from, if it came from any, of which
// Material holds nothing, or no maps: other formats lose them. Each once, ascending.
std::set<std::string> extensions_beyond_materials(const Scene& scene);

// What other renderers draw a glTF material by and Material does not hold: the numbers of
// KHR_materials_transmission, _volume, _iridescence, _dispersion and _diffuse_transmission, by
// their names and in one order for all materials, those of their specifications where the document
// says none; a texture counts 1 where it is there.
std::vector<std::pair<std::string_view, double>> undrawn_numbers(const Scene& scene,
                                                                 std::uint32_t material);

}  // namespace prep
