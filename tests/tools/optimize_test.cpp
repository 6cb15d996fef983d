// `prepare --optimize`: what the command says of it, and the validator of the files.
#include <gtest/gtest.h>

#include "command_runner.h"
#include "gltf_oracle.h"
#include "npm_tools.h"
#include "shared_data.h"

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
