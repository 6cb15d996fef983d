#include "prep/corner_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "exact.h"
#include "shapes.h"

namespace {

using prep::CornerNormals;
using prep::HardEdgeOptions;
using prep::Mesh;
using prep::MeshView;
using prep::NormalFallback;
using prep::NormalOptions;
using prep::NormalWeight;
using prep::Precision;

constexpr NormalWeight weights[] = {NormalWeight::area, NormalWeight::uniform, NormalWeight::angle,
                                    NormalWeight::area_angle, NormalWeight::edge_length};
constexpr Precision precisions[] = {Precision::fast, Precision::accurate, Precision::exact};
constexpr double pi = std::numbers::pi;

HardEdgeOptions at_angle(double degrees) {
    HardEdgeOptions options;
    options.angle_degrees = degrees;
    return options;
}

NormalOptions weighted(NormalWeight weight, Precision precision = Precision::accurate) {
    NormalOptions options;
    options.weight = weight;
    options.precision = precision;
    options.keep_doubles = true;
    return options;
}

CornerNormals normals_of(const Mesh& mesh, const HardEdgeOptions& edges = {},
                         const NormalOptions& options = weighted(NormalWeight::area),
                         bool weld = false) {
    const MeshView view(mesh);
    const prep::Topology topology = prep::build_topology(
        view, weld ? prep::weld_exact(view.positions) : std::vector<std::uint32_t>{});
    const prep::FaceNormals faces = prep::face_normals(view, options.precision, options.threads);
    const auto hard = prep::hard_edges(view, topology, faces, edges);
    EXPECT_TRUE(hard.has_value());
    auto result = prep::corner_normals(view, topology, faces, *hard, options);
    EXPECT_TRUE(result.has_value());
    EXPECT_EQ(result->normals.indices.size(), mesh.corner_count());
    return *std::move(result);
}

glm::vec3 at(const CornerNormals& n, std::uint32_t corner) {
    return n.normals.values[n.normals.indices[corner]];
}
glm::dvec3 double_at(const CornerNormals& n, std::uint32_t corner) {
    return n.doubles[n.normals.indices[corner]];
}
// The float nearest to a direction's unit vector.
glm::vec3 unit(const glm::dvec3& v) {
    return glm::vec3(v / glm::length(v));
}
std::uint32_t corner_at(const Mesh& mesh, std::uint32_t face, std::uint32_t vertex) {
    for (std::uint32_t c = mesh.face_offsets[face]; c < mesh.face_offsets[face + 1]; ++c)
        if (mesh.corner_vertices[c] == vertex) return c;
    ADD_FAILURE() << "face " << face << " has no vertex " << vertex;
    return 0;
}
// Compared in double; the order-free sum stops refining at 2^-45.
void expect_direction(const CornerNormals& n, std::uint32_t corner, const glm::dvec3& direction,
                      double tolerance = 0x1p-45) {
    const glm::dvec3 expected = direction / glm::length(direction);
    EXPECT_LT(glm::length(double_at(n, corner) - expected), tolerance) << "corner " << corner;
    EXPECT_EQ(at(n, corner), glm::vec3(double_at(n, corner)));
}
void expect_unit(const CornerNormals& n) {
    for (const glm::vec3& v : n.normals.values)
        EXPECT_NEAR(glm::length(glm::dvec3(v)), 1.0, 1e-7);  // three roundings to float
}

// The box corner at zero with legs 1, 2, 4 and the slanted face that closes it.
Mesh box_corner(float a = 1, float b = 2, float c = 4) {
    return shapes::mesh_of({{0, 0, 0}, {a, 0, 0}, {0, b, 0}, {0, 0, c}},
                           {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}});
}

TEST(CornerNormals, EmptyMesh) {
    const CornerNormals n = normals_of(Mesh{});
    EXPECT_TRUE(n.normals.values.empty());
    EXPECT_TRUE(n.fallbacks.empty());
}

