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

#include "prep/material.h"
#include "prep/mesh.h"

namespace prep {

// What a loader keeps of its file, so that the writer of the same format loses nothing of it. Only
// that format knows what is in it.
struct RetainedFile {
    virtual ~RetainedFile() = default;
};

// An image as the file refers to it; decoded only when a texture of the plan asks for it.
struct ImageRef {
    std::string name;              // for messages
    std::filesystem::path path;    // set when it is a file of its own
    std::vector<std::byte> bytes;  // set when it is embedded (encoded: PNG, JPEG, …)
    std::string mime_type;
};

enum class LightKind : std::uint8_t { ambient, directional, point, spot };
constexpr auto names_of(LightKind) {
    return std::to_array<EnumName<LightKind>>({{"ambient", LightKind::ambient},
                                               {"directional", LightKind::directional},
                                               {"point", LightKind::point},
                                               {"spot", LightKind::spot}});
}

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

// World transform of every node, parents applied first. O(nodes).
std::vector<glm::dmat4> world_transforms(const Scene& scene);

// Morph targets of all meshes.
std::size_t morph_target_count(const Scene& scene);

// Adds one node per mesh that no node uses (mesh files without a scene graph).
void instance_unused_meshes(Scene& scene);

}  // namespace prep
