// Defects planted in known meshes are found, repaired and logged; a clean mesh keeps its bits.
// What is odd is told by check(), which repair() does not call.
#include "prep/repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "prep/check.h"
#include "prep/prepare.h"
#include "shapes.h"

namespace {

using prep::Mesh;
using prep::RepairOptions;

// A cube of quads from `low` of edge length `size`, outward, with vertices of its own.
void add_cube(Mesh& mesh, const glm::vec3& low, float size) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back(
            low + size * glm::vec3(float(i & 1), float(i >> 1 & 1), float(i >> 2 & 1)));
    for (const std::uint32_t v :
         {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5})
        mesh.corner_vertices.push_back(base + v);
    for (int f = 0; f < 6; ++f) mesh.face_offsets.push_back(mesh.face_offsets.back() + 4);
}

Mesh cube() {
    Mesh mesh;
    mesh.name = "cube";
    add_cube(mesh, glm::vec3(0), 1);
    return mesh;
}

void add_uvs(Mesh& mesh) {
    mesh.uvs.resize(1);
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        mesh.uvs[0].values.push_back({float(c), float(c) / 2});
        mesh.uvs[0].indices.push_back(c);
    }
}

RepairOptions everything() {
    RepairOptions all;
    all.weld_tolerance = 0;
    all.degenerate_faces = all.duplicate_faces = all.non_manifold_edges = true;
    all.non_manifold_vertices = all.orientation = all.outward = all.isolated_vertices = true;
    all.hole_edges = 100;
    return all;
}

std::uint64_t found(const Mesh& mesh, const std::string& kind) {
    for (const prep::Finding& f : prep::check(mesh).findings)
        if (f.kind == kind) return f.count;
    return 0;
}

prep::RepairStep only_step(Mesh& mesh, const RepairOptions& options) {
    const auto log = prep::repair(mesh, options);
    EXPECT_TRUE(log.has_value());
    EXPECT_EQ(log->size(), 1u);
    return log->at(0);
}

bool same(const Mesh& a, const Mesh& b) {
    return a.positions == b.positions && a.face_offsets == b.face_offsets &&
           a.corner_vertices == b.corner_vertices && a.normals.indices == b.normals.indices &&
           a.normals.values == b.normals.values && a.file_vertices == b.file_vertices;
}

TEST(Repair, ACleanMeshKeepsItsBits) {
    Mesh mesh = cube();
    add_uvs(mesh);
    const Mesh before = mesh;
    const auto log = prep::repair(mesh, everything());
    ASSERT_TRUE(log.has_value());
    EXPECT_EQ(log->size(), 9u);
    for (const prep::RepairStep& step : *log) {
        EXPECT_EQ(step.changed, 0u) << step.step;
        EXPECT_EQ(step.left, 0u) << step.step;
    }
    EXPECT_TRUE(same(mesh, before));
    EXPECT_EQ(mesh.uvs[0].values, before.uvs[0].values);
    EXPECT_EQ(mesh.uvs[0].indices, before.uvs[0].indices);
}

TEST(Repair, EmptyMeshIsFine) {
    Mesh mesh;
    ASSERT_TRUE(prep::repair(mesh, everything()).has_value());
    EXPECT_EQ(mesh.face_count(), 0u);
}

TEST(Repair, BadToleranceIsAnErrorAndChangesNothing) {
    Mesh mesh = cube();
    const Mesh before = mesh;
    RepairOptions options;
    for (const double bad : {-1.0, std::nan(""), HUGE_VAL}) {
        options.weld_tolerance = bad;
        const auto log = prep::repair(mesh, options);
        ASSERT_FALSE(log.has_value());
        EXPECT_EQ(log.error().code, prep::ErrorCode::invalid);
        EXPECT_TRUE(same(mesh, before));
    }
}

