// What materials mean, from one format to another: docs/materials.md, row by row.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "formats/ply/ply.h"
#include "gltf_source.h"
#include "mesh_files.h"
#include "prep/image.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

// A triangle with UVs for each material, in their order.
std::string obj_of(const std::vector<std::string>& materials) {
    std::string text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
    for (const std::string& name : materials) text += "usemtl " + name + "\nf 1/1 2/2 3/3\n";
    return text;
}

class Folder {
  public:
    explicit Folder(const std::string& mtl, const std::vector<std::string>& names = {"m"}) {
        test::write_text(dir / "a.mtl", mtl);
        test::write_text(dir / "a.obj", obj_of(names));
    }
    prep::Scene load(const std::string& name, const prep::LoadOptions& options = {}) const {
        auto scene = prep::load_scene(dir / name, options);
        EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        return scene ? *std::move(scene) : prep::Scene{};
    }
    Words save(const prep::Scene& scene, const std::string& name) const {
        auto notes = prep::save_scene(test::untouched(scene), dir / name);
        EXPECT_TRUE(notes.has_value()) << prep::to_string(notes.error());
        return notes ? *notes : Words{};
    }
    prep::Scene through(const prep::Scene& scene, const std::string& name) const {
        save(scene, name);
        return load(name);
    }
    void picture(const std::string& name, std::vector<float> pixels, std::uint32_t channels,
                 std::uint32_t width = 1) const {
        prep::Image image;
        image.width = width;
        image.channels = channels;
        image.height = std::uint32_t(pixels.size()) / (width * channels);
        image.pixels = std::move(pixels);
        EXPECT_TRUE(prep::save_image(dir / name, image).has_value());
    }
    test::TempDir dir;
};

prep::Material mtl(const std::string& text) {
    const Folder folder("newmtl m\n" + text);
    const prep::Scene scene = folder.load("a.obj");
    EXPECT_EQ(scene.materials.size(), 1u);
    return scene.materials.at(0);
}

void expect_color(const glm::vec3& found, const glm::vec3& expected, float step) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], step) << k;
}

double spread(double n) {
    return (n + 2) / 8 + 1 / (2 * n + 4);
}

// --- highlights ----------------------------------------------------------------------------------

TEST(Highlights, ReflectanceIsTheInverseOfTheSpread) {
    // Ks = 1 and Ns = 32: 1 / (34/8 + 1/68)
    const prep::Dielectric d = prep::dielectric(glm::vec3(1.0f), 32);
    EXPECT_NEAR(double(d.reflectance.x), 0.234483, 1e-6);
    EXPECT_NEAR(double(d.roughness), std::pow(2.0 / 34, 0.25), 1e-6);
    for (const float n : {2.0f, 8.0f, 32.0f, 100.0f, 1000.0f, 4998.0f}) {
        const glm::vec3 specular(0.03f, 0.1f, 0.2f);
        const prep::Dielectric made = prep::dielectric(specular, n);
        const prep::BlinnPhong back =
            prep::blinn_phong(glm::vec3(0.5f), 0, made.roughness, made.reflectance);
        EXPECT_NEAR(double(back.shininess), double(n), 2e-5 * double(n) + 1e-5);
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(double(back.specular[k]), double(specular[k]), 2e-5) << n;
        EXPECT_EQ(back.diffuse, glm::vec3(0.5f));
    }
}

TEST(Highlights, ReflectanceIsNeverMoreThanAll) {
    EXPECT_EQ(prep::dielectric(glm::vec3(1.0f, 0.25f, -1.0f), 0).reflectance,
              glm::vec3(1.0f, 0.5f, 0.0f));
    EXPECT_EQ(prep::dielectric(glm::vec3(1.0f), -5).roughness, 1.0f);
}

TEST(Highlights, MtlBecomesSpecularOfThatReflectance) {
    const Folder folder(
        "newmtl a\nKd 0.5 0.5 0.5\nKs 1 0.5 0.25\nNs 32\nnewmtl b\nKs 0 0 0\nNs 10\n", {"a", "b"});
    folder.save(folder.load("a.obj"), "a.glb");
    const test::GltfFile file(folder.dir / "a.glb");
    const Json& a = file.json["materials"][0];
    const Json& factor = a["extensions"]["KHR_materials_specular"]["specularColorFactor"];
    const double expected[3] = {1, 0.5, 0.25};
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(factor[k].get<double>() * 0.04, expected[k] / spread(32), 1e-6);
    EXPECT_NEAR(a["pbrMetallicRoughness"]["roughnessFactor"].get<double>(),
                std::pow(2.0 / 34, 0.25), 1e-6);
    // What is said to be matte is.
    EXPECT_EQ(
        file.json["materials"][1]["extensions"]["KHR_materials_specular"]["specularColorFactor"],
        Json::array({0.0, 0.0, 0.0}));
}

