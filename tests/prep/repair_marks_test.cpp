// Hard marks, creases and sharp vertices name vertices: what becomes of them where a repair gives
// faces other ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "prep/repair.h"

namespace {

using prep::Mesh;
using prep::RepairOptions;

void apply(Mesh& mesh, const RepairOptions& options) {
    const auto log = prep::repair(mesh, options);
    ASSERT_TRUE(log) << to_string(log.error());
    ASSERT_EQ(log->size(), 1u);
    EXPECT_GT(log->front().changed, 0u);
}

using Edges = std::set<std::array<std::uint32_t, 2>>;
Edges marked(const Mesh& mesh) {
    Edges edges;
    for (const glm::uvec2& m : mesh.hard_marks)
        edges.insert({std::min(m.x, m.y), std::max(m.x, m.y)});
    EXPECT_EQ(edges.size(), mesh.hard_marks.size());
    Edges creased;
    for (const prep::EdgeMark& m : mesh.subdivision.creases) {
        creased.insert({std::min(m.v0, m.v1), std::max(m.v0, m.v1)});
        EXPECT_EQ(m.sharpness, 3);
    }
    EXPECT_EQ(creased, edges);
    return edges;
}
void mark(Mesh& mesh, std::uint32_t a, std::uint32_t b) {
    mesh.hard_marks.push_back({a, b});
    mesh.subdivision.creases.push_back({b, a, 3});
}

// Two tetrahedra that meet in vertex 0, of which the second gets a copy: what names an edge or the
// vertex names the copy's too.
TEST(RepairMarks, FollowVerticesThatAreSplit) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0}, {0, 0, 1},
                      {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    for (const std::uint32_t k : {0, 3}) {
        const std::uint32_t a = 1 + k, b = 2 + k, c = 3 + k;
        for (const std::uint32_t v : {0u, b, a, 0u, c, b, 0u, a, c, a, b, c})
            mesh.corner_vertices.push_back(v);
    }
    mesh.face_offsets = {0, 3, 6, 9, 12, 15, 18, 21, 24};
    mark(mesh, 0, 1);
    mark(mesh, 4, 0);
    mark(mesh, 5, 6);
    mark(mesh, 1, 4);  // no edge at all
    mesh.subdivision.corners = {{0, 2}, {5, 1}};
    RepairOptions options;
    options.non_manifold_vertices = true;
    apply(mesh, options);
    ASSERT_EQ(mesh.vertex_count(), 8u);
    EXPECT_EQ(marked(mesh), (Edges{{0, 1}, {4, 7}, {5, 6}, {1, 4}}));
    const std::vector<prep::VertexMark> corners = {{0, 2}, {5, 1}, {7, 2}};
    EXPECT_EQ(mesh.subdivision.corners, corners);
}

// A floor of two quads with a wall on the marked edge between them: the wall's foot is an edge of
// its own afterwards, and marked as the floor's is.
TEST(RepairMarks, StayOnBothSidesOfAnEdgeThatIsSplit) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0},
                      {1, 1, 0}, {2, 1, 0}, {1, 0, 1}, {1, 1, 1}};
    mesh.corner_vertices = {0, 1, 4, 3, 1, 2, 5, 4, 1, 4, 7, 6};
    mesh.face_offsets = {0, 4, 8, 12};
    mark(mesh, 1, 4);
    mark(mesh, 6, 1);
    RepairOptions options;
    options.non_manifold_edges = true;
    apply(mesh, options);
    ASSERT_EQ(mesh.vertex_count(), 10u);
    const std::uint32_t a = mesh.corner_vertices[8], b = mesh.corner_vertices[9];
    ASSERT_GE(std::min(a, b), 8u);  // the wall has the copies
    EXPECT_EQ(marked(mesh), (Edges{{1, 4}, {8, 9}, {6, a}}));
}

// The flat triangle's vertex is put into its neighbour's edge, which is marked in both parts.
TEST(RepairMarks, FollowEdgesThatAreCut) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0.5f, 0.5f, 0}};
    mesh.corner_vertices = {0, 1, 2, 0, 2, 4, 0, 4, 3, 4, 2, 3};
    mesh.face_offsets = {0, 3, 6, 9, 12};
    mark(mesh, 2, 0);
    mark(mesh, 1, 2);
    RepairOptions options;
    options.degenerate_faces = true;
    apply(mesh, options);
    EXPECT_EQ(marked(mesh), (Edges{{0, 4}, {2, 4}, {1, 2}}));
}

// The same where the flat triangle has vertices of its own, by which the edge is marked.
TEST(RepairMarks, OfRepeatedPointsFollowEdgesThatAreCut) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0},       {2, 0, 0}, {2, 2, 0}, {0, 2, 0},
                      {0.5f, 0.5f, 0}, {0, 0, 0}, {2, 2, 0}};
    mesh.corner_vertices = {0, 1, 2, 5, 6, 4, 5, 4, 3, 4, 6, 3};
    mesh.face_offsets = {0, 3, 6, 9, 12};
    mark(mesh, 6, 5);
    RepairOptions options;
    options.degenerate_faces = true;
    apply(mesh, options);
    EXPECT_EQ(marked(mesh), (Edges{{0, 4}, {2, 4}}));
}

}  // namespace
