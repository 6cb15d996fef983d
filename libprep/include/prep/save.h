// Writing a prepared scene: GLB, glTF, OBJ+MTL, PLY, STL, OFF, by ending.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "prep/prepare.h"
#include "prep/result.h"

namespace prep {

struct SaveOptions {
    bool ascii = false;  // PLY and STL: text instead of binary
};

// All files of the output (the mesh, .mtl, .bin, copied images) appear complete or not at all.
// What the format cannot hold is listed in the returned notes ("STL holds no UVs: 1 set dropped").
// Errors: io, unsupported (ending), limit (the format's size limits).
Result<std::vector<std::string>> save_scene(const PreparedScene& prepared,
                                            const std::filesystem::path& path,
                                            const SaveOptions& options = {});

}  // namespace prep
