// glTF materials, textures, samplers and images by value: every factor, every reference, each with
// numbers of its own, so that none can stand for another.
#include <gtest/gtest.h>

#include <cmath>

#include "gltf_maker.h"
#include "mesh_files.h"

namespace {

using Json = test::GltfMaker::Json;
using test::GltfMaker;

// A document of seven textures, texture t showing image 6 − t.
GltfMaker with_textures() {
    GltfMaker maker;
    for (int i = 0; i < 7; ++i) {
        maker.push("images", {{"uri", "data:image/png;base64,iVBORw0K"}});
        maker.push("textures", {{"source", 6 - i}});
    }
    return maker;
}

prep::Scene read(const GltfMaker& maker) {
    auto scene = maker.read();
    EXPECT_TRUE(scene) << test::error_of(scene);
    return scene ? *std::move(scene) : prep::Scene();
}

prep::Material material(const Json& json) {
    GltfMaker maker = with_textures();
    maker.push("materials", json);
    prep::Scene scene = read(maker);
    return scene.materials.empty() ? prep::Material() : scene.materials[0];
}

std::string error(const Json& json) {
    GltfMaker maker = with_textures();
    maker.push("materials", json);
    return test::error_of(maker.read());
}

void expect_map(const prep::TextureRef& map, std::uint32_t texture, std::uint32_t set,
                float strength, const char* name) {
    EXPECT_EQ(map.texture, texture) << name;
    EXPECT_EQ(map.uv_set, set) << name;
    EXPECT_EQ(map.strength, strength) << name;
}

TEST(GltfMaterials, DefaultsAreThoseOfTheSpecification) {
    const prep::Material m = material(Json::object());
    EXPECT_TRUE(m.metallic_roughness);
    EXPECT_EQ(m.diffuse, glm::vec4(1));
    EXPECT_EQ(m.metallic, 1);
    EXPECT_EQ(m.roughness, 1);
    EXPECT_EQ(m.emissive, glm::vec3(0));
    EXPECT_EQ(m.alpha_mode, prep::AlphaMode::opaque);
    EXPECT_EQ(m.alpha_cutoff, 0.5f);
    EXPECT_FALSE(m.double_sided);
    EXPECT_FALSE(m.unlit);
    for (const prep::TextureRef* map : {&m.diffuse_map, &m.metallic_roughness_map, &m.normal_map,
                                        &m.occlusion_map, &m.emissive_map, &m.specular_map})
        EXPECT_FALSE(*map);
}

// Of whatever extension: the first says which UVs tangents follow.
TEST(GltfMaterials, NormalMapsAndAnisotropyOfExtensionsAreKnown) {
    prep::Material m = material(Json::parse(R"({"extensions": {
        "KHR_materials_clearcoat": {"clearcoatTexture": {"index": 1},
            "clearcoatNormalTexture": {"index": 2, "texCoord": 1, "scale": 0.5}},
        "VENDOR_detail": {"detailNormalTexture": {"index": 6}},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.25,
            "anisotropyTexture": {"index": 3, "texCoord": 2}}}})"));
    expect_map(m.layer_normal_map, 2, 1, 0.5f, "clearcoat");
    expect_map(m.anisotropy_map, 3, 2, 1, "anisotropy");
    EXPECT_EQ(m.anisotropy, 0.25f);
    EXPECT_FALSE(m.normal_map);
    m = material(Json::parse(R"({"extensions": {"KHR_materials_anisotropy":
        {"anisotropyTexture": {"index": 3}}, "VENDOR_detail": {"normalTexture": {"index": 6}}}})"));
    EXPECT_FALSE(m.anisotropy_map) << "of strength 0";
    EXPECT_EQ(m.layer_normal_map.texture, 6u);
    EXPECT_NE(error(Json::parse(R"({"extensions": {"KHR_materials_clearcoat":
        {"clearcoatNormalTexture": {"index": 99}}}})")),
              "no error");
}

