// Displacement and tessellation from the command line: heights of closed form, read back from the
// written files; the report against what was asked and against counts made here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "command_runner.h"
#include "prep/displacement/tessellate.h"
#include "prep/image.h"
#include "prep/load.h"
#include "subdivision_oracle.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;
using test::write_text;

// The square (0, 0) … (2, 2) at z = 0 with UVs 0 … 1, facing up.
const std::string square =
    "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";

struct Vertex {
    double x, y, z;
};

struct Written {
    test::Ran ran;
    json file;
    std::vector<Vertex> points;
    std::vector<std::array<std::size_t, 3>> triangles;
    const json& certificate() const { return file["tessellated"][0]; }
    bool has(const std::string& kind) const {
        for (const json& finding : file["findings"])
            if (finding["kind"] == kind) return true;
        return false;
    }
};

class Displace : public testing::Test {
  protected:
    // A map whose texels are what `texel` says of their column and row, the top row first.
    template <class Texel>
    std::string map(const std::string& name, std::uint32_t size, prep::PixelType type,
                    const Texel& texel) {
        prep::Image image{.width = size, .height = size, .channels = 1, .pixels = {}};
        for (std::uint32_t y = 0; y < size; ++y)
            for (std::uint32_t x = 0; x < size; ++x) image.pixels.push_back(float(texel(x, y)));
        const auto saved = prep::save_image(dir_ / name, image, type);
        EXPECT_TRUE(saved) << to_string(saved.error());
        return (dir_ / name).string();
    }

    Written prepared(const std::string& obj, std::vector<std::string> options) {
        write_text(dir_ / "cage.obj", obj);
        options.insert(options.begin(), {"prepare", (dir_ / "cage.obj").string(), "-o",
                                         (dir_ / "out.obj").string(), "--json"});
        Written out;
        out.ran = run_here(options);
        if (out.ran.exit_code != 0) return out;
        out.file = out.ran.json()["files"][0];
        std::istringstream in(test::file_text(dir_ / "out.obj"));
        for (std::string line; std::getline(in, line);) {
            std::istringstream words(line);
            std::string head;
            words >> head;
            if (head == "v") {
                Vertex v{};
                words >> v.x >> v.y >> v.z;
                out.points.push_back(v);
            } else if (head == "f") {
                std::array<std::size_t, 3> corners{};
                for (std::size_t& corner : corners) {
                    std::string word;
                    words >> word;
                    corner = std::stoul(word) - 1;
                }
                out.triangles.push_back(corners);
            }
        }
        return out;
    }

    TempDir dir_;
};

// White above, black below its middle, by exactly half the scale.
TEST_F(Displace, MovesByScaleTimesTexelMinusMidlevel) {
    const std::string white =
        map("white.exr", 4, prep::PixelType::f32, [](auto, auto) { return 1; });
    struct Row {
        std::vector<std::string> options;
        double z;
    };
    for (const Row& row : {Row{{}, 0.5}, Row{{"--height-scale", "0.2"}, 0.1},
                           Row{{"--height-scale", "-3", "--height-midlevel", "0.25"}, -2.25}}) {
        std::vector<std::string> options{"--displace", white, "--edge-length", "0.5"};
        options.insert(options.end(), row.options.begin(), row.options.end());
        const Written out = prepared(square, options);
        ASSERT_EQ(out.ran.exit_code, 0) << out.ran.err;
        ASSERT_GT(out.points.size(), 20U);
        for (const Vertex& v : out.points) EXPECT_NEAR(v.z, row.z, 1e-6);
    }
}

