// What is in a file, counted: before preparing and in what was written.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "prep/prepared_scene.h"
#include "prep/scene.h"

namespace meshprep {

// Names and figures, in the order in which they are shown.
struct Counts {
    std::vector<std::pair<std::string, std::uint64_t>> figures;
    std::vector<std::string> extensions;  // glTF: extensionsUsed
    const std::uint64_t* find(const std::string& name) const;
};

// The scene as loaded: meshes, vertices, faces, triangles, corners with normals, …
Counts count_scene(const prep::Scene& scene);
// What stands beside meshes, as far as there is any: morph targets, skins, animations and their
// channels, cameras, lights.
Counts count_parts(const prep::Scene& scene);
// The prepared meshes: vertices after splitting, triangles. `format`: an ending in lower case,
// without its dot. What has no nodes holds a mesh as often as they show it; materials and textures
// are those of glTF and OBJ.
Counts count_prepared(const prep::PreparedScene& prepared, const std::string& format);

// What a glTF or GLB file's own JSON says (nodes, skins, animations, morph targets, cameras,
// lights, extensions, …), independent of this project's loader; empty for other files and for JSON
// that cannot be read.
Counts count_gltf_file(const std::filesystem::path& path);

nlohmann::ordered_json to_json(const Counts& counts);

}  // namespace meshprep
