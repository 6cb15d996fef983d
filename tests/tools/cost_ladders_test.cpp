// The ladders of `meshprep cost`: every rung's error is where it belongs. Errors are the same on
// every machine; bounds are a fifth above what was measured when they were set (errors that are
// nothing but rounding: twice that), so that a stage that gets worse fails here.
// tests/mutants/cost.txt has a fault for each ladder; docs/accuracy.md says how far each moves its
// error.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "command_runner.h"
#include "cost/ladders/ladder.h"
#include "shapes.h"

namespace {

using cost::Ladder;

Ladder ladder_named(const std::string& name, const prep::Mesh* mesh = nullptr) {
    for (const cost::LadderRow& row : cost::ladder_rows()) {
        if (name != row.name) continue;
        auto ladder = row.make({"mesh", mesh, 1});
        EXPECT_TRUE(ladder) << name;
        return *std::move(ladder);
    }
    ADD_FAILURE() << name;
    return {};
}

// Of each rung its numbers, by its name.
std::map<std::string, std::vector<double>> climbed(const Ladder& ladder) {
    std::map<std::string, std::vector<double>> numbers;
    for (const cost::Rung& rung : ladder.rungs) {
        EXPECT_TRUE(rung.run()) << rung.name;
        numbers[rung.name] = rung.judge();
        EXPECT_EQ(numbers[rung.name].size(), ladder.metrics.size()) << rung.name;
    }
    return numbers;
}

TEST(CostLadders, AreNamedOnceAndSayWhatTheyTime) {
    std::set<std::string> names;
    for (const cost::LadderRow& row : cost::ladder_rows()) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        const Ladder ladder = ladder_named(row.name);
        EXPECT_EQ(ladder.name, row.name);
        EXPECT_FALSE(ladder.title.empty() || ladder.setting.empty() || ladder.subject.empty() ||
                     ladder.oracle.empty() || ladder.timed.empty());
        ASSERT_LT(ladder.primary, ladder.metrics.size());
        ASSERT_LT(ladder.reference, ladder.rungs.size());
        std::set<std::string> rungs;
        for (const cost::Rung& rung : ladder.rungs)
            EXPECT_TRUE(rungs.insert(rung.name).second) << rung.name;
    }
}

// Each command of a rung, with a mesh and an output added, is one that runs.
TEST(CostLadders, CommandsOfRungsRun) {
    const test::TemporaryDirectory dir;
    test::write_text(dir / "ball.obj", test::sphere_obj(8, 5));
    std::set<std::string> commands;
    for (const cost::LadderRow& row : cost::ladder_rows())
        for (const cost::Rung& rung : ladder_named(row.name).rungs) commands.insert(rung.command);
    for (const std::string& command : commands) {
        std::vector<std::string> words;
        for (std::size_t at = 0; at < command.size();) {
            const std::size_t space = std::min(command.find(' ', at), command.size());
            words.push_back(command.substr(at, space - at));
            at = space + 1;
        }
        words.insert(words.begin() + 1, (dir / "ball.obj").string());
        words.insert(words.end(),
                     {"-o", (dir / (words[0] == "render" ? "o.png" : "o.glb")).string()});
        if (words[0] == "render") words.insert(words.end(), {"--size", "32x24"});
        const test::Ran ran = test::run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << command << "\n" << ran.err;
    }
}

TEST(CostLadders, NormalPrecision) {
    auto n = climbed(ladder_named("normal-precision"));
    EXPECT_LT(n["fast"][0], 8e-6);
    EXPECT_GT(n["fast"][0], 1e-7);  // floats: no better than they can be
    EXPECT_LT(n["accurate"][0], 5e-13);
    EXPECT_LT(n["exact"][0], 2e-14);
    for (const char* name : {"accurate", "exact"}) EXPECT_LT(n[name][3], 5e-6);
}

TEST(CostLadders, NormalPrecisionOfAMeshThatIsGiven) {
    const prep::Mesh mesh = shapes::icosphere(3);
    auto n = climbed(ladder_named("normal-precision", &mesh));
    EXPECT_LT(n["accurate"][0], 1e-13);
    EXPECT_LT(n["fast"][0], 1e-4);
    prep::Mesh flat;  // nothing but a face without area
    flat.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    flat.corner_vertices = {0, 1, 2};
    flat.face_offsets = {0, 3};
    EXPECT_FALSE(cost::normal_precision_ladder({"flat", &flat, 1}));
}

TEST(CostLadders, NormalWeight) {
    auto n = climbed(ladder_named("normal-weight"));
    // Max (1999) is the best on smooth surfaces; the table of means is that of a jittered torus.
    EXPECT_LT(n["edge-length"][2], n["uniform"][2]);
    EXPECT_LT(n["edge-length"][2], n["area"][2]);
    EXPECT_LT(n["edge-length"][2], 0.335);
    EXPECT_LT(n["area"][2], 1.55);
    EXPECT_LT(n["uniform"][2], 1.12);
    EXPECT_LT(n["angle"][2], 0.635);
    EXPECT_LT(n["area-angle"][2], 1.2);
}

