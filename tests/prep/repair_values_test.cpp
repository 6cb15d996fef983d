// What each step of repair() leaves behind, by value: attributes, marks, numbers, and which of the
// possible repairs it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "prep/check.h"
#include "prep/repair.h"
#include "shapes.h"

namespace {

using prep::Mesh;
using prep::no_index;
using prep::RepairOptions;
using prep::RepairStep;
using Indices = std::vector<std::uint32_t>;

RepairStep only_step(Mesh& mesh, const RepairOptions& options) {
    const auto log = prep::repair(mesh, options);
    EXPECT_TRUE(log.has_value());
    EXPECT_EQ(log->size(), 1u);
    return log->at(0);
}

RepairStep weld(Mesh& mesh, double tolerance) {
    RepairOptions options;
    options.weld_tolerance = tolerance;
    return only_step(mesh, options);
}

RepairStep degenerate(Mesh& mesh) {
    RepairOptions options;
    options.degenerate_faces = true;
    return only_step(mesh, options);
}

RepairStep split_edges(Mesh& mesh) {
    RepairOptions options;
    options.non_manifold_edges = true;
    return only_step(mesh, options);
}

RepairStep turn(Mesh& mesh) {
    RepairOptions options;
    options.orientation = true;
    return only_step(mesh, options);
}

TEST(RepairValues, TheLogNamesStepsPlacesAndTheMesh) {
    Mesh mesh = shapes::cube();
    RepairOptions all;
    all.weld_tolerance = 0;
    all.degenerate_faces = all.duplicate_faces = all.non_manifold_edges = true;
    all.non_manifold_vertices = all.orientation = all.outward = all.isolated_vertices = true;
    all.hole_edges = 9;
    const auto log = prep::repair(mesh, all, 5);
    ASSERT_TRUE(log.has_value());
    using enum prep::PlaceKind;
    const std::pair<const char*, prep::PlaceKind> expected[] = {
        {"weld", vertex}, {"degenerate", face}, {"duplicates", face},
        {"edges", edge},  {"vertices", vertex}, {"orientation", face},
        {"holes", edge},  {"outward", face},    {"isolated", vertex}};
    ASSERT_EQ(log->size(), std::size(expected));
    for (std::size_t i = 0; i < log->size(); ++i) {
        EXPECT_EQ(log->at(i).step, expected[i].first);
        EXPECT_EQ(log->at(i).place_kind, expected[i].second) << expected[i].first;
        EXPECT_EQ(log->at(i).mesh, 5u);
    }
}

// "Within" is up to the distance itself: 3² + 4² = 5², exactly.
TEST(RepairValues, WeldsUpToTheDistanceItself) {
    for (const bool farther : {false, true}) {
        Mesh mesh;
        mesh.positions = {{0, 0, 0}, {3, 4, farther ? 0.001f : 0}};
        mesh.points = {0, 1};
        EXPECT_EQ(weld(mesh, 5.0).changed, farther ? 0u : 1u);
    }
}

// The tolerance's grid has cells of its own size: a near vertex may lie in any neighbouring one.
TEST(RepairValues, WeldsAcrossTheGridInAnyDirection) {
    for (int k = 0; k < 27; ++k) {
        const glm::vec3 by(float(k % 3 - 1), float(k / 3 % 3 - 1), float(k / 9 - 1));
        for (const float side : {0.01f, 0.99f}) {
            Mesh mesh = shapes::polygon({{5, 0, 0}, {5, 9, 0}, {5, 0, 9}});
            const glm::vec3 at = glm::vec3(side) + glm::vec3(40.0f);
            mesh.positions.push_back(at);
            mesh.positions.push_back(at + 0.55f * by);  // at most 0.953 away
            mesh.points = {3, 4};
            const RepairStep step = weld(mesh, 1.0);
            EXPECT_EQ(step.changed, 1u) << k;
            EXPECT_EQ(mesh.points, (Indices{3, 3})) << k << ' ' << side;
        }
    }
}

TEST(RepairValues, WeldsToTheEarliestVertexWithinReach) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1.5f, 0, 0}, {0.8f, 0, 0}, {2.4f, 0, 0}};
    mesh.points = {0, 1, 2, 3};
    const RepairStep step = weld(mesh, 1.0);
    // 2 is nearer to 1, but 0 came first; what 2 became is not where it was.
    EXPECT_EQ(mesh.points, (Indices{0, 1, 0, 1}));
    EXPECT_EQ(step.places, (Indices{2, 3}));
}

