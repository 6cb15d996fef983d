// `meshprep diff --gate`, `--views`, `--report` and `--flip` from outside.
#include <gtest/gtest.h>

#include <cmath>

#include "command_runner.h"
#include "prep/image.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;
using test::write_text;

class GateCommand : public ::testing::Test {
  protected:
    GateCommand() {
        write_text(dir_ / "ball.obj", test::sphere_obj(16, 8));
        EXPECT_EQ(run_here({"prepare", at("ball.obj"), "-o", at("a.ply"), "--quiet"}).exit_code, 0);
        write_text(dir_ / "gate.json", "{\"gate\": 1}");
    }
    std::string at(const std::string& name) const { return (dir_ / name).string(); }
    // The measure of this name.
    static json measure(const test::Ran& ran, const std::string& name) {
        const json document = ran.json();
        if (!document.contains("differences")) return {};
        for (const json& m : document["differences"][0]["measures"])
            if (m["name"] == name) return m;
        return {};
    }
    test::Ran gated(const std::string& text) {
        write_text(dir_ / "g.json", text);
        return run_here({"diff", at("a.ply"), at("a.ply"), "--gate", at("g.json"), "--json"});
    }
    TempDir dir_;
};

TEST_F(GateCommand, ExitCodesAreThoseOfDiff) {
    EXPECT_EQ(run_here({"diff", at("a.ply"), at("a.ply"), "--gate", at("gate.json")}).exit_code, 0);
    // Another weight turns normals: told, and 1 only with a gate or a tolerance.
    ASSERT_EQ(
        run_here({"prepare", at("ball.obj"), "-o", at("b.ply"), "--weight", "uniform", "--quiet"})
            .exit_code,
        0);
    const std::vector<std::string> both = {"diff", at("a.ply"), at("b.ply")};
    const auto with = [&](std::vector<std::string> more) {
        std::vector<std::string> words = both;
        words.insert(words.end(), more.begin(), more.end());
        return run_here(words);
    };
    const test::Ran bare = with({"--views", "0"});
    EXPECT_EQ(bare.exit_code, 0) << bare.err;
    EXPECT_NE(bare.out.find("BEYOND"), std::string::npos) << bare.out;
    const test::Ran fails = with({"--gate", at("gate.json")});
    EXPECT_EQ(fails.exit_code, 1);
    EXPECT_NE(fails.err.find("the gate is not passed: normals"), std::string::npos) << fails.err;
    EXPECT_EQ(with({"--views", "0", "--tolerance", "0.5"}).exit_code, 1);
    EXPECT_EQ(with({"--views", "0", "--tolerance", "90"}).exit_code, 0);
    EXPECT_EQ(with({"--gate", at("gate.json"), "--normals"}).exit_code, 2);
    EXPECT_EQ(with({"--gate", at("none.json")}).exit_code, 1);
    // The angle that the older comparison finds, at the same corner.
    const json found = measure(with({"--gate", at("gate.json"), "--json"}), "normals");
    const json angles = with({"--normals", "--json"}).json()["differences"][0];
    EXPECT_NEAR(found["value"].get<double>(), angles["degrees"]["largest"].get<double>(), 1e-9);
    EXPECT_EQ(found["findings"][0]["face"], angles["worst"][0]["face"]);
    EXPECT_EQ(found["findings"][0]["corner"], angles["worst"][0]["corner"]);
}

// Points are not compared: a gate that passed would say that they are alike.
TEST_F(GateCommand, NothingToCompareIsAnError) {
    write_text(dir_ / "p.obj", "v 0 0 0\nv 1 0 0\np 1 2\n");
    write_text(dir_ / "q.obj", "v 0 0 5\nv 1 7 0\nv 3 3 3\np 1 2 3\n");
    const test::Ran ran = run_here({"diff", at("p.obj"), at("q.obj"), "--gate", at("gate.json")});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("there is nothing to compare"), std::string::npos) << ran.err;
    // A mesh that is missing is a difference.
    for (const auto& [a, b] : {std::pair{"p.obj", "a.ply"}, {"a.ply", "p.obj"}}) {
        const test::Ran other = run_here({"diff", at(a), at(b), "--gate", at("gate.json")});
        EXPECT_EQ(other.exit_code, 1);
        EXPECT_NE(other.err.find("the gate is not passed"), std::string::npos) << other.err;
    }
}

