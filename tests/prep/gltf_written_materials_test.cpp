// Materials, textures and pictures of scenes that did not come from glTF, as the specification and
// its extensions name them.
#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "mesh_files.h"
#include "prep/image.h"
#include "prep/save.h"
#include "written_gltf.h"

namespace {

using Json = test::GltfFile::Json;

// A triangle for each material, with two UV sets.
prep::Scene scene_with(const std::vector<prep::Material>& materials) {
    prep::Scene scene;
    scene.materials = materials;
    prep::Mesh& mesh = scene.meshes.emplace_back();
    for (std::uint32_t m = 0; m < std::max(materials.size(), std::size_t(1)); ++m) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            mesh.positions.push_back({float(3 * m + k), float(k * k), 0});
            mesh.corner_vertices.push_back(3 * m + k);
        }
        mesh.face_offsets.push_back(3 * m + 3);
        mesh.face_materials.push_back(m);
    }
    mesh.uvs.resize(2);
    for (auto& set : mesh.uvs) {
        set.values = {{0, 0}, {1, 0}, {0, 1}};
        for (std::uint32_t c = 0; c < mesh.corner_vertices.size(); ++c)
            set.indices.push_back(c % 3);
    }
    prep::instance_unused_meshes(scene);
    return scene;
}

std::vector<std::byte> bytes_of(const std::string& text) {
    const auto bytes = std::as_bytes(std::span(text.data(), text.size()));
    return {bytes.begin(), bytes.end()};
}

// A picture of this green, 2 × 1, as a PNG of its own bytes.
std::vector<std::byte> png(float green) {
    prep::Image image;
    image.width = 2;
    image.height = 1;
    image.channels = 3;
    image.pixels = {0.2f, green, 0.4f, 1, 1, 0};
    auto bytes = prep::encode_png(image);
    EXPECT_TRUE(bytes.has_value());
    return bytes ? *bytes : std::vector<std::byte>{};
}

// As many textures, each with a picture of its own.
void add_textures(prep::Scene& scene, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
        prep::ImageRef image;
        image.name = "picture " + std::to_string(i);
        image.bytes = bytes_of("\x89PNG\r\n\x1a\n" + image.name);  // nobody looks further
        scene.images.push_back(image);
        prep::Texture texture;
        texture.image = i;
        scene.textures.push_back(texture);
    }
}

prep::TextureRef map_of(std::uint32_t texture, std::uint32_t uv_set = 0) {
    prep::TextureRef ref;
    ref.texture = texture;
    ref.uv_set = uv_set;
    return ref;
}

struct Saved {
    test::GltfFile file;
    std::vector<std::string> notes;
    const Json& material(std::size_t m) const { return file.json["materials"].at(m); }
    std::string picture(const Json& info) const {  // the bytes behind a textureInfo
        const Json& texture = file.json["textures"].at(info.at("index").get<std::size_t>());
        const Json& image = file.json["images"].at(texture.at("source").get<std::size_t>());
        return file.view_bytes(image.at("bufferView"));
    }
};

Saved saved(prep::Scene scene) {
    const test::TempDir dir;
    auto notes = prep::save_scene(test::untouched(std::move(scene)), dir / "a.glb");
    EXPECT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    test::GltfFile file(dir / "a.glb");
    EXPECT_EQ(file.fault(), "");
    return {std::move(file), notes ? *notes : std::vector<std::string>{}};
}

