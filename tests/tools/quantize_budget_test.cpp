// `prepare --quantize`, and what bits it takes for an error: measured again from the written files,
// by numbers that neither the command nor libprep have read.
#include "meshprep/budgets/quantize_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "command_runner.h"
#include "gltf_maker.h"
#include "hostile_meshes.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "written_gltf.h"

namespace {

using nlohmann::json;
using test::GltfFile;
using test::run_command;
using test::run_here;
using test::TempDir;
using test::write_text;

double degrees_apart(const std::vector<double>& a, const std::vector<double>& b) {
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2],
                 z = a[0] * b[1] - a[1] * b[0];
    return std::atan2(std::sqrt(x * x + y * y + z * z), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) *
           180 / M_PI;
}

// The largest angle between the two files' directions, corner by corner.
double turned(const GltfFile& a, const GltfFile& b, const std::string& name) {
    const auto of_a = a.triangles(0, 0), of_b = b.triangles(0, 0);
    EXPECT_EQ(of_a.size(), of_b.size());
    const auto left = a.attribute(0, 0, name), right = b.attribute(0, 0, name);
    double worst = 0;
    for (std::size_t c = 0; c < std::min(of_a.size(), of_b.size()); ++c)
        worst = std::max(worst, degrees_apart(left.at(of_a[c]), right.at(of_b[c])));
    return worst;
}

class QuantizeBudget : public ::testing::Test {
  protected:
    QuantizeBudget() {
        write_text(dir_ / "ball.obj", test::sphere_obj(14, 7));
        write_text(dir_ / "fine.obj", test::sphere_obj(40, 20));
        // A vault, whose UVs run across it, and a wall that is smooth with it.
        std::string vault, faces;
        for (int i = 0; i <= 20; ++i)
            for (int j = 0; j < 4; ++j)
                vault += "v " + std::to_string(std::cos(i * 0.11)) + " " +
                         std::to_string(std::sin(i * 0.11)) + " " + std::to_string(j * j * 0.3) +
                         "\nvt " + std::to_string((i * 3 + j * j) / 80.0) + " " +
                         std::to_string(j * 0.3 + i * 0.001) + "\n";
        for (int i = 0; i < 20; ++i)
            for (int j = 0; j < 3; ++j) {
                faces += "f";
                for (const int k : {0, 1, 5, 4}) {
                    const std::string v = std::to_string(i * 4 + j + k + 1);
                    faces += " " + v + "/" + v;
                }
                faces += "\n";
            }
        write_text(dir_ / "vault.obj", vault + faces);
        write_text(dir_ / "tent.obj",
                   "v 0 0 0\nv 2 0 0.1\nv 2 1.7 0\nv 0 1 0.3\nv 1 0.9 1.1\n"
                   "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n");
        test::write_hostile_meshes(dir_ / "");
    }
    std::string at(const std::string& name) const { return (dir_ / name).string(); }

    // Writes within `degrees` of normals or tangents; the certificate, held against the
    // numbers in the files.
    void request(const std::string& mesh, const std::string& degrees, int code,
                 const std::string& attribute = "normals",
                 const std::vector<std::string>& more = {}) {
        SCOPED_TRACE(mesh + " " + degrees);
        const std::string out = std::to_string(requests_++) + ".glb";
        const bool odd = requests_ % 2 != 0;
        std::vector<std::string> words = {
            "prepare",
            at(mesh),
            "-o",
            at(out),
            "--quantize",
            "auto",
            "--json",
            "--threads",
            odd ? "2" : "1",
            attribute == "normals" ? "--normal-error" : "--tangent-error",
            degrees};
        words.insert(words.end(), more.begin(), more.end());
        const test::Ran ran = run_here(words);
        ASSERT_EQ(ran.exit_code, code) << ran.err;
        const json file = ran.json()["files"][0];
        const json c = file["certificate"];
        ASSERT_TRUE(c.is_object()) << ran.out;
        const json d = c["directions"][0];
        EXPECT_EQ(d["attribute"], attribute);
        const double asked = std::stod(degrees), achieved = d["achieved"].get<double>();
        EXPECT_EQ(c["met"].get<bool>(), code == 0);
        EXPECT_EQ(achieved <= asked, code == 0);
        // By the file's own numbers. The command reads floats.
        std::vector<std::string> plain = {"prepare", at(mesh), "-o", at("plain.glb"), "--quiet"};
        plain.insert(plain.end(), more.begin(), more.end());
        ASSERT_EQ(run_here(plain).exit_code, 0);
        const std::string name = attribute == "normals" ? "NORMAL" : "TANGENT";
        const GltfFile truth(dir_ / "plain.glb");
        EXPECT_EQ(GltfFile(dir_ / out).fault(), "");
        const double own = turned(truth, GltfFile(dir_ / out), name);
        EXPECT_LE(own, achieved);  // by half a last place of two files' floats at most
        EXPECT_GE(own, achieved - 1.4e-5);
        // One bit less does not do.
        const int bits = d["chosen"]["bits"].get<int>();
        if (code == 0 && bits != 8) {
            std::vector<std::string> less = plain;
            less[3] = at("less.glb");
            less.push_back("--quantize=" + attribute + "=" +
                           std::to_string(bits == 0 ? 16 : bits - 1));
            ASSERT_EQ(run_here(less).exit_code, 0);
            EXPECT_GT(turned(truth, GltfFile(dir_ / "less.glb"), name), asked - 1.2e-5);
        }
        repeats(c["command"].get<std::string>(), out, odd);
    }

