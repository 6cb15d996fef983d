// What is written never replaces what an input is read from: pictures, libraries, meshes of scenes.
// And what an input is read from is known: a change of it is a change of the input.
#include <gtest/gtest.h>

#include <set>

#include "command_runner.h"
#include "prep/image.h"

namespace {

namespace fs = std::filesystem;
using test::file_text;
using test::run_here;
using test::TempDir;
using test::write_text;

const char* const triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";

// A model of three files; the picture has the model's name, as many have.
void write_model(const fs::path& folder, const std::string& name, const std::string& picture) {
    write_text(folder / (name + ".obj"),
               "mtllib " + name + ".mtl\n" + std::string(triangle) + "usemtl m\nf 1/1 2/2 3/3\n");
    write_text(folder / (name + ".mtl"), "newmtl m\nmap_Kd " + picture + "\n");
}

std::string write_picture(const fs::path& path, float value = 0.5f) {
    const prep::Image image{2, 2, 3, std::vector<float>(12, value)};
    EXPECT_TRUE(prep::save_image(path, image).has_value());
    return file_text(path);
}

TEST(SparedFiles, SheetsAreNotDrawnOverAModelsOwnPicture) {
    const TempDir dir;
    write_model(dir.path(), "spot", "spot.png");
    const std::string picture = write_picture(dir / "spot.png");
    const std::string spot = (dir / "spot.obj").string();
    const test::Ran ran =
        run_here({"validate", spot, "-o", dir.path().string(), "--panel", "64", "--json"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_EQ(file_text(dir / "spot.png"), picture);
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"spot.mtl", "spot.obj", "spot.png"}));
    const nlohmann::json error = ran.json()["files"][0]["error"];
    EXPECT_EQ(error["place"], (dir / "spot.png").string());
    EXPECT_EQ(error["text"],
              "a model is read from this file, and a sheet would be written over it; give a "
              "directory of its own");
    const std::string sheets = (dir / "sheets").string();
    for (int again = 0; again < 2; ++again)  // its own sheets are replaced
        EXPECT_EQ(run_here({"validate", spot, "-o", sheets, "--panel", "64"}).exit_code, 0);
}

// Whichever comes first: the picture of an input that has not been read yet is spared as well.
TEST(SparedFiles, SheetsAreNotDrawnOverPicturesOfOtherInputs) {
    for (const bool first : {false, true}) {
        const TempDir dir;
        write_model(dir.path(), "a", "b.png");
        write_text(dir / "b.obj", std::string(triangle) + "f 1 2 3\n");
        const std::string picture = write_picture(dir / "b.png");
        std::vector<std::string> words{"validate", (dir / "a.obj").string(),
                                       (dir / "b.obj").string()};
        if (first) std::swap(words[1], words[2]);
        for (const std::string& word :
             {std::string("-o"), dir.path().string(), std::string("--panel"), std::string("64")})
            words.push_back(word);
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_NE(ran.err.find((dir / "b.png").string() + ": a model is read from this file"),
                  std::string::npos)
            << ran.err;
        EXPECT_EQ(file_text(dir / "b.png"), picture);
        EXPECT_TRUE(fs::exists(dir / "a.html"));
        EXPECT_FALSE(fs::exists(dir / "b.html"));
    }
}

std::string two_meshes() {
    return R"({"meshprep":1,"meshes":{"x":{"shape":{"kind":"box"}},"y":{"shape":{"kind":"box"}}}})";
}

TEST(SparedFiles, SheetsOfOneNameAreTheLaterInputsError) {
    const TempDir dir;
    write_text(dir / "a.json", two_meshes());
    write_text(dir / "a-0-x.obj", test::cube_obj());
    const test::Ran ran =
        run_here({"validate", (dir / "a.json").string(), (dir / "a-0-x.obj").string(), "-o",
                  (dir / "out").string(), "--panel", "64", "--json"});
    EXPECT_EQ(ran.exit_code, 1);
    nlohmann::json files = ran.json()["files"];
    EXPECT_EQ(files[0]["status"], "ok") << ran.err;
    EXPECT_EQ(files[1]["error"]["text"],
              "another sheet has this name; validate the inputs into directories of their own");
    EXPECT_FALSE(fs::exists(dir / "out/a-0-x.html"));
}

