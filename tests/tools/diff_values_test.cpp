// Every figure of `diff` against sums written out here: of pictures and of meshes, the heat map,
// and what --tolerance holds against what.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "command_runner.h"
#include "prep/image.h"
#include "steps.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;
using test::write_text;

constexpr double pi = std::numbers::pi;

json part(const test::Ran& ran, std::size_t which = 0) {
    const json document = ran.json();
    if (!document.contains("differences") || document["differences"].size() <= which) return {};
    return document["differences"][which];
}

// A picture of 8 bits and three channels, a row, from its levels.
std::string save_levels(const TempDir& dir, const std::string& name, std::uint32_t width,
                        const std::vector<int>& levels) {
    prep::Image image{width, std::uint32_t(levels.size() / 3 / width), 3, {}, true};
    for (const int level : levels) image.pixels.push_back(float(level) / 255.0f);
    EXPECT_TRUE(prep::save_image(dir / name, image));
    return (dir / name).string();
}

std::string save_floats(const TempDir& dir, const std::string& name, std::vector<float> values) {
    const prep::Image image{std::uint32_t(values.size()), 1, 1, std::move(values), false};
    EXPECT_TRUE(prep::save_image(dir / name, image, prep::PixelType::f32));
    return (dir / name).string();
}

TEST(DiffPictures, FiguresAreThoseOfAllChannelsOfAllPixels) {
    const TempDir dir;
    const std::vector<int> a = {0, 10, 200, 255, 255, 255, 7, 7, 7, 90, 80, 70};
    const std::vector<int> b = {3, 10, 190, 255, 255, 255, 7, 7, 8, 90, 130, 72};
    const std::string in_a = save_levels(dir, "a.png", 2, a),
                      in_b = save_levels(dir, "b.png", 2, b);
    double squares = 0, sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = std::abs(a[i] - b[i]) / 255.0;
        squares += d * d;
        sum += d;
    }
    const double rmse = std::sqrt(squares / 12);
    const test::Ran ran = run_here({"diff", in_a, in_b, "--json"});
    EXPECT_EQ(ran.exit_code, 0);
    const json found = part(ran);
    EXPECT_EQ(found["kind"], "pictures");
    EXPECT_EQ(found["pixels"], 4);
    EXPECT_EQ(found["different"], 3);
    EXPECT_NEAR(found["rmse"].get<double>(), rmse, 1e-8);  // 8 bits as float: steps of 6e-8
    EXPECT_NEAR(found["mean"].get<double>(), sum / 12, 1e-8);
    EXPECT_NEAR(found["psnr"].get<double>(), 10 * std::log10(1 / (rmse * rmse)), 1e-5);
    EXPECT_NEAR(found["largest"].get<double>(), 50 / 255.0, 1e-7);
    EXPECT_EQ(found["worst"], json::array({1, 1}));
    EXPECT_EQ(ran.json()["a"], in_a);
    EXPECT_EQ(ran.json()["b"], in_b);
    const std::string words = run_here({"diff", in_a, in_b}).out;
    EXPECT_NE(words.find("3 of 4 pixels differ (75.00 %)"), std::string::npos) << words;
    char line[160];
    std::snprintf(line, sizeof line, "  RMSE %.6f, PSNR %.2f dB, mean %.6f, largest %.6f at (1, 1)",
                  rmse, -20 * std::log10(rmse), sum / 12, 50 / 255.0);
    EXPECT_NE(words.find(line), std::string::npos) << words << line;
}

// A difference of one 8-bit level is 1/255: −20 log₁₀(1/255) = 48.13 dB.
TEST(DiffPictures, OneLevelEverywhereIs48Decibels) {
    const TempDir dir;
    const std::string a = save_levels(dir, "a.png", 1, {10, 20, 30});
    const std::string b = save_levels(dir, "b.png", 1, {11, 19, 31});
    EXPECT_NEAR(part(run_here({"diff", a, b, "--json"}))["psnr"].get<double>(), 48.1308, 1e-3);
}