    // The printed command, as a shell runs it, on the other number of threads: the same bytes.
    void repeats(std::string again, const std::string& out, bool odd) {
        ASSERT_EQ(again.rfind("meshprep prepare ", 0), 0u) << again;
        ASSERT_EQ(again.find("-error"), std::string::npos) << again;
        ASSERT_EQ(again.find("auto"), std::string::npos) << again;
        const std::string written = test::file_text(dir_ / out);
        std::filesystem::rename(dir_ / out, dir_ / ("first-" + out));
        again = "'" + test::command_path().string() + "'" + again.substr(8);
        const test::Ran shell =
            test::run_program("/bin/sh", {"-c", again + " --threads " + (odd ? "1" : "2")});
        ASSERT_EQ(shell.exit_code, 0) << again << shell.err;
        EXPECT_EQ(test::file_text(dir_ / out), written) << again;
    }

    TempDir dir_;
    int requests_ = 0;
};

// 40 requests: 20 that can be met, 8 that cannot, 4 that ask for nothing, 4 hostile meshes, 4 that
// are none.
TEST_F(QuantizeBudget, OfFortyRequestsAllAreMetThatCanBe) {
    for (const char* const mesh : {"ball.obj", "fine.obj", "vault.obj", "tent.obj"}) {
        for (const char* const degrees : {"0.4", "0.1", "0.02", "0.003", "0.0002"})
            request(mesh, degrees, 0);
        for (const char* const degrees : {"0", "1e-6"}) request(mesh, degrees, 1);
        request(mesh, "180", 0);
    }
    for (const char* const mesh : {"nan.obj", "flat.obj", "far.obj", "twice.obj"})
        request(mesh, "0.05", 0);
    EXPECT_EQ(requests_, 36);
    const std::vector<std::vector<std::string>> none = {
        {"--quantize=auto", "--normal-error=-1"},
        {"--quantize=auto", "--normal-error=nan"},
        {"--quantize=auto", "--tangent-error=fine"},
        {"--quantize=normals=12", "--normal-error=1"}};
    for (const auto& more : none) {
        std::vector<std::string> words = {"prepare", at("ball.obj"), "-o", at("x.glb")};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(run_here(words).exit_code, 2);
    }
    EXPECT_FALSE(std::filesystem::exists(dir_ / "x.glb"));
}

