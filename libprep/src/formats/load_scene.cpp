#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>

#include "base/finite.h"
#include "contained/pictures.h"
#include "contained/reader_process.h"
#include "formats/registry.h"
#include "formats/transparency.h"
#include "prep/files.h"
#include "prep/load.h"

namespace prep {
namespace {

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

// Faces, lines and points, and those of them that can be somewhere: looked for until one is found.
// Scenes of programs may name vertices that are not there.
struct Elements {
    bool any = false, finite = false;
};
Elements elements_of(const Mesh& mesh) {
    Elements found;
    const auto look = [&](std::span<const std::uint32_t> vertices) {
        found.any |= !vertices.empty();
        found.finite |=
            !vertices.empty() &&
            std::all_of(vertices.begin(), vertices.end(), [&](std::uint32_t v) {
                return v < mesh.positions.size() && detail::is_finite(mesh.positions[v]);
            });
    };
    const auto look_at_all = [&](const std::vector<std::uint32_t>& offsets,
                                 const std::vector<std::uint32_t>& vertices) {
        for (std::size_t i = 0; i + 1 < offsets.size() && !found.finite; ++i)
            if (offsets[i] <= offsets[i + 1] && offsets[i + 1] <= vertices.size())
                look(std::span(vertices).subspan(offsets[i], offsets[i + 1] - offsets[i]));
    };
    look_at_all(mesh.face_offsets, mesh.corner_vertices);
    look_at_all(mesh.line_offsets, mesh.line_vertices);
    for (std::size_t i = 0; i < mesh.points.size() && !found.finite; ++i)
        look({&mesh.points[i], 1});
    return found;
}

// Light that its picture would have shaped is none without it: the surface would be a white patch.
void put_out_missing_emission(Scene& scene) {
    for (Material& material : scene.materials) {
        const std::uint32_t texture = material.emissive_map.texture;
        if (texture >= scene.textures.size() ||
            scene.textures[texture].image >= scene.images.size())
            continue;
        const ImageRef& image = scene.images[scene.textures[texture].image];
        std::error_code ec;
        if (image.bytes.empty() && image.channels.empty() &&
            !std::filesystem::is_regular_file(image.path, ec))
            material.emissive = glm::vec3(0.0f);
    }
}

}  // namespace

Result<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options) {
    std::error_code ec;
    const auto status = std::filesystem::status(path, ec);
    if (!std::filesystem::exists(status))
        return Error{ErrorCode::io, "no such file", path.string()};
    if (std::filesystem::is_directory(status))
        return Error{ErrorCode::io, "this is a directory; name a file", path.string()};
    if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, ec) == 0)
        return Error{ErrorCode::syntax, "the file is empty", path.string()};
    const std::string ending = lower_ending(path);
    const auto claimed = detail::format_that_reads(ending);
    const detail::Format* format = claimed ? *claimed : nullptr;
    if (!format) {
        const auto bytes = read_file(path);
        if (!bytes) return bytes.error();
        format =
            detail::format_of_bytes({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    }
    if (!format && !claimed) return claimed.error();
    if (!format)
        return Error{
            ErrorCode::unsupported,
            "unknown file type '" + ending + "': " + detail::format_titles(false) + " are read",
            path.string()};
    auto scene =
        format->foreign_reader && options.reader_process
            ? detail::load_contained(format->file.name, format->foreign_reader, path, options)
            : format->load(path, options);
    if (!scene) return scene;
    scene->source = path;
    if (format->file.meshes) detail::settle_transparency(*scene, options.transparency);
    warn_of_infinities(*scene);
    put_out_missing_emission(*scene);
    detail::contain_pictures(*scene, options);
    return scene;
}

Result<void> require_geometry(const Scene& scene) {
    std::size_t vertices = 0, nodes = 0;
    bool any = false;
    for (const Mesh& mesh : scene.meshes) {
        const Elements elements = elements_of(mesh);
        if (elements.finite) return {};
        any |= elements.any;
        vertices += mesh.positions.size();
    }
    for (const Node& node : scene.nodes) nodes += node.mesh == no_index;
    struct Kind {
        std::size_t count;
        const char *one, *many;
    };
    const Kind kinds[] = {{vertices, "vertex", "vertices"},
                          {nodes, "node", "nodes"},
                          {scene.materials.size(), "material", "materials"},
                          {scene.images.size(), "picture", "pictures"},
                          {scene.cameras.size(), "camera", "cameras"},
                          {scene.lights.size(), "light", "lights"},
                          {scene.animations.size(), "animation", "animations"}};
    std::string found;
    for (const Kind& kind : kinds)
        if (kind.count > 0)
            found += (found.empty() ? "" : ", ") + std::to_string(kind.count) + " " +
                     (kind.count == 1 ? kind.one : kind.many);
    std::string text =
        (any ? std::string("no face, line or point has coordinates that are all finite; found ")
             : std::string("no faces, lines or points are in the file; found ")) +
        (found.empty() ? std::string("nothing") : found);
    if (!scene.warnings.empty()) text += "; the reader says: " + scene.warnings.front();
    return Error{ErrorCode::invalid, std::move(text), scene.source.string()};
}

}  // namespace prep
