// The JSON scene: meshes, materials, textures, nodes, lights, a camera and the picture to be made,
// in one small file that people write by hand. docs/scene-format.md describes every key.
//
// What goes wrong is placed by JSON pointer ("room.json#/nodes/2/mesh") or, where the text is not
// JSON at all, by line and column ("room.json:12:5").
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "prep/load.h"
#include "prep/render_choices.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace prep {

// A camera that circles the scene.
struct OrbitCamera {
    double azimuth = 0, elevation = 0;  // radians
    double distance = 1;                // in multiples of the distance that fits the scene
    std::optional<double> yfov;         // radians
    std::optional<double> height;       // without perspective: world units from bottom to top
    std::optional<double> znear, zfar;  // zfar 0: none; unset: as they fit the scene
};

// What a scene file says of a mesh file.
struct JsonMeshFile {
    std::filesystem::path file;
    std::uint32_t material = no_index;  // of JsonScene::scene, for every face; none: the file's own
    // Names of the file's materials, and what is in their place.
    std::vector<std::pair<std::string, std::uint32_t>> replaced = {};
};

struct JsonScene {
    Scene scene;
    std::vector<JsonMeshFile> mesh_files;  // those that are placed
    RenderWishes picture;                  // what is left open is the renderer's to choose
    std::optional<OrbitCamera> orbit;      // where the file's camera says so
};

// Referenced files are relative to the scene file. A mesh file brings its meshes, nodes and
// materials; its own lights, cameras and skins are not taken (a note in Scene::warnings says so),
// nor are animations. Errors: io (a file is missing), syntax (not JSON, a repeated key),
// invalid (unknown key, wrong type, out of range, missing or cyclic reference), unsupported (a
// later version of the format), limit (over 64 MiB, generated shapes with over 2^24 faces in
// all), and those of the mesh files. O(text) and the meshes.
Result<JsonScene> load_scene_json(const std::filesystem::path& path,
                                  const LoadOptions& options = {});
// The same of a scene in memory; `path` is its name in messages and where references start.
Result<JsonScene> parse_scene_json(std::string_view text, const std::filesystem::path& path,
                                   const LoadOptions& options = {});
// Without the meshes of mesh files, which are not opened and need not be there: their nodes, their
// materials and warnings are missing. For who asks what the scene file itself says. Errors: as
// above, but for those of mesh files and of names of their materials.
Result<JsonScene> load_scene_json_alone(const std::filesystem::path& path);

}  // namespace prep
