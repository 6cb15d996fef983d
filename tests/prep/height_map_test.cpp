// Height maps: what they read, the bounds of it, and how far they are from flat triangles. The
// judges are the filters' definitions in long double and dense samples.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <limits>

#include "displacement/band_limit.h"
#include "displacement/height_data.h"
#include "displacement/height_field.h"
#include "displacement/map_regions.h"
#include "height_maps.h"

namespace prep {
namespace {

using detail::Deviation;
using detail::HeightMap;
using namespace test;

constexpr HeightFilter filters[] = {HeightFilter::bilinear, HeightFilter::bicubic};
constexpr Wrap wraps[] = {Wrap::repeat, Wrap::mirror, Wrap::clamp};

double part(std::mt19937& random) {
    return double(random()) / 4294967296.0;
}

TEST(HeightMap, ReadsWhatItsFilterIsDefinedToBe) {
    std::mt19937 random(1);
    for (const auto& [width, height] :
         std::initializer_list<std::pair<std::uint32_t, std::uint32_t>>{
             {7, 5}, {16, 16}, {1, 1}, {1, 9}, {9, 1}, {2, 3}})
        for (const HeightFilter filter : filters)
            for (const Wrap wrap : wraps) {
                const Image image = random_picture(width, height, width * 31 + height);
                const auto map = HeightMap::make(image, plain(filter, wrap));
                ASSERT_TRUE(map);
                for (int k = 0; k < 400; ++k) {
                    const glm::dvec2 uv(6 * part(random) - 3, 6 * part(random) - 3);
                    EXPECT_NEAR(map->at(uv).value, by_definition(image, filter, wrap, uv), 1e-13)
                        << width << "x" << height << " at " << uv.x << ", " << uv.y;
                }
            }
}

TEST(HeightMap, TexelsAreReadAtTheirCentresToTheBit) {
    for (const HeightFilter filter : filters) {
        const Image image = random_picture(8, 4, 3);
        const auto map = HeightMap::make(image, plain(filter));
        ASSERT_TRUE(map);
        for (std::uint32_t y = 0; y < 4; ++y)
            for (std::uint32_t x = 0; x < 8; ++x)
                EXPECT_EQ(map->at({(x + 0.5) / 8, (y + 0.5) / 4}).value, double(*image.at(x, y)));
    }
}

TEST(HeightMap, GradientsAreThoseOfItsValues) {
    std::mt19937 random(2);
    for (const HeightFilter filter : filters)
        for (const Wrap wrap : wraps) {
            HeightMapOptions options = plain(filter, wrap);
            options.placement.scale = {2, -0.5f};
            options.placement.rotation = 0.3f;
            options.scale = -3;
            const auto map = HeightMap::make(random_picture(12, 9, 4), options);
            ASSERT_TRUE(map);
            for (int k = 0; k < 300; ++k) {
                const glm::dvec2 uv(4 * part(random) - 2, 4 * part(random) - 2);
                constexpr double h = 1e-6;
                for (int axis = 0; axis < 2; ++axis) {
                    glm::dvec2 before = uv, after = uv;
                    before[axis] -= h;
                    after[axis] += h;
                    const double slope = (map->at(after).value - map->at(before).value) / (2 * h);
                    const double curve = std::abs(map->at(after).value + map->at(before).value -
                                                  2 * map->at(uv).value) /
                                         h;
                    // A kink between both says nothing.
                    if (curve > 1e-2) continue;
                    EXPECT_NEAR(map->at(uv).gradient[axis], slope, 2e-2);
                }
            }
        }
}

TEST(HeightMap, PlacementIsThatOfTextureTransforms) {
    const Image image = random_picture(16, 16, 5);
    HeightMapOptions options = plain();
    options.placement.offset = {0.25f, -0.125f};
    options.placement.scale = {2, 3};
    options.placement.rotation = 0.5f;
    const auto map = HeightMap::make(image, options), bare = HeightMap::make(image, plain());
    ASSERT_TRUE(map && bare);
    std::mt19937 random(6);
    for (int k = 0; k < 100; ++k) {
        const glm::dvec2 uv(part(random), part(random));
        // KHR_texture_transform: offset · rotation · scale.
        const double c = std::cos(0.5), s = std::sin(0.5), u = 2 * uv.x, v = 3 * uv.y;
        const glm::dvec2 placed(0.25 + c * u + s * v, -0.125 - s * u + c * v);
        EXPECT_NEAR(map->at(uv).value, bare->at(placed).value, 1e-12);
    }
}

TEST(HeightMap, ScaleAndMidLevelAreApplied) {
    HeightMapOptions options = plain();
    options.scale = 4;
    options.midlevel = 0.25;
    const auto map = HeightMap::make(random_picture(5, 5, 7), options);
    const auto bare = HeightMap::make(random_picture(5, 5, 7), plain());
    ASSERT_TRUE(map && bare);
    EXPECT_NEAR(map->at({0.3, 0.6}).value, 4 * (bare->at({0.3, 0.6}).value - 0.25), 1e-15);
}

// Files of every type whose texels are the mid-level move nothing, not by the smallest number.
TEST(HeightMap, MidLevelOfEveryFileTypeIsExactlyZero) {
    const std::filesystem::path folder = ::testing::TempDir();
    struct Case {
        const char* name;
        PixelType type;
        double texel;
        int bits;
    };
    for (const Case& c :
         {Case{"mid8.png", PixelType::u8, 128.0 / 255, 8},
          Case{"mid16.png", PixelType::u16, 32768.0 / 65535, 16},
          Case{"mid16.exr", PixelType::f16, 0.5, 0}, Case{"mid32.exr", PixelType::f32, 0.5, 0}}) {
        Image image = picture(6, 4, [&](auto, auto) { return c.texel; });
        const auto path = folder / c.name;
        ASSERT_TRUE(save_image(path, image, c.type));
        const auto loaded = load_image(path);
        ASSERT_TRUE(loaded);
        EXPECT_EQ(loaded->integer_bits, c.bits);
        for (const HeightFilter filter : filters) {
            HeightMapOptions options;
            options.filter = filter;
            options.scale = 0.1;
            const auto map = HeightMap::make(*loaded, options);
            ASSERT_TRUE(map);
            const auto limited = map->limited({}, 0.4);
            ASSERT_TRUE(limited);
            EXPECT_EQ(limited->change, 0.0) << c.name;
            for (const double u : {0.0, 0.1, 0.37, 1.2}) {
                EXPECT_EQ(map->at({u, 0.7 - u}).value, 0.0) << c.name;
                EXPECT_EQ(map->at({u, 0.7 - u}).gradient, glm::dvec2(0.0)) << c.name;
                EXPECT_EQ(limited->map.value({u, 0.7 - u}), 0.0) << c.name;
            }
            const Deviation none = map->deviation({{{0, 0}, {3, 0}, {0, 2}}}, {{0, 0, 0}}, 0);
            EXPECT_EQ(none.upper, 0.0) << c.name;
        }
    }
}

// PNGs of 8 bits are taken for sRGB where colours are meant; heights never are.
TEST(HeightMap, PicturesTaggedAsSrgbAreReadLinearly) {
    Image image = picture(2, 1, [](auto x, auto) { return x == 0 ? 0.2 : 0.8; });
    image.srgb = true;
    const auto path = std::filesystem::path(::testing::TempDir()) / "tagged.png";
    ASSERT_TRUE(save_image(path, image, PixelType::u8));
    const auto loaded = load_image(path);
    ASSERT_TRUE(loaded && loaded->srgb);
    const auto map = HeightMap::make(*loaded, plain());
    ASSERT_TRUE(map);
    EXPECT_NEAR(map->at({0.25, 0.5}).value, 51.0 / 255, 1e-12);
    EXPECT_NEAR(map->at({0.75, 0.5}).value, 204.0 / 255, 1e-12);
}

TEST(HeightMap, QuantumIsHalfAStepOfWhatTheValuesUse) {
    Image bytes = picture(16, 16, [](auto x, auto y) { return double((x * 16 + y)) / 255; });
    bytes.integer_bits = 8;
    HeightMapOptions options;
    options.scale = 2;
    const auto precision = [&](const Image& image) {
        return HeightMap::make(image, options)->precision();
    };
    EXPECT_EQ(precision(bytes).bits, 8);
    EXPECT_DOUBLE_EQ(precision(bytes).half_step, 1.0 / 255);
    Image words = bytes;
    words.integer_bits = 16;  // 8 bits, saved with 16
    EXPECT_EQ(precision(words).bits, 8);
    EXPECT_EQ(precision(words).file_bits, 16);
    words.pixels[3] = float(1001.0 / 65535);
    EXPECT_EQ(precision(words).bits, 16);
    EXPECT_DOUBLE_EQ(precision(words).half_step, 1.0 / 65535);
    Image floats = bytes;
    floats.integer_bits = 0;
    EXPECT_EQ(precision(floats).bits, 8);
    EXPECT_EQ(precision(floats).file_bits, 0);
    floats.pixels[3] = 0.12345f;
    EXPECT_EQ(precision(floats).bits, 0);
    EXPECT_EQ(precision(floats).half_step, 0);
    EXPECT_EQ(precision(picture(2, 2, [](auto x, auto) { return double(x); })).bits, 0);
    EXPECT_EQ(precision(picture(4, 4, [](auto x, auto) { return 1e-30 * (x + 1); })).bits, 0);
}

TEST(HeightMap, WhatIsNoHeightIsAnErrorThatNamesIt) {
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 2e30f}) {
        Image image = random_picture(4, 4, 8);
        image.pixels[2 * 4 + 3] = bad;
        const auto map = HeightMap::make(image, plain());
        ASSERT_FALSE(map);
        EXPECT_NE(map.error().text.find("texel (3, 2)"), std::string::npos) << map.error().text;
    }
    EXPECT_FALSE(HeightMap::make(Image{}, plain()));
    HeightMapOptions options = plain();
    options.channel = 1;
    EXPECT_FALSE(HeightMap::make(random_picture(2, 2, 1), options));
    options = plain();
    options.scale = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(HeightMap::make(random_picture(2, 2, 1), options));
    options = plain();
    options.placement.offset.x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(HeightMap::make(random_picture(2, 2, 1), options));
}

