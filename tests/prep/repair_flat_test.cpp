// Faces without area that hang together: closed surfaces, their edges cut and the cuts filled with
// flat triangles, as tessellators leave them, have to be closed when those are gone.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "prep/repair.h"

namespace {

using prep::Mesh;
using Polygon = std::vector<std::uint32_t>;
using Point = std::tuple<float, float, float>;

// How often each edge, by its points, is run along one way and the other.
std::map<std::pair<Point, Point>, std::array<int, 2>> edge_uses(const Mesh& mesh) {
    std::map<std::pair<Point, Point>, std::array<int, 2>> uses;
    const auto point = [&](std::uint32_t c) {
        const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
        return Point(p.x, p.y, p.z);
    };
    for (std::uint32_t f = 0; f + 1 < mesh.face_offsets.size(); ++f) {
        const std::uint32_t begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        for (std::uint32_t c = begin; c < end; ++c) {
            const Point a = point(c), b = point(c + 1 < end ? c + 1 : begin);
            ++uses[std::minmax(a, b)][a < b ? 0 : 1];
        }
    }
    return uses;
}

bool every_edge_twice(const Mesh& mesh, bool opposite = true) {
    for (const auto& [edge, ways] : edge_uses(mesh))
        if (opposite ? ways[0] != 1 || ways[1] != 1 : ways[0] + ways[1] != 2) return false;
    return true;
}

// Six times the volume of a mesh of triangles and of polygons that are flat and convex.
double volume(const Mesh& mesh) {
    double sum = 0;
    const auto at = [&](std::uint32_t c) {
        return glm::dvec3(mesh.positions[mesh.corner_vertices[c]]);
    };
    for (std::uint32_t f = 0; f + 1 < mesh.face_offsets.size(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f] + 1; c + 1 < mesh.face_offsets[f + 1]; ++c)
            sum += glm::dot(at(mesh.face_offsets[f]), glm::cross(at(c), at(c + 1)));
    return sum;
}

void add_face(Mesh& mesh, const Polygon& polygon) {
    if (mesh.face_offsets.empty()) mesh.face_offsets.push_back(0);
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), polygon.begin(), polygon.end());
    mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
}

// Cuts ears off in random order: of a polygon on a line each is one.
void add_triangulated(Mesh& mesh, Polygon polygon, std::mt19937& random) {
    while (polygon.size() > 3) {
        const std::size_t k = random() % polygon.size(), n = polygon.size();
        add_face(mesh, {polygon[(k + n - 1) % n], polygon[k], polygon[(k + 1) % n]});
        polygon.erase(polygon.begin() + std::ptrdiff_t(k));
    }
    add_face(mesh, polygon);
}

// A tetrahedron whose edges got vertices, of each side its own, on exact points of the line;
// between the sides there are flat triangles.
Mesh sewn_tetrahedron(std::mt19937& random, bool vertices_of_their_own) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {64, 0, 0}, {0, 128, 0}, {0, 0, 32}};
    constexpr std::array<std::array<std::uint32_t, 3>, 4> faces{
        {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    std::map<std::pair<std::uint32_t, std::uint32_t>, Polygon> inside;  // by directed edge
    for (const auto& face : faces)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = face[k], b = face[(k + 1) % 3];
            Polygon& on_edge = inside[{a, b}];
            for (std::uint32_t step = 1; step < 16; ++step) {
                if (random() % 5 != 0) continue;
                // Every second sixteenth is the other way's, so that both never have the same
                // point.
                if ((a < b) == (step % 2 == 0)) continue;
                const float t = float(a < b ? step : 16 - step) / 16;
                const glm::vec3 low = mesh.positions[std::min(a, b)];
                const glm::vec3 high = mesh.positions[std::max(a, b)];
                on_edge.push_back(std::uint32_t(mesh.positions.size()));
                mesh.positions.push_back(low + (high - low) * t);
            }
        }
    for (const auto& face : faces) {
        // A fan about a point inside, so that no vertex of an edge is an ear.
        const std::uint32_t middle = std::uint32_t(mesh.positions.size());
        mesh.positions.push_back(0.5f * mesh.positions[face[0]] + 0.25f * mesh.positions[face[1]] +
                                 0.25f * mesh.positions[face[2]]);
        for (std::size_t k = 0; k < 3; ++k) {
            Polygon rim{face[k]};
            const Polygon& on_edge = inside[{face[k], face[(k + 1) % 3]}];
            rim.insert(rim.end(), on_edge.begin(), on_edge.end());
            rim.push_back(face[(k + 1) % 3]);
            for (std::size_t r = 0; r + 1 < rim.size(); ++r)
                add_face(mesh, {rim[r], rim[r + 1], middle});
        }
    }
    for (std::uint32_t a = 0; a < 4; ++a)
        for (std::uint32_t b = a + 1; b < 4; ++b) {
            // Runs against the faces on both sides.
            Polygon gap{a};
            const Polygon &there = inside[{b, a}], &back = inside[{a, b}];
            gap.insert(gap.end(), there.rbegin(), there.rend());
            gap.push_back(b);
            gap.insert(gap.end(), back.rbegin(), back.rend());
            if (gap.size() > 2) add_triangulated(mesh, gap, random);
        }
    if (vertices_of_their_own) {
        const std::vector<glm::vec3> shared = mesh.positions;
        mesh.positions.clear();
        for (std::uint32_t& v : mesh.corner_vertices) {
            mesh.positions.push_back(shared[v]);
            v = std::uint32_t(mesh.positions.size()) - 1;
        }
    }
    return mesh;
}

