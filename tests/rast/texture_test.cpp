// Wrapping, filters and mip levels, against direct computation.
#include "shading/texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "rast/render.h"
#include "textures.h"

namespace {

using prep::Wrap;
using rast::Footprint;
using rast::MipTexture;
using rast::TextureFilter;
using test::random_image;
using test::texture_of;

constexpr Wrap every_wrap[] = {Wrap::repeat, Wrap::mirror, Wrap::clamp, Wrap::border};

// A texel of the endless plane, by walking there.
std::int64_t walked(std::int64_t i, std::int64_t size, Wrap wrap) {
    if (wrap == Wrap::border) return i < 0 || i >= size ? -1 : i;
    if (wrap == Wrap::clamp) return i < 0 ? 0 : i >= size ? size - 1 : i;
    std::int64_t at = 0;
    int step = 1;
    for (std::int64_t k = 0; k < std::abs(i); ++k) {
        const bool forward = i > 0;
        if (wrap == Wrap::repeat) {
            at = forward ? (at + 1 == size ? 0 : at + 1) : (at == 0 ? size - 1 : at - 1);
        } else {
            // Mirrored: the edge texel comes twice. Going left from texel 0 starts with it.
            if (!forward && k == 0) continue;
            if (at + step < 0 || at + step >= size)
                step = -step;
            else
                at += step;
        }
    }
    return at;
}

glm::dvec4 texel(const prep::Image& image, std::int64_t x, std::int64_t y, Wrap u, Wrap v) {
    const std::int64_t i = walked(x, image.width, u), j = walked(y, image.height, v);
    if (i < 0 || j < 0) return glm::dvec4(0.0);
    const float* p = image.at(std::uint32_t(i), std::uint32_t(j));
    return {p[0], p[1], p[2], p[3]};
}

double distance(const glm::vec4& a, const glm::dvec4& b) {
    const glm::dvec4 d = glm::abs(glm::dvec4(a) - b);
    return std::max({d.x, d.y, d.z, d.w});
}

TEST(Wrap, FollowsTheDefinitionFarOutside) {
    for (const Wrap wrap : every_wrap)
        for (const std::int64_t size : {1, 2, 3, 7})
            for (std::int64_t i = -40; i <= 40; ++i)
                EXPECT_EQ(rast::wrap_texel(i, size, wrap), walked(i, size, wrap))
                    << int(wrap) << " " << size << " " << i;
}

TEST(Filter, NearestAndBilinearEqualDirectComputation) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<float> coordinate(-3, 3);
    for (const glm::uvec2 size : {glm::uvec2(1, 1), {2, 5}, {16, 16}, {7, 3}}) {
        const prep::Image image = random_image(size.x, size.y, size.x);
        for (const Wrap u : every_wrap)
            for (const Wrap v : every_wrap) {
                const MipTexture texture = texture_of(image, u, v);
                for (int n = 0; n < 500; ++n) {
                    const glm::vec2 uv(coordinate(random), coordinate(random));
                    const double x = double(uv.x) * size.x, y = double(uv.y) * size.y;
                    // Where the float product cannot land on another texel.
                    if (std::abs(x - std::round(x)) > 1e-5 && std::abs(y - std::round(y)) > 1e-5) {
                        ASSERT_EQ(distance(texture.sample(uv, {}, TextureFilter::nearest),
                                           texel(image, std::int64_t(std::floor(x)),
                                                 std::int64_t(std::floor(y)), u, v)),
                                  0.0);
                    }
                    const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
                    const double fx = x - 0.5 - left, fy = y - 0.5 - top;
                    const auto at = [&](int i, int j) {
                        return texel(image, std::int64_t(left) + i, std::int64_t(top) + j, u, v);
                    };
                    const glm::dvec4 expected = (at(0, 0) * (1 - fx) + at(1, 0) * fx) * (1 - fy) +
                                                (at(0, 1) * (1 - fx) + at(1, 1) * fx) * fy;
                    // The texel coordinate is rounded once: 48 · 2^-24 texels of a slope below 1,
                    // in both directions, and a few roundings; downwards half a step of 1/32768.
                    ASSERT_LT(distance(texture.sample(uv, {}, TextureFilter::bilinear), expected),
                              1e-5 + 0.5 / 32768);
                }
            }
    }
}

