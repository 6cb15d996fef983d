// `prepare --for`: what is computed for one picture.
#include <gtest/gtest.h>

#include "command_runner.h"
#include "meshprep/options/consumer_option.h"
#include "prep/image.h"
#include "written_primitive.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::written;

class PrepareFor : public ::testing::Test {
  protected:
    void SetUp() override {
        test::GltfText gltf;
        gltf.add({"m",
                  {0, 0, 0, 1, 0, 0, 0, 1, 0},
                  {},
                  {0, 0, 1, 0, 0, 1},
                  {},
                  {0, 1, 2},
                  "\"material\":0",
                  ""});
        test::write_text(
            dir_ / "a.gltf",
            gltf.text(R"("textures":[{"source":0}],"images":[{"uri":"n.png"}],)"
                      R"("materials":[{"name":"rough","normalTexture":{"index":0}}])"));
    }
    test::Ran prepare(const std::vector<std::string>& options) {
        std::vector<std::string> words = {"prepare", (dir_ / "a.gltf").string(), "-o",
                                          (dir_ / "out.glb").string(), "--json"};
        words.insert(words.end(), options.begin(), options.end());
        return run_here(words);
    }
    // Whether normals and tangents were computed, and why.
    std::string made(const std::vector<std::string>& options) {
        const test::Ran ran = prepare(options);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        std::string text;
        const json document = ran.json();
        for (const json& stage : document["files"][0]["stages"])
            for (const char* name : {"normals", "tangents"})
                if (stage["stage"] == name)
                    text += std::string(name) + (stage["run"].get<bool>() ? " made: " : " not: ") +
                            stage["reason"].get<std::string>() + "; ";
        return text;
    }
    test::TempDir dir_;
};

TEST_F(PrepareFor, ComputesWhatOnePictureReads) {
    const std::string lit = "normals made: material 'rough' is lit; ";
    const std::string none = "tangents not: no material in use has a tangent-space normal map; ";
    const std::string map = "tangents made: material 'rough' has a tangent-space normal map; ";
    EXPECT_EQ(made({}), lit + map);
    EXPECT_EQ(made({"--for", "shading=normal-mapped"}), lit + map);
    EXPECT_EQ(made({"--for", "shading=phong"}), lit + none);
    EXPECT_EQ(made({"--for", "textures=off"}), lit + none);
    EXPECT_EQ(made({"--for", "shading=flat"}),
              "normals not: flat shading uses face normals; " + none);
    EXPECT_EQ(made({"--for", "colors=off"}), "normals not: nothing reads colours; " + none);
    EXPECT_EQ(made({"--for", "colors=off,normals=on"}),
              "normals made: normals are kept beside the picture; " + map);
}

TEST_F(PrepareFor, ReadsThePictureOfASceneFile) {
    test::write_text(dir_ / "s.json",
                     R"({"meshprep": 1, "meshes": {"b": {"shape": {"kind": "box"}}},)"
                     R"("lights": [{"kind": "ambient"}], "picture": {"shading": "phong"}})");
    const std::string file = (dir_ / "s.json").string();
    EXPECT_EQ(made({"--for", file}),
              "normals not: no light has a direction or a place; "
              "tangents not: no material in use has a tangent-space normal map; ");
}

// Of a scene file with a material 'brick' that has a normal map, and one, 'plain', that has none.
std::string scene_with(const std::string& meshes) {
    return R"({"meshprep": 1, "textures": {"bumps": {"file": "bumps.ppm"}}, "materials": {)"
           R"("brick": {"normal_map": "bumps"}, "plain": {}}, "meshes": {)" +
           meshes + "}}";
}