// Wide bright highlights would leave nothing of the diffuse light in renderers of glTF.
TEST(Highlights, AWideOneLeavesTheDiffuseColour) {
    const Folder folder(
        "newmtl bright\nKd 0.9 0.2 0.2\nKs 1 0.5 1\nNs 4\nnewmtl dark\nKd 0.1 0 0\nKs 0.9 0.9 "
        "0.9\nNs 6\n",
        {"bright", "dark"});
    const prep::Scene scene = folder.load("a.obj");
    const Words notes = folder.save(scene, "a.glb");
    EXPECT_NE(std::find(notes.begin(), notes.end(),
                        "1 highlight reflects more than the diffuse colour leaves over: limited "
                        "for other programs, exact in extras"),
              notes.end());
    const test::GltfFile file(folder.dir / "a.glb");
    const auto reflected = [&](int m, int k) {
        return file.json["materials"][m]["extensions"]["KHR_materials_specular"]
                        ["specularColorFactor"][k]
                            .get<double>() *
               0.04;
    };
    EXPECT_NEAR(reflected(0, 0), 0.25, 1e-6);
    EXPECT_NEAR(reflected(0, 1), 0.125, 1e-6);  // its hue stays
    EXPECT_NEAR(reflected(1, 0), 0.9 / spread(6), 1e-6);
    const prep::Scene back = folder.load("a.glb");
    EXPECT_EQ(back.materials[0].specular, scene.materials[0].specular);
}

TEST(Highlights, WhatMtlDoesNotSayIsAnOrdinaryDielectric) {
    const prep::Material plain = mtl("Kd 1 0 0\n");
    EXPECT_EQ(plain.shininess, 32.0f);
    expect_color(plain.specular, glm::vec3(float(0.04 * spread(32))), 1e-6f);
    const prep::Material sharp = mtl("Ns 80\n");
    expect_color(sharp.specular, glm::vec3(float(0.04 * spread(80))), 1e-6f);
    EXPECT_EQ(mtl("Ns 1000\n").specular, glm::vec3(1.0f));  // as much as MTL can say
    EXPECT_EQ(mtl("Ks 0 0 0\nNs 80\n").specular, glm::vec3(0.0f));
    EXPECT_EQ(mtl("illum 1\n").specular, glm::vec3(0.0f));
    EXPECT_EQ(mtl("illum 1\nKs 1 1 1\n").specular, glm::vec3(0.0f));
    EXPECT_EQ(mtl("Ks 0.5\n").specular, glm::vec3(0.5f));
}

TEST(Highlights, AnExponentOfZeroIsNone) {
    const Folder folder("newmtl m\nKs 1 1 1\nNs 0\n");
    const prep::Scene scene = folder.load("a.obj");
    EXPECT_EQ(scene.materials[0].shininess, 32.0f);
    expect_color(scene.materials[0].specular, glm::vec3(float(0.04 * spread(32))), 1e-6f);
    EXPECT_EQ(
        scene.warnings,
        Words{"a.mtl: 1 material has Ks with Ns 0, which is no highlight: taken as not stated"});
    EXPECT_EQ(mtl("Ks 0 0 0\nNs 0\n").specular, glm::vec3(0.0f));
}

TEST(Highlights, BlackFactorsOfMapsCountAsWhite) {
    const Folder folder("newmtl m\nKd 0 0 0\nKe 0 0 0\nmap_Kd a.png\nmap_Ke a.png\n");
    folder.picture("a.png", {1, 0, 0}, 3);
    const prep::Material m = folder.load("a.obj").materials.at(0);
    EXPECT_EQ(m.diffuse, glm::vec4(1.0f));
    EXPECT_EQ(m.emissive, glm::vec3(1.0f));
    EXPECT_EQ(mtl("Kd 0 0 0\n").diffuse, glm::vec4(0, 0, 0, 1));
    // Of a picture that is not there nothing is seen: no glow in its place.
    EXPECT_EQ(mtl("Ke 0 0 0\nmap_Ke gone.png\n").emissive, glm::vec3(0));
    EXPECT_EQ(mtl("Pr 0\nmap_Pr gone.png\nmap_Pm gone2.png\n").metallic, 0.0f);
}

