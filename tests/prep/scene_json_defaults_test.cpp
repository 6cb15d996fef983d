// What docs/scene-format.md says of values that a scene file leaves out, and of those it may not
// give.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "mesh_files.h"
#include "prep/scene_json.h"

namespace {

constexpr double degree = std::numbers::pi / 180;

prep::Result<prep::JsonScene> parse(const std::string& rest) {
    return prep::parse_scene_json(
        R"({"meshprep": 1, "meshes": {"box": {"shape": {"kind": "box"}}})" +
            (rest.empty() ? "" : ", " + rest) + "}",
        "nowhere/s.json");
}

prep::JsonScene scene_of(const std::string& rest) {
    auto scene = parse(rest);
    EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    return scene ? std::move(*scene) : prep::JsonScene();
}

// Where the complaint stands; empty without one.
std::string refused_at(const std::string& rest) {
    const auto scene = parse(rest);
    if (scene) return "";
    const std::string place = scene.error().place;
    return place.substr(place.find('#') + 1);
}

TEST(SceneDefaults, AreThoseOfThePage) {
    const test::TempDir dir;
    test::write_text(dir / "t.png", "no picture yet");
    test::write_text(dir / "s.json", R"({"meshprep": 1, "textures": {"t": {"file": "t.png"}},
        "materials": {"m": {"diffuse_map": "t"}, "n": {"normal_map": {"texture": "t"}}},
        "meshes": {"box": {"shape": {"kind": "box"}}}, "lights": [
            {"kind": "spot", "position": [0, 0, 0], "direction": [0, -1, 0]}],
        "camera": {"position": [0, 0, 5], "target": [0, 0, 0]}})");
    const auto loaded = prep::load_scene_json(dir / "s.json");
    ASSERT_TRUE(loaded.has_value()) << prep::to_string(loaded.error());
    const prep::Scene& scene = loaded->scene;
    EXPECT_EQ(scene.name, "");
    const prep::Texture& t = scene.textures.at(0);
    EXPECT_EQ(t.wrap_u, prep::Wrap::repeat);
    EXPECT_EQ(t.wrap_v, prep::Wrap::repeat);
    EXPECT_EQ(t.mag, prep::Filter::linear);
    EXPECT_EQ(t.min, prep::Filter::linear);
    EXPECT_EQ(t.mip, prep::MipFilter::linear);

    ASSERT_EQ(scene.materials.size(), 2u);
    for (const prep::Material& m : scene.materials) {
        EXPECT_EQ(m.diffuse, glm::vec4(0.8f, 0.8f, 0.8f, 1));
        EXPECT_EQ(m.specular, glm::vec3(0.2f));
        EXPECT_EQ(m.ambient, glm::vec3(1));
        EXPECT_EQ(m.emissive, glm::vec3(0));
        EXPECT_EQ(m.shininess, 32.0f);
        EXPECT_EQ(m.alpha_mode, prep::AlphaMode::opaque);
        EXPECT_EQ(m.alpha_cutoff, 0.5f);
        EXPECT_FALSE(m.unlit || m.double_sided || m.normal_map_flip_green);
        EXPECT_EQ(m.normal_map_space, prep::NormalMapSpace::tangent);
        EXPECT_EQ(m.displacement_scale, 1.0f);
        EXPECT_EQ(m.displacement_midlevel, 0.5f);
        EXPECT_EQ(m.displacement_kind, prep::DisplacementKind::height);
        EXPECT_FALSE(bool(m.specular_map) || bool(m.emissive_map) || bool(m.occlusion_map) ||
                     bool(m.bump_map) || bool(m.displacement_map));
        // By its name alone, or as an object of nothing more: the whole of the first UV set.
        EXPECT_NE(bool(m.diffuse_map), bool(m.normal_map));
        const prep::TextureRef& map = m.diffuse_map ? m.diffuse_map : m.normal_map;
        EXPECT_EQ(map.uv_set, 0u);
        EXPECT_EQ(map.offset, glm::vec2(0));
        EXPECT_EQ(map.scale, glm::vec2(1));
        EXPECT_EQ(map.rotation, 0.0f);
        EXPECT_EQ(map.strength, 1.0f);
    }