std::string text_of(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::size_t used_extension(const Json& json, const std::string& name) {
    const Json used = json.value("extensionsUsed", Json::array());
    return std::size_t(std::count(used.begin(), used.end(), name));
}

TEST(GltfWrittenMaterials, BlinnPhongBecomesTheRoughnessOfTheSameHighlight) {
    // roughness⁴ = 2 / (shininess + 2), docs/conventions.md without its limit.
    const std::pair<float, double> cases[] = {
        {0, 1}, {6, std::sqrt(0.5)}, {30, 0.5}, {510, 0.25}, {131070, 0.0625}};
    std::vector<prep::Material> materials;
    for (const auto& [shininess, roughness] : cases) {
        prep::Material m;
        m.name = "m" + std::to_string(materials.size());
        m.shininess = shininess;
        m.ambient = {0.125f, 0.25f, 0.375f};
        m.diffuse = {0.5f, 0.25f, 0.75f, 0.625f};
        m.specular = {0.01f, 0.02f, 0.5f};
        m.metallic = 0.5f;  // of which Blinn-Phong knows nothing
        m.roughness = 0.125f;
        materials.push_back(m);
    }
    const Saved out = saved(scene_with(materials));
    EXPECT_EQ(out.file.json["extensionsUsed"], Json::array({"KHR_materials_specular"}));
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const Json& m = out.material(i);
        EXPECT_EQ(m["name"], materials[i].name);
        const Json& pbr = m["pbrMetallicRoughness"];
        EXPECT_EQ(pbr["baseColorFactor"], Json({0.5, 0.25, 0.75, 0.625}));
        EXPECT_EQ(pbr["metallicFactor"], 0);
        EXPECT_NEAR(pbr["roughnessFactor"].get<double>(), cases[i].second, 1e-7);
        // Light that falls in straight is reflected by the factor times 4 %: the specular colour
        // over its spread, at most the quarter that the diffuse colour leaves.
        const double n = double(cases[i].first), spread = (n + 2) / 8 + 1 / (2 * n + 4);
        const double limited = std::min(1.0, 0.25 / (0.5 / spread));
        const Json& factor = m["extensions"]["KHR_materials_specular"]["specularColorFactor"];
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(factor[std::size_t(k)].get<double>() * 0.04,
                        double(materials[i].specular[k]) / spread * limited, 1e-7);
        EXPECT_EQ(m["extras"]["blinnPhong"], (Json{{"ambient", {0.125, 0.25, 0.375}},
                                                   {"diffuse", {0.5, 0.25, 0.75, 0.625}},
                                                   {"specular", {0.01f, 0.02f, 0.5f}},
                                                   {"shininess", cases[i].first}}));
        EXPECT_FALSE(m.contains("alphaMode") || m.contains("doubleSided") ||
                     m.contains("emissiveFactor"));
    }
}

TEST(GltfWrittenMaterials, MetallicRoughnessStaysAsItIs) {
    prep::Material m;
    m.metallic_roughness = true;
    m.diffuse = {0.1f, 1.5f, -0.5f, 0.25f};
    m.metallic = 0.75f;
    m.roughness = 0.375f;
    m.shininess = 6;
    m.specular_map = map_of(0);
    m.metallic_roughness_map = map_of(1);
    prep::Material beyond = m;
    beyond.metallic = 2;
    beyond.roughness = -1;
    prep::Scene scene = scene_with({m, beyond});
    add_textures(scene, 2);
    const Saved out = saved(scene);
    const Json& pbr = out.material(0)["pbrMetallicRoughness"];
    EXPECT_EQ(pbr["baseColorFactor"], Json({0.1f, 1, 0, 0.25}));
    EXPECT_EQ(pbr["metallicFactor"], 0.75);
    EXPECT_EQ(pbr["roughnessFactor"], 0.375);
    EXPECT_EQ(out.picture(pbr["metallicRoughnessTexture"]), text_of(scene.images[1].bytes));
    EXPECT_FALSE(out.material(0).contains("extras"));
    const Json& specular = out.material(0)["extensions"]["KHR_materials_specular"];
    EXPECT_EQ(out.picture(specular["specularColorTexture"]), text_of(scene.images[0].bytes));
    EXPECT_FALSE(specular.contains("specularColorFactor"));  // 4 % is glTF's own
    EXPECT_EQ(out.material(0)["extensions"].size(), 1u);
    EXPECT_EQ(out.file.json["images"].size(), 2u);
    EXPECT_EQ(out.material(1)["pbrMetallicRoughness"]["metallicFactor"], 1);
    EXPECT_EQ(out.material(1)["pbrMetallicRoughness"]["roughnessFactor"], 0);
    EXPECT_EQ(out.file.json["extensionsUsed"], Json::array({"KHR_materials_specular"}));
}