// A step of 1e-6 for what passes through JSON as it is, exact for what stands in extras.
TEST(RoundTrip, ObjGlbObjKeepsBlinnPhong) {
    const Folder folder(
        "newmtl a\nKa 0.1 0.2 0.3\nKd 0.3 0.5 0.7\nKs 0.25 0.5 1\nKe 0 2 0\nNs 333\nd 0.5\n"
        "newmtl b\nKd 0.9 0.8 0.7\nKs 1 1 1\nNs 4\nnewmtl c\nKd 0.2 0.2 0.2\nillum 0\n"
        "newmtl d\nKd 1 0 1\n",
        {"a", "b", "c", "d"});
    const prep::Scene first = folder.load("a.obj");
    const prep::Scene second = folder.through(folder.through(first, "b.glb"), "c.obj");
    ASSERT_EQ(second.materials.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
        const prep::Material &m = first.materials[i], &n = second.materials[i];
        EXPECT_EQ(n.name, m.name);
        EXPECT_EQ(n.unlit, m.unlit);
        EXPECT_EQ(n.diffuse, m.diffuse);
        EXPECT_EQ(n.alpha_mode, m.alpha_mode);
        expect_color(n.emissive, m.emissive, 1e-6f);
        if (m.unlit) continue;
        EXPECT_EQ(n.ambient, m.ambient);
        EXPECT_EQ(n.specular, m.specular);
        EXPECT_EQ(n.shininess, m.shininess);
        EXPECT_FALSE(n.metallic_roughness);
    }
}

// --- transparency --------------------------------------------------------------------------------
TEST(Transparency, AFileOfWhichNothingWouldBeSeenIsMadeOpaque) {
    for (const char* statement : {"Tr 1\n", "d 0\n"}) {
        const Folder folder(std::string("newmtl m\n") + statement + "newmtl n\n" + statement +
                                "newmtl unused\nd 1\n",
                            {"m", "n"});
        const prep::Scene scene = folder.load("a.obj");
        for (int m = 0; m < 2; ++m) {
            EXPECT_EQ(scene.materials[m].diffuse.a, 1.0f);
            EXPECT_EQ(scene.materials[m].alpha_mode, prep::AlphaMode::opaque);
        }
        EXPECT_EQ(
            scene.warnings,
            Words{"all 2 materials are wholly transparent (opacity 0, as \"Tr 1\" and \"d 0\" "
                  "say): made opaque; --transparency file keeps it"});
        prep::LoadOptions options;
        options.transparency = prep::Transparency::file;
        const prep::Scene kept = folder.load("a.obj", options);
        EXPECT_EQ(kept.materials[0].diffuse.a, 0.0f);
        EXPECT_EQ(kept.materials[0].alpha_mode, prep::AlphaMode::blend);
        EXPECT_EQ(kept.warnings,
                  Words{"all 2 materials are wholly transparent (opacity 0): nothing "
                        "of the model is seen where that is obeyed"});
    }
}

TEST(Transparency, MasksThatCutNothingHideNothing) {
    const test::TempDir dir;
    for (const double cutoff : {0.0, 0.5}) {
        test::GltfSource gltf;
        const Json clear = {{"baseColorFactor", {1, 1, 1, 0}}};
        gltf.json["materials"] = {
            {{"alphaMode", "MASK"}, {"alphaCutoff", cutoff}, {"pbrMetallicRoughness", clear}}};
        const auto at = gltf.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
        gltf.mesh({{{"attributes", {{"POSITION", at}}}, {"material", 0}}});
        gltf.write(dir / "a.gltf");
        EXPECT_EQ(prep::load_scene(dir / "a.gltf")->warnings.size(), cutoff > 0 ? 1u : 0u);
    }
}

