// The command from outside: exit codes, streams, files.
#include <gtest/gtest.h>

#include <cmath>

#include "command_runner.h"
#include "prep/load.h"
#include "shared_data.h"

namespace {

using test::file_text;
using test::run_command;
using test::TempDir;
using test::write_text;

TEST(Command, HelpAndVersionGoToStandardOutput) {
    const test::Ran help = run_command({"--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.out.find("prepare"), std::string::npos);
    EXPECT_EQ(help.err, "");
    for (const char* name : {"prepare", "inspect", "render", "validate", "cost", "diff"}) {
        const test::Ran sub = run_command({name, "--help"});
        EXPECT_EQ(sub.exit_code, 0) << name;
        EXPECT_NE(sub.out.find("Examples:"), std::string::npos) << name;
        EXPECT_NE(sub.out.find("--json"), std::string::npos) << name;
        EXPECT_NE(sub.out.find("--threads"), std::string::npos) << name;
        EXPECT_NE(sub.out.find("--quiet"), std::string::npos) << name;
    }
    const test::Ran version = run_command({"--version"});
    EXPECT_EQ(version.exit_code, 0);
    EXPECT_EQ(version.out.rfind("meshprep ", 0), 0u);
    EXPECT_NE(version.out.find("OpenImageIO"), std::string::npos);
    EXPECT_NE(version.out.find("Apache-2.0"), std::string::npos);
}

TEST(Command, UsageErrorsExitTwo) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const std::string cube = (dir / "cube.obj").string();
    const std::vector<std::vector<std::string>> wrong = {
        {},
        {"bake"},
        {"prepare"},
        {"prepare", cube},
        {"prepare", cube, "-o", "x.glb", "--weight", "heavy"},
        {"prepare", cube, "-o", "x.glb", "--hard-angle", "200"},
        {"prepare", cube, "-o", "x.glb", "--hard-angle", "sixty"},
        {"prepare", cube, "-o", "x.glb", "--hard-borders", "uv,edges"},
        {"prepare", cube, "-o", "x.glb", "--in-place"},
        {"prepare", cube, "-o", (dir / "x.fbx").string()},
        {"prepare", cube, "-o", (dir / "x").string()},
        {"prepare", cube, "-o", (dir / "x.glb").string(), "--ascii"},
        {"prepare", cube, "-o", (dir / "x.glb").string(), "--format", "ply"},
        {"prepare", cube, "--in-place", "--format", "ply"},
        {"prepare", cube, "-o", cube},
        {"render", cube},
        {"render", cube, "-o", (dir / "x.zzz").string()},
        {"render", cube, "-o", (dir / "x").string()},
        {"render", cube, "-o", cube},
        {"render", cube, "-o", "x.png", "--size", "30000x10", "--supersample", "4"},
        {"render", cube, "-o", "x.png", "--size", "0x10"},
        {"render", cube, "-o", "x.png", "--size", "10x"},
        {"render", cube, "-o", "x.png", "--camera", "10,99"},
        {"render", cube, "-o", "x.png", "--background", "red"},
        {"render", cube, "-o", "x.png", "--light", "1"},
        {"render", cube, "-o", "x.png", "--exposure", "nan"},
        {"render", cube, "-o", "x.png", "--ambient", "nan"},
        {"validate", cube},
        {"inspect"},
        {"diff", cube},
        {"inspect", cube, "--threads", "-1"},
    };
    for (const auto& arguments : wrong) {
        const test::Ran ran = run_command(arguments);
        std::string line;
        for (const std::string& a : arguments) line += a + " ";
        EXPECT_EQ(ran.exit_code, 2) << line;
        EXPECT_EQ(ran.out, "") << line;
        EXPECT_NE(ran.err, "") << line;
    }
    EXPECT_EQ(dir.names(), std::vector<std::string>{"cube.obj"});
}

std::string gltf_with_positions(const std::string& base64, const std::string& node) {
    return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[)" + node +
           R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
           R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)"
           R"("min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
           R"("buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)" +
           base64 + R"("}]})";
}