TEST(CornerNormals, OneTriangleHasItsFaceNormalThreeTimes) {
    const Mesh mesh = shapes::polygon({{3, 1, 2}, {4, 1, 2}, {3, 5, 2}});
    for (const NormalWeight w : weights)
        for (const Precision p : precisions) {
            const CornerNormals n = normals_of(mesh, {}, weighted(w, p));
            EXPECT_EQ(n.normals.values, std::vector<glm::vec3>(3, glm::vec3(0, 0, 1)));
            EXPECT_EQ(n.normals.indices, (std::vector<std::uint32_t>{0, 1, 2}));
            EXPECT_TRUE(n.fallbacks.empty());
        }
}

TEST(CornerNormals, CubeIsFlatBelowNinetyDegrees) {
    const Mesh mesh = shapes::cube();
    const glm::vec3 expected[] = {{0, 0, -1}, {0, 0, 1},  {0, -1, 0},
                                  {0, 1, 0},  {-1, 0, 0}, {1, 0, 0}};
    for (const NormalWeight w : weights)
        for (const Precision p : precisions) {
            const CornerNormals n = normals_of(mesh, at_angle(60), weighted(w, p));
            EXPECT_EQ(n.normals.values.size(), 24u);
            for (std::uint32_t c = 0; c < 24; ++c) EXPECT_EQ(at(n, c), expected[c / 4]);
        }
}

TEST(CornerNormals, CubeIsSmoothAtNinetyDegrees) {
    const Mesh mesh = shapes::cube();
    for (const NormalWeight w : weights)
        for (const Precision p : precisions) {
            const CornerNormals n = normals_of(mesh, at_angle(90), weighted(w, p));
            EXPECT_EQ(n.normals.values.size(), 8u);
            for (std::uint32_t c = 0; c < 24; ++c)
                EXPECT_EQ(at(n, c), unit(glm::dvec3(mesh.positions[mesh.corner_vertices[c]])));
        }
}

TEST(CornerNormals, CylinderIsRoundOnItsSideAndFlatOnItsCaps) {
    for (const std::uint32_t segments : {7u, 16u, 64u}) {
        const Mesh mesh = shapes::cylinder(segments);
        for (const NormalWeight w : weights) {
            const CornerNormals n = normals_of(mesh, at_angle(60), weighted(w));
            EXPECT_EQ(n.normals.values.size(), 4 * segments);
            for (std::uint32_t c = 0; c < 4 * segments; ++c) {
                const glm::vec3 p = mesh.positions[mesh.corner_vertices[c]];
                // The rim is rounded to float: 2^-24 across a segment of 2π / segments.
                expect_direction(n, c, {p.x, p.y, 0}, 1e-7 * segments);
            }
            for (std::uint32_t c = 4 * segments; c < 6 * segments; ++c)
                EXPECT_EQ(at(n, c), glm::vec3(0, 0, c < 5 * segments ? -1 : 1));
        }
    }
}

// Twelve points on a circle of radius 5, exactly; neighbours are √10 and √2 apart.
TEST(CornerNormals, UnevenCylinderHasTheClosedFormOfEachWeight) {
    const Mesh mesh = shapes::prism({{5, 0},
                                     {4, 3},
                                     {3, 4},
                                     {0, 5},
                                     {-3, 4},
                                     {-4, 3},
                                     {-5, 0},
                                     {-4, -3},
                                     {-3, -4},
                                     {0, -5},
                                     {3, -4},
                                     {4, -3}});
    const double r10 = std::sqrt(10.0), r2 = std::sqrt(2.0);
    // At (4, 3), between sides with the normals (3, 1)/√10 and (1, 1)/√2.
    const struct {
        NormalWeight weight;
        glm::dvec3 direction;
    } cases[] = {
        {NormalWeight::area, {2, 1, 0}},
        {NormalWeight::uniform, {3 / r10 + 1 / r2, 1 / r10 + 1 / r2, 0}},
        {NormalWeight::angle, {3 / r10 + 1 / r2, 1 / r10 + 1 / r2, 0}},
        {NormalWeight::area_angle, {2, 1, 0}},
        {NormalWeight::edge_length, {4, 3, 0}},  // the circle's own normal
    };
    for (const auto& c : cases)
        for (const Precision p : {Precision::accurate, Precision::exact}) {
            const CornerNormals n = normals_of(mesh, at_angle(60), weighted(c.weight, p));
            EXPECT_EQ(n.normals.values.size(), 48u);
            for (const std::uint32_t vertex : {1u, 13u})
                for (const std::uint32_t face : {0u, 1u})
                    expect_direction(n, corner_at(mesh, face, vertex), c.direction);
            expect_direction(n, corner_at(mesh, 0, 0), {1, 0, 0});
        }
}

