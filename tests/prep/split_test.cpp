#include "prep/split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <limits>
#include <map>

#include "prep/corner_normals.h"
#include "prep/triangulate.h"
#include "shapes.h"

namespace {

using prep::HardEdgeOptions;
using prep::HardEdges;
using prep::Mesh;
using prep::MeshView;
using prep::no_index;
using prep::SplitReason;
using prep::VertexMesh;
using Indices = std::vector<std::uint32_t>;

VertexMesh split_of(const Mesh& mesh, const HardEdges* hard = nullptr,
                    const prep::SplitOptions& options = {}) {
    auto result = prep::split(mesh, hard, options);
    EXPECT_TRUE(result.has_value());
    return *std::move(result);
}

// Gives the mesh computed normals; returns the hard edges.
HardEdges add_normals(Mesh& mesh, const HardEdgeOptions& options = {}) {
    const MeshView view(mesh);
    const prep::Topology topology = prep::build_topology(view);
    const prep::FaceNormals faces = prep::face_normals(view);
    auto hard = prep::hard_edges(view, topology, faces, options);
    mesh.normals = std::move(prep::corner_normals(view, topology, faces, *hard)->normals);
    return *std::move(hard);
}

unsigned bits(SplitReason a) {
    return unsigned(a);
}
unsigned bits(SplitReason a, SplitReason b) {
    return unsigned(a) | unsigned(b);
}

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

// The result against the definition: one vertex for each distinct set of attributes, the way back
// right, triangles those of triangulate() in ranges by part and material.
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
        EXPECT_EQ(out.positions[v], mesh.positions[out.source_vertices[v]]);
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

// The reasons of the copies, in order of the vertices.
std::vector<unsigned> copies(const VertexMesh& out) {
    std::vector<unsigned> result;
    for (const prep::SplitReasons r : out.split_reasons)
        if (r) result.push_back(r);
    return result;
}

// Two quads side by side: corners 1 and 4 at vertex 1, corners 2 and 7 at vertex 4.
Mesh two_quads() {
    return shapes::grid(2, 1);
}

TEST(Split, EmptyMesh) {
    const VertexMesh out = split_of(Mesh{});
    EXPECT_EQ(out.vertex_count(), 0u);
    EXPECT_TRUE(out.ranges.empty());
}

TEST(Split, OneTriangleStaysAsItIs) {
    const Mesh mesh = shapes::polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const VertexMesh out = split_of(mesh);
    EXPECT_EQ(out.positions, mesh.positions);
    EXPECT_EQ(out.indices, (Indices{0, 1, 2}));
    EXPECT_EQ(out.corner_vertices, (Indices{0, 1, 2}));
    expect_right(mesh, out);
}

TEST(Split, WithoutAttributesNothingIsSplit) {
    const Mesh mesh = shapes::cube();
    const VertexMesh out = split_of(mesh);
    EXPECT_EQ(out.positions, mesh.positions);
    EXPECT_EQ(out.triangle_count(), 12u);
    EXPECT_TRUE(copies(out).empty());
    expect_right(mesh, out);
}

TEST(Split, HardCubeHasTwentyFourVerticesSmoothOneEight) {
    Mesh mesh = shapes::cube();
    HardEdges hard = add_normals(mesh);
    VertexMesh out = split_of(mesh, &hard);
    EXPECT_EQ(out.vertex_count(), 24u);
    EXPECT_EQ(copies(out), std::vector<unsigned>(16, bits(SplitReason::hard_edge)));
    expect_right(mesh, out);
    HardEdgeOptions smooth;
    smooth.angle_degrees = 90;
    hard = add_normals(mesh, smooth);
    out = split_of(mesh, &hard);
    EXPECT_EQ(out.vertex_count(), 8u);
    expect_right(mesh, out);
}

TEST(Split, EqualBitsUnderOtherIndicesShare) {
    Mesh mesh = two_quads();
    mesh.normals.values = std::vector<glm::vec3>(8, glm::vec3(0, 0, 1));
    mesh.normals.indices = {0, 1, 2, 3, 4, 5, 6, 7};
    mesh.uvs.resize(1);
    for (std::uint32_t c = 0; c < 8; ++c) {
        mesh.uvs[0].values.push_back(glm::vec2(mesh.positions[mesh.corner_vertices[c]]));
        mesh.uvs[0].indices.push_back(c);
    }
    const VertexMesh out = split_of(mesh);
    EXPECT_EQ(out.vertex_count(), 6u);
    expect_right(mesh, out);
}

TEST(Split, BitsDecideNotValues) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    Mesh mesh = two_quads();
    mesh.uvs.resize(1);
    mesh.uvs[0].values = {{0.0f, nan}, {-0.0f, nan}, {0.0f, nan}};
    mesh.uvs[0].indices = {0, 0, 0, 0, 2, 0, 0, 1};
    const VertexMesh out = split_of(mesh);
    EXPECT_EQ(out.vertex_count(), 7u);  // NaN with the same bits shares; −0 is not 0
    EXPECT_EQ(copies(out), std::vector<unsigned>{bits(SplitReason::uv_seam)});
    expect_right(mesh, out);
}