TEST(SparedFiles, MeshesOfALongNameHaveASheetEach) {
    const TempDir dir;
    const std::string stem(70, 'n');
    write_text(dir / (stem + ".json"), two_meshes());
    const test::Ran ran = run_here({"validate", (dir / (stem + ".json")).string(), "-o",
                                    (dir / "out").string(), "--panel", "64"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    for (const char* const end : {"", "-0", "-1"})
        EXPECT_TRUE(fs::exists(dir / "out" / (stem + end + ".png"))) << end;
}

// Whatever letters the inputs' names have.
TEST(SparedFiles, InputsOfDifferentNamesHaveDifferentSheets) {
    const TempDir dir;
    std::vector<std::string> words{"validate"};
    const std::string longest(250, 'n');  // with .json the most that a file system takes
    for (const std::string& stem : {std::string("模型"), std::string("角色"), std::string("a b"),
                                    std::string("a-b"), longest}) {
        write_text(dir / (stem + ".json"), two_meshes());
        words.push_back((dir / (stem + ".json")).string());
    }
    const fs::path out = dir / "out";
    for (const std::string& word : {std::string("-o"), out.string(), std::string("--panel"),
                                    std::string("64"), std::string("--json")})
        words.push_back(word);
    const test::Ran ran = run_here(words);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    std::set<std::string> sheets;
    nlohmann::json report = ran.json();
    for (nlohmann::json& file : report["files"])
        for (const nlohmann::json& sheet : file["sheets"]) {
            EXPECT_TRUE(fs::exists(sheet.get<std::string>())) << sheet;
            sheets.insert(sheet.get<std::string>());
        }
    EXPECT_EQ(sheets.size(), 15u);
    for (const char* const name : {"模型-0-x.png", "角色-0-x.png", "a b-1-y.png", "a-b-1-y.png"})
        EXPECT_TRUE(fs::exists(out / name)) << name;
}

TEST(SparedFiles, AMeshThatIsNamedTwiceHasOneSheet) {
    const TempDir dir;
    write_text(dir / "a.json", two_meshes());
    const test::Ran ran =
        run_here({"validate", (dir / "a.json").string(), "-o", (dir / "out").string(), "--panel",
                  "64", "--mesh", "1", "--mesh", "1", "--mesh", "y", "--json"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    nlohmann::json report = ran.json();
    EXPECT_EQ(report["files"][0]["sheets"], nlohmann::json{(dir / "out/a-1-y.png").string()});
}

// That of an earlier run has the name of a buffer now.
TEST(SparedFiles, AManifestIsNotReplacedByAnOutput) {
    const TempDir dir;
    write_text(dir / "a.obj", test::cube_obj());
    const std::string manifest = (dir / "out/a.bin").string();
    const auto run = [&](const char* format) {
        return run_here({"prepare", (dir / "a.obj").string(), "-o", (dir / "out").string() + "/",
                         "--format", format, "--manifest", manifest});
    };
    ASSERT_EQ(run("glb").exit_code, 0);
    const test::Ran ran = run("gltf");
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find(manifest + ": this file is read for another result"), std::string::npos)
        << ran.err;
    EXPECT_FALSE(fs::exists(dir / "out/a.gltf"));
    EXPECT_NE(file_text(manifest).find("\"manifest\": 1"), std::string::npos);
}

TEST(SparedFiles, AManifestIsNotWrittenOverWhatInputsAreReadFrom) {
    const TempDir dir;
    write_model(dir.path(), "a", "a.png");
    const std::string picture = write_picture(dir / "a.png");
    fs::create_symlink(dir / "a.obj", dir / "link");
    const std::string obj = file_text(dir / "a.obj"), mtl = file_text(dir / "a.mtl");
    const std::string input = (dir / "a.obj").string(), out = (dir / "out").string() + "/";
    for (const char* const name : {"a.obj", "link", "a.mtl", "a.png"}) {
        const test::Ran ran =
            run_here({"prepare", input, "-o", out, "--manifest", (dir / name).string()});
        EXPECT_EQ(ran.exit_code, 2) << name;
        EXPECT_NE(ran.err.find("the manifest would be written over this file"), std::string::npos)
            << ran.err;
    }
    EXPECT_EQ(file_text(dir / "a.obj"), obj);
    EXPECT_EQ(file_text(dir / "a.mtl"), mtl);
    EXPECT_EQ(file_text(dir / "a.png"), picture);
    EXPECT_FALSE(fs::exists(dir / "out"));
    // Other files are the user's to give away, and an earlier manifest is replaced.
    write_text(dir / "made.json", "notes");
    for (int again = 0; again < 2; ++again)
        EXPECT_EQ(
            run_here({"prepare", input, "-o", out, "--manifest", (dir / "made.json").string()})
                .exit_code,
            0);
    EXPECT_NE(file_text(dir / "made.json").find("\"manifest\": 1"), std::string::npos);
}

// Pictures of glTF files are read into memory with them, and are files all the same.
class PicturesOfGltf : public ::testing::Test {
  protected:
    PicturesOfGltf() {
        write_model(dir_.path(), "m", "x.png");
        picture_ = write_picture(dir_ / "x.png");
        write_text(dir_ / "a.gltf", gltf("x.png"));
    }
    static std::string gltf(const std::string& picture) {
        return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0,
            "TEXCOORD_0": 1}, "material": 0}]}], "materials": [{"pbrMetallicRoughness":
            {"baseColorTexture": {"index": 0}}}], "textures": [{"source": 0}], "images": [{"uri": ")" +
               picture + R"("}], "buffers": [{"byteLength": 60, "uri":
            "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36,
            "byteLength": 24}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3,
            "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}, {"bufferView": 1,
            "componentType": 5126, "count": 3, "type": "VEC2"}]})";
    }
    std::string at(const std::string& name) const { return (dir_ / name).string(); }
    TempDir dir_;
    std::string picture_;
};

