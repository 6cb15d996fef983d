// Writing a prepared scene: GLB, glTF, OBJ+MTL, PLY, STL, OFF, by ending.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "prep/enum_names.h"
#include "prep/prepared_scene.h"
#include "prep/result.h"

namespace prep {

// How glTF files store vertices and triangles.
enum class Compression : std::uint8_t {
    keep,     // as the glTF file that they came from; from others: as they are
    none,     // as they are
    draco,    // KHR_draco_mesh_compression: triangles
    meshopt,  // EXT_meshopt_compression: all but pictures
};
constexpr auto names_of(Compression) {
    return std::to_array<EnumName<Compression>>({{"keep", Compression::keep},
                                                 {"none", Compression::none},
                                                 {"draco", Compression::draco},
                                                 {"meshopt", Compression::meshopt}});
}

struct SaveOptions {
    bool ascii = false;   // PLY and STL: text instead of binary
    bool replace = true;  // whether files that exist are replaced; else they are an error
    // Whether files beside the output (.mtl, .bin, images) may replace files that were read for the
    // scene (its own .mtl, .bin, images); else that is an error.
    bool replace_sources = false;
    // Where not empty, asked of each file that is there already and would be replaced: true keeps
    // it, and is an error. For callers that know what else is read, by other inputs of a batch.
    std::function<bool(const std::filesystem::path& file)> spared = {};
    // Other formats have none: draco and meshopt are errors there. Values lose nothing, but where
    // Draco rounded them in the file that they came from: there they keep its steps.
    Compression compression = Compression::keep;
    // Where not null, the files that were written are added to it, the mesh itself last.
    std::vector<std::filesystem::path>* written = nullptr;
};

// All files of the output (the mesh, .mtl, .bin, copied images) appear complete or not at all.
// What the format cannot hold is listed in the returned notes ("STL holds no UVs: 1 set dropped").
// Errors: io, unsupported (ending), limit (the format's size limits).
Result<std::vector<std::string>> save_scene(const PreparedScene& prepared,
                                            const std::filesystem::path& path,
                                            const SaveOptions& options = {});

}  // namespace prep