TEST(DiffPictures, TheFirstOfEqualLargestDifferencesIsNamed) {
    const TempDir dir;
    const std::string a = save_floats(dir, "a.exr", {0, 0, 0, 0, 0});
    const std::string b = save_floats(dir, "b.exr", {0.25f, 0, 0.5f, 0.5f, 0.25f});
    EXPECT_EQ(part(run_here({"diff", a, b, "--json"}))["worst"], json::array({2, 0}));
}

// From equal to one level, 3, 15, 63 and 255: log₂(1 + level) is 0, 1, 2, 4, 6 and 8 eighths of the
// way from black over blue, red and yellow to white.
TEST(DiffPictures, HeatIsTheLogarithmOfTheLargestChannel) {
    const TempDir dir;
    const int levels[] = {0, 1, 3, 15, 63, 255};
    std::vector<int> a, b;
    for (const int level : levels) {
        a.insert(a.end(), {0, 0, 0});
        b.insert(b.end(), {level / 3, level, 0});  // the largest, not the first, not the mean
    }
    const std::string heat = (dir / "heat.png").string();
    ASSERT_EQ(run_here({"diff", save_levels(dir, "a.png", 3, a), save_levels(dir, "b.png", 3, b),
                        "--heat-map", heat})
                  .exit_code,
              0);
    const auto map = prep::load_image(heat);
    ASSERT_TRUE(map);
    ASSERT_EQ(map->width, 3u);
    ASSERT_EQ(map->height, 2u);
    const double black[3] = {0, 0, 0}, blue[3] = {0.15, 0.25, 0.85}, red[3] = {0.85, 0.15, 0.2},
                 yellow[3] = {1, 0.85, 0.2}, white[3] = {1, 1, 1};
    double half_blue[3];
    for (int k = 0; k < 3; ++k) half_blue[k] = (black[k] + blue[k]) / 2;
    const double* const expected[] = {black, half_blue, blue, red, yellow, white};
    for (std::uint32_t i = 0; i < 6; ++i)
        for (std::size_t k = 0; k < 3; ++k)  // 8 bits: half a level
            EXPECT_NEAR(double(map->at(i % 3, i / 3)[k]), expected[i][k], 0.51 / 255)
                << i << " " << k;
}

TEST(DiffPictures, HeatIsWhiteWhereAnIntegerDiffersOrOneIsInfinite) {
    const TempDir dir;
    const auto save = [&](const std::string& name, const std::vector<std::uint32_t>& words) {
        prep::ImageFiles files;
        const prep::ImageLayout layout{2, 1, {"id"}, prep::PixelType::f32, {true}, false};
        const auto file = files.open(dir / name, layout);
        EXPECT_TRUE(file && files.write_rows(*file, words) && files.commit());
        return (dir / name).string();
    };
    const auto heat = [&](const std::string& a, const std::string& b) {
        const std::string path = (dir / "heat.exr").string();
        EXPECT_EQ(run_here({"diff", a, b, "--heat-map", path}).exit_code, 0);
        const auto map = prep::load_image(path);
        return map ? std::vector<float>{map->at(0, 0)[1], map->at(1, 0)[1]} : std::vector<float>{};
    };
    EXPECT_EQ(heat(save("a.exr", {5, 5}), save("b.exr", {5, 6})), (std::vector<float>{0, 1}));
    EXPECT_EQ(heat(save_floats(dir, "c.exr", {1, HUGE_VALF}), save_floats(dir, "d.exr", {1, 1})),
              (std::vector<float>{0, 1}));
}