// Inside of the map cells are found without its regions: the same bits on both sides of the seams,
// values as defined.
TEST(HeightMap, SeamsAreReadAsTheRestIs) {
    for (const auto& [width, height] :
         std::initializer_list<std::pair<std::uint32_t, std::uint32_t>>{{8, 4}, {1, 8}, {1, 1}})
        for (const HeightFilter filter : filters)
            for (const Wrap wrap : wraps) {
                const Image image = random_picture(width, height, 12);
                detail::HeightMapData data;
                data.options = plain(filter, wrap);
                data.x = {width, wrap};
                data.y = {height, wrap};
                data.raw = image.pixels;
                const auto seams = [](double size) {
                    std::vector<double> at{0.3, 0.5 * size};  // of map coordinates, and a half
                    for (const double line : {0.0, 0.5, 1.5, size - 0.5, size, size + 0.5})
                        for (const double to : {-HUGE_VAL, line, HUGE_VAL})
                            at.push_back(std::nextafter(line, to));
                    return at;
                };
                for (const double x : seams(width))
                    for (const double y : seams(height)) {
                        const glm::dvec2 uv(x / width, y / height), p = data.map_point(uv);
                        const auto of = [](const detail::HeightAxis& axis, double along) {
                            const auto r = detail::region(axis, detail::region_of(axis, along));
                            return std::pair(detail::cell_point(axis, r.cell(along)), r.turn);
                        };
                        const auto [cx, turn_x] = of(data.x, p.x);
                        const auto [cy, turn_y] = of(data.y, p.y);
                        glm::dvec2 gradient;
                        const double value =
                            detail::raw_at(data, cx.cell + data.x.first(), cy.cell + data.y.first(),
                                           cx.part, cy.part, &gradient);
                        const detail::RawSample sample = detail::raw_sample(data, uv);
                        ASSERT_EQ(sample.value, value) << p.x << ", " << p.y;
                        ASSERT_EQ(sample.gradient, gradient * glm::dvec2(turn_x, turn_y));
                        EXPECT_NEAR(value, by_definition(image, filter, wrap, uv), 1e-13);
                    }
            }
}

