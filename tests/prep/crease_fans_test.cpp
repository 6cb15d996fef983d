// The walk around each point against the general way over the topology, whose own tests hold it to
// exact arithmetic: the same decisions and the same bits, or none.
#include "normals/crease_fans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <random>

#include "hard_cases.h"
#include "normals/gathered_terms.h"
#include "prep/corner_normals.h"
#include "prep/topology.h"
#include "sanitized.h"
#include "shapes.h"
#include "steps.h"
#include "surface/vertex_corners.h"

namespace {

using prep::HardEdgeOptions;
using prep::Mesh;
using prep::MeshView;
using prep::NormalOptions;

struct Both {
    std::optional<prep::CreaseNormals> walked;
    prep::HardEdges hard;
    prep::CornerNormals normals;
};

Both both_ways(const Mesh& mesh, const HardEdgeOptions& edges, const NormalOptions& options,
               bool weld) {
    const MeshView view(mesh);
    const std::vector<std::uint32_t> welded =
        weld ? prep::weld_exact(view.positions) : std::vector<std::uint32_t>{};
    std::vector<std::uint32_t> points = mesh.corner_vertices;
    if (weld)
        for (std::uint32_t& p : points) p = welded[p];
    const prep::FaceNormals faces = prep::face_normals(view, options.precision);
    const prep::Topology topology = prep::build_topology(view, welded);
    Both both;
    both.hard = prep::hard_edges(view, topology, faces, edges).value();
    both.normals = prep::corner_normals(view, topology, faces, both.hard, options).value();
    const auto around =
        prep::detail::corners_by_vertex(points, mesh.vertex_count(), options.threads);
    if (prep::detail::may_have_crease_fans(view, options))
        both.walked =
            prep::detail::crease_fans(view, points, welded, around, faces, edges, options);
    return both;
}

std::vector<std::uint32_t> bits(const std::vector<glm::vec3>& values) {
    std::vector<std::uint32_t> result;
    for (const glm::vec3& v : values)
        for (int k = 0; k < 3; ++k) result.push_back(std::bit_cast<std::uint32_t>(v[k]));
    return result;
}

// Whether the walk came to an end.
bool expect_the_same(const Mesh& mesh, const HardEdgeOptions& edges = {},
                     const NormalOptions& options = {}, bool weld = false) {
    const Both both = both_ways(mesh, edges, options, weld);
    if (!both.walked) return false;
    EXPECT_EQ(both.walked->hard.reasons, both.hard.reasons);
    EXPECT_EQ(both.walked->hard.hard_count, both.hard.hard_count);
    EXPECT_EQ(both.walked->hard.exact_decisions, both.hard.exact_decisions);
    EXPECT_EQ(both.walked->normals.normals.indices, both.normals.normals.indices);
    EXPECT_EQ(bits(both.walked->normals.normals.values), bits(both.normals.normals.values));
    EXPECT_EQ(both.walked->normals.exact_sums, both.normals.exact_sums);
    EXPECT_EQ(both.walked->normals.fallbacks.size(), both.normals.fallbacks.size());
    if (both.walked->normals.fallbacks.size() == both.normals.fallbacks.size())
        for (std::size_t i = 0; i < both.normals.fallbacks.size(); ++i) {
            EXPECT_EQ(both.walked->normals.fallbacks[i].corner, both.normals.fallbacks[i].corner);
            EXPECT_EQ(both.walked->normals.fallbacks[i].kind, both.normals.fallbacks[i].kind);
        }
    return true;
}

HardEdgeOptions at_angle(double degrees) {
    HardEdgeOptions options;
    options.angle_degrees = degrees;
    return options;
}

// Smooth all over, in part and nowhere.
TEST(CreaseFans, AreThoseOfTheGeneralWayAtEveryAngle) {
    std::mt19937_64 random(17);
    Mesh bumpy = shapes::fan_triangulated(shapes::torus(40, 30));
    shapes::jitter(bumpy, 0.03f, random);
    for (const double angle : {0.0, 1.0, 5.0, 20.0, 40.0, 60.0, 90.0, 120.0, 180.0}) {
        SCOPED_TRACE(angle);
        EXPECT_TRUE(expect_the_same(bumpy, at_angle(angle)));
        EXPECT_TRUE(expect_the_same(shapes::fan_triangulated(shapes::cube()), at_angle(angle)));
        EXPECT_TRUE(expect_the_same(shapes::icosphere(3), at_angle(angle)));
        EXPECT_TRUE(
            expect_the_same(shapes::fan_triangulated(shapes::cylinder(9)), at_angle(angle)));
    }
}

// A mesh whose vertices and triangles are in random order, with vertices that nothing uses.
Mesh in_random_order(const Mesh& mesh, std::mt19937_64& random) {
    constexpr std::uint32_t unused = 3;
    std::vector<std::uint32_t> places(mesh.vertex_count() + unused), faces(mesh.face_count());
    std::iota(places.begin(), places.end(), 0u);
    std::iota(faces.begin(), faces.end(), 0u);
    std::shuffle(places.begin(), places.end(), random);
    std::shuffle(faces.begin(), faces.end(), random);
    Mesh out;
    out.positions.resize(places.size());
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        out.positions[places[v]] = mesh.positions[v];
    for (const std::uint32_t f : faces) {
        for (std::uint32_t c = 3 * f; c < 3 * f + 3; ++c)
            out.corner_vertices.push_back(places[mesh.corner_vertices[c]]);
        out.face_offsets.push_back(std::uint32_t(out.corner_vertices.size()));
    }
    return out;
}

// Large enough to be gathered: several chunks of triangles, and of blocks of points a last one that
// is not full.
TEST(CreaseFans, OfTrianglesInRandomOrder) {
    std::mt19937_64 random(41);
    Mesh mesh = shapes::fan_triangulated(shapes::torus(300, 240));
    shapes::jitter(mesh, 0.004f, random);
    EXPECT_FALSE(prep::detail::GatheredTerms::pays(mesh.corner_vertices));
    mesh = in_random_order(mesh, random);
    ASSERT_TRUE(prep::detail::GatheredTerms::pays(mesh.corner_vertices));
    NormalOptions options;
    for (const double angle : {10.0, 60.0})
        for (const int threads : {1, 3}) {
            options.threads = threads;
            // Of 216,000 edges some are hard: fans that are one, and some that are not.
            const Both both = both_ways(mesh, at_angle(angle), options, false);
            EXPECT_GT(both.hard.hard_count, 1000u);
            EXPECT_LT(both.hard.hard_count, angle == 60 ? 20'000u : 216'000u);
            EXPECT_TRUE(expect_the_same(mesh, at_angle(angle), options));
        }
}

// Against their definition.
TEST(CreaseFans, GatheredTermsAreThoseOfTheCorners) {
    std::mt19937_64 random(43);
    const Mesh mesh = in_random_order(shapes::fan_triangulated(shapes::torus(300, 240)), random);
    const std::vector<std::uint32_t>& points = mesh.corner_vertices;
    const auto around = prep::detail::corners_by_vertex(points, mesh.vertex_count(), 2);
    std::vector<glm::dvec3> areas;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) areas.emplace_back(f, 2 * f, -double(f));
    for (const int threads : {1, 3}) {
        const prep::detail::GatheredTerms gathered(points, around, areas, threads);
        constexpr std::size_t step = prep::detail::GatheredTerms::block_points;
        std::size_t wrong = 0;
        for (std::size_t first = 0; first < mesh.vertex_count(); first += step) {
            const std::size_t last = std::min(first + step, mesh.vertex_count());
            const std::uint32_t begin = around.offsets[first];
            std::vector<prep::detail::CornerTerm> terms(around.offsets[last] - begin);
            gathered.put_in_order(first, around, terms);
            for (std::size_t i = 0; i < terms.size(); ++i) {
                const std::uint32_t c = around.corners[begin + i], f = c / 3, k = c % 3;
                wrong += terms[i].area != areas[f] ||
                         terms[i].next != points[3 * f + (k + 1) % 3] ||
                         terms[i].previous != points[3 * f + (k + 2) % 3];
            }
        }
        EXPECT_EQ(wrong, 0u);
    }
}

