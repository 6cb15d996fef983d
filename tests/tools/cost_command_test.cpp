// `meshprep cost` from outside: what it says, writes and refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "command_runner.h"

namespace {

using nlohmann::json;
using test::file_text;
using test::run_here;
using test::TempDir;
using test::write_text;

std::vector<std::string> quick(std::vector<std::string> more) {
    more.insert(more.begin(), {"cost", "--threads", "1", "--rounds", "3"});
    return more;
}

TEST(Cost, SaysTheSameInEveryForm) {
    const TempDir dir;
    const std::string page = (dir / "out/page.html").string(), csv = (dir / "t.csv").string(),
                      svg = (dir / "plots").string();
    const test::Ran ran = run_here(quick({"--ladder", "normal-weight,hard-angle", "--json", "-o",
                                          page, "--csv", csv, "--svg", svg, "--png", svg}));
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json document = ran.json();
    ASSERT_EQ(document["ladders"].size(), 2u);
    EXPECT_EQ(document["ladders"][0]["name"], "normal-weight");
    EXPECT_EQ(document["threads"], 1);
    for (const json& ladder : document["ladders"]) {
        EXPECT_EQ(ladder["control_seconds"].size(), 3u);
        for (const json& rung : ladder["rungs"]) EXPECT_EQ(rung["seconds"].size(), 3u);
    }
    // From the JSON alone the same bytes again.
    write_text(dir / "times.json", ran.out);
    const std::string page2 = (dir / "page2.html").string(), csv2 = (dir / "2.csv").string(),
                      svg2 = (dir / "plots2").string();
    const test::Ran again = run_here({"cost", "--from", (dir / "times.json").string(), "-o", page2,
                                      "--csv", csv2, "--svg", svg2, "--png", svg2, "--json"});
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(again.out, ran.out);
    EXPECT_EQ(file_text(page2), file_text(page));
    EXPECT_EQ(file_text(csv2), file_text(csv));
    for (const char* name :
         {"normal-weight.svg", "hard-angle.svg", "normal-weight.png", "hard-angle.png"})
        EXPECT_EQ(file_text(dir / "plots2" / name), file_text(dir / "plots" / name)) << name;
    // In words: a table for each ladder.
    const test::Ran words = run_here({"cost", "--from", (dir / "times.json").string()});
    EXPECT_NE(words.out.find("Weights of normals: a jittered torus"), std::string::npos);
    EXPECT_NE(words.out.find("edge-length"), std::string::npos);
    EXPECT_EQ(run_here({"cost", "--from", (dir / "times.json").string(), "-q"}).out, "");
}

TEST(Cost, TriesWhatItCanOnMeshesThatAreGiven) {
    const TempDir dir;
    write_text(dir / "ball.obj", test::sphere_obj(24, 12));
    write_text(dir / "cube.obj", test::cube_obj());
    const test::Ran ran =
        run_here(quick({(dir / "ball.obj").string(), (dir / "cube.obj").string(), "--ladder",
                        "normal-precision,depth-format", "--json", "--svg", (dir / "s").string()}));
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json document = ran.json();
    ASSERT_EQ(document["ladders"].size(), 3u);
    EXPECT_EQ(document["ladders"][0]["subject"].get<std::string>().rfind("ball.obj", 0), 0u);
    EXPECT_EQ(document["ladders"][1]["subject"].get<std::string>().rfind("cube.obj", 0), 0u);
    EXPECT_EQ(document["ladders"][2]["name"], "depth-format");
    EXPECT_TRUE(std::filesystem::exists(dir / "s/normal-precision.svg"));
    EXPECT_TRUE(std::filesystem::exists(dir / "s/normal-precision-2.svg"));
}

// Errors are the stages' own: the same bytes on any threads.
// A scene is drawn as `render` draws it: its errors, from the files that render writes.
TEST(Cost, ScenesAreThoseThatRenderDraws) {
    const TempDir dir;
    write_text(dir / "ball.obj", test::sphere_obj(24, 12));
    write_text(dir / "scene.json",
               R"({"meshprep": 1,
 "materials": {"red": {"diffuse": [0.8, 0.1, 0.1], "specular": 0.4}},
 "meshes": {"ball": {"file": "ball.obj", "material": "red"},
            "floor": {"shape": {"kind": "plane", "size": [9, 1, 9]}}},
 "nodes": [{"mesh": "ball"}, {"mesh": "floor", "translate": [0, -1, 0]}, {"mesh": "ball", "translate": [1.2, 0.5, -0.7]}],
 "lights": [{"kind": "directional", "direction": [-1, -1, -0.5], "intensity": 0.9}],
 "camera": {"orbit": {"azimuth": 20, "elevation": 75, "distance": 0.25}},
 "picture": {"background": "#204060", "size": [640, 360]}})");
    const std::string scene = (dir / "scene.json").string();
    const test::Ran ran = run_here(quick({scene, "--ladder", "scene-sampling", "--json"}));
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json ladder = ran.json()["ladders"][0];
    EXPECT_NE(ladder["subject"].get<std::string>().find("scene.json, its camera"),
              std::string::npos);
    const auto drawn = [&](const std::string& name, const std::vector<std::string>& more) {
        std::vector<std::string> words = {"render", scene,    "-o", (dir / name).string(),
                                          "--size", "160x120"};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(run_here(words).exit_code, 0);
        return (dir / name).string();
    };
    const std::string truth = drawn("truth.exr", {"--supersample", "16"});
    for (const json& rung : ladder["rungs"]) {
        std::vector<std::string> more;
        std::istringstream words(rung["command"].get<std::string>());
        for (std::string word; words >> word;)
            if (word != "render") more.push_back(word);
        const json apart =
            run_here({"diff", drawn("rung.exr", more), truth, "--json"}).json()["differences"][0];
        // Files of halves, with an alpha that is 1 everywhere.
        const double rmse = apart["rmse"].get<double>() * std::sqrt(4.0 / 3);
        EXPECT_NEAR(rung["errors"][0].get<double>() / rmse, 1, 0.02) << rung["name"];
    }
    EXPECT_GT(ladder["rungs"][0]["errors"][0].get<double>(), 0.003);
}

