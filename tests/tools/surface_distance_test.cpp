// Distances of surfaces against CGAL's bounded Hausdorff distance, and a needle that samples miss.
#include "cost/measure/surface_distance.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "shapes.h"

namespace {

using cost::Triangle;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

std::vector<Triangle> triangles_of(const prep::Mesh& mesh) {
    std::vector<Triangle> out;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t c = mesh.face_offsets[f];
        Triangle t;
        for (std::uint32_t i = 0; i < 3; ++i)
            t[i] = glm::dvec3(mesh.positions[mesh.corner_vertices[c + i]]);
        out.push_back(t);
    }
    return out;
}

CgalMesh cgal_of(const prep::Mesh& mesh) {
    CgalMesh out;
    std::vector<CgalMesh::Vertex_index> v;
    for (const glm::vec3& p : mesh.positions)
        v.push_back(out.add_vertex({double(p.x), double(p.y), double(p.z)}));
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t* c = &mesh.corner_vertices[mesh.face_offsets[f]];
        out.add_face(v[c[0]], v[c[1]], v[c[2]]);
    }
    return out;
}

TEST(SurfaceDistance, AgreesWithCgalsBoundedHausdorffDistance) {
    std::mt19937_64 random(5);
    constexpr double bound = 1e-3;
    for (int k = 0; k < 8; ++k) {
        prep::Mesh a = shapes::icosphere(2);
        prep::Mesh b = k % 2 == 0 ? shapes::icosphere(1 + k / 4)
                                  : shapes::fan_triangulated(shapes::uv_sphere(12 + 4 * k, 9));
        shapes::jitter(a, 0.02f * float(k + 1), random);
        shapes::jitter(b, 0.05f, random);
        const auto ours =
            cost::one_sided_distance(triangles_of(a), triangles_of(b), {.tolerance = 1e-4});
        const double theirs =
            CGAL::Polygon_mesh_processing::bounded_error_Hausdorff_distance<CGAL::Sequential_tag>(
                cgal_of(a), cgal_of(b), bound);
        EXPECT_LE(ours.low, ours.high);
        EXPECT_LE(ours.high - ours.low, 1e-4);
        EXPECT_NEAR(ours.low, theirs, bound + 1e-4) << k;
        // The point that is named is as far away.
        double nearest = INFINITY;
        for (const Triangle& t : triangles_of(b))
            nearest = std::min(nearest, glm::distance(ours.at, cost::nearest_point(t, ours.at)));
        EXPECT_NEAR(nearest, ours.low, 1e-12);
    }
}

// A needle of 1e-7 of the area whose tip stands 1 % of the diagonal above a ball, on one side or
// the other: the distance is found in all of 50, in both directions.
TEST(SurfaceDistance, FindsANeedleThatSamplesMiss) {
    std::mt19937_64 random(11);
    const prep::Mesh ball = shapes::icosphere(3);
    const std::vector<Triangle> smooth = triangles_of(ball);
    double area = 0;
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const Triangle& t : smooth) {
        area += 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
        for (const glm::dvec3& p : t) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    }
    const double diagonal = glm::length(high - low), height = 0.01 * diagonal;
    const double width = 2e-7 * area / height;
    int found = 0;
    for (int seed = 0; seed < 50; ++seed) {
        const Triangle& foot = smooth[random() % smooth.size()];
        const glm::dvec3 along = glm::normalize(foot[1] - foot[0]);
        const glm::dvec3 normal = glm::normalize(glm::cross(foot[1] - foot[0], foot[2] - foot[0]));
        const glm::dvec3 at = (foot[0] + foot[1] + foot[2]) / 3.0;
        std::vector<Triangle> spiked = smooth;
        spiked.insert(spiked.begin() + std::ptrdiff_t(random() % smooth.size()),
                      {at, at + width * along, at + height * normal});
        const cost::DistanceOptions options{.tolerance = 1e-5 * diagonal};
        const auto there = cost::one_sided_distance(spiked, smooth, options);
        const auto back = cost::one_sided_distance(smooth, spiked, options);
        const double both = std::max(there.low, back.low);
        found += both >= 0.009 * diagonal && std::max(there.high, back.high) <= 0.0101 * diagonal;
        EXPECT_LE(back.high, 1e-5 * diagonal);
    }
    EXPECT_EQ(found, 50);
}

TEST(SurfaceDistance, DegenerateTrianglesAreSegmentsAndPoints) {
    const glm::dvec3 a(0), b(1, 0, 0), p(0.5, 2, 0);
    for (const Triangle& t : {Triangle{a, b, b}, Triangle{a, a, b}, Triangle{a, 0.5 * (a + b), b}})
        EXPECT_EQ(cost::nearest_point(t, p), glm::dvec3(0.5, 0, 0));
    EXPECT_EQ(cost::nearest_point({a, a, a}, p), a);
    const Triangle point{p, p, p};
    const auto d = cost::one_sided_distance({&point, 1}, std::vector<Triangle>{{a, b, b}});
    EXPECT_EQ(d.low, 2);
    EXPECT_EQ(d.high, 2);
    EXPECT_EQ(cost::one_sided_distance({}, {&point, 1}).high, 0);
    EXPECT_EQ(cost::one_sided_distance({&point, 1}, {}).low, INFINITY);
}

// The distance of the middle of a fold to the plane is larger than that of any vertex.
TEST(SurfaceDistance, InsidesCountWhereVerticesAreNear) {
    // From a flat square to two roofs: its middle is half way between them and far below the ridge.
    const std::vector<Triangle> flat = {{glm::dvec3(-1, -1, 0), {1, -1, 0}, {1, 1, 0}},
                                        {glm::dvec3(-1, -1, 0), {1, 1, 0}, {-1, 1, 0}}};
    std::vector<Triangle> roof;
    const glm::dvec3 c[4] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, top(0, 0, 1);
    for (int i = 0; i < 4; ++i) roof.push_back({c[i], c[(i + 1) % 4], top});
    const auto d = cost::one_sided_distance(flat, roof, {.tolerance = 1e-6});
    // From (0, 0, 0) to the plane z = 1 − x: 1/√2.
    EXPECT_NEAR(d.low, std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(d.at.x, 0, 1e-2);
}

// Large triangles in one place: each point is held against nearly all of them.
TEST(SurfaceDistance, EndsAtItsLooksWithBoundsThatHold) {
    std::mt19937_64 random(4);
    const auto place = [&] { return double(random() % 1024) / 1024; };
    std::vector<Triangle> from(150), to(150);
    for (std::vector<Triangle>* soup : {&from, &to})
        for (Triangle& t : *soup)
            for (glm::dvec3& p : t) p = {place(), place(), place()};
    cost::DistanceOptions options;
    options.tolerance = 1e-3;
    const cost::SurfaceDistance whole = cost::one_sided_distance(from, to, options);
    ASSERT_TRUE(whole.complete);
    std::size_t pieces = whole.pieces;
    for (const std::uint64_t looks : {100'000, 10'000, 0}) {
        options.most_looks = looks;
        const cost::SurfaceDistance some = cost::one_sided_distance(from, to, options);
        EXPECT_FALSE(some.complete) << looks;
        EXPECT_LE(some.low, whole.high) << looks;
        EXPECT_GE(some.high, whole.low) << looks;
        EXPECT_LE(some.pieces, pieces) << looks;
        pieces = some.pieces;
    }
}

}  // namespace
