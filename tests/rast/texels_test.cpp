// What texels hold, sRGB and the elementary functions, against direct computation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "kernels/kernels.h"
#include "rast/exposure.h"
#include "rast/render.h"
#include "shading/color.h"
#include "shading/portable_math.h"
#include "textures.h"

namespace {

using prep::Wrap;
using rast::Footprint;
using rast::MipTexture;
using rast::TextureFilter;
using test::random_image;
using test::texture_of;

long double decoded(long double x) {
    return x <= 0.04045L ? x / 12.92L : std::pow((x + 0.055L) / 1.055L, 2.4L);
}

TEST(Srgb, DecodesEveryCodeAndEncodesItBack) {
    for (int code = 0; code < 256; ++code) {
        const float x = float(code) / 255.0f;
        const float linear = rast::srgb_to_linear(x);
        ASSERT_NEAR(linear, double(decoded(x)), 1e-7) << code;
        ASSERT_EQ(std::lround(rast::linear_to_srgb(linear) * 255.0f), code);
    }
    EXPECT_EQ(rast::linear_to_srgb(NAN), 0);
    EXPECT_EQ(rast::linear_to_srgb(-1), 0);
    EXPECT_EQ(rast::linear_to_srgb(7), 1);
}

TEST(Srgb, ColoursAreAveragedInLinearLightAndDataIsNot) {
    prep::Image checker{2, 2, 3, {}};
    for (const float x : {0.0f, 1.0f, 1.0f, 0.0f})
        checker.pixels.insert(checker.pixels.end(), {x, x, 0.5f});
    const MipTexture colour = texture_of(checker, Wrap::repeat, Wrap::repeat, true, true);
    EXPECT_FLOAT_EQ(colour.texel(colour.level(1), 0, 0).r, 0.5f);
    EXPECT_NEAR(colour.texel(colour.level(1), 0, 0).b, double(decoded(0.5L)), 1e-7);
    EXPECT_NEAR(rast::linear_to_srgb(colour.texel(colour.level(1), 0, 0).r), 0.735357, 1e-5);
    const MipTexture data = texture_of(checker, Wrap::repeat, Wrap::repeat, true, false);
    EXPECT_EQ(data.texel(data.level(1), 0, 0).b, 0.5f);
}

TEST(Texels, HoldEveryValueOfFilesOf8And16Bits) {
    for (const int steps : {255, 65535}) {
        const auto side = std::uint32_t(std::lround(std::sqrt(steps + 1.0)));
        prep::Image image{side, side, 2, {}};
        for (int code = 0; code <= steps; ++code)
            image.pixels.insert(image.pixels.end(),
                                {float(code) / float(steps), float(steps - code) / float(steps)});
        const MipTexture texture = texture_of(image, Wrap::clamp, Wrap::clamp);
        EXPECT_NE(texture.view().packed, nullptr);
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x) {
                const float* p = image.at(x, y);
                const glm::vec4 expected(p[0], p[0], p[0], p[1]);
                // On a texel's centre a filter of four reads that one alone.
                const glm::vec2 uv = (glm::vec2(x, y) + 0.5f) / float(side);
                ASSERT_EQ(texture.texel(texture.level(0), x, y), expected);
                ASSERT_EQ(texture.sample(uv, {}, TextureFilter::bilinear), expected);
            }
    }
}

TEST(Texels, KeepTheirBitsWhenTwoTexturesLieTogether) {
    const prep::Image images[] = {random_image(19, 33, 31), random_image(19, 33, 32)};
    const auto made = [&](std::size_t i) {
        return texture_of(images[i], Wrap::repeat, Wrap::border, true);
    };
    MipTexture a = made(0), b = made(1);
    const MipTexture alone[] = {made(0), made(1)};
    a.make_pyramid(2);  // the levels below follow later
    ASSERT_TRUE(MipTexture::put_together(a, b));
    EXPECT_EQ(a.view().packed + 4, b.view().packed);
    const MipTexture* const together[] = {&a, &b};
    std::mt19937_64 random(33);
    std::uniform_real_distribution<float> value(-2, 2);
    for (int n = 0; n < 2000; ++n) {
        const glm::vec2 uv(value(random), value(random));
        const Footprint footprint{{std::exp2(3 * value(random) - 4), 0}, {0, 0.02f}};
        for (const TextureFilter filter :
             {TextureFilter::nearest, TextureFilter::bilinear, TextureFilter::trilinear,
              TextureFilter::bicubic, TextureFilter::anisotropic, TextureFilter::ewa})
            for (std::size_t i = 0; i < 2; ++i)
                ASSERT_EQ(together[i]->sample(uv, footprint, filter),
                          alone[i].sample(uv, footprint, filter));
    }
    // Not twice, not with itself, and not what is read at other texels or as floats.
    MipTexture c = made(0), turned = texture_of(images[0], Wrap::border, Wrap::border, true),
               small = texture_of(random_image(19, 32, 34), Wrap::repeat, Wrap::border, true),
               base = texture_of(images[0], Wrap::repeat, Wrap::border);
    prep::Image bright = images[0];
    bright.pixels[0] = 2;
    MipTexture floats = texture_of(bright, Wrap::repeat, Wrap::border, true);
    ASSERT_EQ(floats.view().packed, nullptr);
    for (MipTexture* other : {&a, &b, &c, &turned, &small, &base, &floats})
        EXPECT_FALSE(MipTexture::put_together(c, *other));
}