TEST(Repair, WeldsWithinTheToleranceOnly) {
    // Two quads whose common edge is off by 0.001; a third vertex near is off by 0.01.
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0},      {0, 1, 0},    {1.001f, 0, 0},
                      {2, 0, 0}, {2, 1, 0}, {1, 1.001f, 0}, {0, 1.01f, 0}};
    mesh.corner_vertices = {0, 1, 2, 3, 4, 5, 6, 7, 3, 2, 8};
    mesh.face_offsets = {0, 4, 8, 11};
    RepairOptions options;
    options.weld_tolerance = 0.002;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 2u);
    EXPECT_EQ(step.places, (std::vector<std::uint32_t>{4, 7}));
    EXPECT_EQ(mesh.corner_vertices, (std::vector<std::uint32_t>{0, 1, 2, 3, 1, 5, 6, 2, 3, 2, 8}));
}

// Below the grid of floats only what is equal is within it.
TEST(Repair, TinyTolerancesWeldWhatIsEqual) {
    Mesh mesh;
    for (int k = 0; k < 30; ++k) {
        const float x = float(k % 15) - 7;
        mesh.positions.insert(mesh.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 1e-20f}});
        for (int c = 0; c < 3; ++c)
            mesh.corner_vertices.push_back(std::uint32_t(mesh.corner_vertices.size()));
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    RepairOptions exact;
    exact.weld_tolerance = 0;
    Mesh expected = mesh;
    const prep::RepairStep step = only_step(expected, exact);
    EXPECT_GT(step.changed, 45u);
    for (const double tolerance : {1e-25, 1e-60, 5e-324}) {
        Mesh welded = mesh;
        RepairOptions options;
        options.weld_tolerance = tolerance;
        EXPECT_EQ(only_step(welded, options).changed, step.changed) << tolerance;
        EXPECT_EQ(welded.corner_vertices, expected.corner_vertices) << tolerance;
    }
}

TEST(Repair, DropsFacesThatRepeatAPoint) {
    Mesh mesh = cube();
    add_uvs(mesh);
    // A quad that is a triangle, and a triangle that is an edge.
    mesh.positions.insert(mesh.positions.end(), {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}});
    for (const std::uint32_t v : {8u, 9u, 9u, 10u, 8u, 9u, 9u}) {
        mesh.corner_vertices.push_back(v);
        mesh.uvs[0].indices.push_back(v);
    }
    mesh.face_offsets.insert(mesh.face_offsets.end(), {28, 31});
    EXPECT_EQ(found(mesh, "repeated-vertex-face"), 2u);
    RepairOptions options;
    options.degenerate_faces = true;
    EXPECT_EQ(only_step(mesh, options).changed, 2u);
    EXPECT_EQ(found(mesh, "repeated-vertex-face"), 0u);
    ASSERT_EQ(mesh.face_count(), 7u);
    EXPECT_EQ(mesh.face_offsets.back(), 27u);
    EXPECT_EQ(mesh.uvs[0].indices.size(), 27u);
    EXPECT_EQ(mesh.uvs[0].indices[24], 8u);
    EXPECT_EQ(mesh.uvs[0].indices[26], 10u);
}

TEST(Repair, NamesDegenerateFacesByTheirNumberBefore) {
    // An edge as a triangle, a good triangle, a flat one, and a quad that is flat and repeats.
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {7, 0, 0}};
    mesh.corner_vertices = {0, 1, 1, 0, 1, 2, 3, 4, 5, 3, 4, 4, 5};
    mesh.face_offsets = {0, 3, 6, 9, 13};
    RepairOptions options;
    options.degenerate_faces = true;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 3u);
    EXPECT_EQ(step.places, (std::vector<std::uint32_t>{0, 2, 3}));
    EXPECT_EQ(mesh.corner_vertices, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(Repair, AFlatTriangleLeavesNoCrack) {
    // A square of two triangles with a flat one between: the middle vertex lies on the diagonal.
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0.5f, 0.5f, 0}};
    mesh.corner_vertices = {0, 1, 2, 0, 2, 4, 0, 4, 3, 4, 2, 3};
    mesh.face_offsets = {0, 3, 6, 9, 12};
    mesh.uvs.resize(1);
    for (const std::uint32_t v : mesh.corner_vertices) {
        mesh.uvs[0].indices.push_back(static_cast<std::uint32_t>(mesh.uvs[0].values.size()));
        mesh.uvs[0].values.push_back(glm::vec2(mesh.positions[v]));
    }
    EXPECT_EQ(found(mesh, "zero-area-face"), 1u);
    EXPECT_EQ(found(mesh, "open-edge"), 4u);
    RepairOptions options;
    options.degenerate_faces = true;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.places, std::vector<std::uint32_t>{1});
    EXPECT_EQ(found(mesh, "zero-area-face"), 0u);
    EXPECT_EQ(found(mesh, "open-edge"), 4u);
    EXPECT_EQ(mesh.face_count(), 3u);
    // The vertex that the neighbour was given has the UV of its place on the edge.
    const auto at = std::find(mesh.corner_vertices.begin(), mesh.corner_vertices.begin() + 4, 4u);
    ASSERT_NE(at, mesh.corner_vertices.begin() + 4);
    const auto c = static_cast<std::size_t>(at - mesh.corner_vertices.begin());
    EXPECT_EQ(mesh.uvs[0].values[mesh.uvs[0].indices[c]], glm::vec2(0.5f, 0.5f));
}

