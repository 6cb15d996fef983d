// Which charts of a map a band limit takes for one, and what lies between and beyond them.

#include "displacement/map_charts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <random>

#include "base/step_count.h"
#include "displacement/chart_gutters.h"
#include "displacement/height_field.h"
#include "height_maps.h"
#include "pipeline/displacement_maps.h"

namespace prep {
namespace {

using detail::HeightMap;
using namespace test;

constexpr double pi = std::numbers::pi;

// Two squares that touch in the map and nowhere on the surface: neither reads the other.
TEST(MapCharts, NeighboursInTheMapAloneAreNotAveraged) {
    Mesh mesh;
    mesh.uvs.resize(1);
    mesh.face_offsets = {0};
    for (int q = 0; q < 2; ++q) {
        for (const glm::ivec2& c :
             {glm::ivec2(0, 0), glm::ivec2(1, 0), glm::ivec2(1, 1), glm::ivec2(0, 1)}) {
            const auto corner = std::uint32_t(mesh.positions.size());
            mesh.positions.emplace_back(float(c.x), float(c.y), float(q));
            mesh.corner_vertices.push_back(corner);
            mesh.uvs[0].indices.push_back(corner);
            mesh.uvs[0].values.emplace_back(0.25f + 0.25f * float(q + c.x),
                                            0.25f + 0.5f * float(c.y));
        }
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    constexpr std::uint32_t size = 128;
    const Image image = picture(size, size, [](auto x, auto) { return x < 64 ? 0.0 : 1.0; });
    for (const double spacing : {0.1, 0.4}) {
        HeightMapOptions options = plain();
        options.sample_spacing = spacing;
        const auto map = *height_function(image, options, &mesh);
        for (double u = 0.26; u < 0.74; u += 0.01)
            if (std::abs(u - 0.5) > 1.0 / size) {
                EXPECT_NEAR(map->value({u, 0.5}), u < 0.5 ? 0 : 1, 1e-6) << u << ", " << spacing;
            }
    }
}

// A strip of three tiles beside a small chart, and triangles with odd UVs: the chart is filtered by
// its own scale, and what lies around it is not read.
TEST(MapCharts, TilesLeaveOtherChartsAlone) {
    constexpr std::uint32_t size = 256;
    Charts chart;
    add_quad(chart, {{{0.1, 0.6}, {0.4, 0.6}, {0.4, 0.9}, {0.1, 0.9}}});
    Charts beside = chart;  // a triangle that spans the map often is not among them: it covers all
    add_quad(beside, {{{0, 0.1}, {3, 0.1}, {3, 0.4}, {0, 0.4}}});
    beside.push_back({{{0, 0.5}, {3, 0.5}, {0, 0.5}}});
    const auto wave = [](double cycles) {
        return [=](const glm::dvec2& p) { return std::sin(2 * pi * cycles * (p.x - 0.1) / 0.3); };
    };
    for (const auto& [cycles, passes] : {std::pair(2.0, true), std::pair(7.0, false)}) {
        const auto inside = wave(cycles);
        const Image image = picture(size, size, [&](auto x, auto y) {
            const glm::dvec2 p((x + 0.5) / size, (y + 0.5) / size);
            if (is_inside(chart, p)) return inside(p);
            return p.y < 0.45 && p.y > 0.05 ? std::sin(2 * pi * 4 * p.x + 1) : 1e6;
        });
        const auto map = HeightMap::make(image, plain());
        ASSERT_TRUE(map);
        constexpr double spacing = 0.03;
        const auto alone = map->limited({.triangles = chart}, spacing);
        const auto made = map->limited({.triangles = beside}, spacing);
        ASSERT_TRUE(alone && made);
        const HeightMap one = alone->map.confined(chart), other = made->map.confined(beside);
        double most = 0;
        for (int j = 0; j <= 50; ++j)
            for (int i = 0; i <= 50; ++i) {
                const glm::dvec2 p = 0.1 + 0.3 * glm::dvec2(i, j) / 50.0 + glm::dvec2(0, 0.5);
                EXPECT_NEAR(one.value(p), other.value(p), 1e-6) << i << ", " << j;
                if (i > 18 && i < 32) most = std::max(most, std::abs(other.value(p)));
            }
        if (passes)
            EXPECT_GE(most, 0.95);
        else
            EXPECT_LE(most, 0.02);
        // The strip goes on across the map's edges.
        for (double u = 0; u < 1; u += 0.01)
            EXPECT_NEAR(other.value({u, 0.25}), std::sin(2 * pi * 4 * u + 1), 0.06) << u;
    }
}

// Tiles of any number, wherever they lie: their mean is what a limit far above their detail leaves.
TEST(MapCharts, TilesLieAnywhere) {
    constexpr std::uint32_t size = 64;
    const Image image =
        picture(size, size, [](auto x, auto y) { return (x + y) % 2 == 0 ? 0.25 : 0.75; });
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirror}) {
        const auto map = HeightMap::make(image, plain(HeightFilter::bilinear, wrap));
        ASSERT_TRUE(map);
        for (const double tiles : {0.97, 1.03, 2.5, 3.97, 3.99, 4.0, 4.03, 9.0})
            for (const double from : {0.0, 1.0, 10.0, -10.0, -3.4})
                for (const bool along_u : {false, true}) {
                    Charts charts;
                    const auto at = [&](double a, double b) {
                        return along_u ? glm::dvec2(b, a) : glm::dvec2(a, b);
                    };
                    add_quad(charts, {{at(0, from), at(1, from), at(1, from + tiles),
                                       at(0, from + tiles)}});
                    const auto limited = map->limited({.triangles = charts}, 0.1);
                    ASSERT_TRUE(limited);
                    double most = 0;
                    for (int k = 1; k < 40; ++k)
                        for (const double a : {0.3, 0.5, 0.62})
                            most = std::max(
                                most,
                                std::abs(limited->map.value(at(a, from + tiles * k / 40)) - 0.5));
                    EXPECT_LE(most, 0.02) << tiles << " from " << from << (along_u ? ", u" : ", v");
                }
    }
}

// A floor of many tiles, each larger than the map, takes the time of the map, not of the tiles.
TEST(MapCharts, ManyTilesAreOneChart) {
    constexpr std::uint32_t size = 1024;
    Charts charts;
    for (int j = 0; j < 100; ++j)
        for (int i = 0; i < 100; ++i) {
            const glm::dvec2 low = glm::dvec2(i, j) * (i % 2 == 0 ? 10.0 : 2.0);
            const glm::dvec2 high = low + (i % 2 == 0 ? 10.0 : 2.0);
            add_quad(charts, {{low, {high.x, low.y}, high, {low.x, high.y}}});
        }
    const auto map = HeightMap::make(random_picture(size, size, 2), plain());
    ASSERT_TRUE(map);
    const auto limited = map->limited({.triangles = charts}, 0.2);  // texel by texel: 10¹¹ steps
    ASSERT_TRUE(limited);
    EXPECT_NEAR(limited->map.value({5.3, 7.7}), 0.5, 0.05);
}

detail::HeightMapData texels_of(int size, Wrap wrap) {
    detail::HeightMapData map;
    map.x = map.y = {size, wrap};
    map.raw.assign(std::size_t(size) * std::size_t(size), 0.0f);
    return map;
}

// Nor do tiles that none covers many times: where one chart has all of the map, a tile is looked at
// until it has a texel.
TEST(MapCharts, TilesOfAFewMapsAreOneChart) {
    constexpr int size = 128, tiles = 400;
    Charts charts;
    for (int k = 0; k < tiles; ++k) {
        const glm::dvec2 low(3.0 * (k % 20), 3.0 * (k / 20));
        add_quad(charts, {{low, {low.x + 3, low.y}, low + 3.0, {low.x, low.y + 3}}});
    }
    const std::uint64_t before = detail::steps_taken;
    const auto made = detail::map_charts(texels_of(size, Wrap::repeat), {.triangles = charts});
    EXPECT_EQ(made.size(), 1u);
    // Each of them alone is 9 maps.
    EXPECT_LT(detail::steps_taken - before, std::uint64_t(4 * 9 * size * size + 2 * tiles));
}

// What has no texel has no part in the spacing of a chart that has them all.
TEST(MapCharts, WhatHasNoTexelIsOfNoOtherChart) {
    const auto square = [](double low, double high) {
        return std::array<glm::dvec2, 4>{{{low, low}, {high, low}, {high, high}, {low, high}}};
    };
    struct Case {
        Wrap wrap;
        double tile;
        std::array<glm::dvec2, 4> stray;
    };
    for (const Case& c :
         {Case{Wrap::repeat, 1, square(0.3, 0.30001)}, Case{Wrap::repeat, 5, square(0.3, 0.30001)},
          Case{Wrap::clamp, 1, square(0.3, 0.30001)}, Case{Wrap::clamp, 1, square(3, 13)}}) {
        Charts charts;
        for (int k = 0; k < 2; ++k) add_quad(charts, square(-0.1, c.tile + 0.1));
        add_quad(charts, c.stray);
        const auto made = detail::map_charts(texels_of(64, c.wrap), {.triangles = charts});
        ASSERT_EQ(made.size(), 2u) << c.tile;
        EXPECT_EQ(made[0].triangles.size(), 4u);
        EXPECT_EQ(made[1].triangles.size(), 2u);
    }
}

// Beyond its edge a clamped map is level, and so is what a chart reads there across a seam.
TEST(MapCharts, SeamsBeyondAClampedMapAreLevel) {
    constexpr std::uint32_t size = 256;
    // Two squares side by side: UVs end at 3 on one side of their edge and begin at 0 on the other.
    Mesh mesh;
    mesh.uvs.resize(1);
    mesh.face_offsets = {0, 4, 8};
    mesh.positions = {{0, 0, 0}, {3, 0, 0}, {3, 0.3, 0}, {0, 0.3, 0}, {4, 0, 0}, {4, 0.3, 0}};
    mesh.corner_vertices = {0, 1, 2, 3, 1, 4, 5, 2};
    for (const glm::vec2& uv : {glm::vec2(0, 0.1f),
                                {3, 0.1f},
                                {3, 0.4f},
                                {0, 0.4f},
                                {0, 0.6f},
                                {1, 0.6f},
                                {1, 0.9f},
                                {0, 0.9f}}) {
        mesh.uvs[0].indices.push_back(std::uint32_t(mesh.uvs[0].values.size()));
        mesh.uvs[0].values.push_back(uv);
    }
    // At the seam 1 on one side, 0 on the other: a step, of which a half is left in its middle.
    const Image image =
        picture(size, size, [](auto x, auto y) { return y < size / 2 ? (x + 0.5) / size : 0.0; });
    HeightMapOptions options = plain(HeightFilter::bilinear, Wrap::clamp);
    options.sample_spacing = 0.2;
    const auto map = *height_function(image, options, &mesh);
    EXPECT_NEAR(map->value({0.002, 0.75}), 0.5, 0.1);  // half a step of the filter is 0.08
    EXPECT_NEAR(map->value({0.9, 0.75}), 0, 0.03);
    EXPECT_NEAR(map->value({0.5, 0.25}), 0.5, 0.03);
}

// A triangle beyond what floats tell apart is of no chart.
TEST(MapCharts, StrayTrianglesFlattenNothing) {
    constexpr std::uint32_t size = 128;
    Charts charts;
    add_quad(charts, {{{0.1, 0.1}, {0.9, 0.1}, {0.9, 0.9}, {0.1, 0.9}}});
    const Image image =
        picture(size, size, [](auto x, auto) { return std::sin(2 * pi * 4 * (x + 0.5) / size); });
    const auto map = HeightMap::make(image, plain());
    const auto alone = map->limited({.triangles = charts}, 0.05);
    charts.push_back({{{1e12, 0.7}, {2e12, 0.7}, {1e12, -3e12}}});
    charts.push_back({{{1e30, 0.7}, {0.5, 0.7}, {0.2, 0.1}}});
    const auto other = map->limited({.triangles = charts}, 0.05);
    ASSERT_TRUE(alone && other);
    for (double u = 0.15; u < 0.85; u += 0.01)
        EXPECT_EQ(alone->map.value({u, 0.5}), other->map.value({u, 0.5})) << u;
}

// Of charts that share texels the spacing is one, whatever their order.
TEST(MapCharts, ChartsThatShareTexelsAreOne) {
    constexpr std::uint32_t size = 256;
    const Image image =
        picture(size, size, [](auto x, auto) { return std::sin(2 * pi * 16 * (x + 0.5) / size); });
    const auto map = HeightMap::make(image, plain());
    ASSERT_TRUE(map);
    for (const double tiles : {0.0, 1.0}) {
        std::vector<HeightMap> made;
        for (const bool turned : {false, true}) {
            Charts charts;
            std::vector<double> areas;
            for (const int k : turned ? std::array{1, 0} : std::array{0, 1}) {
                // The second lies within the first, or within its place a tile further.
                const double low = k == 0 ? 0.1 : 0.2 + tiles, high = k == 0 ? 0.9 : 0.7 + tiles;
                add_quad(charts, {{{low, 0.1}, {high, 0.1}, {high, 0.9}, {low, 0.9}}});
                areas.insert(areas.end(), 2, k == 0 ? 0.32 : 32.0);
            }
            const auto limited = map->limited({.triangles = charts, .areas = areas}, 0.05);
            ASSERT_TRUE(limited);
            made.push_back(limited->map);
        }
        double most = 0;
        for (double u = 0.3; u < 0.6; u += 0.003) {
            EXPECT_EQ(made[0].value({u, 0.5}), made[1].value({u, 0.5})) << u;
            most = std::max(most, std::abs(made[0].value({u, 0.5})));
        }
        // UVs of 1.04 over a surface of 64.64: samples are 0.0063 apart there, which carries it.
        EXPECT_GE(most, 0.95) << tiles;
    }
}

// Beyond the edge of a clamped map lies what its edge has.
TEST(MapCharts, ClampedMapsGoOnLevel) {
    constexpr std::uint32_t size = 256;
    Charts charts;
    add_quad(charts, {{{-1, 0.1}, {2, 0.1}, {2, 0.9}, {-1, 0.9}}});
    const Image image = picture(size, size, [](auto x, auto) {
        return x < 2 ? 1.0 : std::sin(2 * pi * 32 * (x + 0.5) / size);
    });
    HeightMapOptions options = plain(HeightFilter::bilinear, Wrap::clamp);
    const auto map = HeightMap::make(image, options);
    ASSERT_TRUE(map);
    const auto limited = map->limited({.triangles = charts}, 0.05);
    ASSERT_TRUE(limited);
    // 2 texels and all beyond are 1, which is half of what the kernel reads there and more.
    EXPECT_GE(limited->map.value({-0.5, 0.5}), 0.5);
    EXPECT_LE(limited->map.value({-0.5, 0.5}), 1.0);
    EXPECT_NEAR(limited->map.value({0.5, 0.5}), 0, 0.02);
    // However far: borders are walked within the map alone.
    Mesh mesh;
    for (const float x : {-1.0f, 1.0f})
        for (const float y : {-1.0f, 1.0f}) mesh.positions.emplace_back(x, y, 0);
    mesh.corner_vertices = {0, 2, 3, 1};
    mesh.face_offsets = {0, 4};
    mesh.uvs.resize(1);
    for (const glm::vec3& p : mesh.positions) mesh.uvs[0].values.emplace_back(1e9f * p.x, p.y);
    mesh.uvs[0].indices = mesh.corner_vertices;
    options.sample_spacing = 1e-6;
    EXPECT_TRUE(height_function(image, options, &mesh));
}

// A chart whose limit is below a texel stays as it is, also where another needs finer texels.
TEST(MapCharts, FinerTexelsKeepWhatIsThere) {
    constexpr std::uint32_t size = 64;
    Charts charts;
    add_quad(charts, {{{0.05, 0.1}, {0.45, 0.1}, {0.45, 0.9}, {0.05, 0.9}}});
    add_quad(charts, {{{0.55, 0.1}, {0.95, 0.1}, {0.95, 0.9}, {0.55, 0.9}}});
    const std::vector<double> areas{0.16, 0.16, 4, 4};  // lengths of the second: 5 times
    for (const double texels : {1.2, 1.6, 2.5, 3.5}) {
        const Image image =
            picture(size, size, [](auto x, auto y) { return x == 48 && y == 32 ? 1.0 : 0.0; });
        const auto map = HeightMap::make(image, plain());
        const auto limited = map->limited({.triangles = charts, .areas = areas}, texels / size);
        ASSERT_TRUE(limited);
        EXPECT_GT(limited->map.width(), size);
        for (double x = 46; x <= 50; x += 0.25) {
            const glm::dvec2 p((x + 0.5) / size, 32.5 / size);
            EXPECT_NEAR(limited->map.value(p), map->value(p), 1e-6) << x << ", " << texels;
        }
        EXPECT_EQ(limited->change, 0);
    }
}

// The part of a triangle within a box.
std::vector<glm::dvec2> clipped(const std::array<glm::dvec2, 3>& triangle, const glm::dvec2& low,
                                const glm::dvec2& high) {
    std::vector<glm::dvec2> polygon(triangle.begin(), triangle.end());
    for (glm::length_t k = 0; k < 2; ++k)
        for (const double side : {-1.0, 1.0}) {
            const auto beyond = [&](const glm::dvec2& p) {
                return side < 0 ? low[k] - p[k] : p[k] - high[k];
            };
            std::vector<glm::dvec2> kept;
            for (std::size_t c = 0; c < polygon.size(); ++c) {
                const glm::dvec2 a = polygon[c], b = polygon[(c + 1) % polygon.size()];
                const double from = beyond(a), to = beyond(b);
                if (from <= 0) kept.push_back(a);
                if ((from < 0 && to > 0) || (from > 0 && to < 0))
                    kept.push_back(glm::mix(a, b, from / (from - to)));
            }
            polygon = std::move(kept);
        }
    return polygon;
}

// A clamped map's last texels are read by all that lies beyond them, of triangles that reach into
// the map as well.
TEST(MapCharts, TexelsReadFromBeyondAClampedMapAreCovered) {
    constexpr double none = 1e9, roundings = 1e-6;
    std::mt19937 random(23);
    std::uniform_real_distribution<double> at(-0.6, 1.6);
    int from_beyond = 0;
    for (int trial = 0; trial < 600; ++trial) {
        detail::HeightMapData map;
        map.x = {trial % 5 == 0 ? 1 : 13, Wrap::clamp};
        map.y = {trial % 7 == 0 ? 1 : 9, trial % 3 == 0 ? Wrap::repeat : Wrap::clamp};
        map.raw.assign(std::size_t(map.x.size * map.y.size), 0.0F);
        std::array<glm::dvec2, 3> uv, p;
        for (std::size_t k = 0; k < 3; ++k) {
            uv[k] = {at(random), map.y.wrap == Wrap::clamp ? at(random) : 0.3 + 0.4 * at(random)};
            p[k] = map.map_point(uv[k]);
        }
        const auto reads = [&](std::int64_t i, std::int64_t j, double by) {
            glm::dvec2 low{double(i), double(j)}, high = low;
            if (i == 0) low.x = -none;
            if (i == map.x.size - 1) high.x = none;
            if (map.y.wrap == Wrap::clamp && j == 0) low.y = -none;
            if (map.y.wrap == Wrap::clamp && j == map.y.size - 1) high.y = none;
            return !clipped(p, low - by, high + by).empty();
        };
        bool any = false;
        for (std::int64_t j = 0; j < map.y.size; ++j)
            for (std::int64_t i = 0; i < map.x.size; ++i) any |= reads(i, j, roundings);
        if (!any) continue;
        const auto covered = detail::covered_texels(map, Charts{uv});
        for (std::int64_t j = 0; j < map.y.size; ++j)
            for (std::int64_t i = 0; i < map.x.size; ++i) {
                const bool is = covered[std::size_t(j * map.x.size + i)] != 0;
                EXPECT_LE(reads(i, j, 1e-12), is) << trial << ": " << i << ", " << j;
                EXPECT_LE(is, reads(i, j, roundings)) << trial << ": " << i << ", " << j;
                from_beyond += is && clipped(p, {double(i) - roundings, double(j) - roundings},
                                             {double(i) + roundings, double(j) + roundings})
                                         .empty();
            }
    }
    EXPECT_GT(from_beyond, 1000);
}

// And a band limit changes them: the row that lies beyond is as smooth as the rest.
TEST(MapCharts, BandLimitsReachTexelsReadFromBeyond) {
    constexpr std::uint32_t size = 256;
    const auto waves = [](double t) { return std::sin(2 * pi * 64 * (t + 0.5) / size); };
    const Charts along_u{{{{0, -0.2}, {1, -0.2}, {0.5, 0.9}}}};
    Charts along_v = along_u;
    for (glm::dvec2& uv : along_v[0]) std::swap(uv.x, uv.y);
    for (const bool turned : {false, true}) {
        const Image image =
            picture(size, size, [&](auto x, auto y) { return waves(turned ? y : x); });
        const auto map = HeightMap::make(image, plain(HeightFilter::bilinear, Wrap::clamp));
        ASSERT_TRUE(map);
        const Charts& charts = turned ? along_v : along_u;
        const auto limited = map->limited({.triangles = charts}, 0.05);
        ASSERT_TRUE(limited);
        for (double t = 0.06; t < 0.94; t += 0.5 / size) {
            const glm::dvec2 uv = turned ? glm::dvec2(-0.15, t) : glm::dvec2(t, -0.15);
            EXPECT_NEAR(limited->map.value(uv), 0, 0.1) << t << (turned ? ", v" : ", u");
        }
    }
}

// Charts that lie over each other, equal ones and tiles, take the time of the map and of their
// rows.
TEST(MapCharts, StackedChartsTakeTheTimeOfOne) {
    constexpr int size = 512, stacked = 2000;
    Charts equal, tiles;
    for (int k = 0; k < stacked; ++k) {
        equal.push_back({{{0, 0}, {1, 0}, {0, 1}}});
        const double u = 1.37 * k;
        add_quad(tiles, {{{u, 0.1}, {u + 1, 0.1}, {u + 1, 0.9}, {u, 0.9}}});
    }
    for (const Charts& charts : {equal, tiles}) {
        const detail::HeightMapData map = texels_of(size, Wrap::repeat);
        const std::uint64_t before = detail::steps_taken;
        const auto covered = detail::covered_texels(map, charts);
        const auto made = detail::map_charts(map, {.triangles = charts});
        // Equal ones but once, else a few in each row of each triangle; all texels of each would be
        // a billion.
        const std::uint64_t rows = charts.size() * size, texels = size * size;
        EXPECT_LT(detail::steps_taken - before,
                  2 * (4 * texels + (charts == equal ? 0 : 6 * rows)));
        EXPECT_EQ(made.size(), 1U);
        for (int j = 0; j < size; ++j)
            for (int i = 0; i < size; ++i) {
                const double v = (j + 0.5) / size, u = (i + 0.5) / size;
                const bool is = charts == equal ? u + v <= 1 + 1e-9 : v >= 0.1 && v <= 0.9;
                ASSERT_EQ(covered[std::size_t(j * size + i)] != 0, is) << i << ", " << j;
            }
    }
}

// A corner of a wall, seen from above, that does not lie around the mean of its corners; UVs are
// its places in a square of 5.
constexpr float wall_square = 5;
Mesh wall(std::initializer_list<std::initializer_list<std::uint32_t>> faces) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {1, 1, 0},
                      {1, 4, 0}, {0, 4, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.face_offsets = {0};
    for (const auto& face : faces) {
        mesh.corner_vertices.insert(mesh.corner_vertices.end(), face);
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    mesh.uvs.resize(1);
    for (const glm::vec3& p : mesh.positions)
        mesh.uvs[0].values.emplace_back((glm::vec2(p) + 0.5F) / wall_square);
    mesh.uvs[0].indices = mesh.corner_vertices;
    return mesh;
}
Mesh whole_wall() {
    return wall({{0, 1, 2, 3, 4, 5}});
}
bool is_in_wall(const glm::dvec2& p) {
    return p.x >= 0 && p.y >= 0 && p.x <= 4 && p.y <= 4 && (p.x <= 1 || p.y <= 1);
}
glm::dvec2 wall_uv(double x, double y) {
    return (glm::dvec2(x, y) + 0.5) / double(wall_square);
}

// Of a polygon that is cut, what lies beside it is no more read than of any other; a limit surface
// over it is a fan about the mean, and reads what that reaches over.
TEST(MapCharts, NothingIsReadBesideAConcavePolygon) {
    constexpr std::uint32_t size = 100;
    const Image image = picture(size, size, [](auto x, auto y) {
        const glm::dvec2 p =
            double(wall_square) * glm::dvec2(x + 0.5, y + 0.5) / double(size) - 0.5;
        return is_in_wall(p) ? 0.25 : 1e6;
    });
    const Mesh mesh = whole_wall();
    const auto polygon = *height_function(image, plain(), &mesh);
    for (double t = 0; t <= 3; t += 0.01) {
        EXPECT_NEAR(polygon->value(wall_uv(1 + t, 1)), 0.25, 1e-6) << t;
        EXPECT_NEAR(polygon->value(wall_uv(1, 1 + t)), 0.25, 1e-6) << t;
    }
    const auto cage = *height_function(image, plain(), &mesh, 0, SubdivisionScheme::catmark);
    EXPECT_GT(cage->value(wall_uv(1.3, 1.3)), 1e5);  // of the mean, (5/3, 5/3), and (1, 1)
    EXPECT_NEAR(cage->value(wall_uv(0.5, 0.5)), 0.25, 1e-6);
}

// A band limit's scale is that of the polygon, as of the same polygon in convex pieces.
TEST(MapCharts, ConcavePolygonsHaveOneScale) {
    constexpr std::uint32_t size = 500;
    const Mesh whole = whole_wall(), pieces = wall({{0, 6, 3, 7}, {6, 1, 2, 3}, {7, 3, 4, 5}});
    for (const auto& [cycles, passes] : {std::pair(1.2, true), std::pair(2.6, false)}) {
        const double waves = cycles;
        const Image image = picture(size, size, [&](auto x, auto) {
            return std::sin(2 * pi * waves * double(wall_square) * (x + 0.5) / size);
        });
        HeightMapOptions options = plain();
        options.sample_spacing = 0.2;  // of 2.5 cycles
        const auto made = *height_function(image, options, &whole);
        const auto of_pieces = *height_function(image, options, &pieces);
        double most = 0;
        for (double x = 1.5; x <= 3; x += 0.01)
            for (const double y : {0.3, 0.5, 0.7}) {
                most = std::max(most, std::abs(made->value(wall_uv(x, y))));
                EXPECT_NEAR(made->value(wall_uv(x, y)), of_pieces->value(wall_uv(x, y)), 1e-6);
            }
        if (passes)
            EXPECT_GE(most, 0.95);
        else
            EXPECT_LE(most, 0.02);
    }
}

// A comb of many corners takes its own time, not that of a fan of all corners for each of its
// triangles.
TEST(MapCharts, ManyCornersTakeNoSquareOfThem) {
    constexpr std::uint32_t teeth = 200, size = 512;
    Mesh mesh;
    for (std::uint32_t k = 0; k < teeth; ++k) {
        mesh.positions.emplace_back(float(2 * k), 100, 0);
        mesh.positions.emplace_back(float(2 * k + 1), 1, 0);
    }
    mesh.positions.emplace_back(float(2 * teeth), 100, 0);
    mesh.positions.emplace_back(float(2 * teeth), 0, 0);
    mesh.positions.emplace_back(0, 0, 0);
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
        mesh.corner_vertices.push_back(std::uint32_t(mesh.positions.size()) - 1 - v);
    mesh.face_offsets = {0, std::uint32_t(mesh.corner_vertices.size())};
    mesh.uvs.resize(1);
    for (const glm::vec3& p : mesh.positions)
        mesh.uvs[0].values.emplace_back(0.1F + 0.002F * p.x, 0.1F + 0.008F * p.y);
    mesh.uvs[0].indices = mesh.corner_vertices;
    HeightMapOptions options = plain();
    options.sample_spacing = 2;
    const std::uint64_t before = detail::steps_taken;
    ASSERT_TRUE(height_function(random_picture(size, size, 5), options, &mesh));
    EXPECT_LT(detail::steps_taken - before, std::uint64_t(20 * size * size));
}

}  // namespace
}  // namespace prep
