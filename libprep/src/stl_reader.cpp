#include <cmath>
#include <cstring>
#include <string_view>

#include "prep/io.h"
#include "prep/mesh_files.h"
#include "text_scan.h"

namespace prep {
namespace {

using detail::LineScanner;

constexpr std::size_t header_size = 84, facet_size = 50;
constexpr std::size_t max_facets = (std::size_t(no_index) - 1) / 3;

Scene make_scene(const std::string& name, std::vector<glm::dvec3> positions,
                 std::vector<std::uint32_t> parts, std::vector<std::string> part_names) {
    Scene scene;
    scene.name = name;
    scene.meshes.emplace_back();
    Mesh& mesh = scene.meshes.back();
    mesh.name = std::filesystem::path(name).stem().string();
    set_positions(mesh, positions);
    const std::uint32_t corners = std::uint32_t(positions.size());
    mesh.corner_vertices.resize(corners);
    for (std::uint32_t c = 0; c < corners; ++c) mesh.corner_vertices[c] = c;
    for (std::uint32_t c = 3; c <= corners; c += 3) mesh.face_offsets.push_back(c);
    if (part_names.size() > 1) {
        mesh.face_parts = std::move(parts);
        mesh.parts = std::move(part_names);
    }
    instance_unused_meshes(scene);
    return scene;
}

float read_float(const std::byte* at) {
    // The format is little-endian, as is every machine this runs on (x86-64).
    float value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

Result<Scene> parse_binary(std::span<const std::byte> bytes, const std::string& name,
                           std::uint32_t count) {
    if (count > max_facets)
        return Error{ErrorCode::limit, "more than 2^32 - 2 corners: cut the file into pieces",
                     name};
    std::vector<glm::dvec3> positions;
    positions.reserve(std::size_t(count) * 3);
    for (std::size_t f = 0; f < count; ++f) {
        const std::byte* at = bytes.data() + header_size + f * facet_size + 12;
        for (int k = 0; k < 3; ++k, at += 12)
            positions.push_back({read_float(at), read_float(at + 4), read_float(at + 8)});
    }
    Scene scene = make_scene(name, std::move(positions), {}, {});
    const std::size_t extra = bytes.size() - header_size - std::size_t(count) * facet_size;
    if (extra > 0)
        scene.warnings.push_back(name + ": " + std::to_string(extra) +
                                 " bytes after the last facet were ignored");
    return scene;
}

Result<Scene> parse_ascii(std::string_view text, const std::string& name) {
    std::vector<glm::dvec3> positions;
    std::vector<std::uint32_t> parts;
    std::vector<std::string> part_names;
    std::size_t line = 0, in_facet = 0, odd_facets = 0;
    bool facet = false;
    const auto fail = [&](const std::string& what, std::string_view content) {
        return Error{ErrorCode::syntax, what + " in " + detail::quoted_line(content),
                     name + ":" + std::to_string(line)};
    };
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view content = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        ++line;
        LineScanner scan(content);
        std::string word;
        for (const char c : scan.word()) word += char(c >= 'A' && c <= 'Z' ? c + 32 : c);
        if (word.empty() || word == "outer" || word == "endloop" || word == "endsolid") continue;
        if (word == "solid") {
            part_names.push_back(std::string(scan.rest()));
        } else if (word == "facet") {
            if (facet) return fail("a facet inside a facet", content);
            facet = true;
            in_facet = 0;
        } else if (word == "vertex") {
            double x, y, z;
            if (!scan.number(x) || !scan.number(y) || !scan.number(z))
                return fail("expected three coordinates", content);
            if (!facet) return fail("a vertex outside a facet", content);
            if (in_facet < 3) positions.push_back({x, y, z});
            ++in_facet;
        } else if (word == "endfacet") {
            if (!facet) return fail("an endfacet without its facet", content);
            facet = false;
            if (in_facet != 3) {
                ++odd_facets;
                positions.resize(positions.size() - std::min<std::size_t>(in_facet, 3));
                continue;
            }
            if (positions.size() >= no_index)
                return Error{ErrorCode::limit, "more than 2^32 - 2 corners", name};
            parts.push_back(part_names.empty() ? 0 : std::uint32_t(part_names.size() - 1));
        } else {
            return fail("expected solid, facet, outer loop, vertex, endloop, endfacet or endsolid",
                        content);
        }
    }
    if (facet) return fail("the file ends inside a facet", "");
    Scene scene = make_scene(name, std::move(positions), std::move(parts), std::move(part_names));
    if (odd_facets > 0)
        scene.warnings.push_back(name + ": " + std::to_string(odd_facets) +
                                 " facets without exactly three corners were dropped");
    return scene;
}

}  // namespace

Result<Scene> parse_stl(std::span<const std::byte> bytes, const std::string& name) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    const bool says_solid = begin != std::string_view::npos &&
                            (text.substr(begin, 5) == "solid" || text.substr(begin, 5) == "SOLID");
    // Text has no zero bytes; a binary header that begins with "solid" is followed by some.
    const bool text_like = says_solid && text.find('\0') == std::string_view::npos;
    if (bytes.size() >= header_size) {
        std::uint32_t count;
        std::memcpy(&count, bytes.data() + 80, 4);
        const std::size_t room = (bytes.size() - header_size) / facet_size;
        const bool exact = bytes.size() == header_size + std::size_t(count) * facet_size;
        if (exact || (!text_like && count <= room)) return parse_binary(bytes, name, count);
        if (!text_like)
            return Error{ErrorCode::syntax,
                         "the header announces " + std::to_string(count) +
                             " facets, but there is room for " + std::to_string(room) +
                             ": the file is cut short or not STL",
                         name + ", byte 80"};
    }
    if (says_solid) return parse_ascii(text, name);
    return Error{ErrorCode::syntax,
                 "neither \"solid\" at the beginning nor a binary header of 84 bytes: not STL",
                 name};
}

}  // namespace prep
