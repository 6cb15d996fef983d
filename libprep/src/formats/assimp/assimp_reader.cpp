#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <strings.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <exception>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>

#include "formats/assimp/import.h"
#include "formats/assimp/model_files.h"
#include "formats/assimp/texts/amf_text.h"
#include "formats/assimp/texts/dxf_text.h"
#include "formats/assimp/texts/md5_numbers.h"
#include "formats/assimp/texts/utf16.h"
#include "formats/assimp/texts/x3d_text.h"
#include "formats/assimp/texts/xml_tags.h"
#include "formats/assimp/threemf/model_review.h"
#include "formats/reader_backend.h"
#include "prep/files.h"
#include "text/lower_case.h"
#include "text/name_list.h"

namespace prep::detail {
namespace {

// Texts in place of the file's are opened by a name of Assimp's own, others by the absolute path.
bool is_opened_by(const std::string& name, const std::filesystem::path& path) {
    std::error_code ec;
    return name.starts_with(AI_MEMORYIO_MAGIC_FILENAME) ||
           name == std::filesystem::absolute(path, ec).string();
}

// Assimp's complaint, with the file as it was asked for.
std::string complaint(std::string text, const std::filesystem::path& path) {
    std::error_code ec;
    for (const std::string& name :
         {AI_MEMORYIO_MAGIC_FILENAME + path.extension().string(),
          std::string(AI_MEMORYIO_MAGIC_FILENAME) + "." + path.extension().string(),
          std::filesystem::absolute(path, ec).string()})
        if (const std::size_t at = text.find(name); at != std::string::npos)
            text.replace(at, name.size(), path.string());
    return "Assimp: " + text;
}

// Skins, animations, cameras and lights are told by the names of nodes: nodes come before them.
Result<Scene> read_scene(aiScene& from, const std::filesystem::path& path,
                         const LoadOptions& options, const PackageParts* package) {
    AssimpImport import{from, path, {}, {}, join_split_meshes(from), package};
    import.scene.name = path.filename().string();
    import_materials(import, options);
    import_sides(import);
    if (auto done = import_meshes(import); !done) return std::move(done).error();
    settle_uv_sets(import);
    if (auto done = import_nodes(import); !done) return std::move(done).error();
    // X3D's root has the name by which the file was opened.
    std::vector<Node>& nodes = import.scene.nodes;
    if (!nodes.empty() && is_opened_by(nodes[0].name, path)) nodes[0].name = import.scene.name;
    import_units(import);
    import_skins(import);
    share_vertices_of_corners(import);
    import_animations(import);
    import_cameras_and_lights(import);
    count_what_is_not_kept(import);
    return std::move(import.scene);
}

std::optional<std::string> text_of_utf16_file(const std::filesystem::path& path) {
    std::array<std::byte, 2> head{};
    std::ifstream in(path, std::ios::binary);
    if (!in.read(reinterpret_cast<char*>(head.data()), head.size()) || !utf8_of_utf16(head))
        return std::nullopt;
    const auto bytes = read_file(path);
    return bytes ? utf8_of_utf16(*bytes) : std::nullopt;
}

// The file's, which `bytes` then holds, or what it was converted to.
Result<std::string_view> text_of(const std::filesystem::path& path,
                                 const std::optional<std::string>& converted,
                                 std::vector<std::byte>& bytes) {
    if (converted) return std::string_view(*converted);
    auto read = read_file(path);
    if (!read) return read.error();
    bytes = *std::move(read);
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

// Numbers that Assimp does not survive, as far as they are beyond the file. `converted`: the text
// that Assimp is given in place of the file's.
Result<void> check_md5_numbers(const std::filesystem::path& path,
                               const std::optional<std::string>& converted) {
    if (::strcasecmp(path.extension().c_str(), ".md5mesh") != 0) return {};
    std::vector<std::byte> bytes;
    const auto text = text_of(path, converted, bytes);
    if (!text) return text.error();
    const auto excess = md5_excess(*text);
    if (!excess) return {};
    return Error{ErrorCode::invalid,
                 "'" + excess->statement + "' is beyond what a file of " +
                     std::to_string(text->size()) + " bytes can hold",
                 path.string() + ':' + std::to_string(excess->line)};
}

// Assimp names lights of X3D that have no name by where they lie in memory: another in each run.
void drop_addresses(std::string_view text, Scene& scene) {
    const auto drop = [&](std::string& name) {
        for (const std::string_view kind : {"DirectionalLight", "PointLight", "SpotLight"})
            if (name.starts_with(kind) && name.size() > kind.size() + 1 &&
                name[kind.size()] == '_' &&
                name.find_first_not_of("0123456789", kind.size() + 1) == std::string::npos &&
                text.find(name) == std::string_view::npos)
                name = kind;
    };
    for (Node& node : scene.nodes)
        if (node.light != no_index) drop(node.name);
    for (Light& light : scene.lights) drop(light.name);
}

// What Assimp is given in place of the file's text, where it would misread that.
std::optional<std::string> text_for_assimp(std::string_view ending, std::string_view text) {
    if (ending == ".amf") return with_one_volume_a_mesh(text);
    if (ending == ".dxf") return with_positive_corners(text);
    if (ending == ".x3d") return with_plain_urls(text);
    return std::nullopt;
}

// Assimp knows no shininess of X3D, which goes to 1 (ISO/IEC 19775-1, 17.2.2.4: 128 of an
// exponent), and no side of a surface: a material is two-sided where one of its file's is.
void settle_x3d_materials(std::string_view xml, Scene& scene) {
    const bool open = has_open_surfaces(xml);
    for (Material& m : scene.materials) {
        if (m.shininess <= 1) m.shininess *= 128;
        m.double_sided |= open;
    }
}

// Materials that no file has: colours of vertices are not to be tinted by them.
void whiten_invented_materials(Scene& scene) {
    const bool colored = std::any_of(scene.meshes.begin(), scene.meshes.end(), [](const Mesh& m) {
        return !m.colors.empty() || !m.vertex_colors.empty();
    });
    for (Material& m : scene.materials)
        if (colored && m.name == AI_DEFAULT_MATERIAL_NAME) {
            m = Material{};
            m.name = AI_DEFAULT_MATERIAL_NAME;
            m.diffuse = glm::vec4(1.0f);
        }
}

// What the file's own text says beside what Assimp has read.
void look_at_text(const std::filesystem::path& path, const std::optional<std::string>& converted,
                  Scene& scene) {
    const std::string ending = lower_case(path.extension().string());
    if (ending == ".3mf")
        scene.remarks.emplace_back(
            "Assimp reads no colours of triangles, no transparency and no unit of 3MF files");
    if (ending == ".amf")
        scene.remarks.emplace_back(
            "Assimp reads no unit of AMF files, and of their materials the colours, as those of "
            "vertices");
    if (ending != ".x3d" && ending != ".amf" && ending != ".dae" && ending != ".dxf") return;
    std::vector<std::byte> bytes;
    const auto text = text_of(path, converted, bytes);
    if (!text) return;  // no error: Assimp has read it a moment ago
    std::vector<std::string> sentences;
    if (ending == ".amf") {
        sentences = misread_of_amf(*text);
        settle_amf_colors(scene);
    } else if (ending == ".dxf") {
        sentences = misread_of_dxf(*text);
        settle_dxf_colors(*text, scene);
    } else if (ending == ".x3d") {
        sentences = misread_of_x3d(*text);
        drop_addresses(*text, scene);
        settle_x3d_materials(*text, scene);
    } else if (text->find("<morph") != std::string_view::npos && has_element(*text, "morph") &&
               std::all_of(scene.meshes.begin(), scene.meshes.end(),
                           [](const Mesh& mesh) { return mesh.morph_targets.empty(); })) {
        sentences.emplace_back(
            "Assimp reads nothing of morph controllers: their meshes are missing");
    }
    if (ending == ".amf" || ending == ".dxf") whiten_invented_materials(scene);
    std::move(sentences.begin(), sentences.end(), std::back_inserter(scene.warnings));
}

void take_files(const ModelFiles& files, Scene& scene) {
    scene.libraries = files.read();
    const auto tell = [&](const std::vector<std::string>& missing, const char* what) {
        NameList names;
        for (const std::string& name : missing) names.add(name);
        if (names.empty()) return;
        scene.library_missing = true;
        scene.warnings.push_back(what + names.text());
    };
    tell(files.missing(), "files that the model names are not there: ");
    tell(files.missing_scripts(), "the model's material script is not there: none of ");
}

std::unique_ptr<Assimp::Importer> make_importer(ModelFiles& files) {
    auto importer = std::make_unique<Assimp::Importer>();
    importer->SetIOHandler(files.make_handler());
    // Pivots come as nodes of their own, which are resolved here: without them, Assimp animates
    // nodes that it does not make. No meshes of bones where the file has none.
    importer->SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, true);
    importer->SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    // A player's legs are one file: the trunk and the head are others.
    importer->SetPropertyBool(AI_CONFIG_IMPORT_MD3_HANDLE_MULTIPART, false);
    return importer;
}

}  // namespace

bool assimp_knows(const std::string& extension) {
    Assimp::Importer importer;
    return importer.IsExtensionSupported(extension);
}

Result<Scene> read_with_assimp(const std::filesystem::path& path, const LoadOptions& options) {
    std::optional<std::string> converted = text_of_utf16_file(path);
    const bool is_utf16 = converted.has_value();
    if (auto checked = check_md5_numbers(path, converted); !checked)
        return std::move(checked).error();
    const std::string ending = lower_case(path.extension().string());
    if (ending == ".amf" || ending == ".dxf" || ending == ".x3d") {
        std::vector<std::byte> bytes;
        const auto text = text_of(path, converted, bytes);
        if (!text) return text.error();
        if (auto other = text_for_assimp(ending, *text)) converted = std::move(other);
    }
    std::optional<PackageReview> package;
    if (ending == ".3mf") {
        auto review = review_package(path);
        if (!review) return std::move(review).error();
        package = *std::move(review);
    }
    try {
        ModelFiles files(path);
        std::unique_ptr<Assimp::Importer> importer = make_importer(files);
        // Only what keeps the file as it is: no joining, no triangulation, no generated normals,
        // no limit to the number of weights. Where a material says that its pictures lie around the
        // mesh like a sphere, a cylinder or a plane, UVs say so.
        constexpr unsigned validated = aiProcess_ValidateDataStructure,
                           steps = aiProcess_GenUVCoords;
        const auto read_by = [&](unsigned how) {
            return converted ? importer->ReadFileFromMemory(converted->data(), converted->size(),
                                                            how, ending.c_str() + !ending.empty())
                             : importer->ReadFile(files.model().string(), how);
        };
        const aiScene* scene = read_by(validated | steps);
        // Motion alone (BVH) is no error, but for Assimp's validation. Its reader of BVH goes on
        // where it ended, so that another has to begin.
        if (!scene && std::string_view(importer->GetErrorString()).find("mNumMeshes is 0") !=
                          std::string_view::npos) {
            importer = make_importer(files);
            scene = read_by(steps);
        }
        if (!scene || !scene->mRootNode)
            return Error{ErrorCode::syntax,
                         complaint(importer->GetErrorString(), path) +
                             (ending == ".blend" ? "; what newer versions of Blender save is not "
                                                   "read: export glTF from it"
                                                 : ""),
                         path.string()};
        const std::unique_ptr<aiScene> own(importer->GetOrphanedScene());
        auto read = read_scene(*own, path, options, package ? &package->parts : nullptr);
        if (read) look_at_text(path, converted, *read);
        if (read && package)
            std::move(package->warnings.begin(), package->warnings.end(),
                      std::back_inserter(read->warnings));
        if (read) take_files(files, *read);
        if (read && is_utf16)
            read->warnings.insert(read->warnings.begin(),
                                  "the file is in UTF-16, which its reader "
                                  "does not know: read as UTF-8");
        return read;
    } catch (const std::exception& e) {
        return Error{ErrorCode::syntax, std::string("Assimp: ") + e.what(), path.string()};
    }
}

}  // namespace prep::detail
