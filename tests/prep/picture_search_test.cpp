// Where pictures are found that files name by the paths of other machines: a test for each rule of
// docs/materials.md, and the same for every reader.
#include "formats/picture_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "mesh_files.h"
#include "prep/image.h"
#include "prep/load.h"
#include "prep/scene_json.h"

namespace {

using prep::detail::PictureSearch;

// A model's directory with files in it, named by their paths below it; "../" goes beside it.
class Place {
  public:
    explicit Place(const std::vector<std::string>& files) {
        std::filesystem::create_directories(model());
        for (const std::string& file : files) add(file);
    }
    std::filesystem::path model() const { return dir_.path() / "outer" / "model"; }
    void add(const std::string& file) const {
        const std::filesystem::path path = (model() / file).lexically_normal();
        std::filesystem::create_directories(path.parent_path());
        test::write_text(path, "x");
    }
    // What is found for a name, below the model's directory; "" where nothing is.
    std::string found(const std::string& name, const std::vector<std::string>& extra = {}) const {
        std::vector<std::filesystem::path> directories;
        for (const std::string& e : extra) directories.push_back(model() / e);
        PictureSearch search(model(), directories);
        const auto path = search.locate(name);
        return path ? path->lexically_relative(model()).generic_string() : "";
    }

  private:
    test::TempDir dir_;
};

TEST(PictureSearch, TakesNamesAsTheyStandFirst) {
    const Place place({"a.png", "textures/a.png", "sub/a.png", "odd\\name.png", "name.png"});
    EXPECT_EQ(place.found("a.png"), "a.png");
    EXPECT_EQ(place.found("sub/a.png"), "sub/a.png");
    EXPECT_EQ(place.found("./sub/../a.png"), "a.png");
    EXPECT_EQ(place.found("odd\\name.png"), "odd\\name.png");  // a file of that very name
    EXPECT_EQ(place.found((place.model() / "sub" / "a.png").string()), "sub/a.png");
}

TEST(PictureSearch, BackslashesAreSlashes) {
    const Place place({"Sub/Dir/a.png"});
    EXPECT_EQ(place.found("Sub\\Dir\\a.png"), "Sub/Dir/a.png");
    EXPECT_EQ(place.found(".\\Sub\\Dir\\a.png"), "Sub/Dir/a.png");
}

TEST(PictureSearch, CapitalsDoNotMatterUnlessBothAreThere) {
    const Place place({"Maps2/Wood.PNG", "both.png", "Both.png", "BOTH2.png", "Both2.png"});
    EXPECT_EQ(place.found("maps2/wood.png"), "Maps2/Wood.PNG");
    EXPECT_EQ(place.found("both.png"), "both.png");
    EXPECT_EQ(place.found("Both.png"), "Both.png");
    EXPECT_EQ(place.found("both2.png"), "BOTH2.png");  // the first in the order of bytes
}

TEST(PictureSearch, PathsOfOtherMachinesAreFoundByTheirLastParts) {
    const Place place({"wood.png", "maps/bark.png", "project/tex/leaf.png", "leaf.png"});
    for (const char* name :
         {"C:\\Users\\me\\project\\wood.png", "C:/Users/me/wood.png", "c:wood.png",
          "\\\\server\\share\\wood.png", "/home/me/wood.png", "file:///C:/me/wood.png",
          "\"D:\\wood.png\"", "D:\\WOOD.png ", "/C:/me/wood.png", "C:\\me\\wo%6Fd.png"})
        EXPECT_EQ(place.found(name), "wood.png") << name;
    EXPECT_EQ(place.found("C:\\me\\maps\\bark.png"), "maps/bark.png");
    // As many of them as fit.
    EXPECT_EQ(place.found("C:\\me\\project\\tex\\leaf.png"), "project/tex/leaf.png");
    EXPECT_EQ(place.found("C:\\me\\tex\\leaf.png"), "leaf.png");
}

TEST(PictureSearch, FoldersOfPicturesAreLookedInInTheirOrder) {
    for (const std::string_view folder : prep::detail::picture_folders) {
        const std::string inside = std::string(folder) + "/a.png";
        EXPECT_EQ(Place({inside}).found("x/a.png"), inside);
        EXPECT_EQ(Place({"../" + inside}).found("a.png"), "../" + inside);  // beside the directory
    }
    EXPECT_EQ(Place({"textures/a.png", "maps/a.png", "../textures/a.png"}).found("a.png"),
              "textures/a.png");
    EXPECT_EQ(Place({"Textures/a.png"}).found("a.png"), "Textures/a.png");
    EXPECT_EQ(Place({"materials2/a.png"}).found("a.png"), "");
}

TEST(PictureSearch, DirectoriesOfTheUserComeLastInTheirOrder) {
    const Place place({"../far/a.png", "../far/b.png", "../far2/a.png", "maps/b.png"});
    EXPECT_EQ(place.found("a.png"), "");
    EXPECT_EQ(place.found("a.png", {"../far2"}), "../far2/a.png");
    EXPECT_EQ(place.found("a.png", {"../far", "../far2"}), "../far/a.png");
    EXPECT_EQ(place.found("b.png", {"../far"}), "maps/b.png");
    EXPECT_EQ(place.found("C:\\x\\A.PNG", {"../far"}), "../far/a.png");
}

// Only what the file itself writes leaves the directories that are searched.
TEST(PictureSearch, GuessesStayInsideTheirDirectories) {
    const Place place({"../secret.png", "../../top.png", "../Other/c.png", "textures/x"});
    EXPECT_EQ(place.found("secret.png"), "");
    EXPECT_EQ(place.found("C:\\..\\secret.png"), "");
    EXPECT_EQ(place.found("textures/../../secret.png"), "../secret.png");  // as it stands
    EXPECT_EQ(place.found("./.././other/C.png"), "../Other/c.png");
    EXPECT_EQ(place.found("..\\secret.png"), "../secret.png");
    EXPECT_EQ(place.found("..\\other\\C.png"), "../Other/c.png");
    EXPECT_EQ(place.found("top.png", {"textures"}), "");
    EXPECT_EQ(place.found("C:/a/../../../top.png", {"textures"}), "");
}

TEST(PictureSearch, NamesThatAreNoneFindNothing) {
    const Place place({"a.png", "textures/b.png"});
    for (const std::string& name :
         {std::string(), std::string("."), std::string(".."), std::string("/"), std::string("C:\\"),
          std::string("textures"), std::string("a.png\0b", 7), std::string(5000, 'x'),
          std::string("a.png/b")})
        EXPECT_EQ(place.found(name), "") << name.substr(0, 20);
}

TEST(PictureSearch, WhatIsMissingIsListedOnceWithThePlaces) {
    const Place place({"a.png"});
    PictureSearch search(place.model(), {"/nowhere/else"});
    EXPECT_EQ(search.warnings(), std::vector<std::string>{});
    EXPECT_EQ(search.find("a.png"), place.model() / "a.png");
    EXPECT_EQ(search.warnings(), std::vector<std::string>{});
    for (const char* name : {"Textures\\gone.png", "C:\\x\\lost.png", "Textures\\gone.png"})
        search.find(name);
    EXPECT_EQ(search.find("Textures\\gone.png"), place.model() / "Textures/gone.png");
    ASSERT_EQ(search.warnings().size(), 1u);
    EXPECT_EQ(search.warnings()[0],
              "2 pictures were not found: Textures\\gone.png, C:\\x\\lost.png; sought in '" +
                  place.model().string() +
                  "', its folders textures, texture, tex, maps, images, image, img, pictures and "
                  "those beside it, '/nowhere/else'");
}

// --- the readers -------------------------------------------------------------------------------

std::filesystem::path picture(const std::filesystem::path& path) {
    prep::Image image;
    image.width = image.height = 1;
    image.channels = 3;
    image.pixels = {1, 0, 0};
    std::filesystem::create_directories(path.parent_path());
    EXPECT_TRUE(prep::save_image(path, image).has_value());
    return path;
}

struct Model {
    const char* name;
    std::string text;
};

std::vector<Model> models_with(const std::string& file) {
    const std::string escaped = file == "C:\\art\\Wood.png" ? "C:\\\\art\\\\Wood.png" : file;
    return {
        {"a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n"},
        {"a.ply",
         "ply\nformat ascii 1.0\ncomment TextureFile " + file +
             "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty "
             "float s\nproperty float t\nelement face 1\nproperty list uchar int "
             "vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"},
        {"a.gltf", R"({"asset": {"version": "2.0"}, "images": [{"uri": ")" + escaped +
                       R"("}], "textures": [{"source": 0}]})"},
        {"a.json", R"({"meshprep": 1, "textures": {"t": {"file": ")" + escaped +
                       R"("}}, "meshes": {"m": {"shape": {"kind": "sphere"}}}})"},
        {"a.x",
         "xof 0303txt 0032\nMaterial m { 1;1;1;1;; 10; 0;0;0;; 0;0;0;; TextureFilename { \"" +
             escaped +
             "\"; } }\nMesh t { 3; 0;0;0;, 1;0;0;, 0;1;0;; 1; 3;0,1,2;; MeshMaterialList { 1; 1; "
             "0;; {m} } }\n"}};
}

