#include "prep/hard_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "exact.h"
#include "exact/exact_normals.h"
#include "exact_dihedrals.h"
#include "shapes.h"

namespace {

using prep::HardEdgeOptions;
using prep::HardEdges;
using prep::Mesh;
using prep::MeshView;
using prep::Precision;

HardEdges hard_of(const Mesh& mesh, const HardEdgeOptions& options = {},
                  Precision precision = Precision::accurate) {
    const MeshView view(mesh);
    const prep::Topology topology = prep::build_topology(view);
    auto result = prep::hard_edges(view, topology, prep::face_normals(view, precision), options);
    EXPECT_TRUE(result.has_value());
    return *std::move(result);
}

HardEdgeOptions at_angle(double degrees) {
    HardEdgeOptions options;
    options.angle_degrees = degrees;
    return options;
}

// Reasons of a wedge's shared edge (half-edge 0 in both triangles' numbering: corners 0 and 3).
unsigned wedge_reasons(const Mesh& mesh, double degrees, Precision p = Precision::accurate) {
    const HardEdges hard = hard_of(mesh, at_angle(degrees), p);
    EXPECT_EQ(hard.reasons[0], hard.reasons[3]);
    return hard.reasons[0];
}

using hard_cases::exact_angles;
using hard_cases::ExactAngle;

exact::Rational squared(const ExactAngle& angle) {
    return exact::Rational(angle.squared_numerator, angle.squared_denominator);
}

TEST(HardEdges, EmptyMesh) {
    EXPECT_TRUE(hard_of(Mesh{}).reasons.empty());
}

TEST(HardEdges, CubeIsHardAtSixtyAndSmoothExactlyAtNinety) {
    EXPECT_EQ(hard_of(shapes::cube(), at_angle(60)).hard_count, 12u);
    EXPECT_EQ(hard_of(shapes::cube(), at_angle(90)).hard_count, 0u);
    EXPECT_EQ(hard_of(shapes::cube(), at_angle(89.999999999)).hard_count, 12u);
    EXPECT_EQ(hard_of(shapes::cube(), at_angle(90.000000001)).hard_count, 0u);
    HardEdgeOptions off;
    off.angle_degrees.reset();
    EXPECT_EQ(hard_of(shapes::cube(), off).hard_count, 0u);
    for (const unsigned r : hard_of(shapes::cube()).reasons) EXPECT_EQ(r, prep::hard_angle);
}

TEST(HardEdges, OneTriangleIsAllBorder) {
    const HardEdges hard = hard_of(shapes::polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(hard.reasons, std::vector<std::uint8_t>(3, prep::hard_border));
    EXPECT_EQ(hard.hard_count, 0u);
}

TEST(HardEdges, CylinderIsHardAroundItsCaps) {
    for (const std::uint32_t segments : {8u, 16u, 100u}) {
        const Mesh mesh = shapes::cylinder(segments);
        EXPECT_EQ(hard_of(mesh, at_angle(60)).hard_count, 2 * segments);
        EXPECT_EQ(hard_of(mesh, at_angle(90)).hard_count, 0u);
        const double turn = 360.0 / segments;
        EXPECT_EQ(hard_of(mesh, at_angle(turn - 0.01)).hard_count, 3 * segments);
        EXPECT_EQ(hard_of(mesh, at_angle(turn + 0.01)).hard_count, 2 * segments);
    }
}

// Each of a cap's edges is decided exactly, and the cap's own normal, a sum of as many products, is
// made once: 20,000 times it would take minutes.
TEST(HardEdges, CapsOfManyCornersAreDecidedExactly) {
    const std::uint32_t segments = 20000;
    Mesh mesh = shapes::cylinder(segments);
    const auto square = hard_of(mesh, at_angle(90));
    EXPECT_EQ(square.hard_count, 0u);
    EXPECT_EQ(square.exact_decisions, 2 * segments);
    EXPECT_EQ(hard_of(mesh, at_angle(89.999)).hard_count, 2 * segments);
    const prep::MeshView view(mesh);
    const prep::detail::ExactFaces exact(view);
    const auto right = prep::detail::threshold_of(90);
    std::vector<std::uint32_t> caps;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        if (mesh.face_offsets[f + 1] - mesh.face_offsets[f] == segments) caps.push_back(f);
    ASSERT_EQ(caps.size(), 2u);
    for (std::uint32_t f = 0; f < mesh.face_count(); f += 100)
        for (const std::uint32_t cap : caps)
            if (f != caps[0] && f != caps[1]) {
                EXPECT_FALSE(exact.turn_exceeds(f, cap, right));
            }
    EXPECT_EQ(exact.kept_made(), 2u);
}

TEST(HardEdges, BowTieHasTheEdgesOfTwoTetrahedra) {
    EXPECT_EQ(hard_of(shapes::bow_tie()).hard_count, 12u);
    EXPECT_EQ(hard_of(shapes::bow_tie(), at_angle(180)).hard_count, 0u);
}

TEST(HardEdges, AngleOutOfRangeIsAnError) {
    for (const double bad : {-1.0, 180.5, std::numeric_limits<double>::quiet_NaN()}) {
        const Mesh mesh = shapes::cube();
        const MeshView view(mesh);
        const auto result = prep::hard_edges(view, prep::build_topology(view),
                                             prep::face_normals(view), at_angle(bad));
        ASSERT_FALSE(result.has_value());
        EXPECT_EQ(result.error().code, prep::ErrorCode::invalid);
    }
}

TEST(HardEdges, WedgeExactlyAtTheThresholdIsSmooth) {
    for (const ExactAngle& angle : exact_angles()) {
        const Mesh mesh = shapes::wedge(angle.n0, angle.n1);
        EXPECT_FALSE(exact::turn_exceeds(exact::area_vector(mesh, 0), exact::area_vector(mesh, 1),
                                         angle.sign, squared(angle)));
        for (const Precision p : {Precision::fast, Precision::accurate, Precision::exact}) {
            EXPECT_EQ(wedge_reasons(mesh, angle.degrees, p), prep::hard_none) << angle.degrees;
            EXPECT_EQ(wedge_reasons(mesh, angle.degrees - 1e-9, p), prep::hard_angle)
                << angle.degrees;
            EXPECT_EQ(wedge_reasons(mesh, angle.degrees + 1e-9, p), prep::hard_none)
                << angle.degrees;
        }
    }
}

TEST(HardEdges, WedgeOneFloatStepOffTheThresholdFallsOnItsSide) {
    for (const ExactAngle& angle : exact_angles()) {
        int over = 0, under = 0;
        for (int vertex = 0; vertex < 4; ++vertex)
            for (int axis = 0; axis < 3; ++axis)
                for (const float towards : {-1e9f, 1e9f}) {
                    Mesh mesh = shapes::wedge(angle.n0, angle.n1);
                    float& x = mesh.positions[vertex][axis];
                    x = std::nextafter(x, towards);
                    const bool exceeds = exact::turn_exceeds(exact::area_vector(mesh, 0),
                                                             exact::area_vector(mesh, 1),
                                                             angle.sign, squared(angle));
                    ++(exceeds ? over : under);
                    for (const Precision p :
                         {Precision::fast, Precision::accurate, Precision::exact})
                        EXPECT_EQ(wedge_reasons(mesh, angle.degrees, p) == prep::hard_angle,
                                  exceeds)
                            << angle.degrees << " vertex " << vertex << " axis " << axis;
                }
        EXPECT_GT(over, 2) << angle.degrees;
        EXPECT_GT(under, 2) << angle.degrees;
    }
}

TEST(HardEdges, FoldAndFlatAtTheEndsOfTheRange) {
    const Mesh flat = shapes::fan_triangulated(shapes::grid(1, 1));
    EXPECT_EQ(hard_of(flat, at_angle(0)).hard_count, 0u);
    Mesh bent = flat;
    bent.positions[3].z = 1e-45f;
    EXPECT_EQ(hard_of(bent, at_angle(0)).hard_count, 1u);
    const Mesh fold = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5f, 0.25f, 0}},
                                      {{0, 1, 2}, {1, 0, 3}});
    EXPECT_EQ(hard_of(fold, at_angle(180)).hard_count, 0u);
    EXPECT_EQ(hard_of(fold, at_angle(179.9999)).hard_count, 1u);
}

