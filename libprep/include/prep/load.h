// Loading any supported mesh file.
//
// Formats in: OBJ+MTL, PLY, STL, OFF, OM, glTF 2.0/GLB, JSON scenes (scene_json.h), and what Assimp
// reads for other endings. A loader says what the file says: no welding, no repair, no
// triangulation. Coordinates are parsed in double; set_positions() (mesh.h) decides about `origin`.
#pragma once

#include <filesystem>

#include "prep/result.h"
#include "prep/scene.h"

namespace prep {

struct LoadOptions {
    int threads = 0;  // 0: all cores; the result does not depend on it
};

// By ending, with a look at the first bytes where the ending is unknown.
// Errors: io, syntax (place = file:line or file#/json/path), unsupported, limit.
Result<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options = {});

}  // namespace prep
