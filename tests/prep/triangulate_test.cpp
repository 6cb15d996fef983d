#include "prep/triangulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "shapes.h"
#include "steps.h"

namespace {

using prep::Mesh;
using prep::MeshView;
using prep::Triangulation;
using Indices = std::vector<std::uint32_t>;

Triangulation cut(const Mesh& mesh, int threads = 0) {
    return prep::triangulate(MeshView(mesh), threads);
}

// Twice the signed area of a triangle seen from +z.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const glm::dvec2 u = b - a, v = c - a;
    return u.x * v.y - u.y * v.x;
}

glm::dvec2 flat(const Mesh& mesh, std::uint32_t corner) {
    return glm::dvec2(mesh.positions[mesh.corner_vertices[corner]]);
}

struct Areas {
    double sum = 0;       // with signs: that of the polygon for any triangulation of its corners
    double absolute = 0;  // without: more than `sum` where triangles overlap or lie outside
};
Areas areas(const Mesh& mesh, const Triangulation& t) {
    Areas result;
    for (std::size_t i = 0; i < t.corners.size(); i += 3) {
        const double area = turn(flat(mesh, t.corners[i]), flat(mesh, t.corners[i + 1]),
                                 flat(mesh, t.corners[i + 2])) /
                            2;
        result.sum += area;
        result.absolute += std::abs(area);
    }
    return result;
}

// k − 2 triangles of each face, of its own corners, each of the polygon's sides once and in its
// direction, each diagonal once in each.
void expect_well_formed(const Mesh& mesh, const Triangulation& t) {
    ASSERT_EQ(t.corners.size(), 3 * t.triangle_faces.size());
    EXPECT_TRUE(std::is_sorted(t.triangle_faces.begin(), t.triangle_faces.end()));
    std::vector<std::uint32_t> counts(mesh.face_count(), 0);
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::size_t i = 0; i < t.triangle_faces.size(); ++i) {
        const std::uint32_t f = t.triangle_faces[i];
        ++counts[f];
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = t.corners[3 * i + k], b = t.corners[3 * i + (k + 1) % 3];
            ASSERT_GE(a, mesh.face_offsets[f]);
            ASSERT_LT(a, mesh.face_offsets[f + 1]);
            EXPECT_TRUE(edges.emplace(a, b).second) << a << "-" << b << " twice";
        }
    }
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        EXPECT_EQ(counts[f], end - begin - 2);
        for (std::uint32_t c = begin; c < end; ++c)
            EXPECT_TRUE(edges.erase({c, c + 1 == end ? begin : c + 1})) << "side " << c;
    }
    for (const auto& [a, b] : edges) EXPECT_TRUE(edges.count({b, a})) << a << "-" << b;
}

// Every triangle runs counter-clockwise and they fill the known area without overlap.
void expect_fills(const Mesh& mesh, double area) {
    const Triangulation t = cut(mesh);
    expect_well_formed(mesh, t);
    const Areas found = areas(mesh, t);
    EXPECT_NEAR(found.sum, area, 1e-12 * area);
    EXPECT_NEAR(found.absolute, area, 1e-12 * area);
}

Mesh reversed(Mesh mesh) {
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        std::reverse(mesh.corner_vertices.begin() + mesh.face_offsets[f],
                     mesh.corner_vertices.begin() + mesh.face_offsets[f + 1]);
    return mesh;
}

Mesh from_corner(const Mesh& polygon, std::uint32_t first) {
    Mesh result = polygon;
    std::rotate(result.corner_vertices.begin(), result.corner_vertices.begin() + first,
                result.corner_vertices.end());
    return result;
}

Mesh regular(std::uint32_t corners, double inner = 1) {  // a star where `inner` < 1
    std::vector<glm::vec3> positions;
    for (std::uint32_t i = 0; i < corners; ++i) {
        const double phi = 2 * std::numbers::pi * i / corners, r = i % 2 ? inner : 1;
        positions.push_back({float(r * std::cos(phi)), float(r * std::sin(phi)), 0});
    }
    return shapes::polygon(positions);
}

double shoelace(const Mesh& polygon) {
    double sum = 0;
    const std::uint32_t n = std::uint32_t(polygon.corner_count());
    for (std::uint32_t c = 0; c < n; ++c) {
        const glm::dvec2 a = flat(polygon, c), b = flat(polygon, (c + 1) % n);
        sum += a.x * b.y - a.y * b.x;
    }
    return sum / 2;
}

TEST(Triangulate, EmptyMesh) {
    EXPECT_TRUE(cut(Mesh{}).corners.empty());
}

