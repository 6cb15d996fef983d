// Which surfaces each depth format tells apart, against theory.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "builders.h"

namespace {

using rast::DepthFormat;

constexpr double near_plane = 0.1;

// Two squares that fill the picture, at distances `far` and `near`, the far one drawn first: it
// stays wherever both come to one depth. `tilt`: change of distance per unit to the right.
prep::PreparedScene two_squares(double near, double far, double tilt) {
    prep::VertexMesh mesh;
    mesh.positions = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    prep::PreparedScene scene = test::scene_of(mesh);
    scene.scene.nodes.push_back(scene.scene.nodes[0]);
    const double distance[] = {far, near};
    for (std::size_t n = 0; n < 2; ++n) {
        glm::dmat4 m(1.0);
        // Both are the same shape seen from the eye, but for their size.
        m[0] = glm::dvec4(distance[n], 0, -tilt * distance[n], 0);
        m[1][1] = distance[n];
        m[3] = glm::dvec4(0, 0, -distance[n], 1);
        scene.scene.nodes[n].transform = m;
    }
    return scene;
}

// Of the picture's pixels, how many show the nearer square.
double told_apart(double near, double far, double tilt, DepthFormat format) {
    rast::RenderRequest request;
    request.width = request.height = 16;
    request.view = test::look_at({0, 0, 0}, {0, 0, -1}, 0.8, near_plane);
    request.shading = rast::Shading::flat;
    request.keep_ids = true;
    request.depth_format = format;
    const rast::Frame frame = test::draw(two_squares(near, far, tilt), request);
    int seen = 0;
    for (const std::uint32_t instance : frame.instance) {
        EXPECT_NE(instance, prep::no_index);
        seen += instance == 1;
    }
    return seen / 256.0;
}

// The step of a format at depth n / d.
double step_of(DepthFormat format, double distance) {
    if (format == DepthFormat::fixed16) return 0x1p-16;
    if (format == DepthFormat::fixed24) return 0x1p-24;
    return std::ldexp(1.0, std::ilogb(near_plane / distance) - 23);
}

// The distance whose depth is one step (times `steps`) less than that of `near`.
double farther(double near, double steps, DepthFormat format) {
    return near_plane / (near_plane / near - steps * step_of(format, near));
}

TEST(DepthFormats, OneStepTellsFacingSquaresApartHalfOfOneOnlySometimes) {
    std::mt19937_64 random(3);
    for (const DepthFormat format :
         {DepthFormat::float32, DepthFormat::fixed24, DepthFormat::fixed16}) {
        SCOPED_TRACE(int(format));
        // Fixed 16 bits end where a step is the whole depth: n · 2^16 = 6,554 units away.
        const double most = format == DepthFormat::fixed16 ? 500 : 50000;
        int half = 0, tries = 0;
        for (double distance = 0.2; distance < most; distance *= 1.31) {
            const double near = distance * (1 + double(random() % 1000) / 4000);
            // A hundredth more pays for the rounding of the transform in double; with 24 bits,
            // rounding to float before may take a quarter of a step from each of both.
            const double enough = format == DepthFormat::fixed24 ? 1.51 : 1.01;
            EXPECT_EQ(told_apart(near, farther(near, enough, format), 0, format), 1) << near;
            EXPECT_EQ(told_apart(near, near, 0, format), 0);  // equal: the first stays
            half += told_apart(near, farther(near, 0.5, format), 0, format) == 1;
            ++tries;
        }
        // Half a step crosses from one value to the next half of the time.
        EXPECT_GT(half, tries / 5);
        EXPECT_LT(half, tries * 4 / 5);
    }
}

TEST(DepthFormats, TheSmallestGapGrowsAsTheoryHasIt) {
    // In units of distance: d · 2^-23 at most for reversed floats, d² / n · 2^-bits for fixed ones.
    for (const double d : {1.0, 10.0, 100.0, 1000.0}) {
        for (const DepthFormat format :
             {DepthFormat::float32, DepthFormat::fixed24, DepthFormat::fixed16}) {
            const double theory = format == DepthFormat::float32   ? d * 0x1p-23
                                  : format == DepthFormat::fixed24 ? d * d / near_plane * 0x1p-24
                                                                   : d * d / near_plane * 0x1p-16;
            if (theory > d / 4) continue;  // nothing is told apart there
            EXPECT_EQ(told_apart(d, d + 1.6 * theory, 0, format), 1) << d << " " << int(format);
            // A fifth of it crosses from one value to the next once in five.
            int apart = 0;
            for (int k = 0; k < 20; ++k) {
                const double near = d * (1 + 0.01003 * k);
                apart += told_apart(near, near + 0.2 * theory, 0, format) == 1;
            }
            EXPECT_LE(apart, 10) << d << " " << int(format);
        }
    }
}

TEST(DepthFormats, SlantedSquaresNeedLittleMore) {
    // The farthest point in the picture is 1.15 times as far as the middle, where a step tells less
    // apart; and in float a plane's depth is off by a few steps of its largest corner's.
    for (const double distance : {0.3, 2.0, 30.0})
        for (const double tilt : {0.1, 0.3}) {
            EXPECT_EQ(told_apart(distance, farther(distance, 1.25, DepthFormat::fixed16), tilt,
                                 DepthFormat::fixed16),
                      1)
                << distance << " " << tilt;
            EXPECT_EQ(told_apart(distance, distance * (1 + 0x1p-19), tilt, DepthFormat::float32), 1)
                << distance << " " << tilt;
        }
}

TEST(DepthFormats, DepthsLieOnTheirGrid) {
    const prep::PreparedScene scene = test::scene_of(test::sphere(30, 20));
    rast::RenderRequest request;
    request.width = request.height = 64;
    request.view = test::look_at({0, 0.5, 2.2}, {0, 0, 0}, 0.8, 0.7);
    request.keep_depth = true;
    const rast::Frame exact = test::draw(scene, request);
    for (const int bits : {16, 24}) {
        request.depth_format = bits == 16 ? DepthFormat::fixed16 : DepthFormat::fixed24;
        for (const prep::SimdLevel level : {prep::SimdLevel::scalar, prep::SimdLevel::automatic}) {
            request.simd = level;
            const rast::Frame frame = test::draw(scene, request);
            std::size_t covered = 0;
            for (std::size_t i = 0; i < frame.depth.size(); ++i) {
                const double k = std::ldexp(double(frame.depth[i]), bits);
                ASSERT_EQ(k, std::floor(k)) << i;
                ASSERT_LT(k, std::ldexp(1.0, bits));
                EXPECT_NEAR(frame.depth[i], exact.depth[i], std::ldexp(0.5, -bits));
                covered += frame.depth[i] > 0;
            }
            EXPECT_GT(covered, 500u);
        }
    }
}

TEST(DepthFormats, CrossingTrianglesLieOnTheGridToo) {
    prep::VertexMesh mesh;  // a floor through the near plane
    mesh.positions = {{-50, -1, 5}, {50, -1, 5}, {50, -1, -50}, {-50, -1, -50}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    rast::RenderRequest request;
    request.width = request.height = 32;
    request.view = test::look_at({0, 0, 0}, {0, 0, -1}, 0.8, 0.1);
    request.keep_depth = true;
    request.depth_format = DepthFormat::fixed16;
    const rast::Frame frame = test::draw(test::scene_of(mesh), request);
    EXPECT_GT(frame.counters.crossing, 0u);
    std::size_t covered = 0;
    for (const float depth : frame.depth) {
        EXPECT_EQ(std::ldexp(depth, 16), std::floor(std::ldexp(depth, 16)));
        covered += depth > 0;
    }
    EXPECT_GT(covered, 200u);
}

// The nearest of all depths is the grid's highest, one step below 1, however a triangle is drawn.
TEST(DepthFormats, NothingIsNearerThanTheGridsTop) {
    for (const bool crossing : {false, true})
        for (const DepthFormat format : {DepthFormat::fixed16, DepthFormat::fixed24}) {
            prep::VertexMesh mesh;  // on the near plane, or one corner just in front of it
            const float z = -1.00000012f;
            mesh.positions = {{-2, -2, z}, {2, -2, z}, {0, 3, crossing ? -0.9999999f : z}};
            mesh.indices = {0, 1, 2};
            rast::RenderRequest request;
            request.width = request.height = 32;
            request.view = test::look_at({0, 0, 0}, {0, 0, -1}, 0.8, 1);
            request.keep_depth = true;
            request.depth_format = format;
            const rast::Frame frame = test::draw(test::scene_of(mesh), request);
            EXPECT_EQ(frame.counters.crossing, crossing ? 1u : 0u);
            const int bits = format == DepthFormat::fixed16 ? 16 : 24;
            std::size_t covered = 0;
            for (const float depth : frame.depth) {
                if (depth == 0) continue;
                ASSERT_GE(depth, 1 - std::ldexp(2.0, -bits));
                ASSERT_LT(depth, 1);
                covered += 1;
            }
            EXPECT_GT(covered, 200u);
        }
}

}  // namespace
