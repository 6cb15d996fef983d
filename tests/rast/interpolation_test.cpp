// Attributes, depth and level of detail at pixels, against the same quantities in long double from
// the snapped corners.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "snapped_triangle.h"

namespace {

using namespace test;
Real ulp(Real scale) {
    const float f = std::abs(float(scale));
    return Real(std::nextafter(f, INFINITY)) - Real(f);
}

// What an error is held against: the largest of the corners' values and of their differences.
Real scale_of(Real v0, Real v1, Real v2) {
    return std::max({std::abs(v0), std::abs(v1), std::abs(v2), std::abs(v1 - v0), std::abs(v2 - v0),
                     std::abs(v2 - v1)});
}

struct Worst {
    Real uv = 0, barycentric = 0, position = 0, color = 0, depth = 0, plain_depth = 0;
    std::size_t pixels = 0, outside_hull = 0, outside_depth = 0;
    void expect_good(const char* name) const {
        std::printf(
            "%s: %zu pixels; worst, in ulp: uv %.2f, colour %.2f, barycentric %.2f, "
            "position %.2f, depth %.2f (%.1e)\n",
            name, pixels, double(uv), double(color), double(barycentric), double(position),
            double(depth), double(plain_depth));
        EXPECT_LT(uv, 3);
        EXPECT_LT(color, 3);
        EXPECT_LT(barycentric, 3);
        EXPECT_LT(position, 3);
        EXPECT_LT(depth, 3);
        EXPECT_EQ(outside_hull, 0u);
        EXPECT_EQ(outside_depth, 0u);
    }
};

struct Case {
    prep::VertexMesh mesh;
    rast::RenderRequest request;
};

rast::Frame draw_case(Case& c) {
    prep::Material material = white();
    material.unlit = true;
    material.double_sided = true;
    c.request.keep_depth = c.request.keep_ids = c.request.keep_uvs = true;
    c.request.keep_barycentrics = c.request.keep_positions = true;
    c.request.threads = 1;
    return test::draw(test::scene_of(c.mesh, material), c.request);
}

void measure(Case& c, Worst& worst) {
    const rast::Frame frame = draw_case(c);
    const rast::RenderRequest& r = c.request;
    const rast::Crop crop = r.crop.value_or(rast::Crop{0, 0, r.width, r.height});
    Corner corner[3];
    for (int k = 0; k < 3; ++k)
        corner[k] = corner_of(*r.view, r.width, r.height, c.mesh.positions[k]);
    for (std::uint32_t j = 0; j < crop.height; ++j)
        for (std::uint32_t i = 0; i < crop.width; ++i) {
            const std::size_t at = std::size_t(j) * crop.width + i;
            if (frame.triangle[at] == prep::no_index) continue;
            const std::int64_t x = centre_from_middle(crop.x + i, r.width);
            const std::int64_t y = centre_from_middle(crop.y + j, r.height);
            const Weights w = weights_of(corner, x, y);
            const auto check = [&](float value, Real v0, Real v1, Real v2, Real& most) {
                const Real expected = w.at[0] * v0 + w.at[1] * v1 + w.at[2] * v2;
                most = std::max(most, std::abs(value - expected) / ulp(scale_of(v0, v1, v2)));
            };
            const auto check_hull = [&](float value, float v0, float v1, float v2) {
                worst.outside_hull +=
                    value < std::min({v0, v1, v2}) || value > std::max({v0, v1, v2});
            };
            const auto& uv = c.mesh.uvs[0];
            const auto& color = c.mesh.colors[0];
            for (int k = 0; k < 2; ++k) {
                check(frame.uv[at][k], uv[0][k], uv[1][k], uv[2][k], worst.uv);
                check_hull(frame.uv[at][k], uv[0][k], uv[1][k], uv[2][k]);
            }
            const auto& p = c.mesh.positions;
            for (int k = 0; k < 3; ++k) {
                check(frame.color[at][k], color[0][k], color[1][k], color[2][k], worst.color);
                check_hull(frame.color[at][k], color[0][k], color[1][k], color[2][k]);
                check(frame.barycentric[at][k], k == 0, k == 1, k == 2, worst.barycentric);
                check_hull(frame.barycentric[at][k], 0, 0, 1);
                // From the eye, which is at the origin.
                check(frame.position[at][k], p[0][k], p[1][k], p[2][k], worst.position);
            }
            Real depth = 0, high = 0, low = 2, dzdx = 0, dzdy = 0, area = 0;
            for (int k = 0; k < 3; ++k) {
                const Corner &f = corner[(k + 1) % 3], &g = corner[(k + 2) % 3];
                depth += w.affine[k] * corner[k].depth;
                high = std::max(high, corner[k].depth);
                low = std::min(low, corner[k].depth);
                dzdx += Real(f.y - g.y) * corner[k].depth;
                dzdy += Real(g.x - f.x) * corner[k].depth;
                area += Real(f.x * g.y - f.y * g.x);
            }
            // The plane stands at a corner; what it adds over the triangle may be large and cancel.
            Real terms = high;
            for (int k = 0; k < 3; ++k)
                terms = std::max(terms, std::abs(dzdx / area * Real(x - corner[k].x)) +
                                            std::abs(dzdy / area * Real(y - corner[k].y)));
            worst.depth = std::max(worst.depth, std::abs(frame.depth[at] - depth) / ulp(terms));
            worst.plain_depth = std::max(worst.plain_depth, std::abs(frame.depth[at] - depth));
            worst.outside_depth += frame.depth[at] < float(low) || frame.depth[at] > float(high);
            ++worst.pixels;
        }
}

template <class Value>
void fill_attributes(prep::VertexMesh& mesh, const Value& value) {
    mesh.uvs = {{}};
    mesh.colors = {{}};
    mesh.indices = {0, 1, 2};
    for (int k = 0; k < 3; ++k) {
        mesh.uvs[0].push_back({value(), value()});
        mesh.colors[0].push_back({value(), value(), value(), 1});
    }
}

TEST(Interpolation, IsWithinThreeUlpsOfLongDouble) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<float> unit(0, 1), either(-1, 1);
    Worst positive, mixed;
    for (int n = 0; n < 1000; ++n) {
        Case c;
        c.request.width = 64 + std::uint32_t(random() % 3);
        c.request.height = 64;
        c.request.view = perspective_view();
        place_corners(c.mesh, *c.request.view, c.request, {0, 0, c.request.width, 64}, random);
        fill_attributes(c.mesh, [&] { return n % 2 ? unit(random) : either(random); });
        measure(c, n % 2 ? positive : mixed);
    }
    positive.expect_good("positive attributes");
    mixed.expect_good("attributes of both signs");
    EXPECT_GT(positive.pixels + mixed.pixels, 400000u);
}