    const prep::Light& light = scene.lights.at(0);
    EXPECT_EQ(light.color, glm::vec3(1));
    EXPECT_EQ(light.intensity, 1.0f);
    EXPECT_EQ(light.range, 0.0f);
    EXPECT_EQ(light.inner_cone, 0.0f);
    EXPECT_FLOAT_EQ(light.outer_cone, float(45 * degree));

    const prep::Camera& camera = scene.cameras.at(0);
    EXPECT_TRUE(camera.perspective);
    EXPECT_NEAR(camera.yfov, 45 * degree, 1e-15);
    EXPECT_EQ(camera.znear, 0.01);
    EXPECT_EQ(camera.zfar, 0);
    const glm::dmat4& stand = scene.nodes.at(scene.active_camera).transform;
    EXPECT_LT(glm::length(stand[1] - glm::dvec4(0, 1, 0, 0)), 1e-15);

    const prep::OrbitCamera orbit = scene_of(R"("camera": {"orbit": {}})").orbit.value();
    EXPECT_NEAR(orbit.azimuth, 30 * degree, 1e-15);
    EXPECT_NEAR(orbit.elevation, 20 * degree, 1e-15);
    EXPECT_EQ(orbit.distance, 1.0);

    // Nothing at all: each mesh once where it is, no camera, no light, and a picture that the
    // renderer chooses.
    const prep::JsonScene bare = scene_of("");
    ASSERT_EQ(bare.scene.nodes.size(), 1u);
    EXPECT_EQ(bare.scene.nodes[0].transform, glm::dmat4(1));
    EXPECT_TRUE(bare.scene.lights.empty() && bare.scene.cameras.empty());
    EXPECT_TRUE(bare.picture.given.empty());
    EXPECT_FALSE(bare.orbit.has_value());
}

// The least and the greatest coordinates, and how many faces.
struct Extent {
    glm::vec3 low{1e9f}, high{-1e9f};
    std::size_t faces = 0;
};
Extent extent(const std::string& shape) {
    const auto scene = prep::parse_scene_json(
        R"({"meshprep": 1, "meshes": {"s": {"shape": {)" + shape + "}}}}", "s.json");
    EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    Extent out;
    if (!scene) return out;
    const prep::Mesh& mesh = scene->scene.meshes.at(0);
    out.faces = mesh.face_count();
    for (const glm::vec3& p : mesh.positions) {
        out.low = glm::min(out.low, p);
        out.high = glm::max(out.high, p);
    }
    return out;
}

TEST(SceneDefaults, OfShapesAreThoseOfThePage) {
    const struct {
        const char* shape;
        glm::vec3 half;
        std::size_t faces;
    } cases[] = {{R"("kind": "plane")", {0.5, 0, 0.5}, 1},
                 {R"("kind": "box")", {0.5, 0.5, 0.5}, 6},
                 {R"("kind": "sphere")", {1, 1, 1}, 64 * 32},
                 {R"("kind": "cylinder")", {1, 1, 1}, 64 + 2},
                 {R"("kind": "torus")", {1.25, 0.25, 1.25}, 64 * 32}};
    for (const auto& c : cases) {
        const Extent found = extent(c.shape);
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(found.high[k], c.half[k], 1e-6) << c.shape;
            EXPECT_NEAR(found.low[k], -c.half[k], 1e-6) << c.shape;
        }
        EXPECT_EQ(found.faces, c.faces) << c.shape;
    }
    // Which key belongs to which shape.
    const struct {
        const char* key;
        const char* of;  // their initials; the sphere's is S
    } keys[] = {{"size", "pb"}, {"radius", "Sct"},    {"height", "c"},
                {"tube", "t"},  {"segments", "pSct"}, {"rings", "pSt"}};
    for (const auto& key : keys)
        for (const char* kind : {"plane", "box", "sphere", "cylinder", "torus"}) {
            const char initial = kind == std::string("sphere") ? 'S' : kind[0];
            const bool taken = std::string(key.of).find(initial) != std::string::npos;
            const std::string value = key.key == std::string("size") ? "[1, 1, 1]" : "3";
            const auto scene = prep::parse_scene_json(
                std::string(R"({"meshprep": 1, "meshes": {"s": {"shape": {"kind": ")") + kind +
                    "\", \"" + key.key + "\": " + value + "}}}}",
                "s.json");
            EXPECT_EQ(scene.has_value(), taken) << kind << " " << key.key;
        }
}