TEST(Cost, ErrorsDependOnNoThreads) {
    const auto errors = [](const char* threads) {
        const test::Ran ran =
            run_here({"cost", "--threads", threads, "--rounds", "1", "--ladder",
                      "normal-weight,hard-angle,tangent-mode,depth-format", "--json"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        json all = json::array();
        const json document = ran.json();
        for (const json& ladder : document["ladders"])
            for (const json& rung : ladder["rungs"]) all.push_back(rung["errors"]);
        return all;
    };
    const json one = errors("1");
    EXPECT_GE(one.size(), 18u);
    EXPECT_EQ(one, errors("3"));
}

TEST(Cost, ListsItsLadders) {
    const test::Ran words = run_here({"cost", "--list"});
    EXPECT_EQ(words.exit_code, 0);
    const json document = run_here({"cost", "--list", "--json"}).json();
    ASSERT_GE(document["known"].size(), 10u);
    std::size_t grids = 0;
    for (const json& ladder : document["known"]) {
        EXPECT_NE(words.out.find(ladder["name"].get<std::string>()), std::string::npos);
        grids += ladder["grid"].get<bool>();
    }
    EXPECT_EQ(grids, 5u);
    std::size_t told = 0;
    for (std::size_t at = 0; (at = words.out.find(" grid\n", at)) != std::string::npos; ++at)
        ++told;
    EXPECT_EQ(told, grids);
}

// A grid runs as ladders do, and says both settings.
TEST(Cost, GridsRunLikeLadders) {
    const TempDir dir;
    const test::Ran ran = run_here(quick({"--ladder", "weight-by-precision", "--json", "--csv",
                                          (dir / "g.csv").string(), "--svg", dir.path().string()}));
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json ladder = ran.json()["ladders"][0];
    ASSERT_EQ(ladder["grid"].size(), 2u);
    EXPECT_EQ(ladder["grid"][0]["name"], "weight");
    EXPECT_EQ(ladder["rungs"].size(), 15u);
    EXPECT_EQ(ladder["rungs"][4]["name"], "uniform, accurate");
    EXPECT_NE(ladder["rungs"][4]["command"].get<std::string>().find(
                  "--weight uniform --hard-angle off --precision accurate"),
              std::string::npos);
    EXPECT_NE(file_text(dir / "weight-by-precision.svg").find("class=\"series\""),
              std::string::npos);
    EXPECT_NE(file_text(dir / "g.csv").find(",weight,uniform,precision,accurate\r\n"),
              std::string::npos);
}

TEST(Cost, RefusesWhatMakesNoSense) {
    const TempDir dir;
    const test::Ran unknown = run_here({"cost", "--ladder", "normal-wieght"});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_NE(unknown.err.find("did you mean 'normal-weight'?"), std::string::npos) << unknown.err;
    EXPECT_EQ(run_here({"cost", "--ladder", ""}).exit_code, 2);
    EXPECT_EQ(run_here({"cost", "--ladder", "depth-format,"}).exit_code, 2);
    EXPECT_EQ(run_here({"cost", "--rounds", "0"}).exit_code, 2);
    EXPECT_EQ(run_here({"cost", "--seconds", "nan"}).exit_code, 2);
    EXPECT_EQ(run_here({"cost", "--from", "x.json", "mesh.obj"}).exit_code, 2);
    EXPECT_EQ(run_here({"cost", "--from", "x.json", "--list"}).exit_code, 2);
    // Options that nothing would follow.
    for (const char* idle : {"--rounds", "--seconds", "--threads"})
        EXPECT_EQ(run_here({"cost", "--from", "x.json", idle, "9"}).exit_code, 2) << idle;
    write_text(dir / "cube.obj", test::cube_obj());
    const test::Ran idle =
        run_here({"cost", (dir / "cube.obj").string(), "--ladder", "depth-format"});
    EXPECT_EQ(idle.exit_code, 2);
    EXPECT_NE(idle.err.find("none of these ladders is tried on files"), std::string::npos);
}

// Outputs that are inputs, two outputs in one file, standard output: said before anything is read
// or measured, and nothing is written.
TEST(Cost, KeepsFilesApart) {
    const TempDir dir;
    const std::string mesh = (dir / "scan.obj").string(), times = (dir / "t.json").string();
    write_text(mesh, test::cube_obj());
    const test::Ran ran = run_here(quick({"--ladder", "normal-weight", "--json"}));
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    write_text(times, ran.out);
    std::filesystem::create_symlink(times, dir / "link.html");
    const std::string page = (dir / "x.html").string();
    const std::vector<std::pair<std::vector<std::string>, const char*>> refused = {
        {{mesh, "-o", mesh}, "also an input"},
        {{mesh, "--csv", (dir / "." / "scan.obj").string()}, "also an input"},
        {{"--from", times, "-o", times}, "also an input"},
        {{"--from", times, "-o", (dir / "link.html").string()}, "also an input"},
        {{"--from", times, "-o", page, "--csv", page}, "two outputs"},
        {{"--from", times, "-o", (dir / "p/normal-weight.svg").string(), "--svg",
          (dir / "p").string()},
         "two outputs"},
        {{"--from", times, "-o", "-"}, "standard output"},
        {{"--from", times, "--csv", "-"}, "standard output"}};
    for (auto [words, text] : refused) {
        words.insert(words.begin(), "cost");
        const test::Ran one = run_here(words);
        EXPECT_EQ(one.exit_code, 1) << words.back();
        EXPECT_NE(one.err.find(text), std::string::npos) << one.err;
    }
    EXPECT_EQ(file_text(mesh), test::cube_obj());
    EXPECT_EQ(file_text(times), ran.out);
    EXPECT_FALSE(std::filesystem::exists(page));
    EXPECT_FALSE(std::filesystem::exists(dir / "p"));
    EXPECT_FALSE(std::filesystem::exists("-"));
}

// A mesh of one face without area has no normal to judge; what else there is stays.
TEST(Cost, OneLadderThatFailsLeavesTheOthers) {
    const TempDir dir;
    write_text(dir / "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    const std::string csv = (dir / "t.csv").string();
    const test::Ran ran =
        run_here({"cost", (dir / "flat.obj").string(), "--threads", "1", "--rounds", "1",
                  "--ladder", "normal-precision,normal-weight", "--json", "--csv", csv});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("no normals that can be judged"), std::string::npos) << ran.err;
    const json document = ran.json();
    ASSERT_EQ(document["ladders"].size(), 1u);
    EXPECT_EQ(document["ladders"][0]["name"], "normal-weight");
    ASSERT_EQ(document["failed"].size(), 1u);
    EXPECT_EQ(document["failed"][0]["ladder"], "normal-precision");
    EXPECT_EQ(document["failed"][0]["subject"], "flat.obj");
    EXPECT_NE(file_text(csv).find("normal-weight"), std::string::npos);
}

TEST(Cost, NeedsNoTemporaryDirectory) {
    const TempDir dir;
    const test::Circumstances nowhere{.environment = {{"TMPDIR", (dir / "none").string()}}};
    const test::Ran ran = test::run_command(
        {"cost", "--threads", "1", "--rounds", "1", "--ladder", "quantized-uvs", "--json"},
        nowhere);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(ran.json()["ladders"].size(), 1u);
}

// Minutes of measuring are not lost to a file that cannot be written.
TEST(Cost, WhatCannotBeWrittenIsStillShown) {
    const TempDir dir;
    std::filesystem::create_directories(dir / "plots/normal-weight.svg");
    const test::Ran ran =
        run_here(quick({"--ladder", "normal-weight", "--json", "--svg", (dir / "plots").string()}));
    EXPECT_EQ(ran.exit_code, 1);
    const json document = ran.json();
    EXPECT_EQ(document["ladders"].size(), 1u);
    EXPECT_TRUE(document["error"].is_object());
    const test::Ran words =
        run_here(quick({"--ladder", "normal-weight", "--svg", (dir / "plots").string()}));
    EXPECT_NE(words.out.find("edge-length"), std::string::npos);
}

TEST(Cost, FailsWithoutATrace) {
    const TempDir dir;
    write_text(dir / "bad.obj", "v 0 0 0\nf 1 2 9\n");
    write_text(dir / "points.obj", "v 0 0 0\nv 1 0 0\np 1 2\n");
    write_text(dir / "times.json", "{\"command\":\"cost\"}");
    const std::string page = (dir / "o/page.html").string(), csv = (dir / "o/x.csv").string();
    const std::vector<std::vector<std::string>> failing = {
        {(dir / "none.obj").string()},
        {(dir / "bad.obj").string()},
        {(dir / "points.obj").string()},
        {"--from", (dir / "none.json").string()},
        {"--from", (dir / "times.json").string()}};
    for (std::vector<std::string> words : failing) {
        if (words[0] != "--from") words.insert(words.begin(), {"--rounds", "1"});
        words.insert(words.begin(), {"cost", "--json", "-o", page, "--csv", csv});
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 1) << words.back();
        EXPECT_NE(ran.err.find("meshprep: error: "), std::string::npos) << words.back();
        EXPECT_TRUE(ran.json()["error"].is_object()) << words.back();
        EXPECT_FALSE(std::filesystem::exists(dir / "o")) << words.back();
    }
    // Places that cannot be written: said before anything is measured.
    write_text(dir / "file", "x");
    std::filesystem::create_directory(dir / "page.html");
    for (const std::string& place :
         {(dir / "file/page.html").string(), (dir / "page.html").string()}) {
        const test::Ran blocked = run_here({"cost", "-o", place});
        EXPECT_EQ(blocked.exit_code, 1) << place;
        EXPECT_NE(blocked.err.find("in the way"), std::string::npos) << blocked.err;
    }
    EXPECT_EQ(file_text(dir / "file"), "x");
}

}  // namespace