// Pictures of 32,768 pixels a side: their corners are 23,170 pixels from the centre.
TEST(Interpolation, IsAsGoodFarFromTheCentre) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<float> unit(0, 1);
    Worst worst;
    for (int n = 0; n < 600; ++n) {
        Case c;
        c.request.width = c.request.height = rast::max_picture_extent;
        c.request.view = perspective_view();
        // Corners stay within the guard band, where they are snapped.
        constexpr std::uint32_t first = 64, last = rast::max_picture_extent - 128;
        const rast::Crop crop{n % 4 < 2 ? first : last, n % 2 ? first : last, 64, 64};
        c.request.crop = crop;
        place_corners(c.mesh, *c.request.view, c.request, crop, random);
        fill_attributes(c.mesh, [&] { return unit(random); });
        measure(c, worst);
    }
    worst.expect_good("at the corners");
    EXPECT_GT(worst.pixels, 200000u);
}

TEST(Interpolation, OfATriangleMovedByThousandsOfPixelsIsTheSameBits) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    constexpr std::uint32_t extent = 32768;
    std::size_t pixels = 0;
    for (int n = 0; n < 300; ++n) {
        Case c;
        c.request.width = c.request.height = extent;
        rast::View view;  // a unit is a pixel
        view.perspective = false;
        view.half_height = extent / 2;
        view.znear = 0;
        view.zfar = 8;
        c.request.view = view;
        fill_attributes(c.mesh, [&] { return unit(random); });
        // On the grid of 1/256 pixels, which floats hold everywhere.
        std::vector<glm::vec3> corners;
        for (int k = 0; k < 3; ++k)
            corners.push_back(
                {float(random() % 16384) / 256, float(random() % 16384) / 256, -8 * unit(random)});
        const auto frame_at = [&](std::int32_t dx, std::int32_t dy) {
            c.mesh.positions = corners;
            for (glm::vec3& p : c.mesh.positions) p += glm::vec3(float(dx), float(dy), 0);
            c.request.crop = rast::Crop{std::uint32_t(std::int32_t(extent / 2) + dx),
                                        std::uint32_t(std::int32_t(extent / 2) - 64 - dy), 64, 64};
            return draw_case(c);
        };
        const rast::Frame here = frame_at(0, 0);
        for (const glm::ivec2 move : {glm::ivec2(8192, 0), {-8192, 8192}, {16200, -16200}}) {
            const rast::Frame there = frame_at(move.x, move.y);
            ASSERT_EQ(here.triangle, there.triangle) << n;
            ASSERT_EQ(here.depth, there.depth) << n;
            ASSERT_EQ(here.uv, there.uv) << n;
            ASSERT_EQ(here.color, there.color) << n;
            ASSERT_EQ(here.barycentric, there.barycentric) << n;
        }
        for (const std::uint32_t t : here.triangle) pixels += t == 0;
    }
    EXPECT_GT(pixels, 50000u);
}