// (0,0,0) (1,0,0) (0,1,0), and three times NaN.
const std::string triangle_base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
const std::string nan_base64 = "AADAfwAAwH8AAMB/AADAfwAAwH8AAMB/AADAfwAAwH8AAMB/";

// "--gate $GATE" of a variable that is not set must not pass everything.
TEST(Command, AnEmptyValueIsNoneAtAll) {
    const TempDir dir;
    write_text(dir / "a.obj", test::cube_obj());
    const std::string a = (dir / "a.obj").string(), out = (dir / "a.glb").string();
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"diff", a, a, "--gate", ""},
                                               {"diff", a, a, "--report", ""},
                                               {"prepare", a, "-o", out, "--manifest", ""},
                                               {"prepare", a, "-o", out, "--for", ""},
                                               {"prepare", a, "-o", out, "--hard-borders", ""},
                                               {"prepare", a, "-o", out, "--allow-extension", ""},
                                               {"prepare", a, "-o", ""},
                                               {"prepare", "", "-o", out},
                                               {"inspect", ""}}) {
        const test::Ran ran = test::run_here(words);
        EXPECT_EQ(ran.exit_code, 2) << words[0] << ' ' << words[words.size() - 2];
        EXPECT_NE(ran.err.find("is empty"), std::string::npos) << ran.err;
    }
    EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(Command, WhatFollowsTwoDashesIsAFile) {
    const TempDir dir;
    std::filesystem::create_directory(dir / "out");
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(dir.path());
    write_text("-d.obj", test::cube_obj());
    write_text("a.obj", test::cube_obj());
    const test::Ran two = test::run_here({"prepare", "-o", "out/", "a.obj", "--", "-d.obj"});
    const test::Ran one = test::run_here({"inspect", "--json", "--", "-d.obj"});
    // No file by itself, and no value.
    const test::Ran none = test::run_here({"--"});
    const test::Ran value = test::run_here({"prepare", "a.obj", "-o", "--", "b.obj"});
    std::filesystem::current_path(before);
    EXPECT_EQ(none.exit_code, 2);
    EXPECT_EQ(value.exit_code, 2);
    EXPECT_NE(value.err.find("--output: needs a value"), std::string::npos) << value.err;
    EXPECT_FALSE(std::filesystem::exists(dir / "--"));
    EXPECT_EQ(two.exit_code, 0) << two.err;
    EXPECT_TRUE(std::filesystem::exists(dir / "out/-d.glb"));
    EXPECT_TRUE(std::filesystem::exists(dir / "out/a.glb"));
    EXPECT_EQ(one.exit_code, 0) << one.err;
}

TEST(Command, AnUnknownSubcommandIsNamedWithThoseThatAre) {
    const test::Ran ran = run_command({"bake"});
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_NE(ran.err.find("'bake' is no subcommand; there are prepare, inspect"),
              std::string::npos)
        << ran.err;
}

TEST(Prepare, APrimitiveWithoutAFiniteTriangleStopsNoBatch) {
    const TempDir dir;
    write_text(dir / "nan.gltf", gltf_with_positions(nan_base64, R"({"mesh":0})"));
    write_text(dir / "z.obj", test::cube_obj());
    const test::Ran ran = run_command({"prepare", (dir / "nan.gltf").string(),
                                       (dir / "z.obj").string(), "-o", (dir / "out").string()});
    // It is written as it was, which is told; the batch goes on and is good.
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_NE(ran.err.find("nan.glb: primitives without a triangle of finite positions were left"),
              std::string::npos)
        << ran.err;
    EXPECT_NE(ran.out.find("2 files: 2 ok, 0 failed, 1 with warnings"), std::string::npos)
        << ran.out;
    const auto left = prep::load_scene(dir / "out/nan.glb");
    ASSERT_TRUE(left.has_value());
    ASSERT_EQ(left->meshes.at(0).positions.size(), 3u);
    for (const glm::vec3& p : left->meshes[0].positions) EXPECT_TRUE(std::isnan(p.x));
    const auto cube = prep::load_scene(dir / "out/z.glb");
    ASSERT_TRUE(cube.has_value());
    EXPECT_EQ(cube->meshes.at(0).face_count(), 12u);
}