TEST(HeightMap, OddCoordinatesReadSomething) {
    const auto map = HeightMap::make(random_picture(8, 8, 9), plain());
    ASSERT_TRUE(map);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double odd : {nan, HUGE_VAL, -HUGE_VAL, 1e300, -1e18, 4e15})
        for (const Wrap wrap : wraps) {
            const auto of = HeightMap::make(random_picture(8, 8, 9), plain(filters[1], wrap));
            EXPECT_TRUE(std::isfinite(of->at({odd, 0.5}).value));
            const std::array<glm::dvec2, 3> t{{{odd, 0}, {0, 0}, {0, 1}}};
            for (const double spacing : {0.3, 1e-300, 1e300}) {
                const auto limited = of->limited({.triangles = {t}}, spacing);
                ASSERT_TRUE(limited);
                EXPECT_TRUE(std::isfinite(limited->map.value({0.25, 0.5})));
            }
            const Deviation far = of->deviation({{{odd, 0}, {0, 0}, {0, 1}}}, {{0, 0, 0}}, 0);
            EXPECT_GE(far.upper, far.lower);
        }
    EXPECT_EQ(map->deviation({{{0, 0}, {1, 0}, {0, 1}}}, {{nan, 0, 0}}, 0).upper, HUGE_VAL);
}