// A tent of one texel on one quad: its peak is there, and few triangles are spent on it.
TEST_F(Displace, ATexelsSpikeIsFoundAtAFewTriangles) {
    constexpr std::uint32_t size = 512, column = 301, row = 77;
    const std::string spike = map("spike.exr", size, prep::PixelType::f32,
                                  [](auto x, auto y) { return x == column && y == row ? 1 : 0; });
    const Written out = prepared(square, {"--displace", spike, "--height-midlevel", "0",
                                          "--height-scale", "0.4", "--chord-error", "0.05"});
    ASSERT_EQ(out.ran.exit_code, 0) << out.ran.err;
    const json& certificate = out.certificate();
    EXPECT_EQ(certificate["asked"], 0.05);
    EXPECT_LE(certificate["proved"].get<double>(), 0.05);
    EXPECT_LE(certificate["measured"].get<double>(), certificate["proved"].get<double>());
    EXPECT_EQ(certificate["triangles"], out.triangles.size());
    EXPECT_LE(out.triangles.size(), 5000U);
    EXPECT_EQ(certificate["unresolved"], 0);
    Vertex top{};
    for (const Vertex& v : out.points)
        if (v.z > top.z) top = v;
    EXPECT_GE(top.z, 0.4 - 0.05);
    EXPECT_NEAR(top.x, 2 * (column + 0.5) / size, 2.0 / size);
    EXPECT_NEAR(top.y, 2 * (1 - (row + 0.5) / size), 2.0 / size);
    // Half the tent's height is asked: without the heights nothing would be halved.
    EXPECT_EQ(prepared(square, {"--chord-error", "0.05"}).triangles.size(), 2U);
}

TEST_F(Displace, TrianglesAreAtMostWhatWasAsked) {
    const std::string waves = map("waves.exr", 64, prep::PixelType::f32, [](auto x, auto y) {
        return 0.5 + 0.5 * std::sin(0.3 * x) * std::cos(0.2 * y);
    });
    double last = 1e9;
    for (const auto& [text, most] :
         {std::pair{"300", 300}, std::pair{"2k", 2000}, std::pair{"0.01M", 10000}}) {
        const Written out = prepared(
            square, {"--displace", waves, "--height-scale", "0.3", "--max-triangles", text});
        ASSERT_EQ(out.ran.exit_code, 0) << out.ran.err;
        EXPECT_LE(out.triangles.size(), std::size_t(most));
        EXPECT_GE(out.triangles.size(), std::size_t(most * 0.95));
        EXPECT_FALSE(out.certificate().contains("asked"));
        EXPECT_LT(out.certificate()["proved"].get<double>(), last);
        last = out.certificate()["proved"].get<double>();
    }
}

// What a budget cuts short is told, and so is one below the coarsest triangles.
TEST_F(Displace, BudgetsThatAreMissedAreTold) {
    const std::string waves = map("waves.exr", 64, prep::PixelType::f32, [](auto x, auto y) {
        return 0.5 + 0.5 * std::sin(0.3 * x) * std::cos(0.2 * y);
    });
    const Written cut =
        prepared(square, {"--displace", waves, "--chord-error", "1e-4", "--max-triangles", "500"});
    ASSERT_EQ(cut.ran.exit_code, 0) << cut.ran.err;
    EXPECT_TRUE(cut.has("budget-reached"));
    EXPECT_FALSE(cut.has("unresolved-error"));
    EXPECT_EQ(cut.certificate()["unresolved"], 0);
    EXPECT_GT(cut.certificate()["over_budget"].get<int>(), 0);
    EXPECT_GT(cut.certificate()["proved"].get<double>(), 1e-4);
    const Written few = prepared(square, {"--displace", waves, "--max-triangles", "1"});
    ASSERT_EQ(few.ran.exit_code, 0) << few.ran.err;
    EXPECT_TRUE(few.has("budget-too-small"));
    EXPECT_EQ(few.triangles.size(), 2U);
}