TEST(Split, EachReasonByItself) {
    const glm::vec3 up(0, 0, 1), aside(1, 0, 0);
    const auto one_bit = [](const Mesh& mesh, SplitReason reason, const HardEdges* hard = nullptr) {
        const VertexMesh out = split_of(mesh, hard);
        EXPECT_EQ(copies(out), std::vector<unsigned>(2, bits(reason))) << bits(reason);
        EXPECT_EQ(out.vertex_count(), 8u);
        expect_right(mesh, out);
    };
    const Indices left_right{0, 0, 0, 0, 1, 1, 1, 1};
    Mesh mesh = two_quads();
    mesh.normals = {{up, aside}, left_right};
    one_bit(mesh, SplitReason::authored_normal);
    mesh = two_quads();
    mesh.uvs = {{{{0, 0}, {1, 1}}, left_right}};
    one_bit(mesh, SplitReason::uv_seam);
    mesh = two_quads();
    mesh.tangents = {{{1, 0, 0, 1}, {1, 0, 0, -1}}, left_right};
    one_bit(mesh, SplitReason::mirrored_uv);
    mesh.tangents.values[1] = {0, 1, 0, 1};
    one_bit(mesh, SplitReason::tangent);
    mesh = two_quads();
    mesh.colors = {{{{1, 0, 0, 1}, {0, 1, 0, 1}}, left_right}};
    one_bit(mesh, SplitReason::color);
    mesh = two_quads();
    mesh.face_materials = {0, 1};
    one_bit(mesh, SplitReason::material);
    mesh = two_quads();
    mesh.face_parts = {0, 1};
    one_bit(mesh, SplitReason::material);
    mesh = two_quads();
    mesh.positions[2].z = mesh.positions[5].z = 3;  // the right quad turns by 72°
    HardEdges hard = add_normals(mesh);
    one_bit(mesh, SplitReason::hard_edge, &hard);
    mesh.face_smoothing = {1, 2};
    hard = add_normals(mesh);
    one_bit(mesh, SplitReason::smoothing_group, &hard);
}

TEST(Split, ReasonsAddUp) {
    const Indices left_right{0, 0, 0, 0, 1, 1, 1, 1};
    Mesh mesh = two_quads();
    mesh.uvs = {{{{0, 0}, {1, 1}}, left_right}};
    mesh.tangents = {{{1, 0, 0, 1}, {1, 0, 0, -1}}, left_right};
    EXPECT_EQ(copies(split_of(mesh)),
              std::vector<unsigned>(2, bits(SplitReason::uv_seam, SplitReason::mirrored_uv)));
    mesh.tangents = {};
    mesh.face_materials = {4, 2};
    EXPECT_EQ(copies(split_of(mesh)),
              std::vector<unsigned>(2, bits(SplitReason::uv_seam, SplitReason::material)));
}