// One of four values differs by 1: mean 1/4, RMSE 1/2, largest 1.
TEST(DiffPictures, ToleranceIsForTheRmseAndHoldsAtEquality) {
    const TempDir dir;
    const std::string a = save_floats(dir, "a.exr", {0, 0, 0, 0});
    const std::string b = save_floats(dir, "b.exr", {0, 0, 1, 0});
    const auto run = [&](const char* tolerance) {
        return run_here({"diff", a, b, "--tolerance", tolerance, "--json"});
    };
    EXPECT_EQ(run("0.5").exit_code, 0);
    EXPECT_EQ(run("0.5").json()["within_tolerance"], true);
    const test::Ran below = run("0.499");
    EXPECT_EQ(below.exit_code, 1);
    EXPECT_EQ(below.json()["within_tolerance"], false);
    EXPECT_NE(below.err.find("further apart than the tolerance of 0.499"), std::string::npos);
    EXPECT_EQ(run("0.3").exit_code, 1);                // above the mean
    EXPECT_EQ(run("0.7").exit_code, 0);                // below the largest
    EXPECT_EQ(run_here({"diff", a, b}).exit_code, 0);  // no tolerance, no verdict
    EXPECT_EQ(run("-1").exit_code, 2);
}

TEST(DiffUsage, WhatCannotBeComparedExitsOneAndSaysWhy) {
    const TempDir dir;
    const std::string a = save_levels(dir, "a.png", 1, {1, 2, 3});
    const std::string wide = save_levels(dir, "wide.png", 2, {1, 2, 3, 4, 5, 6});
    const std::string tall = save_levels(dir, "tall.png", 1, {1, 2, 3, 4, 5, 6});
    write_text(dir / "cube.obj", test::cube_obj());
    write_text(dir / "lean.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
    const std::string cube = (dir / "cube.obj").string(), lean = (dir / "lean.obj").string();
    const struct {
        std::vector<std::string> arguments;
        const char* text;
    } cases[] = {
        {{a, wide}, "the pictures differ in size: 1×1 against 2×1"},
        {{tall, a}, "the pictures differ in size: 1×2 against 1×1"},
        {{a, cube}, "one is a picture, the other a mesh"},
        {{a, a, "--normals"}, "pictures have no normals or tangents"},
        {{cube, cube}, "the files share neither normals nor tangents"},
        {{lean, cube, "--normals"}, "the file carries no normals; 'meshprep prepare' writes"},
        {{lean, lean, "--tangents"},
         "the file carries no tangents; 'meshprep prepare --tangents mikktspace' writes"},
        {{lean, lean, "--heat-map", (dir / "h.png").string()}, "these are meshes"}};
    for (const auto& c : cases) {
        std::vector<std::string> arguments = {"diff"};
        arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
        const test::Ran ran = run_here(arguments);
        EXPECT_EQ(ran.exit_code, 1) << c.text;
        EXPECT_EQ(ran.out, "") << c.text;
        EXPECT_NE(ran.err.find(c.text), std::string::npos) << ran.err;
    }
}

// What one of them has alone is no difference of angles, and is told.
TEST(DiffUsage, WhatOneFileHasAloneIsToldAsNotCompared) {
    const TempDir dir;
    const std::string lean = (dir / "lean.obj").string(), glb = (dir / "full.glb").string();
    write_text(lean,
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n"
               "f 1/1/1 2/2/1 3/3/1\n");
    ASSERT_EQ(run_here({"prepare", lean, "-o", glb, "--tangents", "mikktspace"}).exit_code, 0);
    const std::string told =
        glb + " has tangents, and " + lean + " has none: they are not compared";
    for (const auto& [a, b] : {std::pair(lean, glb), {glb, lean}}) {
        const test::Ran ran = run_here({"diff", a, b});
        EXPECT_EQ(ran.exit_code, 0);
        EXPECT_NE(ran.err.find(told), std::string::npos) << ran.err;
        EXPECT_NE(ran.out.find("normals: 3 corners compared"), std::string::npos) << ran.out;
        EXPECT_EQ(run_here({"diff", a, b, "--normals"}).err, "");  // asked for
    }
    EXPECT_EQ(run_here({"diff", glb, glb}).err, "");
    EXPECT_EQ(run_here({"diff", lean, lean}).err, "");
}

// Triangles apart from each other along x, each with its own normals: angles from +z, by corner.
struct Leaning {
    int place = 0;
    double degrees[3] = {0, 0, 0};
    int first = 0;  // which corner is written first
};
std::string obj_of(const std::vector<Leaning>& triangles) {
    std::string text;
    char line[120];
    int n = 0;
    for (const Leaning& t : triangles) {
        const int x = 3 * t.place;
        const int corners[3][2] = {{x, 0}, {x + 1, 0}, {x, 1}};
        for (int k = 0; k < 3; ++k) {
            const int c = (k + t.first) % 3;
            const double angle = t.degrees[c] * pi / 180;
            std::snprintf(line, sizeof line, "v %d %d 0\nvn %.17g 0 %.17g\n", corners[c][0],
                          corners[c][1], std::sin(angle), std::cos(angle));
            text += line;
        }
        std::snprintf(line, sizeof line, "f %d//%d %d//%d %d//%d\n", n + 1, n + 1, n + 2, n + 2,
                      n + 3, n + 3);
        text += line;
        n += 3;
    }
    return text;
}

std::string save_leaning(const TempDir& dir, const std::string& name,
                         const std::vector<Leaning>& triangles) {
    write_text(dir / name, obj_of(triangles));
    return (dir / name).string();
}

TEST(DiffMeshes, TrianglesOfEitherFileWithoutAPartnerAreCounted) {
    const TempDir dir;
    const std::string a = save_leaning(dir, "a.obj", {{1, {}}, {2, {}}, {3, {}}});
    const std::string b = save_leaning(dir, "b.obj", {{4, {}}, {2, {}}, {5, {}}, {6, {}}});
    const std::string few = save_leaning(dir, "few.obj", {{2, {}}});
    for (const bool turned : {false, true}) {
        const std::string &left = turned ? b : a, &right = turned ? a : b;
        const test::Ran ran = run_here({"diff", left, right, "--json"});
        EXPECT_EQ(ran.exit_code, 0);
        const json found = part(ran);
        EXPECT_EQ(found["unmatched_triangles"], 5) << turned;  // 1 and 3; 4, 5 and 6
        EXPECT_EQ(found["compared"], 3) << turned;
        EXPECT_EQ(found["same_order"], false);
        const test::Ran words = run_here({"diff", left, right});
        EXPECT_NE(words.out.find("5 triangles without a partner"), std::string::npos) << words.out;
        EXPECT_NE(words.out.find("normals: 3 corners compared, triangles matched by position"),
                  std::string::npos);
        // What there is to compare is equal, and still no tolerance holds.
        EXPECT_EQ(run_here({"diff", left, right, "--tolerance", "180"}).exit_code, 1);
    }
    // In one file alone, either of the two.
    EXPECT_EQ(part(run_here({"diff", a, few, "--json"}))["unmatched_triangles"], 2);
    EXPECT_EQ(part(run_here({"diff", few, a, "--json"}))["unmatched_triangles"], 2);
    EXPECT_EQ(run_here({"diff", few, a, "--tolerance", "180"}).exit_code, 1);
}

TEST(DiffMeshes, TrianglesMeetWhateverTheirOrderAndFirstCorner) {
    const TempDir dir;
    const std::string a =
        save_leaning(dir, "a.obj", {{1, {1, 2, 3}, 0}, {2, {4, 5, 6}, 0}, {3, {7, 8, 9}, 0}});
    const std::string b =
        save_leaning(dir, "b.obj", {{3, {7, 8, 9}, 1}, {1, {1, 2, 3}, 2}, {2, {4, 5, 6}, 0}});
    const json found = part(run_here({"diff", a, b, "--json"}));
    EXPECT_EQ(found["unmatched_triangles"], 0);
    EXPECT_EQ(found["compared"], 9);
    EXPECT_EQ(found["identical"], 9);
    EXPECT_EQ(found["degrees"]["largest"], 0.0);
    EXPECT_TRUE(found["worst"].empty());
}

// Two triangles at one place: the one with the nearer UVs is the partner.
TEST(DiffMeshes, OfTrianglesAtOnePlaceTheUvsDecide) {
    const TempDir dir;
    const auto save = [&](const std::string& name, bool turned) {
        const char* left = "f 1/1/1 2/2/1 3/3/1\n";   // upright, UVs at 0
        const char* right = "f 1/4/2 2/5/2 3/6/2\n";  // leaning, UVs at 5
        write_text(dir / name,
                   std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nv 8 9 9\nv 9 8 9\n"
                               "vt 0 0\nvt 1 0\nvt 0 1\nvt 5 5\nvt 6 5\nvt 5 6\n"
                               "vn 0 0 1\nvn 1 0 0\n") +
                       (turned ? std::string(right) + left : std::string(left) + right) +
                       (turned ? "" : "f 4/1/1 5/2/1 6/3/1\n"));
        return (dir / name).string();
    };
    const json found =
        part(run_here({"diff", save("a.obj", false), save("b.obj", true), "--json"}));
    EXPECT_EQ(found["compared"], 6);
    EXPECT_EQ(found["degrees"]["largest"], 0.0);
    EXPECT_EQ(found["unmatched_triangles"], 1);
}