TEST(CreaseFans, EndAtBordersAndMeetAtSharedVertices) {
    EXPECT_TRUE(expect_the_same(shapes::fan_triangulated(shapes::grid(7, 5))));
    EXPECT_TRUE(expect_the_same(shapes::bow_tie()));
    EXPECT_TRUE(expect_the_same(shapes::joined(shapes::bow_tie(), shapes::fan(5))));
    // Vertices that no face uses have no normal.
    Mesh loose = shapes::joined(shapes::fan(6), shapes::icosphere(1));
    loose.positions.insert(loose.positions.begin(), {{9, 9, 9}, {8, 8, 8}});
    for (std::uint32_t& v : loose.corner_vertices) v += 2;
    EXPECT_TRUE(expect_the_same(loose));
}

// Around a pole not all corners are compared with all.
TEST(CreaseFans, OfAnyValence) {
    for (const std::uint32_t valence : {3u, 7u, 8u, 9u, 10u, 200u, 20'000u}) {
        SCOPED_TRACE(valence);
        EXPECT_TRUE(expect_the_same(shapes::fan(valence)));
        EXPECT_TRUE(
            expect_the_same(shapes::fan_triangulated(shapes::uv_sphere(valence, 4)), at_angle(30)));
    }
}

TEST(CreaseFans, OfWeldedPoints) {
    const Mesh cube = shapes::soup(shapes::fan_triangulated(shapes::cube()));
    EXPECT_TRUE(expect_the_same(cube, {}, {}, true));
    EXPECT_TRUE(expect_the_same(cube, at_angle(120), {}, true));
    EXPECT_TRUE(expect_the_same(shapes::soup(shapes::icosphere(3)), at_angle(10), {}, true));
}

TEST(CreaseFans, OfEveryWeightAndPrecision) {
    std::mt19937_64 random(5);
    Mesh mesh = shapes::icosphere(3);
    shapes::jitter(mesh, 0.1f, random);
    // Borders, and fans that a threshold divides.
    Mesh sheet = shapes::fan_triangulated(shapes::grid(14, 9));
    shapes::jitter(sheet, 0.3f, random);
    ASSERT_GT(both_ways(sheet, at_angle(25), {}, false).hard.hard_count, 100u);
    for (const auto& weight : names_of(prep::NormalWeight{}))
        for (const auto& precision : names_of(prep::Precision{})) {
            NormalOptions options;
            options.weight = weight.value;
            options.precision = precision.value;
            EXPECT_TRUE(expect_the_same(mesh, {}, options)) << weight.name << precision.name;
            EXPECT_TRUE(expect_the_same(sheet, at_angle(25), options))
                << weight.name << precision.name;
        }
}

TEST(CreaseFans, OfTheSmallestMeshes) {
    EXPECT_TRUE(expect_the_same(Mesh()));
    const Mesh one = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
    EXPECT_TRUE(expect_the_same(one));
    // Both sides of one triangle: a turn of 180 degrees over every edge, and sums that vanish where
    // it is smooth.
    const Mesh leaf = shapes::mesh_of(one.positions, {{0, 1, 2}, {0, 2, 1}});
    for (const double angle : {60.0, 180.0})
        for (const auto& precision : names_of(prep::Precision{})) {
            NormalOptions options;
            options.precision = precision.value;
            EXPECT_TRUE(expect_the_same(leaf, at_angle(angle), options)) << angle;
        }
    EXPECT_EQ(both_ways(leaf, at_angle(180), {}, false).normals.fallbacks.size(), 3u);
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    Mesh broken = shapes::icosphere(1);
    broken.positions[3].y = nan;
    EXPECT_FALSE(expect_the_same(broken));
    // That no face uses.
    Mesh loose = shapes::icosphere(1);
    loose.positions.push_back({nan, 0, 0});
    EXPECT_TRUE(expect_the_same(loose));
}

TEST(CreaseFans, ObeyGroupsMarksMaterialsAndUvs) {
    std::mt19937_64 random(23);
    Mesh mesh = shapes::icosphere(3);
    HardEdgeOptions options = at_angle(20);
    mesh = hard_cases::with_uvs(mesh);
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        mesh.face_smoothing.push_back(std::uint32_t(random() % 3));
    EXPECT_TRUE(expect_the_same(mesh, options));
    options.angle_inside_groups = true;
    EXPECT_TRUE(expect_the_same(mesh, options));
    mesh.smoothing_kind = prep::SmoothingKind::bit_mask;
    EXPECT_TRUE(expect_the_same(mesh, options));
    mesh.face_smoothing.clear();
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        mesh.face_materials.push_back(std::uint32_t(random() % 2));
    options.material_borders = options.uv_borders = true;
    EXPECT_TRUE(expect_the_same(mesh, options));
    for (std::size_t c = 0; c < mesh.corner_count(); c += 9)
        mesh.hard_marks.emplace_back(mesh.corner_vertices[c], mesh.corner_vertices[c + 1]);
    EXPECT_TRUE(expect_the_same(mesh, options));
    options.angle_degrees.reset();
    EXPECT_TRUE(expect_the_same(mesh, options));
}

// Closed fans of few corners are summed without a ring where no edge can be hard, and where
// attributes decide: there with as many exact decisions as the general way makes.
std::vector<HardEdgeOptions> without_turns_by_far() {
    HardEdgeOptions smooth;
    smooth.angle_degrees.reset();
    HardEdgeOptions in_groups = at_angle(12);
    in_groups.angle_inside_groups = in_groups.uv_borders = in_groups.material_borders = true;
    return {smooth, at_angle(12), in_groups};
}

TEST(CreaseFans, WithoutAnAngleAndByAttributes) {
    std::mt19937_64 random(31);
    Mesh bumpy = shapes::fan_triangulated(shapes::torus(40, 30));
    shapes::jitter(bumpy, 0.05f, random);
    Mesh grouped = hard_cases::with_uvs(bumpy);
    for (std::size_t f = 0; f < grouped.face_count(); ++f) {
        grouped.face_smoothing.push_back(std::uint32_t(1 + f / 400));
        grouped.face_materials.push_back(std::uint32_t(f / 900));
    }
    // Two closed fans at one vertex, whose sums do not cancel as those of a bow tie do.
    Mesh touching = shapes::joined(shapes::fan(4), shapes::fan(4, 0.25));
    for (std::uint32_t& v : touching.corner_vertices)
        if (v == 5) v = 0;
    shapes::jitter(touching, 0.1f, random);
    for (const double angle : {120.0, 180.0}) {
        const Both both = both_ways(touching, at_angle(angle), {}, false);
        ASSERT_EQ(both.normals.normals.values.size(), 10u);
        EXPECT_TRUE(expect_the_same(touching, at_angle(angle)));
    }
    for (const HardEdgeOptions& options : without_turns_by_far())
        for (const Mesh& mesh : {bumpy, grouped, touching, shapes::fan_triangulated(shapes::cube()),
                                 shapes::fan_triangulated(shapes::grid(7, 5)), shapes::bow_tie(),
                                 shapes::fan(8), shapes::fan(9), shapes::icosphere(3)})
            for (const auto& precision : names_of(prep::Precision{})) {
                NormalOptions normal;
                normal.precision = precision.value;
                EXPECT_TRUE(expect_the_same(mesh, options, normal));
            }
    // Coplanar faces at a threshold of none: every turn is decided exactly.
    HardEdgeOptions flat = at_angle(0);
    Mesh sheet = shapes::fan_triangulated(shapes::grid(9, 6));
    sheet.face_smoothing.assign(sheet.face_count(), 1);
    flat.angle_inside_groups = true;
    EXPECT_TRUE(expect_the_same(sheet, flat));
    EXPECT_GT(both_ways(sheet, flat, {}, false).walked->hard.exact_decisions, 50u);
}

TEST(CreaseFans, LeaveNonManifoldEdgesAndEmptyFacesToTheGeneralWay) {
    EXPECT_FALSE(expect_the_same(shapes::book(3)));
    EXPECT_FALSE(expect_the_same(shapes::book(4, true)));
    EXPECT_FALSE(expect_the_same(shapes::book(2)));  // both run the same way
    EXPECT_FALSE(expect_the_same(shapes::fan_triangulated(shapes::moebius(12))));
    EXPECT_FALSE(expect_the_same(shapes::cube()));  // no triangles
    // A face that leaves a closed fan's apex over an edge of it, and comes first.
    const Mesh flap =
        shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 1, 1}},
                        {{0, 1, 5}, {0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}});
    for (const HardEdgeOptions& options : without_turns_by_far())
        EXPECT_FALSE(expect_the_same(flap, options));
    Mesh flat = shapes::icosphere(1);
    flat.positions[0] = flat.positions[flat.corner_vertices[1]];
    flat.positions[flat.corner_vertices[0]] = flat.positions[flat.corner_vertices[1]];
    EXPECT_FALSE(expect_the_same(flat));
}