TEST(Repair, DropsDuplicateFacesAndKeepsTwoSidedOnes) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.corner_vertices = {0, 1, 2, 1, 2, 0, 2, 1, 0};
    mesh.face_offsets = {0, 3, 6, 9};
    mesh.face_materials = {7, 8, 9};
    RepairOptions options;
    options.duplicate_faces = true;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.places, std::vector<std::uint32_t>{1});
    EXPECT_EQ(mesh.face_materials, (std::vector<std::uint32_t>{7, 9}));
}

TEST(Repair, CubesThatShareAnEdgeBecomeTwoSolids) {
    Mesh mesh = cube();
    add_cube(mesh, glm::vec3(1, 1, 0), 1);
    RepairOptions weld;
    weld.weld_tolerance = 0;
    ASSERT_TRUE(prep::repair(mesh, weld).has_value());
    ASSERT_EQ(found(mesh, "non-manifold-edge"), 1u);
    RepairOptions options;
    options.non_manifold_edges = true;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    const prep::MeshSummary summary = prep::check(mesh).summary;
    EXPECT_EQ(summary.non_manifold_edges, 0u);
    EXPECT_EQ(summary.components, 2u);
    EXPECT_TRUE(summary.closed);
    EXPECT_DOUBLE_EQ(summary.volume, 2.0);
    EXPECT_EQ(mesh.file_vertices.size(), mesh.vertex_count());
}

// What is done is not told again.
TEST(Repair, ASecondRunFindsSheetsWithTheirVertices) {
    Mesh mesh;
    add_cube(mesh, glm::vec3(0), 1);
    add_cube(mesh, {1, 1, 0}, 1);
    mesh.positions.push_back({5, 5, 5});
    mesh.positions.push_back({5, 5, 5});  // nobody's
    RepairOptions options;
    options.weld_tolerance = 0;
    options.non_manifold_edges = true;
    const auto first = prep::repair(mesh, options);
    ASSERT_TRUE(first) << to_string(first.error());
    EXPECT_EQ(first->at(0).changed, 2u);  // points of the edge
    EXPECT_EQ(first->at(1).changed, 1u);
    EXPECT_EQ(first->at(1).left, 0u);
    options.weld_tolerance.reset();
    const auto second = prep::repair(mesh, options);
    ASSERT_TRUE(second) << to_string(second.error());
    EXPECT_EQ(second->at(0).changed, 0u);
    EXPECT_EQ(second->at(0).left, 0u);
    EXPECT_TRUE(second->at(0).places.empty());
}

TEST(Repair, AThirdFaceOnAnEdgeGetsItsOwnVertices) {
    // A floor of two quads with a wall on the edge between them.
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0},
                      {1, 1, 0}, {2, 1, 0}, {1, 0, 1}, {1, 1, 1}};
    mesh.corner_vertices = {0, 1, 4, 3, 1, 2, 5, 4, 1, 4, 7, 6};
    mesh.face_offsets = {0, 4, 8, 12};
    ASSERT_EQ(found(mesh, "non-manifold-edge"), 1u);
    RepairOptions options;
    options.non_manifold_edges = true;
    only_step(mesh, options);
    const prep::MeshSummary summary = prep::check(mesh).summary;
    EXPECT_EQ(summary.non_manifold_edges, 0u);
    EXPECT_EQ(summary.components, 2u);
    EXPECT_EQ(mesh.vertex_count(), 10u);
}