// Many triangles at one place, each with normals that lean alike and UVs on a lattice, where some
// are equal and some equally far.
struct Stacked {
    int uvs[6];
    double degrees;
};

std::string save_stacked(const TempDir& dir, const std::string& name,
                         const std::vector<Stacked>& triangles, double off = 0) {
    // One more, so that the files differ in their order.
    std::string text = name == "a.obj" ? "v 5 0 0\nv 6 0 0\nv 5 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n"
                                       : "v 0 0 0\nv 0 0 0\nv 0 0 0\nvn 0 0 1\n";
    text += "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    char line[200];
    for (const Stacked& t : triangles) {
        const double angle = t.degrees * pi / 180;
        const int* const uv = t.uvs;
        std::snprintf(line, sizeof line,
                      "vt %.9g %d\nvt %d %d\nvt %d %d\nvn %.17g 0 %.17g\n"
                      "f 4/-3/-1 5/-2/-1 6/-1/-1\n",
                      uv[0] + off, uv[1], uv[2], uv[3], uv[4], uv[5], std::sin(angle),
                      std::cos(angle));
        text += line;
    }
    write_text(dir / name, text);
    return (dir / name).string();
}

std::vector<Stacked> stacked(int count, int lattice, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<Stacked> triangles(std::size_t(count), Stacked{});
    for (Stacked& t : triangles) {
        for (int& uv : t.uvs) uv = int(random() % std::uint32_t(lattice));
        t.degrees = double(random() % 9000) / 100;
    }
    return triangles;
}