TEST_F(PicturesOfGltf, AreNotWrittenOver) {
    const std::vector<std::vector<std::string>> runs = {
        {"render", at("a.gltf"), "-o", at("x.png"), "--size", "16x16"},
        {"prepare", at("a.gltf"), "-o", at("b.glb"), "--manifest", at("x.png")},
        {"cost", at("a.gltf"), "--ladder", "normals", "-o", at("x.png")}};
    for (const auto& run : runs) {
        EXPECT_NE(run_here(run).exit_code, 0) << run[0];
        EXPECT_EQ(file_text(dir_ / "x.png"), picture_) << run[0];
    }
}

// A picture beside the output gets another name, or is an error; the one that is read stays.
TEST_F(PicturesOfGltf, AreNoneBesideAnOutput) {
    const std::string other = write_picture(dir_ / "b_image0.png", 0.125f);
    write_text(dir_ / "c.gltf", gltf("b_image0.png"));
    for (const char* const reader : {"b_image0.png", "x.png"}) {
        write_text(dir_ / "a.gltf", gltf(reader));
        run_here(
            {"prepare", at("a.gltf"), at("c.gltf"), "-o", dir_.path().string(), "--format", "obj"});
        run_here(
            {"prepare", at("c.gltf"), at("a.gltf"), "-o", dir_.path().string(), "--format", "obj"});
        run_here({"prepare", at("c.gltf"), "-o", at("b.obj")});
        EXPECT_EQ(file_text(dir_ / "b_image0.png"), other);
        EXPECT_EQ(file_text(dir_ / "x.png"), picture_);
    }
}

TEST_F(PicturesOfGltf, AreSourcesOfTheResult) {
    const auto state = [&] {
        const test::Ran ran = run_here({"prepare", at("a.gltf"), "-o", at("out/"), "--manifest",
                                        at("made.json"), "--json", "--skip-unchanged"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.json()["files"][0]["status"].get<std::string>();
    };
    EXPECT_EQ(state(), "ok");
    EXPECT_EQ(state(), "skipped");
    const std::string before = file_text(dir_ / "out/a.glb");
    write_picture(dir_ / "x.png", 0.75f);
    EXPECT_EQ(state(), "ok");
    EXPECT_NE(file_text(dir_ / "out/a.glb"), before);
    EXPECT_EQ(state(), "skipped");
}

TEST(SparedFiles, AManifestIsNotWrittenOverAFileBesideAnOutput) {
    const TempDir dir;
    write_text(dir / "a.obj", test::cube_obj());
    const fs::path buffer = dir / "out/a.bin";
    const test::Ran ran =
        run_here({"prepare", (dir / "a.obj").string(), "-o", (dir / "out").string() + "/",
                  "--format", "gltf", "--manifest", buffer.string()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("the manifest would be written over this output"), std::string::npos)
        << ran.err;
    EXPECT_EQ(run_here({"inspect", (dir / "out/a.gltf").string()}).exit_code, 0);
}

TEST(SparedFiles, HeightsOfTheCommandLineStay) {
    const TempDir dir;
    write_text(dir / "a.obj", std::string(triangle) + "f 1/1 2/2 3/3\n");
    const std::string input = (dir / "a.obj").string(), heights = (dir / "a.png").string();
    const std::string bytes = write_picture(heights);
    const std::vector<std::string> displaced = {"--displace", heights, "--chord-error", "0.1"};
    std::vector<std::vector<std::string>> lines = {
        {"render", input, "-o", heights, "--size", "16x16"},
        {"validate", input, "-o", dir.path().string(), "--panel", "64"},
        {"prepare", input, "-o", (dir / "a.glb").string(), "--manifest", heights}};
    for (std::vector<std::string>& words : lines) {
        words.insert(words.end(), displaced.begin(), displaced.end());
        const test::Ran ran = run_here(words);
        EXPECT_NE(ran.exit_code, 0) << words[0];
        EXPECT_NE(ran.err.find(heights + ": "), std::string::npos) << ran.err;
        EXPECT_EQ(file_text(heights), bytes) << words[0];
    }
}

TEST(SparedFiles, AHeatMapIsNoneOfThePictures) {
    const TempDir dir;
    const std::string a = (dir / "a.png").string(), b = (dir / "b.png").string();
    const std::string first = write_picture(a, 0.25f), second = write_picture(b, 0.75f);
    for (const std::string& map : {a, b}) {
        const test::Ran ran = run_here({"diff", a, b, "--heat-map", map});
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_NE(ran.err.find(map + ": the output is also an input"), std::string::npos)
            << ran.err;
    }
    const std::string map = (dir / "map.png").string();
    const test::Ran one = run_here({"diff", a, b, "--heat-map", map, "--report", map});
    EXPECT_EQ(one.exit_code, 1);
    EXPECT_NE(one.err.find(map + ": two outputs would be written here"), std::string::npos)
        << one.err;
    const test::Ran stream = run_here({"diff", a, b, "--report", "-"});
    EXPECT_EQ(stream.exit_code, 1);
    EXPECT_NE(stream.err.find("-: only --json writes to standard output"), std::string::npos)
        << stream.err;
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"a.png", "b.png"}));
    EXPECT_EQ(file_text(a), first);
    EXPECT_EQ(file_text(b), second);
}

