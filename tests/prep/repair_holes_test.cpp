// Which fill a hole gets, which holes are left, and what the fill is made of.
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
using prep::RepairStep;
using Indices = std::vector<std::uint32_t>;

RepairStep fill(Mesh& mesh, std::uint32_t most_edges = 100) {
    prep::RepairOptions options;
    options.hole_edges = most_edges;
    const auto log = prep::repair(mesh, options);
    EXPECT_TRUE(log.has_value());
    EXPECT_EQ(log->size(), 1u);
    return log->at(0);
}

// A hole and its rim: loop points counter-clockwise, and for each edge i → i + 1 the normal of the
// face beyond it. Those faces lie in the mesh from number `first` on; the hole's points are the
// vertices 0 … n − 1, and triangles between the rim's faces close it all around.
Mesh hole_with_rim(const std::vector<glm::vec3>& points, const std::vector<glm::vec3>& normals,
                   std::size_t first) {
    const auto n = std::uint32_t(points.size());
    Mesh mesh;
    mesh.positions = points;
    for (std::uint32_t i = 0; i < n; ++i) {
        const glm::vec3 edge = points[(i + 1) % n] - points[i];
        mesh.positions.push_back(0.5f * (points[i] + points[(i + 1) % n]) +
                                 glm::cross(edge, normals[i]));
    }
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        mesh.corner_vertices.insert(mesh.corner_vertices.end(), {a, b, c});
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    };
    for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t i = std::uint32_t(first + k) % n;
        add((i + 1) % n, i, n + i);
    }
    for (std::uint32_t i = 0; i < n; ++i) add(n + (i + 1) % n, (i + 1) % n, n + i);
    return mesh;
}

double doubled_area(const Mesh& mesh, std::uint32_t face) {
    const auto at = [&](std::uint32_t k) {
        return glm::dvec3(mesh.positions[mesh.corner_vertices[3 * face + k]]);
    };
    return glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
}

// The new triangles whose corners all are the hole's points, by their sorted points.
std::set<Indices> fill_of(const Mesh& mesh, std::size_t faces_before, std::uint32_t points) {
    std::set<Indices> result;
    for (std::size_t f = faces_before; f < mesh.face_count(); ++f) {
        Indices corners(mesh.corner_vertices.begin() + mesh.face_offsets[f],
                        mesh.corner_vertices.begin() + mesh.face_offsets[f + 1]);
        std::sort(corners.begin(), corners.end());
        if (corners[2] < points) result.insert(corners);
    }
    return result;
}

// A square with a gable that is bent up. Beyond the square's first edge there is a wall: whatever
// flat triangle lies at its foot stands at a right angle to it, and nothing else is bent as much.
// So all fills but those that put the gable's top there tie at 90°, and the least area decides:
// 4 of the square and √(1 + 1/4) of the gable.
TEST(RepairHoles, OfEquallySmoothFillsTheLeastAreaWins) {
    const std::vector<glm::vec3> points{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 3, 0.5f}, {0, 2, 0}};
    const std::vector<glm::vec3> normals{{0, 1, 0}, {0, 0, 1}, {0, -1, 2}, {0, -1, 2}, {0, 0, 1}};
    for (std::size_t first = 0; first < 5; ++first) {
        Mesh mesh = hole_with_rim(points, normals, first);
        const std::size_t before = mesh.face_count();
        const RepairStep step = fill(mesh);
        EXPECT_EQ(step.places.front(), 0u);
        const std::set<Indices> found = fill_of(mesh, before, 5);
        EXPECT_EQ(found.size(), 3u) << first;
        EXPECT_TRUE(found.contains(Indices{2, 3, 4})) << first;
        double area = 0;
        for (std::uint32_t f = std::uint32_t(before); f < before + 3; ++f)
            area += doubled_area(mesh, f) / 2;
        EXPECT_NEAR(area, 4 + std::sqrt(1.25), 1e-6) << first;
    }
}