TEST(RepairValues, WeldsNothingAcrossParts) {
    for (const double tolerance : {0.0, 0.01}) {
        Mesh mesh = shapes::mesh_of({{0, 0, 0},
                                     {1, 0, 0},
                                     {0, 1, 0},  // part 0
                                     {1, 0, 0},
                                     {1, 1, 0},
                                     {0, 1, 0},  // part 1
                                     {0, 1, 0},
                                     {1, 1, 0},
                                     {0, 2, 0}},
                                    {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}});
        mesh.parts = {"", ""};
        mesh.face_parts = {0, 1, 1};
        mesh.tied_to_file = true;
        const RepairStep step = weld(mesh, tolerance);
        // At the common point of all three, both vertices of part 1 are one; so are those of its
        // other edge. Part 0 stays alone.
        EXPECT_EQ(mesh.corner_vertices, (Indices{0, 1, 2, 3, 4, 5, 5, 4, 8})) << tolerance;
        EXPECT_EQ(step.changed, 2u);
    }
}

// Groups of OBJ are names: they cut no vertex.
TEST(RepairValues, WeldsAcrossPartsThatAreNames) {
    for (const double tolerance : {0.0, 0.01}) {
        Mesh mesh =
            shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                            {{0, 1, 2}, {3, 4, 5}});
        mesh.parts = {"left", "right"};
        mesh.face_parts = {0, 1};
        weld(mesh, tolerance);
        EXPECT_EQ(mesh.corner_vertices, (Indices{0, 1, 2, 1, 4, 2})) << tolerance;
    }
}

TEST(RepairValues, WhatNamesVerticesFollowsAWeld) {
    Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                {{0, 1, 2}, {3, 4, 5}});
    mesh.hard_marks = {{3, 5}, {0, 4}};
    mesh.subdivision.creases = {{5, 3, 2.0f}, {4, 5, 1.0f}};
    mesh.subdivision.corners = {{5, 4.0f}};
    mesh.line_offsets = {0, 2};
    mesh.line_vertices = {4, 3};
    mesh.points = {5};
    mesh.file_vertices = {10, 11, 12, 13, 14, 15};
    weld(mesh, 0);
    EXPECT_EQ(mesh.corner_vertices, (Indices{0, 1, 2, 1, 4, 2}));
    EXPECT_EQ(mesh.hard_marks, (std::vector<glm::uvec2>{{1, 2}, {0, 4}}));
    EXPECT_EQ(mesh.subdivision.creases, (std::vector<prep::EdgeMark>{{2, 1, 2.0f}, {4, 2, 1.0f}}));
    EXPECT_EQ(mesh.subdivision.corners, (std::vector<prep::VertexMark>{{2, 4.0f}}));
    EXPECT_EQ(mesh.line_vertices, (Indices{4, 1}));
    EXPECT_EQ(mesh.points, Indices{2});
    // Corners keep the attributes of the file's vertices that they had.
    EXPECT_EQ(mesh.corner_file_vertices, (Indices{10, 11, 12, 13, 14, 15}));
}

TEST(RepairValues, HoleTagsKeepTheirFaces) {
    Mesh mesh = shapes::grid(5, 1);
    mesh.corner_vertices[5] = mesh.corner_vertices[4];  // face 1 becomes a triangle
    for (std::uint32_t c = 8; c < 12; ++c) mesh.corner_vertices[c] = 2;  // face 2 goes
    mesh.subdivision.holes = {0, 2, 3, 4};
    mesh.face_materials = {4, 5, 6, 7, 8};
    const RepairStep step = degenerate(mesh);
    EXPECT_EQ(step.places, (Indices{1, 2}));
    EXPECT_EQ(mesh.subdivision.holes, (Indices{0, 2, 3}));
    EXPECT_EQ(mesh.face_materials, (Indices{4, 5, 7, 8}));
}