prep::RepairStep repair_degenerate(Mesh& mesh) {
    prep::RepairOptions options;
    options.degenerate_faces = true;
    auto log = prep::repair(mesh, options);
    if (!log || log->size() != 1) {
        ADD_FAILURE();
        return {};
    }
    return log->front();
}

// Exact for the numbers here.
std::size_t faces_without_area(const Mesh& mesh) {
    std::size_t count = 0;
    const auto at = [&](std::uint32_t c) {
        return glm::dvec3(mesh.positions[mesh.corner_vertices[c]]);
    };
    for (std::uint32_t f = 0; f + 1 < mesh.face_offsets.size(); ++f) {
        glm::dvec3 area(0.0);
        const std::uint32_t begin = mesh.face_offsets[f];
        for (std::uint32_t c = begin + 1; c + 1 < mesh.face_offsets[f + 1]; ++c)
            area += glm::cross(at(c) - at(begin), at(c + 1) - at(begin));
        count += area == glm::dvec3(0.0);
    }
    return count;
}

TEST(RepairFlatFaces, ClosedSurfacesStayClosed) {
    std::mt19937 random(3);
    std::size_t flat = 0;
    for (int n = 0; n < 300; ++n) {
        Mesh mesh = sewn_tetrahedron(random, n % 3 == 2);
        ASSERT_TRUE(every_edge_twice(mesh)) << n;
        const double before = volume(mesh);
        const std::size_t without = faces_without_area(mesh);
        const prep::RepairStep step = repair_degenerate(mesh);
        EXPECT_EQ(step.changed, without) << n;
        EXPECT_EQ(step.left, 0u);
        EXPECT_EQ(faces_without_area(mesh), 0u) << n;
        EXPECT_TRUE(every_edge_twice(mesh)) << n;
        EXPECT_EQ(volume(mesh), before) << n;  // whole numbers
        flat += without;
    }
    EXPECT_GT(flat, 3000u);
}

TEST(RepairFlatFaces, FacesThatRunTheOtherWayMeetAllTheSame) {
    std::mt19937 random(4);
    for (int n = 0; n < 100; ++n) {
        Mesh mesh = sewn_tetrahedron(random, false);
        for (std::uint32_t f = 0; f + 1 < mesh.face_offsets.size(); ++f)
            if (random() % 4 == 0)
                std::swap(mesh.corner_vertices[mesh.face_offsets[f]],
                          mesh.corner_vertices[mesh.face_offsets[f] + 1]);
        repair_degenerate(mesh);
        EXPECT_EQ(faces_without_area(mesh), 0u) << n;
        EXPECT_TRUE(every_edge_twice(mesh, false)) << n;
    }
}