// The mean of the texels under a coarse one, by exact areas.
glm::dvec4 area_mean(const std::vector<glm::dvec4>& texels, std::uint32_t width,
                     std::uint32_t height, double x0, double x1, double y0, double y1) {
    glm::dvec4 sum(0.0);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const double w = std::max(0.0, std::min(x1, x + 1.0) - std::max(x0, double(x)));
            const double h = std::max(0.0, std::min(y1, y + 1.0) - std::max(y0, double(y)));
            sum += texels[y * width + x] * (w * h);
        }
    return sum / ((x1 - x0) * (y1 - y0));
}

TEST(MipLevels, AreMeansByArea) {
    for (const glm::uvec2 size : {glm::uvec2(8, 8), {16, 2}, {5, 7}, {13, 1}, {1, 1}}) {
        const prep::Image image = random_image(size.x, size.y, 7);
        const MipTexture texture = texture_of(image, Wrap::clamp, Wrap::clamp, true);
        std::vector<glm::dvec4> fine;
        for (std::uint32_t y = 0; y < size.y; ++y)
            for (std::uint32_t x = 0; x < size.x; ++x)
                fine.push_back(texel(image, x, y, Wrap::clamp, Wrap::clamp));
        std::uint32_t width = size.x, height = size.y;
        EXPECT_EQ(texture.level_count(),
                  1 + std::uint32_t(std::floor(std::log2(std::max(width, height)))));
        for (std::uint32_t l = 1; l < texture.level_count(); ++l) {
            const std::uint32_t w = std::max(1u, width / 2), h = std::max(1u, height / 2);
            ASSERT_EQ(texture.level(l).width, w);
            ASSERT_EQ(texture.level(l).height, h);
            std::vector<glm::dvec4> coarse;
            for (std::uint32_t y = 0; y < h; ++y)
                for (std::uint32_t x = 0; x < w; ++x) {
                    coarse.push_back(area_mean(fine, width, height, double(x) * width / w,
                                               double(x + 1) * width / w, double(y) * height / h,
                                               double(y + 1) * height / h));
                    // Half a step of 16 bits each level.
                    ASSERT_LT(distance(texture.texel(texture.level(l), x, y), coarse.back()),
                              1e-6 + l * 0.5 / 65535);
                }
            fine = std::move(coarse);
            width = w;
            height = h;
        }
    }
}

TEST(Filter, LevelOfDetailIsTheLongerSideOfTheFootprint) {
    const MipTexture texture =
        texture_of(random_image(64, 32, 1), Wrap::repeat, Wrap::repeat, true);
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> exponent(-12, 3), angle(0, 2 * std::numbers::pi);
    for (int n = 0; n < 2000; ++n) {
        const auto vector = [&] {
            const double length = std::exp2(exponent(random)), a = angle(random);
            return glm::vec2(float(length * std::cos(a)), float(length * std::sin(a)));
        };
        const Footprint footprint{vector(), vector()};
        const auto texels = [](const glm::vec2& d) {
            return std::hypot(double(d.x) * 64, double(d.y) * 32);
        };
        const double longest = std::max(texels(footprint.dx), texels(footprint.dy));
        // Vulkan asks for 2 fractional bits at least; float keeps 20.
        ASSERT_NEAR(texture.level_of_detail(footprint), std::max(0.0, std::log2(longest)), 1e-5);
    }
    EXPECT_EQ(texture.level_of_detail({}), 0);
    EXPECT_EQ(texture.level_of_detail({{NAN, 0}, {0, 0}}), 0);
    EXPECT_EQ(texture.level_of_detail({{INFINITY, 0}, {0, 0}}), 6);
}