// Nothing exact is computed before it is known that the walk comes to its end.
TEST(CreaseFans, MatchAllPointsBeforeExactSums) {
    const Mesh mesh = shapes::joined(shapes::icosphere(4), shapes::book(3));
    const MeshView view(mesh);
    const auto around =
        prep::detail::corners_by_vertex(mesh.corner_vertices, mesh.vertex_count(), 1);
    NormalOptions options;
    options.precision = prep::Precision::exact;
    options.threads = 1;
    const prep::FaceNormals faces = prep::face_normals(view, options.precision);
    EXPECT_EQ(test::steps_of([&] {
                  EXPECT_FALSE(prep::detail::crease_fans(view, mesh.corner_vertices, {}, around,
                                                         faces, {}, options));
              }),
              0u);
    const Mesh whole = shapes::icosphere(4);
    EXPECT_GE(test::steps_of([&] { expect_the_same(whole, {}, options); }), whole.corner_count());
}

// Where it comes to an end, whatever the mesh.
TEST(CreaseFans, AgreeOnHardAndOddCases) {
    std::size_t walked = 0, number = 0;
    for (const auto& cases : {hard_cases::measured(), hard_cases::odd()})
        for (const hard_cases::Case& one : cases) {
            if (test::sanitized && number++ % 12 != 0) continue;
            SCOPED_TRACE(one.axis + " " + std::to_string(one.value));
            const Mesh mesh = shapes::fan_triangulated(one.mesh);
            for (const bool weld : {false, true})
                for (const double angle : {1.0, 60.0})
                    walked += expect_the_same(mesh, at_angle(angle), {}, weld);
            expect_the_same(mesh, without_turns_by_far()[0]);
        }
    EXPECT_GT(walked, test::sanitized ? 6u : 20u);
    std::mt19937_64 random(3);
    walked = 0;
    for (int n = 0; n < (test::sanitized ? 100 : 300); ++n) {
        SCOPED_TRACE(n);
        const Mesh mesh =
            shapes::random_triangles(4 + std::size_t(n) % 40, 1 + std::size_t(n) % 12, random);
        walked += expect_the_same(mesh);
        for (const HardEdgeOptions& options : without_turns_by_far())
            expect_the_same(mesh, options);
    }
    EXPECT_GT(walked, test::sanitized ? 20u : 60u);
}