// A square whose diagonal has a flat triangle on it; its middle vertex is a quarter along. The
// neighbour's diagonal is the edge from its corner number `first` on.
Mesh square_with_flat_triangle(std::uint32_t first) {
    const std::uint32_t cycle[3] = {0, 1, 2};  // the diagonal runs from 2 to 0
    Mesh mesh =
        shapes::mesh_of({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 1, 0}},
                        {{0, 4, 3},
                         {cycle[(first + 0) % 3], cycle[(first + 1) % 3], cycle[(first + 2) % 3]},
                         {4, 2, 3},
                         {0, 2, 4}});
    mesh.uvs.resize(2);
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
        mesh.uvs[0].values.emplace_back(p.x, 10 + p.y);
        mesh.uvs[0].indices.push_back(c);
        mesh.uvs[1].indices.push_back(c == 4 ? no_index : 0u);
        mesh.normals.indices.push_back(0);
        mesh.tangents.indices.push_back(0);
    }
    mesh.uvs[1].values = {{0.5f, 0.5f}};
    mesh.normals.values = {{0, 0, 1}};
    mesh.tangents.values = {{1, 0, 0, 1}};
    return mesh;
}

TEST(RepairValues, AVertexPutIntoAnEdgeHasTheAttributesOfItsPlace) {
    for (std::uint32_t first = 0; first < 3; ++first) {
        Mesh mesh = square_with_flat_triangle(first);
        const RepairStep step = degenerate(mesh);
        EXPECT_EQ(step.places, Indices{3});
        ASSERT_EQ(mesh.face_count(), 3u);
        EXPECT_EQ(mesh.face_offsets, (Indices{0, 3, 7, 10})) << first;
        // The quad still runs 0, 1, 2, and back by way of 4.
        Indices quad(mesh.corner_vertices.begin() + 3, mesh.corner_vertices.begin() + 7);
        const auto at = std::find(quad.begin(), quad.end(), 4u) - quad.begin();
        std::rotate(quad.begin(), std::find(quad.begin(), quad.end(), 0u), quad.end());
        EXPECT_EQ(quad, (Indices{0, 1, 2, 4})) << first;
        const std::uint32_t c = 3 + std::uint32_t(at);
        EXPECT_EQ(mesh.uvs[0].values[mesh.uvs[0].indices[c]], glm::vec2(1, 11)) << first;
        // A direction between two is computed later; what one end lacks, the place lacks.
        EXPECT_EQ(mesh.normals.indices[c], no_index);
        EXPECT_EQ(mesh.tangents.indices[c], no_index);
        EXPECT_EQ(mesh.corner_file_vertices[c], 4u);
        for (std::uint32_t k = 3; k < 7; ++k) {
            if (k == c) continue;
            EXPECT_EQ(mesh.normals.indices[k], 0u);
            const glm::vec3& p = mesh.positions[mesh.corner_vertices[k]];
            EXPECT_EQ(mesh.uvs[0].values[mesh.uvs[0].indices[k]], glm::vec2(p.x, 10 + p.y));
            EXPECT_EQ(mesh.corner_file_vertices[k], mesh.corner_vertices[k]);
        }
        EXPECT_EQ(prep::check(mesh).summary.open_edges, 4u);
    }
}

// Parts that are names share their vertices.
TEST(RepairValues, AFaceOfAnotherGroupGetsTheVertex) {
    Mesh mesh = square_with_flat_triangle(0);
    mesh.parts = {"", ""};
    mesh.face_parts = {1, 0, 1, 1};
    degenerate(mesh);
    EXPECT_EQ(mesh.face_offsets, (Indices{0, 3, 7, 10}));
    EXPECT_EQ(mesh.face_parts, (Indices{1, 0, 1}));
}