// Over boxes of all sizes, in and around the map.
TEST(HeightMap, RangesHoldAllThatIsReadAndLittleMore) {
    std::mt19937 random(10);
    for (const HeightFilter filter : filters)
        for (const Wrap wrap : wraps) {
            const Image image = random_picture(37, 21, 11);
            HeightMapOptions options = plain(filter, wrap);
            options.scale = -2;
            const auto map = HeightMap::make(image, options);
            ASSERT_TRUE(map);
            for (int k = 0; k < 150; ++k) {
                const double size = std::exp2(-8 * part(random)) * 2;
                const glm::dvec2 low(3 * part(random) - 1.5, 3 * part(random) - 1.5);
                const glm::dvec2 high = low + size * glm::dvec2(part(random), part(random));
                const detail::Interval range = map->range(low, high);
                double least = HUGE_VAL, most = -HUGE_VAL;
                const auto note = [&](const glm::dvec2& uv) {
                    const double h = map->at(uv).value;
                    least = std::min(least, h);
                    most = std::max(most, h);
                    EXPECT_LE(glm::length(map->at(uv).gradient),
                              map->steepest(low, high) * (1 + 1e-12));
                };
                for (int i = 0; i <= 30; ++i)
                    for (int j = 0; j <= 30; ++j)
                        note(low + (high - low) * (glm::dvec2(i, j) / 30.0));
                // Every texel's centre inside is a candidate of its own.
                for (int i = -60; i < 100; ++i)
                    for (int j = -40; j < 60; ++j) {
                        const glm::dvec2 uv((i + 0.5) / 37, (j + 0.5) / 21);
                        if (glm::all(glm::lessThanEqual(low, uv)) &&
                            glm::all(glm::lessThanEqual(uv, high)))
                            note(uv);
                    }
                EXPECT_LE(range.low, least);
                EXPECT_GE(range.high, most);
                // Samples are at most a thirtieth of the box off: their own slope there.
                const double near = glm::length(high - low) / 30 * map->steepest(low, high);
                const double over = filter == HeightFilter::bicubic ? 2 * 9.0 / 32 + 0.3 : 1e-9;
                EXPECT_GE(range.low, least - near - over);
                EXPECT_LE(range.high, most + near + over);
            }
        }
}

struct DisplacedScene {
    const char* name;
    Image image;
};

std::vector<DisplacedScene> scenes() {
    std::vector<DisplacedScene> all;
    all.push_back({"random", random_picture(40, 24, 12)});
    all.push_back({"smooth", picture(64, 64, [](auto x, auto y) {
                       return std::sin(x * 0.0982) * std::cos(y * 0.0982);
                   })});
    all.push_back(
        {"spike", picture(50, 70, [](auto x, auto y) { return x == 17 && y == 33 ? 1.0 : 0.0; })});
    all.push_back({"ramp", picture(33, 33, [](auto x, auto y) { return 0.1 * x - 0.2 * y; })});
    all.push_back({"one", random_picture(1, 1, 13)});
    all.push_back({"row", random_picture(30, 1, 14)});
    return all;
}

// Every block of every level, where its cells lie.
TEST(HeightMap, BlocksHoldWhatTheySay) {
    for (const DisplacedScene& scene : scenes())
        for (const HeightFilter filter : filters)
            for (const Wrap wrap : wraps) {
                detail::HeightMapData map;
                map.options = plain(filter, wrap);
                map.x = {std::int64_t(scene.image.width), wrap};
                map.y = {std::int64_t(scene.image.height), wrap};
                map.raw = scene.image.pixels;
                map.pyramid = detail::make_height_pyramid(map, 1);
                double size = detail::cells_in_block;
                for (const auto& level : map.pyramid.levels) {
                    for (std::int64_t y = 0; y < 4 * map.y.cells(); ++y)
                        for (std::int64_t x = 0; x < 4 * map.x.cells(); ++x) {
                            const double raw =
                                detail::raw_at(map, x / 4 + map.x.first(), y / 4 + map.y.first(),
                                               double(x % 4) / 4, double(y % 4) / 4, nullptr);
                            const double px = double(x) / 4, py = double(y) / 4;
                            const auto bx = std::int64_t(px / size), by = std::int64_t(py / size);
                            const detail::HeightBlock& b =
                                level.blocks[std::size_t(by * level.width + bx)];
                            const double above =
                                raw - (double(b.middle) +
                                       double(b.slope_x) * (px - (double(bx) + 0.5) * size) +
                                       double(b.slope_y) * (py - (double(by) + 0.5) * size));
                            // Doubles' own rounding.
                            constexpr double rounding = 1e-13;
                            ASSERT_GE(above, double(b.below) - rounding) << scene.name;
                            ASSERT_LE(above, double(b.above) + rounding) << scene.name;
                            ASSERT_GE(raw, double(b.low) - rounding) << scene.name;
                            ASSERT_LE(raw, double(b.high) + rounding) << scene.name;
                        }
                    size *= 2;
                }
            }
}

