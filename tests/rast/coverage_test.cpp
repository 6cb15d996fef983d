// Which samples triangles cover. The oracles are integer arithmetic in 128 bits and rays in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/gtc/quaternion.hpp>

#include "hits.h"
#include "sanitized.h"
#include "shapes.h"
#include "simd_levels.h"

namespace {

using namespace hits;

// ---------------------------------------------------------------------------- single triangles

// In the suite 60,000 triangles, a third of them under sanitizers; MESHPREP_COVERAGE_TRIANGLES asks
// for more.
std::uint64_t triangles_to_try() {
    const char* asked = std::getenv("MESHPREP_COVERAGE_TRIANGLES");
    return asked != nullptr ? std::strtoull(asked, nullptr, 10) : test::sanitized ? 20000 : 60000;
}

TEST(Coverage, EqualsExactIntegersOnRandomTriangles) {
    std::mt19937_64 random(1);
    constexpr std::uint32_t extent = 24;
    constexpr std::int64_t far = 16370 * 256;  // just inside the guard band
    const std::vector<SimdLevel> levels = test::every_level();
    const auto positions = every_sample();
    const std::uint64_t total = triangles_to_try();
    std::uint64_t wrong = 0, covered = 0, on_edge = 0, samples = 0;
    for (std::uint64_t n = 0; n < total; ++n) {
        Point p[3];
        const auto anywhere = [&] {
            return std::int64_t(random() % (2 * std::uint64_t(far))) - far;
        };
        const std::int64_t step = random_step(random);
        const auto in_picture = [&] {
            const std::int64_t x = random_coordinate(random, extent, step);
            return Point{x, random_coordinate(random, extent, step)};
        };
        switch (n % 5) {
            case 0:
                for (Point& q : p) q = in_picture();
                break;
            case 1:  // smaller than a pixel
                p[0] = in_picture();
                for (int i = 1; i < 3; ++i)
                    p[i] = {p[0].x + std::int64_t(random() % 300) - 150,
                            p[0].y + std::int64_t(random() % 300) - 150};
                break;
            case 2: {  // slivers along a line through a point of the picture
                const Point middle = in_picture();
                p[0] = {anywhere() / 2, anywhere() / 2};
                p[1] = {2 * middle.x - p[0].x, 2 * middle.y - p[0].y};
                p[2] = {p[1].x + std::int64_t(random() % 64), p[1].y + std::int64_t(random() % 64)};
                break;
            }
            case 3:  // all over the guard band
                for (Point& q : p) q = {anywhere(), anywhere()};
                break;
            default:  // its corners
                for (Point& q : p)
                    q = {random() % 2 ? far - std::int64_t(random() % 512)
                                      : -far + std::int64_t(random() % 512),
                         random() % 2 ? far - std::int64_t(random() % 512)
                                      : -far + std::int64_t(random() % 512)};
        }
        std::vector<ScreenVertex> vertices;
        for (const Point& q : p) {
            vertices.push_back(vertex_at(q.x, q.y, extent, extent));
            const auto record = rast::detail::record_of(vertices.back());
            ASSERT_EQ(record.x, q.x - std::int64_t(extent) * 128);
            ASSERT_EQ(record.y, q.y - std::int64_t(extent) * 128);
        }
        HitOptions options;
        options.level = levels[(n / 5) % levels.size()];
        options.offset = positions[(n / 20) % positions.size()];
        const Hits hits = count_hits(vertices, {{0, 1, 2}}, extent, extent, options);
        // y runs down: what turns clockwise on the screen has a positive determinant.
        const bool back = orientation(p[0], p[1], p[2]) > 0;
        for (std::uint32_t y = 0; y < extent; ++y)
            for (std::uint32_t x = 0; x < extent; ++x) {
                const Point sample = sample_of(x, y, options.offset);
                const int expected = oracle_covers(p[0], p[1], p[2], sample) ? 1 : 0;
                wrong += hits.at(x, y, back) != expected || hits.at(x, y, !back) != 0;
                covered += expected;
                for (int k = 0; k < 3; ++k) on_edge += on_segment(sample, p[k], p[(k + 1) % 3]);
            }
        samples += extent * extent;
    }
    std::printf("%llu triangles, %llu samples, %llu covered, %llu on an edge, %llu wrong\n",
                static_cast<unsigned long long>(total), static_cast<unsigned long long>(samples),
                static_cast<unsigned long long>(covered), static_cast<unsigned long long>(on_edge),
                static_cast<unsigned long long>(wrong));
    EXPECT_EQ(wrong, 0u);
    // The test has something to test.
    EXPECT_GT(covered, 16 * total);
    EXPECT_GT(on_edge, total / 100);
}

TEST(Coverage, ZeroAreaOnTheGridIsCountedAndDrawsNothing) {
    std::mt19937_64 random(2);
    std::uint64_t degenerate = 0, counted = 0;
    constexpr SimdLevel levels[] = {SimdLevel::scalar, SimdLevel::sse4, SimdLevel::avx2,
                                    SimdLevel::avx512};  // the best one below where it is not there
    for (int n = 0; n < 20000; ++n) {
        Point p[3];
        for (Point& q : p) q = {std::int64_t(random() % 12) * 64, std::int64_t(random() % 12) * 64};
        std::vector<ScreenVertex> vertices;
        for (const Point& q : p) vertices.push_back(vertex_at(q.x, q.y, 8, 8));
        HitOptions options;
        options.level = levels[n % 4];
        const Hits hits = count_hits(vertices, {{0, 1, 2}}, 8, 8, options);
        counted += hits.counters.degenerate;
        if (orientation(p[0], p[1], p[2]) != 0) continue;
        ++degenerate;
        ASSERT_EQ(std::count(hits.front.begin(), hits.front.end(), 0), 64);
        ASSERT_EQ(std::count(hits.back.begin(), hits.back.end(), 0), 64);
    }
    EXPECT_EQ(counted, degenerate);
    EXPECT_GT(degenerate, 100u);
}

TEST(Coverage, NonFiniteVerticesAreCountedAndDrawNothing) {
    for (const double bad : {double(NAN), double(INFINITY), -double(INFINITY)})
        for (int component = 0; component < 4; ++component) {
            std::vector<ScreenVertex> vertices;
            for (int i = 0; i < 3; ++i) {
                glm::dvec4 p(i == 1 ? 30 : -10, i == 2 ? 30 : -10, 0.5, 1);
                if (i == 1) p[component] = bad;
                vertices.push_back({p.x, p.y, p.z, p.w});
            }
            const Hits hits = count_hits(vertices, {{0, 1, 2}}, 16, 16);
            EXPECT_EQ(hits.counters.non_finite, 1u);
            EXPECT_EQ(std::count(hits.front.begin(), hits.front.end(), 0), 256);
            EXPECT_EQ(std::count(hits.back.begin(), hits.back.end(), 0), 256);
        }
}

// ---------------------------------------------------------------------------------- closed meshes

struct Eye {
    glm::dmat3 rotation{1.0};
    glm::dvec3 position{0.0};
    rast::View view;
};

Eye random_eye(std::mt19937_64& random, double distance) {
    std::normal_distribution<double> normal;
    const glm::dquat turn =
        glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
    Eye eye;
    eye.rotation = glm::mat3_cast(turn);
    eye.position = glm::transpose(eye.rotation) * glm::dvec3(0, 0, distance);
    eye.view.yfov = 1.0;
    return eye;
}

std::vector<ScreenVertex> seen_from(const Eye& eye, const std::vector<glm::vec3>& positions,
                                    std::uint32_t extent) {
    std::vector<ScreenVertex> out;
    const glm::dmat4 to_clip = rast::projection(eye.view, 1.0);
    for (const glm::vec3& p : positions) {
        const glm::dvec4 clip =
            to_clip * glm::dvec4(eye.rotation * (glm::dvec3(p) - eye.position), 1.0);
        out.push_back({clip.x * 0.5 * extent, clip.y * -0.5 * extent, clip.z, clip.w});
    }
    return out;
}

std::vector<Triangle> triangles_of(const prep::Mesh& mesh) {
    const prep::Mesh fans = shapes::fan_triangulated(mesh);
    std::vector<Triangle> out;
    for (std::size_t i = 0; i + 2 < fans.corner_vertices.size(); i += 3)
        out.push_back(
            {fans.corner_vertices[i], fans.corner_vertices[i + 1], fans.corner_vertices[i + 2]});
    return out;
}

prep::Mesh random_closed_mesh(std::mt19937_64& random, int kind) {
    switch (kind % 4) {
        case 0: {
            prep::Mesh mesh = shapes::icosphere(3);
            shapes::jitter(mesh, 0.05f, random);
            return mesh;
        }
        case 1: {  // spikes that fold over each other
            prep::Mesh mesh = shapes::icosphere(2);
            shapes::jitter(mesh, 0.9f, random);
            return mesh;
        }
        case 2: {
            prep::Mesh mesh = shapes::torus(24, 12);
            shapes::jitter(mesh, 0.1f, random);
            return mesh;
        }
        default: {  // dense: most triangles fall between samples
            prep::Mesh mesh = shapes::uv_sphere(96, 64);
            shapes::jitter(mesh, 0.01f, random);
            return mesh;
        }
    }
}

TEST(Coverage, ClosedMeshesHaveAsManyFrontHitsAsBackHits) {
    std::mt19937_64 random(5);
    constexpr std::uint32_t extent = 96;
    std::uint64_t hit = 0;
    const auto positions = every_sample();
    for (int n = 0; n < 62; ++n) {  // every position twice
        const prep::Mesh mesh = random_closed_mesh(random, n);
        Eye eye = random_eye(random, 4.5);
        eye.view.znear = 0.1;
        const std::vector<ScreenVertex> vertices = seen_from(eye, mesh.positions, extent);
        for (const bool turned : {false, true}) {
            std::vector<Triangle> triangles = triangles_of(mesh);
            if (turned)
                for (Triangle& t : triangles) std::swap(t[1], t[2]);
            HitOptions options;
            options.offset = positions[std::size_t(n) % positions.size()];
            const Hits hits = count_hits(vertices, triangles, extent, extent, options);
            ASSERT_EQ(hits.counters.crossing, 0u);
            for (std::size_t i = 0; i < hits.front.size(); ++i) {
                ASSERT_EQ(hits.front[i], hits.back[i]) << n << ": " << i;
                hit += hits.front[i] > 0;
            }
        }
    }
    EXPECT_GT(hit, 50000u);
}

// ------------------------------------------------------------------------------------- near plane

// What a ray meets beyond the near plane, in double.
struct RayHits {
    int front = 0, back = 0;
    double nearest = -1;     // reversed depth
    double clearance = 1e9;  // pixels to the closest triangle edge, or depth's to the near plane
};

RayHits ray_hits(const Eye& eye, const std::vector<glm::vec3>& positions,
                 const std::vector<Triangle>& triangles, std::uint32_t extent, std::uint32_t x,
                 std::uint32_t y) {
    // In view space, through the pixel's centre, scaled so that t = 1 is at distance 1 along −z.
    const double tangent = std::tan(eye.view.yfov / 2);
    const glm::dvec3 direction(((x + 0.5) / extent * 2 - 1) * tangent,
                               (1 - (y + 0.5) / extent * 2) * tangent, -1);
    const double pixel = 2 * tangent / extent;  // at distance 1
    RayHits hits;
    for (const Triangle& t : triangles) {
        glm::dvec3 p[3];
        for (int i = 0; i < 3; ++i)
            p[i] = eye.rotation * (glm::dvec3(positions[t[i]]) - eye.position);
        // Volumes of the ray with the three edges: their signs say on which side it passes.
        double volume[3], distance = 1e9;
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 plane = glm::cross(p[(i + 1) % 3], p[(i + 2) % 3]);
            volume[i] = glm::dot(direction, plane);
            const double slope = std::hypot(plane.x, plane.y);
            if (slope > 0) distance = std::min(distance, std::abs(volume[i]) / slope / pixel);
        }
        const bool all_in = (volume[0] > 0 && volume[1] > 0 && volume[2] > 0) ||
                            (volume[0] < 0 && volume[1] < 0 && volume[2] < 0);
        // Close to an edge's line matters only where the edge itself is close; being cautious
        // everywhere costs samples, not correctness.
        hits.clearance = std::min(hits.clearance, distance);
        if (!all_in) continue;
        const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
        const double along = glm::dot(direction, normal);
        const double at = glm::dot(p[0], normal) / along;  // distance along −z
        // Grazing planes: a vertex moved by half of 1/256 pixel moves the hit far.
        const double tilt = std::hypot(normal.x, normal.y) * pixel / std::abs(along);
        hits.clearance = std::min(
            hits.clearance, std::abs(at - eye.view.znear) / eye.view.znear / std::max(tilt, 1e-9));
        if (at <= eye.view.znear) continue;
        ++(along < 0 ? hits.front : hits.back);
        hits.nearest = std::max(hits.nearest, eye.view.znear / at);
    }
    return hits;
}

