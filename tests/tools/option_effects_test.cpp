// Options do what they say wherever they are taken, and are refused where they would do nothing.
#include <gtest/gtest.h>

#include "command_runner.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::file_text;
using test::run_here;
using test::TempDir;
using test::write_text;

// What the reader met counts like what the check found.
TEST(OptionEffects, StrictInspectionFailsOnWarningsOfTheReader) {
    const TempDir dir;
    const std::string sound = (dir / "cube.obj").string(), odd = (dir / "odd.obj").string();
    write_text(sound, test::cube_obj());
    write_text(odd, "mtllib none.mtl\n" + test::cube_obj());
    for (const bool strict : {false, true}) {
        std::vector<std::string> words{"inspect", odd, sound, "--json"};
        if (strict) words.emplace_back("--strict");
        const test::Ran ran = run_here(words);
        const json document = ran.json();
        ASSERT_EQ(document["files"][0]["warnings"].size(), 1u) << ran.out;
        for (const json& finding : document["files"][0]["findings"])
            ASSERT_EQ(finding["severity"], "info");
        EXPECT_EQ(document["summary"]["with_warnings"], 1);
        EXPECT_EQ(ran.exit_code, strict ? 1 : 0);
    }
    EXPECT_EQ(run_here({"inspect", sound, "--strict"}).exit_code, 0);
}

TEST(OptionEffects, AListOfLaddersWritesNoFiles) {
    const TempDir dir;
    for (const char* const option : {"-o", "--csv", "--svg", "--png"}) {
        const std::string to = (dir / "out.html").string();
        const test::Ran ran = run_here({"cost", "--list", option, to});
        EXPECT_EQ(ran.exit_code, 2) << option;
        EXPECT_NE(ran.err.find("--list: measures nothing; it takes no -o"), std::string::npos)
            << ran.err;
        EXPECT_EQ(ran.out, "") << option;
    }
    for (const std::vector<std::string>& unused : {std::vector<std::string>{"x.obj"},
                                                   {"--rounds", "5"},
                                                   {"--seconds", "3"},
                                                   {"--threads", "1"}}) {
        std::vector<std::string> words{"cost", "--list"};
        words.insert(words.end(), unused.begin(), unused.end());
        EXPECT_EQ(run_here(words).exit_code, 2) << unused[0];
    }
    EXPECT_EQ(run_here({"cost", "--list"}).exit_code, 0);
}

// What requires an extension that nobody knows is described all the same.
TEST(OptionEffects, InspectionTakesNoLeaveForExtensions) {
    const TempDir dir;
    const std::string file = (dir / "a.gltf").string();
    test::GltfText gltf;
    gltf.add({"a", {0, 0, 0, 1, 0, 0, 0, 1, 0}, {}, {}, {}, {0, 1, 2}, "", ""});
    write_text(file, gltf.text(R"("extensionsUsed":["VENDOR_new"],)"
                               R"("extensionsRequired":["VENDOR_new"])"));
    const std::string out = (dir / "a.glb").string();
    EXPECT_EQ(run_here({"prepare", file, "-o", out}).exit_code, 1);
    EXPECT_EQ(run_here({"prepare", file, "-o", out, "--allow-extension", "all"}).exit_code, 0);
    EXPECT_EQ(run_here({"inspect", file}).exit_code, 0);
    EXPECT_EQ(run_here({"inspect", file, "--allow-extension", "all"}).exit_code, 2);
}

// What is printed can be typed, and gives the same bytes.
TEST(OptionEffects, TheSameAgainIsACommandThatRuns) {
    const TempDir dir;
    const std::string in = (dir / "cube.obj").string(), picture = (dir / "a.png").string();
    write_text(in, test::cube_obj());
    const std::vector<std::vector<std::string>> lines{
        {"prepare", in, "-o", "-", "--format", "ply", "--budget-ms", "100000"},
        {"prepare", in, "-o", (dir / "out/").string(), "--format", "ply", "--no-overwrite",
         "--budget-ms", "100000"},
        {"render", in, "-o", picture, "--size", "32x32", "--no-overwrite", "--image-error", "255"},
        {"prepare", in, "--in-place", "--budget-ms", "100000"}};
    for (const std::vector<std::string>& words : lines) {
        const std::string before = file_text(in);
        const test::Ran ran = test::run_command(words);
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        const auto results = [&] {
            std::string bytes;
            for (const fs::path& file : {dir / "out/cube.ply", dir / "a.png", dir / "cube.obj"})
                bytes += file_text(file) + "|";
            return bytes;
        };
        const std::string written = results();
        // What is said goes where the bytes do not.
        const std::string said = ran.out + ran.err, label = "the same again: meshprep ";
        const std::size_t at = said.find(label), end = said.find('\n', at);
        ASSERT_NE(at, std::string::npos) << said;
        const std::string again = "'" + test::command_path().string() + "' " +
                                  said.substr(at + label.size(), end - at - label.size());
        write_text(in, before);
        const test::Ran same = test::run_program("/bin/sh", {"-c", again});
        EXPECT_EQ(same.exit_code, 0) << again << same.err;
        EXPECT_EQ(results(), written) << again;
        if (words[3] == "-") {
            EXPECT_EQ(same.out, ran.out) << again;
        }
    }
}

TEST(OptionEffects, WhatIsNotDrawnIsSaidInSentences) {
    const TempDir dir;
    const std::string picture = (dir / "a.png").string();
    const auto said = [&](const std::string& name, const std::string& text) {
        write_text(dir / name, text);
        const test::Ran ran =
            run_here({"render", (dir / name).string(), "-o", picture, "--size", "8x8"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.err;
    };
    const auto has = [](const std::string& text, const std::string& part) {
        return text.find("warning: " + part) != std::string::npos;
    };
    const std::string lines = said("lines.obj", test::cube_obj() + "l 1 2 3\n");
    EXPECT_TRUE(has(lines, "2 line segments are not drawn, only")) << lines;
    const std::string point = said("point.obj", test::cube_obj() + "p 1\n");
    EXPECT_TRUE(has(point, "1 point is not drawn, only")) << point;
    test::GltfText gltf;
    for (int n = 0; n < 3; ++n)
        gltf.add({"a",
                  {0, 0, 0, 1, 0, 0, 0, 1, 0},
                  {},
                  {0, 0, 1, 0, 0, 1},
                  {},
                  {0, 1, 2},
                  "\"material\":0",
                  "\"skin\":0"});
    const std::string skinned =
        said("skinned.gltf",
             gltf.text(
                 R"("skins":[{"joints":[0]}],"textures":[{"source":0}],"images":[{"uri":"x.png"}],)"
                 R"("materials":[{"name":"m","extensions":{"KHR_materials_anisotropy":)"
                 R"({"anisotropyStrength":0.5,"anisotropyTexture":{"index":0}}}}],)"
                 R"("extensionsUsed":["KHR_materials_anisotropy"])"));
    EXPECT_TRUE(has(skinned, "3 skinned meshes are drawn as modelled")) << skinned;
    EXPECT_TRUE(has(skinned, "material 'm' has an anisotropy map")) << skinned;
}

}  // namespace
