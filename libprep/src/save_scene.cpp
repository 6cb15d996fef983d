#include <cctype>

#include "gltf_document.h"
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

namespace {

// A mesh has them for faces alone; only glTF files keep those of their lines and points.
void note_loose_attributes(const PreparedScene& prepared, std::vector<std::string>& notes) {
    const GltfDocument* document = prepared.scene.document.get();
    if (!document) return;
    std::size_t count = 0;
    for (std::size_t m = 0; m < document->primitives.size(); ++m)
        for (std::size_t p = 0; p < document->primitives[m].size(); ++p) {
            if (document->primitives[m][p].triangles) continue;
            const Json& attributes = document->json["meshes"][m]["primitives"][p]["attributes"];
            bool any = false;
            for (const auto& item : attributes.items())
                any |= item.key() == "NORMAL" || item.key().starts_with("TEXCOORD_");
            count += any;
        }
    if (count > 0)
        notes.push_back(
            "normals and UVs of lines and points are kept in glTF files only: those of " +
            std::to_string(count) +
            (count == 1 ? " primitive were left out" : " primitives were left out"));
}

}  // namespace
}  // namespace detail

Result<std::vector<std::string>> save_scene(const PreparedScene& prepared,
                                            const std::filesystem::path& path,
                                            const SaveOptions& options) {
    std::string ending = path.extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    if (ending == ".glb" || ending == ".gltf") return detail::write_gltf(prepared, path, options);
    using Write = Result<std::vector<std::string>> (*)(
        const PreparedScene&, const std::filesystem::path&, const SaveOptions&);
    static constexpr std::pair<const char*, Write> others[] = {{".obj", detail::write_obj},
                                                               {".ply", detail::write_ply},
                                                               {".stl", detail::write_stl},
                                                               {".off", detail::write_off}};
    for (const auto& [name, write] : others) {
        if (ending != name) continue;
        auto notes = write(prepared, path, options);
        if (notes) detail::note_loose_attributes(prepared, *notes);
        return notes;
    }
    return Error{ErrorCode::unsupported,
                 "cannot write '" + ending + "': GLB, glTF, OBJ, PLY, STL and OFF are written",
                 path.string()};
}

}  // namespace prep