TEST(Coverage, NearPlaneThroughClosedMeshesEqualsRays) {
    std::mt19937_64 random(6);
    constexpr std::uint32_t extent = 40;
    std::uint64_t compared = 0, inside = 0, crossing = 0;
    for (int n = 0; n < 64; ++n) {
        prep::Mesh mesh = n % 2 ? shapes::icosphere(1) : shapes::cube();
        shapes::jitter(mesh, 0.3f, random);
        // From outside, through the surface, to the middle: the plane sweeps through the mesh and
        // through the eye.
        Eye eye = random_eye(random, 2.2 * double(n) / 64);
        eye.view.znear = n % 4 == 0 ? 1e-3 : 0.4;
        const std::vector<ScreenVertex> vertices = seen_from(eye, mesh.positions, extent);
        for (const bool turned : {false, true}) {
            std::vector<Triangle> triangles = triangles_of(mesh);
            if (turned)
                for (Triangle& t : triangles) std::swap(t[1], t[2]);
            const Hits hits = count_hits(vertices, triangles, extent, extent);
            crossing += hits.counters.crossing;
            for (std::uint32_t y = 0; y < extent; ++y)
                for (std::uint32_t x = 0; x < extent; ++x) {
                    const RayHits rays = ray_hits(eye, mesh.positions, triangles, extent, x, y);
                    // Snapping moves edges by up to 1/256 of a pixel's diagonal half.
                    if (rays.clearance < 0.02) continue;
                    ++compared;
                    const std::size_t i = std::size_t(y) * extent + x;
                    ASSERT_EQ(hits.front[i], rays.front) << n << ": " << x << " " << y;
                    ASSERT_EQ(hits.back[i], rays.back) << n << ": " << x << " " << y;
                    inside += hits.front[i] != hits.back[i];
                }
        }
    }
    EXPECT_GT(compared, 100000u);
    EXPECT_GT(inside, 20000u);  // the plane did cut
    EXPECT_GT(crossing, 250u);
}

