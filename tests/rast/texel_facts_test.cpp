// What is found out about a texture's texels before a plan is made.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "random_scenes.h"
#include "shading/texture.h"

namespace {

// A picture of so many random floats a texel, and one value that is put in.
prep::Image random_floats(std::uint32_t extent, std::size_t at, float value) {
    prep::Image image;
    image.width = image.height = extent;
    image.channels = 4;
    image.floating = true;
    test::RandomNumbers r(7);
    for (std::size_t i = 0; i < std::size_t(extent) * extent * 4; ++i)
        image.pixels.push_back(r.between(0.5f, 3));
    image.pixels[at] = value;
    return image;
}

// Against a plain loop over the values, on any number of threads.
TEST(TexelFacts, AreThoseOfAllTexelsUntilEveryQuestionIsAnswered) {
    constexpr std::uint32_t extent = 300;
    constexpr std::size_t some = (250 * extent + 17) * 4;  // a texel near the end
    rast::TexelQuestions sign, alpha, both;
    sign.not_negative = both.not_negative = true;
    alpha.alpha = both.alpha = true;
    alpha.least_alpha = both.least_alpha = 0.5f;
    const auto facts = [&](std::size_t at, float value, const rast::TexelQuestions& asked) {
        const prep::Image image = random_floats(extent, at, value);
        const rast::MipTexture texture(image, {}, false, rast::TextureLevels::base);
        const rast::TexelFacts one = texture.facts(asked, 1), four = texture.facts(asked, 4);
        EXPECT_EQ(one.known, four.known);
        EXPECT_EQ(one.low, four.low);
        EXPECT_EQ(one.high, four.high);
        EXPECT_FALSE(one.constant);
        if (!one.known) return one;
        for (int k = 0; k < 4; ++k) {
            float low = value, high = value;
            if (at % 4 != std::size_t(k)) low = high = image.pixels[std::size_t(k)];
            for (std::size_t i = std::size_t(k); i < image.pixels.size(); i += 4) {
                low = std::min(low, image.pixels[i]);
                high = std::max(high, image.pixels[i]);
            }
            EXPECT_EQ(one.low[k], low) << k;
            EXPECT_EQ(one.high[k], high) << k;
        }
        return one;
    };
    EXPECT_TRUE(facts(some, 9, sign).known);
    EXPECT_FALSE(facts(some, -0x1p-23f, sign).known);
    EXPECT_TRUE(facts(some, -1, alpha).known);
    EXPECT_TRUE(facts(some, -1, both).known);  // alpha is still to be told
    EXPECT_TRUE(facts(some + 3, 0.5f, alpha).known);
    EXPECT_FALSE(facts(some + 3, 0.49f, alpha).known);
    EXPECT_TRUE(facts(some + 3, 0.49f, both).known);
    EXPECT_FALSE(facts(some + 1, NAN, both).known);
}

// What bends normals, or is no normal, is no reason to make levels; of packed texels the sign is
// known without looking.
TEST(TexelFacts, LevelsAreMadeOfWhatMayBeAFlatNormalMapAlone) {
    rast::TexelQuestions constant, sign;
    constant.constant = true;
    sign.not_negative = true;
    for (const float blue : {1.0f, 0.8f}) {
        prep::Image image;
        image.width = image.height = 64;
        image.channels = 3;
        image.floating = true;
        for (int i = 0; i < 64 * 64; ++i)
            image.pixels.insert(image.pixels.end(), {0.5f, 0.5f, blue});
        const rast::MipTexture texture(image, {}, false, rast::TextureLevels::mipmap);
        EXPECT_EQ(texture.facts(constant, 2).constant, blue == 1);
        EXPECT_EQ(texture.levels_made(), blue == 1 ? 7u : 1u);
        std::fill(image.pixels.begin(), image.pixels.end(), 0.2f);  // 51 of 255
        const rast::MipTexture packed(image, {}, false, rast::TextureLevels::mipmap);
        const rast::TexelFacts facts = packed.facts(sign, 2);
        EXPECT_TRUE(facts.known);
        EXPECT_EQ(facts.low, glm::vec4(0.0f));
        EXPECT_EQ(facts.high, glm::vec4(1.0f));
    }
}

}  // namespace