TEST(Prepare, MirroredNodesKeepTheirFrontInEveryFormat) {
    const TempDir dir;
    write_text(dir / "in.gltf",
               gltf_with_positions(triangle_base64, R"({"mesh":0,"scale":[-1,1,1]})"));
    for (const char* name : {"o.obj", "o.ply", "o.off", "o.stl"}) {
        const std::string out = (dir / name).string();
        ASSERT_EQ(run_command({"prepare", (dir / "in.gltf").string(), "-o", out}).exit_code, 0);
        const auto scene = prep::load_scene(out);
        ASSERT_TRUE(scene.has_value()) << name;
        const prep::Mesh& mesh = scene->meshes.at(0);
        const auto at = [&mesh](std::size_t c) { return mesh.positions[mesh.corner_vertices[c]]; };
        EXPECT_GT(glm::cross(at(1) - at(0), at(2) - at(0)).z, 0) << name;
    }
}

TEST(Prepare, GltfNamesAreEncodedAndReadBackFromTheirOwnDirectory) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const std::string out = (dir / "50%20 off#1.gltf").string();
    ASSERT_EQ(run_command({"prepare", (dir / "cube.obj").string(), "-o", out}).exit_code, 0);
    EXPECT_EQ(run_command({"inspect", out}).exit_code, 0);
    const auto here = std::filesystem::current_path();
    std::filesystem::current_path(dir.path());
    const test::Ran bare = run_command({"inspect", "50%20 off#1.gltf"});
    std::filesystem::current_path(here);
    EXPECT_EQ(bare.exit_code, 0) << bare.err;
}

TEST(Prepare, FilesBesideTheOutputAreGuardedToo) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    write_text(dir / "c.bin", "precious");
    const std::string cube = (dir / "cube.obj").string();
    EXPECT_EQ(
        run_command({"prepare", cube, "-o", (dir / "c.gltf").string(), "--no-overwrite"}).exit_code,
        1);
    EXPECT_EQ(file_text(dir / "c.bin"), "precious");
    EXPECT_FALSE(std::filesystem::exists(dir / "c.gltf"));

    write_text(dir / "lib.mtl", "newmtl red\nKd 1 0 0\n");
    write_text(dir / "a.obj", "mtllib lib.mtl\nusemtl red\n" + test::cube_obj());
    const std::string mtl = file_text(dir / "lib.mtl");
    EXPECT_EQ(run_command({"prepare", (dir / "a.obj").string(), "-o", (dir / "lib.obj").string()})
                  .exit_code,
              1);
    EXPECT_EQ(file_text(dir / "lib.mtl"), mtl);
}

