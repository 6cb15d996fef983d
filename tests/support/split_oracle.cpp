#include "split_oracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>

#include "prep/triangulate.h"

namespace split_oracle {
namespace {

using prep::Mesh;
using prep::MeshView;
using prep::no_index;
using prep::VertexMesh;
using Indices = std::vector<std::uint32_t>;

// All that must be the same for two corners to share a vertex, as bits, read from the source.
using Key = std::vector<std::uint32_t>;
template <class T>
void append(Key& key, const T& value) {
    std::uint32_t words[sizeof(T) / 4];
    std::memcpy(words, &value, sizeof(T));
    key.insert(key.end(), std::begin(words), std::end(words));
}
template <class T>
void append(Key& key, const prep::CornerLayer<T>& layer, std::uint32_t corner, const T& missing) {
    if (layer.empty()) return;
    append(key, layer.indices[corner] == no_index ? missing : layer.values[layer.indices[corner]]);
}
Key key_of(const Mesh& mesh, std::uint32_t face, std::uint32_t corner) {
    Key key{mesh.corner_vertices[corner]};
    append(key, mesh.normals, corner, {0, 0, 1});
    append(key, mesh.tangents, corner, {1, 0, 0, 1});
    for (const auto& layer : mesh.uvs) append(key, layer, corner, {0, 0});
    for (const auto& layer : mesh.colors) append(key, layer, corner, {1, 1, 1, 1});
    key.push_back(mesh.face_materials.empty() ? 0 : mesh.face_materials[face]);
    key.push_back(mesh.face_parts.empty() ? 0 : mesh.face_parts[face]);
    return key;
}

}  // namespace

void expect_right(const Mesh& mesh, const VertexMesh& out) {
    std::map<Key, std::uint32_t> vertices;
    Indices loose;
    ASSERT_EQ(out.corner_vertices.size(), mesh.corner_count());
    Indices first(out.vertex_count(), no_index);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const std::uint32_t v = out.corner_vertices[c];
            ASSERT_LT(v, out.vertex_count());
            EXPECT_EQ(vertices.try_emplace(key_of(mesh, f, c), v).first->second, v);
            if (first[v] == no_index) first[v] = c;
            EXPECT_EQ(out.source_vertices[v], mesh.corner_vertices[c]);
            // What the vertex carries is what its corner has.
            Key source, carried;
            append(source, mesh.normals, c, {0, 0, 1});
            append(source, mesh.tangents, c, {1, 0, 0, 1});
            for (const auto& layer : mesh.uvs) append(source, layer, c, {0, 0});
            for (const auto& layer : mesh.colors) append(source, layer, c, {1, 1, 1, 1});
            if (!mesh.normals.empty()) append(carried, out.normals[v]);
            if (!mesh.tangents.empty()) append(carried, out.tangents[v]);
            for (std::size_t s = 0; s < mesh.uvs.size(); ++s) append(carried, out.uvs[s][v]);
            for (std::size_t s = 0; s < mesh.colors.size(); ++s) append(carried, out.colors[s][v]);
            EXPECT_EQ(source, carried);
        }
    EXPECT_EQ(out.source_corners, first);
    const std::size_t on_faces =
        out.vertex_count() - std::size_t(std::count(first.begin(), first.end(), no_index));
    EXPECT_EQ(vertices.size(), on_faces);  // two vertices never have the same attributes
    for (std::uint32_t v = 0; v < out.vertex_count(); ++v) {
        const bool copy = v > 0 && out.source_vertices[v - 1] == out.source_vertices[v];
        EXPECT_EQ(out.split_reasons[v] != 0, copy) << v;
        if (v > 0) {
            EXPECT_LE(out.source_vertices[v - 1], out.source_vertices[v]);
        }
        if (copy) {
            EXPECT_LT(out.source_corners[v - 1], out.source_corners[v]);
        }
        // By bits: NaN equals nothing.
        EXPECT_EQ(std::memcmp(&out.positions[v], &mesh.positions[out.source_vertices[v]],
                              sizeof(glm::vec3)),
                  0);
    }

    const prep::Triangulation cut = prep::triangulate(MeshView(mesh));
    ASSERT_EQ(out.triangle_count(), cut.triangle_faces.size());
    std::map<std::array<std::uint32_t, 4>, int> expected, found;
    for (std::size_t t = 0; t < cut.triangle_faces.size(); ++t) {
        std::array<std::uint32_t, 4> a{cut.triangle_faces[t]}, b{out.triangle_faces[t]};
        for (int k = 0; k < 3; ++k) {
            a[k + 1] = out.corner_vertices[cut.corners[3 * t + k]];
            b[k + 1] = out.indices[3 * t + k];
        }
        ++expected[a];
        ++found[b];
    }
    EXPECT_EQ(expected, found);
    std::uint32_t next = 0;
    for (const VertexMesh::Range& range : out.ranges) {
        EXPECT_EQ(range.first_triangle, next);
        EXPECT_GT(range.triangle_count, 0u);
        next += range.triangle_count;
        for (std::uint32_t t = range.first_triangle; t < next; ++t) {
            const std::uint32_t f = out.triangle_faces[t];
            EXPECT_EQ(range.material,
                      mesh.face_materials.empty() ? no_index : mesh.face_materials[f]);
            EXPECT_EQ(range.part, mesh.face_parts.empty() ? no_index : mesh.face_parts[f]);
            if (t > range.first_triangle) {
                EXPECT_LE(out.triangle_faces[t - 1], f);
            }
        }
    }
    EXPECT_EQ(next, out.triangle_count());
}

}  // namespace split_oracle