TEST(GltfMaterials, EveryFactorAndEveryMapIsItsOwn) {
    const prep::Material m = material(Json::parse(R"({
        "name": "all",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.6, "roughnessFactor": 0.7,
            "baseColorTexture": {"index": 1},
            "metallicRoughnessTexture": {"index": 2, "texCoord": 1}},
        "normalTexture": {"index": 3, "texCoord": 2, "scale": 0.25},
        "occlusionTexture": {"index": 4, "texCoord": 3, "strength": 0.75},
        "emissiveTexture": {"index": 5, "texCoord": 4},
        "emissiveFactor": [0.5, 0.6, 0.8],
        "alphaMode": "MASK", "alphaCutoff": 0.3125, "doubleSided": true})"));
    EXPECT_EQ(m.name, "all");
    EXPECT_EQ(m.diffuse, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_EQ(m.metallic, 0.6f);
    EXPECT_EQ(m.roughness, 0.7f);
    EXPECT_EQ(m.emissive, glm::vec3(0.5f, 0.6f, 0.8f));
    EXPECT_EQ(m.alpha_mode, prep::AlphaMode::mask);
    EXPECT_EQ(m.alpha_cutoff, 0.3125f);
    EXPECT_TRUE(m.double_sided);
    expect_map(m.diffuse_map, 1, 0, 1, "base colour");
    expect_map(m.metallic_roughness_map, 2, 1, 1, "metallic-roughness");
    expect_map(m.normal_map, 3, 2, 0.25f, "normal");
    expect_map(m.occlusion_map, 4, 3, 0.75f, "occlusion");
    expect_map(m.emissive_map, 5, 4, 1, "emissive");
}

TEST(GltfMaterials, AlphaModesAreTold) {
    EXPECT_EQ(material({{"alphaMode", "OPAQUE"}}).alpha_mode, prep::AlphaMode::opaque);
    EXPECT_EQ(material({{"alphaMode", "MASK"}}).alpha_mode, prep::AlphaMode::mask);
    EXPECT_EQ(material({{"alphaMode", "BLEND"}}).alpha_mode, prep::AlphaMode::blend);
    EXPECT_NE(error({{"alphaMode", "mask"}}).find("/materials/0/alphaMode"), std::string::npos);
}

TEST(GltfMaterials, TextureTransformsMoveTurnScaleAndChooseTheSet) {
    const prep::Material m = material(Json::parse(R"({
        "normalTexture": {"index": 0, "texCoord": 1, "scale": 2, "extensions": {
            "KHR_texture_transform": {"offset": [0.25, -0.5], "rotation": 0.7, "scale": [3, -4],
                                      "texCoord": 5}}},
        "occlusionTexture": {"index": 1, "texCoord": 6, "extensions": {
            "KHR_texture_transform": {"rotation": -1.5}}},
        "emissiveTexture": {"index": 2, "texCoord": 3, "extensions": {
            "KHR_texture_transform": {"texCoord": 0}}}})"));
    EXPECT_EQ(m.normal_map.offset, glm::vec2(0.25f, -0.5f));
    EXPECT_EQ(m.normal_map.scale, glm::vec2(3, -4));
    EXPECT_EQ(m.normal_map.rotation, 0.7f);
    expect_map(m.normal_map, 0, 5, 2, "all of it");
    EXPECT_EQ(m.occlusion_map.offset, glm::vec2(0));
    EXPECT_EQ(m.occlusion_map.scale, glm::vec2(1));
    EXPECT_EQ(m.occlusion_map.rotation, -1.5f);
    expect_map(m.occlusion_map, 1, 6, 1, "its own set where the transform names none");
    expect_map(m.emissive_map, 2, 0, 1, "set 0, said by the transform");
}

TEST(GltfMaterials, EmissiveStrengthMultipliesAndUnlitIsTold) {
    const prep::Material m = material(Json::parse(R"({
        "emissiveFactor": [0.5, 0.25, 1],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 6},
                       "KHR_materials_unlit": {}}})"));
    EXPECT_EQ(m.emissive, glm::vec3(3, 1.5f, 6));
    EXPECT_TRUE(m.unlit);
}

