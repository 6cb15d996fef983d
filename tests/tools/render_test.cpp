// `meshprep render` from outside.
#include <gtest/gtest.h>

#include <set>

#include "command_runner.h"
#include "prep/image.h"
#include "shared_data.h"

namespace {

using test::file_text;
using test::run_here;
using test::TempDir;
using test::write_text;

// A textured plane seen at a slant, so that filters differ.
std::string slanted_floor(const std::string& picture) {
    return R"({"meshprep": 1,
  "textures": {"brick": {"file": "brick.png"}},
  "materials": {"floor": {"diffuse_map": "brick"}},
  "meshes": {"floor": {"shape": {"kind": "plane", "size": [8, 1, 8]}, "material": "floor"}},
  "camera": {"orbit": {"elevation": 8}},
  "picture": )" +
           picture + "}";
}

TEST(Render, SceneFilesTakeEveryFilterWordOfTheCommandLine) {
    const TempDir dir;
    std::filesystem::copy_file(test::source_dir() / "samples/room/brick_color.png",
                               dir / "brick.png");
    write_text(dir / "plain.json", slanted_floor(R"({"size": [96, 64]})"));
    std::set<std::string> pictures;
    for (const std::string word : {"nearest", "bilinear", "nearest-mip", "trilinear", "bicubic",
                                   "anisotropic", "ripmap", "ewa"}) {
        SCOPED_TRACE(word);
        write_text(dir / "scene.json",
                   slanted_floor(R"({"size": [96, 64], "filter": ")" + word + "\"}"));
        const test::Ran by_file = run_here({"render", (dir / "scene.json").string(), "-o",
                                            (dir / "by_file.png").string(), "--quiet"});
        ASSERT_EQ(by_file.exit_code, 0) << by_file.err;
        const test::Ran by_option =
            run_here({"render", (dir / "plain.json").string(), "-o",
                      (dir / "by_option.png").string(), "--filter", word, "--quiet"});
        ASSERT_EQ(by_option.exit_code, 0) << by_option.err;
        const std::string bytes = file_text(dir / "by_file.png");
        EXPECT_EQ(bytes, file_text(dir / "by_option.png"));
        pictures.insert(bytes);
    }
    EXPECT_EQ(pictures.size(), 8u);
}