TEST(GltfWrittenMaterials, EmissionAboveOneIsAStrength) {
    std::vector<prep::Material> materials(4);
    for (prep::Material& m : materials) m.metallic_roughness = true;
    materials[1].emissive = {0.5f, 0, 1};
    materials[2].emissive = {0.5f, 4, 1};
    materials[3].emissive = {-1, 0.25f, 0};
    const Saved out = saved(scene_with(materials));
    EXPECT_FALSE(out.material(0).contains("emissiveFactor"));
    EXPECT_EQ(out.material(1)["emissiveFactor"], Json({0.5, 0, 1}));
    EXPECT_FALSE(out.material(1).contains("extensions"));
    EXPECT_EQ(out.material(2)["emissiveFactor"], Json({0.125, 1, 0.25}));
    EXPECT_EQ(out.material(2)["extensions"],
              (Json{{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}));
    EXPECT_EQ(out.material(3)["emissiveFactor"], Json({0, 0.25, 0}));
    EXPECT_EQ(used_extension(out.file.json, "KHR_materials_emissive_strength"), 1u);
}

TEST(GltfWrittenMaterials, AlphaSidesAndUnlit) {
    std::vector<prep::Material> materials(4);
    materials[1].alpha_mode = prep::AlphaMode::mask;
    materials[1].alpha_cutoff = 0.125f;
    materials[2].alpha_mode = prep::AlphaMode::blend;
    materials[2].double_sided = true;
    materials[3].unlit = true;
    materials[3].specular_map = map_of(0);
    const Saved out = saved(scene_with(materials));
    for (const std::size_t m : {0u, 3u}) {
        EXPECT_FALSE(out.material(m).contains("alphaMode"));
        EXPECT_FALSE(out.material(m).contains("alphaCutoff"));
        EXPECT_FALSE(out.material(m).contains("doubleSided"));
    }
    EXPECT_EQ(out.material(1)["alphaMode"], "MASK");
    EXPECT_EQ(out.material(1)["alphaCutoff"], 0.125);
    EXPECT_EQ(out.material(2)["alphaMode"], "BLEND");
    EXPECT_FALSE(out.material(2).contains("alphaCutoff"));
    EXPECT_EQ(out.material(2)["doubleSided"], true);
    EXPECT_EQ(out.material(3)["extensions"], (Json{{"KHR_materials_unlit", Json::object()}}));
    EXPECT_FALSE(out.material(0)["extensions"].contains("KHR_materials_unlit"));
    EXPECT_EQ(used_extension(out.file.json, "KHR_materials_unlit"), 1u);
}

TEST(GltfWrittenMaterials, EveryMapIsInItsPlaceOnItsUvSet) {
    prep::Material m;
    m.diffuse_map = map_of(0);
    m.specular_map = map_of(1, 1);
    m.emissive_map = map_of(2);
    m.occlusion_map = map_of(3, 1);
    m.occlusion_map.strength = 0.75f;
    m.normal_map = map_of(4);
    m.normal_map.strength = 2.5f;
    m.metallic_roughness_map = map_of(5);  // not of a Blinn-Phong material
    prep::Scene scene = scene_with({m});
    add_textures(scene, 6);
    const Saved out = saved(scene);
    const Json& json = out.material(0);
    const auto expect = [&](const Json& info, std::uint32_t texture, Json rest) {
        EXPECT_EQ(out.picture(info), text_of(scene.images[texture].bytes)) << texture;
        Json members = info;
        members.erase("index");
        EXPECT_EQ(members, rest) << texture;
    };
    expect(json["pbrMetallicRoughness"]["baseColorTexture"], 0, Json::object());
    expect(json["extensions"]["KHR_materials_specular"]["specularColorTexture"], 1,
           {{"texCoord", 1}});
    expect(json["emissiveTexture"], 2, Json::object());
    expect(json["occlusionTexture"], 3, {{"texCoord", 1}, {"strength", 0.75}});
    expect(json["normalTexture"], 4, {{"scale", 2.5}});
    EXPECT_FALSE(json["pbrMetallicRoughness"].contains("metallicRoughnessTexture"));
    EXPECT_EQ(out.file.json["images"].size(), 5u);
    for (const Json& image : out.file.json["images"]) EXPECT_EQ(image["mimeType"], "image/png");
    EXPECT_EQ(out.file.json["images"][0]["name"], "picture 0");
}

TEST(GltfWrittenMaterials, TextureTransformsKeepTheirNumbers) {
    std::vector<prep::Material> materials(5);
    for (prep::Material& m : materials) m.diffuse_map = map_of(0);
    materials[1].diffuse_map.offset = {0.25f, -0.5f};
    materials[2].diffuse_map.scale = {2, -3};
    materials[3].diffuse_map.rotation = 0.75f;
    materials[4].diffuse_map = {0, 1, {1, 2}, {3, 4}, -0.5f};
    prep::Scene scene = scene_with(materials);
    add_textures(scene, 1);
    const Saved out = saved(scene);
    const auto transform = [&](std::size_t m) {
        const Json& info = out.material(m)["pbrMetallicRoughness"]["baseColorTexture"];
        return info.value("/extensions/KHR_texture_transform"_json_pointer, Json());
    };
    EXPECT_EQ(transform(0), Json());
    EXPECT_EQ(transform(1), (Json{{"offset", {0.25, -0.5}}, {"rotation", 0}, {"scale", {1, 1}}}));
    EXPECT_EQ(transform(2), (Json{{"offset", {0, 0}}, {"rotation", 0}, {"scale", {2, -3}}}));
    EXPECT_EQ(transform(3), (Json{{"offset", {0, 0}}, {"rotation", 0.75}, {"scale", {1, 1}}}));
    EXPECT_EQ(transform(4), (Json{{"offset", {1, 2}}, {"rotation", -0.5}, {"scale", {3, 4}}}));
    EXPECT_EQ(out.material(4)["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"], 1);
    EXPECT_EQ(used_extension(out.file.json, "KHR_texture_transform"), 1u);
    EXPECT_EQ(out.file.json["textures"].size(), 1u);  // one for all of them
}

TEST(GltfWrittenMaterials, SamplersSayHowToWrapAndFilter) {
    using prep::Filter, prep::MipFilter, prep::Wrap;
    struct Case {
        prep::Texture texture;
        int wrap_s, wrap_t, mag, min;
    };
    const auto n = Filter::nearest, l = Filter::linear;
    // OpenGL's numbers, section 5.26 of the specification.
    const std::vector<Case> cases = {
        {{0, Wrap::repeat, Wrap::mirror, l, n, MipFilter::none}, 10497, 33648, 9729, 9728},
        {{0, Wrap::mirror, Wrap::clamp, n, l, MipFilter::none}, 33648, 33071, 9728, 9729},
        {{0, Wrap::clamp, Wrap::repeat, l, n, MipFilter::nearest}, 33071, 10497, 9729, 9984},
        {{0, Wrap::repeat, Wrap::clamp, n, l, MipFilter::nearest}, 10497, 33071, 9728, 9985},
        {{0, Wrap::border, Wrap::repeat, l, n, MipFilter::linear}, 33071, 10497, 9729, 9986},
        {{0, Wrap::repeat, Wrap::repeat, n, l, MipFilter::linear}, 10497, 10497, 9728, 9987}};
    std::vector<prep::Material> materials(cases.size());
    for (std::uint32_t i = 0; i < cases.size(); ++i) materials[i].diffuse_map = map_of(i);
    prep::Scene scene = scene_with(materials);
    add_textures(scene, 1);
    scene.textures.clear();
    for (const Case& c : cases) scene.textures.push_back(c.texture);
    const Saved out = saved(scene);
    EXPECT_EQ(out.file.json["images"].size(), 1u);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const Json& info = out.material(i)["pbrMetallicRoughness"]["baseColorTexture"];
        const Json& texture = out.file.json["textures"].at(info["index"].get<std::size_t>());
        EXPECT_EQ(out.file.json["samplers"].at(texture["sampler"].get<std::size_t>()),
                  (Json{{"wrapS", cases[i].wrap_s},
                        {"wrapT", cases[i].wrap_t},
                        {"magFilter", cases[i].mag},
                        {"minFilter", cases[i].min}}))
            << i;
    }
}

