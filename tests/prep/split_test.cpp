#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <map>
#include <random>

#include "prep/corner_normals.h"
#include "prep/split_vertices.h"
#include "prep/triangulate.h"
#include "shapes.h"
#include "split_oracle.h"
#include "steps.h"
#include "surface/vertex_corners.h"
#include "vertices/split_vertices.h"

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
    split_oracle::expect_right(mesh, out);
}

TEST(Split, WithoutAttributesNothingIsSplit) {
    const Mesh mesh = shapes::cube();
    const VertexMesh out = split_of(mesh);
    EXPECT_EQ(out.positions, mesh.positions);
    EXPECT_EQ(out.triangle_count(), 12u);
    EXPECT_TRUE(copies(out).empty());
    split_oracle::expect_right(mesh, out);
}

// Sets keep their numbers; one that the mesh has not is not there, rather than full of zeros.
TEST(Split, UvSetsThatAreNotThereStayAway) {
    Mesh mesh = shapes::cube();
    mesh.uvs.resize(3);
    mesh.uvs[1].values = {{0.25f, 0.5f}};
    mesh.uvs[1].indices.assign(mesh.corner_count(), 0);
    const VertexMesh split = split_of(mesh);
    ASSERT_EQ(split.uvs.size(), 2u);
    EXPECT_TRUE(split.uvs[0].empty());
    EXPECT_EQ(split.uvs[1], std::vector<glm::vec2>(split.vertex_count(), glm::vec2(0.25f, 0.5f)));
    mesh.uvs[1] = {};
    EXPECT_TRUE(split_of(mesh).uvs.empty());
}

TEST(Split, HardCubeHasTwentyFourVerticesSmoothOneEight) {
    Mesh mesh = shapes::cube();
    HardEdges hard = add_normals(mesh);
    VertexMesh out = split_of(mesh, &hard);
    EXPECT_EQ(out.vertex_count(), 24u);
    EXPECT_EQ(copies(out), std::vector<unsigned>(16, bits(SplitReason::hard_edge)));
    split_oracle::expect_right(mesh, out);
    HardEdgeOptions smooth;
    smooth.angle_degrees = 90;
    hard = add_normals(mesh, smooth);
    out = split_of(mesh, &hard);
    EXPECT_EQ(out.vertex_count(), 8u);
    split_oracle::expect_right(mesh, out);
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
    split_oracle::expect_right(mesh, out);
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
    split_oracle::expect_right(mesh, out);
}

