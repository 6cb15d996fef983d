// Writing a prepared scene: GLB, glTF, OBJ+MTL, PLY, STL, OFF, by ending.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "prep/prepared_scene.h"
#include "prep/result.h"

namespace prep {

struct SaveOptions {
    bool ascii = false;   // PLY and STL: text instead of binary
    bool replace = true;  // whether files that exist are replaced; else they are an error
    // Whether files beside the output (.mtl, .bin, images) may replace files that were read for the
    // scene (its own .mtl, .bin, images); else that is an error.
    bool replace_sources = false;
};

// All files of the output (the mesh, .mtl, .bin, copied images) appear complete or not at all.
// What the format cannot hold is listed in the returned notes ("STL holds no UVs: 1 set dropped").
// Errors: io, unsupported (ending), limit (the format's size limits).
Result<std::vector<std::string>> save_scene(const PreparedScene& prepared,
                                            const std::filesystem::path& path,
                                            const SaveOptions& options = {});

}  // namespace prep
