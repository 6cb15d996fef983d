// `--pixel-error`: true surfaces and written triangles, projected by a pinhole camera of the test's
// own; nowhere in the picture are they farther apart than asked.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "command_runner.h"
#include "prep/image.h"
#include "prep/load.h"

namespace {

using nlohmann::json;
using test::run_here;

struct Pinhole {
    glm::dvec3 from{0.0}, at{0.0};
    double fov = 35;          // degrees, of the height
    double ortho_height = 0;  // 0: perspective
    glm::dvec2 size{640, 480};

    struct Seen {
        glm::dvec2 pixel{0.0};
        double depth = 0;
        bool inside = false;  // of the picture's sides
    };
    Seen operator()(const glm::dvec3& p) const {
        const glm::dvec3 f = glm::normalize(at - from);
        const glm::dvec3 right = glm::normalize(glm::cross(f, glm::dvec3(0, 1, 0)));
        const glm::dvec3 up = glm::cross(right, f);
        Seen seen;
        seen.depth = glm::dot(p - from, f);
        const double half = ortho_height > 0 ? ortho_height / 2
                                             : seen.depth * std::tan(fov * std::numbers::pi / 360);
        const double pixels = size.y / 2 / half;
        seen.pixel = pixels * glm::dvec2(glm::dot(p - from, right), glm::dot(p - from, up));
        seen.inside = std::abs(seen.pixel.x) <= size.x / 2 && std::abs(seen.pixel.y) <= size.y / 2;
        return seen;
    }
};

// The square (0, 0, 0) … (2, 0, 2), facing up, its UVs 0 … 1, displaced by a bilinear map.
constexpr int texels = 48;
constexpr double height = 0.2;
float texel(int x, int y) {
    return float(0.5 + 0.25 * std::sin(0.5 * x + 0.2 * y) + 0.25 * std::cos(0.4 * y - 0.3 * x));
}
double height_at(double u, double v) {
    const double x = u * texels - 0.5, y = (1 - v) * texels - 0.5;
    const auto wrapped = [](double n) { return (int(n) % texels + texels) % texels; };
    const double fx = std::floor(x), fy = std::floor(y), tx = x - fx, ty = y - fy;
    const auto t = [&](double i, double j) { return double(texel(wrapped(i), wrapped(j))); };
    return height * ((1 - ty) * ((1 - tx) * t(fx, fy) + tx * t(fx + 1, fy)) +
                     ty * ((1 - tx) * t(fx, fy + 1) + tx * t(fx + 1, fy + 1)));
}
const std::string square =
    "v 0 0 2\nv 2 0 2\nv 2 0 0\nv 0 0 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
glm::dvec3 truth(const glm::dvec2& xz) {
    return {xz.x, height_at(xz.x / 2, 1 - xz.y / 2), xz.y};
}

struct Errors {
    double in_picture = 0;  // pixels
    double anywhere = 0;    // length
    std::size_t seen = 0;
};

class PixelError : public testing::Test {
  protected:
    PixelError() {
        prep::Image image{.width = texels, .height = texels, .channels = 1, .pixels = {}};
        for (int y = 0; y < texels; ++y)
            for (int x = 0; x < texels; ++x) image.pixels.push_back(texel(x, y));
        const auto saved = prep::save_image(dir_ / "map.exr", image, prep::PixelType::f32);
        EXPECT_TRUE(saved) << to_string(saved.error());
        test::write_text(dir_ / "square.obj", square);
    }

    // Prepares `input`, reads the result back.
    void prepare(const std::string& input, std::vector<std::string> options) {
        const std::string out = (dir_ / "out.glb").string();
        options.insert(options.begin(),
                       {"prepare", (dir_ / input).string(), "-o", out, "--json", "--displace",
                        (dir_ / "map.exr").string(), "--height-midlevel", "0", "--height-scale",
                        "0.2", "--weld", "none"});
        const test::Ran ran = run_here(options);
        ASSERT_EQ(ran.exit_code, 0) << ran.err << ran.out;
        certificate_ = ran.json()["files"][0]["tessellated"][0];
        auto scene = prep::load_scene(out);
        ASSERT_TRUE(scene) << to_string(scene.error());
        mesh_ = std::move(scene->meshes.at(0));
    }