TEST(CostLadders, HardAngle) {
    auto n = climbed(ladder_named("hard-angle"));
    // Facets of 1.5°: corners are 0.75° off where nothing is shared.
    EXPECT_NEAR(n["0°"][0], 0.75, 0.01);
    for (const char* name : {"15°", "30°"}) EXPECT_LT(n[name][0], 1e-3);
    EXPECT_GT(n["60°"][0], 20);  // the chamfer of 45° is smeared
    EXPECT_GT(n["off"][0], 60);
    EXPECT_EQ(n["0°"][3], 2 * 240 * 4 + 2 * 240);
    EXPECT_EQ(n["30°"][3], 240 * (1 + 2 + 2 + 1));
    EXPECT_EQ(n["off"][3], 240 * 3);
}

TEST(CostLadders, TangentMode) {
    auto n = climbed(ladder_named("tangent-mode"));
    EXPECT_LT(n["mikktspace"][2], 0.035);
    EXPECT_LT(n["mikktspace"][0], 2.3);
    EXPECT_GT(n["mikktspace-exact"][2], 10 * n["mikktspace"][2]);  // corners without a gradient
}

TEST(CostLadders, SubdivisionLevel) {
    auto n = climbed(ladder_named("subdivision-level"));
    double last = 0.0102;
    for (int level = 1; level <= 6; ++level) {
        const auto& now = n["level " + std::to_string(level)];
        EXPECT_LT(now[0], last);
        EXPECT_GT(now[0], last / 20);
        EXPECT_LT(now[3], 1e-4);  // vertex normals are the limit's
        last = now[0] / 3;        // a quarter each level
    }
}

TEST(CostLadders, ChordError) {
    const Ladder ladder = ladder_named("chord-error");
    double last = 1;
    for (const cost::Rung& rung : ladder.rungs) {
        ASSERT_TRUE(rung.run());
        const std::vector<double> n = rung.judge();
        EXPECT_LE(n[0], n[4]) << "the certificate does not hold: " << rung.name;
        EXPECT_LE(n[4], n[3]) << rung.name;
        EXPECT_GT(n[0], n[3] / 10) << rung.name;  // nor ten times as fine as asked
        EXPECT_LT(n[0], last);
        last = n[0];
    }
}

TEST(CostLadders, ShadingFrequency) {
    auto n = climbed(ladder_named("shading-frequency"));
    for (const char* count : {", 80", ", 320", ", 1280", ", 5120", ", 20480"}) {
        EXPECT_LT(n[std::string("phong") + count][0], n[std::string("gouraud") + count][0]);
        EXPECT_LT(n[std::string("gouraud") + count][0], n[std::string("flat") + count][0]);
    }
    EXPECT_LT(n["flat, 20480"][0], 0.00275);
    EXPECT_LT(n["gouraud, 20480"][0], 0.00052);
    EXPECT_LT(n["phong, 20480"][0], 0.000113);
}

TEST(CostLadders, AntiAliasing) {
    const Ladder ladder = ladder_named("anti-aliasing");
    auto n = climbed(ladder);
    double last = 0.2;
    for (const char* name : {"1 sample", "2 samples", "4 samples", "8 samples", "16 samples",
                             "supersample 8", "exact areas"}) {
        EXPECT_LT(n[name][0], last) << name;
        last = n[name][0];
    }
    EXPECT_LT(n["2 samples"][0], 0.132);
    EXPECT_LT(n["4 samples"][0], 0.069);
    EXPECT_LT(n["8 samples"][0], 0.0465);
    EXPECT_LT(n["16 samples"][0], 0.0345);
    EXPECT_LT(n["supersample 4"][0], 0.025);
    EXPECT_LT(n["supersample 8"][0], 0.0088);
    // Nothing but corners on the grid of 1/256 pixel.
    EXPECT_NEAR(n["exact areas"][0], *ladder.floor, 0.05 * *ladder.floor);
}

TEST(CostLadders, AntiAliasingOfAMeshThatIsGiven) {
    const prep::Mesh mesh = shapes::icosphere(2);
    auto n = climbed(ladder_named("anti-aliasing", &mesh));
    EXPECT_LT(n["exact areas"][0], 0.003);
    EXPECT_GT(n["1 sample"][0], 0.02);
    prep::Mesh none;
    EXPECT_FALSE(cost::anti_aliasing_ladder({"none", &none, 1}));
}

TEST(CostLadders, TextureFilter) {
    auto n = climbed(ladder_named("texture-filter"));
    double last = 0.44;
    for (const char* name : {"nearest", "bilinear", "nearest-mip", "trilinear", "anisotropic 2",
                             "anisotropic 4", "anisotropic 8"}) {
        EXPECT_LT(n[name][0], last) << name;
        last = n[name][0];
    }
    EXPECT_LT(n["trilinear"][0], 0.135);
    EXPECT_LT(n["anisotropic 8"][0], 0.038);
    EXPECT_LT(n["anisotropic 16"][0], 0.037);
    EXPECT_LT(n["bicubic"][0], 0.135);
    EXPECT_LT(n["ewa 16"][0], 0.079);
    EXPECT_LT(n["ripmap"][0], 0.087);
    EXPECT_LT(n["anisotropic 8"][3], 0.035);  // FLIP
}

TEST(CostLadders, DepthFormat) {
    auto n = climbed(ladder_named("depth-format"));
    EXPECT_LT(n["float"][0], 0.001);
    EXPECT_GT(n["fixed24"][0], n["float"][0]);
    EXPECT_GT(n["fixed16"][0], n["fixed24"][0]);
    EXPECT_LT(n["fixed24"][0], 0.265);
    EXPECT_LT(n["fixed16"][0], 0.94);
}

}  // namespace