// 1,000 random dihedrals exactly at the threshold under exact rotations, each with a power-of-two
// scale: every dihedral under every rotation. MESHPREP_LONG_TESTS=1 takes 1,000 rotations, a
// million decisions at each precision.
TEST(HardEdges, ThousandExactDihedralsUnderExactRotationsAndScales) {
    const int rotations = std::getenv("MESHPREP_LONG_TESTS") ? 1000 : 20;
    constexpr std::uint32_t dihedrals = 1000;
    std::mt19937_64 random(21);
    std::uniform_int_distribution<int> shift(-90, 80);
    std::vector<Mesh> meshes;
    std::uint32_t made = 0;
    for (std::size_t a = 0; a < exact_angles().size(); ++a) {
        const std::size_t left = exact_angles().size() - a;
        const std::uint32_t count = (dihedrals - made) / std::uint32_t(left);
        meshes.push_back(hard_cases::exact_dihedrals(exact_angles()[a], count, random));
        made += count;
    }
    ASSERT_EQ(made, dihedrals);
    std::uint64_t decisions = 0, hard_at = 0, soft_below = 0, exact_decisions = 0;
    for (int r = 0; r < rotations; ++r) {
        const glm::dmat3 rotation = hard_cases::exact_rotation(25, random);
        const int exponent = shift(random);
        for (std::size_t a = 0; a < meshes.size(); ++a) {
            Mesh mesh = meshes[a];
            ASSERT_TRUE(hard_cases::transform_exactly(mesh, rotation, exponent));
            const double degrees = exact_angles()[a].degrees;
            for (const Precision p : {Precision::fast, Precision::accurate}) {
                const HardEdges hard = hard_of(mesh, at_angle(degrees), p);
                hard_at += hard.hard_count;
                exact_decisions += hard.exact_decisions;
                decisions += mesh.face_count() / 2;
            }
            const HardEdges below = hard_of(mesh, at_angle(degrees - 1e-7));
            soft_below += mesh.face_count() / 2 - below.hard_count;
        }
    }
    EXPECT_EQ(hard_at, 0u);
    EXPECT_EQ(soft_below, 0u);
    EXPECT_EQ(decisions, 2u * dihedrals * std::uint64_t(rotations));
    EXPECT_EQ(exact_decisions, decisions);  // at the threshold no filter can tell
}