    // Over points of all triangles, in the picture where the truth or the triangle is; `world`
    // takes the mesh to where the camera is.
    Errors errors(const Pinhole& camera, double near, const glm::dmat4& world = glm::dmat4(1)) {
        Errors most;
        const auto carried = [&](const glm::dvec3& p) {
            return glm::dvec3(world * glm::dvec4(p + mesh_.origin, 1));
        };
        for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
            std::array<glm::dvec3, 3> corners;
            for (std::size_t k = 0; k < 3; ++k)
                corners[k] = glm::dvec3(mesh_.positions[mesh_.corner_vertices[3 * f + k]]);
            constexpr int n = 12;
            for (int j = 0; j <= n; ++j)
                for (int i = 0; i + j <= n; ++i) {
                    const glm::dvec3 p = (double(n - i - j) * corners[0] + double(i) * corners[1] +
                                          double(j) * corners[2]) /
                                         double(n);
                    const glm::dvec3 q = truth({p.x, p.z});
                    most.anywhere = std::max(most.anywhere, glm::distance(p, q));
                    const auto a = camera(carried(p)), b = camera(carried(q));
                    const bool a_seen = a.inside && a.depth >= near;
                    const bool b_seen = b.inside && b.depth >= near;
                    if (!a_seen && !b_seen) continue;
                    ++most.seen;
                    most.in_picture = std::max(most.in_picture, glm::distance(a.pixel, b.pixel));
                }
        }
        return most;
    }
    double proved() const { return certificate_["proved_pixels"].get<double>(); }

    test::TempDir dir_;
    json certificate_;
    prep::Mesh mesh_;
};

TEST_F(PixelError, HoldsAllOverThePictureAndNoFartherThanNeeded) {
    const Pinhole camera{.from = {1, 0.9, 3.5}, .at = {1, 0.1, 1}};
    std::size_t last = 0;
    for (const double asked : {4.0, 1.0, 0.5}) {
        ASSERT_NO_FATAL_FAILURE(prepare(
            "square.obj", {"--pixel-error", std::to_string(asked), "--look-from", "1,0.9,3.5",
                           "--look-at", "1,0.1,1", "--fov", "35", "--size", "640x480"}));
        const Errors e = errors(camera, 0.01);
        EXPECT_LE(e.in_picture, asked);
        EXPECT_LE(e.in_picture, proved());
        EXPECT_GT(e.in_picture, asked / 10) << "far fewer triangles would have done";
        EXPECT_GT(e.seen, 1000U);
        EXPECT_LE(proved(), asked);
        EXPECT_EQ(certificate_["asked_pixels"], asked);
        EXPECT_FALSE(certificate_.contains("asked"));
        EXPECT_GT(mesh_.face_count(), last);
        last = mesh_.face_count();
    }
}

// Errors are as large as depths allow, so there are more triangles where the ground is near: to a
// unit of area as one over the depth, which is three times as large in the far third.
TEST_F(PixelError, NearGroundIsFinerThanFarGround) {
    const Pinhole camera{.from = {1, 0.9, 2.3}, .at = {1, 0.1, 1}, .fov = 80};
    ASSERT_NO_FATAL_FAILURE(
        prepare("square.obj", {"--pixel-error", "0.5", "--look-from", "1,0.9,2.3", "--look-at",
                               "1,0.1,1", "--fov", "80", "--size", "640x480"}));
    struct Third {
        double count = 0, area = 0, depth = 0;
    };
    std::array<Third, 3> thirds;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
        std::array<glm::dvec3, 3> p;
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = glm::dvec3(mesh_.positions[mesh_.corner_vertices[3 * f + k]]) + mesh_.origin;
            inside = inside && camera(p[k]).inside;
        }
        if (!inside) continue;
        const glm::dvec3 middle = (p[0] + p[1] + p[2]) / 3.0;
        Third& third = thirds[std::size_t(std::clamp(middle.z * 1.5, 0.0, 2.0))];
        const glm::dvec3 a = p[1] - p[0], b = p[2] - p[0];
        third.area += 0.5 * std::abs(a.x * b.z - a.z * b.x);
        third.depth += camera(middle).depth;
        ++third.count;
    }
    const auto& far = thirds[0];
    const auto& near = thirds[1];  // the nearest is mostly below the picture
    ASSERT_GT(far.count, 100);
    ASSERT_GT(near.count, 100);
    const double depths = (far.depth / far.count) / (near.depth / near.count);
    const double densities = (near.count / near.area) / (far.count / far.area);
    EXPECT_GT(depths, 1.4);
    EXPECT_GT(densities, 0.8 * depths) << depths;
    EXPECT_LT(densities, 1.4 * depths) << depths;
}