TEST(Repair, AFaceOnAnInnerEdgeOfASurfaceLeavesTheSurfaceWhole) {
    // Four by four quads; a triangle stands on an edge in their middle. Whichever way it runs.
    for (const bool reversed : {false, true}) {
        Mesh mesh = shapes::grid(4, 4);
        mesh.positions.push_back({2, 2, 1});
        const std::uint32_t a = 2 * 5 + 1, b = 2 * 5 + 2;
        for (const std::uint32_t v : {reversed ? b : a, reversed ? a : b, 25u})
            mesh.corner_vertices.push_back(v);
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        ASSERT_EQ(found(mesh, "non-manifold-edge"), 1u);
        RepairOptions options;
        options.non_manifold_edges = true;
        const prep::RepairStep step = only_step(mesh, options);
        EXPECT_EQ(step.changed, 1u);
        EXPECT_EQ(step.left, 0u);
        const prep::MeshSummary summary = prep::check(mesh).summary;
        EXPECT_EQ(summary.non_manifold_edges, 0u);
        EXPECT_EQ(summary.components, 2u);
        EXPECT_EQ(summary.open_edges, 16u + 3u);
        EXPECT_EQ(mesh.vertex_count(), 28u);
    }
}

TEST(Repair, AnEdgeOfSixtyThousandFacesBecomesThirtyThousandWedges) {
    constexpr std::uint32_t faces = 60000;
    Mesh mesh;
    mesh.positions = {{0, 0, -1}, {0, 0, 1}};
    mesh.face_offsets = {0};
    for (std::uint32_t i = 0; i < faces; ++i) {
        const double angle = 2 * std::numbers::pi * i / faces;
        mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0);
        const bool upward = i % 2 == 1;
        for (const std::uint32_t v : {upward ? 0u : 1u, upward ? 1u : 0u, i + 2})
            mesh.corner_vertices.push_back(v);
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    RepairOptions options;
    options.non_manifold_edges = true;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.left, 0u);
    const prep::MeshSummary summary = prep::check(mesh).summary;
    EXPECT_EQ(summary.components, faces / 2);
    EXPECT_EQ(summary.non_manifold_edges, 0u);
    EXPECT_EQ(mesh.vertex_count(), 2 * faces);
}

TEST(Repair, AVertexOfFortyThousandFacesThatTouchIsSplitIntoAsMany) {
    constexpr std::uint32_t faces = 40000;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}};
    mesh.face_offsets = {0};
    for (std::uint32_t i = 0; i < faces; ++i) {
        const float x = static_cast<float>(i);
        mesh.positions.emplace_back(x, 1.0f, 0.0f);
        mesh.positions.emplace_back(x, 1.0f, 1.0f);
        for (const std::uint32_t v : {0u, 2 * i + 1, 2 * i + 2}) mesh.corner_vertices.push_back(v);
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    RepairOptions options;
    options.non_manifold_vertices = true;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(mesh.vertex_count(), 3 * faces);
    EXPECT_EQ(prep::check(mesh).summary.components, faces);
}

TEST(Repair, SplitsABowTie) {
    Mesh mesh = cube();
    add_cube(mesh, glm::vec3(1, 1, 1), 1);
    RepairOptions weld;
    weld.weld_tolerance = 0;
    ASSERT_TRUE(prep::repair(mesh, weld).has_value());
    ASSERT_EQ(found(mesh, "non-manifold-vertex"), 1u);
    RepairOptions options;
    options.non_manifold_vertices = true;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.places, std::vector<std::uint32_t>{7});
    EXPECT_EQ(found(mesh, "non-manifold-vertex"), 0u);
    // Only the vertex is split: edges of three faces are another step's.
    EXPECT_EQ(mesh.vertex_count(), 17u);
}

