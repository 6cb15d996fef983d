// Band limits of height maps, texels between charts, vector maps, normal maps from heights.
#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "displacement/height_field.h"
#include "height_maps.h"

namespace prep {
namespace {

using detail::Deviation;
using detail::HeightMap;
using detail::VectorMap;
using namespace test;

constexpr double pi = std::numbers::pi;

double part(std::mt19937& random) {
    return double(random()) / 4294967296.0;
}

Result<HeightMap> limited(const Image& image, const HeightMapOptions& options, double spacing) {
    const auto map = HeightMap::make(image, options);
    if (!map) return map.error();
    auto made = map->limited({}, spacing);
    if (!made) return made.error();
    return std::move(made->map);
}

// Waves of whole cycles a map, in many directions: their amplitude after the filter, by the least
// squares fit of the same wave at scattered points, against the promise.
TEST(BandLimit, WavesOfEveryDirectionPassOrDoNot) {
    std::mt19937 random(1);
    double least_passed = 1, most_stopped = 0;
    for (const glm::uvec2& size :
         {glm::uvec2(256, 256), glm::uvec2(256, 128), glm::uvec2(200, 312)}) {
        const std::uint32_t width = size.x, height = size.y;
        for (const double spacing : {1.0 / 200, 1.0 / 64, 1.0 / 41, 1.0 / 20}) {
            if (spacing * std::min(width, height) < 1) continue;
            for (int k = 0; k < 14; ++k) {
                // Either side of the band, and below the Nyquist frequency of the map itself.
                const double band = k % 2 == 0 ? 0.25 * part(random) : 0.5 + 0.6 * part(random);
                const double angle = 2 * pi * part(random);
                const double cx = std::round(band / spacing * std::cos(angle));
                const double cy = std::round(band / spacing * std::sin(angle));
                const double cycles = std::hypot(cx, cy);
                const bool passes = cycles > 0 && cycles <= 0.25 / spacing;
                const bool stops = cycles >= 0.5 / spacing;
                if ((!passes && !stops) || std::abs(cx) > 0.45 * width ||
                    std::abs(cy) > 0.45 * height)
                    continue;
                const Image image = picture(width, height, [&](auto x, auto y) {
                    return std::cos(2 * pi * (cx * (x + 0.5) / width + cy * (y + 0.5) / height));
                });
                const auto map = limited(image, plain(), spacing);
                ASSERT_TRUE(map);
                double in_phase = 0, most = 0;
                constexpr int samples = 400;
                for (int s = 0; s < samples; ++s) {
                    const glm::dvec2 uv(part(random), part(random));
                    const double value = map->value(uv);
                    in_phase += value * std::cos(2 * pi * (cx * uv.x + cy * uv.y)) * 2 / samples;
                    most = std::max(most, std::abs(value));
                }
                if (stops) {
                    EXPECT_LE(most, 0.02) << cx << ", " << cy << " at " << spacing;
                    most_stopped = std::max(most_stopped, most);
                } else {
                    EXPECT_GE(most, 0.95) << cx << ", " << cy << " at " << spacing;
                    EXPECT_LE(most, 1.05);
                    EXPECT_GE(in_phase, 0.8);  // the same wave, not its negative
                    least_passed = std::min(least_passed, most);
                }
            }
        }
    }
    std::printf("passed at least %.4f, stopped to at most %.4f\n", least_passed, most_stopped);
}

// cos(c r²): the local frequency grows with the distance from the middle.
TEST(BandLimit, ZonePlate) {
    constexpr std::uint32_t size = 1024;
    constexpr double most_cycles = 400;  // a unit, at the distance ½
    const auto phase = [](double r) { return 2 * pi * most_cycles * r * r; };
    const auto cycles = [](double r) { return 2 * most_cycles * r; };
    const Image image = picture(size, size, [&](auto x, auto y) {
        return std::cos(phase(std::hypot((x + 0.5) / size - 0.5, (y + 0.5) / size - 0.5)));
    });
    HeightMapOptions options = plain();
    options.wrap_u = options.wrap_v = Wrap::clamp;
    for (const double spacing : {1.0 / 512, 1.0 / 300, 1.0 / 128, 1.0 / 90}) {
        const auto map = limited(image, options, spacing);
        ASSERT_TRUE(map);
        double most_stopped = 0;
        for (int k = 0; k < 24; ++k) {
            const double angle = 2 * pi * k / 24;
            const glm::dvec2 along(std::cos(angle), std::sin(angle));
            double crest = 0, crests = 0, least = 1;
            for (double r = 0.02; r < 0.5 - 4 * spacing; r += 0.0001) {
                const double value = map->value(glm::dvec2(0.5) + r * along);
                // A kernel's width away from the bands' limits: a zone plate's frequency changes
                // under the kernel.
                const double change = 2 * most_cycles * 4 * spacing;
                if (cycles(r) >= 0.5 / spacing + change)
                    most_stopped = std::max(most_stopped, std::abs(value));
                if (cycles(r) <= 0.25 / spacing - change && std::cos(phase(r)) > 0.999) {
                    crest += value / std::cos(phase(r));
                    ++crests;
                    least = std::min(least, value);
                }
            }
            if (crests > 3) {
                EXPECT_GE(crest / crests, 0.95) << spacing;
                EXPECT_GE(least, 0.93) << spacing;
            }
        }
        EXPECT_LE(most_stopped, 0.02) << spacing;
    }
}

TEST(BandLimit, SpacingsBelowATexelLeaveTheMapAsItIs) {
    const auto map = HeightMap::make(random_picture(32, 32, 3), plain());
    ASSERT_TRUE(map);
    const auto same = map->limited({}, 0.99 / 32), other = map->limited({}, 1.01 / 32);
    ASSERT_TRUE(same && other);
    EXPECT_EQ(same->change, 0.0);
    EXPECT_GT(other->change, 0.1);
    EXPECT_EQ(same->map.width(), 32u);
    EXPECT_EQ(other->map.width(), 5 * 32u);
    std::mt19937 random(4);
    for (int k = 0; k < 100; ++k) {
        const glm::dvec2 uv(part(random), part(random));
        EXPECT_EQ(same->map.value(uv), map->value(uv));
    }
    // Texels beyond what memory is for are refused.
    const auto large =
        HeightMap::make(picture(8192, 8192, [](auto, auto) { return 0.5; }), plain());
    const auto refused = large->limited({}, 1.5 / 8192);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::limit);
}

// A map longer than wide, at spacings between both of its texels: detail along the long side goes,
// that along the short side stays.
TEST(BandLimit, SidesOfDifferentLengthAreFilteredAlike) {
    const Image image = picture(16, 512, [](auto x, auto y) {
        return std::cos(2 * pi * 3 * (x + 0.5) / 16) + std::cos(2 * pi * 150 * (y + 0.5) / 512);
    });
    const auto map = limited(image, plain(), 1.0 / 100);
    ASSERT_TRUE(map);
    double most = 0;
    for (int i = 0; i < 64; ++i)
        for (int j = 0; j < 16; ++j) {
            const glm::dvec2 uv((i % 16 + 0.5) / 16, (i * 16 + j) / 1024.0 + 0.0007);
            most = std::max(most, std::abs(map->value(uv) - std::cos(2 * pi * 3 * uv.x)));
        }
    EXPECT_LE(most, 0.06);
}

// Two triangles of one square chart.
std::vector<std::array<glm::dvec2, 3>> square(glm::dvec2 low, glm::dvec2 high) {
    return {{{low, {high.x, low.y}, high}}, {{low, high, {low.x, high.y}}}};
}

TEST(Gutters, PoisonOutsideOfChartsMovesNothing) {
    std::mt19937 random(7);
    for (const HeightFilter filter : {HeightFilter::bilinear, HeightFilter::bicubic})
        for (int k = 0; k < 12; ++k) {
            // A rotated square, or a triangle.
            const glm::dvec2 centre(0.5 + 0.1 * part(random), 0.5 + 0.1 * part(random));
            const double angle = 2 * pi * part(random), half = 0.12 + 0.15 * part(random);
            const auto corner = [&](int i) {
                const double a = angle + pi / 2 * i;
                return centre + half * glm::dvec2(std::cos(a), std::sin(a));
            };
            std::vector<std::array<glm::dvec2, 3>> charts{{{corner(0), corner(1), corner(2)}}};
            if (k % 2 == 0) charts.push_back({{corner(0), corner(2), corner(3)}});
            const auto inside = [&](const glm::dvec2& p) {
                for (const auto& t : charts) {
                    const auto side = [&](std::size_t i) {
                        const glm::dvec2 a = t[i], b = t[(i + 1) % 3];
                        return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
                    };
                    if (side(0) >= 0 && side(1) >= 0 && side(2) >= 0) return true;
                }
                return false;
            };
            const auto height = [](double u, double v) { return std::sin(5 * u) + v * v; };
            const auto make = [&](double poison) {
                const Image image = picture(96, 96, [&](auto x, auto y) {
                    const glm::dvec2 p((x + 0.5) / 96, (y + 0.5) / 96);
                    return inside(p) || poison == 0 ? height(p.x, p.y) : poison;
                });
                return HeightMap::make(image, plain(filter))->confined(charts);
            };
            const HeightMap clean = make(0), poisoned = make(1e6);
            const auto smooth = [&](double poison) {
                const Image image = picture(96, 96, [&](auto x, auto y) {
                    const glm::dvec2 p((x + 0.5) / 96, (y + 0.5) / 96);
                    return inside(p) || poison == 0 ? height(p.x, p.y) : poison;
                });
                return HeightMap::make(image, plain(filter))
                    ->limited({.triangles = charts}, 0.05)
                    ->map.confined(charts);
            };
            const HeightMap clean_smooth = smooth(0), poisoned_smooth = smooth(1e6);
            for (const auto& t : charts)
                for (int s = 0; s < 2000; ++s) {
                    glm::dvec3 w(part(random), part(random), part(random));
                    if (s % 3 == 0) w.x = 0;  // on the border
                    w /= w.x + w.y + w.z;
                    const glm::dvec2 p = w.x * t[0] + w.y * t[1] + w.z * t[2];
                    EXPECT_NEAR(poisoned.at(p).value, clean.at(p).value, 1e-6);
                    EXPECT_NEAR(poisoned_smooth.value(p), clean_smooth.value(p), 1e-6);
                    // And it is the height, to a texel's step; the chart's tips reach furthest.
                    EXPECT_NEAR(poisoned.at(p).value, height(p.x, p.y), 5.0 / 96);
                }
            EXPECT_NEAR(poisoned.deviation(charts[0], {{0, 0, 0}}, 0).upper,
                        clean.deviation(charts[0], {{0, 0, 0}}, 0).upper, 1e-6);
        }
}

// Around a chart a plane goes on as one, so that slopes at seams are the chart's own.
TEST(Gutters, PlanesGoOnBeyondTheChart) {
    const auto charts = square({0.25, 0.25}, {0.72, 0.6});
    const Image image = picture(64, 64, [](auto x, auto y) {
        const bool in = x >= 16 && x + 0.5 <= 0.72 * 64 && y >= 16 && y + 0.5 <= 0.6 * 64;
        return in ? 0.5 * x - 0.25 * y : -1e6;
    });
    for (const HeightFilter filter : {HeightFilter::bilinear, HeightFilter::bicubic}) {
        const auto map = HeightMap::make(image, plain(filter));
        ASSERT_TRUE(map);
        const HeightMap confined = map->confined(charts);
        for (int i = 0; i <= 100; ++i) {
            const double t = i / 100.0;
            for (const glm::dvec2& p :
                 {glm::dvec2(0.25 + 0.47 * t, 0.25), glm::dvec2(0.25, 0.25 + 0.35 * t),
                  glm::dvec2(0.72, 0.25 + 0.35 * t), glm::dvec2(0.25 + 0.47 * t, 0.6)}) {
                EXPECT_NEAR(confined.at(p).value, 0.5 * (p.x * 64 - 0.5) - 0.25 * (p.y * 64 - 0.5),
                            1e-4);
                EXPECT_NEAR(confined.at(p).gradient.x, 32, 1e-3);
                EXPECT_NEAR(confined.at(p).gradient.y, -16, 1e-3);
            }
        }
    }
}

TEST(Gutters, ThinChartsReadTheTexelsTheyLieIn) {
    // Between two columns of texels' centres, a tenth of a texel wide.
    const std::vector<std::array<glm::dvec2, 3>> charts{
        {{{10.2 / 32, 0.2}, {10.3 / 32, 0.2}, {10.25 / 32, 0.8}}}};
    const Image image = picture(32, 32, [](auto x, auto) { return x == 10 ? 3.0 : 1e6; });
    const auto map = HeightMap::make(image, plain());
    ASSERT_TRUE(map);
    const HeightMap confined = map->confined(charts);
    for (int i = 0; i <= 50; ++i)
        EXPECT_NEAR(confined.at({10.25 / 32, 0.2 + 0.012 * i}).value, 3.0, 1e-9);
}

TEST(Gutters, ChartsThatRepeatAndOddOnes) {
    const Image image = random_picture(16, 16, 8);
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp}) {
        const auto map = HeightMap::make(image, plain(HeightFilter::bilinear, wrap));
        ASSERT_TRUE(map);
        // Tiles are the map all over; nothing covered, and nothing that is a number: as it was.
        const double nan = std::nan("");
        const std::vector<std::array<glm::dvec2, 3>> none{{{{nan, 0}, {0, 1}, {1, 0}}}};
        for (const auto& charts :
             {square({-3, -2}, {5, 9}), square({-1e30, -1e30}, {1e30, 1e30}), none}) {
            const HeightMap confined = map->confined(charts);
            for (const double u : {-1.3, 0.02, 0.4, 2.7})
                EXPECT_EQ(confined.at({u, 0.3 + u}).value, map->at({u, 0.3 + u}).value);
        }
        EXPECT_EQ(map->confined({}).at({0.3, 0.3}).value, map->at({0.3, 0.3}).value);
    }
    // A chart in the second tile stands for the first.
    const auto map = HeightMap::make(image, plain());
    const HeightMap first = map->confined(square({0.3, 0.3}, {0.6, 0.6}));
    const HeightMap second = map->confined(square({1.3, -0.7}, {1.6, -0.4}));
    for (const double u : {0.1, 0.3, 0.5, 0.61, 0.9})
        EXPECT_EQ(first.at({u, u}).value, second.at({u, u}).value);
}