TEST(HardEdges, CubesUnderAThousandRotationsAndScalesStaySmoothAtNinety) {
    std::mt19937_64 random(22);
    std::uniform_int_distribution<int> shift(-80, 80);
    for (int i = 0; i < 1000; ++i) {
        Mesh mesh = shapes::cube();
        ASSERT_TRUE(hard_cases::transform_exactly(mesh, hard_cases::exact_rotation(61, random),
                                                  shift(random)));
        EXPECT_EQ(hard_of(mesh, at_angle(90)).hard_count, 0u);
        EXPECT_EQ(hard_of(mesh, at_angle(89.9999999)).hard_count, 12u);
    }
}

TEST(HardEdges, EverydayMeshesNeedNoExactDecision) {
    EXPECT_EQ(hard_of(shapes::torus(40, 20)).exact_decisions, 0u);
    EXPECT_EQ(hard_of(shapes::icosphere(3)).exact_decisions, 0u);
}

TEST(HardEdges, DecisionsAgreeWithRationalsOnRandomSurfaces) {
    std::mt19937_64 random(23);
    std::uniform_int_distribution<int> coordinate(-3, 3);  // small integers: many exact angles
    for (int i = 0; i < 40; ++i) {
        Mesh mesh = shapes::fan_triangulated(shapes::grid(6, 6), std::uint32_t(i % 2));
        for (glm::vec3& p : mesh.positions) p = p * 2.0f + glm::vec3(0, 0, coordinate(random));
        const MeshView view(mesh);
        const prep::Topology t = prep::build_topology(view);
        for (const ExactAngle& angle : exact_angles()) {
            const auto hard =
                prep::hard_edges(view, t, prep::face_normals(view), at_angle(angle.degrees));
            for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
                if (t.opposite[c] == prep::no_index) continue;
                EXPECT_EQ((hard->reasons[c] & prep::hard_angle) != 0,
                          exact::turn_exceeds(exact::area_vector(mesh, c / 3),
                                              exact::area_vector(mesh, t.opposite[c] / 3),
                                              angle.sign, squared(angle)));
            }
        }
    }
}

