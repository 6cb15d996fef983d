// The command on tangents: diff --tangents, and what inspect tells of conventions.
#include <gtest/gtest.h>

#include <cmath>

#include "command_runner.h"
#include "prep/image.h"
#include "prep/io.h"
#include "prep/save.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TemporaryDirectory;

// A sphere of triangles with MikkTSpace's tangents, as GLB.
prep::Scene make_sphere(const TemporaryDirectory& dir) {
    test::write_text(dir / "sphere.obj", test::sphere_obj(32, 16));
    const std::string bare = (dir / "bare.glb").string(), made = (dir / "made.glb").string();
    EXPECT_EQ(run_here({"prepare", (dir / "sphere.obj").string(), "-o", bare}).exit_code, 0);
    EXPECT_EQ(run_here({"prepare", bare, "-o", made, "--tangents", "mikktspace"}).exit_code, 0);
    auto scene = prep::load_scene(made);
    EXPECT_TRUE(scene.has_value());
    return *std::move(scene);
}

// The scene with its tangents as they are, under another name.
void save(prep::Scene scene, const std::filesystem::path& path) {
    auto prepared = prep::prepare(std::move(scene));
    ASSERT_TRUE(prepared.has_value());
    ASSERT_TRUE(prep::save_scene(*prepared, path).has_value());
}

json inspected(const std::filesystem::path& path) {
    const test::Ran ran = run_here({"inspect", path.string(), "--json"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return ran.json().at("files").at(0).at("conventions");
}

TEST(DiffTangents, FindsNothingBetweenAFileAndItself) {
    const TemporaryDirectory dir;
    make_sphere(dir);
    const std::string made = (dir / "made.glb").string();
    const test::Ran ran =
        run_here({"diff", "--tangents", made, made, "--tolerance", "0", "--json"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_NE(ran.out.find("\"sign_differences\": 0"), std::string::npos) << ran.out;
}

TEST(DiffTangents, MeasuresAnglesAndSigns) {
    const TemporaryDirectory dir;
    prep::Scene scene = make_sphere(dir);
    prep::Mesh& mesh = scene.meshes[0];
    constexpr double angle = 10 * 3.14159265358979 / 180;
    std::size_t flipped = 0;
    for (std::uint32_t v = 0; v < mesh.tangents.values.size(); ++v) {
        glm::vec4& t = mesh.tangents.values[v];
        const glm::dvec3 n(mesh.normals.values[v]), d(t);
        t = glm::vec4(glm::vec3(std::cos(angle) * d + std::sin(angle) * glm::cross(n, d)),
                      v % 4 == 0 ? -t.w : t.w);
    }
    for (const std::uint32_t i : mesh.tangents.indices) flipped += i % 4 == 0;
    save(scene, dir / "turned.glb");
    const test::Ran ran = run_here({"diff", "--tangents", (dir / "made.glb").string(),
                                    (dir / "turned.glb").string(), "--json"});
    const json report = ran.json();
    const json* part = nullptr;
    for (const auto& [key, value] : report.items())
        if (value.is_array() && !value.empty() && value[0].contains("sign_differences"))
            part = &value[0];
    ASSERT_NE(part, nullptr) << ran.out << ran.err;
    EXPECT_EQ(part->at("compared"), mesh.tangents.indices.size());
    EXPECT_EQ(part->at("sign_differences"), flipped);
    EXPECT_NEAR(part->at("degrees").at("mean").get<double>(), 10, 1e-3);
    EXPECT_NEAR(part->at("degrees").at("largest").get<double>(), 10, 1e-3);
    EXPECT_EQ(run_here({"diff", "--tangents", (dir / "made.glb").string(),
                        (dir / "turned.glb").string(), "--tolerance", "11"})
                  .exit_code,
              1);  // the angles would pass, the signs do not
}

TEST(TangentAngle, KeepsGradientsApart) {
    const TemporaryDirectory dir;
    make_sphere(dir);
    const std::string bare = (dir / "bare.glb").string(), apart = (dir / "apart.glb").string();
    const auto prepare = [&](const char* degrees) {
        return run_here({"prepare", bare, "-o", apart, "--tangents", "mikktspace",
                         "--tangent-angle", degrees, "--quiet"})
            .exit_code;
    };
    const auto same = [&] {
        return run_here(
                   {"diff", "--tangents", (dir / "made.glb").string(), apart, "--tolerance", "0"})
                   .exit_code == 0;
    };
    EXPECT_EQ(prepare("180"), 0);
    EXPECT_TRUE(same());
    EXPECT_EQ(prepare("0"), 0);
    EXPECT_FALSE(same());
    EXPECT_EQ(prepare("181"), 2);
    EXPECT_EQ(prepare("-1"), 2);
    EXPECT_EQ(prepare("nan"), 2);
}

TEST(InspectTangents, TellsMikktspaceByItsBits) {
    const TemporaryDirectory dir;
    make_sphere(dir);
    const json told = inspected(dir / "made.glb").at("tangents").at(0);
    EXPECT_EQ(told.at("method"), "mikktspace");
    EXPECT_EQ(told.at("sign"), "as-gltf");
    EXPECT_GT(told.at("compared"), 2000);
    EXPECT_EQ(told.at("identical"), told.at("compared"));
    const test::Ran words = run_here({"inspect", (dir / "made.glb").string()});
    EXPECT_NE(words.out.find("tangents: MikkTSpace (100.0 % of"), std::string::npos) << words.out;
}

TEST(InspectTangents, TellsInvertedSigns) {
    const TemporaryDirectory dir;
    prep::Scene scene = make_sphere(dir);
    for (glm::vec4& t : scene.meshes[0].tangents.values) t.w = -t.w;
    save(scene, dir / "inverted.glb");
    EXPECT_EQ(inspected(dir / "inverted.glb").at("tangents").at(0).at("sign"), "inverted");
    const test::Ran words = run_here({"inspect", (dir / "inverted.glb").string()});
    EXPECT_NE(words.out.find("tangent sign: looks inverted"), std::string::npos) << words.out;
}

// One bump as a normal map: green up, then down.
TEST(InspectTangents, TellsFlippedGreen) {
    const TemporaryDirectory dir;
    for (const double green : {1.0, -1.0}) {
        prep::Image map{96, 96, 3, {}, false};
        for (int y = 0; y < 96; ++y) {
            for (int x = 0; x < 96; ++x) {
                const double dx = (x - 47.5) / 24, dy = (y - 47.5) / 24;
                const double fall = 2 * std::exp(-dx * dx - dy * dy);
                const glm::dvec3 n = glm::normalize(glm::dvec3(fall * dx, -green * fall * dy, 1));
                for (int k = 0; k < 3; ++k) map.pixels.push_back(float(0.5 + 0.5 * n[k]));
            }
        }
        ASSERT_TRUE(prep::save_image(dir / "bump.png", map).has_value());
        test::write_text(dir / "m.mtl", "newmtl m\nKd 1 1 1\nnorm bump.png\n");
        test::write_text(dir / "cube.obj", "mtllib m.mtl\nusemtl m\n" + test::textured_cube_obj());
        const json map_told = inspected(dir / "cube.obj").at("normal_maps").at(0);
        EXPECT_EQ(map_told.at("green"), green > 0 ? "up" : "down");
        EXPECT_GT(green * map_told.at("correlation").get<double>(), 0.8);
    }
}

}  // namespace