// Of a level that repeats along u and is mirrored along v, in double.
glm::dvec4 level_texel(const MipTexture& texture, std::uint32_t l, double x, double y) {
    const auto& level = texture.level(l);
    return glm::dvec4(texture.texel(
        level, std::uint32_t(walked(std::int64_t(std::floor(x)), level.width, Wrap::repeat)),
        std::uint32_t(walked(std::int64_t(std::floor(y)), level.height, Wrap::mirror))));
}
glm::dvec4 level_bilinear(const MipTexture& texture, std::uint32_t l, const glm::vec2& uv) {
    const double x = double(uv.x) * texture.level(l).width - 0.5,
                 y = double(uv.y) * texture.level(l).height - 0.5;
    const double fx = x - std::floor(x), fy = y - std::floor(y);
    const auto at = [&](int i, int j) { return level_texel(texture, l, x + i, y + j); };
    return (at(0, 0) * (1 - fx) + at(1, 0) * fx) * (1 - fy) +
           (at(0, 1) * (1 - fx) + at(1, 1) * fx) * fy;
}

TEST(Filter, TrilinearMixesTheTwoLevelsByTheFraction) {
    const MipTexture texture =
        texture_of(random_image(32, 32, 3), Wrap::repeat, Wrap::mirror, true);
    std::mt19937_64 random(4);
    std::uniform_real_distribution<float> coordinate(-2, 2);
    for (int n = 0; n < 2000; ++n) {
        const glm::vec2 uv(coordinate(random), coordinate(random));
        const double lod = 6.0 * n / 2000;  // 5 is the last level
        const Footprint footprint{{float(std::exp2(lod) / 32), 0}, {0, 0}};
        const double kept = std::min(lod, 5.0), fraction = kept - std::floor(kept);
        const auto bilinear_of = [&](std::uint32_t l) {
            return level_bilinear(texture, std::min(l, 5u), uv);
        };
        const std::uint32_t fine = std::uint32_t(kept);
        const glm::dvec4 expected =
            bilinear_of(fine) * (1 - fraction) + bilinear_of(fine + 1) * fraction;
        // Roundings of the coordinate (64 · 2^-24 texels, half of 1/32768 downwards) and of the
        // level (1e-6).
        ASSERT_LT(distance(texture.sample(uv, footprint, TextureFilter::trilinear), expected),
                  2e-5 + 0.5 / 32768);
    }
}

// As OpenGL ES 3.2, 8.14, and Vulkan have it: `mag` up to a level of detail of 0, `min` beyond, on
// the first level, the nearest one (half way the finer) or both around it.
TEST(Filter, BySamplerEqualsDirectComputation) {
    using prep::Filter;
    using prep::MipFilter;
    const prep::Image image = random_image(32, 32, 21);
    std::mt19937_64 random(22);
    std::uniform_real_distribution<float> coordinate(-2, 2);
    for (const Filter mag : {Filter::nearest, Filter::linear})
        for (const Filter min : {Filter::nearest, Filter::linear})
            for (const MipFilter mip : {MipFilter::none, MipFilter::nearest, MipFilter::linear}) {
                prep::Texture sampler;
                sampler.wrap_v = Wrap::mirror;
                sampler.mag = mag;
                sampler.min = min;
                sampler.mip = mip;
                const MipTexture texture(
                    image, sampler, false,
                    rast::levels_for(rast::filter_for(TextureFilter::by_sampler, sampler)));
                int tried = 0;
                for (int n = 0; n < 1000; ++n) {
                    const glm::vec2 uv(coordinate(random), coordinate(random));
                    const double lod = 9.0 * n / 1000 - 2, kept = std::clamp(lod, 0.0, 5.0);
                    const Footprint footprint{{float(std::exp2(lod) / 32), 0}, {0, 0}};
                    const double fraction = kept - std::floor(kept);
                    // Where rounding cannot choose another texel or level.
                    bool clear = std::abs(lod) > 1e-4 && std::abs(fraction - 0.5) > 1e-4;
                    const auto read = [&](std::uint32_t l) {
                        if ((lod > 0 ? min : mag) == Filter::linear)
                            return level_bilinear(texture, l, uv);
                        const double x = double(uv.x) * texture.level(l).width,
                                     y = double(uv.y) * texture.level(l).height;
                        clear &= std::abs(x - std::round(x)) > 1e-4 &&
                                 std::abs(y - std::round(y)) > 1e-4;
                        return level_texel(texture, l, x, y);
                    };
                    const std::uint32_t fine = std::uint32_t(kept), coarse = std::min(fine + 1, 5u);
                    const glm::dvec4 expected =
                        mip == MipFilter::none ? read(0)
                        : mip == MipFilter::nearest
                            ? read(fraction > 0.5 ? coarse : fine)
                            : read(fine) * (1 - fraction) + read(coarse) * fraction;
                    if (!clear) continue;
                    ++tried;
                    ASSERT_LT(distance(texture.sample(uv, footprint, TextureFilter::by_sampler),
                                       expected),
                              2e-5 + 0.5 / 32768)
                        << int(mag) << int(min) << int(mip) << " " << lod;
                }
                EXPECT_GT(tried, 900);
            }
}