TEST(Split, PartsStayTogetherOnRequest) {
    Mesh mesh = two_quads();
    mesh.face_materials = {1, 0};
    mesh.face_parts = {0, 1};
    const VertexMesh out = split_of(mesh, nullptr, {.parts_apart = false, .threads = 0});
    EXPECT_EQ(out.vertex_count(), 6u);
    ASSERT_EQ(out.ranges.size(), 2u);
    EXPECT_EQ(out.ranges[0].material, 1u);
    EXPECT_EQ(out.ranges[1].part, 1u);
}

TEST(Split, RangesAreSortedByPartThenMaterialInSourceOrder) {
    Mesh mesh = shapes::grid(6, 1);
    mesh.face_parts = {1, 0, 1, 0, 1, 0};
    mesh.face_materials = {0, 5, 1, 3, 0, 3};
    const VertexMesh out = split_of(mesh);
    expect_right(mesh, out);
    Indices found;
    for (const auto& r : out.ranges)
        found.insert(found.end(), {r.part, r.material, r.triangle_count});
    EXPECT_EQ(found, (Indices{0, 3, 4, 0, 5, 2, 1, 0, 4, 1, 1, 2}));
    EXPECT_EQ(out.triangle_faces, (Indices{3, 3, 5, 5, 1, 1, 0, 0, 4, 4, 2, 2}));
}

TEST(Split, MissingValuesGetDefaults) {
    Mesh mesh = two_quads();
    const Indices none(4, no_index);
    const Indices left{0, 0, 0, 0, no_index, no_index, no_index, no_index};
    mesh.normals = {{{1, 0, 0}}, left};
    mesh.tangents = {{{0, 1, 0, -1}}, left};
    mesh.uvs = {{{{3, 4}}, left}};
    mesh.colors = {{{{0, 0, 0, 0}}, left}};
    const VertexMesh out = split_of(mesh);
    expect_right(mesh, out);
    const std::uint32_t v = out.corner_vertices[5];
    EXPECT_EQ(out.normals[v], glm::vec3(0, 0, 1));
    EXPECT_EQ(out.tangents[v], glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(out.uvs[0][v], glm::vec2(0, 0));
    EXPECT_EQ(out.colors[0][v], glm::vec4(1, 1, 1, 1));
}

TEST(Split, LinesAndPointsKeepTheirVerticesUnusedOnesGo) {
    Mesh mesh = two_quads();  // vertices 0 … 5
    for (int i = 0; i < 5; ++i) mesh.positions.push_back({10, i, 0});
    mesh.line_vertices = {1, 7, 8};
    mesh.line_offsets = {0, 3};
    mesh.points = {10};
    mesh.vertex_colors = std::vector<glm::vec4>(11, glm::vec4(1));
    mesh.vertex_colors[10] = {0, 0.5f, 1, 1};
    const VertexMesh out = split_of(mesh);
    EXPECT_EQ(out.source_vertices, (Indices{0, 1, 2, 3, 4, 5, 7, 8, 10}));
    EXPECT_EQ(out.lines, (Indices{1, 6, 6, 7}));
    EXPECT_EQ(out.points, (Indices{8}));
    EXPECT_EQ(out.source_corners[8], no_index);
    ASSERT_EQ(out.colors.size(), 1u);
    EXPECT_EQ(out.colors[0][8], mesh.vertex_colors[10]);
}

TEST(Split, DegenerateAndRepeatedFacesPassThrough) {
    const Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                      {{0, 0, 0}, {0, 1, 2}, {0, 1, 2}, {0, 1, 1}});
    const VertexMesh out = split_of(mesh);
    EXPECT_EQ(out.vertex_count(), 3u);
    EXPECT_EQ(out.indices, (Indices{0, 0, 0, 0, 1, 2, 0, 1, 2, 0, 1, 1}));
    expect_right(mesh, out);
}