TEST(Prepare, LinksAreFollowed) {
    const TempDir dir;
    write_text(dir / "real.obj", test::cube_obj());
    std::filesystem::create_symlink("real.obj", dir / "link.obj");
    const std::string link = (dir / "link.obj").string();
    ASSERT_EQ(run_command({"prepare", link, "--in-place"}).exit_code, 0);
    EXPECT_TRUE(std::filesystem::is_symlink(dir / "link.obj"));
    EXPECT_NE(file_text(dir / "real.obj"), test::cube_obj());
    // Also where it leads to nothing yet, by way of another.
    std::filesystem::create_directory(dir / "sub");
    std::filesystem::create_symlink("sub/next.ply", dir / "first.ply");
    std::filesystem::create_symlink(dir / "fresh.ply", dir / "sub/next.ply");
    const test::Ran ran =
        run_command({"prepare", (dir / "real.obj").string(), "-o", (dir / "first.ply").string()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_TRUE(std::filesystem::is_symlink(dir / "first.ply"));
    EXPECT_TRUE(std::filesystem::is_symlink(dir / "sub/next.ply"));
    EXPECT_TRUE(
        std::filesystem::is_regular_file(std::filesystem::symlink_status(dir / "fresh.ply")));
}

TEST(Command, MissingInputsExitOneAndSaySo) {
    const TempDir dir;
    const std::string none = (dir / "none.obj").string();
    for (const std::vector<std::string>& arguments :
         std::vector<std::vector<std::string>>{{"prepare", none, "-o", (dir / "x.glb").string()},
                                               {"inspect", none},
                                               {"render", none, "-o", (dir / "x.png").string()},
                                               {"validate", none, "-o", (dir / "sheets").string()},
                                               {"diff", none, none}}) {
        const test::Ran ran = run_command(arguments);
        EXPECT_EQ(ran.exit_code, 1) << arguments[0];
        EXPECT_NE(ran.err.find(none), std::string::npos) << arguments[0] << ran.err;
        EXPECT_EQ(ran.out, "") << arguments[0];
    }
    EXPECT_TRUE(dir.names().empty());
}

TEST(Prepare, SeveralInputsDoNotMakeADirectoryOutOfAMeshsName) {
    const TempDir dir;
    write_text(dir / "a.obj", test::cube_obj());
    write_text(dir / "b.obj", test::cube_obj());
    const std::vector<std::string> inputs{"prepare", (dir / "a.obj").string(),
                                          (dir / "b.obj").string(), "-o"};
    const auto run = [&](const std::string& output) {
        std::vector<std::string> words = inputs;
        words.push_back((dir / output).string() + (output.back() == '/' ? "/" : ""));
        return run_command(words);
    };
    const test::Ran one = run("x.glb");
    EXPECT_EQ(one.exit_code, 2) << one.err;
    EXPECT_NE(one.err.find("several inputs need a directory"), std::string::npos) << one.err;
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"a.obj", "b.obj"}));
    EXPECT_EQ(run("x.glb/").exit_code, 0);
    EXPECT_EQ(run("out").exit_code, 0);
    EXPECT_TRUE(std::filesystem::is_regular_file(dir / "x.glb/b.glb"));
    EXPECT_TRUE(std::filesystem::is_regular_file(dir / "out/a.glb"));
}