// Two squares whose charts lie at heights 0 and ½: their shared edge is at ¼, off by ¼ from both.
TEST_F(Displace, HeightsThatDifferAcrossASeamAreTold) {
    const std::string steps =
        map("steps.exr", 16, prep::PixelType::f32, [](auto x, auto) { return x < 6 ? 0.5 : 1; });
    const std::string squares =
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
        "vt 0.05 0.1\nvt 0.2 0.1\nvt 0.2 0.9\nvt 0.05 0.9\n"
        "vt 0.6 0.1\nvt 0.8 0.1\nvt 0.8 0.9\nvt 0.6 0.9\n"
        "f 1/1 2/2 5/3 4/4\nf 2/5 3/6 6/7 5/8\n";
    const Written missed = prepared(squares, {"--displace", steps, "--chord-error", "0.05"});
    ASSERT_EQ(missed.ran.exit_code, 0) << missed.ran.err;
    EXPECT_TRUE(missed.has("seam-gap"));
    EXPECT_FALSE(missed.has("unresolved-error"));
    EXPECT_NEAR(missed.certificate()["largest_shared_gap"].get<double>(), 0.25, 1e-6);
    EXPECT_GE(missed.certificate()["proved"].get<double>(), 0.25);
    const Written met = prepared(squares, {"--displace", steps, "--chord-error", "0.6"});
    ASSERT_EQ(met.ran.exit_code, 0) << met.ran.err;
    EXPECT_FALSE(met.has("seam-gap"));
    EXPECT_LE(met.certificate()["proved"].get<double>(), 0.6);
    // The same in pixels, which the text then tells.
    const Written pixels =
        prepared(squares, {"--displace", steps, "--pixel-error", "2", "--camera", "0,30"});
    ASSERT_EQ(pixels.ran.exit_code, 0) << pixels.ran.err;
    EXPECT_TRUE(pixels.has("seam-gap"));
    EXPECT_NE(pixels.file["findings"].dump().find("instead of 2 pixels"), std::string::npos)
        << pixels.file["findings"];
    EXPECT_EQ(pixels.certificate()["unresolved"], 0);
    EXPECT_GT(pixels.certificate()["proved_pixels"].get<double>(), 50);
    const Written seen =
        prepared(squares, {"--displace", steps, "--pixel-error", "1000", "--camera", "0,30"});
    ASSERT_EQ(seen.ran.exit_code, 0) << seen.ran.err;
    EXPECT_FALSE(seen.has("seam-gap"));
}

TEST_F(Displace, WithoutAGoalAThousandthOfTheDiagonal) {
    const std::string hill =
        map("hill.exr", 16, prep::PixelType::f32, [](auto x, auto) { return x < 8 ? 0 : 1; });
    const Written out = prepared(square, {"--displace", hill, "--height-scale", "0.2"});
    ASSERT_EQ(out.ran.exit_code, 0) << out.ran.err;
    EXPECT_NEAR(out.certificate()["asked"].get<double>(), std::sqrt(8.0) / 1000, 1e-12);
}