// In the order of the first file each takes the nearest that is left, of equally near ones the
// first.
TEST(DiffMeshes, OfManyTrianglesAtOnePlaceEachTakesTheNearestThatIsLeft) {
    const TempDir dir;
    for (const int lattice : {1, 2, 4, 1000}) {
        const std::vector<Stacked> a = stacked(120, lattice, 1), b = stacked(90, lattice, 2);
        std::vector<Stacked> left = b;
        double sum = 0;
        for (const Stacked& t : a) {
            if (left.empty()) break;
            const auto far = [&t](const Stacked& other) {
                int squares = 0;
                for (int k = 0; k < 6; ++k)
                    squares += (t.uvs[k] - other.uvs[k]) * (t.uvs[k] - other.uvs[k]);
                return squares;
            };
            const auto best = std::min_element(
                left.begin(), left.end(),
                [&](const Stacked& x, const Stacked& y) { return far(x) < far(y); });
            sum += std::abs(t.degrees - best->degrees);
            left.erase(best);
        }
        const json found = part(run_here(
            {"diff", save_stacked(dir, "a.obj", a), save_stacked(dir, "b.obj", b), "--json"}));
        EXPECT_EQ(found["compared"], 270) << lattice;
        EXPECT_EQ(found["unmatched_triangles"], 31) << lattice;
        EXPECT_NEAR(found["degrees"]["mean"].get<double>(), sum / 90, 1e-4) << lattice;
    }
}

