// The command on tangents: diff --tangents, and what inspect tells of conventions.
#include <gtest/gtest.h>

#include <cmath>

#include "command_runner.h"
#include "prep/image.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;

// A sphere of triangles with MikkTSpace's tangents, as GLB.
prep::Scene make_sphere(const TempDir& dir) {
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
    const TempDir dir;
    make_sphere(dir);
    const std::string made = (dir / "made.glb").string();
    const test::Ran ran =
        run_here({"diff", "--tangents", made, made, "--tolerance", "0", "--json"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_NE(ran.out.find("\"sign_differences\": 0"), std::string::npos) << ran.out;
}

TEST(DiffTangents, MeasuresAnglesAndSigns) {
    const TempDir dir;
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
    const TempDir dir;
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
    const TempDir dir;
    make_sphere(dir);
    const json told = inspected(dir / "made.glb").at("tangents").at(0);
    EXPECT_EQ(told.at("method"), "mikktspace");
    EXPECT_EQ(told.at("sign"), "as-gltf");
    EXPECT_GT(told.at("compared"), 2000);
    EXPECT_EQ(told.at("identical"), told.at("compared"));
    const test::Ran words = run_here({"inspect", (dir / "made.glb").string()});
    EXPECT_NE(words.out.find("tangents: MikkTSpace (100.0 % of"), std::string::npos) << words.out;
}

// Twenty triangles in the plane z = 0 whose u runs along x and whose v runs down: MikkTSpace's
// tangent is x, its sign +1 in glTF's convention. Each corner has a tangent of its own, turned by
// so many degrees about z.
std::string flat_gltf(const std::vector<double>& degrees, const std::vector<int>& signs) {
    std::vector<float> positions, normals, uvs, tangents;
    std::vector<std::uint32_t> indices;
    for (std::size_t c = 0; c < degrees.size(); ++c) {
        const auto left = float(c / 3), x = left + (c % 3 == 1 ? 1.0f : 0.0f),
                   y = c % 3 == 2 ? 1.0f : 0.0f;
        positions.insert(positions.end(), {x, y, 0});
        normals.insert(normals.end(), {0, 0, 1});
        uvs.insert(uvs.end(), {x / 32, 1 - y / 32});
        const double a = degrees[c] * 3.14159265358979 / 180;
        const bool whole = degrees[c] == 0;
        tangents.insert(tangents.end(), {whole ? 1 : float(std::cos(a)),
                                         whole ? 0 : float(std::sin(a)), 0, float(signs[c])});
        indices.push_back(std::uint32_t(c));
    }
    test::GltfText gltf;
    gltf.add({"flat", positions, normals, uvs, tangents, indices, "", ""});
    return gltf.text();
}

TEST(InspectTangents, FiguresAreThoseOfThePlanesOwnDirections) {
    const TempDir dir;
    std::vector<double> degrees(60, 0.0);
    std::vector<int> signs(60, 1);
    test::write_text(dir / "flat.gltf", flat_gltf(degrees, signs));
    json told = inspected(dir / "flat.gltf").at("tangents").at(0);
    EXPECT_EQ(told.at("mesh"), "flat");
    EXPECT_EQ(told.at("uv_set"), 0);
    EXPECT_EQ(told.at("method"), "mikktspace");
    EXPECT_EQ(told.at("sign"), "as-gltf");
    EXPECT_EQ(told.at("compared"), 60);
    EXPECT_EQ(told.at("identical"), 60);
    EXPECT_EQ(told.at("largest_degrees"), 0.0);
    // 40 as they were, 12 within 5°, 5 within 90° and 3 nearly the other way round; 7 signs turned.
    for (std::size_t c = 40; c < 60; ++c)
        degrees[c] = c < 52 ? 0.125 * double(c - 39) + 1.5 : c < 57 ? 60 + double(c - 52) : 177;
    for (std::size_t c = 0; c < 7; ++c) signs[8 * c] = -1;
    test::write_text(dir / "turned.gltf", flat_gltf(degrees, signs));
    told = inspected(dir / "turned.gltf").at("tangents").at(0);
    EXPECT_EQ(told.at("method"), "other");
    EXPECT_EQ(told.at("sign"), "mixed");  // 88 %
    EXPECT_EQ(told.at("identical"), 40);
    EXPECT_EQ(told.at("within_1_degree"), 40);
    EXPECT_EQ(told.at("within_5_degrees"), 52);
    EXPECT_EQ(told.at("opposite"), 3);
    EXPECT_EQ(told.at("same_sign"), 53);
    EXPECT_NEAR(told.at("largest_degrees").get<double>(), 177, 1e-4);
    EXPECT_EQ(told.at("median_degrees"), 0.0);
    const std::string words = run_here({"inspect", (dir / "turned.gltf").string()}).out;
    EXPECT_NE(words.find("  flat: tangents: not MikkTSpace (66.7 % of 60 corners within 1°, 86.7 % "
                         "within 5°, 66.7 % to the last bit; median 0°, largest 177°)\n"),
              std::string::npos)
        << words;
    EXPECT_NE(words.find("  flat: tangent sign: agrees with no convention (w is glTF's at 88.3 % "
                         "of the corners)\n"),
              std::string::npos)
        << words;
    test::write_text(dir / "back.gltf", flat_gltf(std::vector<double>(60, 180.0), signs));
    EXPECT_NE(run_here({"inspect", (dir / "back.gltf").string()})
                  .out.find("; 100.0 % point the other way"),
              std::string::npos);
}

TEST(InspectTangents, TellsInvertedSigns) {
    const TempDir dir;
    prep::Scene scene = make_sphere(dir);
    for (glm::vec4& t : scene.meshes[0].tangents.values) t.w = -t.w;
    save(scene, dir / "inverted.glb");
    EXPECT_EQ(inspected(dir / "inverted.glb").at("tangents").at(0).at("sign"), "inverted");
    const test::Ran words = run_here({"inspect", (dir / "inverted.glb").string()});
    EXPECT_NE(words.out.find("tangent sign: looks inverted"), std::string::npos) << words.out;
}

// One bump as a normal map: green up, then down.
TEST(InspectTangents, TellsFlippedGreen) {
    const TempDir dir;
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
        EXPECT_EQ(map_told.at("image"), "bump.png");
        EXPECT_EQ(map_told.at("material"), "m");
        const std::string words = run_here({"inspect", (dir / "cube.obj").string()}).out;
        EXPECT_NE(
            words.find(green > 0 ? "normal map bump.png: green points up, as glTF has it"
                                 : "normal map bump.png: green looks flipped: it points down"),
            std::string::npos)
            << words;
    }
}

}  // namespace