// What no face has is not drawn, and frames nothing.
TEST_F(PixelError, StrayVerticesFrameNothing) {
    test::write_text(
        dir_ / "stray.obj", "v 1000 0 0\n" + [] {
            std::string moved = square;
            const std::string face = "f 1/1 2/2 3/3 4/4";
            return moved.replace(moved.find(face), face.size(), "f 2/1 3/2 4/3 5/4");
        }());
    // Nor is a point, or a line.
    const std::string stray = test::file_text(dir_ / "stray.obj");
    test::write_text(dir_ / "point.obj", stray + "p 1\n");
    test::write_text(dir_ / "line.obj", stray + "l 1 2\n");
    std::vector<std::size_t> counts;
    for (const char* const name : {"square.obj", "stray.obj", "point.obj", "line.obj"}) {
        ASSERT_NO_FATAL_FAILURE(prepare(name, {"--pixel-error", "0.5", "--camera", "20,30"}));
        counts.push_back(mesh_.face_count());
    }
    EXPECT_GT(counts[0], 1000U);
    EXPECT_EQ(counts, std::vector<std::size_t>(4, counts[0]));
}

// In a valley of the relief: ground before, behind, beside and above the eye.
TEST_F(PixelError, IsFiniteWithTheEyeInside) {
    const Pinhole camera{.from = {1, 0.11, 1}, .at = {2, 0.1, 1.1}, .fov = 60};
    ASSERT_NO_FATAL_FAILURE(
        prepare("square.obj", {"--pixel-error", "1", "--look-from", "1,0.11,1", "--look-at",
                               "2,0.1,1.1", "--fov", "60", "--size", "640x480"}));
    const Errors e = errors(camera, 0.002);
    EXPECT_LE(e.in_picture, 1);
    EXPECT_LE(proved(), 1);
    EXPECT_GT(e.seen, 1000U);
    EXPECT_EQ(certificate_["unresolved"], 0);
    EXPECT_LT(mesh_.face_count(), 200000U);
    // Behind the eye nothing is seen, and nothing was halved for it but to close the mesh.
    std::size_t behind = 0;
    double farthest = 0;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
        bool all = true;
        for (std::size_t k = 0; k < 3; ++k)
            all = all && mesh_.positions[mesh_.corner_vertices[3 * f + k]].x < 0.9F;
        behind += all;
    }
    farthest = e.anywhere;
    EXPECT_LT(behind, mesh_.face_count() / 4);
    EXPECT_GT(farthest, 0.02);
}

TEST_F(PixelError, HoldsWithoutPerspective) {
    const Pinhole camera{.from = {3, 2, 4}, .at = {1, 0, 1}, .ortho_height = 1.2};
    ASSERT_NO_FATAL_FAILURE(
        prepare("square.obj", {"--pixel-error", "0.7", "--look-from", "3,2,4", "--look-at", "1,0,1",
                               "--ortho", "1.2", "--size", "640x480"}));
    const Errors e = errors(camera, 0);
    EXPECT_LE(e.in_picture, 0.7);
    EXPECT_GT(e.in_picture, 0.07);
    EXPECT_LE(proved(), 0.7);
}