// Three quads in a row, turned by 45° each; edges between 0 and 1 and between 1 and 2.
struct Strip {
    Mesh mesh;
    std::uint32_t first = 0, second = 0;  // their half-edges in quad 1
};
Strip strip() {
    Strip s;
    s.mesh = shapes::mesh_of(
        {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 1}, {2, 1, 1}, {2, 0, 2}, {2, 1, 2}},
        {{0, 2, 3, 1}, {2, 4, 5, 3}, {4, 6, 7, 5}});
    s.first = 7;
    s.second = 5;
    return s;
}

TEST(HardEdges, OverlappingMasksAreSmoothWhereTheyIntersect) {
    Strip s = strip();
    s.mesh.smoothing_kind = prep::SmoothingKind::bit_mask;
    s.mesh.face_smoothing = {1, 3, 2};  // 0 and 1 share bit 0, 1 and 2 share bit 1
    HardEdges hard = hard_of(s.mesh, at_angle(10));
    EXPECT_EQ(hard.reasons[s.first], prep::hard_none);  // 45°, but in a common group
    EXPECT_EQ(hard.reasons[s.second], prep::hard_none);
    s.mesh.face_smoothing = {1, 3, 4};
    hard = hard_of(s.mesh, at_angle(80));
    EXPECT_EQ(hard.reasons[s.first], prep::hard_none);
    EXPECT_EQ(hard.reasons[s.second], prep::hard_smoothing_group);  // 45° < 80°, no common group
    s.mesh.face_smoothing = {0, 0, 0};
    EXPECT_EQ(hard_of(s.mesh, at_angle(80)).hard_count, 2u);  // 0 is smooth with nothing
}

TEST(HardEdges, GroupNumbersAreSmoothWhenEqual) {
    Strip s = strip();
    s.mesh.face_smoothing = {1, 3, 3};  // as masks 1 and 3 would intersect
    const HardEdges hard = hard_of(s.mesh, at_angle(10));
    EXPECT_EQ(hard.reasons[s.first], prep::hard_smoothing_group);
    EXPECT_EQ(hard.reasons[s.second], prep::hard_none);
    s.mesh.face_smoothing = {0, 0, 1};
    EXPECT_EQ(hard_of(s.mesh).hard_count, 2u);
}

TEST(HardEdges, AngleInsideGroupsOnRequestAndGroupsCanBeIgnored) {
    Strip s = strip();
    s.mesh.face_smoothing = {1, 1, 2};
    HardEdgeOptions options = at_angle(10);
    options.angle_inside_groups = true;
    HardEdges hard = hard_of(s.mesh, options);
    EXPECT_EQ(hard.reasons[s.first], prep::hard_angle);
    EXPECT_EQ(hard.reasons[s.second], prep::hard_angle | prep::hard_smoothing_group);
    options = at_angle(80);
    options.smoothing_groups = false;
    EXPECT_EQ(hard_of(s.mesh, options).hard_count, 0u);
}

TEST(HardEdges, MarksAndInfinitelySharpCreases) {
    Strip s = strip();
    s.mesh.hard_marks = {{3, 2}};  // either direction
    s.mesh.subdivision.creases = {{4, 5, 10.0f}, {0, 1, 3.0f}};
    HardEdges hard = hard_of(s.mesh, at_angle(80));
    EXPECT_EQ(hard.reasons[s.first], prep::hard_mark);
    EXPECT_EQ(hard.reasons[s.second], prep::hard_mark);
    s.mesh.subdivision.creases[0].sharpness = 9.9f;
    EXPECT_EQ(hard_of(s.mesh, at_angle(80)).reasons[s.second], prep::hard_none);
    HardEdgeOptions options = at_angle(80);
    options.marks = false;
    EXPECT_EQ(hard_of(s.mesh, options).hard_count, 0u);
}

TEST(HardEdges, MarksOutOfRangeAreIgnored) {
    Strip s = strip();
    s.mesh.hard_marks = {{3, 900}, {prep::no_index, 2}};
    EXPECT_EQ(hard_of(s.mesh, at_angle(80)).hard_count, 0u);
}

