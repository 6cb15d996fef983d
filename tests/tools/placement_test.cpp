// --scale and --up, and what is said of units: lengths in what is written against those of the
// file.
#include <gtest/gtest.h>

#include <cmath>

#include "command_runner.h"
#include "gltf_motion.h"
#include "rig_files.h"
#include "written_gltf.h"

namespace {

using test::run_here;
using test::TempDir;

const char* const triangle = "v 1 2 3\nv 2 2 3\nv 1 4 3\nf 1 2 3\n";

glm::dvec3 first_vertex(const std::filesystem::path& glb) {
    const test::GltfFile file(glb);
    return test::GltfMotion(file).vertices(-1, 0).at(0).world;
}

TEST(Placement, ScaleAndUpReachTheFileAndTheReport) {
    const TempDir dir;
    test::write_text(dir / "a.obj", triangle);
    const auto ran = run_here({"prepare", (dir / "a.obj").string(), "-o", (dir / "a.glb").string(),
                               "--scale", "0.5", "--up", "z", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const glm::dvec3 p = first_vertex(dir / "a.glb");
    EXPECT_LT(glm::length(p - glm::dvec3(0.5, 1.5, -1)), 1e-12) << p.x << ' ' << p.y << ' ' << p.z;
    const auto placement = ran.json()["files"][0]["placement"];
    EXPECT_EQ(placement["factor"], 0.5);
    EXPECT_EQ(placement["scale"], 0.5);
    EXPECT_EQ(placement["file_unit"], 1);
    EXPECT_EQ(placement["file_unit_source"], "");
    EXPECT_EQ(placement["up"], "z");
    const auto said = run_here({"prepare", (dir / "a.obj").string(), "-o", (dir / "a.glb").string(),
                                "--scale", "0.5", "--up", "z"});
    EXPECT_NE(said.out.find("lengths × 0.5: --scale 0.5; z turned to y"), std::string::npos)
        << said.out;
}

TEST(Placement, FormatsWithoutNodesHaveItInTheirVertices) {
    const TempDir dir;
    test::write_text(dir / "a.obj", triangle);
    ASSERT_EQ(run_here({"prepare", (dir / "a.obj").string(), "-o", (dir / "b.obj").string(),
                        "--scale", "2", "--up", "x"})
                  .exit_code,
              0);
    EXPECT_NE(test::file_text(dir / "b.obj").find("v -4 2 6"), std::string::npos)
        << test::file_text(dir / "b.obj");
}

TEST(Placement, WhatFbxStatesIsToldByPrepareAndInspect) {
    const TempDir dir;
    test::write_text(dir / "rig.fbx", test::fbx_rig({}));
    const std::string line = "lengths × 0.0254: FBX UnitScaleFactor 2.54 (0.0254 m to a unit)";
    const auto inspected = run_here({"inspect", (dir / "rig.fbx").string()});
    EXPECT_NE(inspected.out.find(line), std::string::npos) << inspected.out;
    EXPECT_NE(inspected.out.find("2 morph targets"), std::string::npos) << inspected.out;
    const auto json = run_here({"inspect", (dir / "rig.fbx").string(), "--json"}).json();
    EXPECT_NEAR(json["files"][0]["placement"]["factor"].get<double>(), 0.0254, 1e-9);
    EXPECT_EQ(json["files"][0]["parts"]["animations"], 1);
    const auto prepared = run_here({"prepare", (dir / "rig.fbx").string(), "-o",
                                    (dir / "rig.glb").string(), "--scale", "10", "--json"});
    ASSERT_EQ(prepared.exit_code, 0) << prepared.err;
    const auto file = prepared.json()["files"][0];
    EXPECT_NEAR(file["placement"]["factor"].get<double>(), 0.254, 1e-9);
    EXPECT_EQ(file["parts"]["morph_targets"], 2);
    EXPECT_EQ(file["gltf_after"]["animations"], 1);
}

TEST(Placement, NothingIsSaidWhereNothingIsScaledOrTurned) {
    const TempDir dir;
    test::write_text(dir / "a.obj", triangle);
    const auto ran =
        run_here({"prepare", (dir / "a.obj").string(), "-o", (dir / "a.glb").string()});
    EXPECT_EQ(ran.out.find("lengths"), std::string::npos);
    EXPECT_EQ(first_vertex(dir / "a.glb"), glm::dvec3(1, 2, 3));
}

TEST(Placement, WrongValuesAreUsageErrors) {
    for (const std::vector<std::string>& wrong :
         std::vector<std::vector<std::string>>{{"--scale", "0"},
                                               {"--scale", "-1"},
                                               {"--scale", "inf"},
                                               {"--scale", "1,2"},
                                               {"--scale", "big"},
                                               {"--up", "w"}}) {
        const auto ran = run_here({"prepare", "a.obj", "-o", "b.glb", wrong[0], wrong[1]});
        EXPECT_EQ(ran.exit_code, 2) << wrong[0] << ' ' << wrong[1];
        EXPECT_NE(ran.err.find(wrong[0]), std::string::npos) << ran.err;
    }
}

}  // namespace
