#include "formats/registry.h"

#include <algorithm>
#include <cctype>

#include "base/file_bytes.h"
#include "formats/foreign_files.h"
#include "formats/gltf/gltf.h"
#include "formats/obj/obj.h"
#include "formats/off/off.h"
#include "formats/picture_search.h"
#include "formats/ply/ply.h"
#include "formats/stl/stl.h"
#include "prep/files.h"
#include "prep/scene_json.h"
#include "text/line_ends.h"
#include "text/lower_case.h"

namespace prep {
namespace detail {
namespace {

Result<Scene> load_facets(const std::filesystem::path& path, const LoadOptions& options) {
    const auto bytes = read_file_bytes(path, options.threads);
    if (!bytes) return bytes.error();
    return parse_stl(*bytes, path.filename().string(), options.threads);
}

Result<Scene> load_object_file(const std::filesystem::path& path, const LoadOptions& options) {
    const auto bytes = read_file_bytes(path, options.threads);
    if (!bytes) return bytes.error();
    return parse_off(*bytes, path.filename().string());
}

Result<Scene> load_polygons(const std::filesystem::path& path, const LoadOptions& options) {
    const auto bytes = read_file_bytes(path, options.threads);
    if (!bytes) return bytes.error();
    PictureSearch pictures(path.parent_path(), options.texture_directories);
    return parse_ply(*bytes, path.filename().string(), &pictures, options.threads);
}

Result<Scene> load_openmesh(const std::filesystem::path& path, const LoadOptions&) {
    const auto bytes = read_file(path);
    if (!bytes) return bytes.error();
    return load_om(*bytes, path);
}

Result<Scene> load_wavefront(const std::filesystem::path& path, const LoadOptions& options) {
    return load_obj(path, options);
}

Result<Scene> load_json(const std::filesystem::path& path, const LoadOptions& options) {
    auto loaded = load_scene_json(path, options);
    if (!loaded) return loaded.error();
    if (loaded->orbit)
        loaded->scene.remarks.push_back(
            "the file's camera circles what a picture shows: the scene gets no camera of it");
    return std::move(loaded->scene);
}

Result<Scene> load_other(const std::filesystem::path& path, const LoadOptions& options) {
    return load_with_assimp(path, options);
}

bool is_gltf(std::string_view head) {
    if (head.starts_with("glTF")) return true;
    const std::size_t first = head.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    return first != std::string_view::npos && head[first] == '{' &&
           head.find("\"asset\"") != std::string_view::npos;
}
bool is_obj(std::string_view head) {
    return head.starts_with("v ") || head.find("\nv ") != std::string_view::npos;
}
bool is_ply(std::string_view head) {
    return without_byte_order_mark(head).starts_with("ply");
}
bool is_stl(std::string_view head) {
    return says_solid(without_byte_order_mark(head));
}
bool is_off(std::string_view head) {
    const std::string_view first = head.substr(0, head.find_first_of(" \r\n"));
    return first.ends_with("OFF") && first.size() <= 8;
}

bool contains(const std::vector<std::string_view>& endings, std::string_view ending) {
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

}  // namespace

const std::vector<Format>& formats() {
    static const std::vector<Format> rows{
        {{"glTF", "GLB, glTF", {".glb", ".gltf", ".vrm"}, {".glb", ".gltf"}},
         is_gltf,
         load_gltf,
         write_gltf,
         {.compression = true, .triangle_order = true, .everything = true}},
        {{"OBJ", "OBJ", {".obj"}, {".obj"}},
         is_obj,
         load_wavefront,
         write_obj,
         {.partial_uvs = true, .materials = true, .subdivision = true}},
        {{"PLY", "PLY", {".ply"}, {".ply"}},
         is_ply,
         load_polygons,
         write_ply,
         {.corner_values = false, .float_colors = false}},
        {{"STL", "STL", {".stl"}, {".stl"}},
         is_stl,
         load_facets,
         write_stl,
         {.corner_values = false, .uvs = false, .float_colors = false}},
        {{"OFF", "OFF", {".off"}, {".off"}},
         is_off,
         load_object_file,
         write_off,
         {.corner_values = false}},
        {{"OM", "OM", {".om"}, {}}, nullptr, load_openmesh, nullptr, {}, "OpenMesh"},
        {{"JSON scene", "JSON scenes", {".json"}, {}, false}, nullptr, load_json, nullptr, {}},
        // What people keep beside meshes is not listed: a file that is named is read whatever
        // Assimp claims, a directory is read for these alone. `.mesh` is Ogre's, Medit's and
        // others'; `.wrl` Assimp 5.2 claims without reading it.
        {{"Assimp",
          "the formats of Assimp (FBX, DAE, 3DS, …)",
          {".fbx", ".dae", ".3ds", ".blend",   ".lwo", ".ac",      ".x",   ".ase",
           ".dxf", ".3mf", ".b3d", ".md5mesh", ".lws", ".ms3d",    ".cob", ".smd",
           ".x3d", ".amf", ".bvh", ".ifc",     ".md2", ".mesh.xml"},
          {}},
         nullptr,
         load_other,
         nullptr,
         {},
         "Assimp"},
    };
    return rows;
}

Result<const Format*> format_that_reads(std::string_view ending) {
    for (const Format& format : formats())
        if (contains(format.file.endings, ending)) return &format;
    const auto claimed = assimp_reads(std::string(ending));
    if (!claimed) return claimed.error();
    return *claimed ? &formats().back() : nullptr;
}

const Format* format_that_writes(std::string_view ending) {
    for (const Format& format : formats())
        if (contains(format.file.written, ending)) return &format;
    return nullptr;
}

const Format* format_of_bytes(std::string_view bytes) {
    const std::string_view head = bytes.substr(0, 512);
    for (const Format& format : formats())
        if (format.sniff && format.sniff(head)) return &format;
    return nullptr;
}

std::string format_titles(bool written) {
    std::vector<std::string_view> titles;
    for (const Format& format : formats())
        if (!written || format.write) titles.push_back(format.file.title);
    std::string text;
    for (const std::string_view& title : titles) {
        if (!text.empty()) text += &title == &titles.back() ? " and " : ", ";
        text += title;
    }
    return text;
}

}  // namespace detail

const std::vector<FileFormat>& file_formats() {
    static const std::vector<FileFormat> files = [] {
        std::vector<FileFormat> list;
        for (const detail::Format& format : detail::formats()) list.push_back(format.file);
        return list;
    }();
    return files;
}

const FileFormat* file_format(const std::filesystem::path& path) {
    // Ogre's text has an ending of two parts.
    const std::string name = detail::lower_case(path.filename().string());
    for (const FileFormat& format : file_formats())
        for (const std::string_view ending : format.endings)
            if (name.size() > ending.size() && name.ends_with(ending)) return &format;
    return nullptr;
}

const FileFormat* file_format_of_bytes(std::string_view bytes) {
    const detail::Format* const format = detail::format_of_bytes(bytes);
    return format ? &file_formats()[std::size_t(format - detail::formats().data())] : nullptr;
}

std::string lower_ending(const std::filesystem::path& path) {
    return detail::lower_case(path.extension().string());
}

}  // namespace prep