TEST(SparedFiles, PagesOfCostAreNoLibraryOfAnInput) {
    const TempDir dir;
    write_model(dir.path(), "a", "a.png");
    const std::string library = file_text(dir / "a.mtl");
    const test::Ran ran =
        run_here({"cost", (dir / "a.obj").string(), "--ladder", "normal-precision", "--rounds", "1",
                  "--csv", (dir / "a.mtl").string()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("the output is also an input"), std::string::npos) << ran.err;
    EXPECT_EQ(file_text(dir / "a.mtl"), library);
}

// An input may have any name; here that of the library beside the output.
TEST(SparedFiles, TheInputIsNoFileBesideItsOutput) {
    const TempDir dir;
    const std::string text = std::string(triangle) + "usemtl red\nf 1 2 3\n";
    write_text(dir / "a.mtl", text);
    const test::Ran ran = run_here({"prepare", (dir / "a.mtl").string(), "--input-format", "obj",
                                    "-o", (dir / "a.obj").string()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find((dir / "a.mtl").string() + ": this file"), std::string::npos) << ran.err;
    EXPECT_EQ(file_text(dir / "a.mtl"), text);
    EXPECT_EQ(dir.names(), std::vector<std::string>{"a.mtl"});
}

TEST(SparedFiles, TheMeshesOfASceneAreNoOutputOfIt) {
    const TempDir dir;
    write_text(dir / "part.obj", test::cube_obj());
    write_text(dir / "scene.json", R"({"meshprep":1,"meshes":{"p":{"file":"part.obj"}}})");
    const std::string scene = (dir / "scene.json").string();
    const test::Ran ran = run_here({"prepare", scene, "-o", (dir / "part.obj").string()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find((dir / "part.obj").string() + ": this file was read for the result"),
              std::string::npos)
        << ran.err;
    EXPECT_EQ(file_text(dir / "part.obj"), test::cube_obj());
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"part.obj", "scene.json"}));
}

TEST(SparedFiles, AChangedMeshOfASceneIsAChange) {
    const TempDir dir;
    write_model(dir.path(), "part", "part.png");
    write_picture(dir / "part.png");
    write_text(dir / "scene.json",
               R"({"meshprep":1,"meshes":{"p":{"file":"part.obj"},"q":{"file":"part.obj"}}})");
    const fs::path manifest = dir / "made.json";
    const auto run = [&] {
        const test::Ran ran =
            run_here({"prepare", (dir / "scene.json").string(), "-o", (dir / "out.glb").string(),
                      "--manifest", manifest.string(), "--skip-unchanged", "--json"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.json()["files"][0]["status"].get<std::string>();
    };
    EXPECT_EQ(run(), "ok");
    nlohmann::json made = nlohmann::json::parse(file_text(manifest));
    std::vector<std::string> sources;
    for (nlohmann::json& source : made["files"][0]["sources"])
        sources.push_back(fs::path(source["path"].get<std::string>()).filename().string());
    EXPECT_EQ(sources, (std::vector<std::string>{"scene.json", "part.obj", "part.mtl", "part.png",
                                                 "part.png"}));
    EXPECT_EQ(run(), "skipped");
    for (const char* const name : {"part.obj", "part.mtl"}) {
        write_text(dir / name, file_text(dir / name) + "# changed\n");
        EXPECT_EQ(run(), "ok") << name;
        EXPECT_EQ(run(), "skipped") << name;
    }
}

}  // namespace