TEST_F(GateCommand, AGateThatIsNoneSaysWhere) {
    const std::pair<const char*, const char*> wrong[] = {
        {"{", "is no JSON"},
        {"[]", "#: is no object"},
        {"{}", "#/gate: is not 1"},
        {R"({"gate":2})", "#/gate: is not 1"},
        {R"({"gate":1,"limit":{}})", "did you mean 'limits'"},
        {R"({"gate":1,"limits":{"normal":1}})", "#/limits/normal: is not known here"},
        {R"({"gate":1,"limits":{"normals":-1}})", "#/limits/normals: is neither null nor"},
        {R"({"gate":1,"limits":{"normals":"1"}})", "#/limits/normals: is neither null nor"},
        {R"({"gate":1,"views":65})", "#/views: is no whole number from 0 to 64"},
        {R"({"gate":1,"size":1.5})", "#/size: is no whole number"},
        {R"({"gate":1,"scope":{"meshes":[]}})", "#/scope/meshes: is no list of names"},
        {R"({"gate":1,"scope":{"meshes":["none"]}})", "has no mesh named 'none'"},
        {R"({"gate":1,"replay":1})", "#/replay: is no command"},
    };
    for (const auto& [text, complaint] : wrong) {
        const test::Ran ran = gated(text);
        EXPECT_EQ(ran.exit_code, 1) << text;
        const json error = ran.json()["error"];
        const std::string whole =
            error["place"].get<std::string>() + ": " + error["text"].get<std::string>();
        EXPECT_NE(whole.find(complaint), std::string::npos) << text << "\n" << whole;
    }
}

TEST_F(GateCommand, LimitsViewsAndReplayAreTheGates) {
    const test::Ran ran = gated(
        R"({"gate":1,"limits":{"normals":null,"uvs":0.5,"flip":0},"views":2,"size":32,"replay":"make it"})");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_TRUE(measure(ran, "normals")["limit"].is_null());
    EXPECT_EQ(measure(ran, "uvs")["limit"], 0.5);
    const json judged = ran.json()["differences"][0];
    EXPECT_EQ(judged["views"].size(), 2u);
    EXPECT_EQ(judged["replay"], "make it");
    for (const json& view : judged["views"]) {
        EXPECT_EQ(view["flip"], 0.0);
        EXPECT_EQ(view["outline"], 0.0);
    }
}

// What `docs/ci.md` says of costs: same files are neither searched nor drawn.
TEST_F(GateCommand, FilesThatDoNotDifferAreNotDrawn) {
    const test::Ran ran = gated("{\"gate\":1}");
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_TRUE(ran.json()["differences"][0]["views"].empty());
    EXPECT_EQ(measure(ran, "distance")["proved"], true);
    EXPECT_EQ(measure(ran, "distance")["value"], 0.0);
}

TEST_F(GateCommand, LimitsOfWhatIsDrawnNeedViews) {
    for (const std::string name : {"flip", "silhouettes"}) {
        const test::Ran ran = gated(R"({"gate":1,"views":0,"limits":{")" + name + R"(":0.1}})");
        EXPECT_EQ(ran.exit_code, 1);
        const json error = ran.json()["error"];
        EXPECT_EQ(error["text"], "is a limit of what is drawn, and there are 0 views");
        EXPECT_EQ(error["place"], at("g.json") + "#/limits/" + name);
        write_text(dir_ / "g.json", R"({"gate":1,"limits":{")" + name + R"(":0.1}})");
        EXPECT_EQ(
            run_here({"diff", at("a.ply"), at("a.ply"), "--gate", at("g.json"), "--views", "0"})
                .exit_code,
            1);
    }
    EXPECT_EQ(gated(R"({"gate":1,"views":0,"limits":{"flip":null}})").exit_code, 0);
    EXPECT_EQ(gated(R"({"gate":1,"views":0})").exit_code, 0);
}