// Bounds are bounds: no sample is beyond `upper`, and `lower` is reached.
TEST(HeightMap, DeviationsOfRandomTrianglesAreBounded) {
    std::mt19937 random(15);
    double worst = 0;
    for (const DisplacedScene& scene : scenes())
        for (const HeightFilter filter : filters)
            for (const Wrap wrap : wraps) {
                HeightMapOptions options = plain(filter, wrap);
                options.scale = 1.5;
                const auto map = HeightMap::make(scene.image, options);
                ASSERT_TRUE(map);
                for (int k = 0; k < 60; ++k) {
                    const double size = std::exp2(-8 * part(random)) * 2.5;
                    const glm::dvec2 at(2 * part(random) - 0.5, 2 * part(random) - 0.5);
                    std::array<glm::dvec2, 3> uv;
                    std::array<double, 3> values;
                    for (std::size_t c = 0; c < 3; ++c) {
                        uv[c] = at + size * glm::dvec2(part(random), part(random));
                        if (k % 7 == 5) uv[c] = at + size * part(random) * glm::dvec2(1, 0.3);
                        if (k % 7 == 6) uv[c] = at;
                        values[c] = map->at(uv[c]).value + (k % 3 == 0 ? 0.2 * part(random) : 0);
                    }
                    const double enough = k % 4 == 0 ? 0.1 : 0;
                    const Deviation d = map->deviation(uv, values, enough);
                    const int n = 60;
                    double sampled = 0;
                    over_triangle(n, [&](const glm::dvec3& w) {
                        const glm::dvec2 p = w.x * uv[0] + w.y * uv[1] + w.z * uv[2];
                        const double l = w.x * values[0] + w.y * values[1] + w.z * values[2];
                        sampled = std::max(sampled, std::abs(map->at(p).value - l));
                    });
                    EXPECT_GE(d.upper, sampled) << scene.name << " " << k;
                    EXPECT_LE(d.lower, d.upper);
                    // The sample next to where `lower` was found is half a step off at most.
                    double step = 0, tilt = 0;
                    for (std::size_t c = 0; c < 3; ++c) {
                        step = std::max(step, glm::length(uv[c] - uv[(c + 1) % 3]) / n);
                        tilt = std::max(tilt, std::abs(values[c] - values[(c + 1) % 3]) / n);
                    }
                    EXPECT_LE(d.lower,
                              sampled + 1e-12 + tilt +
                                  step * map->steepest(glm::min(uv[0], glm::min(uv[1], uv[2])),
                                                       glm::max(uv[0], glm::max(uv[1], uv[2]))))
                        << scene.name << " " << k;
                    EXPECT_LE(d.upper, std::max(enough, 1.1 * d.lower) + 1e-9)
                        << scene.name << " " << k << " filter " << int(filter);
                    if (enough == 0 && sampled > 1e-3) worst = std::max(worst, d.upper / sampled);
                }
            }
    std::printf("largest upper over sampled: %.3f\n", worst);
}

// A plane, however its triangle lies, is found to be one.
TEST(HeightMap, DeviationFromAPlaneIsRounding) {
    const auto map =
        HeightMap::make(picture(200, 200, [](auto x, auto y) { return 0.25 * x + 0.5 * y; }),
                        plain(HeightFilter::bicubic, Wrap::clamp));
    ASSERT_TRUE(map);
    const std::array<glm::dvec2, 3> uv{{{0.1, 0.1}, {0.9, 0.2}, {0.3, 0.8}}};
    const Deviation d = map->deviation(
        uv, {map->at(uv[0]).value, map->at(uv[1]).value, map->at(uv[2]).value}, 1e-9);
    EXPECT_LE(d.upper, 1e-9);
}

