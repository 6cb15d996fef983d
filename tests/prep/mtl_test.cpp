#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <string>

#include "formats/obj/obj.h"
#include "invariants.h"
#include "mesh_files.h"
#include "prep/image.h"
#include "prep/save.h"
#include "shapes.h"

namespace {

prep::MtlLibrary parse(const std::string& text) {
    return prep::parse_mtl(text, "m.mtl", "textures");
}

TEST(MtlFile, EmptyAndCommentsOnlyGiveNothing) {
    for (const char* text : {"", "\n\n", "# nothing\r\n", "\xef\xbb\xbf# a byte order mark\n"}) {
        const auto lib = parse(text);
        EXPECT_TRUE(lib.materials.empty());
        EXPECT_TRUE(lib.warnings.empty());
    }
}

TEST(MtlFile, WordsAreReadInAnyCaseAndMaterialsStartAfresh) {
    const auto lib = parse("NewMtl one\r\nKD 1 0 0\r\nNS 10\r\nnewmtl two\r\nkd 0 1 0\r\n");
    ASSERT_EQ(lib.materials.size(), 2u);
    EXPECT_EQ(lib.materials[0].diffuse, glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(lib.materials[1].diffuse, glm::vec4(0, 1, 0, 1));
    EXPECT_EQ(lib.materials[1].shininess, prep::Material{}.shininess);
    EXPECT_EQ(lib.materials[0].specular, prep::usual_specular(10));
}

TEST(MtlFile, OpacityAndTransparency) {
    const auto lib = parse(
        "newmtl a\nTr 0.25\nnewmtl b\nd 0.5\nTr 0.9\nnewmtl c\nTr 0.9\nd 0.5\nnewmtl d\nd -halo "
        "0.25\nnewmtl e\nd 7\nnewmtl f\nd 0.5\nd 1\n");
    ASSERT_EQ(lib.materials.size(), 6u);
    EXPECT_EQ(lib.materials[0].diffuse.a, 0.75f);
    EXPECT_EQ(lib.materials[1].diffuse.a, 0.5f);
    EXPECT_EQ(lib.materials[2].diffuse.a, 0.5f);
    EXPECT_EQ(lib.materials[3].diffuse.a, 0.25f);
    EXPECT_EQ(lib.materials[4].diffuse.a, 1.0f);
    EXPECT_EQ(lib.materials[5].alpha_mode, prep::AlphaMode::opaque);
}

TEST(MtlFile, IlluminationModels) {
    const auto lib = parse(
        "newmtl a\nKs 1 1 1\nillum 0\nnewmtl b\nKs 1 1 1\nillum 1\nnewmtl c\nKs 1 1 1\nillum 2\n");
    EXPECT_TRUE(lib.materials[0].unlit);
    EXPECT_EQ(lib.materials[1].specular, glm::vec3(0));
    EXPECT_EQ(lib.materials[2].specular, glm::vec3(1));
}

TEST(MtlFile, MapOptionsEndWhereTheFileNameBegins) {
    const auto lib = parse(
        "newmtl a\nmap_Kd -clamp on -mm 0 1 -blendu on -texres 512 -o 0.5 tex 1.png\n"
        "map_Ks -s 2 2 2 -imfchan r sub\\dir\\spec.png\nmap_Ke -t 1 2 3 glow.png\n"
        "disp -bm 0.25 height.png\nnorm n.png\n");
    const prep::Material& m = lib.materials[0];
    const auto image = [&](const prep::TextureRef& ref) {
        return lib.images[lib.textures[ref.texture].image];
    };
    EXPECT_EQ(image(m.diffuse_map).name, "tex 1.png");
    EXPECT_EQ(lib.textures[m.diffuse_map.texture].wrap_u, prep::Wrap::clamp);
    EXPECT_EQ(m.diffuse_map.offset, glm::vec2(0.5f, 0));
    EXPECT_EQ(image(m.specular_map).name, "sub/dir/spec.png");
    EXPECT_EQ(image(m.specular_map).path, std::filesystem::path("textures/sub/dir/spec.png"));
    EXPECT_EQ(m.specular_map.scale, glm::vec2(2));
    EXPECT_EQ(image(m.emissive_map).name, "glow.png");
    EXPECT_EQ(m.displacement_map.strength, 0.25f);
    EXPECT_EQ(image(m.normal_map).name, "n.png");
}

TEST(MtlFile, DisplacementIsBaseAndGain) {
    const auto read = [](const std::string& options) {
        return parse("newmtl a\ndisp" + options + " height.png\n");
    };
    const auto as = [&](const std::string& options, float scale, float midlevel) {
        const auto lib = read(options);
        const prep::Material& m = lib.materials[0];
        EXPECT_TRUE(m.displacement_map) << options;
        EXPECT_EQ(m.displacement_scale, scale) << options;
        EXPECT_EQ(m.displacement_midlevel, midlevel) << options;
        EXPECT_EQ(m.displacement_kind, prep::DisplacementKind::height);
        for (const std::string& warning : lib.warnings)
            EXPECT_EQ(warning.find("-mm"), std::string::npos) << warning;
    };
    as("", 1, 0);
    as(" -mm 0 1", 1, 0);
    as(" -mm -0.5 1", 1, 0.5f);
    as(" -mm 0.25 -0.5 -bm 2", -0.5f, 0.5f);
    as(" -mm 0.125", 1, -0.125f);
    // The same height everywhere is none of a map's.
    as(" -mm 3 0", 0, 0);
    EXPECT_NE(read(" -mm 3 0").warnings.at(0).find("gain of 0"), std::string::npos);
    as(" -mm 1e30 1e-30", 1e-30f, 0);
    // Another map's is not taken, as before.
    EXPECT_NE(parse("newmtl a\nbump -mm -0.5 1 height.png\n").warnings.size(), 0u);
}

TEST(MtlFile, OneImageIsKeptOnceAndMissingOnesAreNamedOnce) {
    const test::TempDir dir;
    test::write_text(dir / "there.png", "x");
    const auto lib = prep::parse_mtl(
        "newmtl a\nmap_Kd there.png\nmap_Ks gone.png\nnewmtl b\nmap_Kd ./there.png\nmap_Ks "
        "gone.png\nmap_Ke -clamp on gone.png\n",
        "m.mtl", dir.path());
    EXPECT_EQ(lib.images.size(), 2u);
    EXPECT_EQ(lib.textures.size(), 3u);  // gone.png repeated and clamped
    EXPECT_EQ(lib.warnings,
              std::vector<std::string>{
                  "a picture was not found: gone.png; sought in '" + dir.path().string() +
                  "', its folders textures, texture, tex, maps, images, image, img, pictures and "
                  "those beside it; --texture-dir names more places"});
}

TEST(MtlFile, WarningsNameTheLineAndAreNotEndless) {
    const auto lib =
        parse("newmtl a\nKd nan 0 0\nKd 1 2\nNs many\nmap_Kd -s\nmap_Kd -bm x tex.png\n");
    EXPECT_EQ(lib.warnings[0], "m.mtl:2: expected a number; the statement was skipped");
    EXPECT_EQ(lib.warnings[1], "m.mtl:3: expected a number; the statement was skipped");
    EXPECT_EQ(lib.warnings[2], "m.mtl:4: expected a number; the statement was skipped");
    EXPECT_EQ(lib.warnings[3], "m.mtl:5: option -s lacks its argument");
    EXPECT_EQ(lib.materials[0].diffuse, prep::Material{}.diffuse);
    std::string flood;
    for (int i = 0; i < 1000; ++i) flood += "Kd x\n";
    EXPECT_EQ(parse("newmtl a\n" + flood).warnings.size(), 20u);
}

TEST(MtlFile, ValuesBeyondFloatsAreWarningsAndTheDefaultStays) {
    const auto lib = parse(
        "newmtl a\nKs 1e40\nKd 0.5 -1e39 0\nNs inf\nKe 3.4e38\nmap_Kd -s 1e31 2 -bm 1e39 t.png\n");
    EXPECT_EQ(std::vector<std::string>(lib.warnings.begin(), lib.warnings.begin() + 5),
              (std::vector<std::string>{
                  "m.mtl:2: expected a number of at most 3.4e38; the statement was skipped",
                  "m.mtl:3: expected a number of at most 3.4e38; the statement was skipped",
                  "m.mtl:4: expected a number; the statement was skipped",
                  "m.mtl:6: option -s has a value beyond 1e30; it was skipped",
                  "m.mtl:6: option -bm has a value beyond 1e30; it was skipped"}));
    const prep::Material& m = lib.materials[0];
    EXPECT_EQ(m.specular, prep::usual_specular(m.shininess));
    EXPECT_EQ(m.diffuse, prep::Material{}.diffuse);
    EXPECT_EQ(m.shininess, prep::Material{}.shininess);
    EXPECT_EQ(m.emissive, glm::vec3(3.4e38f));
    EXPECT_EQ(m.diffuse_map.scale, glm::vec2(1));
    EXPECT_EQ(m.diffuse_map.strength, 1.0f);
}

TEST(MtlFile, CommentsEndAnyLineButNamesKeepTheirHash) {
    const test::TempDir dir;
    test::write_text(dir / "t#1.png", "x");
    test::write_text(dir / "u.png", "x");
    const auto lib = prep::parse_mtl(
        "newmtl Material #25\nKd 1 0 0 # red\nKs 0.5 # grey\nNs 7#x\nillum 2 # on\n"
        "map_Kd t#1.png\nmap_Ks u.png # the second\n",
        "m.mtl", dir.path());
    EXPECT_EQ(lib.warnings, std::vector<std::string>{});
    const prep::Material& m = lib.materials[0];
    EXPECT_EQ(m.name, "Material #25");
    EXPECT_EQ(m.diffuse, glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(m.specular, glm::vec3(0.5f));
    EXPECT_EQ(m.shininess, 7.0f);
    EXPECT_EQ(lib.images[0].name, "t#1.png");
    EXPECT_EQ(lib.images[1].name, "u.png");
}

TEST(MtlFile, MapOptionsThatAreNotTakenAreNamedOnce) {
    const std::string file = " t.png\n";
    const auto warnings = [&](const std::string& options) {
        auto all = parse("newmtl a\nmap_Kd" + options + file + "map_Ks" + options + file).warnings;
        return std::vector<std::string>(all.begin(), all.end() - 1);  // the missing picture
    };
    const std::vector<std::string> none;
    EXPECT_EQ(warnings(" -mm 0 1 -blendu on -t 0 0 0 -cc off -boost 0 -texres 64 -clamp on"), none);
    EXPECT_EQ(warnings(" -mm 0.1 0.9 -blendv off -t 1 -imfchan r"),
              std::vector<std::string>{
                  "m.mtl: map options that were not taken: -mm, -blendv, -t, -imfchan"});
}

TEST(MtlFile, StatementsThatAreNotTakenAreNamedOnce) {
    const auto lib = parse(
        "newmtl a\nNi 1.5\nTf 1 1 1\nTf 1\nRx 0.3\nmap_Ka x.png\nnewmtl b\nRx 0.4\nhaste 3\n");
    EXPECT_EQ(
        lib.warnings,
        (std::vector<std::string>{"m.mtl: statements that were not taken: rx, map_ka, haste"}));
    for (const char* tinted : {"Tf 1 0.5 1", "Tf spectral a.rfl", "Tf xyz 1 1 1"})
        EXPECT_EQ(parse(std::string("newmtl a\n") + tinted + "\n").warnings,
                  std::vector<std::string>{"m.mtl: statements that were not taken: tf"});
    std::string flood = "newmtl a\n";
    for (int i = 0; i < 1000; ++i) flood += "word" + std::to_string(i) + " 1\n";
    ASSERT_EQ(parse(flood).warnings.size(), 1u);
    EXPECT_LT(parse(flood).warnings[0].size(), 500u);
}

TEST(MtlFile, LibrariesAreFoundBesideTheObj) {
    const test::TempDir dir;
    test::write_text(dir / "my look.mtl", "newmtl red\nKd 1 0 0\nmap_Kd -s 2 2 red.png\n");
    test::write_text(dir / "blue.mtl", "newmtl blue\nKd 0 0 1\nmap_Kd blue.png\n");
    test::write_text(dir / "a.obj",
                     "mtllib my look.mtl\nmtllib blue.mtl gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                     "usemtl blue\nf 1 2 3\nusemtl red\nf 1 2 3\nusemtl green\nf 1 2 3\n");
    const auto scene = prep::load_obj(dir / "a.obj");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(test::broken_promise(*scene), "");
    ASSERT_EQ(scene->materials.size(), 3u);
    EXPECT_EQ(scene->materials[0].name, "red");
    EXPECT_EQ(scene->meshes[0].face_materials, (std::vector<std::uint32_t>{1, 0, 2}));
    const prep::Material& blue = scene->materials[1];
    EXPECT_EQ(scene->images[scene->textures[blue.diffuse_map.texture].image].name, "blue.png");
    EXPECT_NE(std::find(scene->warnings.begin(), scene->warnings.end(),
                        "material library 'gone.mtl' cannot be read: its materials get the default "
                        "look"),
              scene->warnings.end());
}

// As exporters write it that name the library with each object.
TEST(MtlFile, LibrariesNamedAgainAreReadOnce) {
    const test::TempDir dir;
    test::write_text(dir / "a.mtl", "newmtl red\nKd 1 0 0\nmap_Kd red.png\n");
    test::write_text(dir / "a.obj",
                     "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n"
                     "mtllib ./a.mtl\nusemtl red\nf 1 2 3\n");
    const auto scene = prep::load_obj(dir / "a.obj");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->materials.size(), 1u);
    EXPECT_EQ(scene->textures.size(), 1u);
    EXPECT_EQ(scene->images.size(), 1u);
    EXPECT_EQ(scene->libraries.size(), 1u);
    EXPECT_EQ(scene->meshes[0].face_materials, (std::vector<std::uint32_t>{0, 0}));
}

// Faces without a material are none of one that is called as they are.
TEST(MtlFile, NoMaterialIsNotTheOneCalledDefault) {
    const test::TempDir dir;
    test::write_text(dir / "a.mtl", "newmtl default\nKd 1 0 0\n");
    test::write_text(dir / "a.obj",
                     "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl default\nf 1 2 3\n");
    const auto scene = prep::load_obj(dir / "a.obj");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->meshes[0].face_materials, (std::vector<std::uint32_t>{prep::no_index, 0}));
    // Written with the face of the material first, so that the other needs a word of its own.
    prep::Scene turned = *scene;
    turned.meshes[0].face_materials = {0, prep::no_index};
    ASSERT_TRUE(prep::save_scene(test::untouched(turned), dir / "b.obj").has_value());
    const auto again = prep::load_obj(dir / "b.obj");
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    const std::uint32_t second = again->meshes[0].face_materials[1];
    EXPECT_TRUE(second >= again->materials.size() || again->materials[second].name != "default");
}

// Embedded pictures get the ending of what they are.
TEST(MtlFile, EmbeddedPicturesAreNamedByTheirKind) {
    const test::TempDir dir;
    for (const auto& [head, ending] :
         {std::pair<std::string, std::string>{std::string("RIFF\4\0\0\0WEBP", 12), ".webp"},
          {"\x89PNG\r\n\x1a\n", ".png"},
          {"\xff\xd8\xff\xe0", ".jpg"}}) {
        prep::Scene scene;
        scene.images.resize(1);
        const auto bytes = std::as_bytes(std::span(head));
        scene.images[0].bytes.assign(bytes.begin(), bytes.end());
        scene.textures.resize(1);
        scene.textures[0].image = 0;
        scene.materials.resize(1);
        scene.materials[0].name = "m";
        scene.materials[0].diffuse_map.texture = 0;
        scene.meshes.push_back(shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
        scene.meshes[0].face_materials = {0};
        prep::instance_unused_meshes(scene);
        ASSERT_TRUE(prep::save_scene(test::untouched(scene), dir / "a.obj").has_value());
        EXPECT_EQ(test::file_text(dir / ("a_image0" + ending)), head) << ending;
    }
}

TEST(MtlFile, WrittenMaterialsReadBack) {
    const test::TempDir dir;
    test::write_text(
        dir / "in.mtl",
        "newmtl a b\nKa 0.1 0.2 0.3\nKd 0.3 0.5 0.7\nKs 0.25 0.5 1\nKe 0 2 0\nNs 333\n"
        "d 0.125\nmap_Kd -s 2 3 1 -o 0.5 0.25 0 -clamp on tex 1.png\nnorm -bm 0.5 n.png\n"
        "newmtl flat\nKd 1 1 1\nillum 0\n");
    test::write_text(dir / "in.obj",
                     "mtllib in.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a b\nf 1 2 3\nusemtl "
                     "flat\nf 3 2 1\n");
    const auto first = prep::load_obj(dir / "in.obj");
    ASSERT_TRUE(first.has_value());
    const auto saved = prep::save_scene(test::untouched(*first), dir / "out.obj");
    ASSERT_TRUE(saved.has_value()) << prep::to_string(saved.error());
    const auto again = prep::load_obj(dir / "out.obj");
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    ASSERT_EQ(again->materials.size(), 2u);
    const prep::Material &m = first->materials[0], &n = again->materials[0];
    EXPECT_EQ(n.name, m.name);
    EXPECT_EQ(n.ambient, m.ambient);
    EXPECT_EQ(n.diffuse, m.diffuse);
    EXPECT_EQ(n.specular, m.specular);
    EXPECT_EQ(n.emissive, m.emissive);
    EXPECT_EQ(n.shininess, m.shininess);
    EXPECT_EQ(n.alpha_mode, m.alpha_mode);
    EXPECT_EQ(n.diffuse_map.scale, m.diffuse_map.scale);
    EXPECT_EQ(n.diffuse_map.offset, m.diffuse_map.offset);
    EXPECT_EQ(n.normal_map.strength, m.normal_map.strength);
    EXPECT_EQ(again->textures[n.diffuse_map.texture].wrap_u, prep::Wrap::clamp);
    EXPECT_EQ(again->textures[n.diffuse_map.texture].wrap_v, prep::Wrap::clamp);
    EXPECT_EQ(again->textures[n.normal_map.texture].wrap_u, prep::Wrap::repeat);
    EXPECT_EQ(again->images[again->textures[n.diffuse_map.texture].image].path,
              (dir / "tex 1.png").lexically_normal());
    EXPECT_TRUE(again->materials[1].unlit);
    EXPECT_EQ(again->meshes[0].face_materials, first->meshes[0].face_materials);
}

// A triangle with one material and one picture of 2 × 2 texels, all of a colour.
class OneMaterialMtl : public ::testing::Test {
  protected:
    OneMaterialMtl() {
        const prep::Image image{
            2, 2, 3, {0.25f, 0.75f, 1, 0.25f, 0.75f, 1, 0.25f, 0.75f, 1, 0.25f, 0.75f, 1}};
        scene_.images.resize(1);
        scene_.images[0].bytes = *prep::encode_png(image, prep::PixelType::u16);
        scene_.textures.resize(1);
        scene_.textures[0].image = 0;
        scene_.materials.resize(1);
        scene_.materials[0].name = "m";
        scene_.meshes.push_back(shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
        scene_.meshes[0].face_materials = {0};
        scene_.meshes[0].uvs.push_back({{{0, 0}, {1, 0}, {0, 1}}, {0, 1, 2}});
        prep::instance_unused_meshes(scene_);
    }
    prep::Material& material() { return scene_.materials[0]; }
    // As it is read again, with what the writer told.
    prep::Scene read_back(std::vector<std::string>& notes) {
        auto saved = prep::save_scene(test::untouched(scene_), dir_ / "a.obj");
        EXPECT_TRUE(saved.has_value());
        if (saved) notes = *std::move(saved);
        auto again = prep::load_obj(dir_ / "a.obj");
        EXPECT_TRUE(again.has_value());
        return again ? *std::move(again) : prep::Scene{};
    }
    test::TempDir dir_;
    prep::Scene scene_;
};

TEST_F(OneMaterialMtl, GreenThatPointsDownIsTurnedOver) {
    material().normal_map.texture = 0;
    material().normal_map_flip_green = true;
    std::vector<std::string> notes;
    const prep::Scene again = read_back(notes);
    const prep::Material& m = again.materials.at(0);
    ASSERT_TRUE(m.normal_map);
    EXPECT_FALSE(m.normal_map_flip_green);
    const auto image = prep::load_image(again.images[again.textures[m.normal_map.texture].image]);
    ASSERT_TRUE(image.has_value());
    for (std::size_t i = 0; i < image->pixels.size(); i += image->channels) {
        EXPECT_NEAR(image->pixels[i], 0.25, 1e-5);  // of 16 bits
        EXPECT_NEAR(image->pixels[i + 1], 0.25, 1e-5);
        EXPECT_NEAR(image->pixels[i + 2], 1, 1e-5);
    }
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("its green turned over"), std::string::npos) << notes[0];
}

TEST_F(OneMaterialMtl, ObjectSpaceNormalMapsAreLeftOut) {
    material().normal_map.texture = 0;
    material().normal_map_space = prep::NormalMapSpace::object;
    std::vector<std::string> notes;
    EXPECT_FALSE(read_back(notes).materials.at(0).normal_map);
    EXPECT_EQ(notes, std::vector<std::string>{"MTL has no object-space normal maps: left out"});
}

TEST_F(OneMaterialMtl, WhatIsBlackStaysBlack) {
    material().diffuse = {0, 0, 0, 1};
    material().diffuse_map.texture = 0;
    material().emissive_map.texture = 0;
    material().specular_map.texture = 0;
    std::vector<std::string> notes;
    const prep::Scene again = read_back(notes);
    const prep::Material& m = again.materials.at(0);
    EXPECT_TRUE(m.specular_map);
    EXPECT_TRUE(!m.diffuse_map || glm::vec3(m.diffuse) == glm::vec3(0));
    EXPECT_TRUE(!m.emissive_map || m.emissive == glm::vec3(0));
    EXPECT_EQ(notes.size(), 1u);
    material().diffuse = {0, 0.5f, 0, 1};
    EXPECT_TRUE(read_back(notes).materials.at(0).diffuse_map);
}

TEST_F(OneMaterialMtl, AnExponentOfZeroStays) {
    material().specular = glm::vec3(0.5f);
    material().shininess = 0;
    std::vector<std::string> notes;
    const prep::Scene again = read_back(notes);
    EXPECT_LT(again.materials.at(0).shininess, 0.001f);
    EXPECT_EQ(again.materials.at(0).specular, glm::vec3(0.5f));
    EXPECT_TRUE(again.warnings.empty()) << again.warnings.at(0);
}

TEST_F(OneMaterialMtl, PicturesOfNamesThatAStatementCannotHold) {
    scene_.images[0].bytes.clear();
    material().diffuse_map.texture = 0;
    std::vector<std::string> notes;
    for (const char* const name : {" t.png", "t.png ", "t.png\nnewmtl n"}) {
        test::write_text(dir_ / name, "x");
        scene_.images[0].path = dir_ / name;
        const prep::Scene again = read_back(notes);
        EXPECT_EQ(again.materials.size(), 1u) << name;
        EXPECT_TRUE(again.images.empty()) << name;
        EXPECT_EQ(notes.size(), 1u) << name;
    }
    test::write_text(dir_ / "-s 2 2 2.png", "x");
    scene_.images[0].path = dir_ / "-s 2 2 2.png";
    const prep::Scene again = read_back(notes);
    EXPECT_TRUE(notes.empty());
    ASSERT_EQ(again.images.size(), 1u);
    EXPECT_EQ(again.images[0].path.filename(), "-s 2 2 2.png");
    EXPECT_EQ(again.materials[0].diffuse_map.scale, glm::vec2(1));
}

// Of two sets an OBJ file has the one that a map reads which is seen.
TEST_F(OneMaterialMtl, UnseenMapsDoNotChooseTheUvs) {
    scene_.meshes[0].uvs.push_back({{{0, 0}, {0.5f, 0}, {0, 0.5f}}, {0, 1, 2}});
    material().diffuse = {0, 0, 0, 1};
    material().diffuse_map = {.texture = 0, .uv_set = 0};
    material().emissive = glm::vec3(1);
    material().emissive_map = {.texture = 0, .uv_set = 1};
    std::vector<std::string> notes;
    const prep::Scene again = read_back(notes);
    EXPECT_TRUE(again.materials.at(0).emissive_map);
    ASSERT_EQ(again.meshes.at(0).uvs.size(), 1u);
    EXPECT_EQ(again.meshes[0].uvs[0].values.at(1), glm::vec2(0.5f, 0));
    material().diffuse = glm::vec4(1);
    material().emissive = glm::vec3(0);
    std::swap(material().diffuse_map.uv_set, material().emissive_map.uv_set);
    EXPECT_TRUE(read_back(notes).materials.at(0).diffuse_map);
}

// With another set's UVs the map would be seen.
TEST_F(OneMaterialMtl, FacesWithoutTheSetThatAMapReadsHaveNoUvs) {
    material().diffuse_map = {.texture = 0, .uv_set = 1};
    std::vector<std::string> notes;
    EXPECT_TRUE(read_back(notes).meshes.at(0).uvs.empty());
    EXPECT_EQ(notes, std::vector<std::string>{"faces without the UV set that their material's "
                                              "maps read are written without UVs"});
    material().diffuse_map.uv_set = 0;
    EXPECT_EQ(read_back(notes).meshes.at(0).uvs.size(), 1u);
    // Where there are none at all, none are lost.
    scene_.meshes[0].uvs.clear();
    read_back(notes);
    EXPECT_TRUE(notes.empty());
}

TEST_F(OneMaterialMtl, BordersAroundTexturesAreToldInGltf) {
    material().diffuse_map.texture = 0;
    scene_.textures[0].wrap_v = prep::Wrap::border;
    const auto notes = prep::save_scene(test::untouched(scene_), dir_ / "a.glb");
    ASSERT_TRUE(notes.has_value());
    EXPECT_EQ(*notes, std::vector<std::string>{"glTF has no borders around textures: they are "
                                               "clamped to their edges instead"});
}

}  // namespace
