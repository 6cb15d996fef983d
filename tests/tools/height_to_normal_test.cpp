// Normal maps of height maps from the command line, against the normals of heights of closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "command_runner.h"
#include "prep/image.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;

constexpr std::uint32_t size = 256;
constexpr double two_pi = 2 * std::numbers::pi;

// Whole waves: the map repeats.
struct Waves {
    double a = 0.05, b = 0.08;
    int fu = 3, fv = 2;
    double height(double u, double v) const {
        return a * std::sin(two_pi * fu * u) + b * std::cos(two_pi * fv * v + 1);
    }
    glm::dvec2 slope(double u, double v) const {
        return {a * two_pi * fu * std::cos(two_pi * fu * u),
                -b * two_pi * fv * std::sin(two_pi * fv * v + 1)};
    }
};

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}

class HeightToNormal : public testing::Test {
  protected:
    std::string heights(const std::string& name, prep::PixelType type, double scale,
                        double offset) {
        prep::Image image{.width = size, .height = size, .channels = 1, .pixels = {}};
        for (std::uint32_t y = 0; y < size; ++y)
            for (std::uint32_t x = 0; x < size; ++x)
                image.pixels.push_back(
                    float(waves_.height((x + 0.5) / size, (y + 0.5) / size) * scale + offset));
        const auto saved = prep::save_image(dir_ / name, image, type);
        EXPECT_TRUE(saved) << to_string(saved.error());
        return (dir_ / name).string();
    }
    // The largest angle from the closed form, which `strength` and sizes enter as lengths.
    double worst(const std::string& file, const glm::dvec2& lengths, double strength, bool down) {
        const auto image = prep::load_image(file);
        EXPECT_TRUE(image) << to_string(image.error());
        if (!image || image->width != size || image->height != size || image->channels != 3)
            return 180;
        double most = 0;
        for (std::uint32_t y = 0; y < size; y += 3)
            for (std::uint32_t x = 0; x < size; x += 3) {
                const float* c = image->at(x, y);
                const glm::dvec3 read(2 * double(c[0]) - 1, 2 * double(c[1]) - 1,
                                      2 * double(c[2]) - 1);
                const glm::dvec2 s =
                    waves_.slope((x + 0.5) / size, (y + 0.5) / size) / lengths * strength;
                // Along u is right; v runs down the picture, green points up in it.
                const glm::dvec3 closed(-s.x, down ? -s.y : s.y, 1);
                most = std::max(most, degrees_between(read, closed));
            }
        return most;
    }
    Waves waves_;
    TempDir dir_;
};

TEST_F(HeightToNormal, SlopesAreThoseOfTheClosedForm) {
    const std::string map = heights("map.exr", prep::PixelType::f32, 1, 0);
    struct Row {
        std::vector<std::string> options;
        const char* output;
        glm::dvec2 lengths;
        double strength;
        bool down;
        double most;  // degrees: the central difference's (2π f/256)²/6, and a code of the file
    };
    for (const Row& row :
         {Row{{}, "a.png", {1, 1}, 1, false, 0.05}, Row{{}, "a.exr", {1, 1}, 1, false, 0.05},
          Row{{"--bits", "8"}, "b.png", {1, 1}, 1, false, 0.45},
          Row{{"--size", "2,0.5"}, "c.png", {2, 0.5}, 1, false, 0.05},
          Row{{"--size", "3"}, "d.png", {3, 3}, 1, false, 0.05},
          Row{{"--strength", "2.5"}, "e.png", {1, 1}, 2.5, false, 0.05},
          Row{{"--height-scale", "-0.5"}, "f.png", {1, 1}, -0.5, false, 0.05},
          Row{{"--flip-green"}, "g.png", {1, 1}, 1, true, 0.05}}) {
        std::vector<std::string> words{"height-to-normal", map, "-o", (dir_ / row.output).string(),
                                       "--json"};
        words.insert(words.end(), row.options.begin(), row.options.end());
        const test::Ran ran = run_here(words);
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_LE(worst((dir_ / row.output).string(), row.lengths, row.strength, row.down),
                  row.most)
            << row.output;
        // Read the other way round, the map would be far off: the check sees it.
        EXPECT_GT(worst((dir_ / row.output).string(), row.lengths, row.strength, !row.down), 10)
            << row.output;
    }
}

