// Single cases at which rounding, order or an odd neighbour would decide otherwise: areas, ties of
// normals, seams, empty faces, spikes and cuts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "exact.h"
#include "prep/corner_normals.h"
#include "prep/split_vertices.h"
#include "prep/triangulate.h"
#include "shapes.h"

namespace {

using prep::EdgeKind;
using prep::FaceState;
using prep::Mesh;
using prep::MeshView;
using prep::no_index;
using prep::NormalFallback;
using prep::Precision;
using Indices = std::vector<std::uint32_t>;

// How far a face's area vector is off, against its length.
double area_error(const Mesh& mesh, Precision precision) {
    const auto faces = prep::face_normals(MeshView(mesh), precision);
    const exact::Vector truth = exact::area_vector(mesh, 0);
    const exact::Vector off = exact::vector(faces.area_vectors[0]) - truth;
    const exact::Rational error2 = exact::dot(off, off), length2 = exact::dot(truth, truth);
    return std::sqrt(exact::Rational(error2 / length2).convert_to<double>());
}

TEST(ExactCases, ASliverHasAreaThoughItsProductsRoundAlike) {
    // In units of 2⁻⁵⁰ the products are 30 · 2⁵⁰ − 16 and − 17: doubles have steps of 4 there.
    const Mesh mesh = shapes::polygon({{0x1p-50f, 0x1p-49f, 0}, {3, 5, 0}, {6, 10, 0}});
    for (const Precision precision : {Precision::fast, Precision::accurate, Precision::exact}) {
        const auto faces = prep::face_normals(MeshView(mesh), precision);
        EXPECT_EQ(int(faces.states[0]), int(FaceState::regular));
        EXPECT_EQ(faces.area_vectors[0], glm::dvec3(0, 0, 0x1p-50));
    }
}

TEST(ExactCases, AreasThatNearlyCancelKeepTheirAccuracy) {
    // There and back along nearly the same way; coordinates of many more bits than a float's, once
    // the first corner is subtracted.
    std::mt19937_64 random(1);
    std::uniform_real_distribution<float> unit(-1, 1);
    for (int i = 0; i < 1000; ++i) {
        const auto vector = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
        const glm::vec3 first = 3e-5f * vector(), a = vector(), b = vector();
        const float aside = i % 2 ? 1e-4f : 1e-3f;
        const Mesh mesh = shapes::polygon({first, a, b, a + aside * vector()});
        ASSERT_LE(area_error(mesh, Precision::accurate), prep::accurate_face_error) << i;
        ASSERT_LE(area_error(mesh, Precision::fast), prep::fast_face_error) << i;
    }
}

TEST(ExactCases, TheTiniestTrianglesHaveArea) {
    for (const float size : {0x1p-149f, 0x1p-126f, 1e-30f, 1e-15f}) {
        const auto faces =
            prep::face_normals(MeshView(shapes::polygon({{0, 0, 0}, {size, 0, 0}, {0, size, 0}})));
        EXPECT_EQ(int(faces.states[0]), int(FaceState::regular)) << size;
        EXPECT_EQ(faces.area_vectors[0], glm::dvec3(0, 0, double(size) * double(size))) << size;
    }
}

TEST(ExactCases, FacesDecidedExactlyAreCountedOverAllBlocksOfWork) {
    // Every thousandth triangle lies on a line, its first corner too near zero for doubles to hold
    // its edges.
    Mesh mesh;
    for (std::uint32_t f = 0; f < 40000; ++f) {
        const float x = float(f % 200), y = float(f / 200);
        if (f % 1000 == 0)
            for (const float t : {0x1p-60f, 1.0f, 3.0f}) mesh.positions.emplace_back(t, t, t);
        else
            for (const glm::vec2 d : {glm::vec2(0, 0), {1, 0}, {0, 1}})
                mesh.positions.emplace_back(x + d.x, y + d.y, 0.0f);
        for (std::uint32_t k = 0; k < 3; ++k) mesh.corner_vertices.push_back(3 * f + k);
        mesh.face_offsets.push_back(3 * f + 3);
    }
    for (const int threads : {1, 3})
        EXPECT_EQ(prep::face_normals(MeshView(mesh), Precision::accurate, threads).exact_faces,
                  40u);
}

prep::CornerNormals smooth_normals(const Mesh& mesh, const prep::NormalOptions& options = {}) {
    const MeshView view(mesh);
    const prep::Topology topology = prep::build_topology(view);
    const prep::FaceNormals faces = prep::face_normals(view, options.precision);
    prep::HardEdgeOptions edges;
    edges.angle_degrees.reset();
    const auto hard = prep::hard_edges(view, topology, faces, edges);
    return *prep::corner_normals(view, topology, faces, *hard, options);
}

glm::vec3 normal(const prep::CornerNormals& n, std::uint32_t corner) {
    return n.normals.values[n.normals.indices[corner]];
}

// A leaf of two sides, smooth over its rim: the sides are as large as each other.
TEST(ExactCases, OfTwoEqualFacesTheGreaterVectorGivesTheNormal) {
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const struct {
        glm::vec3 a, b, expected;
    } planes[] = {{x, y, z}, {y, z, x}, {z, x, y}, {y, x, z}};
    for (const auto& [a, b, expected] : planes) {
        for (const bool turned : {false, true}) {
            const Mesh mesh =
                shapes::mesh_of({glm::vec3(0), a, b}, turned ? shapes::Faces{{2, 1, 0}, {0, 1, 2}}
                                                             : shapes::Faces{{0, 1, 2}, {2, 1, 0}});
            const prep::CornerNormals n = smooth_normals(mesh);
            for (std::uint32_t c = 0; c < 6; ++c) EXPECT_EQ(normal(n, c), expected) << turned;
            ASSERT_EQ(n.fallbacks.size(), 3u);
            for (const auto& f : n.fallbacks)
                EXPECT_EQ(int(f.kind), int(NormalFallback::largest_face));
        }
    }
}

TEST(ExactCases, FallbacksComeByCornerAndSayWhatTheyAre) {
    // A flat triangle over a good one's edge, a lonely flat one, and a leaf: corners ascend where
    // vertices descend.
    const Mesh mesh = shapes::mesh_of({{0, 0, 0},
                                       {4, 0, 0},
                                       {0, 4, 0},
                                       {9, 0, 0},
                                       {8, 0, 0},
                                       {7, 0, 0},
                                       {0, 0, 5},
                                       {4, 0, 5},
                                       {4, 4, 5},
                                       {2, 0, 5}},
                                      {{7, 6, 9}, {6, 7, 8}, {5, 4, 3}, {2, 1, 0}, {0, 1, 2}});
    const prep::CornerNormals n = smooth_normals(mesh);
    std::vector<std::pair<std::uint32_t, NormalFallback>> found;
    for (const auto& f : n.fallbacks) found.emplace_back(f.corner, f.kind);
    const std::vector<std::pair<std::uint32_t, NormalFallback>> expected{
        {2, NormalFallback::neighbour_face}, {6, NormalFallback::none_defined},
        {7, NormalFallback::none_defined},   {8, NormalFallback::none_defined},
        {9, NormalFallback::largest_face},   {10, NormalFallback::largest_face},
        {11, NormalFallback::largest_face}};
    EXPECT_EQ(found, expected);
    EXPECT_EQ(normal(n, 2), glm::vec3(0, 0, 1));
    EXPECT_EQ(normal(n, 0), glm::vec3(0, 0, 1));
}

TEST(ExactCases, SumsDecidedExactlyAreCountedOverAllBlocksOfWork) {
    Mesh mesh = shapes::mesh_of({{0, 0, 9}, {1, 0, 9}, {0, 1, 9}}, {{0, 1, 2}, {2, 1, 0}});
    mesh = shapes::joined(mesh, shapes::grid(120, 100));
    EXPECT_EQ(smooth_normals(mesh).exact_sums, 3u);
}

// Two faces folded flat on each other but for 2⁻¹²: floats leave nothing of their sum, and the
// promise for `fast` holds all the same.
TEST(ExactCases, FastNormalsOfSharpFoldsAreWithinTheirBound) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto vector = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
    prep::NormalOptions options;
    options.precision = Precision::fast;
    options.keep_doubles = true;
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 a = vector(), b = vector(), c = vector(), d = c + 0x1p-12f * vector();
        const Mesh mesh = shapes::mesh_of({a, b, c, d}, {{0, 1, 2}, {1, 0, 3}});
        const prep::CornerNormals n = smooth_normals(mesh, options);
        const exact::Vector truth = exact::area_vector(mesh, 0) + exact::area_vector(mesh, 1);
        const double angle = exact::angle_between(truth, n.doubles[n.normals.indices[0]]);
        ASSERT_LE(angle, prep::fast_normal_error) << i;
    }
}

