// What displacement and tessellation refuse: usage errors, errors of files, and what would be lost.
#include <gtest/gtest.h>

#include "command_runner.h"
#include "prep/image.h"

namespace {

using test::run_here;
using test::TempDir;
using test::write_text;

const std::string quad =
    "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";

class DisplaceRefusals : public testing::Test {
  protected:
    // A map of floats that are 1.
    std::string white(const std::string& name) {
        const prep::Image image{
            .width = 2, .height = 2, .channels = 1, .pixels = std::vector<float>(4, 1.0f)};
        const auto saved = prep::save_image(dir_ / name, image, prep::PixelType::f32);
        EXPECT_TRUE(saved) << to_string(saved.error());
        return (dir_ / name).string();
    }
    test::Ran run(const std::string& obj, std::vector<std::string> options) {
        write_text(dir_ / "cage.obj", obj);
        options.insert(options.begin(), {"prepare", (dir_ / "cage.obj").string(), "-o",
                                         (dir_ / "out.obj").string(), "--json"});
        return run_here(options);
    }
    TempDir dir_;
};

TEST_F(DisplaceRefusals, MistakesAreUsageErrors) {
    const std::string some = white("some.exr");
    struct Row {
        std::vector<std::string> options;
        const char* says;
    };
    for (const Row& row :
         {Row{{"--displace", "missing.png"}, "missing.png"},
          Row{{"--height-scale", "1"}, "works only together with --displace"},
          Row{{"--height-channel", "1"}, "works only together with --displace"},
          Row{{"--displace-kind", "vector-object"}, "works only together with --displace"},
          Row{{"--displace", some, "--height-scale", "much"}, "much"},
          Row{{"--displace", some, "--height-filter", "cubic"}, "bicubic"},
          Row{{"--displace", some, "--displace-kind", "vector"}, "vector-object"},
          Row{{"--displace", some, "--displace-axes", "tangent-normal-bitangent"},
              "vector-tangent"},
          Row{{"--displace", "noise", "--displace-axes", "tangent-normal-bitangent"},
              "--displace-axes"},
          Row{{"--displace", some, "--displace-kind", "vector-tangent", "--displace-axes",
               "object"},
              "tangent-bitangent-normal"},
          Row{{"--band-limit", "0.1", "--chord-error", "1"}, "--displace"},
          Row{{"--displace", some, "--band-limit", "0"}, "--band-limit"},
          Row{{"--displace", some, "--band-limit", "fine"}, "fine"},
          Row{{"--noise", "simplex"}, "--displace"},
          Row{{"--displace", "noise", "--noise", "worley"}, "simplex"},
          Row{{"--displace", "noise", "--noise-octaves", "0"}, "--noise-octaves"},
          Row{{"--displace", "noise", "--noise-octaves", "2,2,2,2"}, "--noise-octaves"},
          Row{{"--displace", "noise", "--noise-seed", "-1"}, "--noise-seed"},
          Row{{"--displace", "noise", "--height-scale", "2"}, "--height-scale"},
          Row{{"--height-midlevel", "0", "--displace", "noise"}, "--height-midlevel"},
          Row{{"--displace", "noise", "--height-filter", "bicubic"},
              "error: --height-filter: says how a map is read"},
          Row{{"--subdivide", "catmark:3", "--chord-error", "0.1"}, "a level of --subdivide"},
          Row{{"--subdivide", "catmark:2", "--chord-error", "0.1"},
              "--chord-error: cannot stand beside a level of --subdivide"},
          Row{{"--edge-length", "0.1", "--subdivide", "loop:2"}, "a level of --subdivide"},
          Row{{"--subdivide", "catmark", "--control-points", "--displace", some},
              "--displace: cannot stand beside --control-points"},
          Row{{"--subdivide", "catmark", "--face-varying", "all", "--edge-length", "1"},
              "--edge-length: cannot stand beside --face-varying"},
          Row{{"--subdivide", "catmark", "--max-influences", "2", "--max-triangles", "9"},
              "--max-triangles: cannot stand beside --max-influences"},
          Row{{"--subdivide", "loop:1", "--residual-normal-map", "8"}, "a level of --subdivide"},
          Row{{"--displace", "noise", "--height-channel", "1"}, "--height-channel"},
          Row{{"--displace", "noise", "--displace-kind", "vector-object"}, "--displace-kind"},
          Row{{"--displace", "materials", "--displace-kind", "vector-object"}, "--displace-kind"},
          Row{{"--noise-scale", "2", "--displace", "materials"}, "materials"},
          Row{{"--chord-error", "0"}, "--chord-error"},
          Row{{"--edge-length", "-1"}, "--edge-length"},
          Row{{"--max-triangles", "12q"}, "12q"},
          Row{{"--max-triangles", "0"}, "--max-triangles"}}) {
        const test::Ran out = run(quad, row.options);
        EXPECT_EQ(out.exit_code, 2) << row.options[0];
        EXPECT_NE(out.err.find(row.says), std::string::npos) << out.err;
    }
}

// Material libraries stay as they are there: they would ask for the displacement once more, or at
// the old scale, and hold no residual map.
TEST_F(DisplaceRefusals, InPlaceObjIsNotMovedByWhatAsksForItAgain) {
    white("up.exr");
    write_text(dir_ / "a.mtl", "newmtl raised\ndisp up.exr\n");
    const std::string text = "mtllib a.mtl\nusemtl raised\n" + quad;
    const std::string file = (dir_ / "a.obj").string();
    write_text(file, text);
    for (const std::vector<std::string>& options :
         {std::vector<std::string>{"--displace", "materials"},
          std::vector<std::string>{"--displace", "noise", "--residual-normal-map", "8"},
          std::vector<std::string>{"--scale", "2"}}) {
        std::vector<std::string> words{"prepare", file, "--in-place"};
        words.insert(words.end(), options.begin(), options.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_NE(ran.err.find("in place OBJ keeps its material libraries"), std::string::npos)
            << ran.err;
        EXPECT_EQ(test::file_text(file), text);
    }
    // Without a library it gets one of its own.
    const std::string alone = (dir_ / "alone.obj").string();
    write_text(alone, quad);
    const test::Ran own = run_here(
        {"prepare", alone, "--in-place", "--displace", "noise", "--residual-normal-map", "8"});
    EXPECT_EQ(own.exit_code, 0) << own.err;
    EXPECT_NE(test::file_text(alone).find("mtllib"), std::string::npos);
    // What no library says is done, and what has none to do.
    EXPECT_EQ(run_here({"prepare", file, "--in-place", "--displace", "noise"}).exit_code, 0);
    write_text(dir_ / "a.mtl", "newmtl raised\n");
    write_text(file, text);
    EXPECT_EQ(run_here({"prepare", file, "--in-place", "--displace", "materials"}).exit_code, 0);
}

TEST_F(DisplaceRefusals, WhatCannotBeDoneIsTheFilesError) {
    const std::string some = white("some.exr");
    test::GltfText nameless;
    nameless.add({"", {0, 0, 0, 1, 0, 0, 0, 1, 0}, {}, {}, {}, {0, 1, 2}, "", ""});
    write_text(dir_ / "bare.gltf", nameless.text());
    const std::string bare = (dir_ / "bare.gltf").string();
    const test::Ran unnamed = run_here(
        {"prepare", bare, "-o", (dir_ / "bare.glb").string(), "--displace", some, "--quiet"});
    EXPECT_EQ(unnamed.exit_code, 1);
    EXPECT_NE(unnamed.err.find("error: " + bare + ": mesh '"), std::string::npos) << unnamed.err;
    const test::Ran no_uvs = run("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", {"--displace", some});
    EXPECT_EQ(no_uvs.exit_code, 1);
    EXPECT_NE(no_uvs.err.find("UV"), std::string::npos) << no_uvs.err;
    write_text(dir_ / "text.png", "this is no picture");
    const test::Ran no_picture = run(quad, {"--displace", (dir_ / "text.png").string()});
    EXPECT_EQ(no_picture.exit_code, 1);
    EXPECT_NE(no_picture.err.find("text.png"), std::string::npos) << no_picture.err;
    const test::Ran too_fine = run(quad, {"--displace", some, "--chord-error", "1e-12"});
    EXPECT_EQ(too_fine.exit_code, 1);
    const test::Ran channel = run(quad, {"--displace", some, "--height-channel", "3"});
    EXPECT_EQ(channel.exit_code, 1);
    EXPECT_NE(channel.err.find("channel"), std::string::npos) << channel.err;
    EXPECT_FALSE(std::filesystem::exists(dir_ / "out.obj"));
}

}  // namespace