TEST(DiffMeshes, TrianglesAtOnePlaceAreNotAllLookedAtForEach) {
    const TempDir dir;
    constexpr int count = 20000;
    // None with UVs that tell them apart; those of one file alone; all, a little off in one file;
    // all by another of their six values than the first.
    for (const auto& [a, b, first_differs] :
         {std::tuple(1, 1, true), std::tuple(1, 2, true), std::tuple(1000000, 1000000, true),
          std::tuple(1000000, 1000000, false)}) {
        std::vector<Stacked> left = stacked(count, a, 3);
        for (Stacked& t : left)
            if (!first_differs) t.uvs[0] = 0;
        std::vector<Stacked> right = a == b ? left : stacked(count, b, 4);
        std::reverse(right.begin(), right.end());
        const std::string in_a = save_stacked(dir, "a.obj", left);
        const std::string in_b = save_stacked(dir, "b.obj", right, a > 1 ? 0.25 : 0);
        const std::uint64_t steps = test::steps_of([&] {
            const json found = part(run_here({"diff", in_a, in_b, "--json"}));
            EXPECT_EQ(found["compared"], 3 * count);
        });
        EXPECT_GT(steps, std::uint64_t(count));
        EXPECT_LT(steps, std::uint64_t(100 * count)) << a << " " << b;
    }
}

// 35 triangles, corner i leans by i degrees: 105 angles, 0° to 104°.
TEST(DiffMeshes, FiguresAreThoseOfTheSortedAngles) {
    const TempDir dir;
    std::vector<Leaning> straight, leaning;
    for (int t = 0; t < 35; ++t) {
        straight.push_back({t, {}});
        leaning.push_back({t, {3.0 * t, 3.0 * t + 1, 3.0 * t + 2}});
    }
    double sum = 0, squares = 0;
    for (int i = 0; i < 105; ++i) {
        sum += i;
        squares += double(i) * i;
    }
    const json found = part(run_here({"diff", save_leaning(dir, "a.obj", straight),
                                      save_leaning(dir, "b.obj", leaning), "--json"}));
    EXPECT_EQ(found["kind"], "normals");
    EXPECT_EQ(found["compared"], 105);
    EXPECT_EQ(found["same_order"], true);
    EXPECT_EQ(found["identical"], 1);  // the one that leans by 0°
    EXPECT_EQ(found["invalid"], 0);
    const json& degrees = found["degrees"];
    // Normals are floats: each angle is good to 4e-6 degrees.
    EXPECT_NEAR(degrees["mean"].get<double>(), sum / 105, 1e-5);
    EXPECT_NEAR(degrees["rms"].get<double>(), std::sqrt(squares / 105), 1e-5);
    EXPECT_NEAR(degrees["median"].get<double>(), 52, 1e-5);  // the 53rd of 105
    EXPECT_NEAR(degrees["p99"].get<double>(), 103, 1e-5);  // ⌈0.99 · 105⌉ = 104, the last but one
    EXPECT_NEAR(degrees["largest"].get<double>(), 104, 1e-5);
    ASSERT_EQ(found["worst"].size(), 8u);
    for (int k = 0; k < 8; ++k) {
        const int i = 104 - k;
        EXPECT_NEAR(found["worst"][std::size_t(k)]["degrees"].get<double>(), i, 1e-5);
        EXPECT_EQ(found["worst"][std::size_t(k)]["mesh"], 0);
        EXPECT_EQ(found["worst"][std::size_t(k)]["face"], i / 3);
        EXPECT_EQ(found["worst"][std::size_t(k)]["corner"], i % 3);
    }
}