// The extension's README: F0 is the specular colour, what scatters is diffuse · (1 − max(F0)), and
// α = (1 − glossiness)²: a metallic-roughness material of no metal.
TEST(GltfMaterials, SpecularGlossinessTakesThePlaceOfMetallicRoughness) {
    const prep::Material m = material(Json::parse(R"({
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 0],
                                 "baseColorTexture": {"index": 4},
                                 "metallicRoughnessTexture": {"index": 2}},
        "extensions": {"KHR_materials_ior": {"ior": 2},
                       "KHR_materials_pbrSpecularGlossiness": {
            "diffuseFactor": [0.1, 0.2, 0.3, 0.4], "specularFactor": [0.5, 0.6, 0.7],
            "glossinessFactor": 0.75,
            "diffuseTexture": {"index": 1, "texCoord": 2},
            "specularGlossinessTexture": {"index": 3, "texCoord": 1}}}})"));
    EXPECT_TRUE(m.metallic_roughness);
    EXPECT_EQ(m.metallic, 0);
    EXPECT_FALSE(m.metallic_roughness_map);
    EXPECT_EQ(m.diffuse, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f)) << "a map says what is left";
    EXPECT_EQ(m.reflectance, glm::vec3(0.5f, 0.6f, 0.7f));
    expect_map(m.diffuse_map, 1, 2, 1, "diffuse");
    expect_map(m.specular_map, 3, 1, 1, "specular");
    EXPECT_EQ(m.roughness, 0.25f);
}

TEST(GltfMaterials, OfSpecularGlossinessWhatIsReflectedIsNotScattered) {
    Json json = Json::parse(R"({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.1, 0.2, 0.3, 0.4], "specularFactor": [0.5, 0.6, 0.7]}}})");
    const glm::vec4 scattered(0.03f, 0.06f, 0.09f, 0.4f);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(material(json).diffuse[k], scattered[k], 1e-7) << k;
    json["extensions"]["KHR_materials_unlit"] = Json::object();
    EXPECT_EQ(material(json).diffuse, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
}

TEST(GltfMaterials, SpecularGlossinessWithoutItsMembersIsWhiteSmoothAndWithoutMaps) {
    const prep::Material m = material(Json::parse(R"({
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 0],
                                 "baseColorTexture": {"index": 4}},
        "extensions": {"KHR_materials_pbrSpecularGlossiness": {}}})"));
    EXPECT_EQ(m.diffuse, glm::vec4(0, 0, 0, 1)) << "a mirror scatters nothing";
    EXPECT_EQ(m.reflectance, glm::vec3(1));
    EXPECT_FALSE(m.diffuse_map);
    EXPECT_FALSE(m.specular_map);
    EXPECT_EQ(m.roughness, 0);
    EXPECT_EQ(material(Json::parse(R"({"extensions": {"KHR_materials_pbrSpecularGlossiness":
                                       {"glossinessFactor": 0}}})"))
                  .roughness,
              1);
}

TEST(GltfMaterials, OurOwnFilesSayTheBlinnPhongMaterialExactly) {
    const prep::Material m = material(Json::parse(R"({
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 0], "metallicFactor": 0},
        "extensions": {"KHR_materials_specular": {"specularColorTexture":
                                                  {"index": 6, "texCoord": 2}}},
        "extras": {"blinnPhong": {"ambient": [0.1, 0.2, 0.3], "diffuse": [0.4, 0.5, 0.6, 0.7],
                                  "specular": [0.8, 0.9, 0.25], "shininess": 123}}})"));
    EXPECT_FALSE(m.metallic_roughness);
    EXPECT_EQ(m.ambient, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.diffuse, glm::vec4(0.4f, 0.5f, 0.6f, 0.7f));
    EXPECT_EQ(m.specular, glm::vec3(0.8f, 0.9f, 0.25f));
    EXPECT_EQ(m.shininess, 123);
    expect_map(m.specular_map, 6, 2, 1, "specular");
}

TEST(GltfMaterials, DisplacementStandsInExtras) {
    const prep::Material m = material(Json::parse(R"({"extras": {"displacement": {
        "texture": {"index": 3, "texCoord": 1}, "scale": 0.5, "midlevel": 0.25,
        "kind": "vector-tangent"}}})"));
    expect_map(m.displacement_map, 3, 1, 1, "displacement");
    EXPECT_EQ(m.displacement_scale, 0.5f);
    EXPECT_EQ(m.displacement_midlevel, 0.25f);
    EXPECT_EQ(m.displacement_kind, prep::DisplacementKind::vector_tangent);
    const prep::Material plain = material(Json::parse(R"({"extras": {"displacement":
                                                          {"texture": 4}}})"));
    expect_map(plain.displacement_map, 4, 0, 1, "displacement");
    EXPECT_EQ(plain.displacement_scale, 1.0f);
    EXPECT_EQ(plain.displacement_midlevel, 0.5f);
}