TEST(Transparency, OneTransparentMaterialAmongOthersIsWhatItSays) {
    const Folder folder("newmtl m\nTr 1\nnewmtl n\nTr 0.5\n", {"m", "n"});
    const prep::Scene scene = folder.load("a.obj");
    EXPECT_EQ(scene.materials[0].diffuse.a, 0.0f);
    EXPECT_EQ(scene.materials[1].diffuse.a, 0.5f);
    EXPECT_EQ(scene.warnings, Words{});
}

TEST(Transparency, FuzeOfMeshLabIsSeen) {
    MESHPREP_REQUIRE_SHARED(shared);
    const std::filesystem::path file = shared / "real_files/fuze/fuze.obj";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no real_files in the shared data";
    const auto scene = prep::load_scene(file);
    ASSERT_TRUE(scene.has_value());
    ASSERT_EQ(scene->materials.size(), 1u);
    EXPECT_EQ(scene->materials[0].diffuse, glm::vec4(1.0f));
    EXPECT_EQ(scene->materials[0].alpha_mode, prep::AlphaMode::opaque);
    EXPECT_EQ(scene->warnings.size(), 2u);  // Tr 1; Ks 1 with Ns 0
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(test::untouched(*scene), dir / "a.glb").has_value());
    const test::GltfFile written(dir / "a.glb");
    const Json& m = written.json["materials"][0];
    EXPECT_FALSE(m.contains("alphaMode"));
    EXPECT_NEAR(m["extensions"]["KHR_materials_specular"]["specularColorFactor"][0].get<double>(),
                1.0, 1e-5);
    EXPECT_TRUE(m["pbrMetallicRoughness"].contains("baseColorTexture"));
}

// --- physically based MTL ------------------------------------------------------------------------

TEST(PhysicalMtl, StatementsAreRead) {
    const prep::Material m =
        mtl("Kd 0.8 0.6 0.2\nKs 0.5 0.5 0.5\nNs 100\nPr 0.25\nPm 0.75\nPs 0.1 0.2 0.3\nPc 0.5\nPcr "
            "0.125\naniso 0.375\nanisor 0.25\nKe 1 2 3\nNi 1.8\n");
    EXPECT_TRUE(m.metallic_roughness);
    EXPECT_EQ(m.diffuse, glm::vec4(0.8f, 0.6f, 0.2f, 1));
    EXPECT_EQ(m.roughness, 0.25f);
    EXPECT_EQ(m.metallic, 0.75f);
    EXPECT_EQ(m.sheen, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.clearcoat, 0.5f);
    EXPECT_EQ(m.clearcoat_roughness, 0.125f);
    EXPECT_EQ(m.anisotropy, 0.375f);
    EXPECT_NEAR(double(m.anisotropy_rotation), 1.5707963, 1e-6);  // a quarter of a turn
    EXPECT_EQ(m.emissive, glm::vec3(1, 2, 3));
    expect_color(m.reflectance, glm::vec3(float(0.8 * 0.8 / (2.8 * 2.8))), 1e-6f);
}

TEST(PhysicalMtl, DefaultsOfWhatIsNotSaid) {
    const prep::Material rough = mtl("Pr 0.3\nNi 1\n");
    EXPECT_TRUE(rough.metallic_roughness);
    EXPECT_EQ(rough.metallic, 0.0f);
    EXPECT_EQ(rough.reflectance, glm::vec3(0.04f));
    const prep::Material metal = mtl("Ns 30\nPm 1\n");
    EXPECT_NEAR(double(metal.roughness), 0.5, 1e-6);  // of the exponent
    EXPECT_EQ(mtl("Pr 7\n").roughness, 1.0f);
    EXPECT_FALSE(mtl("Pc 0.5\nNi 1.4\n").metallic_roughness);
}

