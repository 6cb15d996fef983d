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

#include "prep/enum_names.h"
#include "prep/material.h"
#include "prep/mesh.h"
#include "prep/result.h"

namespace prep {

// What a loader keeps of its file, so that the writer of the same format loses nothing of it. Only
// that format knows what is in it.
struct RetainedFile {
    virtual ~RetainedFile() = default;
    // What else the file says of a mesh's part by the order of its triangles and vertices.
    virtual KeptOrder kept_order(std::size_t, std::size_t) const { return KeptOrder::none; }
};

struct ImageOptions;
struct ImageRef;

// A channel of a picture that is put together from others: maps that a file names one by one and
// glTF holds in one picture.
struct PackedChannel {
    std::shared_ptr<const ImageRef> source;  // null: `value` everywhere
    std::uint32_t channel = 0;               // of the source; `opacity`: its alpha, else its first
    bool inverted = false;                   // 1 − what is there
    float value = 1;
    static constexpr std::uint32_t opacity = 4;
};

// An image as the file refers to it; decoded only when a texture of the plan asks for it.
struct ImageRef {
    std::string name;                      // for messages
    std::filesystem::path path;            // set when it is a file of its own
    std::vector<std::byte> bytes;          // set when it is embedded (encoded: PNG, JPEG, …)
    std::filesystem::path read_from = {};  // the file that `bytes` came from, if it has one
    std::string mime_type;
    std::vector<PackedChannel> channels = {};  // put together from these: no path and no bytes
    // How it is decoded (image.h); null: in the caller's process. load_scene() sets it where it has
    // a process for the readers of other libraries.
    std::shared_ptr<const ImageOptions> options = nullptr;
};

// The files that a picture is read from; none where it is embedded.
std::vector<std::filesystem::path> files_of(const ImageRef& image);

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
    double xmag = 1, ymag = 1;      // orthographic half extents; xmag 0: as wide as the picture
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
    std::uint32_t parent = no_index;  // any other node; without cycles (loaders check)
    glm::dmat4 transform{1.0};        // to the parent
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

enum class Axis : std::uint8_t { x, y, z };
constexpr auto names_of(Axis) {
    return std::to_array<EnumName<Axis>>({{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}});
}

// How the numbers of a file became metres with y up. The nodes' transforms have it already.
struct Placement {
    // What the file says of itself: metres to one of its units, and in which words ("FBX
    // UnitScaleFactor 1"; empty: the file says nothing, and its unit is taken for a metre).
    double file_unit = 1;
    std::string file_unit_source;
    double scale = 1;   // asked for, on top of it
    Axis up = Axis::y;  // asked for: the axis that was turned to y
    double factor() const { return file_unit * scale; }
};

struct Scene {
    std::string name;
    std::filesystem::path source;                  // the file it came from
    std::vector<std::filesystem::path> libraries;  // other files read with it, but for images
    bool library_missing = false;                  // such a file was not there to be read
    // Where libraries and pictures were looked for before they were found elsewhere: a file that
    // appears there would be read in their place.
    std::vector<std::filesystem::path> passed_over;
    std::vector<Mesh> meshes;
    std::vector<Node> nodes;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<ImageRef> images;
    std::vector<Light> lights;
    std::vector<Camera> cameras;
    std::vector<Skin> skins;
    std::vector<Animation> animations;
    std::uint32_t active_camera = no_index;  // a node
    Placement placement;
    // The document that the scene was read from (glTF). Where it is there, glTF is written by
    // changing it: geometry that prepare() made anew, what place_scene() did. Nodes and meshes that
    // were edited, added or taken away are an error then; edits of positions, materials, cameras,
    // lights, skins and animations are not written. A program that edits those resets the pointer,
    // and the file is written from the scene alone. None: other writers need none.
    std::shared_ptr<const RetainedFile> retained_file;
    std::uint64_t source_bytes = 0;  // of the file and its buffers, where a limit depends on it
    std::vector<std::string>
        warnings;  // odd but usable: what the loader met and what it made of it
    // What a file says beside the model, and nothing here has a place for: authors, programs,
    // their settings, names.
    std::vector<std::string> remarks;
};

// For scenes that a program made or changed by hand: an error (invalid) that names the first list
// whose indices, sizes or offsets break what mesh.h and this header say of it, nodes that are their
// own ancestors among it. Loaders give no such scene; what functions make of one is not defined.
// O(scene).
Result<void> require_consistent(const Scene& scene);

// World transform of every node, parents applied first. O(nodes).
std::vector<glm::dmat4> world_transforms(const Scene& scene);

// What a linear transform does to normals: the cofactors in the determinant's sign, which flat ones
// have, too; else its transposed inverse but for a factor. The largest element is in [1, 2), so
// that squares stay in range however large or small the transform is. Zero where no direction is
// left, not finite where `linear` is not.
glm::dmat3 normal_matrix(const glm::dmat3& linear);

// Whether it turns faces round, however large or small it is; false for flat ones.
bool mirrors(const glm::dmat3& linear);

// Morph targets of all meshes.
std::size_t morph_target_count(const Scene& scene);

// Adds one node per mesh that no node uses (mesh files without a scene graph).
void instance_unused_meshes(Scene& scene);

// Scales the scene and turns its `up` axis to y (x to y about z, z to y about x), by a node above
// all others; the cameras' clip planes and the lights' ranges follow. `scale` is finite and over 0.
// Nothing is added where nothing changes. Once for a scene: Placement, and a document that is
// written back, hold one.
void place_scene(Scene& scene, double scale, Axis up);

}  // namespace prep
