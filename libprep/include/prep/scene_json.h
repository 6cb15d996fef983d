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

#include "prep/load.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace prep {

// What a scene file asks of the picture; what it leaves open is the renderer's to choose. The names
// are those of `meshprep render`'s options.
struct PictureSettings {
    std::optional<glm::uvec2> size;         // pixels, each 1 … 32768
    std::optional<std::string> shading;     // flat, gouraud, phong, normal-mapped
    std::optional<glm::vec3> background;    // linear
    std::optional<std::string> cull;        // by-material, back, front, none
    std::optional<std::string> filter;      // the words of `meshprep render --filter`
    std::optional<int> samples;             // a pixel: 1, 2, 4, 8, 16; not beside coverage by area
    std::optional<int> supersample;         // 1 … 16
    std::optional<std::string> coverage;    // samples, area
    std::optional<int> max_anisotropy;      // 1 … 16
    std::optional<std::string> tone_map;    // off, reinhard
    std::optional<double> exposure;         // 1e-6 … 1e6
    std::optional<double> orbit_azimuth;    // radians; a camera that circles the scene and is
    std::optional<double> orbit_elevation;  // … set only where the file's camera says "orbit"
    std::optional<double> orbit_distance;   // in multiples of the distance that fits the scene
};

struct JsonScene {
    Scene scene;
    PictureSettings picture;
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

}  // namespace prep