// Both ways behind one function.
TEST(CreaseNormals, AreThoseOfTheFourSteps) {
    std::size_t walked = 0;
    for (const Mesh& mesh :
         {shapes::soup(shapes::icosphere(3)), shapes::fan_triangulated(shapes::cube()),
          shapes::cube(), shapes::book(4)})
        for (const bool weld : {false, true}) {
            const Both both = both_ways(mesh, at_angle(10), {}, weld);
            walked += both.walked.has_value();
            const MeshView view(mesh);
            const auto welded =
                weld ? prep::weld_exact(view.positions) : std::vector<std::uint32_t>{};
            const auto at_once = prep::crease_normals(view, welded, at_angle(10));
            ASSERT_TRUE(at_once.has_value());
            EXPECT_EQ(at_once->hard.reasons, both.hard.reasons);
            EXPECT_EQ(at_once->normals.normals.indices, both.normals.normals.indices);
            EXPECT_EQ(bits(at_once->normals.normals.values), bits(both.normals.normals.values));
        }
    EXPECT_EQ(walked, 4u);  // the triangles of the first two, welded or not
    const Mesh sphere = shapes::icosphere(1);
    const auto refused = prep::crease_normals(MeshView(sphere), {}, at_angle(181));
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().code, prep::ErrorCode::invalid);
}

TEST(CreaseFans, AreTheSameOnAnyNumberOfThreads) {
    std::mt19937_64 random(29);
    Mesh mesh = shapes::fan_triangulated(shapes::torus(260, 150));
    shapes::jitter(mesh, 0.004f, random);
    for (const int threads : {1, 2, 8}) {
        NormalOptions options;
        options.threads = threads;
        HardEdgeOptions edges = at_angle(12);
        edges.threads = threads;
        EXPECT_TRUE(expect_the_same(mesh, edges, options));
    }
}

}  // namespace