// Two materials, one with a map of its own, one without.
TEST_F(Displace, MaterialsHaveTheirOwnMaps) {
    map("up.exr", 4, prep::PixelType::f32, [](auto, auto) { return 1; });
    write_text(dir_ / "two.mtl", "newmtl raised\ndisp up.exr\nnewmtl plain\n");
    const std::string two =
        "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl raised\nf 1/1 2/2 3/3 4/4\n"
        "usemtl plain\nf 5/1 6/2 7/3 8/4\n";
    const Written out = prepared(two, {"--displace", "materials", "--edge-length", "1"});
    ASSERT_EQ(out.ran.exit_code, 0) << out.ran.err;
    ASSERT_GT(out.points.size(), 8U);
    // MTL's heights are base + gain · texel: 0 moves nothing.
    for (const Vertex& v : out.points) EXPECT_NEAR(v.z, v.x < 3 ? 1 : 0, 1e-6);
    const Written other = prepared(two, {"--displace", "materials", "--height-scale", "0.5",
                                         "--height-midlevel", "0.25", "--edge-length", "1"});
    ASSERT_GT(other.points.size(), 8U);
    for (const Vertex& v : other.points) EXPECT_NEAR(v.z, v.x < 3 ? 0.375 : 0, 1e-6);
    EXPECT_FALSE(out.has("no-displacement-map"));
    // -bm multiplies; what was displaced is not displaced again.
    write_text(dir_ / "two.mtl", "newmtl raised\ndisp -bm 0.25 up.exr\nnewmtl plain\n");
    const Written less = prepared(two, {"--displace", "materials", "--edge-length", "1"});
    ASSERT_GT(less.points.size(), 8U);
    for (const Vertex& v : less.points) EXPECT_NEAR(v.z, v.x < 3 ? 0.25 : 0, 1e-6);
    for (const char* const name : {"again.obj", "again.glb"}) {
        const std::string again = (dir_ / name).string();
        ASSERT_EQ(run_here({"prepare", (dir_ / "cage.obj").string(), "-o", again, "--displace",
                            "materials"})
                      .exit_code,
                  0);
        const test::Ran second = run_here({"prepare", again, "-o", (dir_ / "second.obj").string(),
                                           "--displace", "materials", "--json"});
        ASSERT_EQ(second.exit_code, 0) << second.err;
        const json file = second.json()["files"][0];
        ASSERT_FALSE(file.contains("tessellated")) << name;
        EXPECT_EQ(file["findings"][0]["kind"], "no-displacement-map") << name;
    }
    EXPECT_TRUE(prepared(square, {"--displace", "materials", "--edge-length", "1"})
                    .has("no-displacement-map"));
}

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 d = b - a;
    const double t = std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0, 1.0);
    return glm::length(p - a - t * d);
}
double distance_to_triangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& t) {
    const glm::dvec3 n = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
    bool inside = true;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &a = t[k], &b = t[(k + 1) % 3];
        inside = inside && glm::dot(glm::cross(b - a, p - a), n) >= 0;
        nearest = std::min(nearest, distance_to_segment(p, a, b));
    }
    return inside ? std::abs(glm::dot(p - t[0], n)) : nearest;
}

// A cube as a cage: limit points by the published rules, in long double, are within the error of
// the triangles, which are closed.
TEST_F(Displace, LimitSurfacesAreTessellatedToTheError) {
    const std::string cube =
        "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
        "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    const Written coarse = prepared(cube, {"--subdivide", "catmark", "--chord-error", "0.02"});
    ASSERT_EQ(coarse.ran.exit_code, 0) << coarse.ran.err;
    const Written fine = prepared(cube, {"--subdivide", "catmark", "--chord-error", "0.002"});
    ASSERT_EQ(fine.ran.exit_code, 0) << fine.ran.err;
    EXPECT_GT(fine.triangles.size(), 3 * coarse.triangles.size());
    EXPECT_LE(coarse.certificate()["proved"].get<double>(), 0.02);
    EXPECT_LE(fine.certificate()["proved"].get<double>(), 0.002);
    const auto scene = prep::load_scene(dir_ / "cage.obj");
    ASSERT_TRUE(scene) << to_string(scene.error());
    // At odd multiples of 2⁻⁹ and their like: coarser ones are vertices.
    std::vector<test::SubdivisionOracle::Location> places;
    for (std::uint32_t face = 0; face < 6; ++face)
        for (std::uint32_t x = 19; x < 512; x += 42)
            for (std::uint32_t y = 13; y < 512; y += 46) places.push_back({face, 0, x, y});
    const auto limits = test::SubdivisionOracle(scene->meshes[0], {}).limits(places, 9);
    for (const auto& [made, error] : {std::pair(&coarse, 0.02), std::pair(&fine, 0.002)}) {
        double farthest = 0;
        for (const auto& limit : limits) {
            double nearest = std::numeric_limits<double>::infinity();
            for (const auto& t : made->triangles) {
                std::array<glm::dvec3, 3> corners;
                for (std::size_t k = 0; k < 3; ++k) {
                    const Vertex& v = made->points[t[k]];
                    corners[k] = {v.x, v.y, v.z};
                }
                nearest =
                    std::min(nearest, distance_to_triangle(glm::dvec3(limit.position), corners));
            }
            farthest = std::max(farthest, nearest);
        }
        EXPECT_LE(farthest, error);
        EXPECT_GT(farthest, error / 100) << "far fewer triangles would have done";
    }
    // Closed: every edge once each way.
    std::map<std::pair<std::size_t, std::size_t>, int> edges;
    for (const auto& t : fine.triangles)
        for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        EXPECT_EQ(edges.count({edge.second, edge.first}), 1U);
    }
}