TEST(Repair, TurnsTheFewerFacesAndTheirNormals) {
    Mesh mesh = cube();
    std::reverse(mesh.corner_vertices.begin() + 5, mesh.corner_vertices.begin() + 8);
    // Normals as the turned face has them: inward there, outward elsewhere.
    const glm::vec3 outward[6] = {{0, 0, -1}, {0, 0, 1},  {0, -1, 0},
                                  {0, 1, 0},  {-1, 0, 0}, {1, 0, 0}};
    for (std::uint32_t f = 0; f < 6; ++f) {
        mesh.normals.values.push_back(f == 1 ? -outward[f] : outward[f]);
        for (int k = 0; k < 4; ++k) mesh.normals.indices.push_back(f);
    }
    EXPECT_GT(found(mesh, "mixed-orientation"), 0u);
    RepairOptions options;
    options.orientation = true;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.places, std::vector<std::uint32_t>{1});
    const prep::MeshSummary summary = prep::check(mesh).summary;
    EXPECT_TRUE(summary.oriented);
    EXPECT_DOUBLE_EQ(summary.volume, 1.0);
    for (std::uint32_t c = 4; c < 8; ++c)
        EXPECT_EQ(mesh.normals.values[mesh.normals.indices[c]], outward[1]);
    EXPECT_EQ(found(mesh, "flipped-normal"), 0u);
}

TEST(Repair, AMoebiusStripKeepsASeamAndSaysSo) {
    Mesh mesh;
    constexpr int steps = 12;
    for (int i = 0; i < steps; ++i) {
        const double a = 2 * 3.14159265358979 * i / steps;
        for (const double r : {-0.3, 0.3})
            mesh.positions.push_back({float(std::cos(a) * (1 + r * std::cos(a / 2))),
                                      float(std::sin(a) * (1 + r * std::cos(a / 2))),
                                      float(r * std::sin(a / 2))});
    }
    for (std::uint32_t i = 0; i < steps; ++i) {
        const bool last = i + 1 == steps;
        const std::uint32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
        for (const std::uint32_t v : {a, c, d, b}) mesh.corner_vertices.push_back(v);
        mesh.face_offsets.push_back(4 * (i + 1));
    }
    RepairOptions options;
    options.orientation = true;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.left, 1u);
    EXPECT_EQ(found(mesh, "mixed-orientation"), 1u);
}

TEST(Repair, TurnsShellsOutwardButNotCavities) {
    Mesh mesh = cube();
    add_cube(mesh, glm::vec3(3, 0, 0), 1);                 // will be inside out
    add_cube(mesh, glm::vec3(0.25f, 0.25f, 0.25f), 0.5f);  // a cavity
    for (std::size_t f = 6; f < 18; ++f)
        std::reverse(mesh.corner_vertices.begin() + mesh.face_offsets[f] + 1,
                     mesh.corner_vertices.begin() + mesh.face_offsets[f + 1]);
    ASSERT_EQ(found(mesh, "inside-out-shell"), 1u);
    RepairOptions options;
    options.outward = true;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.places, std::vector<std::uint32_t>{6});
    EXPECT_EQ(found(mesh, "inside-out-shell"), 0u);
    EXPECT_DOUBLE_EQ(prep::check(mesh).summary.volume, 2.0 - 0.125);
}

TEST(Repair, FillsAHoleWithTheRimsAttributes) {
    Mesh mesh = cube();
    add_uvs(mesh);
    mesh.face_materials = {0, 0, 0, 0, 0, 0};
    // The last face goes.
    mesh.corner_vertices.resize(20);
    mesh.uvs[0].indices.resize(20);
    mesh.face_offsets.pop_back();
    mesh.face_materials = {3, 3, 3, 3, 3};
    ASSERT_EQ(found(mesh, "hole"), 1u);
    RepairOptions options;
    options.hole_edges = 3;
    EXPECT_EQ(only_step(mesh, options).left, 1u);
    EXPECT_EQ(mesh.face_count(), 5u);
    options.hole_edges = 4;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.left, 0u);
    const prep::MeshSummary summary = prep::check(mesh).summary;
    EXPECT_TRUE(summary.closed);
    EXPECT_TRUE(summary.oriented);
    EXPECT_DOUBLE_EQ(summary.volume, 1.0);
    EXPECT_EQ(mesh.face_materials, (std::vector<std::uint32_t>{3, 3, 3, 3, 3, 3, 3}));
    EXPECT_EQ(mesh.uvs[0].indices.size(), mesh.corner_count());
}