// Normals along an axis are the same with any bits: what floats' own rounding leaves is told.
TEST_F(QuantizeBudget, NothingMeetsZeroThoughNothingIsLost) {
    write_text(dir_ / "square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    request("square.obj", "0", 1);
    request("square.obj", "0.001", 0);
}

TEST_F(QuantizeBudget, TangentsAndWhatElseWasGiven) {
    for (const char* const degrees : {"0.3", "0.01", "0.001"})
        request("vault.obj", degrees, 0, "tangents", {"--tangents", "mikktspace"});
    request("vault.obj", "0.1", 0, "normals", {"--hard-angle", "5", "--scale", "0.25"});
    request("ball.obj", "0.05", 0, "normals", {"--subdivide", "catmark:1"});
}

// Both at once, each with its own bits; compressed files are measured as any other.
TEST_F(QuantizeBudget, EachDirectionHasItsBits) {
    for (const char* const method : {"none", "draco", "meshopt"}) {
        const test::Ran ran =
            run_here({"prepare", at("vault.obj"), "-o", at("both.glb"), "--tangents", "mikktspace",
                      "--quantize", "auto", "--normal-error", "0.3", "--tangent-error", "0.002",
                      "--compress", method, "--json"});
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        const json c = ran.json()["files"][0]["certificate"];
        ASSERT_EQ(c["directions"].size(), 2u);
        const int normals = c["directions"][0]["chosen"]["bits"].get<int>(),
                  tangents = c["directions"][1]["chosen"]["bits"].get<int>();
        EXPECT_LT(normals, 11);
        EXPECT_GT(tangents, 14);
        EXPECT_NE(c["command"].get<std::string>().find(
                      "--quantize positions=16,normals=" + std::to_string(normals) +
                      ",tangents=" + std::to_string(tangents) + ",uvs=16"),
                  std::string::npos)
            << c["command"];
        // By the judge, in a process of its own, where the order of vertices is another.
        ASSERT_EQ(run_here({"prepare", at("vault.obj"), "-o", at("plain.glb"), "--tangents",
                            "mikktspace"})
                      .exit_code,
                  0);
        write_text(dir_ / "gate.json",
                   R"({"gate": 1, "limits": {"positions": 2e-5, "distance": 2e-5,
                   "normals": 0.3, "tangents": 0.002}})");
        const test::Ran gate = run_command(
            {"diff", at("plain.glb"), at("both.glb"), "--gate", at("gate.json"), "--quiet"});
        EXPECT_EQ(gate.exit_code, 0) << gate.out << gate.err;
    }
}