// Ten levels of sRGB noise against means in long double: half a step of 16 bits for the first level
// and for each that is made of the one before.
TEST(Srgb, TenLevelsKeepTheirMeans) {
    constexpr std::uint32_t side = 1024;
    prep::Image image{side, side, 3, {}, true};
    std::mt19937 random(10);
    for (std::uint32_t i = 0; i < side * side * 3; ++i)
        image.pixels.push_back(float(random() % 256) / 255.0f);
    const MipTexture texture = texture_of(image, Wrap::repeat, Wrap::repeat, true, true);
    EXPECT_NE(texture.view().packed, nullptr);
    ASSERT_EQ(texture.level_count(), 11u);
    std::vector<long double> fine;
    for (const float x : image.pixels) fine.push_back(decoded(x));
    for (std::uint32_t l = 0, extent = side; l < texture.level_count(); ++l, extent /= 2) {
        double worst = 0;
        std::vector<long double> coarse;
        for (std::uint32_t y = 0; y < extent; ++y)
            for (std::uint32_t x = 0; x < extent; ++x)
                for (std::uint32_t c = 0; c < 3; ++c) {
                    const auto at = [&](std::uint32_t i, std::uint32_t j) {
                        return fine[(j * extent + i) * 3 + c];
                    };
                    const float found = texture.texel(texture.level(l), x, y)[int(c)];
                    worst = std::max(worst, std::abs(double(found - at(x, y))));
                }
        coarse.resize(std::size_t(extent / 2) * (extent / 2) * 3);
        for (std::uint32_t y = 0; y < extent / 2; ++y)
            for (std::uint32_t x = 0; x < extent / 2; ++x)
                for (std::uint32_t c = 0; c < 3; ++c) {
                    long double sum = 0;
                    for (std::uint32_t k = 0; k < 4; ++k)
                        sum += fine[((2 * y + k / 2) * extent + 2 * x + k % 2) * 3 + c];
                    coarse[(y * (extent / 2) + x) * 3 + c] = sum / 4;
                }
        EXPECT_LT(worst, 1e-7 + (l + 1) * 0.5 / 65535) << "level " << l;
        fine = std::move(coarse);
    }
}

// Dark codes of 16 bits are finer than 16 linear bits are.
TEST(Srgb, ColoursOf16BitsStayFloats) {
    prep::Image image{256, 256, 3, {}, true};
    for (int code = 0; code < 65536; ++code)
        image.pixels.insert(image.pixels.end(), 3, float(code) / 65535.0f);
    const MipTexture texture = texture_of(image, Wrap::repeat, Wrap::repeat, false, true);
    for (std::uint32_t code = 0; code < 65536; ++code)
        ASSERT_NEAR(texture.texel(texture.level(0), code % 256, code / 256).g,
                    double(decoded(code / 65535.0L)), 1e-7);
}

TEST(Srgb, PicturesAreEncodedAndToneMappedOnlyWhenAsked) {
    rast::Frame frame;
    frame.width = 3;
    frame.height = 1;
    for (const float level : {0.5f, 4.0f, -1.0f})
        frame.color.emplace_back(level, level, level, 1.0f);
    const prep::Image plain = rast::to_srgb(frame);
    EXPECT_NEAR(plain.pixels[0], 0.735357, 1e-5);
    EXPECT_EQ(plain.pixels[3], 1);
    EXPECT_EQ(plain.pixels[6], 0);
    prep::RenderChoices tone;
    tone.tone_map = prep::ToneMap::reinhard;
    const prep::Image mapped = rast::to_srgb(frame, tone);
    EXPECT_NEAR(mapped.pixels[3], 1.055 * std::pow(0.8, 1 / 2.4) - 0.055, 1e-6);  // 4 / (1 + 4)
    EXPECT_NEAR(mapped.pixels[0], 1.055 * std::pow(1 / 3.0, 1 / 2.4) - 0.055, 1e-6);
    EXPECT_EQ(mapped.pixels[6], 0);
    tone.exposure = 0.25f;
    EXPECT_NEAR(rast::to_srgb(frame, tone).pixels[3], 0.735357, 1e-5);  // 1 / (1 + 1)
    tone.tone_map = prep::ToneMap::off;
    EXPECT_NEAR(rast::to_srgb(frame, tone).pixels[0], 1.055 * std::pow(0.125, 1 / 2.4) - 0.055,
                1e-6);
}