// 4096² texels, one of them high: found by a search that looks at few blocks.
TEST(HeightMap, ASpikeOfOneTexelIsFoundQuickly) {
    Image image = picture(4096, 4096, [](auto, auto) { return 0.5; });
    std::mt19937 random(16);
    HeightMapOptions options = plain(HeightFilter::bilinear, Wrap::clamp);
    options.midlevel = 0.5;
    for (const HeightFilter filter : filters) {
        options.filter = filter;
        const auto x = std::size_t(random() % 2048), y = std::size_t(random() % 2047);
        image.pixels[y * 4096 + x] = 1.5f;
        const auto map = HeightMap::make(image, options);
        ASSERT_TRUE(map);
        image.pixels[y * 4096 + x] = 0.5f;
        const std::array<glm::dvec2, 3> uv{{{0, 0}, {1, 0}, {0, 1}}};
        const auto begin = std::chrono::steady_clock::now();
        // 2,000 nodes of millions: what the pyramid is for.
        const Deviation d = map->deviation(uv, {{0, 0, 0}}, 0, 2000);
        const double us =
            std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
                .count();
        std::printf("spike found in %.0f us: [%g, %g]\n", us, d.lower, d.upper);
        EXPECT_GE(d.upper, 1.0);
        EXPECT_LE(d.upper, 1.1 * d.lower + 1e-9);
        EXPECT_LE(d.lower, 1.0 + 1e-12);
        // A triangle beside it is flat.
        const Deviation flat =
            map->deviation({{{0.6, 0.6}, {1, 0.6}, {0.6, 1}}}, {{0, 0, 0}}, 0, 100);
        EXPECT_LE(flat.upper, 1e-10);
    }
}

// With little effort the bound is wider, and holds.
TEST(HeightMap, DeviationHoldsWithLittleEffort) {
    const auto map = HeightMap::make(random_picture(256, 256, 17), plain());
    ASSERT_TRUE(map);
    const std::array<glm::dvec2, 3> uv{{{0, 0}, {1, 0.1}, {0.2, 1}}};
    const std::array<double, 3> values{0.5, 0.5, 0.5};
    const Deviation full = map->deviation(uv, values, 0);
    double before = HUGE_VAL;
    for (const std::uint32_t effort : {1u, 16u, 256u, 4096u}) {
        const Deviation d = map->deviation(uv, values, 0, effort);
        EXPECT_GE(d.upper, full.lower);
        EXPECT_LE(d.upper, before);
        before = d.upper;
    }
}

TEST(HeightMap, BlocksTakeLessThanAThirdOfTheTexels) {
    HeightMapOptions options = plain(HeightFilter::bicubic);
    const auto map = HeightMap::make(random_picture(1024, 512, 18), options);
    ASSERT_TRUE(map);
    const double texels = 1024 * 512 * sizeof(float);
    EXPECT_LE(double(map->memory()), texels * 4 / 3);
}

TEST(HeightMap, ThreadsChangeNothing) {
    const Image image = random_picture(300, 200, 19);
    HeightMapOptions options = plain(HeightFilter::bicubic);
    options.threads = 1;
    const auto one = HeightMap::make(image, options);
    options.threads = 7;
    const auto seven = HeightMap::make(image, options);
    ASSERT_TRUE(one && seven);
    const detail::ChartAtlas charts{
        {{{{0.1, 0.1}, {0.4, 0.2}, {0.2, 0.7}}}, {{{0.5, 0.1}, {1.2, 0.2}, {0.7, 0.9}}}}};
    std::mt19937 random(20);
    for (int k = 0; k < 200; ++k) {
        const glm::dvec2 uv(part(random), part(random));
        const double s = part(random) * 0.2;
        if (k % 20 == 0) {
            const auto a = one->limited(charts, s), b = seven->limited(charts, s);
            ASSERT_TRUE(a && b);
            EXPECT_EQ(a->change, b->change);
            for (int i = 0; i < 40; ++i) {
                const glm::dvec2 p(part(random), part(random));
                EXPECT_EQ(a->map.value(p), b->map.value(p));
            }
        }
        const std::array<glm::dvec2, 3> t{uv, uv + glm::dvec2(s, 0), uv + glm::dvec2(0, s)};
        EXPECT_EQ(one->deviation(t, {{0, 0, 0}}, 0.1).upper,
                  seven->deviation(t, {{0, 0, 0}}, 0.1).upper);
    }
}

}  // namespace
}  // namespace prep