TEST(Filter, ConstantTexturesStayBitConstant) {
    prep::Image image{13, 5, 3, {}};
    for (int i = 0; i < 65; ++i) image.pixels.insert(image.pixels.end(), {0.1f, 0.7f, 0.3f});
    const MipTexture texture = texture_of(image, Wrap::repeat, Wrap::clamp);
    std::mt19937_64 random(5);
    std::uniform_real_distribution<float> coordinate(-20, 20);
    for (int n = 0; n < 2000; ++n)
        ASSERT_EQ(
            texture.sample({coordinate(random), coordinate(random)}, {}, TextureFilter::bilinear),
            glm::vec4(0.1f, 0.7f, 0.3f, 1));
}

TEST(Filter, HostileCoordinatesAreHarmless) {
    const MipTexture texture = texture_of(random_image(8, 8, 6), Wrap::repeat, Wrap::mirror, true);
    for (const float bad : {NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 1e-40f})
        for (const TextureFilter filter :
             {TextureFilter::nearest, TextureFilter::bilinear, TextureFilter::trilinear}) {
            const glm::vec4 c = texture.sample({bad, -bad}, {{bad, 0}, {0, bad}}, filter);
            for (int k = 0; k < 4; ++k) EXPECT_TRUE(c[k] >= 0 && c[k] <= 1);
        }
}

constexpr TextureFilter every_filter[] = {
    TextureFilter::by_sampler,  TextureFilter::nearest,     TextureFilter::bilinear,
    TextureFilter::nearest_mip, TextureFilter::trilinear,   TextureFilter::bicubic,
    TextureFilter::ripmap,      TextureFilter::anisotropic, TextureFilter::ewa};

MipTexture texture_for(const prep::Image& image, TextureFilter filter) {
    return MipTexture(image, prep::Texture{}, false, rast::levels_for(filter));
}

TEST(Filter, BicubicIsKeysKernel) {
    const prep::Image image = random_image(9, 6, 12);
    const MipTexture texture = texture_for(image, TextureFilter::bicubic);
    const auto kernel = [](double x) {  // Keys 1981, equation 8 with a = −1/2
        x = std::abs(x);
        if (x < 1) return 1.5 * x * x * x - 2.5 * x * x + 1;
        if (x < 2) return -0.5 * x * x * x + 2.5 * x * x - 4 * x + 2;
        return 0.0;
    };
    std::mt19937_64 random(13);
    std::uniform_real_distribution<float> coordinate(-1, 2);
    for (int n = 0; n < 2000; ++n) {
        const glm::vec2 uv(coordinate(random), coordinate(random));
        const double x = double(uv.x) * 9 - 0.5, y = double(uv.y) * 6 - 0.5;
        glm::dvec4 expected(0.0);
        for (std::int64_t j = std::int64_t(std::floor(y)) - 2; double(j) < y + 3; ++j)
            for (std::int64_t i = std::int64_t(std::floor(x)) - 2; double(i) < x + 3; ++i)
                expected += texel(image, i, j, Wrap::repeat, Wrap::repeat) *
                            (kernel(x - double(i)) * kernel(y - double(j)));
        ASSERT_LT(distance(texture.sample(uv, {}, TextureFilter::bicubic), expected), 2e-5);
    }
}

