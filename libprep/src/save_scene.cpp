#include <cctype>

#include "prep/save.h"
#include "writers.h"

namespace prep {
namespace detail {

FileSetRules rules_for(const PreparedScene& prepared, const std::filesystem::path& path,
                       const SaveOptions& options) {
    FileSetRules rules;
    rules.replace = options.replace;
    rules.target = path;
    if (options.replace_sources) return rules;
    rules.spare = prepared.scene.libraries;
    if (!prepared.scene.source.empty()) rules.spare.push_back(prepared.scene.source);
    for (const ImageRef& image : prepared.scene.images)
        if (image.bytes.empty()) rules.spare.push_back(image.path);
    return rules;
}

void note_groups(const PreparedScene& prepared, const std::string& format,
                 std::vector<std::string>& notes) {
    std::size_t count = 0;
    for (const Mesh& mesh : prepared.scene.meshes)
        for (const std::string& part : mesh.parts) count += !part.empty();
    if (count > 0)
        notes.push_back(format + " holds no groups within a mesh: " + std::to_string(count) +
                        (count == 1 ? " name was left out" : " names were left out"));
}

}  // namespace detail

Result<std::vector<std::string>> save_scene(const PreparedScene& prepared,
                                            const std::filesystem::path& path,
                                            const SaveOptions& options) {
    std::string ending = path.extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    if (ending == ".glb" || ending == ".gltf") return detail::write_gltf(prepared, path, options);
    if (ending == ".obj") return detail::write_obj(prepared, path, options);
    if (ending == ".ply") return detail::write_ply(prepared, path, options);
    if (ending == ".stl") return detail::write_stl(prepared, path, options);
    if (ending == ".off") return detail::write_off(prepared, path, options);
    return Error{ErrorCode::unsupported,
                 "cannot write '" + ending + "': GLB, glTF, OBJ, PLY, STL and OFF are written",
                 path.string()};
}

}  // namespace prep