Image three_channels(std::uint32_t size, unsigned seed) {
    std::mt19937 random(seed);
    Image image = picture(size, size, [](auto, auto) { return 0.0; });
    image.channels = 3;
    image.pixels.resize(image.pixels.size() * 3);
    for (float& p : image.pixels) p = float(double(random() % 4096) / 4096 - 0.5);
    return image;
}

TEST(VectorMap, AxesAreInTheStatedOrder) {
    Image image = three_channels(1, 9);
    image.pixels = {1, 2, 3};
    VectorMapOptions options;
    options.map = plain();
    options.map.scale = 2;
    const auto value = [&] { return VectorMap::make(image, options)->at({0.5, 0.5}).value; };
    options.axes = VectorAxes::tangent_normal_bitangent;
    EXPECT_EQ(value(), glm::dvec3(2, 6, 4));
    options.axes = VectorAxes::tangent_bitangent_normal;
    EXPECT_EQ(value(), glm::dvec3(2, 4, 6));
    options.flip = {false, true, false};
    EXPECT_EQ(value(), glm::dvec3(2, -4, 6));
    options.axes = VectorAxes::object;
    options.flip = {};
    EXPECT_TRUE(VectorMap::make(image, options)->in_object_space());
    EXPECT_EQ(value(), glm::dvec3(2, 4, 6));
    options.map.channel = 1;
    EXPECT_FALSE(VectorMap::make(image, options));
    EXPECT_FALSE(VectorMap::make(random_picture(2, 2, 1), VectorMapOptions{}));
}

