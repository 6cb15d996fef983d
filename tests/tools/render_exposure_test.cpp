// Exposure that is found, black pictures and what lies behind the scene, from outside.
#include <gtest/gtest.h>

#include <cmath>

#include "command_runner.h"
#include "prep/image.h"

namespace {

using test::file_text;
using test::run_here;
using test::TempDir;
using test::write_text;

// A square that faces +z, of albedo 0.5 or black, under a light of so many lux from in front.
std::string lit_square(double lux, bool black = false) {
    test::GltfText gltf;
    gltf.add({.name = "square",
              .positions = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0},
              .normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1},
              .uvs = {},
              .tangents = {},
              .indices = {0, 1, 2, 0, 2, 3},
              .more = R"("material":0)",
              .node = R"("extensions":{"KHR_lights_punctual":{"light":0}})"});
    const std::string grey = black ? "0,0,0" : "0.5,0.5,0.5";
    return gltf.text(
        R"("extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":)"
        R"([{"type":"directional","intensity":)" +
        std::to_string(lux) + R"(}]}},"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[)" +
        grey + R"(,1],"metallicFactor":0,"roughnessFactor":1}}])");
}

struct Picture {
    test::Ran ran;
    std::string bytes;
    prep::Image image;
    // Of the pixel at this share of the width and height, as 8 bits.
    int at(double x, double y, std::size_t channel) const {
        const float v = image.at(std::uint32_t(x * (image.width - 1)),
                                 std::uint32_t(y * (image.height - 1)))[channel];
        return int(std::lround(v * 255));
    }
};

Picture draw(const std::filesystem::path& input, const std::filesystem::path& output,
             const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"render", input.string(), "-o",       output.string(),
                                       "--size", "96x96",        "--camera", "0,0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Picture picture;
    picture.ran = run_here(arguments);
    EXPECT_EQ(picture.ran.exit_code, 0) << picture.ran.err;
    picture.bytes = file_text(output);
    picture.image = prep::load_image(output).value();
    return picture;
}

std::size_t where(const std::string& text, const std::string& part) {
    return text.find(part);
}

TEST(RenderExposure, IsFoundForFilesThatBringLightsAndIsTold) {
    const TempDir dir;
    write_text(dir / "lamp.gltf", lit_square(40000));
    const Picture found = draw(dir / "lamp.gltf", dir / "a.png");
    EXPECT_NE(where(found.ran.out, "exposure "), std::string::npos) << found.ran.out;
    const Picture json = draw(dir / "lamp.gltf", dir / "b.png", {"--json"});
    const double exposure = json.ran.json()["exposure"]["value"];
    EXPECT_GT(exposure, 0);
    EXPECT_LT(exposure, 1e-3);
    EXPECT_NEAR(exposure * double(json.ran.json()["exposure"]["bright"]), 0.8, 0.005);
    // 0.8 in sRGB is 231 of 255; and by hand it is the same picture.
    EXPECT_NEAR(found.at(0.5, 0.5, 1), 231, 3);
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", exposure);
    const Picture hand = draw(dir / "lamp.gltf", dir / "c.png", {"--exposure", text});
    EXPECT_EQ(hand.bytes, found.bytes);
    // Lights that fit are left alone: to the bit what exposure 1 gives.
    write_text(dir / "fit.gltf", lit_square(1.5));
    EXPECT_EQ(draw(dir / "fit.gltf", dir / "d.png").bytes,
              draw(dir / "fit.gltf", dir / "e.png", {"--exposure", "1"}).bytes);
}

// Linear 0.2159 is 128 in sRGB, in front of any exposure.
TEST(RenderExposure, LightsNothingBehindTheScene) {
    const TempDir dir;
    write_text(dir / "lamp.gltf", lit_square(3));
    for (const char* exposure : {"auto", "0.01", "1", "7"}) {
        const Picture picture = draw(dir / "lamp.gltf", dir / "a.png",
                                     {"--exposure", exposure, "--background", "#808080"});
        EXPECT_EQ(picture.at(0, 0, 0), 128) << exposure;
    }
}