TEST(DiffMeshes, ToleranceIsForTheLargestAngleAndHoldsAtEquality) {
    const TempDir dir;
    // Five upright corners and one at a right angle, exactly: mean 15, RMS 37, largest 90.
    write_text(dir / "a.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nvn 1 0 0\n"
               "f 1//1 2//1 3//1\nf 2//1 4//1 3//1\n");
    write_text(dir / "b.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nvn 1 0 0\n"
               "f 1//1 2//1 3//1\nf 2//1 4//2 3//1\n");
    const auto exit_at = [&](const char* tolerance) {
        return run_here({"diff", (dir / "a.obj").string(), (dir / "b.obj").string(), "--tolerance",
                         tolerance})
            .exit_code;
    };
    EXPECT_EQ(exit_at("90"), 0);
    EXPECT_EQ(exit_at("89.9"), 1);
    EXPECT_EQ(exit_at("40"), 1);  // above RMS and mean, below the largest
    EXPECT_EQ(exit_at("16"), 1);  // above the mean
    EXPECT_EQ(exit_at("0"), 1);
}

TEST(DiffMeshes, DirectionsThatAreNoneAreCountedAndHoldNoTolerance) {
    const TempDir dir;
    const char* vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 0\nvn nan 0 1\nvn 0 0 7\n";
    const auto save = [&](const std::string& name, const std::string& face) {
        write_text(dir / name, vertices + face);
        return (dir / name).string();
    };
    const std::string a = save("a.obj", "f 1//1 2//1 3//1\n");
    for (const auto& [face, invalid] :
         {std::pair{"f 1//1 2//2 3//1\n", 1}, std::pair{"f 1//1 2//2 3//3\n", 2}}) {
        const std::string b = save("b.obj", face);
        for (const auto& [left, right] : {std::pair{a, b}, std::pair{b, a}}) {
            const test::Ran ran = run_here({"diff", left, right, "--tolerance", "180", "--json"});
            EXPECT_EQ(part(ran)["invalid"], invalid);
            EXPECT_EQ(part(ran)["compared"], 3);
            EXPECT_EQ(ran.exit_code, 1);
        }
        const std::string words = run_here({"diff", a, b}).out;
        EXPECT_NE(words.find("zero, missing or not finite in a file: " + std::to_string(invalid)),
                  std::string::npos)
            << words;
    }
    // A face without normals in one file alone.
    const char* face = "f 1//1 2//1 3//1\n";
    const std::string both = save("both.obj", std::string(face) + face),
                      half = save("half.obj", std::string(face) + "f 1 2 3\n");
    for (const auto& [left, right] : {std::pair{both, half}, std::pair{half, both}}) {
        const json found = part(run_here({"diff", left, right, "--json"}));
        EXPECT_EQ(found["compared"], 6);
        EXPECT_EQ(found["invalid"], 3);
    }
    EXPECT_EQ(part(run_here({"diff", half, half, "--json"}))["compared"], 3);
    // Length is no direction.
    const json longer = part(run_here({"diff", a, save("c.obj", "f 1//4 2//4 3//4\n"), "--json"}));
    EXPECT_EQ(longer["invalid"], 0);
    EXPECT_EQ(longer["degrees"]["largest"], 0.0);
    EXPECT_EQ(longer["identical"], 0);
}