TEST_F(Displace, FindingsSayWhatTheMapHolds) {
    const auto ramp = [](auto x, auto) { return x / 63.0; };
    const std::string bytes = map("ramp8.png", 64, prep::PixelType::u8, ramp);
    const std::string words = map("ramp16.png", 64, prep::PixelType::u16, [&](auto x, auto y) {
        return ramp(x, y) * 0.987;  // not what eight bits hold
    });
    EXPECT_TRUE(
        prepared(square, {"--displace", bytes, "--max-triangles", "100"}).has("coarse-heights"));
    EXPECT_FALSE(
        prepared(square, {"--displace", words, "--max-triangles", "100"}).has("coarse-heights"));
}

// x, y, z of the file's first three channels; floats stand as they are, 0.5 moves nothing in
// integers.
TEST_F(Displace, VectorMapsMoveByTheirVectors) {
    const glm::dvec3 step(0.25, -0.5, 0.125);
    for (const bool floats : {true, false}) {
        const char* const name = floats ? "step.exr" : "step.png";
        prep::Image image{.width = 4, .height = 4, .channels = 3, .pixels = {}};
        for (int i = 0; i < 16; ++i)
            for (int k = 0; k < 3; ++k)
                image.pixels.push_back(
                    float(floats ? step[k] : (32768 + 65535 * step[k] / 2) / 65535));
        ASSERT_TRUE(prep::save_image(dir_ / name, image,
                                     floats ? prep::PixelType::f32 : prep::PixelType::u16));
        const Written out =
            prepared(square, {"--displace", (dir_ / name).string(), "--displace-kind",
                              "vector-object", "--height-scale", "2", "--edge-length", "0.45"});
        ASSERT_EQ(out.ran.exit_code, 0) << out.ran.err;
        const Written rest = prepared(square, {"--edge-length", "0.45"});
        ASSERT_EQ(out.points.size(), rest.points.size());
        // A step of 16 bits, halved by rounding, twice the scale.
        const double most = floats ? 1e-6 : 2.0 / 65535;
        const double scale = floats ? 2 : 1;
        for (std::size_t v = 0; v < rest.points.size(); ++v) {
            EXPECT_NEAR(out.points[v].x - rest.points[v].x, scale * step.x, most) << name;
            EXPECT_NEAR(out.points[v].y - rest.points[v].y, scale * step.y, most) << name;
            EXPECT_NEAR(out.points[v].z - rest.points[v].z, scale * step.z, most) << name;
        }
    }
    // Eight bits are as coarse as those of heights.
    const prep::Image steps{.width = 1, .height = 1, .channels = 3, .pixels = {0.2F, 0.4F, 0.6F}};
    for (const auto type : {prep::PixelType::u8, prep::PixelType::u16}) {
        prep::Image image = steps;
        if (type == prep::PixelType::u16) image.pixels[0] = 0.12345F;
        ASSERT_TRUE(prep::save_image(dir_ / "steps.png", image, type));
        EXPECT_EQ(prepared(square, {"--displace", (dir_ / "steps.png").string(), "--displace-kind",
                                    "vector-object", "--edge-length", "1"})
                      .has("coarse-heights"),
                  type == prep::PixelType::u8);
    }
    const std::string grey = map("grey.exr", 2, prep::PixelType::f32, [](auto, auto) { return 1; });
    EXPECT_EQ(
        prepared(square, {"--displace", grey, "--displace-kind", "vector-object"}).ran.exit_code,
        1);
}