TEST(VectorMap, DeviationsBoundTheVectorsLength) {
    std::mt19937 random(10);
    for (const HeightFilter filter : {HeightFilter::bilinear, HeightFilter::bicubic}) {
        VectorMapOptions options;
        options.map = plain(filter);
        const auto map = VectorMap::make(three_channels(24, 11), options);
        ASSERT_TRUE(map);
        for (int k = 0; k < 100; ++k) {
            const double size = std::exp2(-7 * part(random)) * 2;
            std::array<glm::dvec2, 3> uv;
            std::array<glm::dvec3, 3> values;
            for (std::size_t c = 0; c < 3; ++c) {
                uv[c] = glm::dvec2(0.3, 0.6) + size * glm::dvec2(part(random), part(random));
                values[c] = map->at(uv[c]).value;
            }
            const Deviation d = map->deviation(uv, values, 0);
            double sampled = 0;
            over_triangle(60, [&](const glm::dvec3& w) {
                const glm::dvec2 p = w.x * uv[0] + w.y * uv[1] + w.z * uv[2];
                const glm::dvec3 l = w.x * values[0] + w.y * values[1] + w.z * values[2];
                sampled = std::max(sampled, glm::length(map->at(p).value - l));
                EXPECT_LE(glm::length(map->at(p).value), map->longest(p, p) + 1e-12);
            });
            EXPECT_GE(d.upper, sampled);
            EXPECT_LE(d.upper, 1.1 * d.lower + 1e-3);
            EXPECT_LE(sampled, d.upper);
            EXPECT_LE(d.lower, d.upper);
        }
    }
}