TEST(GltfWrittenMaterials, PicturesOfOtherFormatsBecomePng) {
    const test::TempDir dir;
    prep::Image image;
    image.width = 2;
    image.height = 2;
    image.channels = 3;
    for (int i = 0; i < 12; ++i) image.pixels.push_back(float(20 * i) / 255);
    ASSERT_TRUE(prep::save_image(dir / "a.bmp", image).has_value());
    ASSERT_TRUE(prep::save_image(dir / "b.jpg", image).has_value());
    std::vector<prep::Material> materials(3);
    for (std::uint32_t i = 0; i < 3; ++i) materials[i].diffuse_map = map_of(i);
    prep::Scene scene = scene_with(materials);
    scene.images.resize(3);
    scene.images[0].name = "bmp";
    scene.images[0].path = dir / "a.bmp";
    scene.images[1].path = dir / "b.jpg";
    scene.images[2].name = "gone";
    scene.images[2].path = dir / "c.png";
    for (std::uint32_t i = 0; i < 3; ++i) {
        scene.textures.emplace_back();
        scene.textures.back().image = i;
    }
    const Saved out = saved(scene);
    ASSERT_EQ(out.file.json["images"].size(), 2u);
    EXPECT_EQ(out.file.json["images"][0]["mimeType"], "image/png");
    EXPECT_EQ(out.file.json["images"][1]["mimeType"], "image/jpeg");
    const auto info = [&](std::size_t m) {
        return out.material(m)["pbrMetallicRoughness"].value("baseColorTexture", Json());
    };
    EXPECT_EQ(out.picture(info(1)), test::file_text(dir / "b.jpg"));
    EXPECT_EQ(info(2), Json());
    const std::string bytes = out.picture(info(0));
    const auto decoded =
        prep::decode_image(std::as_bytes(std::span(bytes.data(), bytes.size())), "a.png");
    ASSERT_TRUE(decoded.has_value());
    ASSERT_EQ(decoded->pixels.size(), image.pixels.size());
    for (std::size_t i = 0; i < image.pixels.size(); ++i)  // far below a step of 1/255
        EXPECT_NEAR(decoded->pixels[i], image.pixels[i], 1e-6);
    EXPECT_EQ(out.notes, (std::vector<std::string>{
                             "texture 'bmp' was converted to PNG",
                             "textures that cannot be read: gone: their materials go without"}));
}