// At every sample, near edges too: what is cut open shows exactly one back face more than front
// faces, or none. Two triangles of one edge must never both win or both lose it.
TEST(Coverage, NearPlaneSweepLeavesNoCracks) {
    std::mt19937_64 random(7);
    constexpr std::uint32_t extent = 64;
    std::uint64_t open = 0;
    for (int n = 0; n < 120; ++n) {
        prep::Mesh mesh = n % 2 ? shapes::icosphere(3) : shapes::uv_sphere(32, 16);
        Eye eye = random_eye(random, 1.6 * double(n) / 120);
        eye.view.znear = n % 3 == 0 ? 1e-6 : 0.2;
        const Hits hits =
            count_hits(seen_from(eye, mesh.positions, extent), triangles_of(mesh), extent, extent);
        for (std::size_t i = 0; i < hits.front.size(); ++i) {
            const int more = hits.back[i] - hits.front[i];
            ASSERT_TRUE(more == 0 || more == 1) << n << ": " << i << " " << more;
            // A convex body: at most one of each.
            ASSERT_LE(hits.front[i], 1);
            ASSERT_LE(hits.back[i], 1);
            open += more == 1;
        }
    }
    EXPECT_GT(open, 100000u);
}

TEST(Coverage, VisibleDepthEqualsRays) {
    std::mt19937_64 random(8);
    constexpr std::uint32_t extent = 40;
    std::uint64_t compared = 0;
    double worst = 0;
    for (int n = 0; n < 24; ++n) {
        prep::Mesh mesh = shapes::icosphere(1);
        shapes::jitter(mesh, 0.4f, random);
        Eye eye = random_eye(random, 2.5 * double(n) / 24);
        eye.view.znear = 0.3;
        const std::vector<Triangle> triangles = triangles_of(mesh);
        const Hits hits =
            count_hits(seen_from(eye, mesh.positions, extent), triangles, extent, extent);
        for (std::uint32_t y = 0; y < extent; ++y)
            for (std::uint32_t x = 0; x < extent; ++x) {
                const RayHits rays = ray_hits(eye, mesh.positions, triangles, extent, x, y);
                if (rays.clearance < 0.1) continue;
                const float depth = hits.nearest[std::size_t(y) * extent + x];
                if (rays.nearest < 0) {
                    ASSERT_EQ(depth, -1.0f);
                    continue;
                }
                worst = std::max(worst, std::abs(depth - rays.nearest) / rays.nearest);
                ++compared;
            }
    }
    EXPECT_GT(compared, 5000u);
    // Corners move by up to 1/512 pixel in x and y; on triangles about 10 pixels wide whose depth
    // changes by its own size that is about 4e-4, more on steep ones.
    EXPECT_LT(worst, 0.02);
}

