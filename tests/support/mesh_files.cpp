#include "mesh_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "invariants.h"

namespace test {

prep::Result<prep::Scene> parsed(prep::Result<prep::Scene> (*parse)(std::span<const std::byte>,
                                                                    const std::string&),
                                 const std::string& text, const std::string& name) {
    auto scene = parse(std::as_bytes(std::span(text.data(), text.size())), name);
    if (scene) {
        EXPECT_EQ(broken_promise(*scene), "");
    }
    return scene;
}

std::string error_of(const prep::Result<prep::Scene>& result) {
    return result ? "no error" : prep::to_string(result.error());
}

prep::PreparedScene untouched(prep::Scene scene) {
    prep::PrepareOptions options;
    options.request.normals = prep::Request::Level::never;
    options.request.tangents = prep::Request::Level::never;
    options.tangent.mode = prep::TangentMode::mikktspace_exact;  // which leaves lengths alone
    auto prepared = prep::prepare(std::move(scene), options);
    if (!prepared) throw std::runtime_error(prep::to_string(prepared.error()));
    return std::move(*prepared);
}

namespace {

template <class T>
bool same_bits(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

template <class T>
bool same_lists(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

template <class T>
bool same_layers(const prep::CornerLayer<T>& a, const prep::CornerLayer<T>& b) {
    return same_lists(a.values, b.values) && same_lists(a.indices, b.indices);
}

template <class T>
bool same_value(const prep::CornerLayer<T>& a, const prep::CornerLayer<T>& b, std::size_t corner) {
    const auto i = a.empty() ? prep::no_index : a.indices[corner];
    const auto j = b.empty() ? prep::no_index : b.indices[corner];
    if (i == prep::no_index || j == prep::no_index) return i == j;
    return same_bits(a.values[i], b.values[j]);
}

}  // namespace

std::string corner_difference(const prep::Mesh& a, const prep::Mesh& b) {
    if (a.face_offsets != b.face_offsets) return "faces";
    const auto at = [](const prep::Mesh& mesh, std::size_t c) {
        const glm::dvec3 p(mesh.positions[mesh.corner_vertices[c]]);
        return mesh.origin == glm::dvec3(0.0) ? p : mesh.origin + p;  // −0 + 0 is 0
    };
    const prep::CornerLayer<glm::vec2> no_uv;
    const prep::CornerLayer<glm::vec4> no_color;
    for (std::size_t c = 0; c < a.corner_count(); ++c) {
        const std::string where = " of corner " + std::to_string(c);
        if (!same_bits(at(a, c), at(b, c))) return "position" + where;
        if (!same_value(a.normals, b.normals, c)) return "normal" + where;
        if (!same_value(a.uvs.empty() ? no_uv : a.uvs[0], b.uvs.empty() ? no_uv : b.uvs[0], c))
            return "UV" + where;
        if (!same_value(a.colors.empty() ? no_color : a.colors[0],
                        b.colors.empty() ? no_color : b.colors[0], c))
            return "colour" + where;
    }
    return {};
}

std::string exact_difference(const prep::Mesh& a, const prep::Mesh& b) {
    if (!same_bits(a.origin, b.origin)) return "origin";
    if (!same_lists(a.positions, b.positions)) return "positions";
    if (a.face_offsets != b.face_offsets) return "face_offsets";
    if (a.corner_vertices != b.corner_vertices) return "corner_vertices";
    if (!same_layers(a.normals, b.normals)) return "normals";
    if (!same_layers(a.tangents, b.tangents)) return "tangents";
    if (a.uvs.size() != b.uvs.size()) return "number of UV sets";
    for (std::size_t s = 0; s < a.uvs.size(); ++s)
        if (!same_layers(a.uvs[s], b.uvs[s])) return "uvs";
    if (a.colors.size() != b.colors.size()) return "number of colour layers";
    for (std::size_t s = 0; s < a.colors.size(); ++s)
        if (!same_layers(a.colors[s], b.colors[s])) return "colors";
    if (a.face_materials != b.face_materials) return "face_materials";
    if (a.face_smoothing != b.face_smoothing) return "face_smoothing";
    if (a.face_parts != b.face_parts) return "face_parts";
    if (a.parts != b.parts) return "parts";
    if (!(a.subdivision == b.subdivision)) return "subdivision";
    if (a.line_offsets != b.line_offsets) return "line_offsets";
    if (a.line_vertices != b.line_vertices) return "line_vertices";
    if (a.points != b.points) return "points";
    if (!same_lists(a.vertex_colors, b.vertex_colors)) return "vertex_colors";
    return {};
}

}  // namespace test