TEST(PictureSearch, EveryReaderFindsPicturesInTexturesAndInGivenDirectories) {
    for (const bool given : {false, true}) {
        const test::TempDir dir;
        std::filesystem::create_directories(dir / "model");
        picture(given ? dir / "far" / "wood.png" : dir / "model" / "Textures" / "wood.png");
        test::write_text(dir / "model" / "a.mtl", "newmtl m\nmap_Kd C:\\art\\Wood.png\n");
        prep::LoadOptions options;
        if (given) options.texture_directories.push_back(dir / "far");
        for (const Model& model : models_with("C:\\art\\Wood.png")) {
            test::write_text(dir / "model" / model.name, model.text);
            const auto scene = prep::load_scene(dir / "model" / model.name, options);
            ASSERT_TRUE(scene.has_value()) << model.name << prep::to_string(scene.error());
            ASSERT_EQ(scene->images.size(), 1u) << model.name;
            EXPECT_TRUE(prep::load_image(scene->images[0]).has_value()) << model.name;
            EXPECT_EQ(scene->warnings, std::vector<std::string>{}) << model.name;
        }
    }
}

TEST(PictureSearch, EveryMeshReaderListsWhatIsMissingOnce) {
    const test::TempDir dir;
    test::write_text(dir / "a.mtl", "newmtl m\nmap_Kd gone.png\nmap_Ks gone.png\n");
    for (const Model& model : models_with("gone.png")) {
        if (std::string(model.name) == "a.json") continue;  // that is an error: a scene is written
        test::write_text(dir / model.name, model.text);
        const auto scene = prep::load_scene(dir / model.name);
        ASSERT_TRUE(scene.has_value()) << model.name << prep::to_string(scene.error());
        ASSERT_EQ(scene->warnings.size(), 1u) << model.name;
        EXPECT_TRUE(scene->warnings[0].starts_with(
            "a picture was not found: gone.png; sought in '" + dir.path().string() + "'"))
            << model.name << ": " << scene->warnings[0];
        EXPECT_NE(scene->warnings[0].find("--texture-dir"), std::string::npos);
    }
}