TEST(RepairFlatFaces, PartsThatAreNamesMeetAllTheSame) {
    std::mt19937 random(5);
    for (int n = 0; n < 100; ++n) {
        Mesh mesh = sewn_tetrahedron(random, false);
        mesh.parts = {"a", "b", "c"};
        for (std::uint32_t f = 0; f + 1 < mesh.face_offsets.size(); ++f)
            mesh.face_parts.push_back(std::uint32_t(random() % 3));
        repair_degenerate(mesh);
        EXPECT_TRUE(every_edge_twice(mesh)) << n;
    }
}

// Those of a file that is written back share no vertices: an edge of one takes none of another.
TEST(RepairFlatFaces, StayBetweenPartsThatShareNoVertices) {
    std::mt19937 random(6);
    std::uint64_t left = 0, changed = 0;
    for (int n = 0; n < 100; ++n) {
        Mesh mesh = sewn_tetrahedron(random, true);
        mesh.parts = {"a", "b"};
        mesh.tied_to_file = true;
        for (std::uint32_t f = 0; f + 1 < mesh.face_offsets.size(); ++f)
            mesh.face_parts.push_back(random() % 8 == 0);
        const std::size_t without = faces_without_area(mesh);
        const prep::RepairStep step = repair_degenerate(mesh);
        EXPECT_EQ(step.changed + step.left, without);
        EXPECT_EQ(faces_without_area(mesh), step.left);
        EXPECT_TRUE(every_edge_twice(mesh)) << n;
        std::vector<std::uint32_t> part_of(mesh.positions.size(), prep::no_index);
        for (std::uint32_t f = 0; f + 1 < mesh.face_offsets.size(); ++f)
            for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
                std::uint32_t& part = part_of[mesh.corner_vertices[c]];
                if (part == prep::no_index) part = mesh.face_parts[f];
                EXPECT_EQ(part, mesh.face_parts[f]);
            }
        left += step.left;
        changed += step.changed;
    }
    EXPECT_GT(left, 100u);
    EXPECT_GT(changed, 100u);
}

TEST(RepairFlatFaces, PolygonsOnALineGoLikeTriangles) {
    // A square's diagonal, between whose sides a flat pentagon lies.
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}, {2, 2, 0}, {4, 4, 0}, {6, 6, 0}};
    add_face(mesh, {0, 1, 2});
    add_face(mesh, {0, 4, 3});
    add_face(mesh, {4, 5, 3});
    add_face(mesh, {5, 6, 3});
    add_face(mesh, {6, 2, 3});
    add_face(mesh, {0, 2, 6, 5, 4});
    const prep::RepairStep step = repair_degenerate(mesh);
    EXPECT_EQ(step.changed, 1u);
    std::size_t open = 0;
    for (const auto& [edge, ways] : edge_uses(mesh)) open += ways[0] + ways[1] == 1;
    EXPECT_EQ(open, 4u);
    EXPECT_EQ(Polygon(mesh.corner_vertices.begin(), mesh.corner_vertices.begin() + 6),
              (Polygon{0, 1, 2, 6, 5, 4}));
}

// A polygon on a line that visits both ends in turns, a triangle beside each edge: each would take
// all vertices between.
TEST(RepairFlatFaces, StayWhereEdgesRunToAndFro) {
    Mesh mesh;
    constexpr std::uint32_t count = 400;
    Polygon zigzag;
    for (std::uint32_t k = 0; k < count; ++k) {
        mesh.positions.push_back({float(k), 0, 0});
        zigzag.push_back(k % 2 == 0 ? k / 2 : count - 1 - k / 2);
    }
    mesh.positions.push_back({0, 5, 0});
    add_face(mesh, zigzag);
    for (std::uint32_t k = 0; k < count; ++k)
        add_face(mesh, {zigzag[(k + 1) % count], zigzag[k], count});
    const std::size_t corners = mesh.corner_vertices.size();
    const prep::RepairStep step = repair_degenerate(mesh);
    EXPECT_EQ(step.changed, 0u);
    EXPECT_EQ(step.left, 1u);
    EXPECT_EQ(mesh.corner_vertices.size(), corners);
}

}  // namespace