TEST_F(HeightToNormal, ReportTellsSlopesAndWhatEightBitsCost) {
    const std::string fine = heights("fine.exr", prep::PixelType::f32, 1, 0);
    const std::string coarse = heights("coarse.png", prep::PixelType::u8, 2, 0.5);
    const std::string out = (dir_ / "out.png").string();
    const test::Ran one = run_here({"height-to-normal", fine, "-o", out, "--json"});
    ASSERT_EQ(one.exit_code, 0) << one.err;
    const json told = one.json();
    EXPECT_EQ(told["width"], size);
    EXPECT_EQ(told["bits"], 16);
    EXPECT_FALSE(told.contains("coarsest_degrees"));
    // Both waves at their steepest.
    const double steepest =
        std::atan(two_pi * std::hypot(waves_.a * waves_.fu, waves_.b * waves_.fv)) * 180 /
        std::numbers::pi;
    EXPECT_NEAR(told["steepest_degrees"].get<double>(), steepest, 0.1);
    EXPECT_GT(told["mean_degrees"].get<double>(), 0.4 * steepest);
    EXPECT_LT(told["mean_degrees"].get<double>(), 0.9 * steepest);
    const test::Ran two = run_here({"height-to-normal", coarse, "-o", out, "--json"});
    ASSERT_EQ(two.exit_code, 0) << two.err;
    // A step of 1/255 over two texels of 1/256.
    EXPECT_NEAR(two.json()["coarsest_degrees"].get<double>(),
                std::atan(256.0 / 255 / 2) * 180 / std::numbers::pi, 1e-9);
    EXPECT_NE(two.err.find("8 bits"), std::string::npos) << two.err;
    // The same steps in a file for more.
    const auto steps = prep::load_image(coarse);
    ASSERT_TRUE(steps);
    for (const auto& [name, type] : {std::pair("wide.png", prep::PixelType::u16),
                                     std::pair("wide.exr", prep::PixelType::f32)}) {
        ASSERT_TRUE(prep::save_image(dir_ / name, *steps, type));
        const test::Ran wide =
            run_here({"height-to-normal", (dir_ / name).string(), "-o", out, "--json"});
        ASSERT_EQ(wide.exit_code, 0) << wide.err;
        EXPECT_TRUE(wide.json().contains("coarsest_degrees")) << name;
    }
}

TEST_F(HeightToNormal, BordersAreReadAsTheMapContinues) {
    // A ramp: steep at the seam where it repeats, half as steep there where it is clamped, level
    // where it is mirrored.
    prep::Image image{.width = 64, .height = 4, .channels = 1, .pixels = {}};
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 64; ++x) image.pixels.push_back(float(x) / 64);
    ASSERT_TRUE(prep::save_image(dir_ / "ramp.exr", image, prep::PixelType::f32));
    const auto slope_at = [&](const std::string& wrap, std::uint32_t x) {
        const std::string out = (dir_ / (wrap + ".exr")).string();
        EXPECT_EQ(
            run_here({"height-to-normal", (dir_ / "ramp.exr").string(), "-o", out, "--wrap", wrap})
                .exit_code,
            0);
        const auto made = prep::load_image(out);
        EXPECT_TRUE(made);
        const float* c = made->at(x, 1);
        return -(2 * double(c[0]) - 1) / (2 * double(c[2]) - 1);
    };
    for (const char* wrap : {"repeat", "mirror", "clamp"})
        EXPECT_NEAR(slope_at(wrap, 30), 1, 1e-5) << wrap;
    EXPECT_NEAR(slope_at("repeat", 0), (1.0 / 64 - 63.0 / 64) * 64 / 2, 1e-4);
    EXPECT_NEAR(slope_at("clamp", 0), 0.5, 1e-5);
    EXPECT_NEAR(slope_at("mirror", 63), 0.5, 1e-5);
}

TEST_F(HeightToNormal, MistakesHaveReasonsAndLeaveNoFile) {
    const std::string map = heights("map.exr", prep::PixelType::f32, 1, 0);
    ASSERT_TRUE(prep::save_image(dir_ / "there.png",
                                 {.width = 1, .height = 1, .channels = 3, .pixels = {0, 0, 0}}));
    test::write_text(dir_ / "text.png", "no picture");
    struct Row {
        std::vector<std::string> words;
        int code;
        const char* says;
    };
    const std::string out = (dir_ / "out.png").string();
    for (const Row& row :
         {Row{{(dir_ / "none.png").string(), "-o", out}, 1, "none.png"},
          Row{{(dir_ / "text.png").string(), "-o", out}, 1, "text.png"},
          Row{{map, "-o", (dir_ / "out.xyz").string()}, 1, "xyz"},
          Row{{map, "-o", (dir_ / "out.exr").string(), "--bits", "8"}, 1, "bits"},
          Row{{map, "-o", (dir_ / "out.jpg").string(), "--bits", "16"}, 1, "bits"},
          Row{{map, "-o", out, "--height-channel", "3"}, 1, "channel"},
          Row{{map, "-o", map}, 1, "over the heights"},
          Row{{map, "-o", (dir_ / "there.png").string(), "--no-overwrite"}, 1, "exists"},
          Row{{map, "-o", out, "--size", "0"}, 2, "--size"},
          Row{{map, "-o", out, "--size", "1,2,3"}, 2, "--size"},
          Row{{map, "-o", out, "--strength", "much"}, 2, "much"},
          Row{{map, "-o", out, "--bits", "12"}, 2, "--bits"}, Row{{map}, 2, "--output"}}) {
        std::vector<std::string> words{"height-to-normal"};
        words.insert(words.end(), row.words.begin(), row.words.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, row.code) << row.says << ": " << ran.err;
        EXPECT_NE(ran.err.find(row.says), std::string::npos) << ran.err;
        EXPECT_FALSE(std::filesystem::exists(out)) << row.says;
        EXPECT_FALSE(std::filesystem::exists(dir_ / "out.exr"));
    }
    EXPECT_EQ(prep::load_image(map)->channels, 1U);
}

}  // namespace