// A node that is stretched turns normals farther than the file's numbers say: bits are added until
// what is measured in the world holds.
TEST_F(QuantizeBudget, WhatNodesDoToDirectionsCounts) {
    test::GltfMaker d;
    std::vector<float> places, normals;
    for (int i = 0; i < 60; ++i) {
        const double a = 0.02 * i + 0.1, b = 0.1 + 0.013 * i;
        places.insert(places.end(), {float(i), float(i % 3), float(i % 7)});
        normals.insert(normals.end(), {float(std::cos(a) * std::cos(b)),
                                       float(std::sin(a) * std::cos(b)), float(std::sin(b))});
    }
    d.mesh(
        {{{"attributes",
           {{"POSITION", d.accessor(places, "VEC3")}, {"NORMAL", d.accessor(normals, "VEC3")}}}}});
    d.json["nodes"][0]["scale"] = {1, 1, 0.05};
    write_text(dir_ / "stretched.glb", d.glb());
    const test::Ran ran = run_here({"prepare", at("stretched.glb"), "-o", at("out.glb"),
                                    "--quantize", "auto", "--normal-error", "0.05", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json c = ran.json()["files"][0]["certificate"]["directions"][0];
    EXPECT_LE(c["achieved"].get<double>(), 0.05);
    // In the world, from the file: z divided by its scale.
    const auto world = [&](const char* name) {
        const GltfFile file(dir_ / name);
        std::vector<std::vector<double>> out;
        const auto values = file.attribute(0, 0, "NORMAL");
        for (const std::size_t v : file.triangles(0, 0)) {
            std::vector<double> n = values.at(v);
            n[2] /= 0.05;
            out.push_back(n);
        }
        return out;
    };
    const auto a = world("stretched.glb"), b = world("out.glb");
    ASSERT_EQ(a.size(), b.size());
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, degrees_apart(a[i], b[i]));
    EXPECT_NEAR(worst, c["achieved"].get<double>(), 1e-4);
    // By the numbers alone fewer bits would have done.
    EXPECT_LT(c["tried"][c["tried"].size() - 2]["degrees"].get<double>(), 0.05);
}

TEST_F(QuantizeBudget, ItIsToldInWordsToo) {
    const test::Ran ran = run_here({"prepare", at("vault.obj"), "-o", at("x.glb"), "--quantize",
                                    "auto", "--normal-error", "0.1"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    for (const char* const text :
         {"positions of 16 bits: 84 rounded, off by ", " of the mesh's diagonal at most",
          "normals: 0.1° asked, 0.0", "measured on all 360 corners", "next: 0.0",
          "the same again: meshprep prepare "})
        EXPECT_NE(ran.out.find(text), std::string::npos) << text << "\n" << ran.out;
    const test::Ran none = run_here({"prepare", at("vault.obj"), "-o", at("y.glb"), "--quantize",
                                     "auto", "--normal-error", "0"});
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_NE(none.err.find("no storage keeps normals within 0°; the best found has"),
              std::string::npos)
        << none.err;
    EXPECT_TRUE(std::filesystem::exists(dir_ / "y.glb"));
}

// What is met is left out the next time; what is not fails again.
TEST_F(QuantizeBudget, WhatIsUnmetIsNotDone) {
    for (const bool met : {true, false}) {
        const std::string name = met ? "met" : "unmet";
        for (const bool again : {false, true}) {
            const test::Ran ran =
                run_here({"prepare", at("tent.obj"), "-o", at(name + ".glb"), "--quantize", "auto",
                          "--normal-error", met ? "1" : "0", "--manifest", at(name + ".json"),
                          "--skip-unchanged", "--json"});
            EXPECT_EQ(ran.exit_code, met ? 0 : 1) << ran.err;
            EXPECT_EQ(ran.json()["files"][0]["status"], met && again ? "skipped" : "ok");
        }
    }
}

// What was not compared is not said to be: directions that are not there, corners left out.
TEST_F(QuantizeBudget, TheScopeIsWhatWasCompared) {
    const test::Ran ran = run_here({"prepare", at("tent.obj"), "-o", at("scope.glb"), "--quantize",
                                    "auto", "--tangent-error", "0.1", "--json"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    const json none = ran.json()["files"][0]["certificate"];
    EXPECT_EQ(none["scope"], "tangents: none there");
    EXPECT_EQ(none["directions"][0]["corners_placed"], 0);
    meshprep::DirectionChoice some;
    some.corners = 3;
    some.placed = 9;
    some.chosen = {8, 0.1, 12};
    EXPECT_EQ(some.scope(),
              "measured on 3 of 9 corners that were read, and on all 12 stored "
              "values");
}

// The default scene's normals are exact with any bits; the other scene's count too.
TEST_F(QuantizeBudget, OtherScenesCount) {
    test::GltfMaker d;
    const std::vector<float> places{0, 0, 0, 1, 0, 0, 0, 1, 0}, flat{0, 0, 1, 0, 0, 1, 0, 0, 1},
        slanted{0.8f, 0.1f, 0.59f, 0.5f, 0.3f, 0.81f, 0.1f, 0.7f, 0.7f};
    for (const std::vector<float>& normals : {flat, slanted})
        d.mesh({{{"attributes",
                  {{"POSITION", d.accessor(places, "VEC3")},
                   {"NORMAL", d.accessor(normals, "VEC3")}}}}});
    d.json["scenes"] = json::parse(R"([{"nodes": [0]}, {"nodes": [1]}])");
    d.json["scene"] = 0;
    write_text(dir_ / "scenes.glb", d.glb());
    const test::Ran ran = run_here({"prepare", at("scenes.glb"), "-o", at("out.glb"), "--quantize",
                                    "auto", "--normal-error", "1", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const GltfFile before(dir_ / "scenes.glb"), after(dir_ / "out.glb");
    const auto a = before.attribute(1, 0, "NORMAL"), b = after.attribute(1, 0, "NORMAL");
    double worst = 0;
    for (std::size_t v = 0; v < 3; ++v) worst = std::max(worst, degrees_apart(a.at(v), b.at(v)));
    EXPECT_GT(worst, 0.05);
    const json c = ran.json()["files"][0]["certificate"]["directions"][0];
    EXPECT_GE(c["achieved"].get<double>(), worst);
}

// Bits are added by what was measured; the file that is there is replaced once.
TEST_F(QuantizeBudget, TheOutputIsReplacedOnce) {
    test::GltfMaker d;
    const std::vector<float> places{0, 0, 0, 1, 0, 1, 0, 1, 0},
        normals{0.8f, 0.1f, 0.59f, 0.5f, 0.3f, 0.81f, 0.1f, 0.7f, 0.7f};
    d.mesh(
        {{{"attributes",
           {{"POSITION", d.accessor(places, "VEC3")}, {"NORMAL", d.accessor(normals, "VEC3")}}}}});
    d.json["nodes"][0]["scale"] = {1, 1, 0.05};
    write_text(dir_ / "stretched.glb", d.glb());
    auto scene = prep::load_scene(dir_ / "stretched.glb");
    ASSERT_TRUE(scene);
    const auto prepared = prep::prepare(*std::move(scene), {});
    ASSERT_TRUE(prepared);
    const std::filesystem::path path = dir_ / "out.glb";
    write_text(path, "old");
    std::vector<std::string> replaced;
    prep::SaveOptions save;
    save.quantization = meshprep::usual_quantization();
    save.spared = [&](const std::filesystem::path& file) {
        replaced.push_back(test::file_text(file));
        return false;
    };
    const auto done = meshprep::save_within(*prepared, path, save, {0.05, {}}, 1);
    ASSERT_TRUE(done);
    EXPECT_EQ(replaced, std::vector<std::string>{"old"});
    EXPECT_TRUE(done->certificate.met());
    // A failure leaves what was there.
    write_text(path, "old");
    save.spared = [](const std::filesystem::path&) { return true; };
    EXPECT_FALSE(meshprep::save_within(*prepared, path, save, {0.05, {}}, 1));
    EXPECT_EQ(test::file_text(path), "old");
}

// What came as whole numbers stays so where nothing is rounded: the last rung takes what the file
// takes, not what floats would.
TEST_F(QuantizeBudget, BytesAreThoseOfTheFile) {
    for (const char* bits : {"0", "8", "12"}) {
        SCOPED_TRACE(bits);
        std::vector<std::string> make = {"prepare", at("ball.obj"), "-o", at("came.glb")};
        if (bits[0] != '0') make.push_back(std::string("--quantize=normals=") + bits);
        ASSERT_EQ(run_here(make).exit_code, 0);
        const test::Ran ran = run_here({"prepare", at("came.glb"), "-o", at("went.glb"), "--json",
                                        "--quantize", "auto", "--normal-error", "1e-9"});
        EXPECT_EQ(ran.exit_code, 1);
        const json tried = ran.json()["files"][0]["certificate"]["directions"][0]["tried"];
        const std::string file = test::file_text(dir_ / "came.glb");
        std::uint32_t length = 0;
        std::memcpy(&length, file.data() + 12, 4);
        const json document = json::parse(file.substr(20, length));
        const json& normals = document["accessors"].at(
            document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"].get<std::size_t>());
        const std::uint64_t count = normals["count"];
        const std::uint64_t one = bits[0] == '0' ? 12 : bits[0] == '8' ? 4 : 8;
        ASSERT_EQ(tried.size(), 10u);
        EXPECT_EQ(tried[9]["bits"], 0);
        EXPECT_EQ(tried[9]["bytes"], count * one);
        EXPECT_EQ(tried[0]["bytes"], count * 4);
        EXPECT_EQ(tried[1]["bytes"], count * 8);
    }
}

TEST_F(QuantizeBudget, WhatMakesNoSenseIsAUsageError) {
    const std::vector<std::vector<std::string>> mistaken = {
        {"-o", at("x.glb"), "--quantize", "normals"},
        {"-o", at("x.glb"), "--quantize", "normals=7"},
        {"-o", at("x.glb"), "--quantize", "normals=17"},
        {"-o", at("x.glb"), "--quantize", "positions=3"},
        {"-o", at("x.glb"), "--quantize", "uvs=8.5"},
        {"-o", at("x.glb"), "--quantize", "uvs=8,uvs=9"},
        {"-o", at("x.glb"), "--quantize", "colors=8"},
        {"-o", at("x.glb"), "--quantize", ""},
        {"-o", at("x.glb"), "--tangent-error", "1"},
        {"-o", "-", "--format", "glb", "--quantize", "auto", "--normal-error", "1"},
        {"--in-place", "--quantize", "auto", "--normal-error", "1"},
    };
    for (const auto& more : mistaken) {
        std::vector<std::string> words = {"prepare", at("ball.obj")};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(run_here(words).exit_code, 2) << more.back();
    }
    EXPECT_FALSE(std::filesystem::exists(dir_ / "x.glb"));
    // The format is known with each file.
    const test::Ran obj =
        run_here({"prepare", at("ball.obj"), "-o", at("x.obj"), "--quantize", "auto"});
    EXPECT_EQ(obj.exit_code, 1);
    EXPECT_NE(obj.err.find("write .glb or .gltf"), std::string::npos) << obj.err;
}

}  // namespace