// A square with one corner raised by its side. Either diagonal bends the fill itself: by 60° the
// one through the raised corner, by 54.7° the other; but against the face beyond the first edge,
// which leans by 63.4°, the other's flat triangle bends by just that.
TEST(RepairHoles, TheFacesAroundTheHoleCountWhereverItsLoopBegins) {
    const std::vector<glm::vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}};
    const std::vector<glm::vec3> beyond{{0, -2, 1}, {-1, -2, 2}, {-2, -1, 2}, {-1, 0, 2}};
    for (const bool leaning : {true, false}) {
        std::vector<glm::vec3> normals = beyond;
        if (!leaning) normals[0] = {0, -1, 2};
        for (std::size_t first = 0; first < 4; ++first) {
            Mesh mesh = hole_with_rim(points, normals, first);
            const std::size_t before = mesh.face_count();
            fill(mesh);
            const std::set<Indices> through_raised{{0, 1, 2}, {0, 2, 3}};
            const std::set<Indices> other{{0, 1, 3}, {1, 2, 3}};
            EXPECT_EQ(fill_of(mesh, before, 4), leaning ? through_raised : other) << first;
        }
    }
}

// A cube without its top (points 4, 5, 7, 6 of shapes::cube, at z = 1).
Mesh open_cube() {
    Mesh mesh = shapes::cube();
    Indices kept;
    for (std::uint32_t f = 0; f < 6; ++f) {
        bool top = true;
        for (std::uint32_t c = 4 * f; c < 4 * f + 4; ++c)
            top &= mesh.positions[mesh.corner_vertices[c]].z > 0;
        if (!top) kept.push_back(f);
    }
    return shapes::with_face_order(mesh, kept);
}

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, const glm::vec3& tip) {
    mesh.positions.push_back(tip);
    for (const std::uint32_t v : {a, b, std::uint32_t(mesh.positions.size() - 1)})
        mesh.corner_vertices.push_back(v);
    mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
}

bool has_edge(const std::set<Indices>& triangles, std::uint32_t a, std::uint32_t b) {
    return std::any_of(triangles.begin(), triangles.end(), [&](const Indices& t) {
        return std::count(t.begin(), t.end(), a) + std::count(t.begin(), t.end(), b) == 2;
    });
}

TEST(RepairHoles, NoFillDoublesAnEdgeThatIsThere) {
    ASSERT_EQ(open_cube().face_count(), 5u);
    const std::pair<std::uint32_t, std::uint32_t> diagonals[] = {{4, 7}, {5, 6}};
    for (const auto& [a, b] : diagonals) {
        // A fin on one diagonal: the fill takes the other. The fin's own rim is a loop as well.
        Mesh mesh = open_cube();
        add_triangle(mesh, a, b, {0, 0, 3});
        const RepairStep step = fill(mesh);
        EXPECT_EQ(step.changed, 2u);
        EXPECT_EQ(step.left, 0u);
        const std::set<Indices> found = fill_of(mesh, 6, 8);
        EXPECT_EQ(found.size(), 2u);
        EXPECT_FALSE(has_edge(found, a, b));
        EXPECT_EQ(prep::check(mesh).summary.non_manifold_edges, 0u);
    }
    Mesh mesh = open_cube();
    add_triangle(mesh, 4, 7, {0, 0, 3});
    add_triangle(mesh, 5, 6, {0, 0, 4});
    const RepairStep step = fill(mesh);
    EXPECT_EQ(step.changed, 2u);  // the fins
    EXPECT_EQ(step.left, 1u);
    EXPECT_NE(step.text.find("no triangulation fits"), std::string::npos);
    EXPECT_TRUE(fill_of(mesh, 7, 8).empty());
}