TEST(HardEdges, UvAndMaterialBordersOnRequest) {
    Strip s = strip();
    s.mesh.face_materials = {0, 0, 1};
    s.mesh.uvs.resize(1);
    s.mesh.uvs[0].values = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {1, 0}};
    // Quad 1 uses another UV at the first edge; value 4 repeats value 1, so that the edge between 1
    // and 2 differs in index only.
    s.mesh.uvs[0].indices = {0, 1, 2, 3, 0, 1, 2, 3, 4, 1, 1, 2};
    HardEdgeOptions options = at_angle(80);
    EXPECT_EQ(hard_of(s.mesh, options).hard_count, 0u);
    options.material_borders = true;
    EXPECT_EQ(hard_of(s.mesh, options).reasons[s.second], prep::hard_material);
    options.uv_borders = true;
    const HardEdges hard = hard_of(s.mesh, options);
    EXPECT_EQ(hard.reasons[s.first], prep::hard_uv_border);
    EXPECT_EQ(hard.reasons[s.second], prep::hard_material);
}

TEST(HardEdges, ThreeFacesOnAnEdgeAreHard) {
    HardEdgeOptions off;
    off.angle_degrees.reset();
    const HardEdges hard = hard_of(shapes::book(3, true), off);
    for (const std::uint32_t c : {0u, 3u, 6u}) EXPECT_EQ(hard.reasons[c], prep::hard_non_manifold);
    EXPECT_EQ(hard.reasons[1], prep::hard_border);
    EXPECT_EQ(hard_of(shapes::book(2, false), off).reasons[0], prep::hard_non_manifold);
}

TEST(HardEdges, SlitGoesByTheFaceAcrossItsLongestEdge) {
    // A 90° edge whose one side is split: the collinear triangle (0, 1, 4) fills the T-junction.
    const Mesh mesh = shapes::mesh_of({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 0, -1}, {1, 0, 0}},
                                      {{0, 1, 2}, {1, 0, 4}, {4, 0, 3}, {1, 4, 3}});
    const HardEdges hard = hard_of(mesh, at_angle(60));
    EXPECT_EQ(hard.reasons[0], prep::hard_none);   // the slit goes by face 0
    EXPECT_EQ(hard.reasons[4], prep::hard_angle);  // 0–4: against face 2
    EXPECT_EQ(hard.reasons[5], prep::hard_angle);  // 4–1: against face 3
    Mesh flat = mesh;
    flat.positions[3] = {1, -1, 0};
    EXPECT_EQ(hard_of(flat, at_angle(60)).hard_count, 0u);
}

TEST(HardEdges, NonFiniteFacesCountAsMissing) {
    Mesh mesh = shapes::cube();
    mesh.positions[7].x = std::numeric_limits<float>::infinity();
    HardEdgeOptions off;
    off.angle_degrees.reset();
    const HardEdges hard = hard_of(mesh, off);
    EXPECT_EQ(std::count(hard.reasons.begin(), hard.reasons.end(), prep::hard_border), 18);
    EXPECT_EQ(hard.hard_count, 9u);  // the edges of the three faces at the vertex
}

TEST(HardEdges, OrderOfFacesAndVerticesAndThreadsDoNotMatter) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937_64 random(seed);
        Mesh mesh = shapes::torus(12, 8);
        shapes::jitter(mesh, 0.2f, random);
        // Some slits and folds.
        for (int i = 0; i < 10; ++i) {
            const std::size_t v = random() % mesh.vertex_count();
            mesh.positions[v] = mesh.positions[random() % mesh.vertex_count()];
        }
        const HardEdges base = hard_of(mesh);
        const auto order = shapes::random_order(mesh.face_count(), random);
        const auto numbers = shapes::random_order(mesh.vertex_count(), random);
        const HardEdges other =
            hard_of(shapes::with_vertex_order(shapes::with_face_order(mesh, order), numbers));
        for (std::uint32_t f = 0; f < order.size(); ++f)
            for (std::uint32_t k = 0; k < 4; ++k)
                EXPECT_EQ(other.reasons[4 * f + k], base.reasons[4 * order[f] + k]);
        EXPECT_EQ(other.hard_count, base.hard_count);
    }
    const Mesh large = shapes::torus(300, 200);
    HardEdgeOptions options = at_angle(1.0);
    options.threads = 1;
    const HardEdges one = hard_of(large, options);
    for (const int threads : {2, 3, 8}) {
        options.threads = threads;
        EXPECT_EQ(hard_of(large, options).reasons, one.reasons);
    }
}

}  // namespace