TEST(SceneLimits, OfMaterialsAreThoseOfThePage) {
    const auto at = [](const std::string& rest) {
        return refused_at(R"("materials": {"m": {)" + rest + "}}");
    };
    const struct {
        const char* key;
        const char* inside[2];
        const char* outside[2];
    } keys[] = {{"diffuse", {"0", "1"}, {"-0.01", "1.01"}},
                {"specular", {"0", "1"}, {"-0.01", "1.01"}},
                {"shininess", {"0", "1e6"}, {"-1", "1000001"}},
                {"opacity", {"0", "1"}, {"-0.01", "1.01"}},
                {"alpha_cutoff", {"0", "1"}, {"-0.01", "1.01"}}};
    for (const auto& key : keys)
        for (int i = 0; i < 2; ++i) {
            const std::string word = "\"" + std::string(key.key) + "\": ";
            EXPECT_EQ(at(word + key.inside[i]), "") << word << key.inside[i];
            EXPECT_EQ(at(word + key.outside[i]), "/materials/m/" + std::string(key.key))
                << word << key.outside[i];
        }
    EXPECT_EQ(at(R"("emissive": 100, "ambient": 3)"), "");  // light has no such bound
    EXPECT_EQ(at(R"("alpha_mode": "clip")"), "/materials/m/alpha_mode");
    EXPECT_EQ(at(R"("normal_map_space": "world")"), "/materials/m/normal_map_space");
    // The texture is looked for when the numbers are right.
    const auto map = [&](const std::string& rest) {
        return at(R"("normal_map": {"texture": "none")" + rest + "}");
    };
    EXPECT_EQ(map(R"(, "uv_set": 7)"), "/materials/m/normal_map/texture");
    EXPECT_EQ(map(R"(, "uv_set": 8)"), "/materials/m/normal_map/uv_set");
    EXPECT_EQ(map(R"(, "uv_set": -1)"), "/materials/m/normal_map/uv_set");
    EXPECT_EQ(at(R"("normal_map": {"uv_set": 0})"), "/materials/m/normal_map");
}

TEST(SceneLimits, OfPicturesAreThoseOfThePage) {
    const auto at = [](const std::string& rest) {
        return refused_at("\"picture\": {" + rest + "}");
    };
    EXPECT_EQ(at(R"("size": [32768, 1])"), "");
    EXPECT_EQ(at(R"("size": [32769, 1])"), "/picture/size/0");
    EXPECT_EQ(at(R"("size": [1, 0])"), "/picture/size/1");
    EXPECT_EQ(at(R"("size": [1.5, 1])"), "/picture/size");
    for (const char* good : {"1", "16"}) {
        EXPECT_EQ(at(R"("supersample": )" + std::string(good)), "");
        EXPECT_EQ(at(R"("max_anisotropy": )" + std::string(good)), "");
        EXPECT_EQ(at(R"("samples": )" + std::string(good)), "");
    }
    for (const char* bad : {"0", "17"}) {
        EXPECT_EQ(at(R"("supersample": )" + std::string(bad)), "/picture/supersample");
        EXPECT_EQ(at(R"("max_anisotropy": )" + std::string(bad)), "/picture/max_anisotropy");
        EXPECT_EQ(at(R"("samples": )" + std::string(bad)), "/picture/samples");
    }
    EXPECT_EQ(at(R"("exposure": 1e-6)"), "");
    EXPECT_EQ(at(R"("exposure": 1e6)"), "");
    EXPECT_EQ(at(R"("exposure": 1.1e6)"), "/picture/exposure");
    EXPECT_EQ(at(R"("exposure": 9e-7)"), "/picture/exposure");
    EXPECT_EQ(at(R"("allow_error": 0)"), "");
    EXPECT_EQ(at(R"("allow_error": 1e6)"), "");
    EXPECT_EQ(at(R"("allow_error": 1.1e6)"), "/picture/allow_error");
    EXPECT_EQ(at(R"("allow_error": -1)"), "/picture/allow_error");
    EXPECT_EQ(at(R"("tone_map": "filmic")"), "/picture/tone_map");
    EXPECT_EQ(at(R"("shading": "toon")"), "/picture/shading");
    EXPECT_EQ(at(R"("cull": "all")"), "/picture/cull");
}