TEST(CornerNormals, BoxCornerHasTheClosedFormOfEachWeight) {
    const Mesh mesh = box_corner();
    const struct {
        NormalWeight weight;
        glm::dvec3 direction;
    } cases[] = {
        {NormalWeight::area, {-8, -4, -2}},  // areas bc/2, ca/2, ab/2
        {NormalWeight::uniform, {-1, -1, -1}},
        {NormalWeight::angle, {-1, -1, -1}},  // three right angles
        {NormalWeight::area_angle, {-8, -4, -2}},
        {NormalWeight::edge_length, {-1, -2, -4}},  // through the circumscribed sphere's centre
    };
    for (const auto& c : cases)
        for (const Precision p : {Precision::accurate, Precision::exact}) {
            const CornerNormals n = normals_of(mesh, at_angle(180), weighted(c.weight, p));
            EXPECT_EQ(n.normals.values.size(), 4u);
            for (const std::uint32_t face : {0u, 1u, 2u})
                expect_direction(n, corner_at(mesh, face, 0), c.direction);
        }
}

TEST(CornerNormals, UnequalAnglesHaveTheClosedFormOfEachWeight) {
    // At the end of a leg of length 1: two faces with 45° there and the slanted one with 60°.
    const Mesh mesh = box_corner(1, 1, 1);
    const glm::dvec3 straight(0, -1, -1), slanted(1, 1, 1);
    const double r3 = std::sqrt(3.0);
    const struct {
        NormalWeight weight;
        glm::dvec3 direction;
    } cases[] = {
        {NormalWeight::area, straight + slanted},  // the slanted one is √3 times as large
        {NormalWeight::uniform, straight + slanted / r3},
        {NormalWeight::angle, pi / 4 * straight + pi / 3 / r3 * slanted},
        {NormalWeight::area_angle, pi / 4 * straight + pi / 3 * slanted},
        {NormalWeight::edge_length, {1, -1, -1}},
    };
    for (const auto& c : cases)
        for (const Precision p : {Precision::accurate, Precision::exact}) {
            const CornerNormals n = normals_of(mesh, at_angle(180), weighted(c.weight, p));
            expect_direction(n, corner_at(mesh, 3, 1), c.direction);
        }
}

TEST(CornerNormals, ReflexCornerOfAPolygonHasItsReflexAngle) {
    // An L-shaped prism; vertex 3 is the notch, at (1, 1): 270° in the cap, 90° in the two sides.
    const Mesh mesh = shapes::prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
    const std::uint32_t top = 7, notch = 9;
    const struct {
        NormalWeight weight;
        glm::dvec3 direction;
    } cases[] = {
        {NormalWeight::area, {2, 2, 3}},        {NormalWeight::uniform, {1, 1, 1}},
        {NormalWeight::angle, {1, 1, 3}},       {NormalWeight::area_angle, {2, 2, 9}},
        {NormalWeight::edge_length, {1, 1, 2}},  // sines of 1; edges of 1·2, 1·2 and 1·1
    };
    for (const auto& c : cases)
        for (const Precision p : {Precision::accurate, Precision::exact}) {
            const CornerNormals n = normals_of(mesh, at_angle(180), weighted(c.weight, p));
            expect_direction(n, corner_at(mesh, top, notch), c.direction);
        }
}