TEST(PhysicalMtl, TwoGreyPicturesAreOneInGltf) {
    const Folder folder("newmtl m\nPr 1\nmap_Pr rough.png\nmap_Pm metal.png\n");
    folder.picture("rough.png", {51 / 255.0f, 102 / 255.0f}, 1, 2);           // 2 × 1
    folder.picture("metal.png", {1, 1, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0}, 3, 2);  // 2 × 2
    const prep::Scene scene = folder.load("a.obj");
    EXPECT_EQ(scene.warnings, Words{});
    const prep::Material& m = scene.materials.at(0);
    EXPECT_EQ(m.metallic, 1.0f);
    EXPECT_EQ(m.roughness, 1.0f);
    const auto picture = prep::load_image(
        scene.images.at(scene.textures.at(m.metallic_roughness_map.texture).image));
    ASSERT_TRUE(picture.has_value());
    ASSERT_EQ(picture->width * picture->height * picture->channels, 2u * 2 * 3);
    for (std::uint32_t y = 0; y < 2; ++y)
        for (std::uint32_t x = 0; x < 2; ++x) {
            EXPECT_NEAR(picture->at(x, y)[1], x == 0 ? 51 / 255.0f : 102 / 255.0f, 1e-6f);
            EXPECT_NEAR(picture->at(x, y)[2], x == 0 ? 1.0f : 0.0f, 1e-6f);
        }
    const Words notes = folder.save(scene, "a.glb");
    EXPECT_NE(std::find(notes.begin(), notes.end(),
                        "texture 'rough.png + metal.png' was put together as PNG"),
              notes.end());
    const test::GltfFile file(folder.dir / "a.glb");
    ASSERT_TRUE(
        file.json["materials"][0]["pbrMetallicRoughness"].contains("metallicRoughnessTexture"));
    // And apart again.
    const prep::Scene back = folder.through(folder.load("a.glb"), "b.obj");
    const prep::Material& n = back.materials.at(0);
    const auto again =
        prep::load_image(back.images.at(back.textures.at(n.metallic_roughness_map.texture).image));
    ASSERT_TRUE(again.has_value());
    ASSERT_EQ(again->pixels.size(), picture->pixels.size());
    for (std::size_t i = 0; i < picture->pixels.size(); ++i)
        if (i % 3 != 0) {
            EXPECT_NEAR(again->pixels[i], picture->pixels[i], 1e-6f) << i;
        }
    const std::string text = test::file_text(folder.dir / "b.mtl");
    EXPECT_NE(text.find("map_Pr b_image0_roughness.png"), std::string::npos) << text;
    EXPECT_NE(text.find("map_Pm b_image0_metallic.png"), std::string::npos) << text;
}

TEST(PhysicalMtl, OnePictureAloneLeavesTheOtherQuantity) {
    const Folder folder("newmtl m\nPm 1\nmap_Pr rough.png\n");
    folder.picture("rough.png", {0.2f}, 1);
    const prep::Scene scene = folder.load("a.obj");
    const prep::Material& m = scene.materials.at(0);
    const auto picture = prep::load_image(
        scene.images.at(scene.textures.at(m.metallic_roughness_map.texture).image));
    ASSERT_TRUE(picture.has_value());
    EXPECT_NEAR(picture->at(0, 0)[1], 0.2f, 1e-6f);
    EXPECT_EQ(picture->at(0, 0)[2], 1.0f);
}

TEST(PhysicalMtl, TheSamePictureForBothIsPackedAlready) {
    const Folder folder("newmtl m\nmap_Pr both.png\nmap_Pm both.png\n");
    folder.picture("both.png", {0, 0.4f, 0.8f}, 3);
    const prep::Scene scene = folder.load("a.obj");
    EXPECT_EQ(scene.images.size(), 1u);
    EXPECT_TRUE(scene.images[0].channels.empty());
    EXPECT_EQ(scene.materials[0].metallic_roughness_map.texture, 0u);
}

TEST(PhysicalMtl, MaterialsOfTheSamePicturesShareWhatIsMadeOfThem) {
    const Folder folder(
        "newmtl m\nmap_Pr a.png\nmap_Pm b.png\nnewmtl n\nmap_Pr a.png\nmap_Pm b.png\n"
        "newmtl o\nmap_Pr b.png\nmap_Pm a.png\n",
        {"m", "n", "o"});
    for (const char* name : {"a.png", "b.png"}) folder.picture(name, {0.2f}, 1);
    const prep::Scene scene = folder.load("a.obj");
    EXPECT_EQ(scene.materials[0].metallic_roughness_map.texture,
              scene.materials[1].metallic_roughness_map.texture);
    EXPECT_NE(scene.materials[0].metallic_roughness_map.texture,
              scene.materials[2].metallic_roughness_map.texture);
    EXPECT_EQ(scene.images.size(), 4u);
}