TEST(Render, TexturesAreReadAsTheirSamplersAskUnlessAFilterIsAskedFor) {
    const TempDir dir;
    std::filesystem::copy_file(test::source_dir() / "samples/room/brick_color.png",
                               dir / "brick.png");
    const auto draw = [&](const std::string& sampler, const std::vector<std::string>& options) {
        std::string scene = slanted_floor(R"({"size": [96, 64]})");
        scene.insert(scene.find(R"("brick.png")") + 11, sampler);
        write_text(dir / "scene.json", scene);
        std::vector<std::string> words{"render", (dir / "scene.json").string(), "-o",
                                       (dir / "out.png").string(), "--quiet"};
        words.insert(words.end(), options.begin(), options.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return file_text(dir / "out.png");
    };
    const std::string nearest = R"(, "mag": "nearest", "min": "nearest", "mip": "none")";
    EXPECT_EQ(draw(nearest, {}), draw("", {"--filter", "nearest"}));
    EXPECT_EQ(draw(nearest, {"--filter", "ewa"}), draw("", {"--filter", "ewa"}));
    EXPECT_EQ(draw(R"(, "mip": "none")", {}), draw("", {"--filter", "bilinear"}));
    EXPECT_EQ(draw(R"(, "mip": "nearest")", {}), draw("", {"--filter", "nearest-mip"}));
    EXPECT_EQ(draw("", {}), draw("", {"--filter", "trilinear"}));
}

TEST(Render, SceneFilesAskForTheSameAsOptionsAndTheOptionsWin) {
    const TempDir dir;
    std::filesystem::copy_file(test::source_dir() / "samples/room/brick_color.png",
                               dir / "brick.png");
    write_text(dir / "plain.json", slanted_floor(R"({"size": [96, 64]})"));
    const auto draw = [&](const std::string& scene, const std::vector<std::string>& options) {
        std::vector<std::string> words{"render", (dir / scene).string(), "-o",
                                       (dir / "out.png").string(), "--quiet"};
        words.insert(words.end(), options.begin(), options.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return file_text(dir / "out.png");
    };
    struct Case {
        std::string keys;
        std::vector<std::string> same, plain;  // options; those that undo the keys
    };
    const std::string before = draw("plain.json", {});
    for (const Case& c :
         {Case{R"("samples": 8)", {"--samples", "8"}, {"--samples", "1"}},
          Case{R"("coverage": "area")", {"--coverage", "area"}, {"--coverage", "samples"}},
          Case{R"("supersample": 3)", {"--supersample", "3"}, {"--supersample", "1"}},
          Case{R"("filter": "ewa", "max_anisotropy": 2)",
               {"--filter", "ewa", "--max-anisotropy", "2"},
               {"--filter", "trilinear"}},
          Case{R"("exposure": 0.5)", {"--exposure", "0.5"}, {"--exposure", "1"}}}) {
        SCOPED_TRACE(c.keys);
        write_text(dir / "scene.json", slanted_floor(R"({"size": [96, 64], )" + c.keys + "}"));
        const std::string by_option = draw("plain.json", c.same);
        EXPECT_NE(by_option, before);
        EXPECT_EQ(draw("scene.json", {}), by_option);
        EXPECT_EQ(draw("scene.json", c.plain), before);
    }
    // Samples and exact areas exclude each other: what the option says goes.
    write_text(dir / "scene.json", slanted_floor(R"({"size": [96, 64], "samples": 8})"));
    EXPECT_EQ(draw("scene.json", {"--coverage", "area"}),
              draw("plain.json", {"--coverage", "area"}));
    write_text(dir / "scene.json", slanted_floor(R"({"size": [96, 64], "coverage": "area"})"));
    EXPECT_EQ(draw("scene.json", {"--samples", "4"}), draw("plain.json", {"--samples", "4"}));
}

// A picture of linear light, drawn as a texture, gives the same light again.
TEST(Render, FloatTexturesAreLinearLight) {
    const TempDir dir;
    const std::string tail = R"("meshes": {"p": {"shape": {"kind": "plane"}, "material": "m"}},
  "camera": {"position": [0, 2, 0], "target": [0, 0, 0], "up": [0, 0, -1], "height": 0.5},
  "picture": {"size": [16, 16]}})";
    write_text(dir / "plain.json",
               R"({"meshprep": 1, "materials": {"m": {"diffuse": [0.25, 0.5, 0.75],
  "unlit": true}}, )" +
                   tail);
    write_text(dir / "mapped.json",
               R"({"meshprep": 1, "textures": {"t": {"file": "plain.exr"}}, "materials": {"m":
  {"diffuse": 1, "diffuse_map": "t", "unlit": true}}, )" +
                   tail);
    for (const std::string name : {"plain", "mapped"}) {
        const test::Ran ran = run_here({"render", (dir / (name + ".json")).string(), "-o",
                                        (dir / (name + ".exr")).string(), "--quiet"});
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
    }
    // The colour of the file, by value: 0.25 read as sRGB would be 0.05.
    for (const char* name : {"plain.exr", "mapped.exr"}) {
        const auto image = prep::load_image(dir / name);
        ASSERT_TRUE(image) << name;
        const float* middle = image->at(8, 8);
        EXPECT_NEAR(middle[0], 0.25, 1e-3) << name;  // half a step of a half at 0.25 is 1e-4
        EXPECT_NEAR(middle[1], 0.5, 1e-3) << name;
        EXPECT_NEAR(middle[2], 0.75, 1e-3) << name;
    }
}

TEST(Render, WhatIsNotDrawnIsTold) {
    const TempDir dir;
    std::filesystem::copy_file(test::source_dir() / "samples/room/brick_color.png",
                               dir / "brick.png");
    write_text(dir / "scene.json", R"({"meshprep": 1,
  "textures": {"t": {"file": "brick.png", "mag": "nearest"}},
  "materials": {"m": {"diffuse_map": "t", "bump_map": "t", "displacement_map": "t"}},
  "meshes": {"p": {"shape": {"kind": "plane"}, "material": "m"}},
  "picture": {"size": [16, 16], "tone_map": "reinhard"}})");
    const auto warnings = [&](const std::string& output, const std::vector<std::string>& more) {
        std::vector<std::string> words{"render", (dir / "scene.json").string(), "-o",
                                       (dir / output).string()};
        words.insert(words.end(), more.begin(), more.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.err;
    };
    const std::string linear = warnings("a.exr", {});
    for (const char* text :
         {"displacement map, which is not drawn", "tone_map is for pictures of 8 bits"})
        EXPECT_NE(linear.find(text), std::string::npos) << text << "\n" << linear;
    EXPECT_EQ(linear.find("bump map"), std::string::npos) << linear;
    const std::string chosen = warnings("a.png", {});
    EXPECT_EQ(chosen.find("tone_map"), std::string::npos) << chosen;
}

// The page's examples are scenes as they stand.
TEST(Render, DrawsTheExamplesOfTheSceneFormatPage) {
    const std::string page = file_text(test::source_dir() / "docs/scene-format.md");
    const std::string open = "```json\n";
    const TempDir dir;
    std::size_t examples = 0;
    for (std::size_t at = page.find(open); at != std::string::npos; at = page.find(open, at)) {
        at += open.size();
        write_text(dir / "scene.json", page.substr(at, page.find("```", at) - at));
        const test::Ran ran =
            run_here({"render", (dir / "scene.json").string(), "-o", (dir / "scene.png").string(),
                      "--size", "160x90", "--quiet"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        ++examples;
    }
    EXPECT_EQ(examples, 2u);
}

}  // namespace