TEST(Filter, RipmapReadsBoxesAlongTheAxes) {
    const prep::Image image = random_image(16, 16, 14);
    const MipTexture texture = texture_for(image, TextureFilter::ripmap);
    // Four texels wide, one high, and the other way round, on the centres of such boxes; two levels
    // are rounded by half a step of 16 bits.
    constexpr double bound = 1e-6 + 2 * 0.5 / 65535;
    for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 4; ++i) {
            glm::dvec4 row(0.0), column(0.0);
            for (int k = 0; k < 4; ++k) {
                row += texel(image, 4 * i + k, j, Wrap::repeat, Wrap::repeat) / 4.0;
                column += texel(image, j, 4 * i + k, Wrap::repeat, Wrap::repeat) / 4.0;
            }
            const float along = (4 * float(i) + 2) / 16, across = (float(j) + 0.5f) / 16;
            ASSERT_LT(distance(texture.sample({along, across}, {{0.25f, 0}, {0, 1.0f / 16}},
                                              TextureFilter::ripmap),
                               row),
                      bound);
            ASSERT_LT(distance(texture.sample({across, along}, {{0, 0.25f}, {1.0f / 16, 0}},
                                              TextureFilter::ripmap),
                               column),
                      bound);
        }
}

TEST(Filter, EwaIsTheGaussianOverTheEllipse) {
    const prep::Image image = random_image(64, 64, 15);
    const MipTexture texture = texture_for(image, TextureFilter::ewa);
    std::mt19937_64 random(16);
    std::uniform_real_distribution<double> value(0, 1);
    for (int n = 0; n < 300; ++n) {
        const glm::vec2 uv(float(value(random)), float(value(random)));
        // A short side of at most a texel: the first level alone is read.
        const double turn = 6.28 * value(random), length = 1.5 + 6 * value(random),
                     width = length / 8 + (0.95 - length / 8) * value(random);
        const glm::dvec2 a = glm::dvec2(std::cos(turn), std::sin(turn)) * length,
                         b = glm::dvec2(-std::sin(turn), std::cos(turn)) * width;
        // The screen's axes may be any conjugate ones: J times a rotation has the same ellipse.
        const double roll = 6.28 * value(random);
        const glm::dvec2 right = a * std::cos(roll) + b * std::sin(roll),
                         down = b * std::cos(roll) - a * std::sin(roll);
        const Footprint footprint{glm::vec2(right / 64.0), glm::vec2(down / 64.0)};
        // The quadratic form is the inverse of J Jᵀ + 1.
        const double xx = a.x * a.x + b.x * b.x + 1, xy = a.x * a.y + b.x * b.y,
                     yy = a.y * a.y + b.y * b.y + 1, det = xx * yy - xy * xy;
        const double u = double(uv.x) * 64 - 0.5, v = double(uv.y) * 64 - 0.5;
        glm::dvec4 sum(0.0);
        double total = 0;
        for (int y = int(v) - 12; y <= int(v) + 13; ++y)
            for (int x = int(u) - 12; x <= int(u) + 13; ++x) {
                const double dx = x - u, dy = y - v;
                const double r2 = (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / det;
                if (r2 >= 1) continue;
                const double w = std::exp(-2 * r2) - std::exp(-2.0);
                sum += texel(image, x, y, Wrap::repeat, Wrap::repeat) * w;
                total += w;
            }
        // The table's steps of 1/256 in r² change a weight by 0.4 % at most, up and down.
        ASSERT_LT(distance(texture.sample(uv, footprint, TextureFilter::ewa, 8), sum / total),
                  4e-3);
    }
}

// A floor is as sharp whichever way the camera is rolled.
TEST(Filter, AnisotropicFootprintsAreEllipsesHoweverTheScreenIsTurned) {
    const prep::Image image = random_image(64, 32, 35);
    std::mt19937_64 random(36);
    std::uniform_real_distribution<double> value(0, 1);
    for (const TextureFilter filter : {TextureFilter::anisotropic, TextureFilter::ewa}) {
        const MipTexture texture = texture_for(image, filter);
        for (int n = 0; n < 300; ++n) {
            const glm::vec2 uv(float(value(random)), float(value(random)));
            const double turn = 6.28 * value(random), roll = 6.28 * value(random);
            const double length = 1.5 + 20 * value(random);
            const double width = length * (0.15 + 0.8 * value(random));
            const glm::dvec2 size(64, 32);
            const glm::dvec2 a = glm::dvec2(std::cos(turn), std::sin(turn)) * length / size,
                             b = glm::dvec2(-std::sin(turn), std::cos(turn)) * width / size;
            const Footprint straight{glm::vec2(a), glm::vec2(b)};
            const Footprint rolled{glm::vec2(a * std::cos(roll) + b * std::sin(roll)),
                                   glm::vec2(b * std::cos(roll) - a * std::sin(roll))};
            const glm::vec4 expected = texture.sample(uv, straight, filter, 8);
            ASSERT_LT(distance(texture.sample(uv, rolled, filter, 8), glm::dvec4(expected)), 2e-3)
                << n << ", filter " << int(filter);
        }
    }
}

// Cost must stay bounded whatever the footprint is: this ends, or it does not.
TEST(Filter, ExtremeFootprintsAreFiniteAndEndSoon) {
    const prep::Image image = random_image(64, 16, 17);
    for (const TextureFilter filter : every_filter) {
        const MipTexture texture = texture_for(image, filter);
        for (const float a : {0.0f, 1e-30f, 1e-3f, 1.0f, 1e6f, 1e20f, 3e38f, float(INFINITY), NAN})
            for (const float b : {0.0f, 1e-30f, 1e-3f, 1.0f, 1e6f, 1e20f, 3e38f, float(NAN)})
                for (const int most : {1, 2, 16}) {
                    const glm::vec4 c = texture.sample({0.3f, a}, {{a, b}, {-b, a}}, filter, most);
                    const glm::vec4 d = texture.sample({b, 0.1f}, {{a, 0}, {b, 0}}, filter, most);
                    for (int k = 0; k < 4; ++k)
                        ASSERT_TRUE(std::abs(c[k]) < 2 && std::abs(d[k]) < 2);
                }
    }
}

TEST(Filter, ConstantTexturesKeepTheirEnergyEdgeOn) {
    prep::Image image{64, 64, 1, std::vector<float>(64 * 64, 0.3f)};
    std::mt19937_64 random(18);
    std::uniform_real_distribution<float> coordinate(-20, 20);
    std::uniform_real_distribution<double> exponent(-9, 3);
    for (const TextureFilter filter : every_filter) {
        const MipTexture texture = texture_for(image, filter);
        for (int n = 0; n < 2000; ++n) {
            const float a = float(std::exp2(exponent(random))),
                        b = float(std::exp2(exponent(random)));
            const float c =
                texture.sample({coordinate(random), coordinate(random)}, {{a, b}, {b, a}}, filter)
                    .r;
            // Mip levels are sums of four products: half an ulp each time.
            ASSERT_NEAR(c, 0.3f, 6 * 6e-8);
        }
    }
}

// A picture of a texture from 1,024 samples a pixel of its first level: a pixel's mean, and the
// mean by EWA's own weights, exp(−2r²) − exp(−2) within a pixel of the centre.
struct Supersampled {
    std::vector<double> box, gauss;
};
template <class Map>
Supersampled supersampled(const prep::Image& image, int extent, const Map& uv_at) {
    constexpr int grid = 32;
    const MipTexture base = texture_for(image, TextureFilter::nearest);
    Supersampled out;
    for (int y = 0; y < extent; ++y)
        for (int x = 0; x < extent; ++x) {
            double box = 0, gauss = 0, total = 0;
            for (int j = -grid; j < 2 * grid; ++j)
                for (int i = -grid; i < 2 * grid; ++i) {
                    const double dx = (i + 0.5) / grid, dy = (j + 0.5) / grid;
                    const double r2 = (dx - 0.5) * (dx - 0.5) + (dy - 0.5) * (dy - 0.5);
                    const bool in_box = i >= 0 && i < grid && j >= 0 && j < grid;
                    if (r2 >= 1 && !in_box) continue;
                    const double value =
                        base.sample(glm::vec2(uv_at(x + dx, y + dy)), {}, TextureFilter::bilinear)
                            .r;
                    const double weight = std::max(0.0, std::exp(-2 * r2) - std::exp(-2.0));
                    if (in_box) box += value;
                    gauss += value * weight;
                    total += weight;
                }
            out.box.push_back(box / (grid * grid));
            out.gauss.push_back(gauss / total);
        }
    return out;
}

struct Quality {
    double rmse = 0, energy = 0;  // energy: mean over the reference's mean
    double rmse_gauss = 0;
};
template <class Map>
Quality quality(const prep::Image& image, const Supersampled& expected, TextureFilter filter,
                int most, int extent, const Map& uv_at) {
    const MipTexture texture = texture_for(image, filter);
    double squared = 0, squared_gauss = 0, mean = 0, reference_mean = 0;
    std::size_t n = 0;
    for (int y = 0; y < extent; ++y)
        for (int x = 0; x < extent; ++x, ++n) {
            const double h = 1e-3;
            const glm::dvec2 at = uv_at(x + 0.5, y + 0.5);
            const Footprint footprint{
                glm::vec2((uv_at(x + 0.5 + h, y + 0.5) - uv_at(x + 0.5 - h, y + 0.5)) / (2 * h)),
                glm::vec2((uv_at(x + 0.5, y + 0.5 + h) - uv_at(x + 0.5, y + 0.5 - h)) / (2 * h))};
            const double value = texture.sample(glm::vec2(at), footprint, filter, most).r;
            squared += (value - expected.box[n]) * (value - expected.box[n]);
            squared_gauss += (value - expected.gauss[n]) * (value - expected.gauss[n]);
            mean += value;
            reference_mean += expected.box[n];
        }
    return {std::sqrt(squared / double(n)), mean / reference_mean,
            std::sqrt(squared_gauss / double(n))};
}

// Which axis of the screen is the long one is the camera's affair.
TEST(Filter, AnisotropicProbesLieAlongTheLongSideWhicheverItIs) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<float> any(-1, 1);
    const MipTexture texture = texture_for(random_image(64, 64, 5), TextureFilter::anisotropic);
    for (int i = 0; i < 2000; ++i) {
        const glm::vec2 uv(any(random), any(random));
        const Footprint one{glm::vec2(any(random), any(random)) * 0.2f,
                            glm::vec2(any(random), any(random)) * 0.03f};
        const Footprint other{one.dy, one.dx};
        for (const int most : {2, 16})
            ASSERT_EQ(texture.sample(uv, one, TextureFilter::anisotropic, most),
                      texture.sample(uv, other, TextureFilter::anisotropic, most))
                << i;
    }
}