TEST(PhysicalMtl, OpacityPicturesBecomeTheColoursAlpha) {
    const Folder folder("newmtl m\nmap_Kd color.png\nmap_d alpha.png\n");
    folder.picture("color.png", {1, 0.2f, 0}, 3);
    folder.picture("alpha.png", {0.6f}, 1);
    const prep::Scene scene = folder.load("a.obj");
    const prep::Material& m = scene.materials.at(0);
    EXPECT_EQ(m.alpha_mode, prep::AlphaMode::blend);
    const auto picture =
        prep::load_image(scene.images.at(scene.textures.at(m.diffuse_map.texture).image));
    ASSERT_TRUE(picture.has_value());
    ASSERT_EQ(picture->channels, 4u);
    const float expected[4] = {1, 0.2f, 0, 0.6f};
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(picture->at(0, 0)[k], expected[k], 1e-6f);
    // The two files are named again.
    folder.save(scene, "b.obj");
    const std::string text = test::file_text(folder.dir / "b.mtl");
    EXPECT_NE(text.find("map_Kd color.png"), std::string::npos) << text;
    EXPECT_NE(text.find("map_d alpha.png"), std::string::npos) << text;
}

// A step of 1e-6: reflectances pass through a factor of 25 and an index of refraction, rotations
// through turns.
TEST(RoundTrip, ObjGlbObjKeepsPhysicalMaterials) {
    const Folder folder(
        "newmtl a\nKd 0.8 0.6 0.2\nPr 0.25\nPm 1\nPs 0.1 0.2 0.3\nPc 0.5\nPcr 0.125\naniso "
        "0.375\nanisor 0.1\nKe 1 2 3\nnewmtl b\nKd 0.1 0.2 0.3\nPr 0.7\nPm 0\nNi 1.33\nd 0.25\n",
        {"a", "b"});
    const prep::Scene first = folder.load("a.obj");
    const prep::Scene second = folder.through(folder.through(first, "b.glb"), "c.obj");
    ASSERT_EQ(second.materials.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const prep::Material &m = first.materials[i], &n = second.materials[i];
        EXPECT_TRUE(n.metallic_roughness);
        EXPECT_EQ(n.diffuse, m.diffuse);
        EXPECT_EQ(n.metallic, m.metallic);
        EXPECT_EQ(n.roughness, m.roughness);
        EXPECT_EQ(n.clearcoat, m.clearcoat);
        EXPECT_EQ(n.clearcoat_roughness, m.clearcoat_roughness);
        EXPECT_EQ(n.sheen, m.sheen);
        EXPECT_EQ(n.anisotropy, m.anisotropy);
        EXPECT_NEAR(n.anisotropy_rotation, m.anisotropy_rotation, 1e-6f);
        expect_color(n.reflectance, m.reflectance, 1e-6f);
        expect_color(n.emissive, m.emissive, 1e-6f);
    }
}

TEST(GltfReflectance, ComesFromIorAndSpecular) {
    const test::TempDir dir;
    test::write_text(dir / "a.gltf", R"({"asset": {"version": "2.0"}, "materials": [
        {"extensions": {"KHR_materials_ior": {"ior": 1.8}}},
        {"extensions": {"KHR_materials_specular": {"specularFactor": 0.5,
                                                   "specularColorFactor": [2, 1, 0]}}},
        {"extensions": {"KHR_materials_ior": {"ior": 0},
                        "KHR_materials_specular": {"specularFactor": 0.25}}},
        {"extensions": {"KHR_materials_specular": {}, "KHR_materials_ior": {"ior": 1.5}}}]})");
    const auto scene = prep::load_scene(dir / "a.gltf");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    expect_color(scene->materials[0].reflectance, glm::vec3(float(0.64 / 7.84)), 1e-6f);
    expect_color(scene->materials[1].reflectance, glm::vec3(0.04f, 0.02f, 0), 1e-7f);
    expect_color(scene->materials[2].reflectance, glm::vec3(0.25f), 1e-7f);
    EXPECT_EQ(scene->materials[3].reflectance, glm::vec3(0.04f));
}

// --- FBX -----------------------------------------------------------------------------------------