TEST(Repair, FillsANonPlanarHoleOfASphereWithoutFolds) {
    Mesh mesh = shapes::uv_sphere(24, 12);
    const std::size_t faces = mesh.face_count();
    const double whole = prep::check(mesh).summary.volume;
    ASSERT_GT(whole, 0);
    // Faces in the middle of the list, with common edges: one hole.
    std::vector<std::uint32_t> vertices, offsets{0};
    for (std::size_t f = 0; f < faces; ++f) {
        if (f >= faces / 2 && f < faces / 2 + 5) continue;
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            vertices.push_back(mesh.corner_vertices[c]);
        offsets.push_back(static_cast<std::uint32_t>(vertices.size()));
    }
    mesh.corner_vertices = vertices;
    mesh.face_offsets = offsets;
    mesh.normals = {};
    mesh.uvs.clear();
    ASSERT_EQ(found(mesh, "hole"), 1u);
    RepairOptions options;
    options.hole_edges = 100;
    EXPECT_EQ(only_step(mesh, options).changed, 1u);
    const prep::MeshCheck after = prep::check(mesh);
    EXPECT_TRUE(after.summary.closed);
    EXPECT_TRUE(after.summary.manifold);
    EXPECT_NEAR(after.summary.volume, whole, 0.01 * whole);
    EXPECT_EQ(found(mesh, "folded-edge"), 0u);
}

TEST(Repair, RemovesIsolatedVerticesAndRenumbersMarks) {
    Mesh mesh = cube();
    mesh.positions.insert(mesh.positions.begin(), {9, 9, 9});
    for (std::uint32_t& v : mesh.corner_vertices) ++v;
    mesh.hard_marks = {{1, 2}, {0, 1}};
    mesh.subdivision.creases = {{1, 2, 3.0f}, {0, 5, 1.0f}};
    mesh.subdivision.corners = {{8, 2.0f}, {0, 1.0f}};
    RepairOptions options;
    options.isolated_vertices = true;
    const prep::RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.places, std::vector<std::uint32_t>{0});
    EXPECT_EQ(mesh.positions, cube().positions);
    EXPECT_EQ(mesh.corner_vertices, cube().corner_vertices);
    EXPECT_EQ(mesh.hard_marks, (std::vector<glm::uvec2>{{0, 1}}));
    EXPECT_EQ(mesh.subdivision.creases, (std::vector<prep::EdgeMark>{{0, 1, 3.0f}}));
    EXPECT_EQ(mesh.subdivision.corners, (std::vector<prep::VertexMark>{{7, 2.0f}}));
    EXPECT_EQ(mesh.file_vertices.front(), 1u);
}

TEST(Repair, NonFinitePositionsAreLeftAlone) {
    Mesh mesh = cube();
    mesh.positions[3] = {NAN, 0, 0};
    mesh.positions[5] = {HUGE_VALF, 0, 0};
    EXPECT_TRUE(prep::repair(mesh, everything()).has_value());
}

TEST(Repair, PrepareLogsItAndStaysSilentOtherwise) {
    Mesh mesh = cube();
    mesh.corner_vertices.resize(20);
    mesh.face_offsets.pop_back();
    prep::Scene scene;
    scene.meshes.push_back(mesh);
    prep::instance_unused_meshes(scene);
    EXPECT_TRUE(prep::prepare(scene)->repairs.empty());
    prep::PrepareOptions options;
    options.repair.hole_edges = 10;
    const auto prepared = prep::prepare(scene, options);
    ASSERT_TRUE(prepared.has_value());
    ASSERT_EQ(prepared->repairs.size(), 1u);
    EXPECT_EQ(prepared->repairs[0].step, "holes");
    EXPECT_EQ(prepared->repairs[0].changed, 1u);
    EXPECT_EQ(prepared->meshes[0].triangle_count(), 12u);
}

}  // namespace
