#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include "formats/foreign_files.h"
#include "formats/gltf/gltf.h"
#include "formats/obj/obj.h"
#include "formats/off/off.h"
#include "formats/ply/ply.h"
#include "formats/stl/stl.h"
#include "prep/files.h"
#include "prep/load.h"
#include "prep/scene_json.h"

namespace prep {
namespace {

std::string lower_extension(const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

// What the first bytes say, for files without a telling ending.
std::string sniff(std::span<const std::byte> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                                std::min<std::size_t>(bytes.size(), 512));
    if (text.starts_with("glTF")) return ".glb";
    if (text.starts_with("ply")) return ".ply";
    if (text.starts_with("solid")) return ".stl";
    const std::string_view first = text.substr(0, text.find_first_of(" \r\n"));
    if (first.ends_with("OFF") && first.size() <= 8) return ".off";
    if (text.find("\nv ") != std::string_view::npos || text.starts_with("v ")) return ".obj";
    if (text.find("\"asset\"") != std::string_view::npos) return ".gltf";
    return {};
}

Result<Scene> load_by_ending(const std::string& ending, const std::filesystem::path& path,
                             const LoadOptions& options) {
    if (ending == ".obj") return load_obj(path, options.threads);
    if (ending == ".gltf" || ending == ".glb" || ending == ".vrm") return load_gltf(path, options);
    const bool ours = ending == ".ply" || ending == ".stl" || ending == ".off" || ending == ".om";
    if (ours) {
        const auto bytes = read_file(path);
        if (!bytes) return bytes.error();
        const std::string name = path.filename().string();
        if (ending == ".ply") return parse_ply(*bytes, name);
        if (ending == ".stl") return parse_stl(*bytes, name);
        if (ending == ".off") return parse_off(*bytes, name);
        return detail::load_om(*bytes, path);
    }
    if (ending == ".json") {
        auto loaded = load_scene_json(path, options);
        if (!loaded) return loaded.error();
        return std::move(loaded->scene);
    }
    if (detail::assimp_reads(ending)) return detail::load_with_assimp(path);
    return Error{ErrorCode::unsupported,
                 "unknown file type '" + ending +
                     "': OBJ, PLY, STL, OFF, OM, glTF, GLB, JSON scenes and the formats of Assimp "
                     "(FBX, DAE, 3DS, …) are read",
                 path.string()};
}

// Decimal coordinates can be finite and yet beyond what a float holds.
void warn_of_infinities(Scene& scene) {
    std::uint64_t count = 0;
    for (const Mesh& mesh : scene.meshes)
        for (const glm::vec3& p : mesh.positions)
            count += std::isinf(p.x) || std::isinf(p.y) || std::isinf(p.z);
    if (count > 0)
        scene.warnings.push_back(std::to_string(count) +
                                 (count == 1 ? " vertex is" : " vertices are") +
                                 " infinite, or beyond the range of float (3.4e38)");
}

}  // namespace

Result<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options) {
    std::error_code ec;
    const auto status = std::filesystem::status(path, ec);
    if (!std::filesystem::exists(status))
        return Error{ErrorCode::io, "no such file", path.string()};
    if (std::filesystem::is_directory(status))
        return Error{ErrorCode::io, "this is a directory; name a file", path.string()};
    std::string ending = lower_extension(path);
    if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, ec) == 0)
        return Error{ErrorCode::syntax, "the file is empty", path.string()};
    static constexpr std::string_view known[] = {".obj", ".gltf", ".glb", ".vrm", ".json",
                                                 ".ply", ".stl",  ".off", ".om"};
    if (std::find(std::begin(known), std::end(known), ending) == std::end(known) &&
        !detail::assimp_reads(ending)) {
        const auto bytes = read_file(path);
        if (!bytes) return bytes.error();
        const std::string guess = sniff(*bytes);
        if (!guess.empty()) ending = guess;
    }
    auto scene = load_by_ending(ending, path, options);
    if (!scene) return scene;
    scene->source = path;
    warn_of_infinities(*scene);
    return scene;
}

}  // namespace prep