// Half an octahedron's faces: two holes that both reach from one end of the x axis to the other.
// The other diagonal of each is taken by a fin, so that the first hole needs the axis, and the
// second finds it taken.
TEST(RepairHoles, AFillTakesItsEdgesFromThoseThatFollow) {
    Mesh mesh =
        shapes::mesh_of({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                        {{0, 5, 2}, {1, 2, 5}, {0, 4, 3}, {1, 3, 4}});
    ASSERT_TRUE(prep::check(mesh).summary.oriented);
    add_triangle(mesh, 2, 4, {0, 5, 5});
    add_triangle(mesh, 3, 5, {0, -5, -5});
    const RepairStep step = fill(mesh);
    EXPECT_EQ(step.changed, 3u);  // the fins' rims, and one of the holes
    EXPECT_EQ(step.left, 1u);
    const prep::MeshSummary after = prep::check(mesh).summary;
    EXPECT_EQ(after.non_manifold_edges, 0u);
    EXPECT_EQ(after.open_edges, 4u);
    EXPECT_EQ(fill_of(mesh, 6, 6).size(), 2u);
}

TEST(RepairHoles, HolesBetweenTwoPartsAreLeft) {
    Mesh mesh = open_cube();
    mesh.parts = {"a", "b"};
    mesh.face_parts = {0, 0, 0, 0, 1};
    const Mesh before = mesh;
    const RepairStep step = fill(mesh);
    EXPECT_EQ(step.changed, 0u);
    EXPECT_EQ(step.left, 1u);
    EXPECT_NE(step.text.find("of several parts"), std::string::npos);
    EXPECT_EQ(mesh.corner_vertices, before.corner_vertices);
    mesh.face_parts.assign(5, 1);
    EXPECT_EQ(fill(mesh).changed, 1u);
    EXPECT_EQ(mesh.face_parts, Indices(7, 1));
}

TEST(RepairHoles, ALoopThatTouchesItselfIsLeft) {
    // Two faces of a grid that touch in one vertex are missing: their rims are one loop of eight.
    Mesh mesh = shapes::grid(4, 4);
    Indices kept;
    for (std::uint32_t f = 0; f < 16; ++f)
        if (f != 5 && f != 10) kept.push_back(f);
    mesh = shapes::with_face_order(mesh, kept);
    const RepairStep step = fill(mesh, 8);
    EXPECT_EQ(step.changed, 0u);
    EXPECT_EQ(step.left, 2u);  // and the grid's own rim of sixteen
    EXPECT_EQ(mesh.face_count(), 14u);
}

TEST(RepairHoles, AFillHasItsRimsAttributesAndNoNormals) {
    Mesh mesh = open_cube();
    // The bottom comes first, and is of another material, group and colour than the sides.
    std::uint32_t bottom = 0;
    for (std::uint32_t f = 0; f < 5; ++f) {
        bool low = true;
        for (std::uint32_t c = 4 * f; c < 4 * f + 4; ++c)
            low &= mesh.positions[mesh.corner_vertices[c]].z < 0;
        if (low) bottom = f;
    }
    Indices order{bottom};
    for (std::uint32_t f = 0; f < 5; ++f)
        if (f != bottom) order.push_back(f);
    mesh = shapes::with_face_order(mesh, order);
    mesh.face_materials = {9, 3, 3, 3, 3};
    mesh.face_smoothing = {1, 2, 2, 2, 2};
    mesh.uvs.resize(1);
    mesh.colors.resize(1);
    mesh.uvs[0].values = {{7, 7}};
    mesh.colors[0].values = {{1, 0, 0, 1}, {0, 1, 0, 1}};
    mesh.normals.values = {{0, 0, 1}};
    mesh.tangents.values = {{1, 0, 0, 1}};
    for (std::uint32_t c = 0; c < 20; ++c) {
        const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
        mesh.uvs[0].values.emplace_back(p.x, p.y);
        mesh.uvs[0].indices.push_back(p.z > 0 ? c + 1 : 0);
        mesh.colors[0].indices.push_back(c < 4 ? 0 : 1);
        mesh.normals.indices.push_back(0);
        mesh.tangents.indices.push_back(0);
        mesh.corner_file_vertices.push_back(100 + c);
    }
    EXPECT_EQ(fill(mesh, 3).left, 1u);
    const RepairStep step = fill(mesh, 4);  // a hole of just the largest size
    EXPECT_EQ(step.changed, 1u);
    EXPECT_EQ(mesh.face_materials, (Indices{9, 3, 3, 3, 3, 3, 3}));
    EXPECT_EQ(mesh.face_smoothing, (Indices{1, 2, 2, 2, 2, 2, 2}));
    ASSERT_EQ(mesh.corner_count(), 26u);
    for (std::uint32_t c = 20; c < 26; ++c) {
        const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
        EXPECT_EQ(p.z, 1);
        EXPECT_EQ(mesh.uvs[0].values[mesh.uvs[0].indices[c]], glm::vec2(p.x, p.y));
        EXPECT_EQ(mesh.colors[0].indices[c], 1u);
        EXPECT_EQ(mesh.normals.indices[c], no_index);
        EXPECT_EQ(mesh.tangents.indices[c], no_index);
        // The vertex of the file is one that a rim's corner at the same vertex has.
        const std::uint32_t from = mesh.corner_file_vertices[c] - 100;
        ASSERT_LT(from, 20u);
        EXPECT_EQ(mesh.corner_vertices[from], mesh.corner_vertices[c]);
    }
}

}  // namespace