TEST(RenderExposure, CropsShareIt) {
    const TempDir dir;
    write_text(dir / "lamp.gltf", lit_square(300));
    const Picture whole = draw(dir / "lamp.gltf", dir / "whole.png");
    const Picture part = draw(dir / "lamp.gltf", dir / "part.png", {"--crop", "0,0,20x96"});
    for (std::uint32_t y = 0; y < 96; y += 5)
        for (std::uint32_t x = 0; x < 20; x += 3)
            for (std::uint32_t k = 0; k < 3; ++k)
                ASSERT_EQ(part.image.at(x, y)[k], whole.image.at(x, y)[k]) << x << ", " << y;
}

TEST(RenderExposure, OfSceneFilesIsOneUnlessTheyAskForIt) {
    const TempDir dir;
    const auto scene = [](const std::string& picture) {
        return R"({"meshprep": 1, "materials": {"m": {"diffuse": [0.5, 0.5, 0.5], "specular": [0, 0, 0]}},
  "meshes": {"floor": {"shape": {"kind": "sphere"}, "material": "m"}},
  "lights": [{"kind": "directional", "intensity": 500, "direction": [0, 0, -1]}],
  "picture": )" +
               picture + "}";
    };
    write_text(dir / "plain.json", scene("{}"));
    write_text(dir / "asks.json", scene(R"({"exposure": "auto"})"));
    const auto drawn = [&](const std::string& name) {
        const test::Ran ran =
            run_here({"render", (dir / (name + ".json")).string(), "-o",
                      (dir / (name + ".png")).string(), "--size", "64x64", "--json"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.json();
    };
    EXPECT_FALSE(drawn("plain").contains("exposure"));
    EXPECT_LT(drawn("asks")["exposure"]["value"], 0.1);
    EXPECT_NE(file_text(dir / "plain.png"), file_text(dir / "asks.png"));
}

TEST(RenderExposure, BlackPicturesSayWhy) {
    const TempDir dir;
    write_text(dir / "dim.gltf", lit_square(1e-4));
    const Picture dim = draw(dir / "dim.gltf", dir / "a.png", {"--exposure", "1"});
    EXPECT_NE(where(dim.ran.err, "100 % of the pixels that show a surface are black: the lights"),
              std::string::npos)
        << dim.ran.err;
    EXPECT_EQ(where(draw(dir / "dim.gltf", dir / "b.png").ran.err, "are black"), std::string::npos);
    write_text(dir / "soot.gltf", lit_square(1, true));
    // Without its light's highlight, which even black has.
    const Picture soot = draw(dir / "soot.gltf", dir / "c.png", {"--exposure", "0.001"});
    EXPECT_NE(where(soot.ran.err, "are black: the materials' colours are black"), std::string::npos)
        << soot.ran.err;
}

TEST(RenderExposure, ASlateLiesBehindFilesAndBlackBehindScenes) {
    const TempDir dir;
    for (const double lux : {1.0, 40000.0}) {
        write_text(dir / "lamp.gltf", lit_square(lux));
        const Picture file = draw(dir / "lamp.gltf", dir / "a.png");
        // 0.10, 0.13, 0.16 linear, as sRGB, whatever the exposure.
        EXPECT_NEAR(file.at(0, 0, 0), 89, 1) << lux;
        EXPECT_NEAR(file.at(0, 0, 1), 101, 1) << lux;
        EXPECT_NEAR(file.at(0, 0, 2), 111, 1) << lux;
    }
    const Picture other = draw(dir / "lamp.gltf", dir / "b.png", {"--background", "#ff0000"});
    EXPECT_EQ(other.at(0, 0, 0), 255);
    EXPECT_EQ(other.at(0, 0, 2), 0);
    write_text(dir / "scene.json",
               R"({"meshprep": 1, "meshes": {"ball": {"shape": {"kind": "sphere"}}}})");
    EXPECT_EQ(draw(dir / "scene.json", dir / "c.png").at(0, 0, 1), 0);
}

}  // namespace