// glTF's green points up: a map whose green points down is written turned over, and only as a
// normal map.
TEST(GltfWrittenMaterials, NormalMapsWhoseGreenPointsDownAreTurnedOver) {
    prep::Material m, up;
    m.normal_map = m.diffuse_map = up.normal_map = map_of(0);
    m.normal_map_flip_green = true;
    prep::Scene scene = scene_with({m, up});
    add_textures(scene, 1);
    scene.images[0].bytes = png(51 / 255.0f);
    const Saved out = saved(scene);
    const std::string own = text_of(scene.images[0].bytes);
    EXPECT_EQ(out.picture(out.material(0)["pbrMetallicRoughness"]["baseColorTexture"]), own);
    EXPECT_EQ(out.picture(out.material(1)["normalTexture"]), own);
    const std::string turned = out.picture(out.material(0)["normalTexture"]);
    const auto decoded =
        prep::decode_image(std::as_bytes(std::span(turned.data(), turned.size())), "a.png");
    ASSERT_TRUE(decoded.has_value());
    const float expected[6] = {51, 204, 102, 255, 0, 0};
    ASSERT_EQ(decoded->pixels.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_NEAR(decoded->pixels[i] * 255, expected[i], 1e-3) << i;
}

TEST(GltfWrittenMaterials, NormalMapsOfSixteenBitsKeepThemWhenTurnedOver) {
    prep::Material m;
    m.normal_map = map_of(0);
    m.normal_map_flip_green = true;
    prep::Scene scene = scene_with({m});
    add_textures(scene, 1);
    prep::Image image;
    image.width = image.height = 1;
    image.channels = 3;
    image.pixels = {12345 / 65535.0f, 20001 / 65535.0f, 40000 / 65535.0f};
    scene.images[0].bytes = *prep::encode_png(image, prep::PixelType::u16);
    const Saved out = saved(scene);
    const std::string turned = out.picture(out.material(0)["normalTexture"]);
    const auto decoded =
        prep::decode_image(std::as_bytes(std::span(turned.data(), turned.size())), "a.png");
    ASSERT_TRUE(decoded.has_value());
    const float expected[3] = {12345, 65535 - 20001, 40000};
    ASSERT_EQ(decoded->pixels.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(decoded->pixels[i] * 65535, expected[i], 0.1) << i;
}

TEST(GltfWrittenMaterials, MapsThatGltfHasNoPlaceForAreTold) {
    prep::Material m;
    m.normal_map = map_of(0);
    m.normal_map_space = prep::NormalMapSpace::object;
    m.bump_map = map_of(1);
    prep::Scene scene = scene_with({m});
    add_textures(scene, 2);
    const Saved out = saved(scene);
    EXPECT_FALSE(out.material(0).contains("normalTexture"));
    EXPECT_FALSE(out.file.json.contains("images"));
    EXPECT_EQ(out.notes, (std::vector<std::string>{"glTF has no object-space normal maps: left out",
                                                   "glTF has no bump maps: left out"}));
}

TEST(GltfWrittenMaterials, DisplacementIsKeptInExtras) {
    prep::Material m;
    m.displacement_map = map_of(1, 1);
    m.displacement_map.strength = 0.5f;
    m.displacement_scale = 3;
    m.displacement_midlevel = 0.25f;
    m.displacement_kind = prep::DisplacementKind::vector_object;
    prep::Scene scene = scene_with({m, prep::Material{}});
    add_textures(scene, 2);
    const Saved out = saved(scene);
    const Json& kept = out.material(0)["extras"]["displacement"];
    EXPECT_EQ(out.picture(kept["texture"]), text_of(scene.images[1].bytes));
    EXPECT_EQ(kept["texture"]["texCoord"], 1);
    EXPECT_EQ(kept["scale"], 1.5);
    EXPECT_EQ(kept["midlevel"], 0.25);
    EXPECT_EQ(kept["kind"], "vector-object");
    EXPECT_FALSE(out.material(1)["extras"].contains("displacement"));
    EXPECT_EQ(out.notes, std::vector<std::string>{
                             "glTF has no displacement maps: kept in the materials' extras"});
}

// Heights of floats keep 16 bits of what PNG holds; what lies beyond is told.
TEST(GltfWrittenMaterials, HeightsBecomePicturesOfSixteenBits) {
    const test::TempDir dir;
    prep::Image image;
    image.width = 2;
    image.height = 1;
    image.channels = 1;
    image.pixels = {0.3f, 1.5f};
    ASSERT_TRUE(prep::save_image(dir / "height.exr", image, prep::PixelType::f32));
    prep::Material m;
    m.displacement_map = map_of(0);
    prep::Scene scene = scene_with({m});
    add_textures(scene, 1);
    scene.images[0].bytes.clear();
    scene.images[0].path = dir / "height.exr";
    const Saved out = saved(scene);
    const std::string png = out.picture(out.material(0)["extras"]["displacement"]["texture"]);
    const auto decoded =
        prep::decode_image(std::as_bytes(std::span(png.data(), png.size())), "a.png");
    ASSERT_TRUE(decoded.has_value());
    EXPECT_EQ(decoded->integer_bits, 16);
    EXPECT_NEAR(decoded->pixels[0], 0.3f, 0.6 / 65535);
    EXPECT_EQ(decoded->pixels[decoded->channels], 1.0f);
    EXPECT_EQ(std::count_if(out.notes.begin(), out.notes.end(),
                            [](const std::string& note) {
                                return note.find("heights beyond 0 to 1") != std::string::npos;
                            }),
              1);
}

// Two meshes of one material: the second has the first UV set only, so its copy of the material
// goes without the map on the second.
TEST(GltfWrittenMaterials, MapsOnUvSetsThatAMeshLacksAreLeftOutForIt) {
    prep::Material m;
    m.diffuse_map = map_of(0);
    m.occlusion_map = map_of(1, 1);
    prep::Scene scene = scene_with({prep::Material{}, m});
    add_textures(scene, 2);
    scene.meshes.push_back(scene.meshes[0]);
    scene.meshes[1].uvs.resize(1);
    prep::instance_unused_meshes(scene);
    const Saved out = saved(scene);
    ASSERT_EQ(out.file.json["materials"].size(), 3u);
    EXPECT_EQ(out.file.primitive(0, 0)["material"], 0);
    EXPECT_EQ(out.file.primitive(1, 0)["material"], 0);
    EXPECT_EQ(out.file.primitive(0, 1)["material"], 1);
    EXPECT_EQ(out.file.primitive(1, 1)["material"], 2);
    EXPECT_TRUE(out.material(1).contains("occlusionTexture"));
    EXPECT_FALSE(out.material(2).contains("occlusionTexture"));
    EXPECT_EQ(out.material(2)["pbrMetallicRoughness"], out.material(1)["pbrMetallicRoughness"]);
    EXPECT_EQ(out.notes, std::vector<std::string>{
                             "maps were left out where faces have no UVs for them (1 material)"});
}

// A mesh that has the second set alone keeps the map on it, though a set of zeros stands before.
TEST(GltfWrittenMaterials, MapsOnAnAbsentFirstUvSetAreLeftOutAlone) {
    prep::Material m;
    m.diffuse_map = map_of(0);
    m.occlusion_map = map_of(1, 1);
    prep::Scene scene = scene_with({m});
    add_textures(scene, 2);
    scene.meshes[0].uvs[0] = {};
    const Saved out = saved(scene);
    ASSERT_EQ(out.file.json["materials"].size(), 1u);
    EXPECT_FALSE(out.material(0)["pbrMetallicRoughness"].contains("baseColorTexture"));
    EXPECT_EQ(out.material(0)["occlusionTexture"]["texCoord"], 1);
    EXPECT_EQ(out.notes, std::vector<std::string>{
                             "maps were left out where faces have no UVs for them (1 material)"});
}

}  // namespace