TEST(CornerNormals, EdgeLengthWeightsAreExactOnASphere) {
    std::mt19937_64 random(31);
    std::normal_distribution<double> normal;
    // A pyramid of random points on a sphere around its first: any polyhedral fan will do.
    std::vector<glm::vec3> positions{{0, 0, 1}};
    for (int i = 0; i < 9; ++i) {
        const double phi = 2 * pi * (i + 0.3 * std::sin(normal(random))) / 9;
        const double theta = 0.5 + 0.3 * std::sin(normal(random));
        positions.push_back(glm::vec3(std::sin(theta) * std::cos(phi),
                                      std::sin(theta) * std::sin(phi), std::cos(theta)));
    }
    shapes::Faces faces;
    for (std::uint32_t i = 0; i < 9; ++i) faces.push_back({0, 1 + i, 1 + (i + 1) % 9});
    const Mesh mesh = shapes::mesh_of(positions, faces);
    const CornerNormals n = normals_of(mesh, at_angle(180), weighted(NormalWeight::edge_length));
    expect_direction(n, 0, {0, 0, 1}, 1e-6);  // the points are rounded to float
    const CornerNormals area = normals_of(mesh, at_angle(180), weighted(NormalWeight::area));
    EXPECT_GT(glm::length(double_at(area, 0) - glm::dvec3(0, 0, 1)), 1e-3);
}

TEST(CornerNormals, WedgeIsSmoothAtTheThresholdAndSplitJustOverIt) {
    // The normals (1, 1, 0) and (1, 0, 1) are exactly 60° apart.
    const Mesh exactly = shapes::wedge({1, 1, 0}, {1, 0, 1});
    for (const Precision p : precisions) {
        const CornerNormals n =
            normals_of(exactly, at_angle(60), weighted(NormalWeight::uniform, p));
        EXPECT_EQ(n.normals.values.size(), 4u);
        for (const std::uint32_t c : {0u, 1u, 3u, 4u}) EXPECT_EQ(at(n, c), unit({2, 1, 1}));
        EXPECT_EQ(at(n, 2), unit({1, 1, 0}));
        EXPECT_EQ(at(n, 5), unit({1, 0, 1}));
    }
    int over = 0, under = 0;
    for (const float towards : {-1e9f, 1e9f}) {
        Mesh mesh = exactly;
        mesh.positions[3].x = std::nextafter(mesh.positions[3].x, towards);
        const exact::Vector a = exact::area_vector(mesh, 0), b = exact::area_vector(mesh, 1);
        const bool exceeds = exact::turn_exceeds(a, b, 1, exact::Rational(1, 4));
        ++(exceeds ? over : under);
        for (const Precision p : precisions) {
            const CornerNormals n =
                normals_of(mesh, at_angle(60), weighted(NormalWeight::uniform, p));
            EXPECT_EQ(n.normals.values.size(), exceeds ? 6u : 4u);
            EXPECT_EQ(at(n, 0) == at(n, 4), !exceeds);
            if (exceeds) {
                EXPECT_EQ(at(n, 0), unit({1, 1, 0}));
            }
        }
    }
    EXPECT_EQ(over, 1);
    EXPECT_EQ(under, 1);
}

TEST(CornerNormals, BowTieVertexHasOneNormalForEachSide) {
    const Mesh mesh = shapes::bow_tie();
    const CornerNormals n = normals_of(mesh, at_angle(180));
    EXPECT_EQ(n.normals.values.size(), 8u);
    // Three sides of a closed tetrahedron sum to minus the fourth.
    for (const std::uint32_t face : {1u, 2u, 3u})
        EXPECT_EQ(at(n, corner_at(mesh, face, 0)), glm::vec3(0, 0, -1));
    for (const std::uint32_t face : {5u, 6u, 7u})
        EXPECT_EQ(at(n, corner_at(mesh, face, 0)), glm::vec3(0, 0, 1));
    // The same as a soup whose equal positions are welded.
    const CornerNormals welded =
        normals_of(shapes::soup(mesh), at_angle(180), weighted(NormalWeight::area), true);
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) EXPECT_EQ(at(welded, c), at(n, c));
}