TEST(Prepare, CountsBeforeAndAfterAreThoseOfTheFiles) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const test::Ran ran = run_command(
        {"prepare", (dir / "cube.obj").string(), "-o", (dir / "cube.glb").string(), "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const nlohmann::json json = ran.json();
    ASSERT_TRUE(json.is_object());
    EXPECT_EQ(json["command"], "prepare");
    const nlohmann::json& file = json["files"][0];
    EXPECT_EQ(file["status"], "ok");
    EXPECT_EQ(file["before"]["vertices"], 8);
    EXPECT_EQ(file["before"]["faces"], 6);
    // A 90° cube at 60°: every corner splits in three, 16 more vertices than before.
    EXPECT_EQ(file["after"]["vertices"], 24);
    EXPECT_EQ(file["after"]["triangles"], 12);
    EXPECT_EQ(file["splits"]["hard_edge"], 16);
    EXPECT_EQ(file["gltf_after"]["meshes"], 1);
    // What was written is what is said.
    const prep::Result<prep::Scene> written = prep::load_scene(dir / "cube.glb");
    ASSERT_TRUE(written);
    ASSERT_EQ(written->meshes.size(), 1u);
    EXPECT_EQ(written->meshes[0].vertex_count(), 24u);
    EXPECT_EQ(written->meshes[0].face_count(), 12u);
}

// What has no nodes holds a mesh twice that two of them show.
TEST(Prepare, CountsAreThoseOfFlattenedFiles) {
    const TempDir dir;
    write_text(dir / "cube.obj", "mtllib cube.mtl\nusemtl a\n" + test::cube_obj());
    write_text(dir / "cube.mtl", "newmtl a\nKd 1 0 0\n");
    ASSERT_EQ(
        run_command({"prepare", (dir / "cube.obj").string(), "-o", (dir / "cube.gltf").string()})
            .exit_code,
        0);
    nlohmann::json document = nlohmann::json::parse(test::file_text(dir / "cube.gltf"));
    document["nodes"].push_back({{"mesh", 0}, {"translation", {5, 0, 0}}});
    document["scenes"][0]["nodes"].push_back(document["nodes"].size() - 1);
    write_text(dir / "two.gltf", document.dump());
    for (const char* ending : {"obj", "ply", "stl", "gltf"}) {
        const auto out = dir / (std::string("out.") + ending);
        const test::Ran ran =
            run_command({"prepare", (dir / "two.gltf").string(), "-o", out.string(), "--json"});
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        const nlohmann::json after = ran.json()["files"][0]["after"];
        const auto read = prep::load_scene(out);
        ASSERT_TRUE(read) << ending;
        EXPECT_EQ(after["triangles"], std::string(ending) == "gltf" ? 12 : 24) << ending;
        std::size_t triangles = 0;
        for (const prep::Mesh& mesh : read->meshes)
            triangles += mesh.corner_count() - 2 * mesh.face_count();
        EXPECT_EQ(after["triangles"], triangles) << ending;
        EXPECT_EQ(after["materials"], read->materials.size()) << ending;
    }
}

TEST(Prepare, TellsTheBytesReadAndWritten) {
    const TempDir dir;
    write_text(dir / "cube.obj", "mtllib cube.mtl\n" + test::cube_obj());
    write_text(dir / "cube.mtl", "newmtl a\nKd 1 0 0\n");
    std::vector<std::string> line = {"prepare", (dir / "cube.obj").string(), "-o",
                                     (dir / "cube.gltf").string()};
    const std::string said = run_command(line).out;
    line.push_back("--json");
    const test::Ran ran = run_command(line);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const nlohmann::json bytes = ran.json()["files"][0]["bytes"];
    const auto size = [&](const char* name) { return std::filesystem::file_size(dir / name); };
    EXPECT_EQ(bytes["input"], size("cube.obj") + size("cube.mtl"));
    EXPECT_EQ(bytes["output"], size("cube.gltf") + size("cube.bin"));
    EXPECT_NE(said.find("  bytes "), std::string::npos) << said;
}

TEST(Prepare, OptionsReachTheStages) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const auto vertices = [&](const std::vector<std::string>& extra) {
        std::vector<std::string> arguments = {"prepare", (dir / "cube.obj").string(), "-o",
                                              (dir / "cube.glb").string(), "--json"};
        arguments.insert(arguments.end(), extra.begin(), extra.end());
        return run_command(arguments).json()["files"][0]["after"]["vertices"].get<int>();
    };
    EXPECT_EQ(vertices({}), 24);
    EXPECT_EQ(vertices({"--hard-angle", "off"}), 8);
    EXPECT_EQ(vertices({"--hard-angle", "90"}), 8);  // exactly at the threshold stays smooth
    EXPECT_EQ(vertices({"--hard-angle", "89.99"}), 24);
}