TEST(Filter, BetterOnesAreCloserToSupersampling) {
    prep::Image checker{128, 128, 1, {}}, zones{256, 256, 1, {}};
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x) checker.pixels.push_back(float((x / 8 + y / 8) % 2));
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 256; ++x) {
            const double dx = x - 127.5, dy = y - 127.5;
            checker.channels = 1;
            zones.pixels.push_back(
                float(0.5 + 0.5 * std::cos((dx * dx + dy * dy) * 3.14159 / 512)));
        }
    constexpr int extent = 40;
    // A floor that recedes to the horizon, turned against the texture; and rings seen from far.
    const auto floor = [](double x, double y) {
        const double depth = 14.0 / (y + 1.5), across = (x - extent / 2.0) * depth / 40;
        return glm::dvec2(0.8 * across + 0.6 * depth, 0.8 * depth - 0.6 * across) * 0.7;
    };
    const auto rings = [](double x, double y) { return glm::dvec2(x / extent, y / extent); };
    struct Row {
        const char* name;
        TextureFilter filter;
        int most;
        Quality floor, rings;
    };
    std::vector<Row> rows{{"nearest", TextureFilter::nearest, 1, {}, {}},
                          {"bilinear", TextureFilter::bilinear, 1, {}, {}},
                          {"trilinear", TextureFilter::trilinear, 1, {}, {}},
                          {"bicubic", TextureFilter::bicubic, 1, {}, {}},
                          {"ripmap", TextureFilter::ripmap, 1, {}, {}},
                          {"anisotropic 2", TextureFilter::anisotropic, 2, {}, {}},
                          {"anisotropic 4", TextureFilter::anisotropic, 4, {}, {}},
                          {"anisotropic 8", TextureFilter::anisotropic, 8, {}, {}},
                          {"anisotropic 16", TextureFilter::anisotropic, 16, {}, {}},
                          {"ewa 16", TextureFilter::ewa, 16, {}, {}},
                          {"nearest mip", TextureFilter::nearest_mip, 1, {}, {}}};
    const Supersampled true_floor = supersampled(checker, extent, floor);
    const Supersampled true_rings = supersampled(zones, extent, rings);
    std::printf("%-15s %10s %8s %10s %10s %8s\n", "", "floor", "energy", "own", "rings", "energy");
    for (Row& row : rows) {
        row.floor = quality(checker, true_floor, row.filter, row.most, extent, floor);
        row.rings = quality(zones, true_rings, row.filter, row.most, extent, rings);
        std::printf("%-15s %10.4f %8.3f %10.4f %10.4f %8.3f\n", row.name, row.floor.rmse,
                    row.floor.energy, row.floor.rmse_gauss, row.rings.rmse, row.rings.energy);
    }
    // In the order of the table; from anisotropic 8 on the last hundredth is the pixel's shape.
    const auto at = [&](std::size_t row) { return rows[row].floor.rmse; };
    EXPECT_GT(at(0), at(1));
    EXPECT_GT(at(1), at(2));
    EXPECT_GT(at(2), at(4));  // ripmap: nothing for slanted footprints
    EXPECT_GT(at(4), at(5));
    EXPECT_GT(at(5), at(6));
    EXPECT_GT(at(6), at(7));
    EXPECT_GE(at(7), at(8));
    EXPECT_LT(at(8), 0.03);
    EXPECT_LT(at(10), at(1));  // the nearest mip level: between bilinear and trilinear
    EXPECT_GT(at(10), at(2));
    // EWA's Gaussian reaches two pixels, the reference is one pixel's box: smoother than that, but
    // free of trilinear's blur across the floor. Held against its own weights it is the best.
    EXPECT_LT(at(9), at(4));
    for (std::size_t row = 0; row < 9; ++row)
        EXPECT_LT(rows[9].floor.rmse_gauss, rows[row].floor.rmse_gauss);
    for (std::size_t row = 2; row < rows.size(); ++row) {
        EXPECT_LT(rows[row].rings.rmse, rows[1].rings.rmse);
        EXPECT_NEAR(rows[row].floor.energy, 1, 0.005) << rows[row].name;
        EXPECT_NEAR(rows[row].rings.energy, 1, 0.005) << rows[row].name;
    }
}

}  // namespace