// Extras are free: a displacement that is not as ours is no fault of the file.
TEST(GltfMaterials, DisplacementOfOthersInExtrasIsToldAndLeftOut) {
    for (const char* text : {R"("rough")", R"({})", R"({"texture": 7})", R"({"texture": "a"})",
                             R"({"texture": 0, "scale": "1"})", R"({"texture": 0, "kind": 3})",
                             R"({"texture": 0, "kind": "bump"})", R"([0])"}) {
        GltfMaker maker = with_textures();
        maker.push("materials", {{"extras", {{"displacement", Json::parse(text)}}}});
        const prep::Scene scene = read(maker);
        ASSERT_EQ(scene.materials.size(), 1u) << text;
        EXPECT_FALSE(scene.materials[0].displacement_map) << text;
        ASSERT_EQ(scene.warnings.size(), 1u) << text;
        EXPECT_NE(scene.warnings[0].find("#/materials/0/extras/displacement"), std::string::npos)
            << scene.warnings[0];
    }
}

TEST(GltfMaterials, WhatIsNoTextureOrNoNumberIsRefusedAtItsPlace) {
    const auto refused = [](const char* text, const std::string& place) {
        const std::string found = error(Json::parse(text));
        EXPECT_NE(found.find("#/materials/0/" + place), std::string::npos) << found;
    };
    refused(R"({"normalTexture": {"index": 7}})", "normalTexture/index");
    refused(R"({"normalTexture": {"scale": 1}})", "normalTexture/index");
    refused(R"({"normalTexture": {"index": 0, "scale": "1"}})", "normalTexture/scale");
    refused(R"({"normalTexture": {"index": 0, "texCoord": -1}})", "normalTexture/texCoord");
    refused(R"({"normalTexture": {"index": 0, "texCoord": 1.5}})", "normalTexture/texCoord");
    refused(R"({"emissiveFactor": [1, 2]})", "emissiveFactor");
    refused(R"({"emissiveFactor": [1, 2, null]})", "emissiveFactor/2");
    refused(R"({"doubleSided": 1})", "doubleSided");
    EXPECT_EQ(error(Json::parse(R"({"normalTexture": {"index": 6, "texCoord": 2.0}})")),
              "no error");
}

// --- textures, samplers, images --------------------------------------------------------------

TEST(GltfTextures, ShowTheImageThatTheyName) {
    GltfMaker maker = with_textures();
    maker.push("textures", Json::object());
    const prep::Scene scene = read(maker);
    ASSERT_EQ(scene.textures.size(), 8u);
    for (std::uint32_t t = 0; t < 7; ++t) EXPECT_EQ(scene.textures[t].image, 6 - t);
    EXPECT_EQ(scene.textures[7].image, prep::no_index);
}

TEST(GltfTextures, AWebpImageIsTakenWhereThereIsNoOther) {
    GltfMaker maker = with_textures();
    for (const bool also : {false, true}) {
        Json texture;
        texture["extensions"]["EXT_texture_webp"]["source"] = 3;
        if (also) texture["source"] = 5;
        maker.push("textures", texture);
    }
    const prep::Scene scene = read(maker);
    ASSERT_EQ(scene.textures.size(), 9u);
    EXPECT_EQ(scene.textures[7].image, 3u);
    EXPECT_EQ(scene.textures[8].image, 5u);
}

TEST(GltfTextures, WrapModesAreReadForEachDirection) {
    GltfMaker maker = with_textures();
    const std::pair<int, prep::Wrap> modes[] = {
        {10497, prep::Wrap::repeat}, {33071, prep::Wrap::clamp}, {33648, prep::Wrap::mirror}};
    for (const auto& [s, unused_s] : modes)
        for (const auto& [t, unused_t] : modes)
            maker.push(
                "textures",
                {{"source", 0}, {"sampler", maker.push("samplers", {{"wrapS", s}, {"wrapT", t}})}});
    maker.push("textures", {{"sampler", maker.push("samplers", Json::object())}});
    const prep::Scene scene = read(maker);
    ASSERT_EQ(scene.textures.size(), 17u);
    for (std::size_t i = 0; i < 9; ++i) {
        EXPECT_EQ(scene.textures[7 + i].wrap_u, modes[i / 3].second) << i;
        EXPECT_EQ(scene.textures[7 + i].wrap_v, modes[i % 3].second) << i;
    }
    EXPECT_EQ(scene.textures[16].wrap_u, prep::Wrap::repeat);
    EXPECT_EQ(scene.textures[16].wrap_v, prep::Wrap::repeat);
    maker.json["samplers"][0]["wrapT"] = 33070;
    EXPECT_NE(test::error_of(maker.read()).find("/samplers/0/wrapT"), std::string::npos);
}