TEST(DiffMeshes, CornersOfPolygonsAreNamedAsInTheFile) {
    const TempDir dir;
    const char* text =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\nvn 0 0 1\n"
        "vn 0.6 0 0.8\nf 1//1 2//1 3//1 4//1\n";
    write_text(dir / "a.obj", std::string(text) + "f 5//1 6//1 7//1 8//1\n");
    write_text(dir / "b.obj", std::string(text) + "f 5//1 6//1 7//1 8//2\n");
    const json found =
        part(run_here({"diff", (dir / "a.obj").string(), (dir / "b.obj").string(), "--json"}));
    ASSERT_FALSE(found["worst"].empty());
    EXPECT_EQ(found["worst"][0]["face"], 1);
    EXPECT_EQ(found["worst"][0]["corner"], 3);
    EXPECT_NEAR(found["worst"][0]["degrees"].get<double>(), std::asin(0.6) * 180 / pi, 1e-5);
}

TEST(DiffMeshes, BothAttributesAreComparedWhereBothFilesHaveThem) {
    const TempDir dir;
    // Signs: of w alone, counted by corner, whatever the angles.
    const auto save = [&](const std::string& name, const std::vector<float>& tangents) {
        test::GltfText gltf;
        gltf.add({"m",
                  {0, 0, 0, 1, 0, 0, 0, 1, 0},
                  {0, 0, 1, 0, 0, 1, 0, 0, 1},
                  {0, 0, 1, 0, 0, 1},
                  tangents,
                  {0, 1, 2},
                  "",
                  ""});
        write_text(dir / name, gltf.text());
        return (dir / name).string();
    };
    const std::string a = save("a.gltf", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
    const std::string b = save("b.gltf", {1, 0, 0, -1, 0, 1, 0, 1, 1, 0, 0, 1});
    const test::Ran ran = run_here({"diff", a, b, "--json"});
    ASSERT_EQ(ran.json()["differences"].size(), 2u) << ran.out << ran.err;
    EXPECT_EQ(part(ran, 0)["kind"], "normals");
    EXPECT_EQ(part(ran, 0)["identical"], 3);
    const json tangents = part(ran, 1);
    EXPECT_EQ(tangents["kind"], "tangents");
    EXPECT_EQ(tangents["sign_differences"], 1);
    EXPECT_EQ(tangents["identical"], 1);
    EXPECT_NEAR(tangents["degrees"]["largest"].get<double>(), 90, 1e-9);
    EXPECT_NEAR(tangents["degrees"]["mean"].get<double>(), 30, 1e-9);
    const std::string words = run_here({"diff", a, b}).out;
    EXPECT_NE(words.find("signs that differ: 1\n"), std::string::npos) << words;
    // The angles are within it, the sign is not.
    EXPECT_EQ(run_here({"diff", a, b, "--tolerance", "90"}).exit_code, 1);
    const std::string c = save("c.gltf", {1, 0, 0, 1, 0, 1, 0, 1, 1, 0, 0, 1});
    EXPECT_EQ(run_here({"diff", a, c, "--tolerance", "90"}).exit_code, 0);
    EXPECT_EQ(run_here({"diff", a, c, "--tolerance", "89"}).exit_code, 1);
    EXPECT_EQ(run_here({"diff", a, c, "--tolerance", "89", "--normals"}).exit_code, 0);
    // And the other way round: it takes both.
    std::string leaning = test::file_text(a);
    const std::vector<float> upright = {0, 0, 1, 0, 0, 1, 0, 0, 1},
                             tilted = {0, 0.6f, 0.8f, 0, 0, 1, 0, 0, 1};
    const auto coded = [](const std::vector<float>& values) {
        return test::base64_of(
            std::string(reinterpret_cast<const char*>(values.data()), values.size() * 4));
    };
    const std::size_t at = leaning.find(coded(upright));
    ASSERT_NE(at, std::string::npos);
    leaning.replace(at, coded(upright).size(), coded(tilted));
    write_text(dir / "d.gltf", leaning);
    const std::string d = (dir / "d.gltf").string();
    EXPECT_EQ(run_here({"diff", a, d, "--tolerance", "30"}).exit_code, 1);
    EXPECT_EQ(run_here({"diff", a, d, "--tolerance", "30", "--tangents"}).exit_code, 0);
}

}  // namespace