// Twice the area vector by floats alone.
glm::vec3 float_area(const glm::vec3& a, const glm::vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Needles that fold by a degree or two: so much is left of their sum that no exact arithmetic is
// called for, and in a few of a hundred thousand floats alone would break the bound.
TEST(ExactCases, FastNormalsOfFoldedNeedlesAreWithinTheirBound) {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto vector = [&] {
        const float x = unit(random), y = unit(random), z = unit(random);
        return glm::vec3(x, y, z);
    };
    prep::NormalOptions options;
    options.precision = Precision::fast;
    options.keep_doubles = true;
    int risky = 0;
    for (int i = 0; i < 250000; ++i) {
        const glm::vec3 a = vector(), along = vector(), b = a + along;
        const float where = 0.5f + 0.4f * unit(random);
        const glm::vec3 c = a + where * along + 0.06f * vector(), d = c + 0.0021f * vector();
        const auto area = [](const glm::vec3& o, const glm::vec3& p, const glm::vec3& q) {
            return glm::cross(glm::dvec3(p) - glm::dvec3(o), glm::dvec3(q) - glm::dvec3(o));
        };
        const glm::dvec3 sum = area(a, b, c) + area(b, a, d);
        const glm::dvec3 by_floats =
            glm::dvec3(float_area(b - a, c - a)) + glm::dvec3(float_area(a - b, d - b));
        const double sine =
            glm::length(glm::cross(sum, by_floats)) / (glm::length(sum) * glm::length(by_floats));
        if (!(sine > prep::fast_normal_error)) continue;
        ++risky;
        const Mesh mesh = shapes::mesh_of({a, b, c, d}, {{0, 1, 2}, {1, 0, 3}});
        const prep::CornerNormals n = smooth_normals(mesh, options);
        const exact::Vector truth = exact::area_vector(mesh, 0) + exact::area_vector(mesh, 1);
        ASSERT_LE(exact::angle_between(truth, n.doubles[n.normals.indices[0]]),
                  prep::fast_normal_error)
            << i;
    }
    EXPECT_GT(risky, 100);
}

TEST(ExactCases, ASeamAtEitherEndOfAnEdgeIsABorder) {
    for (int end = -1; end < 2; ++end) {
        Mesh mesh = shapes::grid(2, 1);  // the common edge: corners 1–2 and 7–4
        mesh.uvs.resize(1);
        for (const glm::vec3& p : mesh.positions) mesh.uvs[0].values.emplace_back(p.x, p.y);
        mesh.uvs[0].indices = mesh.corner_vertices;
        mesh.uvs[0].values.push_back({7, 7});
        if (end == 0) mesh.uvs[0].indices[4] = 6;
        if (end == 1) mesh.uvs[0].indices[7] = 6;
        const MeshView view(mesh);
        const prep::Topology topology = prep::build_topology(view);
        prep::HardEdgeOptions options;
        options.uv_borders = true;
        const auto hard = prep::hard_edges(view, topology, prep::face_normals(view), options);
        EXPECT_EQ(hard->hard_count, end < 0 ? 0u : 1u);
        for (const std::uint32_t c : {1u, 7u})
            EXPECT_EQ(hard->reasons[c], end < 0 ? prep::hard_none : prep::hard_uv_border) << end;
    }
}

EdgeKind kind_of_first_edge(const Mesh& mesh) {
    return prep::build_topology(MeshView(mesh)).kinds[0];
}

TEST(ExactCases, EmptyFacesOnAnEdgeAreNoFacesOfIt) {
    const std::vector<glm::vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    // Two faces that run the same way, and an empty one.
    const Mesh mixed = shapes::mesh_of(points, {{0, 1, 2}, {0, 1, 3}, {0, 1, 1}});
    EXPECT_EQ(int(kind_of_first_edge(mixed)), int(EdgeKind::inconsistent));
    EXPECT_EQ(int(prep::build_topology(MeshView(mixed)).kinds[3]), int(EdgeKind::inconsistent));
    // One that runs there and back twice has two sides of its own there.
    const Mesh twice = shapes::mesh_of(points, {{0, 1, 2}, {0, 1, 0, 1}});
    for (const std::uint32_t c : {0u, 3u, 4u, 5u, 6u})
        EXPECT_EQ(int(prep::build_topology(MeshView(twice)).kinds[c]), int(EdgeKind::non_manifold))
            << c;
    EXPECT_EQ(prep::build_topology(MeshView(twice)).opposite[0], no_index);
}

TEST(ExactCases, ColorsOfPointsAreNotThoseOfFaces) {
    Mesh mesh = shapes::grid(1, 1);
    mesh.positions.push_back({9, 9, 9});
    mesh.points = {4, 0};
    for (int v = 0; v < 5; ++v) mesh.vertex_colors.emplace_back(0.1f * float(v), 0, 0, 1);
    // Two sets; the faces' first one has a value at two corners.
    mesh.colors = {{{{0, 1, 0, 1}}, {0, 0, no_index, no_index}},
                   {{{0, 0, 1, 1}, {1, 0, 1, 1}}, {0, 1, 0, 1}}};
    const auto out = prep::split(mesh);
    ASSERT_TRUE(out.has_value());
    ASSERT_EQ(out->colors.size(), 2u);
    for (std::uint32_t v = 0; v < out->vertex_count(); ++v) {
        const std::uint32_t c = out->source_corners[v];
        if (c == no_index) {
            EXPECT_EQ(out->colors[0][v], mesh.vertex_colors[4]);
            continue;
        }
        EXPECT_EQ(out->colors[0][v], c < 2 ? glm::vec4(0, 1, 0, 1) : glm::vec4(1)) << c;
        EXPECT_EQ(out->colors[1][v], mesh.colors[1].values[c % 2]) << c;
    }
}

TEST(ExactCases, AVertexOfManyCopiesSharesThoseThatAreEqual) {
    // Sixty faces around a vertex with forty normals, each of the later twenty a second time.
    Mesh mesh = shapes::fan(60);
    mesh.normals.indices.assign(mesh.corner_count(), 0);
    for (std::uint32_t i = 0; i < 80; ++i)
        mesh.normals.values.emplace_back(std::cos(float(i % 40)), std::sin(float(i % 40)), 0);
    std::set<std::uint32_t> distinct;
    for (std::uint32_t f = 0; f < 60; ++f) {
        for (std::uint32_t c = 3 * f; c < 3 * f + 3; ++c) {
            if (mesh.corner_vertices[c] != 0) continue;
            // The same values under other indices.
            mesh.normals.indices[c] = f < 40 ? f : 40 + f - 20;
            distinct.insert(mesh.normals.indices[c] % 40);
        }
    }
    ASSERT_EQ(distinct.size(), 40u);
    const auto out = prep::split(mesh);
    ASSERT_TRUE(out.has_value());
    std::uint32_t copies = 0;
    for (const std::uint32_t v : out->source_vertices) copies += v == 0;
    EXPECT_EQ(copies, 40u);
}

double area_of_triangles(const Mesh& mesh, const prep::Triangulation& t) {
    double sum = 0;
    for (std::size_t i = 0; i < t.corners.size(); i += 3) {
        const auto at = [&](std::size_t k) {
            return glm::dvec2(mesh.positions[mesh.corner_vertices[t.corners[i + k]]]);
        };
        const glm::dvec2 u = at(1) - at(0), v = at(2) - at(0);
        sum += std::abs(u.x * v.y - u.y * v.x) / 2;
    }
    return sum;
}

// Petals that all begin and end in one point: what an ear at that point covers may hold another
// petal.
TEST(ExactCases, PetalsThatTouchInTheirPointAreFilledOnce) {
    const double degree = std::acos(-1.0) / 180;
    for (const auto& starts : {std::vector<double>{0, 60}, {0, 40, 80}, {0, 100, 200, 300}}) {
        for (std::uint32_t first = 0; first < 3 * starts.size(); ++first) {
            std::vector<glm::vec3> corners;
            double area = 0;
            for (const double start : starts) {
                corners.emplace_back(0.0f);
                for (const double a : {start, start + 30})
                    corners.emplace_back(std::cos(a * degree), std::sin(a * degree), 0);
                area += std::sin(30 * degree) / 2;
            }
            std::rotate(corners.begin(), corners.begin() + first, corners.end());
            const Mesh mesh = shapes::polygon(corners);
            EXPECT_NEAR(area_of_triangles(mesh, prep::triangulate(MeshView(mesh))), area, 1e-6)
                << starts.size() << " petals from corner " << first;
        }
    }
}

TEST(ExactCases, ADartIsCutInsideWhicheverDiagonalIsShorter) {
    for (std::uint32_t first = 0; first < 4; ++first) {
        for (const float height : {1.2f, 9.0f}) {
            std::vector<glm::vec3> corners{{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {1, height, 0}};
            std::rotate(corners.begin(), corners.begin() + first, corners.end());
            const Mesh mesh = shapes::polygon(corners);
            EXPECT_NEAR(area_of_triangles(mesh, prep::triangulate(MeshView(mesh))), height - 1,
                        1e-6)
                << first;
        }
    }
}

TEST(ExactCases, ASquareIsCutFromItsFirstCorner) {
    const Mesh mesh = shapes::grid(1, 1);
    EXPECT_EQ(prep::triangulate(MeshView(mesh)).corners, (Indices{0, 1, 2, 0, 2, 3}));
}

// What is decided does not depend on which way is up: polygons with spikes, slits and corners on
// straight sides, turned by quarters.
TEST(ExactCases, QuarterTurnsOfPolygonsGiveTheSameTriangles) {
    std::mt19937_64 random(3);
    for (int i = 0; i < 400; ++i) {
        std::vector<glm::vec3> corners;
        glm::vec2 at(0);
        const std::size_t count = 5 + random() % 12;
        for (std::size_t k = 0; k < count; ++k) {
            corners.emplace_back(at, 0.0f);
            const float step = float(random() % 3);
            at += random() % 2 ? glm::vec2(step - 1, 0) : glm::vec2(0, step - 1);
        }
        corners.back() = {3, 3, 0};
        Mesh mesh = shapes::polygon(corners);
        // Without an area there is no plane to cut in.
        if (exact::area_vector(mesh, 0).z == 0) continue;
        const Indices expected = prep::triangulate(MeshView(mesh)).corners;
        for (int turns = 1; turns < 4; ++turns) {
            for (glm::vec3& p : mesh.positions) p = {-p.y, p.x, 0};
            ASSERT_EQ(prep::triangulate(MeshView(mesh)).corners, expected)
                << "polygon " << i << ", " << turns << " quarter turns";
        }
    }
}

}  // namespace