TEST_F(PrepareFor, DrawsAFileWithTheMaterialsThatTheSceneFileGivesIt) {
    test::write_text(dir_ / "bumps.ppm", "P6 1 1 255\nabc");
    const auto tangents = [&](const std::string& meshes) {
        test::write_text(dir_ / "s.json", scene_with(meshes));
        const std::string text = made({"--for", (dir_ / "s.json").string()});
        return text.substr(text.find("tangents"));
    };
    const std::string own = "tangents made: material 'rough' has a tangent-space normal map; ";
    const std::string brick =
        "tangents made: material 'rough', drawn as 'brick', has a tangent-space normal map; ";
    const std::string none = "tangents not: no material in use has a tangent-space normal map; ";
    EXPECT_EQ(tangents(R"("a": {"file": "a.gltf"})"), own);
    EXPECT_EQ(tangents(R"("a": {"file": "a.gltf", "material": "brick"})"), brick);
    EXPECT_EQ(tangents(R"("a": {"file": "a.gltf", "material": "plain"})"), none);
    EXPECT_EQ(tangents(R"("a": {"file": "a.gltf", "materials": {"rough": "plain"}})"), none);
    EXPECT_EQ(tangents(R"("a": {"file": "./a.gltf", "materials": {"rough": "brick"}})"), brick);
    // Twice there: as another and as itself.
    EXPECT_EQ(tangents(R"("a": {"file": "a.gltf", "material": "plain"}, "b": {"file": "a.gltf"})"),
              own);
    EXPECT_EQ(tangents(R"("b": {"file": "a.gltf"}, "a": {"file": "a.gltf", "material": "plain"})"),
              own);
    // What is written is in it, there or not yet; other files say nothing of this one.
    EXPECT_EQ(tangents(R"("a": {"file": "out.glb", "material": "plain"})"), none);
    std::filesystem::remove(dir_ / "out.glb");
    EXPECT_EQ(tangents(R"("a": {"file": "out.glb", "material": "plain"})"), none);
    EXPECT_EQ(tangents(R"("a": {"file": "other.glb", "material": "plain"})"), own);
}