TEST(Coverage, WindingDecidesTheSideAndCulling) {
    const std::vector<ScreenVertex> vertices{vertex_at(0, 0, 16, 16), vertex_at(0, 4096, 16, 16),
                                             vertex_at(4096, 0, 16, 16)};
    // Down, then right: counter-clockwise to the eye.
    HitOptions drop_back, drop_front;
    drop_back.cull = CullSide::back;
    drop_front.cull = CullSide::front;
    const Hits front = count_hits(vertices, {{0, 1, 2}}, 16, 16, drop_back);
    EXPECT_EQ(front.counters.facing_away, 0u);
    EXPECT_EQ(front.at(2, 2, false), 1);
    EXPECT_EQ(count_hits(vertices, {{0, 1, 2}}, 16, 16, drop_front).counters.facing_away, 1u);
    EXPECT_EQ(count_hits(vertices, {{0, 2, 1}}, 16, 16, drop_back).counters.facing_away, 1u);
}

// The records that the kernels make are those of the doubles behind them, on every level.
TEST(Coverage, TransformedVerticesAreTheirDoublesRounded) {
    std::mt19937_64 random(9);
    std::normal_distribution<float> normal;
    prep::VertexMesh mesh;
    for (int i = 0; i < 1003; ++i)
        mesh.positions.push_back({3 * normal(random), 3 * normal(random), 3 * normal(random)});
    mesh.positions[17].y = NAN;
    mesh.positions[500].z = INFINITY;
    rast::View view;
    view.znear = 0.1;
    view.world_to_view[3] = glm::dvec4(0, 0, -2, 1);
    rast::detail::RenderInstance instance(mesh, 0, glm::dmat4(1.0), view, 640, 480);
    std::size_t unsnapped = 0;
    for (const prep::SimdLevel level : test::every_level()) {
        instance.records.assign(mesh.vertex_count(), {});
        instance.transform(rast::detail::kernels_for(level), 0, mesh.vertex_count());
        for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
            const auto expected = rast::detail::record_of(instance.homogeneous(v));
            ASSERT_EQ(instance.records[v].x, expected.x) << v;
            ASSERT_EQ(instance.records[v].y, expected.y) << v;
            if (expected.x == rast::detail::mark_non_finite) continue;
            ASSERT_EQ(instance.records[v].w, expected.w) << v;
            ASSERT_EQ(instance.records[v].depth, expected.depth) << v;
            unsnapped += expected.x == rast::detail::mark_unsnapped;
        }
        EXPECT_EQ(instance.records[17].x, rast::detail::mark_non_finite);
        EXPECT_EQ(instance.records[500].x, rast::detail::mark_non_finite);
    }
    EXPECT_GT(unsnapped, 100u);
}

}  // namespace
