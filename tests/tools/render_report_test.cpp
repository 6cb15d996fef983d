// What `render` says of what it drew, and of what it did not.
#include <gtest/gtest.h>

#include <algorithm>

#include "command_runner.h"
#include "shared_data.h"

namespace {

using test::run_here;
using test::TempDir;
using test::write_text;

TEST(RenderReport, SaysWhatWasDrawnAndWhatWasNot) {
    const TempDir dir;
    test::GltfText gltf;
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    gltf.add({"m",
              positions,
              {},
              {},
              {},
              {0, 1, 2},
              R"("material":0,"targets":[{"POSITION":0},{"POSITION":0}])",
              R"("skin":0)"});
    gltf.add({"l", positions, {}, {}, {}, {0, 1, 1, 2}, R"("mode":1)", ""});
    gltf.add({"p", positions, {}, {}, {}, {0, 1, 2}, R"("mode":0)", ""});
    gltf.add({"unused", positions, {}, {}, {}, {0, 1, 2}, "", ""});
    write_text(dir / "a.gltf", gltf.text(R"("skins":[{"joints":[1]}],"materials":[{"name":"glass",)"
                                         R"("alphaMode":"BLEND"}])"));
    const std::vector<std::string> words = {"render", (dir / "a.gltf").string(),
                                            "-o",     (dir / "a.png").string(),
                                            "--size", "24x16",
                                            "--cull", "none"};
    std::vector<std::string> as_json = words;
    as_json.push_back("--json");
    const test::Ran ran = run_here(as_json);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const nlohmann::json document = ran.json();
    EXPECT_EQ(document["outputs"], nlohmann::json::array({(dir / "a.png").string()}));
    EXPECT_EQ(document["plan"]["width"], 24);
    EXPECT_EQ(document["plan"]["height"], 16);
    EXPECT_EQ(document["plan"]["triangles"], 2);
    EXPECT_EQ(document["plan"]["lights"], 4);  // three and the ambient one
    EXPECT_EQ(document["counters"]["triangles"], 2);
    const std::vector<std::string> warnings = document["warnings"];
    const auto told = [&](const std::string& text) {
        return std::count(warnings.begin(), warnings.end(), text) == 1 &&
               ran.err.find("warning: " + text) != std::string::npos;
    };
    EXPECT_TRUE(told("material 'glass' is drawn opaque: nothing is blended")) << ran.err;
    EXPECT_TRUE(told("1 skinned mesh is drawn as modelled, not posed")) << ran.err;
    EXPECT_TRUE(told("morph targets are not applied: 2, whatever their weights")) << ran.err;
    EXPECT_TRUE(told("2 line segments and 3 points are not drawn, only triangles are")) << ran.err;
    EXPECT_EQ(warnings.size(), 4u);
    const std::string out = run_here(words).out;
    EXPECT_NE(out.find("a.png  24×16, "), std::string::npos) << out;
    EXPECT_NE(out.find(", 2 triangles; read "), std::string::npos) << out;
}

// What reading had to say is in the document as well; and a blank picture has its reason.
TEST(RenderReport, HasTheWarningsOfReading) {
    const TempDir dir;
    write_text(dir / "a.obj", "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    test::GltfText nowhere;
    nowhere.add({"m", {0, 0, 0, 1, 0, 0, 0, 1, 0}, {}, {}, {}, {0, 1, 2}, R"("material":0)", ""});
    nlohmann::json gltf = nlohmann::json::parse(nowhere.text(R"("materials":[{"extensions":)"
                                                             R"({"KHR_materials_unlit":{}}}])"));
    write_text(dir / "unlit.gltf", gltf.dump());
    gltf["nodes"][0].erase("mesh");
    write_text(dir / "b.gltf", gltf.dump());
    const auto warnings = [&](const std::string& name, const std::string& filter = "ewa") {
        const test::Ran ran =
            run_here({"render", (dir / name).string(), "-o", (dir / "a.png").string(), "--size",
                      "8x8", "--json", "--filter", filter, "--max-anisotropy", "4"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.json()["warnings"].get<std::vector<std::string>>();
    };
    const std::vector<std::string> read = warnings("a.obj");
    ASSERT_EQ(read.size(), 1u);
    EXPECT_NE(read[0].find("none.mtl"), std::string::npos) << read[0];
    EXPECT_EQ(warnings("b.gltf"),
              std::vector<std::string>{"nothing is drawn: no node places a mesh"});
    // Without light no normals are missed.
    EXPECT_EQ(warnings("unlit.gltf"), std::vector<std::string>{});
    EXPECT_EQ(
        warnings("unlit.gltf", "trilinear"),
        std::vector<std::string>{"--max-anisotropy is of --filter anisotropic and ewa alone"});
}

TEST(RenderReport, EmptyPicturesHaveTheirReason) {
    const TempDir dir;
    write_text(dir / "a.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 -9\nv 0 1e-4 -9\nv 1e-4 0 -9\nf 1 2 3\nf 4 5 6\n");
    write_text(dir / "one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const auto warnings = [&](const std::string& name, std::vector<std::string> more,
                              const char* size = "16x16") {
        std::vector<std::string> words = {
            "render", (dir / name).string(), "-o", (dir / "a.png").string(), "--size", size,
            "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.json()["warnings"].get<std::vector<std::string>>();
    };
    using Texts = std::vector<std::string>;
    EXPECT_EQ(warnings("one.obj", {"--camera", "0,0"}), Texts{});
    EXPECT_EQ(warnings("one.obj", {"--camera", "180,0"}),
              Texts{"the picture is empty: its triangle is seen from behind (--cull none draws "
                    "both sides)"});
    EXPECT_EQ(warnings("one.obj", {"--camera", "180,0", "--cull", "none"}), Texts{});
    EXPECT_EQ(warnings("one.obj", {"--camera", "0,0", "--cull", "front"}),
              Texts{"the picture is empty: its triangle is seen from the front, which --cull front "
                    "leaves out"});
    EXPECT_EQ(warnings("one.obj", {"--look-from", "0,0,1", "--look-at", "0,0,2"}),
              Texts{"the picture is empty: its triangle is outside of it or behind the camera"});
    write_text(dir / "far.json", R"({"meshprep":1,"meshes":{"wide":{"shape":{"kind":"plane",
        "size":[1e6,1,1e6]}}},"nodes":[{"mesh":"wide","rotate":[90,0,0]}],
        "camera":{"position":[0,0,5],"target":[0,0,0],"near":0.1,"far":2}})");
    EXPECT_EQ(warnings("far.json", {}), Texts{"the picture is empty: all 2 triangles are outside "
                                              "of it or behind the camera"});
    EXPECT_EQ(warnings("a.obj",
                       {"--look-from", "0.2,0.2,-4", "--look-at", "0.2,0.2,0", "--cull", "back"}),
              Texts{"the picture is empty: 1 triangle is seen from behind (--cull none draws both "
                    "sides), 1 triangle is outside of it or behind the camera"});
    // Between pixels' centres; exact areas draw it.
    const std::vector<std::string> from_afar = {"--look-from", "0,0,2000", "--look-at",
                                                "0.05,0.05,0"};
    EXPECT_EQ(warnings("one.obj", from_afar),
              Texts{"the picture is empty: its triangle is too small to cover a pixel's centre"});
    std::vector<std::string> by_areas = from_afar;
    by_areas.insert(by_areas.end(), {"--coverage", "area"});
    EXPECT_EQ(warnings("one.obj", by_areas), Texts{});
    // Bands count the same triangles once more.
    EXPECT_EQ(
        warnings("one.obj", {"--camera", "180,0", "--band-memory", "1"}, "2000x2000"),
        Texts{"the picture is empty: its triangles are seen from behind (--cull none draws both "
              "sides)"});
}

TEST(RenderReport, EachPictureOfATurntableIsLookedAt) {
    const TempDir dir;
    write_text(dir / "one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const test::Ran ran =
        run_here({"render", (dir / "one.obj").string(), "-o", (dir / "t.png").string(), "--size",
                  "16x16", "--camera", "0,0", "--turntable", "8", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const auto outputs = ran.json()["outputs"].get<std::vector<std::string>>();
    const auto warnings = ran.json()["warnings"].get<std::vector<std::string>>();
    ASSERT_EQ(outputs.size(), 8u);
    // Five of them show its back or its edge: told once, by the first.
    ASSERT_EQ(warnings.size(), 1u);
    const std::string third = std::filesystem::path(outputs[2]).filename().string();
    EXPECT_TRUE(warnings[0].starts_with(third + ": the picture is empty: ")) << warnings[0];
}

}  // namespace
