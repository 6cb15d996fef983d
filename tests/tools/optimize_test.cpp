// `prepare --optimize`: what the command says of it, and the validator of the files.
#include <gtest/gtest.h>

#include <glm/glm.hpp>
#include <set>

#include "command_runner.h"
#include "gltf_maker.h"
#include "gltf_oracle.h"
#include "npm_tools.h"
#include "prep/load.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

using nlohmann::json;
using test::run_here;

TEST(Optimize, TheReportTellsWhatMovedAndWhatItIsWorth) {
    const test::TempDir dir;
    test::write_text(dir / "ball.obj", test::sphere_obj(60, 40));
    const std::string in = (dir / "ball.obj").string(), out = (dir / "ball.glb").string();
    const test::Ran plain = run_here({"prepare", in, "-o", out, "--json"});
    ASSERT_EQ(plain.exit_code, 0) << plain.err;
    EXPECT_FALSE(plain.json()["files"][0].contains("optimized"));
    const test::Ran ran = run_here({"prepare", in, "-o", out, "--json", "--optimize"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json file = ran.json()["files"][0];
    EXPECT_EQ(file["after"], plain.json()["files"][0]["after"]);
    ASSERT_EQ(file["optimized"].size(), 1u);
    const json order = file["optimized"][0];
    EXPECT_EQ(order["mesh"], 0);
    EXPECT_EQ(order["triangles_kept"], 0);
    EXPECT_GT(order["triangles_moved"], 0);
    EXPECT_GT(order["vertices_moved"], 0);
    for (const char* when : {"before", "after"}) {
        const double all = order[when]["shaded"];
        EXPECT_DOUBLE_EQ(order[when]["acmr"], all / double(file["after"]["triangles"]));
        EXPECT_DOUBLE_EQ(order[when]["atvr"], all / double(file["after"]["vertices"]));
    }
    EXPECT_LT(order["after"]["shaded"], order["before"]["shaded"]);
    bool listed = false;
    for (const json& stage : file["stages"])
        listed |= stage["stage"] == "optimize" && stage["run"] && stage["reason"] == "asked for";
    EXPECT_TRUE(listed);
    const test::Ran words = run_here({"prepare", in, "-o", out, "--optimize"});
    EXPECT_NE(words.out.find("vertices shaded a triangle"), std::string::npos) << words.out;
}

TEST(Optimize, SaysWhatBlends) {
    const test::TempDir dir;
    test::GltfText gltf;
    gltf.add({"glass", {0, 0, 0, 1, 0, 0, 0, 1, 0}, {}, {}, {}, {0, 1, 2}, R"("material":0)", ""});
    test::write_text(dir / "glass.gltf", gltf.text(R"("materials":[{"alphaMode":"BLEND"}])"));
    const test::Ran ran = run_here(
        {"prepare", (dir / "glass.gltf").string(), "-o", (dir / "out.glb").string(), "--optimize"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_NE(ran.out.find("1 blended triangle stay in order"), std::string::npos) << ran.out;
}

TEST(Optimize, IsForGltfFiles) {
    const test::TempDir dir;
    test::write_text(dir / "cube.obj", test::cube_obj());
    const test::Ran ran = run_here(
        {"prepare", (dir / "cube.obj").string(), "-o", (dir / "x.ply").string(), "--optimize"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("--optimize is for glTF"), std::string::npos) << ran.err;
    EXPECT_FALSE(std::filesystem::exists(dir / "x.ply"));
}

// What each corner of each triangle has, whatever their order.
std::multiset<std::vector<double>> corners_of(const std::filesystem::path& path) {
    const test::GltfFile file(path);
    std::multiset<std::vector<double>> corners;
    std::vector<test::GltfValues> values;
    for (const char* name : {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0"})
        values.push_back(file.attribute(0, 0, name));
    for (const std::size_t v : file.triangles(0, 0)) {
        std::vector<double> corner;
        for (const test::GltfValues& of : values)
            for (const double x : of.at(v)) corner.push_back(x);
        corners.insert(std::move(corner));
    }
    return corners;
}

// The same of what is compressed, as it is read.
std::multiset<std::vector<float>> corners_read(const std::filesystem::path& path) {
    const auto scene = prep::load_scene(path);
    EXPECT_TRUE(scene) << to_string(scene.error());
    const prep::Mesh& mesh = scene->meshes[0];
    std::multiset<std::vector<float>> corners;
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::vec3 p = mesh.positions[mesh.corner_vertices[c]];
        const glm::vec3 n = mesh.normals.values[mesh.normals.indices[c]];
        const glm::vec4 t = mesh.tangents.values[mesh.tangents.indices[c]];
        corners.insert({p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y, t.z, t.w});
    }
    return corners;
}

// Directions that were rounded to 8 bits or by Draco are not rounded again, nor made floats; their
// lengths are what such rounding leaves, which is no fault.
TEST(Optimize, DirectionsThatWereRoundedStayAsTheyAre) {
    const test::TempDir dir;
    test::write_text(dir / "ball.obj", test::sphere_obj(60, 40));
    const auto prepare = [&](const char* from, const char* to, std::vector<std::string> more) {
        more.insert(more.begin(),
                    {"prepare", (dir / from).string(), "-o", (dir / to).string(), "--quiet"});
        const test::Ran ran = run_here(more);
        EXPECT_EQ(ran.exit_code, 0) << to << ran.err;
    };
    prepare("ball.obj", "bytes.glb",
            {"--tangents", "mikktspace", "--quantize", "normals=8,tangents=8"});
    prepare("bytes.glb", "bytes2.glb", {"--optimize", "--strict"});
    EXPECT_EQ(corners_of(dir / "bytes.glb"), corners_of(dir / "bytes2.glb"));
    EXPECT_EQ(std::filesystem::file_size(dir / "bytes.glb"),
              std::filesystem::file_size(dir / "bytes2.glb"));
    // A sheet whose directions Draco has in steps of a 127th.
    test::GltfMaker maker;
    std::vector<double> positions, normals, tangents, uvs;
    const auto rounded = [](glm::dvec3 v) { return glm::round(127.0 * glm::normalize(v)) / 127.0; };
    const auto put = [](std::vector<double>& to, const glm::dvec3& v, int count) {
        for (int k = 0; k < count; ++k) to.push_back(v[k]);
    };
    constexpr int side = 8;
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
            for (const glm::ivec2 at : {glm::ivec2(0, 0), glm::ivec2(1, 0), glm::ivec2(1, 1),
                                        glm::ivec2(0, 0), glm::ivec2(1, 1), glm::ivec2(0, 1)}) {
                const double x = i + at.x, y = j + at.y, slope = 0.1 * x;
                put(positions, {x, y, 0.5 * slope * x}, 3);
                put(normals, rounded({-slope, 0, 1}), 3);
                put(tangents, rounded({1, 0, slope}), 3);
                tangents.push_back(1);
                put(uvs, {x / side, 1 - y / side, 0}, 2);
            }
    maker.mesh({maker.draco_primitive({{"POSITION", 5126, 3, false, positions},
                                       {"NORMAL", 5126, 3, false, normals},
                                       {"TANGENT", 5126, 4, false, tangents},
                                       {"TEXCOORD_0", 5126, 2, false, uvs}})});
    test::write_text(dir / "draco.glb", maker.glb());
    prepare("draco.glb", "draco2.glb", {"--optimize"});
    EXPECT_EQ(corners_read(dir / "draco.glb").size(), 6U * side * side);
    EXPECT_EQ(corners_read(dir / "draco.glb"), corners_read(dir / "draco2.glb"));
}

TEST(Optimize, TheValidatorFindsNoErrors) {
    MESHPREP_REQUIRE_NPM(validator, "gltf-validator");
    const test::TempDir dir;
    test::write_text(dir / "ball.obj", test::sphere_obj(60, 40));
    json list = json::array();
    for (const char* compression : {"none", "meshopt", "draco"})
        for (const char* ending : {".glb", ".gltf"}) {
            const std::string name = std::string(compression) + ending;
            ASSERT_EQ(run_here({"prepare", (dir / "ball.obj").string(), "-o", (dir / name).string(),
                                "--optimize", "--compress", compression})
                          .exit_code,
                      0);
            list.push_back({{"name", name}, {"output", (dir / name).string()}});
            list.back()["before"] = json::object();
        }
    EXPECT_TRUE(test::validates(validator, list, dir / "list.json"))
        << "its complaints stand above";
}

}  // namespace
