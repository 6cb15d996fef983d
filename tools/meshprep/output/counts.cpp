#include "meshprep/output/counts.h"

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "meshprep/files/file_list.h"
#include "prep/files.h"
#include "prep/formats.h"

namespace meshprep {
namespace {

using SortedJson = nlohmann::json;

void add(Counts& counts, const char* name, std::uint64_t value) {
    counts.figures.emplace_back(name, value);
}

// The JSON part of a glTF or GLB file; the binary part, which is the most, is not read.
std::string gltf_text(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    char head[20] = {};
    if (in.read(head, sizeof head) && std::memcmp(head, "glTF", 4) == 0) {
        std::uint32_t length = 0;
        std::memcpy(&length, head + 12, 4);
        std::error_code ec;
        const auto size = std::filesystem::file_size(path, ec);
        if (ec || length > size - sizeof head) return {};
        std::string text(length, ' ');
        if (!in.read(text.data(), std::streamsize(length))) return {};
        return text;
    }
    const prep::Result<std::vector<std::byte>> bytes = prep::read_file(path);
    if (!bytes) return {};
    return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

const SortedJson& member(const SortedJson& object, const char* key) {
    static const SortedJson none;
    if (!object.is_object()) return none;
    const auto found = object.find(key);
    return found == object.end() ? none : *found;
}

std::uint64_t size_of(const SortedJson& object, const char* key) {
    const SortedJson& value = member(object, key);
    return value.is_array() ? value.size() : 0;
}

}  // namespace

const std::uint64_t* Counts::find(const std::string& name) const {
    for (const auto& figure : figures)
        if (figure.first == name) return &figure.second;
    return nullptr;
}

Counts count_scene(const prep::Scene& scene) {
    std::uint64_t vertices = 0, faces = 0, triangles = 0, lines = 0, points = 0;
    for (const prep::Mesh& mesh : scene.meshes) {
        vertices += mesh.vertex_count();
        faces += mesh.face_count();
        triangles += mesh.corner_count() - 2 * mesh.face_count();
        lines += mesh.line_offsets.empty() ? 0 : mesh.line_offsets.size() - 1;
        points += mesh.points.size();
    }
    Counts counts;
    add(counts, "meshes", scene.meshes.size());
    add(counts, "vertices", vertices);
    add(counts, "faces", faces);
    add(counts, "triangles", triangles);
    if (lines > 0) add(counts, "polylines", lines);
    if (points > 0) add(counts, "points", points);
    add(counts, "materials", scene.materials.size());
    add(counts, "textures", scene.textures.size());
    return counts;
}

Counts count_parts(const prep::Scene& scene) {
    std::uint64_t channels = 0;
    for (const prep::Animation& animation : scene.animations) channels += animation.channels.size();
    Counts counts;
    const auto add_some = [&](const char* name, std::uint64_t value) {
        if (value > 0) add(counts, name, value);
    };
    add_some("morph targets", prep::morph_target_count(scene));
    add_some("skins", scene.skins.size());
    add_some("animations", scene.animations.size());
    add_some("animation channels", channels);
    add_some("cameras", scene.cameras.size());
    add_some("lights", scene.lights.size());
    return counts;
}

Counts count_prepared(const prep::PreparedScene& prepared, const std::string& format) {
    const bool has_nodes = format == "glb" || format == "gltf";
    const bool has_materials = has_nodes || format == "obj";
    std::vector<std::uint64_t> times(prepared.meshes.size(), has_nodes ? 1 : 0);
    for (const prep::Node& node : prepared.scene.nodes)
        if (!has_nodes && node.mesh != prep::no_index) ++times[node.mesh];
    std::uint64_t vertices = 0, triangles = 0, lines = 0, points = 0;
    for (std::size_t m = 0; m < times.size(); ++m) {
        const prep::VertexMesh& mesh = prepared.meshes[m];
        vertices += times[m] * mesh.vertex_count();
        triangles += times[m] * mesh.triangle_count();
        lines += times[m] * (mesh.lines.size() / 2);
        points += times[m] * mesh.points.size();
    }
    Counts counts;
    add(counts, "meshes", prepared.meshes.size());
    add(counts, "vertices", vertices);
    add(counts, "triangles", triangles);
    if (lines > 0) add(counts, "line segments", lines);
    if (points > 0) add(counts, "points", points);
    add(counts, "materials", has_materials ? prepared.scene.materials.size() : 0);
    add(counts, "textures", has_materials ? prepared.scene.textures.size() : 0);
    return counts;
}

Counts count_gltf_file(const std::filesystem::path& path) {
    const prep::FileFormat* const format = prep::file_format(path);
    if (!format || format->name != "glTF") return {};
    const std::string text = gltf_text(path);
    // The non-throwing form; a document that is no JSON counts as nothing.
    const SortedJson json = SortedJson::parse(text, nullptr, false);
    if (!json.is_object()) return {};
    Counts counts;
    add(counts, "nodes", size_of(json, "nodes"));
    add(counts, "meshes", size_of(json, "meshes"));
    std::uint64_t primitives = 0, targets = 0, channels = 0;
    if (const SortedJson& meshes = member(json, "meshes"); meshes.is_array()) {
        for (const SortedJson& mesh : meshes) {
            const SortedJson& list = member(mesh, "primitives");
            if (!list.is_array()) continue;
            primitives += list.size();
            for (const SortedJson& primitive : list) targets += size_of(primitive, "targets");
        }
    }
    if (const SortedJson& animations = member(json, "animations"); animations.is_array())
        for (const SortedJson& animation : animations) channels += size_of(animation, "channels");
    add(counts, "primitives", primitives);
    add(counts, "morph targets", targets);
    add(counts, "skins", size_of(json, "skins"));
    add(counts, "animations", size_of(json, "animations"));
    add(counts, "animation channels", channels);
    add(counts, "cameras", size_of(json, "cameras"));
    const SortedJson& extensions = member(json, "extensions");
    add(counts, "lights", size_of(member(extensions, "KHR_lights_punctual"), "lights"));
    add(counts, "materials", size_of(json, "materials"));
    add(counts, "textures", size_of(json, "textures"));
    add(counts, "images", size_of(json, "images"));
    if (const SortedJson& used = member(json, "extensionsUsed"); used.is_array())
        for (const SortedJson& name : used)
            if (name.is_string()) counts.extensions.push_back(name.get<std::string>());
    return counts;
}

nlohmann::ordered_json to_json(const Counts& counts) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const auto& [name, value] : counts.figures) {
        std::string key = name;
        for (char& c : key)
            if (c == ' ') c = '_';
        json[key] = value;
    }
    if (!counts.extensions.empty()) json["extensions"] = counts.extensions;
    return json;
}

}  // namespace meshprep
