// Scene: everything a file holds that shading can call for. Loaders fill it, prepare() obeys it,
// librast draws it.
#pragma once

#include <filesystem>
#include <glm/ext/quaternion_double.hpp>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "prep/mesh.h"

namespace prep {

// What a loader keeps of its file, so that the writer of the same format loses nothing of it. Only
// that format knows what is in it.
struct RetainedFile {
    virtual ~RetainedFile() = default;
};

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

// Scale first, then rotation, then translation: what animations move.
struct Trs {
    glm::dvec3 translation{0.0};
    glm::dquat rotation{1, 0, 0, 0};  // of unit length; w first
    glm::dvec3 scale{1.0};
    glm::dmat4 matrix() const;
};

struct Node {
    std::string name;
    std::uint32_t parent =
        no_index;               // always an earlier or later node, never cyclic (loaders check)
    glm::dmat4 transform{1.0};  // to the parent
    // Where the file gives the transform so: `transform` is its matrix. Empty: a matrix of its own.
    std::optional<Trs> trs;
    std::uint32_t mesh = no_index, camera = no_index, light = no_index, skin = no_index;
};

struct Skin {
    std::string name;
    std::vector<std::uint32_t> joints;    // nodes
    std::vector<glm::mat4> inverse_bind;  // one per joint
};

enum class Interpolation : std::uint8_t { linear, step, cubic_spline };
enum class AnimationPath : std::uint8_t { translation, rotation, scale, weights, other };

// Keys: values[i] stands at times[i]. A value is 3 numbers of a translation or scale, 4 of a
// rotation (x, y, z, w), one for each morph target of weights; a cubic spline's key is three of
// them: the tangent before, the value, the tangent after. Both null where the file's data are not
// there.
struct AnimationSampler {
    Interpolation interpolation = Interpolation::linear;
    std::shared_ptr<const std::vector<float>> times, values;  // seconds; samplers may share them
};

struct AnimationChannel {
    std::uint32_t sampler = 0;      // of the same animation
    std::uint32_t node = no_index;  // none: what `other` moves is known to the file alone
    AnimationPath path = AnimationPath::other;
};

// Carried for whoever plays it; nothing here does.
struct Animation {
    std::string name;
    std::vector<AnimationSampler> samplers;
    std::vector<AnimationChannel> channels;
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
    std::vector<Animation> animations;
    std::uint32_t active_camera = no_index;             // a node
    std::shared_ptr<const RetainedFile> retained_file;  // none: no writer needs it
    std::uint64_t source_bytes = 0;  // of the file and its buffers, where a limit depends on it
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

// Morph targets of all meshes.
std::size_t morph_target_count(const Scene& scene);

// Adds one node per mesh that no node uses (mesh files without a scene graph).
void instance_unused_meshes(Scene& scene);

}  // namespace prep