TEST(RepairValues, ATurnedFaceKeepsItsAttributesByVertex) {
    // Three quads in a row; the middle one is turned. Its tangents are shared with the others.
    Mesh mesh = shapes::grid(3, 1);
    std::reverse(mesh.corner_vertices.begin() + 4, mesh.corner_vertices.begin() + 8);
    mesh.uvs.resize(1);
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
        mesh.uvs[0].values.emplace_back(p.x, 1 - p.y);
        mesh.uvs[0].indices.push_back(c);
        mesh.tangents.indices.push_back(c < 4 ? 0 : 1);
        mesh.normals.indices.push_back(c >= 4 && c < 7 ? 1 : 0);
    }
    mesh.normals.values = {{0, 0, 1}, {0, 0, -1}};
    mesh.tangents.values = {{1, 0, 0, 1}, {0, 1, 0, -1}};
    const RepairStep step = turn(mesh);
    EXPECT_EQ(step.places, Indices{1});
    // As a grid has it, from the same first corner on.
    Indices row(mesh.corner_vertices.begin() + 4, mesh.corner_vertices.begin() + 8);
    std::rotate(row.begin(), std::find(row.begin(), row.end(), 1u), row.end());
    EXPECT_EQ(row, (Indices{1, 2, 6, 5}));
    std::multiset<float> signs;
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
        EXPECT_EQ(mesh.uvs[0].values[mesh.uvs[0].indices[c]], glm::vec2(p.x, 1 - p.y)) << c;
        // Normals that went with the old direction turn; the one that stood against it stays.
        EXPECT_EQ(mesh.normals.values[mesh.normals.indices[c]], glm::vec3(0, 0, 1)) << c;
        const glm::vec4 t = mesh.tangents.values[mesh.tangents.indices[c]];
        if (c < 4) {
            EXPECT_EQ(t, glm::vec4(1, 0, 0, 1));
        } else if (c >= 8) {
            EXPECT_EQ(t, glm::vec4(0, 1, 0, -1));
        } else {
            EXPECT_EQ(glm::vec3(t), glm::vec3(0, 1, 0));
            signs.insert(t.w);
        }
    }
    // w = B · (N × T) keeps B where N turns: three did.
    EXPECT_EQ(signs, (std::multiset<float>{-1, 1, 1, 1}));
}

TEST(RepairValues, OfTwoFacesThatDisagreeTheSecondTurns) {
    for (const std::size_t reversed : {0u, 1u}) {
        Mesh mesh = shapes::grid(2, 1);
        std::reverse(mesh.corner_vertices.begin() + long(4 * reversed),
                     mesh.corner_vertices.begin() + long(4 * reversed + 4));
        EXPECT_EQ(turn(mesh).places, Indices{1});
    }
}

TEST(RepairValues, AShellTurnsAsAWhole) {
    Mesh mesh = shapes::icosphere(2);
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        std::swap(mesh.corner_vertices[3 * f], mesh.corner_vertices[3 * f + 1]);
    const double volume = prep::check(mesh).summary.volume;
    ASSERT_LT(volume, 0);
    RepairOptions options;
    options.outward = true;
    const RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.places, Indices{0});
    const prep::MeshSummary after = prep::check(mesh).summary;
    EXPECT_TRUE(after.oriented);
    EXPECT_DOUBLE_EQ(after.volume, -volume);
}

// Pages about the z axis: third vertices at these angles, in degrees; upward ones run from vertex
// 0 below to vertex 1 above, and so face counter-clockwise.
Mesh pages(const std::vector<std::pair<double, bool>>& walls) {
    Mesh mesh;
    mesh.positions = {{0, 0, -1}, {0, 0, 1}};
    for (const auto& [degrees, upward] : walls) {
        const double angle = degrees * std::acos(-1.0) / 180;
        const auto tip = std::uint32_t(mesh.positions.size());
        mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0);
        for (const std::uint32_t v : {upward ? 0u : 1u, upward ? 1u : 0u, tip})
            mesh.corner_vertices.push_back(v);
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    return mesh;
}