// Every layer with few values, many repeated under other indices, some missing.
Mesh random_layers(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    Mesh mesh = shapes::torus(9, 7);
    const std::size_t corners = mesh.corner_count();
    const auto layer = [&](auto& to, auto... values) {
        to.values = {values..., values...};
        for (std::size_t c = 0; c < corners; ++c)
            to.indices.push_back(random() % 8 == 0 ? no_index
                                                   : std::uint32_t(random() % to.values.size()));
    };
    if (random() % 2) layer(mesh.normals, glm::vec3(0, 0, 1), glm::vec3(0, 1, 0));
    if (random() % 2)
        layer(mesh.tangents, glm::vec4(1, 0, 0, 1), glm::vec4(1, 0, 0, -1), glm::vec4(0, 1, 0, 1));
    mesh.uvs.resize(random() % 3);
    for (auto& set : mesh.uvs) layer(set, glm::vec2(0, 0), glm::vec2(0.5f, -0.0f));
    mesh.colors.resize(random() % 2);
    for (auto& set : mesh.colors) layer(set, glm::vec4(1), glm::vec4(0));
    const auto per_face = [&](Indices& to) {
        if (random() % 2)
            for (std::size_t f = 0; f < mesh.face_count(); ++f)
                to.push_back(std::uint32_t(random() % 3));
    };
    per_face(mesh.face_materials);
    per_face(mesh.face_parts);
    return mesh;
}

TEST(Split, RandomLayersGiveOneVertexForEachSetOfBits) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(seed);
        const Mesh mesh = random_layers(seed);
        expect_right(mesh, split_of(mesh));
    }
}

TEST(Split, SplitMeshSplitsNoFurther) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const VertexMesh once = split_of(random_layers(seed));
        Mesh mesh;
        mesh.positions = once.positions;
        mesh.corner_vertices = once.indices;
        for (std::uint32_t t = 0; t < once.triangle_count(); ++t)
            mesh.face_offsets.push_back(3 * t + 3);
        mesh.uvs.resize(once.uvs.size());
        for (std::size_t s = 0; s < once.uvs.size(); ++s) mesh.uvs[s] = {once.uvs[s], once.indices};
        if (!once.normals.empty()) mesh.normals = {once.normals, once.indices};
        EXPECT_EQ(split_of(mesh).vertex_count(), once.vertex_count());
    }
}

TEST(Split, FlatPoleOfHundredThousandFacesTakesLinearTime) {
    Mesh mesh = shapes::fan(100'000);
    HardEdgeOptions flat;
    flat.angle_degrees = 0;
    const HardEdges hard = add_normals(mesh, flat);
    const auto start = std::chrono::steady_clock::now();
    const VertexMesh out = split_of(mesh, &hard);
    // Comparing all copies of the pole with one another would take minutes.
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
    EXPECT_GT(out.vertex_count(), 200'000u);  // neighbours share a normal by rounding at times
}

TEST(Split, ThreadsChangeNothing) {
    Mesh mesh = shapes::torus(300, 200);
    std::mt19937_64 random(51);
    shapes::jitter(mesh, 0.02f, random);
    mesh.face_materials.resize(mesh.face_count());
    for (auto& m : mesh.face_materials) m = std::uint32_t(random() % 3);
    HardEdgeOptions edges;
    edges.angle_degrees = 30;
    const HardEdges hard = add_normals(mesh, edges);
    const VertexMesh one = split_of(mesh, &hard, {.parts_apart = true, .threads = 1});
    for (const int threads : {2, 8}) {
        const VertexMesh many = split_of(mesh, &hard, {.parts_apart = true, .threads = threads});
        EXPECT_EQ(one.positions, many.positions);
        EXPECT_EQ(one.normals, many.normals);
        EXPECT_EQ(one.indices, many.indices);
        EXPECT_EQ(one.corner_vertices, many.corner_vertices);
        EXPECT_EQ(one.split_reasons, many.split_reasons);
        EXPECT_EQ(one.triangle_faces, many.triangle_faces);
    }
}

}  // namespace
