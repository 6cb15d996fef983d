// How far a bilinear map is from flat triangles of some texels: not below the departure of any
// point, by the filter's definition in long double, and not above that of the worst one.
#include "displacement/bilinear_deviation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "displacement/height_field.h"
#include "height_maps.h"

namespace prep {
namespace {

using detail::HeightMap;
using namespace test;

double part(std::mt19937& random) {
    return double(random()) / 4294967296.0;
}

// Through texels inside, points along the edges and some inside.
double sampled(const Image& image, Wrap wrap, const std::array<glm::dvec2, 3>& uv,
               const std::array<double, 3>& values) {
    double most = 0;
    const auto see = [&](double a, double b, double c) {
        const double height =
            by_definition(image, HeightFilter::bilinear, wrap, a * uv[0] + b * uv[1] + c * uv[2]);
        most = std::max(most, std::abs(height - (a * values[0] + b * values[1] + c * values[2])));
    };
    constexpr int along = 500;
    for (int k = 0; k <= along; ++k) {
        const double t = double(k) / along;
        see(1 - t, t, 0);
        see(0, 1 - t, t);
        see(t, 0, 1 - t);
    }
    // Where edges cross lines between texels, or very nearly.
    for (std::size_t k = 0; k < 3; ++k)
        for (glm::length_t axis = 0; axis < 2; ++axis) {
            const double texels = axis == 0 ? image.width : image.height;
            const double from = uv[k][axis] * texels - 0.5;
            const double to = uv[(k + 1) % 3][axis] * texels - 0.5;
            for (double line = std::ceil(std::min(from, to)); line <= std::max(from, to); ++line) {
                if (from == to) break;
                const double t = (line - from) / (to - from);
                std::array<double, 3> w{};
                w[k] = 1 - t;
                w[(k + 1) % 3] = t;
                see(w[0], w[1], w[2]);
            }
        }
    const glm::dvec2 p = uv[1] - uv[0], q = uv[2] - uv[0];
    const double area = p.x * q.y - p.y * q.x;
    const glm::dvec2 low = glm::min(uv[0], glm::min(uv[1], uv[2]));
    const glm::dvec2 high = glm::max(uv[0], glm::max(uv[1], uv[2]));
    const double w = image.width, h = image.height;
    for (double j = std::floor(low.y * h) - 1; area != 0 && j <= high.y * h + 1; ++j)
        for (double i = std::floor(low.x * w) - 1; i <= high.x * w + 1; ++i) {
            const glm::dvec2 d = glm::dvec2((i + 0.5) / w, (j + 0.5) / h) - uv[0];
            const double b = (d.x * q.y - d.y * q.x) / area, c = (p.x * d.y - p.y * d.x) / area;
            if (b >= 0 && c >= 0 && b + c <= 1) see(1 - b - c, b, c);
        }
    return most;
}

TEST(BilinearDeviation, IsThatOfTheWorstPoint) {
    std::mt19937 random(31);
    std::size_t exact = 0;
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
        for (const auto& [width, height] :
             std::initializer_list<std::pair<std::uint32_t, std::uint32_t>>{
                 {64, 64}, {40, 17}, {3, 2}, {1, 1}}) {
            const Image image = random_picture(width, height, width);
            HeightMapOptions options = plain(HeightFilter::bilinear, wrap);
            const auto map = HeightMap::make(image, options);
            ASSERT_TRUE(map);
            for (int k = 0; k < 250; ++k) {
                // From a hundredth of a texel to thirty.
                const double size = std::exp2(part(random) * 11.5 - 6.6);
                const glm::dvec2 texel(1.0 / width, 1.0 / height);
                std::array<glm::dvec2, 3> uv;
                std::array<double, 3> values;
                const glm::dvec2 at(3 * part(random) - 1, 3 * part(random) - 1);
                for (std::size_t c = 0; c < 3; ++c) {
                    uv[c] = at + size * texel * glm::dvec2(part(random), part(random));
                    // Corners on texels and on lines between them.
                    if (k % 5 == 0) uv[c] = (glm::floor(uv[c] / texel) + 0.5) * texel;
                    if (k % 5 == 1) uv[c].x = (std::floor(uv[c].x / texel.x) + 0.5) * texel.x;
                    values[c] = k % 2 == 0 ? map->at(uv[c]).value : part(random);
                }
                if (k % 7 == 3) uv[2] = 0.25 * uv[0] + 0.75 * uv[1];  // of no area
                if (k % 7 == 4) uv[1] = uv[2] = uv[0];
                const detail::Deviation d = map->deviation(uv, values, 0);
                const double found = sampled(image, wrap, uv, values);
                EXPECT_LE(found, d.upper + 1e-15) << width << ' ' << k;
                // Edges are sampled at five hundred points: a parabola's top lies between two.
                EXPECT_LE(d.upper, found * 1.001 + 1e-9) << width << ' ' << k << ' ' << size;
                exact += d.upper <= found * 1.001 + 1e-9;
            }
        }
    EXPECT_EQ(exact, 3000U);
}

// A ridge between two texels' corners: neither a texel nor a crossing is as high as the parabola of
// the edge over it.
TEST(BilinearDeviation, HasTheTopOfAnEdgesParabola) {
    Image image{.width = 4, .height = 4, .channels = 1, .pixels = std::vector<float>(16, 0.0F)};
    image.pixels[1 * 4 + 1] = 1;
    image.pixels[2 * 4 + 2] = 1;
    const auto map = HeightMap::make(image, plain(HeightFilter::bilinear, Wrap::clamp));
    ASSERT_TRUE(map);
    // Across the saddle, from texel (2, 1) to (1, 2), both 0: ½ in the middle.
    const glm::dvec2 a(2.5 / 4, 1.5 / 4), b(1.5 / 4, 2.5 / 4);
    const detail::Deviation d = map->deviation({{a, b, a}}, {{0, 0, 0}}, 0);
    EXPECT_NEAR(d.upper, 0.5, 1e-12);
    EXPECT_GE(d.upper, 0.5);
}

// Large raw heights that the mid-level takes away: interpolation rounds them before that.
TEST(BilinearDeviation, HasAMarginForHeightsThatCancel) {
    std::mt19937 random(8);
    const Image image =
        picture(4, 4, [&](auto, auto) { return 16777000.0 + double(random() % 2); });
    HeightMapOptions options = plain(HeightFilter::bilinear, Wrap::clamp);
    options.midlevel = 16777000.5;
    const auto map = HeightMap::make(image, options);
    ASSERT_TRUE(map);
    using Real = long double;
    for (int k = 0; k < 500; ++k) {
        const double x = 1 + 0.98 * part(random), y = 1 + 0.98 * part(random);
        const glm::dvec2 uv((x + 0.5) / 4, (y + 0.5) / 4);
        const auto texel = [&](std::size_t i, std::size_t j) {
            return Real(image.pixels[4 * j + i]) - Real(options.midlevel);
        };
        // Of the coordinates that the map makes of these.
        const Real fx = Real(uv.x * 4 - 0.5) - 1, fy = Real(uv.y * 4 - 0.5) - 1;
        const Real height = (1 - fy) * ((1 - fx) * texel(1, 1) + fx * texel(2, 1)) +
                            fy * ((1 - fx) * texel(1, 2) + fx * texel(2, 2));
        EXPECT_GE(Real(map->deviation({uv, uv, uv}, {{0, 0, 0}}, 0).upper), std::abs(height)) << k;
    }
}

// All 0 but for one texel, with rows of texels 64 a side.
detail::HeightMapData spike(std::size_t x, std::size_t y) {
    detail::HeightMapData data;
    data.options = plain(HeightFilter::bilinear, Wrap::clamp);
    data.x = {64, Wrap::clamp};
    data.y = {64, Wrap::clamp};
    data.raw.assign(64 * 64, 0.0F);
    data.raw[64 * y + x] = 1;
    data.pyramid = detail::make_height_pyramid(data, 1);
    return data;
}

// The parameter of a line before the end is rounded to 1: the row is met there all the same, and
// searched.
TEST(BilinearDeviation, MeetsRowsThatEndsAreAnUlpBeyond) {
    const detail::HeightMapData data = spike(8, 3);
    for (const double y : {2.9999999999999996, 3.0, 3.0000000000000004}) {
        const std::array<glm::dvec2, 3> at{{{12, 26.436669190780016}, {2.2, y}, {12, 0.7}}};
        for (std::size_t first = 0; first < 3; ++first)
            for (const std::size_t way : {1U, 2U}) {
                std::array<glm::dvec2, 3> uv;
                for (std::size_t k = 0; k < 3; ++k)
                    uv[k] = (at[(first + way * k) % 3] + 0.5) / 64.0;
                const auto found = detail::bilinear_deviation(data, uv, {{0, 0, 0}});
                ASSERT_TRUE(found);
                EXPECT_GE(found->upper, 1.0) << y << ' ' << first << ' ' << way;
            }
    }
}

// Corners some ulps from rows and columns, one texel inside that alone is not 0.
TEST(BilinearDeviation, HoldsForCornersBesideLines) {
    std::mt19937 random(47);
    detail::HeightMapData data = spike(8, 3);
    std::size_t inside = 0;
    const auto beside = [&](int line) {
        double at = (line + 0.5) / 64;
        for (int ulps = int(random() % 7) - 3; ulps != 0; ulps -= ulps > 0 ? 1 : -1)
            at = std::nextafter(at, ulps > 0 ? 2 : -2);
        return at;
    };
    for (int k = 0; k < 60000; ++k) {
        const int line = 16 + int(random() % 32);
        std::array<glm::dvec2, 3> uv;
        for (glm::dvec2& c : uv) c = 0.25 + 0.5 * glm::dvec2(part(random), part(random));
        const std::size_t corner = random() % 3;
        uv[corner].y = beside(line);
        if (k % 2 == 0) uv[corner].x = beside(16 + int(random() % 32));
        if (k % 3 == 0) uv[(corner + 1) % 3].y = beside(line + int(random() % 3) - 1);
        if (k % 5 == 0) uv[(corner + 2) % 3].x = beside(16 + int(random() % 32));
        // Of the texels in that row the one in the middle of the triangle.
        using Real = long double;
        const auto cross = [&](const glm::dvec2& from, const glm::dvec2& to, Real x, Real y) {
            return (Real(to.x) - Real(from.x)) * (y - Real(from.y)) -
                   (Real(to.y) - Real(from.y)) * (x - Real(from.x));
        };
        Real deepest = 0.01L / 64;
        int texel = -1;
        for (int i = 15; i <= 49; ++i) {
            const Real x = (i + 0.5L) / 64, y = (line + 0.5L) / 64;
            const std::array<Real, 3> c{cross(uv[0], uv[1], x, y), cross(uv[1], uv[2], x, y),
                                        cross(uv[2], uv[0], x, y)};
            const Real least = std::min({c[0], c[1], c[2]}), most = std::max({c[0], c[1], c[2]});
            const Real depth = std::max(least, -most);
            if (depth > deepest) deepest = depth, texel = i;
        }
        if (texel < 0) continue;
        ++inside;
        float& height = data.raw[std::size_t(64 * line + texel)];
        data.raw[64 * 3 + 8] = 0;
        height = 1;
        const auto found = detail::bilinear_deviation(data, uv, {{0.25, 0.25, 0.25}});
        height = 0;
        if (!found) continue;  // larger than the walk takes
        ASSERT_GE(found->upper, 0.75) << k;
        ASSERT_LE(found->upper, 0.75 + 1e-9) << k;
    }
    EXPECT_GT(inside, 10000U);
}

TEST(BilinearDeviation, LeavesTheRestToTheSearch) {
    detail::HeightMapData data;
    const auto map = [&](HeightFilter filter) {
        data.options = plain(filter, Wrap::repeat);
        data.x = {64, Wrap::repeat};
        data.y = {64, Wrap::repeat};
        data.raw.assign(64 * 64, 0.5F);
        data.pyramid = detail::make_height_pyramid(data, 1);
    };
    map(HeightFilter::bilinear);
    const std::array<glm::dvec2, 3> small{{{0, 0}, {0.1, 0}, {0, 0.1}}},
        large{{{0, 0}, {0.9, 0}, {0, 0.1}}}, odd{{{0, 0}, {NAN, 0}, {0, 0.1}}};
    EXPECT_TRUE(detail::bilinear_deviation(data, small, {{0, 0, 0}}));
    EXPECT_FALSE(detail::bilinear_deviation(data, large, {{0, 0, 0}}));
    EXPECT_FALSE(detail::bilinear_deviation(data, odd, {{0, 0, 0}}));
    EXPECT_FALSE(
        detail::bilinear_deviation(data, small, {{0, std::numeric_limits<double>::infinity(), 0}}));
    map(HeightFilter::bicubic);
    EXPECT_FALSE(detail::bilinear_deviation(data, small, {{0, 0, 0}}));
}

}  // namespace
}  // namespace prep
