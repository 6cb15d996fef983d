// Wavefront OBJ and MTL, with the subdivision tags ("t" lines) of OpenSubdiv's regression shapes.
//
// Read: v (with w or colours), vt, vn, f (n-gons, negative indices), l, p, o, g, s, usemtl, mtllib,
// t; comments, line continuations, CRLF. Free-form geometry is skipped with a warning.
// vt's origin is the bottom left, ours the top left: v becomes 1 − v, computed in double.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "prep/load.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace prep {

namespace detail {
class PictureSearch;
}

struct ObjOptions {
    std::string name = "memory.obj";  // for messages
    std::filesystem::path directory;  // where .mtl files and textures are looked up
    std::vector<std::filesystem::path> texture_directories = {};
    bool read_materials = true;
    int threads = 0;
};

// One mesh, its materials, one node. Errors: syntax (a number or a statement that is none), invalid
// (an index out of range), limit; place = "name:line". The result is the same for any thread count.
Result<Scene> parse_obj(std::span<const std::byte> bytes, const ObjOptions& options = {});
Result<Scene> load_obj(const std::filesystem::path& path, const LoadOptions& options = {});

struct MtlLibrary {
    std::vector<Material> materials;  // texture indices are into `textures`
    std::vector<Texture> textures;
    std::vector<ImageRef> images;
    std::vector<std::string> warnings;
};

// Never fails: what cannot be understood is a warning with its line. Pictures that are missing are
// left to the search's own warnings().
MtlLibrary parse_mtl(std::string_view text, const std::string& name,
                     detail::PictureSearch& pictures);
// With a search of its own, whose warnings are among the library's.
MtlLibrary parse_mtl(std::string_view text, const std::string& name,
                     const std::filesystem::path& directory);

}  // namespace prep