// The scene file's own camera and size; two nodes show one mesh: the near one, which is stretched,
// decides.
TEST_F(PixelError, TheStrictestInstanceHolds) {
    const auto scene = [&](bool near, bool far) {
        json nodes = json::array();
        if (far)
            nodes.push_back(
                {{"name", "far"}, {"mesh", "m"}, {"translate", {0, 0, -30}}, {"scale", 0.5}});
        if (near)
            nodes.push_back(
                {{"name", "near"}, {"mesh", "m"}, {"translate", {-1, 0, 0}}, {"scale", {1, 3, 1}}});
        const json file = {
            {"meshprep", 1},
            {"meshes", {{"m", {{"file", "square.obj"}}}}},
            {"nodes", nodes},
            {"camera", {{"position", {0, 1.5, 5}}, {"target", {0, 0, 0}}, {"fov", 40}}},
            {"picture", {{"size", {800, 600}}}}};
        test::write_text(dir_ / "scene.json", file.dump());
    };
    const Pinhole camera{.from = {0, 1.5, 5}, .at = {0, 0, 0}, .fov = 40, .size = {800, 600}};
    glm::dmat4 near_world(1), far_world(0.5);
    near_world[1][1] = 3;
    near_world[3] = glm::dvec4(-1, 0, 0, 1);
    far_world[3] = glm::dvec4(0, 0, -30, 1);
    std::array<std::size_t, 3> counts{};
    for (const auto& [near, far] :
         {std::pair(true, true), std::pair(true, false), std::pair(false, true)}) {
        scene(near, far);
        ASSERT_NO_FATAL_FAILURE(prepare("scene.json", {"--pixel-error", "0.8"}));
        if (near) {
            const Errors e = errors(camera, 0.1, near_world);
            EXPECT_LE(e.in_picture, 0.8);
            EXPECT_GT(e.in_picture, 0.08);
        }
        if (far) {
            EXPECT_LE(errors(camera, 0.1, far_world).in_picture, 0.8);
        }
        EXPECT_LE(proved(), 0.8);
        counts[near && far ? 0 : near ? 1 : 2] = mesh_.face_count();
    }
    EXPECT_EQ(counts[0], counts[1]);
    EXPECT_LT(10 * counts[2], counts[1]);
    // By number, and the choice of another.
    scene(true, true);
    ASSERT_NO_FATAL_FAILURE(prepare("scene.json", {"--pixel-error", "0.8", "--camera", "0"}));
    EXPECT_EQ(mesh_.face_count(), counts[0]);
    ASSERT_NO_FATAL_FAILURE(
        prepare("scene.json", {"--pixel-error", "0.8", "--camera", "0", "--size", "80x60"}));
    EXPECT_LT(5 * mesh_.face_count(), counts[0]);
}

// `render` means its own picture, and so does an orbit: what is drawn is what was proved.
TEST_F(PixelError, RenderMeansItsOwnPicture) {
    const std::string mesh = (dir_ / "square.obj").string();
    std::array<std::uint64_t, 2> triangles{};
    for (const int size : {64, 640}) {
        const std::string pixels = std::to_string(size) + "x" + std::to_string(size * 3 / 4);
        const test::Ran drawn = run_here(
            {"render", mesh, "-o", (dir_ / "out.png").string(), "--displace",
             (dir_ / "map.exr").string(), "--height-midlevel", "0", "--height-scale", "0.2",
             "--pixel-error", "0.5", "--camera", "20,30", "--size", pixels, "--json"});
        ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
        ASSERT_NO_FATAL_FAILURE(
            prepare("square.obj", {"--pixel-error", "0.5", "--camera", "20,30", "--size", pixels}));
        const auto plan = drawn.json()["plan"];
        EXPECT_EQ(plan["triangles"].get<std::uint64_t>(), mesh_.face_count());
        triangles[size > 100] = mesh_.face_count();
    }
    EXPECT_GT(triangles[1], 10 * triangles[0]);
}

TEST_F(PixelError, MistakesAreUsageErrors) {
    const std::string mesh = (dir_ / "square.obj").string(), out = (dir_ / "out.glb").string();
    const auto run = [&](std::vector<std::string> options) {
        options.insert(options.begin(), {"prepare", mesh, "-o", out});
        return run_here(options);
    };
    for (const std::vector<std::string>& options : {std::vector<std::string>{"--pixel-error", "0"},
                                                    {"--camera", "10,20"},
                                                    {"--chord-error", "0.1", "--fov", "30"},
                                                    {"--size", "64x64"},
                                                    {"--pixel-error", "1", "--size", "64"},
                                                    {"--pixel-error", "1", "--look-at", "0,0,0"}}) {
        EXPECT_EQ(run(options).exit_code, 2) << options[0];
    }
    // The option that was given is the one that is named.
    for (const auto& [option, value] :
         {std::pair("--fov", "30"), std::pair("--ortho", "2"), std::pair("--look-from", "1,2,3")}) {
        const test::Ran alone = run({option, value});
        EXPECT_EQ(alone.exit_code, 2) << option;
        EXPECT_NE(alone.err.find(option), std::string::npos) << alone.err;
        EXPECT_EQ(alone.err.find("--camera"), std::string::npos) << alone.err;
    }
    const test::Ran fine =
        run({"--displace", (dir_ / "map.exr").string(), "--pixel-error", "1e-7"});
    EXPECT_EQ(fine.exit_code, 1);
    EXPECT_NE(fine.err.find("pixels is finer than floats"), std::string::npos) << fine.err;
    const test::Ran none = run({"--pixel-error", "1", "--camera", "hall"});
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_NE(none.err.find("no camera 'hall'"), std::string::npos) << none.err;
    EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