TEST(Split, EachReasonByItself) {
    const glm::vec3 up(0, 0, 1), aside(1, 0, 0);
    const auto one_bit = [](const Mesh& mesh, SplitReason reason, const HardEdges* hard = nullptr) {
        const VertexMesh out = split_of(mesh, hard);
        EXPECT_EQ(copies(out), std::vector<unsigned>(2, bits(reason))) << bits(reason);
        EXPECT_EQ(out.vertex_count(), 8u);
        split_oracle::expect_right(mesh, out);
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

TEST(Split, PartsStayTogetherOnRequestMaterialsDoNot) {
    Mesh mesh = shapes::grid(4, 1);  // vertices 0…4 below, 5…9 above
    mesh.face_materials = {1, 1, 0, 0};
    mesh.face_parts = {0, 1, 2, 0};
    const VertexMesh out = split_of(mesh, nullptr, {.parts_apart = false, .threads = 0});
    EXPECT_EQ(out.vertex_count(), 12u);
    EXPECT_EQ(copies(out), std::vector<unsigned>(2, bits(SplitReason::material)));
    ASSERT_EQ(out.ranges.size(), 2u);
    for (std::uint32_t r = 0; r < 2; ++r) {
        EXPECT_EQ(out.ranges[r].material, r);
        EXPECT_EQ(out.ranges[r].part, no_index);
        EXPECT_EQ(out.ranges[r].triangle_count, 4u);
    }
    EXPECT_EQ(out.triangle_faces, (Indices{2, 2, 3, 3, 0, 0, 1, 1}));
    mesh.face_parts.clear();
    split_oracle::expect_right(mesh, out);
    mesh.face_materials.clear();
    mesh.face_parts = {0, 1, 2, 3};
    const VertexMesh names = split_of(mesh, nullptr, {.parts_apart = false, .threads = 0});
    EXPECT_EQ(names.vertex_count(), 10u);
    EXPECT_EQ(names.ranges.size(), 1u);
}

TEST(Split, RangesAreSortedByPartThenMaterialInSourceOrder) {
    Mesh mesh = shapes::grid(6, 1);
    mesh.face_parts = {1, 0, 1, 0, 1, 0};
    mesh.face_materials = {0, 5, 1, 3, 0, 3};
    const VertexMesh out = split_of(mesh);
    split_oracle::expect_right(mesh, out);
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
    split_oracle::expect_right(mesh, out);
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
    split_oracle::expect_right(mesh, out);
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
        split_oracle::expect_right(mesh, split_of(mesh));
    }
}

// Layers that have their vertices' numbers are read by vertex: those that have them up to some
// corner, or from one on, are not.
TEST(Split, LayersThatFollowVerticesInPartAreReadByCorner) {
    for (const bool from_the_end : {false, true}) {
        Mesh mesh = shapes::grid(6, 4);
        prep::CornerLayer<glm::vec2>& uvs = mesh.uvs.emplace_back();
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
            uvs.values.emplace_back(float(v), 0.5f);
        uvs.indices = mesh.corner_vertices;
        const std::size_t corner = from_the_end ? 1 : mesh.corner_count() - 2;
        uvs.indices[corner] = uvs.indices[corner] == 0 ? 1 : 0;
        const VertexMesh out = split_of(mesh);
        for (std::size_t c = 0; c < mesh.corner_count(); ++c)
            EXPECT_EQ(out.uvs[0][out.corner_vertices[c]], uvs.values[uvs.indices[c]]) << c;
        split_oracle::expect_right(mesh, out);
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

// Copies of a vertex are compared one by one up to twelve or so, by hash beyond: some steps each.
// All with one another would be 5·10⁹.
TEST(Split, FlatPoleOfHundredThousandFacesTakesLinearTime) {
    Mesh mesh = shapes::fan(100'000);
    HardEdgeOptions flat;
    flat.angle_degrees = 0;
    const HardEdges hard = add_normals(mesh, flat);
    VertexMesh out;
    const std::uint64_t steps = test::steps_of([&] { out = split_of(mesh, &hard); });
    EXPECT_GT(steps, 0u);
    EXPECT_LE(steps, 2u * 100'000u);
    EXPECT_GT(out.vertex_count(), 200'000u);  // neighbours share a normal by rounding at times
}

TEST(Split, FacesOfManyMaterialsOrPartsOnTheSameVerticesTakeLinearTime) {
    constexpr std::uint32_t count = 20'000;
    for (const bool parts : {false, true}) {
        Mesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        for (std::uint32_t f = 0; f < count; ++f) {
            mesh.corner_vertices.insert(mesh.corner_vertices.end(), {0, 1, 2});
            mesh.face_offsets.push_back(3 * f + 3);
            (parts ? mesh.face_parts : mesh.face_materials).push_back(f);
        }
        VertexMesh out;
        const std::uint64_t steps = test::steps_of([&] { out = split_of(mesh); });
        EXPECT_EQ(out.vertex_count(), 3 * count);
        EXPECT_GT(steps, 0u);
        EXPECT_LE(steps, 10 * std::uint64_t(count));
    }
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

// The corners by vertex may come from who has them already.
TEST(Split, WithCornersByVertexIsTheSame) {
    std::mt19937_64 random(13);
    Mesh mesh = shapes::fan_triangulated(shapes::torus(60, 30));
    shapes::jitter(mesh, 0.05f, random);
    mesh = shapes::joined(mesh, shapes::grid(4, 3));
    mesh.positions.push_back({7, 7, 7});  // no face's
    const HardEdges hard = add_normals(mesh, {.angle_degrees = 20});
    for (const int threads : {1, 4}) {
        const auto around =
            prep::detail::corners_by_vertex(mesh.corner_vertices, mesh.vertex_count(), threads);
        const VertexMesh one = split_of(mesh, &hard, {.threads = threads});
        const auto other = prep::detail::split_vertices(mesh, &hard, &around, {.threads = threads});
        ASSERT_TRUE(other.has_value());
        ASSERT_GT(one.vertex_count(), mesh.vertex_count());
        EXPECT_EQ(other->positions, one.positions);
        EXPECT_EQ(other->normals, one.normals);
        EXPECT_EQ(other->indices, one.indices);
        EXPECT_EQ(other->corner_vertices, one.corner_vertices);
        EXPECT_EQ(other->source_vertices, one.source_vertices);
        EXPECT_EQ(other->source_corners, one.source_corners);
        EXPECT_EQ(other->split_reasons, one.split_reasons);
    }
}

}  // namespace