TEST(Triangulate, TrianglesStayAsTheyAre) {
    const Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {2, 1, 0}});
    const Triangulation t = cut(mesh);
    EXPECT_EQ(t.corners, (Indices{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(t.triangle_faces, (Indices{0, 1}));
}

TEST(Triangulate, QuadsAreCutAlongTheShorterDiagonal) {
    const Mesh wide = shapes::polygon({{0, 0, 0}, {2, -1, 0}, {4, 0, 0}, {2, 1, 0}});
    EXPECT_EQ(cut(wide).corners, (Indices{0, 1, 3, 1, 2, 3}));
    EXPECT_EQ(cut(from_corner(wide, 1)).corners, (Indices{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(cut(shapes::grid(1, 1)).corners, (Indices{0, 1, 2, 0, 2, 3}));  // a tie: 0–2
}

TEST(Triangulate, ConcaveQuadsAreCutInside) {
    // A dart: its shorter diagonal lies outside.
    const Mesh dart = shapes::polygon({{0, 0, 0}, {4, -1, 0}, {1, 0, 0}, {4, 1, 0}});
    for (std::uint32_t first = 0; first < 4; ++first) expect_fills(from_corner(dart, first), 1);
}

TEST(Triangulate, ConcavePolygonsAreFilledOnce) {
    const Mesh ell =
        shapes::polygon({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}});
    const Mesh comb = shapes::polygon({{0, 0, 0},
                                       {7, 0, 0},
                                       {7, 3, 0},
                                       {6, 3, 0},
                                       {6, 1, 0},
                                       {5, 1, 0},
                                       {5, 3, 0},
                                       {4, 3, 0},
                                       {4, 1, 0},
                                       {3, 1, 0},
                                       {3, 3, 0},
                                       {2, 3, 0},
                                       {2, 1, 0},
                                       {1, 1, 0},
                                       {1, 3, 0},
                                       {0, 3, 0}});
    const Mesh spiral = shapes::polygon({{0, 0, 0},
                                         {5, 0, 0},
                                         {5, 5, 0},
                                         {1, 5, 0},
                                         {1, 2, 0},
                                         {3, 2, 0},
                                         {3, 3, 0},
                                         {2, 3, 0},
                                         {2, 4, 0},
                                         {4, 4, 0},
                                         {4, 1, 0},
                                         {0, 1, 0}});
    for (std::uint32_t first = 0; first < 6; ++first) expect_fills(from_corner(ell, first), 3);
    for (std::uint32_t first = 0; first < 16; ++first) expect_fills(from_corner(comb, first), 15);
    for (std::uint32_t first = 0; first < 12; ++first)
        expect_fills(from_corner(spiral, first), 5 + 4 + 3 + 2 + 1);
}

TEST(Triangulate, RegularPolygonsAndStarsHaveTheirClosedFormArea) {
    for (const std::uint32_t n : {5u, 6u, 12u, 64u, 999u}) {
        const Mesh mesh = regular(n);
        const double closed = 0.5 * n * std::sin(2 * std::numbers::pi / n);
        EXPECT_NEAR(areas(mesh, cut(mesh)).absolute, closed, 1e-6);  // the corners are floats
        expect_fills(mesh, shoelace(mesh));
    }
    for (const std::uint32_t n : {10u, 64u, 500u}) {
        const Mesh mesh = regular(n, 0.3);
        const double closed = 0.5 * n * 0.3 * std::sin(2 * std::numbers::pi / n);
        EXPECT_NEAR(areas(mesh, cut(mesh)).absolute, closed, 1e-6);
        expect_fills(mesh, shoelace(mesh));
    }
}

TEST(Triangulate, WindingFollowsTheFaceInAnyPlane) {
    const Mesh ell =
        shapes::polygon({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}});
    for (const bool backwards : {false, true})
        for (int plane = 0; plane < 6; ++plane) {
            Mesh mesh = backwards ? reversed(ell) : ell;
            for (glm::vec3& p : mesh.positions) {
                if (plane == 1) p = {p.y, p.z, p.x};
                if (plane == 2) p = {p.z, p.x, p.y};
                if (plane == 3) p = {p.x, -p.y, -p.z};
                if (plane == 4) p = {p.x, p.y, p.x + 2 * p.y};
                if (plane == 5) p = {p.x + p.y, p.x - p.y, 3 * p.x};
            }
            const auto at = [&](std::uint32_t c) {
                return glm::dvec3(mesh.positions[mesh.corner_vertices[c]]);
            };
            glm::dvec3 normal(0.0);
            for (std::uint32_t c = 0; c < 6; ++c) normal += glm::cross(at(c), at((c + 1) % 6));
            const Triangulation t = cut(mesh);
            expect_well_formed(mesh, t);
            double sum = 0;
            for (std::size_t i = 0; i < t.corners.size(); i += 3) {
                const glm::dvec3 a = at(t.corners[i]);
                const glm::dvec3 area =
                    glm::cross(at(t.corners[i + 1]) - a, at(t.corners[i + 2]) - a);
                EXPECT_GE(glm::dot(area, normal), 0) << plane;
                sum += glm::length(area);
            }
            EXPECT_NEAR(sum, glm::length(normal), 1e-12);
        }
}

TEST(Triangulate, CollinearCornersLoseNoArea) {
    // A square with nine more corners on each side.
    std::vector<glm::vec3> positions;
    for (int i = 0; i < 10; ++i) positions.push_back({i, 0, 0});
    for (int i = 0; i < 10; ++i) positions.push_back({10, i, 0});
    for (int i = 0; i < 10; ++i) positions.push_back({10 - i, 10, 0});
    for (int i = 0; i < 10; ++i) positions.push_back({0, 10 - i, 0});
    const Mesh square = shapes::polygon(positions);
    for (std::uint32_t first = 0; first < 40; first += 3)
        expect_fills(from_corner(square, first), 100);
    // All corners on one line, and all at one point: k − 2 triangles all the same.
    for (const float step : {1.0f, 0.0f}) {
        std::vector<glm::vec3> line;
        for (int i = 0; i < 9; ++i) line.push_back(glm::vec3(1, 2, 3) * (step * float(i)));
        const Mesh mesh = shapes::polygon(line);
        expect_well_formed(mesh, cut(mesh));
    }
}

TEST(Triangulate, SelfTouchingPolygonsAreFilledOnce) {
    // Two squares that touch in one point, run through once.
    const Mesh eight = shapes::polygon(
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {1, 1, 0}, {0, 1, 0}});
    for (std::uint32_t first = 0; first < 8; ++first) expect_fills(from_corner(eight, first), 2);
    // A square with a square hole, joined by a bridge that is run along in both directions.
    const Mesh ring = shapes::polygon({{0, 0, 0},
                                       {4, 0, 0},
                                       {4, 4, 0},
                                       {0, 4, 0},
                                       {0, 0, 0},
                                       {1, 1, 0},
                                       {1, 3, 0},
                                       {3, 3, 0},
                                       {3, 1, 0},
                                       {1, 1, 0}});
    for (std::uint32_t first = 0; first < 10; ++first) expect_fills(from_corner(ring, first), 12);
}

TEST(Triangulate, SelfCrossingPolygonsKeepTheirSignedArea) {
    const Mesh pentagram = [] {
        const Mesh mesh = regular(5);
        return shapes::mesh_of(mesh.positions, {{0, 2, 4, 1, 3}});
    }();
    const Triangulation t = cut(pentagram);
    expect_well_formed(pentagram, t);
    EXPECT_NEAR(areas(pentagram, t).sum, shoelace(pentagram), 1e-12);
}

TEST(Triangulate, RandomStarPolygonsCoverEveryPointOnce) {
    std::mt19937_64 random(41);
    std::uniform_real_distribution<double> radius(0.1, 1), unit(-1, 1);
    for (int i = 0; i < 30; ++i) {
        const std::uint32_t n = 5 + std::uint32_t(i) * 3;
        std::vector<glm::vec3> positions;
        for (std::uint32_t k = 0; k < n; ++k) {
            const double phi = 2 * std::numbers::pi * k / n, r = radius(random);
            positions.push_back({float(r * std::cos(phi)), float(r * std::sin(phi)), 0});
        }
        const Mesh mesh = shapes::polygon(positions);
        expect_fills(mesh, shoelace(mesh));
        const Triangulation t = cut(mesh);
        for (int s = 0; s < 200; ++s) {
            const glm::dvec2 p(unit(random), unit(random));
            int crossings = 0, covered = 0;
            for (std::uint32_t c = 0; c < n; ++c) {
                const glm::dvec2 a = flat(mesh, c), b = flat(mesh, (c + 1) % n);
                if ((a.y > p.y) != (b.y > p.y))
                    crossings += p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
            }
            for (std::size_t k = 0; k < t.corners.size(); k += 3) {
                const glm::dvec2 a = flat(mesh, t.corners[k]), b = flat(mesh, t.corners[k + 1]),
                                 c = flat(mesh, t.corners[k + 2]);
                covered += turn(a, b, p) > 0 && turn(b, c, p) > 0 && turn(c, a, p) > 0;
            }
            EXPECT_EQ(covered, crossings % 2) << p.x << ' ' << p.y << " in polygon " << i;
        }
    }
}

TEST(Triangulate, FarOffSliversAreDecidedExactly) {
    // A polygon one float step high at 16 million: doubles alone would see it as flat or folded.
    const float far = 16777216.0f, up = std::nextafter(far, 1e9f);
    const Mesh mesh = shapes::polygon({{far, far, 0},
                                       {up, far, 0},
                                       {up + 8, far, 0},
                                       {up + 8, up, 0},
                                       {up, up, 0},
                                       {far, up, 0}});
    expect_fills(mesh, shoelace(mesh));
}

TEST(Triangulate, NonFiniteCornersStillGiveTriangles) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    for (const float bad : {nan, inf, -inf})
        for (const std::uint32_t n : {3u, 4u, 5u, 9u}) {
            Mesh mesh = regular(n);
            mesh.positions[n - 1].y = bad;
            expect_well_formed(mesh, cut(mesh));
        }
}

// Looks at corners and at the tree's nodes: some for each level of the tree and corner, where
// looking at all corners for each ear would take 10⁸.
TEST(Triangulate, TenThousandCornersTakeSomeLooksEach) {
    for (const double inner : {1.0, 0.5}) {
        for (const std::uint32_t corners : {2'500u, 10'000u}) {
            const Mesh mesh = regular(corners, inner);
            Triangulation t;
            const double looks = double(test::steps_of([&] { t = cut(mesh); }));
            EXPECT_GE(looks, corners - 3.0);
            EXPECT_LE(looks, 4 * test::n_log_n(corners)) << corners << ' ' << inner;
            EXPECT_NEAR(areas(mesh, t).absolute, shoelace(mesh), 1e-9);
        }
    }
}

// Outlines with few ears at a time: cut once for all instead of looked for again and again.
Mesh spiral(std::uint32_t corners) {
    const std::uint32_t half = corners / 2;
    std::vector<glm::vec3> positions;
    for (std::uint32_t i = 0; i < corners; ++i) {
        const double t = double(i < half ? i : corners - 1 - i) / half;
        const double phi = 80 * std::numbers::pi * t, r = 0.1 + t + (i < half ? 0.01 : 0);
        positions.push_back({float(r * std::cos(phi)), float(r * std::sin(phi)), 0});
    }
    return shapes::polygon(positions);
}
Mesh zigzag(std::uint32_t corners) {  // a thin band up and down
    const std::uint32_t half = corners / 2;
    std::vector<glm::vec3> positions;
    for (std::uint32_t i = 0; i < corners; ++i) {
        const bool back = i >= half;
        const std::uint32_t k = back ? corners - 1 - i : i;
        positions.push_back({float(k), k % 2 ? (back ? 0.1f : 0.f) : (back ? 100.f : 99.9f), 0});
    }
    return shapes::polygon(positions);
}
TEST(Triangulate, ManyTurnsAreFilledOnce) {
    for (const std::uint32_t corners : {500u, 50'000u}) {
        SCOPED_TRACE(corners);
        expect_fills(spiral(corners), shoelace(spiral(corners)));
        expect_fills(zigzag(corners), shoelace(zigzag(corners)));
    }
}

// A large figure of eight: once the one lobe is cut, the other has no ear at all.
TEST(Triangulate, LargePolygonsThatCrossThemselvesOnceEnd) {
    constexpr std::uint32_t corners = 6'000;
    std::vector<glm::vec3> positions;
    for (std::uint32_t i = 0; i < corners; ++i) {
        const double t = 2 * std::numbers::pi * (i + 0.5) / corners;
        const double size = std::sin(t) < 0 ? 0.6 : 1;
        positions.push_back({float(size * std::sin(t)), float(size * std::sin(2 * t)), 0});
    }
    const Mesh mesh = shapes::polygon(positions);
    const Triangulation t = cut(mesh);
    EXPECT_EQ(t.triangle_faces.size(), corners - 2);
    EXPECT_NEAR(areas(mesh, t).sum, shoelace(mesh), 1e-9);
}

TEST(Triangulate, ThreadsChangeNothing) {
    std::mt19937_64 random(42);
    Mesh mesh = shapes::torus(300, 200);
    shapes::jitter(mesh, 0.05f, random);
    const Triangulation one = cut(mesh, 1);
    for (const int threads : {2, 8}) {
        const Triangulation many = cut(mesh, threads);
        EXPECT_EQ(one.corners, many.corners);
        EXPECT_EQ(one.triangle_faces, many.triangle_faces);
    }
}

}  // namespace