TEST(CornerNormals, ThreeFacesOnAnEdgeKeepTheirOwnNormals) {
    // A T: wings towards +x, −x and +y on the edge 0–1; the wing +x goes on over the edge 1–2 by a
    // face turned 45° up.
    const Mesh mesh =
        shapes::mesh_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {1, 1, 1}},
                        {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {2, 1, 5}});
    for (const NormalWeight w : weights) {
        const CornerNormals n = normals_of(mesh, at_angle(180), weighted(w));
        for (const std::uint32_t vertex : {0u, 1u}) {
            EXPECT_EQ(at(n, corner_at(mesh, 1, vertex)), glm::vec3(0, 1, 0));
            EXPECT_EQ(at(n, corner_at(mesh, 2, vertex)), glm::vec3(-1, 0, 0));
        }
        EXPECT_EQ(at(n, corner_at(mesh, 0, 0)), glm::vec3(0, 1, 0));
        // The fan goes on over 1–2, though not over 0–1.
        EXPECT_EQ(n.normals.indices[corner_at(mesh, 0, 1)],
                  n.normals.indices[corner_at(mesh, 3, 1)]);
        EXPECT_NE(at(n, corner_at(mesh, 0, 1)), glm::vec3(0, 1, 0));
    }
    const CornerNormals n = normals_of(mesh, at_angle(180));
    // Area vectors (0, 1, 0) and (−1, 1, −1).
    expect_direction(n, corner_at(mesh, 0, 1), {-1, 2, -1});
}

// The box corner's three straight faces around vertex 0, as one fan, by overlapping masks.
TEST(CornerNormals, OverlappingMasksJoinWhatTheyConnect) {
    Mesh mesh = box_corner(1, 1, 1);
    mesh.smoothing_kind = prep::SmoothingKind::bit_mask;
    mesh.face_smoothing = {1, 3, 2, 0};  // faces 0 and 2 have none in common, but 1 joins them
    CornerNormals n = normals_of(mesh, at_angle(10));
    for (const std::uint32_t face : {0u, 1u, 2u})
        EXPECT_EQ(at(n, corner_at(mesh, face, 0)), unit({-1, -1, -1}));
    EXPECT_EQ(at(n, corner_at(mesh, 0, 1)), glm::vec3(0, 0, -1));  // 0 and 2 meet at 0–1: hard
    EXPECT_EQ(at(n, corner_at(mesh, 2, 1)), glm::vec3(0, -1, 0));
    EXPECT_EQ(at(n, corner_at(mesh, 0, 2)), unit({-1, 0, -1}));  // 0 and 1 meet at 0–2: smooth
    EXPECT_EQ(at(n, corner_at(mesh, 3, 1)), unit({1, 1, 1}));    // 0: smooth with nothing
    mesh.face_smoothing = {1, 3, 4, 0};
    n = normals_of(mesh, at_angle(180));
    EXPECT_EQ(at(n, corner_at(mesh, 0, 0)), unit({-1, 0, -1}));
    EXPECT_EQ(at(n, corner_at(mesh, 1, 0)), unit({-1, 0, -1}));
    EXPECT_EQ(at(n, corner_at(mesh, 2, 0)), glm::vec3(0, -1, 0));
}

TEST(CornerNormals, GroupNumbersJoinOnlyWhenEqual) {
    Mesh mesh = box_corner(1, 1, 1);
    mesh.face_smoothing = {1, 3, 3, 0};  // as masks 1 and 3 would meet
    const CornerNormals n = normals_of(mesh, at_angle(10));
    EXPECT_EQ(at(n, corner_at(mesh, 0, 0)), glm::vec3(0, 0, -1));
    EXPECT_EQ(at(n, corner_at(mesh, 1, 0)), unit({-1, -1, 0}));
    EXPECT_EQ(at(n, corner_at(mesh, 2, 0)), unit({-1, -1, 0}));
}