TEST(SceneLimits, MatricesEndWithTheRowOfPoints) {
    const auto at = [](const std::string& rest) {
        return refused_at(R"("nodes": [{"mesh": "box", "matrix": [)" + rest + "]}]");
    };
    EXPECT_EQ(at("1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1"), "");
    EXPECT_EQ(at("1,0,0,0.5, 0,1,0,0, 0,0,1,0, 5,6,7,1"), "/nodes/0/matrix");
    EXPECT_EQ(at("1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,2"), "/nodes/0/matrix");
    EXPECT_EQ(at("1,0,0,5, 0,1,0,6, 0,0,1,7, 0,0,0,1"), "/nodes/0/matrix");  // by rows
}

// Neither is JSON: what is not too long is told so at its first character.
TEST(SceneLimits, MoreThan64MebibytesAreRefused) {
    std::string text(std::size_t(64) << 20, '?');
    EXPECT_EQ(prep::parse_scene_json(text, "s.json").error().code, prep::ErrorCode::syntax);
    text += '?';
    EXPECT_EQ(prep::parse_scene_json(text, "s.json").error().code, prep::ErrorCode::limit);
}

TEST(SceneLimits, AFileBringsNoSceneAndNothingThatMovesOrLights) {
    const test::TempDir dir;
    const std::string head = R"({"meshprep": 1, "meshes": {"t": {"file": ")";
    test::write_text(dir / "inner.json", R"({"meshprep": 1, "meshes": {"a": {"shape": {"kind":
        "box"}}}})");
    test::write_text(dir / "outer.json", head + "inner.json\"}}}");
    const auto nested = prep::load_scene_json(dir / "outer.json");
    ASSERT_FALSE(nested.has_value());
    EXPECT_EQ(nested.error().code, prep::ErrorCode::unsupported);
    EXPECT_EQ(nested.error().place, (dir / "outer.json").string() + "#/meshes/t/file");

    test::write_text(dir / "t.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "skin": 0, "children": [1]}, {"camera": 0, "extensions":
            {"KHR_lights_punctual": {"light": 0}}}], "skins": [{"joints": [1]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}]}},
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "_HEAT": 0},
            "targets": [{"POSITION": 0}]}]}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
            "samplers": [{"input": 1, "output": 2}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
        "min": [0, 0, 0], "max": [1, 1, 0]}, {"bufferView": 0, "componentType": 5126, "count": 1,
        "type": "SCALAR", "min": [0], "max": [0]}, {"bufferView": 0, "componentType": 5126,
        "count": 1, "type": "VEC3"}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,)"
                                     R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
    test::write_text(dir / "s.json", head + "t.gltf\"}}}");
    const auto loaded = prep::load_scene_json(dir / "s.json");
    ASSERT_TRUE(loaded.has_value()) << prep::to_string(loaded.error());
    const prep::Scene& scene = loaded->scene;
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_TRUE(scene.lights.empty() && scene.cameras.empty() && scene.skins.empty());
    for (const prep::Node& node : scene.nodes)
        EXPECT_TRUE(node.light == prep::no_index && node.camera == prep::no_index &&
                    node.skin == prep::no_index);
    EXPECT_EQ(scene.warnings,
              std::vector<std::string>{
                  "mesh 't': the file's own lights, cameras, skins, animations, morph targets, "
                  "attributes of other names are not part of the scene"});
    EXPECT_TRUE(scene.animations.empty());
    EXPECT_TRUE(scene.meshes[0].morph_targets.empty() && scene.meshes[0].vertex_attributes.empty());
}

}  // namespace