TEST(PictureSearch, WhatGlowsByAMissingPictureDoesNotGlow) {
    const test::TempDir dir;
    test::write_text(dir / "m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    test::write_text(dir / "m.mtl", "newmtl a\nKe 1 1 1\nmap_Ke glow.png\nnewmtl b\nKe 1 0.5 0\n");
    auto scene = prep::load_scene(dir / "m.obj");
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(scene->materials[0].emissive, glm::vec3(0));
    EXPECT_EQ(scene->materials[1].emissive, glm::vec3(1, 0.5f, 0));
    test::write_text(dir / "glow.png", "x");
    scene = prep::load_scene(dir / "m.obj");
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(scene->materials[0].emissive, glm::vec3(1));
}

TEST(PictureSearch, MaterialLibrariesAreFoundTheSameWay) {
    const test::TempDir dir;
    test::write_text(dir / "My Look.MTL", "newmtl m\nKd 1 0 0\n");
    test::write_text(dir / "a.obj",
                     "mtllib C:\\me\\my look.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    const auto scene = prep::load_scene(dir / "a.obj");
    ASSERT_TRUE(scene.has_value());
    ASSERT_EQ(scene->materials.size(), 1u);
    EXPECT_EQ(scene->materials[0].diffuse, glm::vec4(1, 0, 0, 1));
}

// A name of thousands of folders would be sought in seconds and gigabytes.
TEST(PictureSearchPlaces, AreFewWhateverTheName) {
    const Place place({"textures/t.png"});
    std::string name;
    for (int n = 0; n < 1500; ++n) name += "a/";
    PictureSearch search(place.model());
    const auto found = search.locate(name + "t.png");
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->lexically_relative(place.model()).generic_string(), "textures/t.png");
    EXPECT_LT(search.passed_over().size(), 700u);
    EXPECT_TRUE(search.passed_over().contains(place.model() / "t.png"));
    EXPECT_FALSE(search.passed_over().contains(place.model() / "textures/t.png"));
}

}  // namespace