TEST(FbxMaterials, MaxPbrMaterialMetalRough) {
    MESHPREP_REQUIRE_SHARED(shared);
    const std::filesystem::path file = shared / "real_files/maxPbrMaterial_metalRough.fbx";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no real_files in the shared data";
    const auto missing = prep::load_scene(file);
    ASSERT_TRUE(missing.has_value()) << prep::to_string(missing.error());
    Words warnings = missing->warnings;
    warnings.erase(
        std::remove_if(warnings.begin(), warnings.end(),
                       [](const std::string& w) { return !w.starts_with("7 pictures"); }),
        warnings.end());
    EXPECT_EQ(warnings.size(), 1u);
    const prep::Material& m = missing->materials.at(0);
    EXPECT_TRUE(m.metallic_roughness);
    EXPECT_TRUE(m.diffuse_map && m.metallic_roughness_map && m.normal_map && m.emissive_map &&
                m.occlusion_map);
    EXPECT_EQ(m.normal_map.strength, 0.75f);
    // Without its pictures the material has its values.
    EXPECT_EQ(m.diffuse, glm::vec4(0, 1, 1, 1));
    EXPECT_EQ(m.emissive, glm::vec3(0));  // (1, 1, 0), by a picture that is not there
    EXPECT_EQ(m.metallic, 0.25f);
    EXPECT_EQ(m.roughness, 0.5f);
    EXPECT_EQ(m.alpha_mode, prep::AlphaMode::opaque);  // the opacity picture is not there

    // With the pictures there, under another case, in a directory of the user's.
    const Folder pictures("");
    const std::pair<const char*, float> values[] = {
        {"Metalness", 0.2f}, {"Roughness", 0.6f}, {"Occlusion", 0.4f}, {"Opacity", 0.8f}};
    for (const auto& [name, value] : values)
        pictures.picture(std::string(name) + ".png", {value}, 1);
    for (const char* name : {"albedo.png", "normal.png", "emission.png"})
        pictures.picture(name, {0.2f, 0.4f, 0.6f}, 3);
    prep::LoadOptions options;
    options.texture_directories.push_back(pictures.dir.path());
    const auto scene = prep::load_scene(file, options);
    ASSERT_TRUE(scene.has_value());
    for (const std::string& warning : scene->warnings)
        EXPECT_EQ(warning.find("not found"), std::string::npos) << warning;
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(test::untouched(*scene), dir / "a.glb").has_value());
    const auto back = prep::load_scene(dir / "a.glb");
    ASSERT_TRUE(back.has_value());
    const prep::Material& n = back->materials.at(0);
    EXPECT_EQ(n.alpha_mode, prep::AlphaMode::blend);
    const auto texel = [&](const prep::TextureRef& ref) {
        const auto image = prep::load_image(back->images.at(back->textures.at(ref.texture).image));
        EXPECT_TRUE(image.has_value());
        return image ? image->pixels : std::vector<float>(4);
    };
    EXPECT_NEAR(texel(n.metallic_roughness_map).at(1), 0.6f, 1e-6f);
    EXPECT_NEAR(texel(n.metallic_roughness_map).at(2), 0.2f, 1e-6f);
    EXPECT_NEAR(texel(n.diffuse_map).at(3), 0.8f, 1e-6f);
    EXPECT_NEAR(texel(n.diffuse_map).at(1), 0.4f, 1e-6f);
    EXPECT_NEAR(texel(n.occlusion_map).at(0), 0.4f, 1e-6f);
}

// FBX gives a specular colour and its multiplier: 0.25 0.25 0.5 and 0.5, exponent 10.
TEST(FbxMaterials, PhongCubeComesBackFromGlb) {
    MESHPREP_REQUIRE_SHARED(shared);
    const std::filesystem::path file = shared / "real_files/phong_cube.fbx";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no real_files in the shared data";
    const auto scene = prep::load_scene(file);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const prep::Material& m = scene->materials.at(0);
    EXPECT_EQ(m.specular, glm::vec3(0.125f, 0.125f, 0.25f));
    EXPECT_EQ(m.shininess, 10.0f);
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(test::untouched(*scene), dir / "a.glb").has_value());
    const test::GltfFile written(dir / "a.glb");
    const Json& material = written.json["materials"][0];
    const Json& factor = material["extensions"]["KHR_materials_specular"]["specularColorFactor"];
    const double expected[3] = {0.125, 0.125, 0.25};
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(factor[k].get<double>() * 0.04, expected[k] / spread(10), 1e-6);
    EXPECT_NEAR(material["pbrMetallicRoughness"]["roughnessFactor"].get<double>(),
                std::pow(2.0 / 12, 0.25), 1e-6);
    const auto back = prep::load_scene(dir / "a.glb");
    ASSERT_TRUE(back.has_value());
    EXPECT_EQ(back->materials[0].specular, m.specular);
    EXPECT_EQ(back->materials[0].shininess, m.shininess);
    EXPECT_EQ(back->materials[0].diffuse, m.diffuse);
    EXPECT_EQ(back->materials[0].emissive, m.emissive);
}