// Edge functions of triangles that are less than 128 pixels wide and high are taken from slopes of
// 16 bits; those of wider ones in double. Every side of that border, either way round.
TEST(Interpolation, ChangesNotWhereSlopesLeaveSixteenBits) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    Worst worst;
    for (int n = 0; n < 3 * 2 * 2 * 2 * 4; ++n) {
        Case c;
        c.request.width = c.request.height = 192;
        c.request.simd = std::array{prep::SimdLevel::scalar, prep::SimdLevel::sse4,
                                    prep::SimdLevel::avx2, prep::SimdLevel::avx512}[n / 24];
        rast::View view;  // a unit is a pixel
        view.perspective = false;
        view.half_height = 96;
        view.znear = 0;
        view.zfar = 8;
        c.request.view = view;
        const auto place = [&](float from, float to) {
            return from + std::floor(unit(random) * (to - from) * 256) / 256;
        };
        const float extent = 128 + float(n % 3 - 1) / 256;
        glm::vec3 corners[] = {{-70, place(-60, 60), 0},
                               {-70 + extent, place(-60, 60), 0},
                               {place(-60, 50), place(-60, 60), 0}};
        for (glm::vec3& p : corners) {
            if (n / 3 % 2) p.x = -p.x;
            if (n / 6 % 2) p.y = -p.y;
            if (n / 12 % 2) std::swap(p.x, p.y);
            p.z = -8 * unit(random);
            c.mesh.positions.push_back(p);
        }
        fill_attributes(c.mesh, [&] { return unit(random); });
        measure(c, worst);
    }
    worst.expect_good("128 pixels");
    EXPECT_GT(worst.pixels, 100000u);
}

// Where corners share a value, rounding must not pass it.
TEST(Interpolation, StaysInTheHullOfTheCorners) {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<float> unit(-1, 1);
    std::size_t constant = 0, outside = 0, pixels = 0;
    float worst = 0;
    for (int n = 0; n < 1000; ++n) {
        Case c;
        c.request.width = c.request.height = 64;
        c.request.view = perspective_view();
        if (n % 2 == 0) {
            place_corners(c.mesh, *c.request.view, c.request, {0, 0, 64, 64}, random);
        } else {  // edges through pixel centres: a weight is exactly zero
            c.request.view = test::flat_view(32);
            for (int k = 0; k < 3; ++k)
                c.mesh.positions.push_back(
                    {float(random() % 64) - 31.5f, float(random() % 64) - 31.5f, -unit(random)});
        }
        fill_attributes(c.mesh, [&] { return unit(random); });
        auto& uv = c.mesh.uvs[0];
        auto& color = c.mesh.colors[0];
        uv[1].x = uv[0].x;
        uv[2].y = uv[1].y;
        color[2].r = color[0].r;
        color[1].b = color[2].b = color[0].b;
        const rast::Frame frame = draw_case(c);
        for (std::size_t i = 0; i < frame.triangle.size(); ++i) {
            if (frame.triangle[i] == prep::no_index) continue;
            const auto check = [&](float value, float v0, float v1, float v2) {
                const float low = std::min({v0, v1, v2}), high = std::max({v0, v1, v2});
                outside += value < low || value > high;
                worst = std::max({worst, (low - value) / (std::abs(low) + 1e-20f),
                                  (value - high) / (std::abs(high) + 1e-20f)});
            };
            for (int k = 0; k < 2; ++k) check(frame.uv[i][k], uv[0][k], uv[1][k], uv[2][k]);
            for (int k = 0; k < 3; ++k)
                check(frame.color[i][k], color[0][k], color[1][k], color[2][k]);
            constant += frame.color[i].b == color[0].b;
            ++pixels;
        }
    }
    std::printf("%zu pixels, %zu values outside, by %.2g\n", pixels, outside, double(worst));
    EXPECT_EQ(outside, 0u);
    EXPECT_EQ(constant, pixels);
    EXPECT_GT(pixels, 300000u);
}

}  // namespace