// The faces that use a face's two spine vertices.
std::vector<std::set<std::uint32_t>> sheets(const Mesh& mesh) {
    std::vector<std::set<std::uint32_t>> result(mesh.face_count());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t g = 0; g < mesh.face_count(); ++g) {
            const auto spine = [&](std::uint32_t face) {
                const auto* c = &mesh.corner_vertices[3 * face];
                return std::set<std::uint32_t>{c[0], c[1]};
            };
            if (spine(f) == spine(g)) result[f].insert(g);
        }
    return result;
}

TEST(RepairValues, SolidWedgesKeepTheirTwoWalls) {
    using Set = std::set<std::uint32_t>;
    for (const double from : {0.0, 10.0, 77.0, 200.0, 345.0}) {
        // Two solids: from 0° to 30°, and from 165° to 195° past the direction opposite to the
        // first wall. Their walls face outward.
        Mesh mesh =
            pages({{from, false}, {from + 30, true}, {from + 165, false}, {from + 195, true}});
        const RepairStep step = split_edges(mesh);
        EXPECT_EQ(step.changed, 1u);
        EXPECT_EQ(step.places, Indices{0});
        EXPECT_EQ(sheets(mesh), (std::vector<Set>{{0, 1}, {0, 1}, {2, 3}, {2, 3}})) << from;
        EXPECT_EQ(mesh.vertex_count(), 8u);
        // The copies know where they come from.
        EXPECT_EQ(mesh.file_vertices, (Indices{0, 1, 2, 3, 4, 5, 0, 1}));
        // The same with the walls of the solids in another order.
        Mesh other =
            pages({{from + 195, true}, {from, false}, {from + 165, false}, {from + 30, true}});
        split_edges(other);
        EXPECT_EQ(sheets(other), (std::vector<Set>{{0, 2}, {1, 3}, {0, 2}, {1, 3}})) << from;
    }
}

TEST(RepairValues, CopiesOfAVertexHaveItsColorAndItsNumberInTheFile) {
    Mesh mesh = pages({{0, true}, {90, true}, {180, true}});
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        mesh.vertex_colors.emplace_back(float(v), 0, 0, 1);
        mesh.file_vertices.push_back(std::uint32_t(20 + v));
    }
    split_edges(mesh);
    ASSERT_EQ(mesh.vertex_count(), 9u);
    EXPECT_EQ(mesh.file_vertices, (Indices{20, 21, 22, 23, 24, 20, 20, 21, 21}));
    for (std::uint32_t v = 5; v < 9; ++v) {
        const std::uint32_t of = mesh.file_vertices[v] - 20;
        EXPECT_EQ(mesh.vertex_colors[v], mesh.vertex_colors[of]);
        EXPECT_EQ(mesh.positions[v], mesh.positions[of]);
    }
}

// Two walls that run the same way hang together around both ends over edges of mixed orientation:
// whichever of them the third is paired with, the other stays at the edge.
TEST(RepairValues, AnEdgeWhoseFacesHangTogetherAroundBothEndsIsLeft) {
    Mesh mesh = pages({{180, true}, {0, true}, {90, false}});
    for (const std::uint32_t v : {0u, 2u, 3u, 2u, 1u, 3u}) mesh.corner_vertices.push_back(v);
    mesh.face_offsets.insert(mesh.face_offsets.end(), {12, 15});
    ASSERT_EQ(prep::check(mesh).summary.non_manifold_edges, 1u);
    const RepairStep step = split_edges(mesh);
    EXPECT_EQ(step.changed, 0u);
    EXPECT_EQ(step.left, 1u);
    EXPECT_NE(step.text.find("left"), std::string::npos);
    EXPECT_EQ(prep::check(mesh).summary.non_manifold_edges, 1u);
    EXPECT_EQ(mesh.vertex_count(), 5u);
}