// --- PLY -----------------------------------------------------------------------------------------

std::string ply(const std::string& comments, const std::string& face_properties,
                const std::string& faces, const std::string& vertex_properties = "",
                const std::string& after = "") {
    return "ply\nformat ascii 1.0\n" + comments +
           "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
           vertex_properties + "element face 2\nproperty list uchar int vertex_indices\n" +
           face_properties + "end_header\n0 0 0" + after + "\n1 0 0" + after + "\n0 1 0" + after +
           "\n" + faces;
}

TEST(PlyTextures, FacesNameTheirPictureOrNone) {
    const test::TempDir dir;
    const std::string header = "comment TextureFile a b.png \ncomment TextureFile c.png\n";
    const std::string uv = " 6 0 0 1 0 0 1";
    test::write_text(dir / "a.ply",
                     ply(header, "property list uchar float texcoord\nproperty int texnumber\n",
                         "3 0 1 2" + uv + " 1\n3 2 1 0" + uv + " -1\n"));
    const auto scene = prep::load_scene(dir / "a.ply");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->materials.size(), 3u);
    EXPECT_EQ(scene->meshes[0].face_materials, (std::vector<std::uint32_t>{1, 2}));
    EXPECT_EQ(scene->images[0].name, "a b.png");
    EXPECT_EQ(scene->images[1].path, dir / "c.png");
    EXPECT_EQ(scene->materials[1].diffuse, glm::vec4(1.0f));
    EXPECT_EQ(scene->materials[1].diffuse_map.texture, 1u);
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_TRUE(scene->warnings[0].starts_with("2 pictures were not found: a b.png, c.png"));
}

TEST(PlyTextures, UvsOfVerticesDoAsWell) {
    const test::TempDir dir;
    test::write_text(dir / "a.ply", ply("comment TextureFile a.png\n", "", "3 0 1 2\n3 2 1 0\n",
                                        "property float s\nproperty float t\n", " 0.5 0.25"));
    const auto scene = prep::load_scene(dir / "a.ply");
    ASSERT_TRUE(scene.has_value());
    ASSERT_EQ(scene->materials.size(), 1u);
    EXPECT_EQ(scene->meshes[0].face_materials, (std::vector<std::uint32_t>{0, 0}));
}

TEST(PlyTextures, WithoutUvsThereIsNoMaterialButAWord) {
    const test::TempDir dir;
    test::write_text(dir / "a.ply", ply("comment TextureFile a.png\n", "", "3 0 1 2\n3 2 1 0\n"));
    const auto scene = prep::load_scene(dir / "a.ply");
    ASSERT_TRUE(scene.has_value());
    EXPECT_TRUE(scene->materials.empty());
    EXPECT_TRUE(scene->meshes[0].face_materials.empty());
    EXPECT_EQ(scene->warnings, Words{"a.ply: a TextureFile without UVs was not taken"});
}

TEST(PlyTextures, FuzeIsTexturedInBothForms) {
    MESHPREP_REQUIRE_SHARED(shared);
    for (const char* name : {"fuze.ply", "fuze_ascii.ply"}) {
        const std::filesystem::path file = shared / "real_files/fuze" / name;
        if (!std::filesystem::exists(file)) GTEST_SKIP() << "no real_files in the shared data";
        const auto scene = prep::load_scene(file);
        ASSERT_TRUE(scene.has_value());
        ASSERT_EQ(scene->images.size(), 1u);
        EXPECT_TRUE(prep::load_image(scene->images[0]).has_value());
        EXPECT_EQ(scene->meshes[0].face_materials, std::vector<std::uint32_t>(1000, 0));
        const test::TempDir dir;
        ASSERT_TRUE(prep::save_scene(test::untouched(*scene), dir / "a.glb").has_value());
        const test::GltfFile written(dir / "a.glb");
        EXPECT_EQ(written.json["images"].size(), 1u);
        EXPECT_TRUE(
            written.json["materials"][0]["pbrMetallicRoughness"].contains("baseColorTexture"));
    }
}

}  // namespace