// The first pixel is behind the scene, of the second surfaces have a half.
TEST(Srgb, WhatIsBehindTheSceneIsNotToneMapped) {
    const auto encoded = [](double x) { return 1.055 * std::pow(x, 1 / 2.4) - 0.055; };
    const glm::vec3 background(0.25f, 0.5f, 1.0f);
    prep::RenderChoices choices;
    choices.tone_map = prep::ToneMap::reinhard;
    choices.background = background;
    rast::expose(choices, 0.5f);
    rast::Frame frame;
    frame.width = 2;
    frame.height = 1;
    frame.color = {glm::vec4(choices.background, 0),
                   glm::vec4(0.5f * choices.background + 0.5f * glm::vec3(4.0f), 0.5f)};
    const prep::Image shown = rast::to_srgb(frame, choices);
    for (glm::length_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(shown.pixels[std::size_t(k)], encoded(background[k]), 1e-6);
        // 4 · 0.5 is shown as 2/3.
        EXPECT_NEAR(shown.pixels[3 + std::size_t(k)], encoded(0.5 * background[k] + 0.5 * 2 / 3),
                    1e-6);
    }
}

// Neighbours that are alike, that differ in one channel, and that are no numbers.
TEST(Srgb, EachPixelIsEncodedForItself) {
    rast::Frame frame;
    const glm::vec4 color(0.2f, 0.4f, 0.6f, 1.0f);
    frame.color.assign(8, color);
    for (glm::length_t k = 0; k < 3; ++k) frame.color[2 * std::size_t(k) + 1][k] = 0.1f;
    frame.color.insert(frame.color.end(), 2, glm::vec4(NAN));
    frame.width = std::uint32_t(frame.color.size());
    frame.height = 1;
    const prep::Image image = rast::to_srgb(frame);
    for (std::size_t i = 0; i < frame.color.size(); ++i)
        for (glm::length_t k = 0; k < 3; ++k)
            EXPECT_EQ(image.pixels[3 * i + std::size_t(k)], rast::linear_to_srgb(frame.color[i][k]))
                << i << " " << k;
}

TEST(Elementary, LogAndExpKeepThirteenDigits) {
    std::mt19937_64 random(8);
    std::uniform_real_distribution<double> exponent(-300, 300), argument(-700, 700);
    for (int n = 0; n < 100000; ++n) {
        const double x = std::pow(10.0, exponent(random));
        const long double expected = std::log((long double)x);
        ASSERT_NEAR(rast::log_portable(x), double(expected),
                    std::max(1e-13 * std::abs(double(expected)), 1e-15));
        const double y = argument(random);
        const double e = double(std::exp((long double)y));
        ASSERT_NEAR(rast::exp_portable(y), e, 1e-13 * e);
    }
}

TEST(Elementary, LogarithmToBaseTwoInFloat) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> exponent(-120, 120);
    double worst = 0;
    for (int n = 0; n < 200000; ++n) {
        const float x = float(std::exp2(n % 2 ? exponent(random) : exponent(random) / 1000));
        const double expected = double(std::log2((long double)x));
        // Beside a fixed error one rounding of the result, whose last bit is at most 2^-17.
        const double rounding = std::max(1.0, std::abs(expected)) * 0x1p-23;
        worst = std::max(worst, std::abs(double(rast::log2_portable(x)) - expected) - rounding);
    }
    EXPECT_LT(worst, 3.1e-7);
    for (int k = -100; k <= 100; ++k)
        EXPECT_NEAR(rast::log2_portable(std::ldexp(1.0f, k)), float(k), 1e-6);
}

TEST(SpecularPower, KeepsItsDigitsUpToSharpHighlights) {
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> exponent(-14, 0), power(0, 5);
    double worst = 0;
    for (int n = 0; n < 200000; ++n) {
        const double s =
            n % 2 ? std::pow(10.0, exponent(random)) : 1 - std::pow(10.0, exponent(random));
        const float sine2 = float(s), cosine2 = float(1 - s);
        const float shininess = float(std::pow(10.0, power(random)));
        // Where the sine is the smaller one it is what counts, else the cosine.
        const long double logarithm =
            sine2 < 0.5f ? std::log1p(-(long double)sine2) : std::log((long double)cosine2);
        const double expected = double(std::exp(0.5L * (long double)shininess * logarithm));
        if (expected < 1e-30) continue;
        float out = 0;
        rast::detail::scalar_kernels().specular_powers(&sine2, &cosine2, shininess, 1, &out);
        worst = std::max(worst, std::abs(out - expected) / expected);
    }
    std::printf("worst relative error %.2g\n", worst);
    // Six roundings of the exponent to base 2, at most 100 for 1e-30, each 6e-8 of it.
    EXPECT_LT(worst, 100 * 6e-8 * 6);
    const auto at = [](float sine2, float cosine2, float shininess) {
        float out = 0;
        rast::detail::scalar_kernels().specular_powers(&sine2, &cosine2, shininess, 1, &out);
        return out;
    };
    EXPECT_EQ(at(1, 0, 0), 1.0f);  // 0^0
    EXPECT_EQ(at(0, 1, 1e5f), 1.0f);
    EXPECT_LT(at(1, 0, 5), 1e-30f);
}

}  // namespace