// Along the tangent (u grows with x here), up in the picture (y), and along the normal, in the
// order that is said.
TEST_F(Displace, VectorMapsInTangentSpaceMoveAlongTheirAxes) {
    const glm::dvec3 step(0.25, -0.5, 0.125);
    prep::Image image{.width = 4, .height = 4, .channels = 3, .pixels = {}};
    for (int i = 0; i < 48; ++i) image.pixels.push_back(float(step[i % 3]));
    const std::string file = (dir_ / "tangent.exr").string();
    ASSERT_TRUE(prep::save_image(file, image, prep::PixelType::f32));
    const Written rest = prepared(square, {"--edge-length", "0.45"});
    for (const char* const axes : {"", "tangent-normal-bitangent", "tangent-bitangent-normal"}) {
        std::vector<std::string> options{
            "--displace", file, "--displace-kind", "vector-tangent", "--edge-length", "0.45"};
        if (*axes) options.insert(options.end(), {"--displace-axes", axes});
        const Written out = prepared(square, options);
        ASSERT_EQ(out.ran.exit_code, 0) << out.ran.err;
        ASSERT_EQ(out.points.size(), rest.points.size());
        const bool normal_last = std::string(axes) == "tangent-bitangent-normal";
        for (std::size_t v = 0; v < rest.points.size(); ++v) {
            EXPECT_NEAR(out.points[v].x - rest.points[v].x, step.x, 1e-6) << axes;
            EXPECT_NEAR(out.points[v].y - rest.points[v].y, normal_last ? step.y : step.z, 1e-6);
            EXPECT_NEAR(out.points[v].z - rest.points[v].z, normal_last ? step.z : step.y, 1e-6);
        }
    }
}

TEST_F(Displace, NoiseMovesByItsValue) {
    prep::NoiseOptions noise{.kind = prep::NoiseKind::simplex,
                             .frequency = 1.5,
                             .octaves = 3,
                             .lacunarity = 2.2,
                             .gain = 0.4,
                             .seed = 7,
                             .scale = 0.3};
    const auto field = prep::noise_function(noise);
    ASSERT_TRUE(field);
    std::vector<std::string> options{"--displace",      "noise",     "--noise",           "simplex",
                                     "--noise-scale",   "0.3",       "--noise-frequency", "1.5",
                                     "--noise-octaves", "3,2.2,0.4", "--noise-seed",      "7",
                                     "--chord-error",   "0.01"};
    const Written out = prepared(square, options);
    ASSERT_EQ(out.ran.exit_code, 0) << out.ran.err;
    EXPECT_LE(out.certificate()["proved"].get<double>(), 0.01);
    ASSERT_GT(out.points.size(), 100U);
    double highest = 0;
    for (const Vertex& v : out.points) {
        EXPECT_NEAR(v.z, (*field)->at({v.x, v.y, 0}).value, 1e-6);
        highest = std::max(highest, std::abs(v.z));
    }
    EXPECT_GT(highest, 0.05);
    // No UVs are needed; with a map both add up.
    const Written bare = prepared("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", options);
    EXPECT_EQ(bare.ran.exit_code, 0) << bare.ran.err;
    const std::string white =
        map("white.exr", 4, prep::PixelType::f32, [](auto, auto) { return 1; });
    options[1] = white;
    const Written both = prepared(square, options);
    ASSERT_EQ(both.ran.exit_code, 0) << both.ran.err;
    ASSERT_GT(both.points.size(), 100U);
    for (const Vertex& v : both.points)
        EXPECT_NEAR(v.z, 0.5 + (*field)->at({v.x, v.y, 0}).value, 1e-6);
    options[1] = "materials";
    EXPECT_EQ(prepared(square, options).ran.exit_code, 2);
}

