// The ladders of `meshprep cost`: every rung's error is where it belongs. Errors are the same on
// every machine; tables hold them to 3 %, from both sides (errors that are nothing but rounding: to
// twice what was measured), so that a stage that gets worse fails here.
// tests/mutants/cost.txt has a fault for each ladder; docs/accuracy.md says how far each moves its
// error.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "climbed_ladders.h"
#include "command_runner.h"
#include "cost/ladders/ladder.h"
#include "shapes.h"

namespace {

using cost::Ladder;
using test::climbed;
using test::expect_errors;
using test::ladder_named;

TEST(CostLadders, AreNamedOnceAndSayWhatTheyTime) {
    std::set<std::string> names;
    for (const cost::LadderRow& row : cost::ladder_rows()) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        const Ladder ladder = ladder_named(row.name);
        EXPECT_EQ(ladder.name, row.name);
        EXPECT_EQ(ladder.grid.empty(), !row.grid) << row.name;
        EXPECT_FALSE(ladder.title.empty() || ladder.setting.empty() || ladder.subject.empty() ||
                     ladder.oracle.empty() || ladder.timed.empty());
        ASSERT_LT(ladder.primary, ladder.metrics.size());
        ASSERT_LT(ladder.reference, ladder.rungs.size());
        std::set<std::string> rungs;
        for (const cost::Rung& rung : ladder.rungs)
            EXPECT_TRUE(rungs.insert(rung.name).second) << rung.name;
    }
}

// What rungs that draw show: the middle of the picture as it is, and what it misses four times.
TEST(CostLadders, LooksAreAPartOfThePictureAndItsError) {
    cost::Pixels picture{128, 80, 1, {}}, truth = picture;
    for (int i = 0; i < 128 * 80; ++i) {
        picture.values.push_back(i % 128 / 128.0);
        truth.values.push_back(i % 128 / 128.0 + (i / 128 == 4 ? 0.125 : 0));
    }
    const cost::Look look = cost::look_of(picture, truth);
    EXPECT_EQ(look.picture.width, 96u);
    EXPECT_EQ(look.picture.height, 72u);
    EXPECT_EQ(look.picture.values[0], 16 / 128.0);
    EXPECT_EQ(look.picture.values[96 * 72 - 1], 111 / 128.0);
    EXPECT_EQ(look.difference.values[0], 0.5);  // row 4 is the first
    EXPECT_EQ(look.difference.values[96], 0);
    for (const cost::LadderRow& row : cost::ladder_rows()) {
        const Ladder ladder = ladder_named(row.name);
        std::size_t drawn = 0;
        for (const cost::Rung& rung : ladder.rungs) drawn += bool(rung.look);
        const std::set<std::string> draw = {
            "anti-aliasing", "texture-filter", "shading-frequency",
            "depth-format",  "scene-sampling", "samples-by-supersampling",
            "relief"};
        EXPECT_EQ(drawn, draw.count(row.name) ? ladder.rungs.size() : 0) << row.name;
    }
    const Ladder ladder = ladder_named("texture-filter");
    ASSERT_TRUE(ladder.rungs[0].run());
    const cost::Look nearest = ladder.rungs[0].look();
    double sum = 0;
    for (const double v : nearest.difference.values) sum += v;
    EXPECT_GT(sum / double(nearest.difference.values.size()), 0.1);
}