TEST(CornerNormals, AreaWeightsFollowTheDiagonalsAngleWeightsDoNot) {
    const Mesh quads = shapes::cube();
    for (std::uint32_t first = 0; first < 4; ++first) {
        const Mesh cut = shapes::fan_triangulated(quads, first);
        const CornerNormals area = normals_of(cut, at_angle(90));
        const CornerNormals angle = normals_of(cut, at_angle(90), weighted(NormalWeight::angle));
        std::vector<glm::dvec3> sums(8, glm::dvec3(0.0));
        for (std::uint32_t c = 0; c < cut.corner_count(); ++c) {
            const exact::Vector v = exact::area_vector(cut, c / 3);
            sums[cut.corner_vertices[c]] += glm::dvec3(
                v.x.convert_to<double>(), v.y.convert_to<double>(), v.z.convert_to<double>());
        }
        bool differs = false;
        for (std::uint32_t c = 0; c < cut.corner_count(); ++c) {
            const std::uint32_t v = cut.corner_vertices[c];
            const glm::vec3 diagonal = unit(glm::dvec3(cut.positions[v]));
            EXPECT_EQ(at(area, c), unit(sums[v]));  // multiples of 4 along each axis
            differs |= at(area, c) != diagonal;
            expect_direction(angle, c, glm::dvec3(cut.positions[v]));
        }
        EXPECT_TRUE(differs);
    }
}

TEST(CornerNormals, PlanarQuadsAndTheirTrianglesAgree) {
    Mesh quads = shapes::grid(7, 5);
    for (glm::vec3& p : quads.positions) p = {p.x, 2 * p.y, p.x + p.y};  // stays planar
    const glm::vec3 expected = unit({-2, -1, 2});
    for (const NormalWeight w : weights)
        for (const std::uint32_t first : {0u, 1u, 4u}) {
            const Mesh mesh = first == 4 ? quads : shapes::fan_triangulated(quads, first);
            const CornerNormals n = normals_of(mesh, at_angle(0), weighted(w));
            EXPECT_EQ(n.normals.values.size(), quads.vertex_count());
            for (const glm::vec3& v : n.normals.values) EXPECT_EQ(v, expected);
        }
}

// ---- Degenerate input ----

TEST(CornerNormals, OppositeFacesTakeTheLargestAndSaySo) {
    const Mesh leaf = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}});
    for (const NormalWeight w : weights)
        for (const Precision p : precisions) {
            const CornerNormals n = normals_of(leaf, at_angle(180), weighted(w, p));
            ASSERT_EQ(n.fallbacks.size(), 3u);
            for (const auto& f : n.fallbacks) EXPECT_EQ(f.kind, NormalFallback::largest_face);
            // A tie: the greater vector.
            EXPECT_EQ(n.normals.values, std::vector<glm::vec3>(3, glm::vec3(0, 0, 1)));
        }
    const CornerNormals apart = normals_of(leaf, at_angle(60));
    EXPECT_TRUE(apart.fallbacks.empty());
    EXPECT_EQ(at(apart, 0), glm::vec3(0, 0, 1));
    EXPECT_EQ(at(apart, 3), glm::vec3(0, 0, -1));
}

TEST(CornerNormals, FacesWithoutAreaAddNothing) {
    // A quad as two triangles with an empty triangle on its diagonal.
    const Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                      {{0, 1, 2}, {0, 2, 3}, {0, 2, 2}});
    for (const NormalWeight w : weights) {
        const CornerNormals n = normals_of(mesh, {}, weighted(w));
        EXPECT_TRUE(n.fallbacks.empty());
        for (std::uint32_t c = 0; c < 6; ++c) EXPECT_EQ(at(n, c), glm::vec3(0, 0, 1));
        expect_unit(n);
    }
}