// An edge that is left takes nothing from the count of those that were split.
TEST(RepairValues, EdgesLeftAndSplitAreCountedApart) {
    Mesh left = pages({{180, true}, {0, true}, {90, false}});
    for (const std::uint32_t v : {0u, 2u, 3u, 2u, 1u, 3u}) left.corner_vertices.push_back(v);
    left.face_offsets.insert(left.face_offsets.end(), {12, 15});
    for (glm::vec3& p : left.positions) p.x += 20;
    Mesh mesh = shapes::joined(pages({{0, true}, {90, true}, {180, true}}), left);
    const RepairStep step = split_edges(mesh);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.left, 1u);
    EXPECT_EQ(step.places, (Indices{0, 9}));
    Mesh again = mesh;
    const RepairStep second = split_edges(again);
    EXPECT_EQ(second.changed, 0u);
    EXPECT_EQ(second.left, 1u);
    EXPECT_EQ(second.places, Indices{9});
}

// A face that has run empty between two points makes no other edge one that is left.
TEST(RepairValues, AnEdgeBesideAnEmptyFaceIsSplit) {
    Mesh mesh = shapes::mesh_of({{1, 1, 0}, {0, 1, 0}, {1, 2, 2}, {1, 1, 0}, {0, 0, 1}},
                                {{2, 3, 1}, {1, 4, 3}, {1, 3, 2}, {3, 2, 0}});
    const std::size_t vertices = mesh.vertex_count();
    const RepairStep step = split_edges(mesh);
    EXPECT_GT(mesh.vertex_count(), vertices);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.left, 0u);
}

TEST(RepairValues, EdgesAndVerticesAreStepsOfTheirOwn) {
    // A book of three pages and a bow tie that does not touch it.
    Mesh tie = shapes::bow_tie();
    for (glm::vec3& p : tie.positions) p.x += 20;
    const Mesh both = shapes::joined(pages({{0, true}, {90, true}, {180, true}}), tie);
    Mesh mesh = both;
    EXPECT_EQ(split_edges(mesh).changed, 1u);
    EXPECT_EQ(mesh.vertex_count(), both.vertex_count() + 4);
    EXPECT_EQ(prep::check(mesh).summary.non_manifold_vertices, 1u);
    mesh = both;
    RepairOptions options;
    options.non_manifold_vertices = true;
    const RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(step.places, Indices{5});  // the bow tie's middle
    EXPECT_EQ(mesh.vertex_count(), both.vertex_count() + 1);
    EXPECT_EQ(prep::check(mesh).summary.non_manifold_edges, 1u);
}

TEST(RepairValues, ColorsLinesAndPointsMoveUpWithTheirVertices) {
    Mesh mesh;
    for (int v = 0; v < 6; ++v) {
        mesh.positions.emplace_back(float(v), float(v % 2), 0.0f);
        mesh.vertex_colors.emplace_back(0.1f * float(v), 0, 0, 1);
    }
    mesh.corner_vertices = {1, 2, 3};
    mesh.face_offsets = {0, 3};
    mesh.line_offsets = {0, 2};
    mesh.line_vertices = {5, 1};
    mesh.points = {5, 3};
    RepairOptions options;
    options.isolated_vertices = true;
    const RepairStep step = only_step(mesh, options);
    EXPECT_EQ(step.places, (Indices{0, 4}));
    EXPECT_EQ(mesh.corner_vertices, (Indices{0, 1, 2}));
    EXPECT_EQ(mesh.line_vertices, (Indices{3, 0}));
    EXPECT_EQ(mesh.points, (Indices{3, 2}));
    EXPECT_EQ(mesh.file_vertices, (Indices{1, 2, 3, 5}));
    ASSERT_EQ(mesh.vertex_colors.size(), 4u);
    for (std::size_t v = 0; v < 4; ++v) {
        EXPECT_EQ(mesh.vertex_colors[v].x, 0.1f * float(mesh.file_vertices[v]));
        EXPECT_EQ(mesh.positions[v].x, float(mesh.file_vertices[v]));
    }
}

}  // namespace