TEST(Prepare, ExplainTellsEveryStageWithItsReason) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const test::Ran ran = run_command(
        {"prepare", (dir / "cube.obj").string(), "-o", (dir / "cube.ply").string(), "--explain"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_NE(ran.out.find("normals"), std::string::npos);
    EXPECT_NE(ran.out.find("skipped"), std::string::npos);
    EXPECT_NE(ran.out.find("no material in use has a tangent-space normal map"), std::string::npos);
    EXPECT_NE(ran.out.find(" ms"), std::string::npos);
}

TEST(Prepare, OneBadFileStopsNoOther) {
    const TempDir dir;
    write_text(dir / "a.obj", test::cube_obj());
    write_text(dir / "b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    write_text(dir / "c.obj", test::sphere_obj(8, 4));
    const test::Ran ran =
        run_command({"prepare", (dir / "a.obj").string(), (dir / "b.obj").string(),
                     (dir / "c.obj").string(), "-o", (dir / "out").string()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("b.obj:4"), std::string::npos) << ran.err;
    EXPECT_NE(ran.out.find("3 files: 2 ok, 1 failed"), std::string::npos) << ran.out;
    EXPECT_TRUE(std::filesystem::exists(dir / "out/a.glb"));
    EXPECT_FALSE(std::filesystem::exists(dir / "out/b.glb"));
    EXPECT_TRUE(std::filesystem::exists(dir / "out/c.glb"));
}

TEST(Prepare, DirectoriesKeepTheirTreeWithRecursive) {
    const TempDir dir;
    std::filesystem::create_directories(dir / "in/sub/deep");
    write_text(dir / "in/a.obj", test::cube_obj());
    write_text(dir / "in/sub/a.obj", test::cube_obj());
    write_text(dir / "in/sub/deep/b.obj", test::cube_obj());
    write_text(dir / "in/readme.txt", "no mesh");
    ASSERT_EQ(
        run_command({"prepare", (dir / "in").string(), "-o", (dir / "flat").string()}).exit_code,
        0);
    EXPECT_TRUE(std::filesystem::exists(dir / "flat/a.glb"));
    EXPECT_FALSE(std::filesystem::exists(dir / "flat/sub"));
    ASSERT_EQ(run_command({"prepare", (dir / "in").string(), "-r", "-o", (dir / "tree").string(),
                           "--format", "ply"})
                  .exit_code,
              0);
    for (const char* name : {"a.ply", "sub/a.ply", "sub/deep/b.ply"})
        EXPECT_TRUE(std::filesystem::exists(dir / (std::string("tree/") + name))) << name;
}

// An avatar is a GLB of another ending: what is read by name is found in a directory, too.
TEST(Prepare, DirectoriesAreReadForEveryEndingOfAFormat) {
    const TempDir dir;
    std::filesystem::create_directories(dir / "in");
    write_text(dir / "cube.obj", test::cube_obj());
    ASSERT_EQ(run_command({"prepare", (dir / "cube.obj").string(), "-o", (dir / "c.glb").string()})
                  .exit_code,
              0);
    std::filesystem::rename(dir / "c.glb", dir / "in/avatar.VRM");
    write_text(dir / "in/settings.json", "{}");
    const test::Ran ran = run_command(
        {"prepare", (dir / "in").string(), "-o", (dir / "out/").string(), "--format", "obj"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_TRUE(std::filesystem::exists(dir / "out/avatar.obj"));
    EXPECT_FALSE(std::filesystem::exists(dir / "out/settings.obj"));
}

TEST(Prepare, AFailedRunLeavesTheOldFileAsItWas) {
    const TempDir dir;
    write_text(dir / "bad.obj", "v 0 0 0\nf 1 2 3\n");
    write_text(dir / "old.glb", "the old file");
    const test::Ran ran =
        run_command({"prepare", (dir / "bad.obj").string(), "-o", (dir / "old.glb").string()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_EQ(file_text(dir / "old.glb"), "the old file");
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"bad.obj", "old.glb"}));
}

TEST(Prepare, WritesOverItsInputOnlyInPlace) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const std::string path = (dir / "cube.obj").string();
    EXPECT_EQ(
        run_command({"prepare", path, "-o", dir.path().string(), "--format", "obj"}).exit_code, 2);
    EXPECT_EQ(file_text(dir / "cube.obj"), test::cube_obj());
    EXPECT_EQ(run_command({"prepare", path, "--in-place"}).exit_code, 0);
    EXPECT_NE(file_text(dir / "cube.obj").find("vn "), std::string::npos);
}

TEST(Prepare, KeepsExistingOutputWithNoOverwrite) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    write_text(dir / "cube.glb", "the old file");
    EXPECT_EQ(run_command({"prepare", (dir / "cube.obj").string(), "-o",
                           (dir / "cube.glb").string(), "--no-overwrite"})
                  .exit_code,
              1);
    EXPECT_EQ(file_text(dir / "cube.glb"), "the old file");
}

TEST(Prepare, QuietSaysNothingButErrors) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const test::Ran good = run_command(
        {"prepare", (dir / "cube.obj").string(), "-o", (dir / "cube.glb").string(), "--quiet"});
    EXPECT_EQ(good.exit_code, 0);
    EXPECT_EQ(good.out + good.err, "");
    const test::Ran bad = run_command(
        {"prepare", (dir / "none.obj").string(), "-o", (dir / "x.glb").string(), "--quiet"});
    EXPECT_EQ(bad.exit_code, 1);
    EXPECT_EQ(bad.out, "");
    EXPECT_NE(bad.err, "");
}

TEST(Prepare, WritesTheSameBytesForAnyThreadCount) {
    const TempDir dir;
    write_text(dir / "ball.obj", test::sphere_obj(48, 24));
    std::string first;
    for (const char* threads : {"1", "2", "3", "8"}) {
        ASSERT_EQ(
            run_command({"prepare", (dir / "ball.obj").string(), "-o", (dir / "ball.glb").string(),
                         "--tangents", "mikktspace", "--threads", threads})
                .exit_code,
            0);
        const std::string bytes = file_text(dir / "ball.glb");
        ASSERT_FALSE(bytes.empty());
        if (first.empty()) first = bytes;
        EXPECT_EQ(bytes, first) << threads;
    }
}

TEST(Inspect, TellsContentAndFindings) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const test::Ran ran = run_command({"inspect", (dir / "cube.obj").string(), "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const nlohmann::json file = ran.json()["files"][0];
    EXPECT_EQ(file["meshes"][0]["quads"], 6);
    EXPECT_EQ(file["meshes"][0]["closed"], true);
    EXPECT_EQ(file["meshes"][0]["genus"], 0);
    EXPECT_EQ(file["meshes"][0]["volume"], 1.0);
    EXPECT_TRUE(file["findings"].empty()) << file["findings"].dump();
}

TEST(Inspect, StrictFailsOnWarnings) {
    const TempDir dir;
    // Three faces on one edge.
    write_text(dir / "fan.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
    const std::string path = (dir / "fan.obj").string();
    const test::Ran lenient = run_command({"inspect", path});
    EXPECT_EQ(lenient.exit_code, 0);
    EXPECT_NE(lenient.out.find("non-manifold-edge"), std::string::npos) << lenient.out;
    EXPECT_EQ(run_command({"inspect", path, "--strict", "--quiet"}).exit_code, 1);
    write_text(dir / "cube.obj", test::cube_obj());
    EXPECT_EQ(run_command({"inspect", (dir / "cube.obj").string(), "--strict"}).exit_code, 0);
}

TEST(Json, IsValidOnSuccessAndOnFailure) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    write_text(dir / "bad\xff.obj", "v 0 0 0\nf 1 2 3\n");
    const std::string cube = (dir / "cube.obj").string(), bad = (dir / "bad\xff.obj").string();
    const std::string none = (dir / "none.obj").string();
    for (const std::string& input : {cube, bad, none}) {
        for (std::vector<std::string> arguments : std::vector<std::vector<std::string>>{
                 {"prepare", input, "-o", (dir / "x.glb").string()},
                 {"inspect", input},
                 {"render", input, "-o", (dir / "x.png").string(), "--size", "32x32"},
                 {"validate", input, "-o", (dir / "sheets").string(), "--panel", "64"},
                 {"diff", input, (dir / "x.glb").string()}}) {
            arguments.push_back("--json");
            const test::Ran ran = run_command(arguments);
            const nlohmann::json json = ran.json();
            EXPECT_TRUE(json.is_object()) << arguments[0] << " " << input << "\n" << ran.out;
            EXPECT_EQ(json.value("command", ""), arguments[0]);
        }
    }
}

}  // namespace