TEST(CornerNormals, SlitTakesItsNeighboursNormal) {
    // A collinear triangle whose middle vertex no other face has.
    const Mesh mesh =
        shapes::mesh_of({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1, 0, 0}}, {{0, 1, 2}, {1, 0, 3}});
    for (const NormalWeight w : weights) {
        const CornerNormals n = normals_of(mesh, {}, weighted(w));
        for (std::uint32_t c = 0; c < 6; ++c) EXPECT_EQ(at(n, c), glm::vec3(0, 0, 1));
        ASSERT_EQ(n.fallbacks.size(), 1u);
        EXPECT_EQ(n.fallbacks[0].corner, 5u);
        EXPECT_EQ(n.fallbacks[0].kind, NormalFallback::neighbour_face);
    }
}

TEST(CornerNormals, NothingToGoByGivesZ) {
    const Mesh meshes[] = {
        shapes::polygon({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}),
        shapes::polygon({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}),
        shapes::mesh_of({{0, 0, 0}}, {{0, 0, 0}}),
        shapes::polygon({{0, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<float>::quiet_NaN(), 0}}),
        shapes::polygon({{0, 0, 0}, {std::numeric_limits<float>::infinity(), 0, 0}, {0, 1, 0}}),
    };
    for (const Mesh& mesh : meshes)
        for (const NormalWeight w : weights)
            for (const Precision p : precisions) {
                const CornerNormals n = normals_of(mesh, {}, weighted(w, p));
                EXPECT_EQ(n.fallbacks.size(), n.normals.values.size());
                for (const auto& f : n.fallbacks) EXPECT_EQ(f.kind, NormalFallback::none_defined);
                for (const glm::vec3& v : n.normals.values) EXPECT_EQ(v, glm::vec3(0, 0, 1));
            }
}

TEST(CornerNormals, NonFiniteFacesHarmNoOther) {
    Mesh mesh = shapes::cube();
    mesh.positions[7].y = std::numeric_limits<float>::quiet_NaN();
    const CornerNormals n = normals_of(mesh, at_angle(180));
    expect_unit(n);
    // Vertex 0 is on the three faces that are left, vertex 1 on two of them.
    EXPECT_EQ(at(n, corner_at(mesh, 0, 0)), unit({-1, -1, -1}));
    EXPECT_EQ(at(n, corner_at(mesh, 0, 1)), unit({0, -1, -1}));
    EXPECT_EQ(at(n, corner_at(mesh, 5, 1)), glm::vec3(0, 0, 1));
    EXPECT_EQ(n.fallbacks.size(), 12u);
}

TEST(CornerNormals, DenormalAndHugeCoordinates) {
    for (const int exponent : {-149, -126, -60, 60, 120, 126}) {
        Mesh mesh = shapes::cube();
        for (glm::vec3& p : mesh.positions)
            p = glm::vec3(glm::dvec3(p) * std::ldexp(1.0, exponent));
        for (const NormalWeight w : weights)
            for (const Precision p : precisions) {
                const CornerNormals n = normals_of(mesh, at_angle(90), weighted(w, p));
                EXPECT_TRUE(n.fallbacks.empty());
                for (std::uint32_t c = 0; c < 24; ++c) {
                    const glm::dvec3 sign =
                        glm::sign(glm::dvec3(mesh.positions[mesh.corner_vertices[c]]));
                    EXPECT_EQ(at(n, c), unit(sign)) << exponent;
                }
            }
    }
}

TEST(CornerNormals, PoleOfHundredThousandFaces) {
    const std::uint32_t valence = 100'000;
    const Mesh mesh = shapes::fan(valence);
    for (const NormalWeight w : weights) {
        const CornerNormals n = normals_of(mesh, at_angle(180), weighted(w));
        EXPECT_EQ(n.normals.values.size(), valence + 1u);
        // The rim's float grid (6e-8) against a step of 6e-5, averaged.
        expect_direction(n, 0, {0, 0, 1}, 1e-5);
    }
}