TEST_F(GateCommand, NamesDoNotReachTheTerminalAsTheyAre) {
    // A mesh without a name is called as its file.
    const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 1\n";
    write_text(dir_ / "a\x1b[31mred.obj", points + "f 1//1 2//1 3//1\n");
    write_text(dir_ / "y.obj", points + "f 1//1 2//1 3//2\n");
    const test::Ran ran = run_here({"diff", at("a\x1b[31mred.obj"), at("y.obj"), "--views", "0"});
    EXPECT_NE(ran.out.find("[31mred'"), std::string::npos) << ran.out;
    EXPECT_EQ(ran.out.find('\x1b'), std::string::npos);
}

// A box whose right side stands 1 pixel of the picture farther out, by the frame that
// docs/comparing.md states: a ball about the first file's box, 2.1 radii across the picture.
TEST_F(GateCommand, OutlinesAreMeasuredInPixels) {
    std::string a = test::cube_obj(), b;
    write_text(dir_ / "a.obj", a);
    const double pixel = 2.1 * std::sqrt(3.0) / 2 / 256;
    std::istringstream lines(a);
    for (std::string line; std::getline(lines, line);) {
        double x = 0, y = 0, z = 0;
        if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3)
            line = "v " + std::to_string(x > 0.4 ? x + pixel : x) + " " + std::to_string(y) + " " +
                   std::to_string(z);
        b += line + "\n";
    }
    write_text(dir_ / "b.obj", b);
    const test::Ran ran = run_here({"diff", at("a.obj"), at("b.obj"), "--views", "16", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json views = ran.json()["differences"][0]["views"];
    ASSERT_EQ(views.size(), 16u);
    for (const json& view : views) {
        // What a shift along x moves at right angles to the gaze.
        const double x = view["direction"][0].get<double>(), seen = std::sqrt(1 - x * x);
        EXPECT_LT(view["outline"].get<double>(), 1.15 * seen + 0.05);
        if (seen > 0.9) {
            EXPECT_GT(view["outline"].get<double>(), 0.7 * seen);
        }
    }
    EXPECT_NEAR(measure(ran, "positions")["value"].get<double>(), pixel / std::sqrt(3.0), 1e-5);
    EXPECT_EQ(measure(ran, "silhouettes")["follows"], "positions");
}

TEST_F(GateCommand, ThePageNeedsNothingElseAndIsTheSameAgain) {
    ASSERT_EQ(
        run_here({"prepare", at("ball.obj"), "-o", at("b.ply"), "--weight", "uniform", "--quiet"})
            .exit_code,
        0);
    write_text(dir_ / "small.json", R"({"gate":1,"views":2,"size":64})");
    for (const char* threads : {"1", "2"})
        ASSERT_EQ(
            run_here({"diff", at("a.ply"), at("b.ply"), "--gate", at("small.json"), "--report",
                      at(std::string("page") + threads + ".html"), "--threads", threads, "--quiet"})
                .exit_code,
            1);
    const std::string page = test::file_text(dir_ / "page1.html");
    EXPECT_EQ(page, test::file_text(dir_ / "page2.html"));
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_EQ(page.find("src=\"http"), std::string::npos);
    EXPECT_NE(page.find("Beyond its limit: normals"), std::string::npos);
    EXPECT_NE(page.find("degrees</td><td>mesh 0"), std::string::npos);
    std::size_t pictures = 0;
    for (std::size_t p = page.find("<img"); p != std::string::npos; p = page.find("<img", p + 1))
        ++pictures;
    EXPECT_EQ(pictures, 6u);  // three of each of two views
    const test::Ran over =
        run_here({"diff", at("a.ply"), at("b.ply"), "--report", at("a.ply"), "--json"});
    EXPECT_EQ(over.exit_code, 1);
    EXPECT_EQ(over.json()["error"]["text"], "the output is also an input; give another name");
}

// So far out that all of it is at one place: a dot of that size, and not an error.
TEST_F(GateCommand, ViewsOfWhatIsFarOut) {
    test::write_text(dir_ / "far.json",
                     R"({"meshprep":1,"meshes":{"box":{"shape":{"kind":"box"}}},)"
                     R"("nodes":[{"mesh":"box","translate":[1e30,0,0]}]})");
    const test::Ran ran =
        run_here({"diff", at("far.json"), at("far.json"), "--views", "2", "--json"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
}

TEST_F(GateCommand, APageDoesNotReplaceALibrary) {
    test::write_text(dir_ / "m.mtl", "newmtl red\nKd 1 0 0\n");
    test::write_text(dir_ / "m.obj",
                     "mtllib m.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const test::Ran over =
        run_here({"diff", at("m.obj"), at("m.obj"), "--report", at("m.mtl"), "--json"});
    EXPECT_EQ(over.exit_code, 1);
    EXPECT_EQ(over.json()["error"]["text"], "the output is also an input; give another name");
    EXPECT_EQ(test::file_text(dir_ / "m.mtl"), "newmtl red\nKd 1 0 0\n");
}

TEST_F(GateCommand, PicturesHaveFlip) {
    const auto save = [&](const std::string& name, float grey) {
        const prep::Image image{32, 32, 1, std::vector<float>(32 * 32, grey), true};
        EXPECT_TRUE(prep::save_image(dir_ / name, image));
        return at(name);
    };
    const std::string a = save("a.png", 0.2f), b = save("b.png", 0.4f);
    const test::Ran same = run_here({"diff", a, a, "--flip", "--json"});
    EXPECT_EQ(same.json()["differences"][0]["flip"]["mean"], 0.0);
    EXPECT_FALSE(run_here({"diff", a, b, "--json"}).json()["differences"][0].contains("flip"));
    // Grey levels without an edge: the paper's colour part alone, |L*1 − L*2|, as its steps have
    // it: HyAB distance of Hunt-adjusted colours to the power 0.7, over that of green to blue, the
    // lower 0.4 of it drawn out to 0.95.
    const double found = run_here({"diff", a, b, "--flip", "--json"})
                             .json()["differences"][0]["flip"]["mean"]
                             .get<double>();
    const auto lightness = [](double encoded) {
        const double y = std::pow((encoded + 0.055) / 1.055, 2.4);
        return 116 * std::cbrt(y) - 16;
    };
    // 8 bits: 51 and 102 of 255.
    const double distance = std::pow(lightness(102 / 255.0) - lightness(51 / 255.0), 0.7);
    // HyAB of Hunt-adjusted sRGB green and blue: 308.109 (of Lab 87.737, −86.185, 83.179
    // and 32.303, 79.188, −107.860, chroma times L/100), to the power 0.7.
    const double most = std::pow(
        87.737 - 32.303 +
            std::hypot(0.87737 * -86.185 - 0.32303 * 79.188, 0.87737 * 83.179 + 0.32303 * 107.860),
        0.7);
    EXPECT_NEAR(found, 0.95 / 0.4 * distance / most, 2e-3);
    write_text(dir_ / "strict.json", R"({"gate":1,"limits":{"flip":0.01,"rmse":null}})");
    write_text(dir_ / "mild.json", R"({"gate":1,"limits":{"flip":0.99,"rmse":null}})");
    EXPECT_EQ(run_here({"diff", a, b, "--gate", at("mild.json")}).exit_code, 0);
    const test::Ran strict =
        run_here({"diff", a, b, "--gate", at("strict.json"), "--report", at("p.html")});
    EXPECT_EQ(strict.exit_code, 1);
    EXPECT_NE(strict.err.find("the gate is not passed: flip"), std::string::npos) << strict.err;
    EXPECT_NE(test::file_text(dir_ / "p.html").find("FLIP mean"), std::string::npos);
    EXPECT_EQ(run_here({"diff", a, b, "--views", "3"}).exit_code, 1);
    const test::Ran meshes = run_here({"diff", at("a.ply"), at("a.ply"), "--flip", "--json"});
    EXPECT_EQ(meshes.exit_code, 1);
    EXPECT_EQ(meshes.json()["error"]["text"],
              "--flip compares pictures; of meshes, a gate's limit \"flip\" does");
}

// FLIP takes what is not a number for black; a gate that holds FLIP alone still sees it.
TEST_F(GateCommand, PicturesWithNumbersThatAreNonePassNoGate) {
    std::vector<float> values(8 * 8 * 3);
    const auto write = [&](const std::string& name) {
        std::string text = "PF\n8 8\n-1.0\n";
        text.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
        write_text(dir_ / name, text);
    };
    write("a.pfm");
    write_text(dir_ / "g.json", R"({"gate":1,"limits":{"flip":1,"rmse":null}})");
    for (const float none : {NAN, INFINITY}) {
        values[50] = none;
        write("b.pfm");
        const auto code = [&](const char* first) {
            return run_here({"diff", at(first), at("b.pfm"), "--gate", at("g.json")}).exit_code;
        };
        EXPECT_EQ(code("a.pfm"), 1);
        EXPECT_EQ(code("b.pfm"), 0);
    }
}

// IDs are no colours, so that there is no FLIP of them: an error that leaves nothing behind.
TEST_F(GateCommand, WhatFailsWritesNoHeatMap) {
    ASSERT_EQ(run_here({"render", at("ball.obj"), "-o", at("p.png"), "--size=16x16", "--buffers",
                        "id", "--buffer-file", at("id.exr"), "--quiet"})
                  .exit_code,
              0);
    const test::Ran ran = run_here(
        {"diff", at("id.exr"), at("id.exr"), "--flip", "--heat-map", at("heat.png"), "--json"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_EQ(ran.json()["error"]["text"],
              "FLIP compares colours, and this file's channels are others");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "heat.png"));
}

// Numbers of extensions that are not drawn here are part of a material's look elsewhere.
TEST_F(GateCommand, GlassIsNotPaint) {
    write_text(dir_ / "m.mtl", "newmtl red\nKd 1 0 0\n");
    write_text(dir_ / "m.obj", "mtllib m.mtl\nusemtl red\n" + test::cube_obj());
    ASSERT_EQ(run_here({"prepare", at("m.obj"), "-o", at("m.gltf"), "--quiet"}).exit_code, 0);
    const auto with = [&](const std::string& name, const json& extensions) {
        json document = json::parse(test::file_text(dir_ / "m.gltf"));
        for (const auto& item : extensions.items()) {
            document["materials"][0]["extensions"][item.key()] = item.value();
            document["extensionsUsed"].push_back(item.key());
        }
        write_text(dir_ / name, document.dump());
        return at(name);
    };
    const json glass = {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}};
    const json thin = {{"KHR_materials_transmission", {{"transmissionFactor", 0.25}}}};
    const json film = {{"KHR_materials_iridescence", {{"iridescenceFactor", 1}}}};
    const std::string paint = with("paint.gltf", json::object());
    const auto faces = [&](const std::string& a, const std::string& b) {
        const test::Ran ran = run_here({"diff", a, b, "--views", "0", "--json"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return measure(ran, "materials").at("value").get<double>();
    };
    EXPECT_EQ(faces(paint, with("glass.gltf", glass)), 12);
    EXPECT_EQ(faces(with("glass.gltf", glass), paint), 12);
    EXPECT_EQ(faces(with("glass.gltf", glass), with("thin.gltf", thin)), 12);
    EXPECT_EQ(faces(with("film.gltf", film), paint), 12);
    EXPECT_EQ(faces(with("glass.gltf", glass), with("again.gltf", glass)), 0);
    // What an extension has where it says nothing is what files without it have.
    const json idle = {{"KHR_materials_transmission", {{"transmissionFactor", 0}}},
                       {"KHR_materials_volume", {{"attenuationColor", {1, 1, 1}}}},
                       {"KHR_materials_iridescence", {{"iridescenceIor", 1.3}}}};
    EXPECT_EQ(faces(with("idle.gltf", idle), paint), 0);
    // However long its names are.
    json odd = {{"VENDOR_" + std::string(100000, 'x'), json::array()}};
    for (int k = 0; k < 15000; ++k) odd.begin().value().push_back(k);
    EXPECT_EQ(faces(with("odd.gltf", odd), paint), 0);
}

}  // namespace
