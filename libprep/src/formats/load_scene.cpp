#include <cmath>
#include <string_view>

#include "formats/registry.h"
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
    const detail::Format* format = detail::format_that_reads(ending);
    if (!format) {
        const auto bytes = read_file(path);
        if (!bytes) return bytes.error();
        format =
            detail::format_of_bytes({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    }
    if (!format)
        return Error{
            ErrorCode::unsupported,
            "unknown file type '" + ending + "': " + detail::format_titles(false) + " are read",
            path.string()};
    auto scene = format->load(path, options);
    if (!scene) return scene;
    scene->source = path;
    warn_of_infinities(*scene);
    return scene;
}

}  // namespace prep