// By name or for every face, with a material of their own or none, glTF to glTF or not.
TEST_F(PrepareFor, WritesTheTangentsThatMaterialsOfASceneFileRead) {
    test::write_text(dir_ / "bumps.ppm", "P6 1 1 255\nabc");
    const auto add = [&](const char* name, const char* material, const char* materials) {
        test::GltfText gltf;
        gltf.add({"m",
                  {0, 0, 0, 1, 0, 0, 0, 1, 0},
                  {},
                  {0, 0, 1, 0, 0, 1},
                  {},
                  {0, 1, 2},
                  material,
                  ""});
        test::write_text(dir_ / name, gltf.text(materials));
    };
    add("own.gltf", "\"material\":0", R"("materials":[{"name":"smooth"}])");
    add("bare.gltf", "", "");
    test::write_text(dir_ / "bare.obj",
                     "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    const std::string tangents = "NORMAL POSITION TANGENT TEXCOORD_0 0 textures, 0 images";
    const std::string none = "NORMAL POSITION TEXCOORD_0 0 textures, 0 images";
    const auto made_of = [&](const std::string& input, const std::string& of_file) {
        test::write_text(dir_ / "s.json",
                         scene_with("\"a\": {\"file\": \"" + input + "\"" + of_file + "}"));
        const std::filesystem::path out = dir_ / "out.gltf";
        const test::Ran ran = run_here({"prepare", (dir_ / input).string(), "-o", out.string(),
                                        "--for", (dir_ / "s.json").string()});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return written(out);
    };
    for (const char* input : {"own.gltf", "bare.gltf", "bare.obj"}) {
        EXPECT_EQ(made_of(input, R"(, "material": "brick")"), tangents) << input;
        const std::string plain = made_of(input, R"(, "material": "plain")");
        EXPECT_EQ(plain.find("TANGENT"), std::string::npos) << input;
    }
    EXPECT_EQ(made_of("own.gltf", R"(, "materials": {"smooth": "brick"})"), tangents);
    EXPECT_EQ(made_of("own.gltf", R"(, "materials": {"smooth": "plain"})"), none);
    // As the file that is written may call it.
    EXPECT_EQ(made_of("own.gltf", R"(, "materials": {"smooth_2": "brick"})"), tangents);
    EXPECT_EQ(made_of("bare.obj", R"(, "materials": {"material_0": "brick"})"), tangents);
}

// However the path is spelt, from wherever it starts.
TEST_F(PrepareFor, FindsAFileThatIsNotWrittenYet) {
    test::write_text(dir_ / "bumps.ppm", "P6 1 1 255\nabc");
    std::filesystem::create_directory(dir_ / "scenes");
    std::string text = scene_with(R"("a": {"file": "../made.gltf", "material": "plain"})");
    text.replace(text.find("bumps.ppm"), 0, "../");
    test::write_text(dir_ / "scenes" / "s.json", text);
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(dir_.path());
    const test::Ran ran =
        run_here({"prepare", "a.gltf", "-o", "made.gltf", "--for", "scenes/s.json"});
    std::filesystem::current_path(before);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(written(dir_ / "made.gltf").find("TANGENT"), std::string::npos);
}

TEST_F(PrepareFor, MaterialsOfASceneFileMayBeUnlit) {
    test::write_text(dir_ / "bumps.ppm", "P6 1 1 255\nabc");
    std::string text = scene_with(R"("a": {"file": "a.gltf", "material": "plain"})");
    text.replace(text.find("\"plain\": {}"), 11, R"("plain": {"unlit": true})");
    test::write_text(dir_ / "s.json", text);
    EXPECT_EQ(made({"--for", (dir_ / "s.json").string()}).rfind("normals not: every material", 0),
              0u)
        << made({"--for", (dir_ / "s.json").string()});
}

TEST_F(PrepareFor, FilesThatNoNodePlacesSayNothing) {
    test::write_text(dir_ / "bumps.ppm", "P6 1 1 255\nabc");
    std::string text = scene_with(R"("a": {"file": "a.gltf", "material": "plain"},)"
                                  R"("b": {"shape": {"kind": "box"}})");
    text.insert(text.size() - 1, R"(, "nodes": [{"mesh": "b"}])");
    test::write_text(dir_ / "s.json", text);
    EXPECT_NE(
        made({"--for", (dir_ / "s.json").string()}).find("tangents made: material 'rough' has"),
        std::string::npos);
}

TEST_F(PrepareFor, MapsOfMaterialsThatAreDrawnAsOthersAreNotWritten) {
    test::write_text(dir_ / "bumps.ppm", "P6 1 1 255\nabc");
    test::write_text(dir_ / "t.ppm", std::string("P6 1 1 255\n") + "abc");
    test::write_text(dir_ / "b.mtl",
                     "newmtl m\nKd 1 1 1\nmap_Kd t.ppm\nnewmtl n\nKd 1 1 1\nmap_Kd t.ppm\n");
    test::write_text(dir_ / "b.obj",
                     "mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
                     "usemtl m\nf 1/1 2/2 3/3\nusemtl n\nf 1/1 4/2 2/3\n");
    const auto textures = [&](const std::string& of_file) {
        test::write_text(dir_ / "s.json", scene_with(R"("b": {"file": "b.obj", )" + of_file + "}"));
        const std::filesystem::path out = dir_ / "out.gltf";
        const test::Ran ran = run_here({"prepare", (dir_ / "b.obj").string(), "-o", out.string(),
                                        "--for", (dir_ / "s.json").string()});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        std::string text;
        const json document = json::parse(test::file_text(out), nullptr, false);
        for (const json& material : document["materials"])
            text += material.dump().find("baseColorTexture") == std::string::npos ? "- " : "map ";
        return text;
    };
    EXPECT_EQ(textures(R"("materials": {})"), "map map ");
    EXPECT_EQ(textures(R"("materials": {"n": "plain"})"), "map - ");
    EXPECT_EQ(textures(R"("material": "plain")"), "- - ");
}

TEST_F(PrepareFor, TellsWhatAMaterialIsDrawnAs) {
    test::write_text(dir_ / "bumps.ppm", "P6 1 1 255\nabc");
    test::write_text(dir_ / "s.json",
                     scene_with(R"("a": {"file": "a.gltf", "material": "brick"})"));
    const json mesh = prepare({"--for", (dir_ / "s.json").string(), "--explain"})
                          .json()["files"][0]["requirements"][0];
    EXPECT_EQ(mesh["tangents"]["why"]["subject"], "/materials/0/normal_map");
    EXPECT_EQ(mesh["tangents"]["why"]["drawn_as"], "brick");
    test::write_text(dir_ / "c.obj",
                     "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    test::write_text(dir_ / "s.json", scene_with(R"("a": {"file": "c.obj", "material": "brick"})"));
    const test::Ran words =
        run_here({"prepare", (dir_ / "c.obj").string(), "-o", (dir_ / "c.glb").string(), "--for",
                  (dir_ / "s.json").string(), "--explain"});
    for (const char* line : {"the default material, drawn as 'brick', is lit",
                             "the default material, drawn as 'brick', has a normal map"})
        EXPECT_NE(words.out.find(line), std::string::npos) << words.out;
    const json own = prepare({"--explain"}).json()["files"][0]["requirements"][0];
    EXPECT_FALSE(own["tangents"]["why"].contains("drawn_as"));
}

TEST_F(PrepareFor, WritesNoMoreThanOnePictureReads) {
    test::write_text(dir_ / "t.ppm", std::string("P6 1 1 255\n") + "abc");
    test::write_text(dir_ / "b.mtl", "newmtl m\nKd 1 1 1\nmap_Kd t.ppm\n");
    test::write_text(dir_ / "b.obj",
                     "mtllib b.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvt 0 0\nvt 1 0\n"
                     "vt 0 1\nvn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\n");
    const auto made_of = [&](const std::string& input, std::vector<std::string> options) {
        const std::filesystem::path out = dir_ / (input + ".gltf");
        std::vector<std::string> words = {"prepare", (dir_ / input).string(), "-o", out.string()};
        words.insert(words.end(), options.begin(), options.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return written(out);
    };
    EXPECT_EQ(made_of("b.obj", {}), "COLOR_0 NORMAL POSITION TEXCOORD_0 1 textures, 1 images");
    EXPECT_EQ(made_of("b.obj", {"--for", "shading=phong"}),
              "COLOR_0 NORMAL POSITION TEXCOORD_0 1 textures, 1 images");
    EXPECT_EQ(made_of("b.obj", {"--for", "shading=flat"}),
              "COLOR_0 POSITION TEXCOORD_0 1 textures, 1 images");
    EXPECT_EQ(made_of("b.obj", {"--for", "shading=phong,textures=off"}),
              "COLOR_0 NORMAL POSITION 0 textures, 0 images");
    EXPECT_EQ(made_of("b.obj", {"--for", "colors=off"}), "POSITION 0 textures, 0 images");
    EXPECT_EQ(made_of("b.obj", {"--for", "colors=off,uvs=on"}),
              "POSITION TEXCOORD_0 0 textures, 0 images");
    EXPECT_EQ(made_of("b.obj", {"--for", "textures=off", "--tangents", "mikktspace"}),
              "COLOR_0 NORMAL POSITION TANGENT TEXCOORD_0 0 textures, 0 images");
    // A glTF document keeps its textures, and the UVs that they need.
    ASSERT_EQ(made_of("b.obj", {"--tangents", "mikktspace"}),
              "COLOR_0 NORMAL POSITION TANGENT TEXCOORD_0 1 textures, 1 images");
    EXPECT_EQ(made_of("b.obj.gltf", {"--for", "shading=phong"}),
              "COLOR_0 NORMAL POSITION TEXCOORD_0 1 textures, 1 images");
    EXPECT_EQ(made_of("b.obj.gltf", {"--for", "colors=off"}),
              "POSITION TEXCOORD_0 1 textures, 1 images");
}

// Written in another format, a glTF document is a mesh as any other.
TEST_F(PrepareFor, DocumentsOfAnotherFormatLeaveUnreadUvsAndMapsOut) {
    prep::Image normals;
    normals.width = normals.height = 1;
    normals.channels = 3;
    normals.pixels = {0.6f, 0.5f, 0.9f};
    const std::vector<std::byte> png = *prep::encode_png(normals);
    test::write_text(dir_ / "n.png", {reinterpret_cast<const char*>(png.data()), png.size()});
    const auto text_of = [&](std::vector<std::string> options) {
        std::vector<std::string> words = {"prepare", (dir_ / "a.gltf").string(), "-o",
                                          (dir_ / "out.obj").string()};
        words.insert(words.end(), options.begin(), options.end());
        EXPECT_EQ(run_here(words).exit_code, 0);
        return test::file_text(dir_ / "out.obj") + test::file_text(dir_ / "out.mtl");
    };
    const auto has = [](const std::string& text, const char* word) {
        return text.find(word) != std::string::npos;
    };
    const std::string all = text_of({}), phong = text_of({"--for", "shading=phong"});
    EXPECT_TRUE(has(all, "vt ") && has(all, "norm ")) << all;
    EXPECT_TRUE(!has(phong, "vt ") && !has(phong, "norm ")) << phong;
}

TEST_F(PrepareFor, PointsAndLinesKeepWhatTheyHave) {
    test::write_text(dir_ / "c.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\np 1\n");
    const test::Ran ran = run_here({"prepare", (dir_ / "c.obj").string(), "-o",
                                    (dir_ / "out.gltf").string(), "--for", "colors=off"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_NE(written(dir_ / "out.gltf").find("COLOR_0"), std::string::npos);
}

TEST_F(PrepareFor, ExplainsWhatEachMeshCallsFor) {
    const json mesh =
        prepare({"--for", "shading=phong", "--explain"}).json()["files"][0]["requirements"][0];
    EXPECT_EQ(mesh["normals"]["needed"], true);
    EXPECT_EQ(mesh["normals"]["why"]["code"], "material_lit");
    EXPECT_EQ(mesh["normals"]["why"]["label"], "run");
    EXPECT_EQ(mesh["normals"]["why"]["subject"], "/materials/0");
    EXPECT_EQ(mesh["tangents"]["why"]["code"], "no_tangent_map");
    EXPECT_EQ(mesh["tangents"]["why"]["label"], "not requested");
    EXPECT_EQ(mesh["calls"].size(), 1u);
    const json all = prepare({"--explain"}).json()["files"][0]["requirements"][0];
    EXPECT_EQ(all["calls"].size(), 3u);
    EXPECT_EQ(all["calls"][2]["feature"], "tangent-space map");
    EXPECT_EQ(all["calls"][2]["why"]["subject"], "/materials/0/normal_map");
    EXPECT_EQ(all["provided"]["uv_sets"], json::array({0}));
    EXPECT_FALSE(prepare({}).json()["files"][0].contains("requirements"));
    const test::Ran words = run_here(
        {"prepare", (dir_ / "a.gltf").string(), "-o", (dir_ / "out.glb").string(), "--explain"});
    EXPECT_NE(words.out.find("material 'rough' has a tangent-space normal map"), std::string::npos)
        << words.out;
    EXPECT_NE(words.out.find("called for"), std::string::npos) << words.out;
}

// As plans have it: what stands at no node lights nothing, and where nothing does, lights are set
// up.
TEST(ConsumerOption, LightsCountWhereANodeHasThem) {
    prep::Scene scene;
    EXPECT_TRUE(meshprep::has_directed_light(scene));
    scene.lights.resize(2);
    scene.lights[0].kind = prep::LightKind::ambient;
    scene.lights[1].kind = prep::LightKind::directional;
    scene.nodes.resize(1);
    scene.nodes[0].light = 0;
    EXPECT_FALSE(meshprep::has_directed_light(scene));
    scene.nodes[0].light = 1;
    EXPECT_TRUE(meshprep::has_directed_light(scene));
    scene.lights.resize(1);
    scene.nodes[0].light = prep::no_index;
    EXPECT_TRUE(meshprep::has_directed_light(scene));
}

TEST_F(PrepareFor, WhatItDoesNotKnowIsAUsageError) {
    for (const char* wrong : {"shading=shiny", "textures=maybe", "tangents=on", "phong"}) {
        const test::Ran ran = prepare({"--for", wrong});
        EXPECT_EQ(ran.exit_code, 2) << wrong;
        EXPECT_NE(ran.err.find("--for"), std::string::npos) << ran.err;
    }
}

TEST_F(PrepareFor, AMissingSceneFileIsAnErrorLikeAnyInput) {
    const test::Ran ran = prepare({"--for", "missing.json"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE((ran.err + ran.out).find("missing.json"), std::string::npos) << ran.err << ran.out;
    EXPECT_FALSE(std::filesystem::exists(dir_ / "out.glb"));
}

}  // namespace