// Each command of a rung, with a mesh and an output added, is one that runs.
TEST(CostLadders, CommandsOfRungsRun) {
    const test::TempDir dir;
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
    EXPECT_GT(n["accurate"][0], 5e-14);
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

TEST(CostLadders, WeldDistance) {
    auto n = climbed(ladder_named("weld-distance"));
    EXPECT_EQ(n["0"][0], 100);  // a soup
    EXPECT_EQ(n["0.00002"][0], 0);
    EXPECT_EQ(n["0.001"][0], 0);
    EXPECT_EQ(n["0.001"][2], 0);
    EXPECT_GT(n["0.000005"][1], n["0.00001"][1]);
    EXPECT_GT(n["0.00001"][1], 0);
    EXPECT_EQ(n["0.000005"][2], 0);  // nothing melts below the scatter
    EXPECT_GT(n["0.03"][2], 5);
    EXPECT_GT(n["0.06"][2], 90);
}

TEST(CostLadders, NormalWeight) {
    auto n = climbed(ladder_named("normal-weight"));
    // Max (1999) is the best on smooth surfaces; the table of means is that of a jittered torus.
    EXPECT_LT(n["edge-length"][2], n["uniform"][2]);
    EXPECT_LT(n["edge-length"][2], n["area"][2]);
    expect_errors(n, 2,
                  {{"area", 1.285},
                   {"uniform", 0.9323},
                   {"angle", 0.5276},
                   {"area-angle", 0.9934},
                   {"edge-length", 0.2788}});
    // Inside triangles what a weight misses at corners is evened out, but for what lies between.
    expect_errors(n, 4,
                  {{"area", 0.5784},
                   {"uniform", 0.4427},
                   {"angle", 0.2762},
                   {"area-angle", 0.4659},
                   {"edge-length", 0.1579}});
    // Floats alone lie between a weight's definition and what the stage makes of it.
    for (const auto& [name, numbers] : n) EXPECT_LT(numbers[3], 5e-6) << name;
}

TEST(CostLadders, HardAngle) {
    auto n = climbed(ladder_named("hard-angle"));
    // Facets of 1.5°: corners are 0.75° off where nothing is shared.
    EXPECT_NEAR(n["0°"][0], 0.75, 0.01);
    for (const char* name : {"15°", "30°"}) EXPECT_LT(n[name][0], 1e-3);
    // Corners where a side of 45° or 90° to it is smeared in.
    expect_errors(n, 2,
                  {{"0°", 0.5121},
                   {"15°", 1.354e-5},
                   {"30°", 1.354e-5},
                   {"60°", 17.96},
                   {"90°", 35.8},
                   {"off", 35.8}});
    EXPECT_EQ(n["90°"], n["off"]);  // no edge is above 90°
    EXPECT_EQ(n["0°"][3], 2 * 240 * 4 + 2 * 240);
    EXPECT_EQ(n["30°"][3], 240 * (1 + 2 + 2 + 1));
    EXPECT_EQ(n["off"][3], 240 * 3);
}

TEST(CostLadders, TangentMode) {
    auto n = climbed(ladder_named("tangent-mode"));
    // mikktspace-exact: corners without a gradient point anywhere.
    expect_errors(n, 2,
                  {{"mikktspace", 0.02858},
                   {"mikktspace-exact", 1.094},
                   {"mikktspace, 4°", 0.0698},
                   {"mikktspace, 1°", 1.142}});
    EXPECT_LT(n["mikktspace"][0], 2);
}

TEST(CostLadders, SubdivisionLevel) {
    auto n = climbed(ladder_named("subdivision-level"));
    expect_errors(n, 0,
                  {{"level 1", 8.494e-3},
                   {"level 2", 2.335e-3},
                   {"level 3", 6.085e-4},
                   {"level 4", 1.550e-4},
                   {"level 5", 3.910e-5},
                   {"level 6", 9.815e-6}});
    double last = 0.0102;
    for (int level = 1; level <= 6; ++level) {
        const auto& now = n["level " + std::to_string(level)];
        EXPECT_LT(now[0], last);
        EXPECT_GT(now[0], last / 20);
        EXPECT_LT(now[3], 1e-4);  // vertex normals are the limit's
        // From the surface to the mesh it is as far as from the mesh to the surface, about.
        EXPECT_NEAR(now[6] / now[0], 1, 0.25) << level;
        // Between corners normals are off by a quarter each level too.
        EXPECT_LT(now[7], level == 1 ? 10 : n["level " + std::to_string(level - 1)][7] / 2.5);
        EXPECT_GT(now[7], 100 * now[3]);
        last = now[0] / 3;  // a quarter each level
    }
}

TEST(CostLadders, ChordError) {
    const Ladder ladder = ladder_named("chord-error");
    double last = 1;
    std::map<std::string, std::vector<double>> numbers;
    for (const cost::Rung& rung : ladder.rungs) {
        ASSERT_TRUE(rung.run());
        const std::vector<double> n = rung.judge();
        EXPECT_LE(n[0], n[4]) << "the certificate does not hold: " << rung.name;
        EXPECT_LE(n[4], n[3]) << rung.name;
        EXPECT_LT(n[0], last);
        // No part of the surface is without triangles.
        EXPECT_LE(n[7], n[4]) << rung.name;
        EXPECT_GE(n[7], n[0] / 3) << rung.name;
        last = n[0];
        numbers[rung.name] = n;
    }
    expect_errors(numbers, 0,
                  {{"0.0433", 6.928e-3},
                   {"0.01299", 2.411e-3},
                   {"0.00433", 8.158e-4},
                   {"0.001299", 2.360e-4},
                   {"0.000433", 8.141e-5},
                   {"0.0001299", 2.784e-5}},
                  0.1);  // where the triangles lie may move
}

TEST(CostLadders, ShadingFrequency) {
    auto n = climbed(ladder_named("shading-frequency"));
    for (const char* count : {", 80", ", 320", ", 1280", ", 5120", ", 20480"}) {
        EXPECT_LT(n[std::string("phong") + count][0], n[std::string("gouraud") + count][0]);
        EXPECT_LT(n[std::string("gouraud") + count][0], n[std::string("flat") + count][0]);
    }
    expect_errors(n, 0,
                  {{"flat, 80", 0.06316},
                   {"gouraud, 80", 0.05974},
                   {"phong, 80", 0.02238},
                   {"flat, 320", 0.03166},
                   {"gouraud, 320", 0.02435},
                   {"phong, 320", 0.005328},
                   {"flat, 1280", 0.0156},
                   {"gouraud, 1280", 0.006809},
                   {"phong, 1280", 0.001308},
                   {"flat, 5120", 0.006695},
                   {"gouraud, 5120", 0.0018},
                   {"phong, 5120", 3.204e-4},
                   {"flat, 20480", 2.369e-3},
                   {"gouraud, 20480", 4.443e-4},
                   {"phong, 20480", 7.77e-5}});
    // What a coarse ball misses is no matter of shading: alike for all three.
    for (const char* word : {"gouraud, 80", "phong, 80"})
        EXPECT_NEAR(n[word][2] / n["flat, 80"][2], 1, 0.03) << word;
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
    expect_errors(n, 0,
                  {{"1 sample", 0.1694},
                   {"2 samples", 0.1103},
                   {"4 samples", 0.06293},
                   {"8 samples", 0.03863},
                   {"16 samples", 0.02875},
                   {"supersample 2", 0.05965},
                   {"supersample 4", 0.02066},
                   {"supersample 8", 0.007261},
                   {"exact areas", 5.057e-4}});
    // Each setting has exactly the samples that it says, areas to a float's rounding.
    for (const auto& [name, numbers] : n)
        EXPECT_LE(numbers[3], name == "exact areas" ? 3e-8 : 0) << name;
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
    // Too small for floats, which drew nothing.
    prep::Mesh small = shapes::icosphere(1);
    for (glm::vec3& p : small.positions) p *= 1e-36f;
    EXPECT_FALSE(cost::anti_aliasing_ladder({"small", &small, 1}));
    // A corner that is nowhere takes its triangles along, and no more; and front and back of a
    // ball cover a pixel once.
    prep::Mesh ball = shapes::icosphere(2);
    ball.positions[7].y = NAN;
    const Ladder of_ball = ladder_named("anti-aliasing", &ball);
    EXPECT_NE(of_ball.subject.find(": 315 triangles"), std::string::npos) << of_ball.subject;
    auto nowhere = climbed(of_ball);
    EXPECT_LT(nowhere["exact areas"][0], 0.001);
    EXPECT_LT(nowhere["exact areas"][3], 0.001);
    EXPECT_GT(nowhere["1 sample"][0], 0.01);
}

// Highlights too are between pixels: supersampling sees them, samples of one shading do not.
TEST(CostLadders, SceneSampling) {
    auto n = climbed(ladder_named("scene-sampling"));
    const std::pair<const char*, double> wanted[] = {
        {"1 sample", 0.00865},      {"2 samples", 0.00567},     {"4 samples", 0.00385},
        {"8 samples", 0.00247},     {"16 samples", 0.00186},    {"supersample 2", 0.00313},
        {"supersample 4", 0.00103}, {"supersample 8", 3.81e-4}, {"exact areas", 2.86e-4}};
    for (const auto& [name, rmse] : wanted) EXPECT_NEAR(n[name][0], rmse, 0.03 * rmse) << name;
}

TEST(CostLadders, TextureFilter) {
    const Ladder ladder = ladder_named("texture-filter");
    auto n = climbed(ladder);
    double last = 0.44;
    for (const char* name : {"nearest", "bilinear", "nearest-mip", "trilinear", "anisotropic 2",
                             "anisotropic 4", "anisotropic 8"}) {
        EXPECT_LT(n[name][0], last) << name;
        last = n[name][0];
    }
    expect_errors(n, 0,
                  {{"nearest", 0.3683},
                   {"bilinear", 0.303},
                   {"nearest-mip", 0.1247},
                   {"trilinear", 0.1117},
                   {"bicubic", 0.1095},
                   {"anisotropic 2", 0.05862},
                   {"anisotropic 4", 0.03522},
                   {"anisotropic 8", 0.02945},
                   {"anisotropic 16", 0.02891},
                   {"ripmap", 0.07157},
                   {"ewa 8", 0.06381},
                   {"ewa 16", 0.06357}});
    expect_errors(n, 3,  // FLIP
                  {{"nearest", 0.2548},
                   {"bilinear", 0.2126},
                   {"nearest-mip", 0.08691},
                   {"trilinear", 0.08118},
                   {"bicubic", 0.07915},
                   {"anisotropic 2", 0.04176},
                   {"anisotropic 4", 0.03088},
                   {"anisotropic 8", 0.02801},
                   {"anisotropic 16", 0.02782},
                   {"ripmap", 0.04968},
                   {"ewa 8", 0.0377},
                   {"ewa 16", 0.03742}});
    EXPECT_LT(*ladder.floor, 0.001);  // the truth is sharper than any rung
}

TEST(CostLadders, DepthFormat) {
    auto n = climbed(ladder_named("depth-format"));
    EXPECT_LT(n["float"][0], 0.001);
    EXPECT_GT(n["fixed24"][0], n["float"][0]);
    EXPECT_GT(n["fixed16"][0], n["fixed24"][0]);
    EXPECT_NEAR(n["fixed24"][0], 0.2207, 0.01);
    EXPECT_NEAR(n["fixed16"][0], 0.7773, 0.02);
}

// Half a step in each of three coordinates at worst; the truth is the surface, so that what the
// mesh itself rounds is in it.
TEST(CostLadders, QuantizedPositions) {
    auto n = climbed(ladder_named("quantized-positions"));
    for (const int bits : {6, 8, 10, 12, 14, 16}) {
        const auto& now = n[std::to_string(bits) + " bits"];
        // The longest side, 2.8, of a diagonal of 4.0.
        EXPECT_LE(now[0], std::sqrt(3.0) / 2 * 0.71 / (std::exp2(bits) - 1) + 1e-7) << bits;
        EXPECT_GE(now[0], std::sqrt(3.0) / 2 * 0.6 / (std::exp2(bits) - 1)) << bits;
        EXPECT_LT(now[3], n["floats"][3]) << bits;
    }
    expect_errors(n, 0,
                  {{"6 bits", 8.97e-3},
                   {"8 bits", 2.29e-3},
                   {"10 bits", 5.54e-4},
                   {"12 bits", 1.39e-4},
                   {"14 bits", 3.40e-5},
                   {"16 bits", 8.77e-6},
                   {"floats", 1.63e-8}});
    EXPECT_GT(n["floats"][0], 5e-9);
    EXPECT_LT(n["8 bits"][3], n["10 bits"][3]);
}

TEST(CostLadders, QuantizedDirections) {
    for (const char* name : {"quantized-normals", "quantized-tangents"}) {
        auto n = climbed(ladder_named(name));
        for (const int bits : {8, 9, 10, 12, 14, 16}) {
            const double step = 1 / (std::exp2(bits - 1) - 1);  // of coordinates up to 1
            const double worst = std::sqrt(3.0) / 2 * step * 180 / std::numbers::pi;
            const auto& now = n[std::to_string(bits) + " bits"];
            EXPECT_LE(now[0], worst) << name << ", " << bits;
            EXPECT_GE(now[0], worst / 2) << name << ", " << bits;
        }
        EXPECT_LT(n["floats"][0], 5e-6) << name;
    }
}

TEST(CostLadders, QuantizedUvs) {
    auto n = climbed(ladder_named("quantized-uvs"));
    for (const int bits : {6, 8, 10, 12, 14, 16}) {
        const auto& now = n[std::to_string(bits) + " bits"];
        // Half a step, and half of one of the type that it is stored in.
        const double stored = bits == 6       ? 255
                              : bits % 8 == 0 ? std::numeric_limits<double>::infinity()
                                              : 65535;
        EXPECT_LE(now[0], 0.5 / (std::exp2(bits) - 1) + 0.5 / stored + 1e-7) << bits;
        EXPECT_GE(now[0], 0.45 / (std::exp2(bits) - 1)) << bits;
    }
    EXPECT_LT(n["floats"][0], 3e-8);
}

// Nothing to read is no small error.
TEST(CostLadders, FilesThatWereNotWrittenAreInfinitelyFar) {
    const Ladder ladder = ladder_named("quantized-uvs");
    EXPECT_EQ(ladder.rungs[0].judge()[0], std::numeric_limits<double>::infinity());
}

TEST(CostLadders, DisplacementError) {
    const Ladder ladder = ladder_named("displacement-error");
    double last = 1;
    for (const cost::Rung& rung : ladder.rungs) {
        ASSERT_TRUE(rung.run());
        const std::vector<double> n = rung.judge();
        EXPECT_LE(n[0], n[4]) << "the certificate does not hold: " << rung.name;
        EXPECT_LE(n[4], n[3]) << rung.name;
        EXPECT_GE(n[0], n[3] * 0.85) << rung.name << " is finer than was asked";
        EXPECT_GE(n[0], n[4] * 0.9) << rung.name << " is proved with waste";
        EXPECT_LT(n[0], last);
        last = n[0];
    }
}

TEST(CostLadders, HeightFilter) {
    auto n = climbed(ladder_named("height-filter"));
    // Bilinear: a quarter with twice the texels, as far as triangles are fine enough.
    EXPECT_NEAR(n["bilinear, 16²"][0] / n["bilinear, 32²"][0], 4, 0.6);
    for (const char* size : {", 16²", ", 32²", ", 64²"})
        EXPECT_LT(n[std::string("bicubic") + size][0], n[std::string("bilinear") + size][0] / 1.5)
            << size;
    expect_errors(n, 0,
                  {{"bilinear, 16²", 2.32e-3},
                   {"bicubic, 16²", 2.72e-4},
                   {"bilinear, 32²", 5.89e-4},
                   {"bicubic, 32²", 1.10e-4},
                   {"bilinear, 64²", 1.84e-4},
                   {"bicubic, 64²", 9.51e-5},
                   {"bilinear, 128²", 1.32e-4},
                   {"bicubic, 128²", 9.67e-5}},
                  0.1);  // where the triangles lie may move
}

TEST(CostLadders, BandLimit) {
    auto n = climbed(ladder_named("band-limit"));
    // As read, vertices have the ripples: a fiftieth of the wave's 0.05.
    EXPECT_NEAR(n["none"][0], 0.02 * 0.05, 1e-4);
    EXPECT_LT(n["0.02"][0], n["none"][0] / 4);
    expect_errors(n, 0,
                  {{"none", 9.43e-4},
                   {"0.01", 8.63e-4},
                   {"0.02", 8.14e-5},
                   {"0.04", 6.26e-4},
                   {"0.08", 8.97e-4},
                   {"0.16", 4.57e-3}});
}

TEST(CostLadders, Relief) {
    auto n = climbed(ladder_named("relief"));
    expect_errors(n, 2,
                  {{"bump map, 32²", 0.2949},
                   {"bump map, 64²", 0.07118},
                   {"bump map, 128²", 0.01899},
                   {"bump map, 256²", 8.286e-3},
                   {"normal map, 32²", 0.2980},
                   {"normal map, 64²", 0.07208},
                   {"normal map, 128²", 0.01932},
                   {"normal map, 256²", 8.504e-3},
                   {"displaced, 0.003", 0.8273},
                   {"displaced, 0.001", 0.3250},
                   {"displaced, 0.0003", 0.09172},
                   {"displaced, 0.0001", 0.03620}});
    // What a pixel shows is off by at most as much as its normal turns.
    for (const auto& [name, numbers] : n)
        EXPECT_LT(numbers[3], numbers[0] * std::numbers::pi / 180) << name;
    EXPECT_EQ(n["bump map, 64²"][4], 2);
    EXPECT_GT(n["displaced, 0.0001"][4], 2 * n["displaced, 0.0003"][4]);
}

}  // namespace
