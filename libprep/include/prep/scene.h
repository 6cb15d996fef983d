// Scene: everything a file holds that shading can call for. Loaders fill it, prepare() obeys it,
// librast draws it.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "prep/mesh.h"

namespace prep {

class GltfDocument;  // the retained glTF file (gltf.h): what we do not understand is written back

enum class Wrap : std::uint8_t { repeat, mirror, clamp, border };
enum class Filter : std::uint8_t { nearest, linear };
enum class MipFilter : std::uint8_t { none, nearest, linear };

// An image as the file refers to it; decoded only when a texture of the plan asks for it.
struct ImageRef {
    std::string name;              // for messages
    std::filesystem::path path;    // set when it is a file of its own
    std::vector<std::byte> bytes;  // set when it is embedded (encoded: PNG, JPEG, …)
    std::string mime_type;
};

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
enum class NormalMapSpace : std::uint8_t { tangent, object };

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

enum class LightKind : std::uint8_t { ambient, directional, point, spot };

// Lights shine along their node's −Z (directional, spot) from its origin (point, spot), as in
// KHR_lights_punctual. Point and spot fall off with 1/r².
struct Light {
    std::string name;
    LightKind kind = LightKind::directional;
    glm::vec3 color{1.0f};  // linear
    float intensity = 1;
    float range = 0;                                  // 0: no limit
    float inner_cone = 0, outer_cone = 0.785398163f;  // radians from the axis
};

struct Camera {
    std::string name;
    bool perspective = true;
    double yfov = 0.8;              // radians
    double aspect = 0;              // 0: take the picture's
    double xmag = 1, ymag = 1;      // orthographic half extents
    double znear = 0.01, zfar = 0;  // zfar 0: infinite
};

struct Node {
    std::string name;
    std::uint32_t parent =
        no_index;               // always an earlier or later node, never cyclic (loaders check)
    glm::dmat4 transform{1.0};  // to the parent
    std::uint32_t mesh = no_index, camera = no_index, light = no_index, skin = no_index;
};

struct Skin {
    std::string name;
    std::vector<std::uint32_t> joints;    // nodes
    std::vector<glm::mat4> inverse_bind;  // one per joint
};

struct Scene {
    std::string name;
    std::filesystem::path source;                  // the file it came from
    std::vector<std::filesystem::path> libraries;  // other files read with it, but for images
    std::vector<Mesh> meshes;
    std::vector<Node> nodes;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<ImageRef> images;
    std::vector<Light> lights;
    std::vector<Camera> cameras;
    std::vector<Skin> skins;
    std::uint32_t active_camera = no_index;        // a node
    std::shared_ptr<const GltfDocument> document;  // set when the source was glTF
    std::vector<std::string>
        warnings;  // odd but usable: what the loader met and what it made of it
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

// World transform of every node, parents applied first. O(nodes).
std::vector<glm::dmat4> world_transforms(const Scene& scene);

// Morph targets of all meshes; of a mesh with several parts, the most that one of them has.
std::size_t morph_target_count(const Scene& scene);

// Adds one node per mesh that no node uses (mesh files without a scene graph).
void instance_unused_meshes(Scene& scene);

}  // namespace prep