TEST(GltfTextures, FiltersAreThoseOfTheirNumbers) {
    using prep::Filter;
    using prep::MipFilter;
    struct Minification {
        int code;
        Filter min;
        MipFilter mip;
    };
    const Minification all[] = {
        {9728, Filter::nearest, MipFilter::none},    {9729, Filter::linear, MipFilter::none},
        {9984, Filter::nearest, MipFilter::nearest}, {9985, Filter::linear, MipFilter::nearest},
        {9986, Filter::nearest, MipFilter::linear},  {9987, Filter::linear, MipFilter::linear}};
    GltfMaker maker;
    for (const Minification& m : all)
        maker.push("textures", {{"sampler", maker.push("samplers", {{"minFilter", m.code}})}});
    for (const int code : {9728, 9729})
        maker.push("textures", {{"sampler", maker.push("samplers", {{"magFilter", code}})}});
    const prep::Scene scene = read(maker);
    ASSERT_EQ(scene.textures.size(), 8u);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(scene.textures[i].min, all[i].min) << all[i].code;
        EXPECT_EQ(scene.textures[i].mip, all[i].mip) << all[i].code;
        EXPECT_EQ(scene.textures[i].mag, Filter::linear);
    }
    EXPECT_EQ(scene.textures[6].mag, Filter::nearest);
    EXPECT_EQ(scene.textures[7].mag, Filter::linear);
    EXPECT_EQ(scene.textures[6].min, Filter::linear);
    EXPECT_EQ(scene.textures[6].mip, MipFilter::linear);
    maker.json["samplers"][0]["minFilter"] = 9730;
    EXPECT_NE(test::error_of(maker.read()).find("/samplers/0/minFilter"), std::string::npos);
}

TEST(GltfImages, BytesComeFromViewsDataUrisAndFiles) {
    const test::TempDir dir;
    test::write_text(dir / "a b\xc3\xa9.png", "beside");
    GltfMaker maker;
    maker.view(std::vector<float>{1});
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < 5; ++i) bytes.push_back(std::uint8_t(250 + i));
    maker.push("images", {{"bufferView", maker.view(bytes)}, {"mimeType", "image/png"}});
    // All 64 digits, in both spellings of the last two, and every length's padding.
    for (const char* text : {"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/",
                             "-_-_", "QQ==", "QUI=", "QU\\nJD"})
        maker.push("images", {{"uri", std::string("data:image/jpeg;base64,") + text}});
    maker.json["images"][5]["uri"] = "data:image/jpeg;base64,QU\r\nJ D";
    maker.push("images", {{"uri", "a%20b%c3%A9.png"}});
    maker.push("images", {{"uri", "missing.png"}, {"name", "gone"}});
    test::write_text(dir / "in.gltf", maker.gltf());
    const auto scene = prep::load_gltf(dir / "in.gltf");
    ASSERT_TRUE(scene) << test::error_of(scene);
    const auto text = [&](std::size_t image) {
        const std::vector<std::byte>& b = scene->images.at(image).bytes;
        return std::string(reinterpret_cast<const char*>(b.data()), b.size());
    };
    EXPECT_EQ(text(0), "\xfa\xfb\xfc\xfd\xfe");
    EXPECT_EQ(scene->images[0].mime_type, "image/png");
    // Six bits each, from 0 to 63, high bits first.
    std::string digits;
    for (unsigned i = 0; i < 64; i += 4) {
        const unsigned bits = i << 18 | (i + 1) << 12 | (i + 2) << 6 | (i + 3);
        for (const unsigned shift : {16u, 8u, 0u}) digits += char(bits >> shift & 255);
    }
    EXPECT_EQ(text(1), digits);
    EXPECT_EQ(text(2), "\xfb\xff\xbf");
    EXPECT_EQ(text(3), "A");
    EXPECT_EQ(text(4), "AB");
    EXPECT_EQ(text(5), "ABC");
    EXPECT_EQ(text(6), "beside");
    EXPECT_EQ(text(7), "");
    EXPECT_EQ(scene->images[7].name, "gone");
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_TRUE(scene->warnings[0].starts_with("a picture was not found: missing.png; sought in '"))
        << scene->warnings[0];
}

}  // namespace