TEST(CornerNormals, EverydayMeshesNeedNoExactSum) {
    for (const NormalWeight w : weights)
        for (const Precision p : {Precision::fast, Precision::accurate}) {
            EXPECT_EQ(normals_of(shapes::torus(40, 20), {}, weighted(w, p)).exact_sums, 0u);
            EXPECT_EQ(normals_of(shapes::icosphere(3), {}, weighted(w, p)).exact_sums, 0u);
            // The two sides of a leaf cancel at all of its corners.
            const Mesh leaf =
                shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}});
            EXPECT_EQ(normals_of(leaf, at_angle(180), weighted(w, p)).exact_sums, 3u);
        }
}

// ---- Order, threads ----

Mesh hostile_torus(std::mt19937_64& random) {
    Mesh mesh = shapes::torus(12, 8);
    shapes::jitter(mesh, 0.2f, random);
    for (int i = 0; i < 10; ++i)  // slits, folds and cancelling fans
        mesh.positions[random() % mesh.vertex_count()] =
            mesh.positions[random() % mesh.vertex_count()];
    return mesh;
}

TEST(CornerNormals, OrderOfFacesAndVerticesChangesNoBit) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937_64 random(seed);
        const Mesh mesh =
            seed % 2 ? hostile_torus(random) : shapes::random_triangles(30, 60, random);
        const auto order = shapes::random_order(mesh.face_count(), random);
        const auto numbers = shapes::random_order(mesh.vertex_count(), random);
        const Mesh other = shapes::with_vertex_order(shapes::with_face_order(mesh, order), numbers);
        for (const NormalWeight w : weights)
            for (const Precision p : precisions)
                for (const double angle : {60.0, 180.0}) {
                    const CornerNormals a = normals_of(mesh, at_angle(angle), weighted(w, p));
                    const CornerNormals b = normals_of(other, at_angle(angle), weighted(w, p));
                    EXPECT_EQ(a.normals.values.size(), b.normals.values.size());
                    EXPECT_EQ(a.fallbacks.size(), b.fallbacks.size());
                    for (std::uint32_t f = 0, c = 0; f < order.size(); ++f)
                        for (std::uint32_t k = mesh.face_offsets[order[f]];
                             k < mesh.face_offsets[order[f] + 1]; ++k, ++c) {
                            EXPECT_EQ(double_at(b, c), double_at(a, k));
                            EXPECT_EQ(at(b, c), at(a, k));
                        }
                }
    }
}

TEST(CornerNormals, ThreadsChangeNoByte) {
    std::mt19937_64 random(33);
    Mesh mesh = shapes::torus(300, 200);
    shapes::jitter(mesh, 0.01f, random);
    for (const NormalWeight w : weights)
        for (const Precision p : {Precision::fast, Precision::accurate}) {
            NormalOptions options = weighted(w, p);
            options.threads = 1;
            const CornerNormals one = normals_of(mesh, at_angle(30), options);
            for (const int threads : {2, 8}) {
                options.threads = threads;
                const CornerNormals many = normals_of(mesh, at_angle(30), options);
                EXPECT_EQ(one.normals.values, many.normals.values);
                EXPECT_EQ(one.normals.indices, many.normals.indices);
                EXPECT_EQ(one.doubles, many.doubles);
            }
        }
}

TEST(CornerNormals, PowerOfTwoScalesChangeNoBit) {
    std::mt19937_64 random(34);
    const Mesh mesh = hostile_torus(random);
    for (const NormalWeight w : weights)
        for (const Precision p : precisions) {
            const CornerNormals base = normals_of(mesh, {}, weighted(w, p));
            for (const int exponent : {-80, -7, 1, 100}) {
                Mesh scaled = mesh;
                for (glm::vec3& v : scaled.positions) v *= std::ldexp(1.0f, exponent);
                EXPECT_EQ(normals_of(scaled, {}, weighted(w, p)).doubles, base.doubles);
            }
        }
}

}  // namespace