// What samples of a length cannot carry is left out: of maps, whose lengths are the mesh's and not
// the map's, and of noise.
TEST_F(Displace, BandLimitsLeaveOutWhatSamplesCannotCarry) {
    // 2 and 20 waves over the square's two units.
    constexpr double pi = 3.14159265358979323846;
    const std::string two = map("waves.exr", 256, prep::PixelType::f32, [](auto x, auto) {
        return std::cos(4 * pi * (x + 0.5) / 256) + std::cos(40 * pi * (x + 0.5) / 256);
    });
    std::vector<std::string> options{"--displace",        two,  "--height-scale", "0.1",
                                     "--height-midlevel", "0",  "--edge-length",  "0.07",
                                     "--band-limit",      "0.1"};
    const Written limited = prepared(square, options);
    ASSERT_EQ(limited.ran.exit_code, 0) << limited.ran.err;
    EXPECT_TRUE(limited.has("band-limited"));
    ASSERT_GT(limited.points.size(), 1000U);
    double off = 0;
    double at_ends = 0;
    for (const Vertex& v : limited.points) {
        // Within a kernel's width of the surface's border there is less to average.
        double& most = v.x > 0.4 && v.x < 1.6 ? off : at_ends;
        most = std::max(most, std::abs(v.z - 0.1 * std::cos(2 * pi * v.x)));
    }
    EXPECT_LE(off, 0.003);
    EXPECT_LE(at_ends, 0.01);
    options.back() = "0.01";  // 25 cycles a unit are whole
    const Written carried = prepared(square, options);
    ASSERT_EQ(carried.ran.exit_code, 0) << carried.ran.err;
    double most = 0;
    for (const Vertex& v : carried.points) most = std::max(most, v.z);
    EXPECT_GT(most, 0.18);

    const auto field = prep::noise_function({.frequency = 1.5, .scale = 0.3});
    ASSERT_TRUE(field);
    const Written noise = prepared(
        square, {"--displace", "noise", "--noise-frequency", "1.5", "--noise-scale", "0.3",
                 "--noise-octaves", "3,2.2", "--band-limit", "0.1516", "--chord-error", "0.01"});
    ASSERT_EQ(noise.ran.exit_code, 0) << noise.ran.err;
    EXPECT_TRUE(noise.has("band-limited"));
    ASSERT_GT(noise.points.size(), 100U);
    for (const Vertex& v : noise.points) EXPECT_NEAR(v.z, (*field)->at({v.x, v.y, 0}).value, 1e-6);
}

// The code of 8 bits nearest to a mid-level of 0.5 is far from it.
TEST_F(Displace, FloatHeightsOfMaterialsKeepTheirMidlevelInGltf) {
    map("h.exr", 2, prep::PixelType::f32, [](std::uint32_t x, auto) { return x; });
    write_text(dir_ / "s.obj", square);
    write_text(dir_ / "s.json",
               R"({"meshprep":1,"textures":{"h":{"file":"h.exr"}},"materials":{"a":{)"
               R"("displacement_map":"h","displacement_scale":100,"displacement_midlevel":0.5}},)"
               R"("meshes":{"pl":{"file":"s.obj","material":"a"}}})");
    const std::string glb = (dir_ / "s.glb").string();
    const test::Ran ran = run_here({"prepare", (dir_ / "s.json").string(), "-o", glb});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_NE(ran.err.find("heights were rounded to 16 bits"), std::string::npos) << ran.err;
    const test::Ran moved = run_here({"prepare", glb, "-o", (dir_ / "s2.obj").string(),
                                      "--displace", "materials", "--edge-length", "0.5"});
    ASSERT_EQ(moved.exit_code, 0) << moved.err;
    const auto scene = prep::load_scene(dir_ / "s2.obj");
    ASSERT_TRUE(scene) << to_string(scene.error());
    float low = 0, high = 0;
    for (const glm::vec3& p : scene->meshes[0].positions) {
        low = std::min(low, p.z);
        high = std::max(high, p.z);
    }
    EXPECT_NEAR(low, -50, 0.001);
    EXPECT_NEAR(high, 50, 0.001);
}

}  // namespace