// Slopes of closed forms: normals to within what central differences leave out.
TEST(HeightToNormal, NormalsAreThoseOfTheClosedForm) {
    constexpr std::uint32_t size = 256;
    const double a = 0.02;
    const Image image = picture(size, size, [&](auto x, auto y) {
        return a * std::sin(2 * pi * 2 * (x + 0.5) / size) +
               a * std::cos(2 * pi * (y + 0.5) / size);
    });
    HeightToNormalOptions options;
    options.map = plain();
    options.map.scale = 3;
    options.uv_size = {2, 0.5};
    options.strength = 1.5;
    const auto normals = height_to_normal(image, options);
    ASSERT_TRUE(normals);
    ASSERT_EQ(normals->channels, 3u);
    options.flip_green = true;
    const auto flipped = height_to_normal(image, options);
    for (std::uint32_t y = 0; y < size; y += 3)
        for (std::uint32_t x = 0; x < size; x += 5) {
            const double u = (x + 0.5) / size, v = (y + 0.5) / size;
            const double by_u = 3 * a * 4 * pi * std::cos(4 * pi * u) / 2 * 1.5;
            const double by_v = -3 * a * 2 * pi * std::sin(2 * pi * v) / 0.5 * 1.5;
            // v runs down, the bitangent up.
            const glm::dvec3 n = glm::normalize(glm::dvec3(-by_u, by_v, 1));
            for (std::uint32_t k = 0; k < 3; ++k)
                EXPECT_NEAR(2 * double(normals->at(x, y)[k]) - 1, n[int(k)], 2e-3);
            EXPECT_NEAR(double(flipped->at(x, y)[1]), 1 - double(normals->at(x, y)[1]), 1e-7);
        }
}

TEST(HeightToNormal, LevelGroundPointsUpAndOddOptionsAreErrors) {
    HeightToNormalOptions options;
    const auto normals = height_to_normal(random_picture(1, 1, 1), options);
    ASSERT_TRUE(normals);
    EXPECT_EQ(normals->pixels, (std::vector<float>{0.5f, 0.5f, 1.0f}));
    EXPECT_FALSE(height_to_normal(Image{}, options));
    options.uv_size.x = 0;
    EXPECT_FALSE(height_to_normal(random_picture(2, 2, 1), options));
    options.uv_size.x = 1;
    options.strength = std::nan("");
    EXPECT_FALSE(height_to_normal(random_picture(2, 2, 1), options));
}

}  // namespace
}  // namespace prep
