// Scene files, value by value: lights, cameras, materials, textures, and meshes from files of their
// own whose materials and nodes become part of the scene.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "formats/obj/obj.h"
#include "mesh_files.h"
#include "prep/scene_json.h"

namespace {

constexpr double pi = std::numbers::pi;

prep::Result<prep::JsonScene> parse(const std::string& rest) {
    return prep::parse_scene_json(
        R"({"meshprep": 1, "meshes": {"box": {"shape": {"kind": "box"}}}, )" + rest + "}",
        "nowhere/s.json");
}

prep::JsonScene scene_of(const std::string& rest) {
    auto scene = parse(rest);
    EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    return scene ? std::move(*scene) : prep::JsonScene();
}

prep::Scene load(const test::TempDir& dir, const std::string& text) {
    test::write_text(dir / "s.json", text);
    auto scene = prep::load_scene_json(dir / "s.json");
    EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    return scene ? std::move(scene->scene) : prep::Scene();
}

TEST(SceneValues, LightsAreAsTheFileSays) {
    const prep::Scene scene = scene_of(R"("lights": [
        {"name": "s", "kind": "spot", "position": [1, 2, 3], "direction": [0, 0, 1], "range": 7,
         "intensity": 5, "color": [1, 0.5, 0.25], "inner_cone": 12, "outer_cone": 30},
        {"kind": "point", "position": [0, 1, 0], "range": 2.5, "intensity": 0.125},
        {"kind": "directional", "direction": [-1, 0, 0], "intensity": 3},
        {"kind": "ambient", "color": "#ffffff", "intensity": 0.0625}])")
                                  .scene;
    ASSERT_EQ(scene.lights.size(), 4u);
    const prep::Light& spot = scene.lights[0];
    EXPECT_EQ(spot.name, "s");
    EXPECT_EQ(spot.kind, prep::LightKind::spot);
    EXPECT_EQ(spot.color, glm::vec3(1, 0.5f, 0.25f));
    EXPECT_EQ(spot.intensity, 5);
    EXPECT_EQ(spot.range, 7);
    EXPECT_FLOAT_EQ(spot.inner_cone, float(pi / 15));
    EXPECT_FLOAT_EQ(spot.outer_cone, float(pi / 6));
    EXPECT_EQ(scene.lights[1].kind, prep::LightKind::point);
    EXPECT_EQ(scene.lights[1].range, 2.5f);
    EXPECT_EQ(scene.lights[1].intensity, 0.125f);
    EXPECT_EQ(scene.lights[2].kind, prep::LightKind::directional);
    EXPECT_EQ(scene.lights[2].intensity, 3);
    EXPECT_EQ(scene.lights[2].range, 0);
    EXPECT_EQ(scene.lights[3].kind, prep::LightKind::ambient);
    EXPECT_EQ(scene.lights[3].intensity, 0.0625f);
    const glm::dvec3 wanted[] = {{0, 0, 1}, {}, {-1, 0, 0}};
    for (const prep::Node& node : scene.nodes)
        if (node.light == 0 || node.light == 2) {
            const glm::dvec3 shines(node.transform * glm::dvec4(0, 0, -1, 0));
            EXPECT_LT(glm::length(shines - wanted[node.light]), 1e-12);
        }
}

TEST(SceneValues, CamerasStandAndLookAsTheFileSays) {
    const prep::Scene scene = scene_of(R"("camera": {"position": [1, 2, 3], "target": [1, 2, -4],
        "up": [1, 0, 0], "fov": 30, "near": 0.5, "far": 90})")
                                  .scene;
    ASSERT_EQ(scene.cameras.size(), 1u);
    const prep::Camera& camera = scene.cameras[0];
    EXPECT_TRUE(camera.perspective);
    EXPECT_NEAR(camera.yfov, pi / 6, 1e-15);
    EXPECT_EQ(camera.znear, 0.5);
    EXPECT_EQ(camera.zfar, 90);
    const glm::dmat4& m = scene.nodes[scene.active_camera].transform;
    EXPECT_EQ(m[3], glm::dvec4(1, 2, 3, 1));
    EXPECT_LT(glm::length(m[2] - glm::dvec4(0, 0, 1, 0)), 1e-15);   // looks along −Z
    EXPECT_LT(glm::length(m[1] - glm::dvec4(1, 0, 0, 0)), 1e-15);   // its up
    EXPECT_LT(glm::length(m[0] - glm::dvec4(0, -1, 0, 0)), 1e-15);  // its right: up × back
}

TEST(SceneValues, OrthographicHeightsAreWhole) {
    const prep::Scene scene =
        scene_of(R"("camera": {"position": [0, 0, 5], "target": [0, 0, 0], "height": 3})").scene;
    EXPECT_FALSE(scene.cameras[0].perspective);
    EXPECT_EQ(scene.cameras[0].ymag, 1.5);  // half extents
    EXPECT_EQ(scene.cameras[0].xmag, 0) << "no width is named";
    EXPECT_EQ(scene.cameras[0].zfar, 0);
}

TEST(SceneValues, OrbitsAreInDegrees) {
    const prep::OrbitCamera orbit =
        scene_of(R"("camera": {"orbit": {"azimuth": 90, "elevation": -45, "distance": 2.5}})")
            .orbit.value();
    EXPECT_NEAR(orbit.azimuth, pi / 2, 1e-12);
    EXPECT_NEAR(orbit.elevation, -pi / 4, 1e-12);
    EXPECT_EQ(orbit.distance, 2.5);
    EXPECT_FALSE(orbit.yfov || orbit.height || orbit.znear || orbit.zfar);
}

TEST(SceneValues, OrbitsHaveTheirLens) {
    const prep::OrbitCamera seen =
        scene_of(R"("camera": {"orbit": {}, "fov": 30, "near": 0.25, "far": 8})").orbit.value();
    EXPECT_NEAR(seen.yfov.value(), pi / 6, 1e-15);
    EXPECT_EQ(seen.znear, 0.25);
    EXPECT_EQ(seen.zfar, 8);
    EXPECT_FALSE(seen.height);
    const prep::OrbitCamera flat =
        scene_of(R"("camera": {"orbit": {}, "height": 3})").orbit.value();
    EXPECT_EQ(flat.height, 3);
    EXPECT_FALSE(flat.yfov || flat.znear || flat.zfar);
}

TEST(SceneValues, MaterialsAreAsTheFileSays) {
    const prep::Scene scene =
        scene_of(R"("materials": {"m": {"diffuse": "#FFAB0c", "specular": 0.25,
        "ambient": [0.5, 0.25, 0.125], "emissive": [2, 0, 1], "shininess": 77, "opacity": 0.375,
        "alpha_mode": "mask", "alpha_cutoff": 0.75, "double_sided": true, "unlit": true,
        "normal_map_space": "object", "normal_map_flip_green": true},
        "b": {"alpha_mode": "blend"}})")
            .scene;
    ASSERT_EQ(scene.materials.size(), 2u);
    const prep::Material& m = scene.materials[scene.materials[0].name == "m" ? 0 : 1];
    const auto linear = [](int level) {  // IEC 61966-2-1
        return std::pow((level / 255.0 + 0.055) / 1.055, 2.4);
    };
    EXPECT_EQ(m.diffuse.r, 1);
    EXPECT_NEAR(m.diffuse.g, linear(0xab), 1e-6);
    EXPECT_NEAR(m.diffuse.b, 12 / 255.0 / 12.92 > 0.0031308 ? linear(12) : 12 / 255.0 / 12.92,
                1e-6);
    EXPECT_EQ(m.diffuse.a, 0.375f);
    EXPECT_EQ(m.specular, glm::vec3(0.25f));
    EXPECT_EQ(m.ambient, glm::vec3(0.5f, 0.25f, 0.125f));
    EXPECT_EQ(m.emissive, glm::vec3(2, 0, 1));
    EXPECT_EQ(m.shininess, 77);
    EXPECT_EQ(m.alpha_mode, prep::AlphaMode::mask);
    EXPECT_EQ(m.alpha_cutoff, 0.75f);
    EXPECT_TRUE(m.double_sided && m.unlit && m.normal_map_flip_green);
    EXPECT_EQ(m.normal_map_space, prep::NormalMapSpace::object);
    EXPECT_EQ(scene.materials[scene.materials[0].name == "m" ? 1 : 0].alpha_mode,
              prep::AlphaMode::blend);
}

TEST(SceneValues, TexturesAndMapsAreAsTheFileSays) {
    const test::TempDir dir;
    for (const char* name : {"a.png", "b.png"}) test::write_text(dir / name, "no picture yet");
    const prep::Scene scene = load(dir, R"({"meshprep": 1,
        "textures": {"a": {"file": "a.png", "wrap_u": "mirror", "wrap_v": "clamp", "mag": "nearest",
            "mip": "none"}, "b": {"file": "b.png", "wrap": "border", "min": "nearest",
            "mip": "nearest"}},
        "materials": {"m": {"diffuse_map": {"texture": "b", "uv_set": 1, "offset": [0.25, 0.5],
            "scale": [2, 3], "rotate": 90}, "specular_map": "a",
            "emissive_map": "b", "occlusion_map": {"texture": "a", "strength": 0.5}, "normal_map": "b", "bump_map": "a",
            "displacement_map": "b", "displacement_scale": -0.25, "displacement_midlevel": 0.75,
            "displacement_kind": "vector-object"}},
        "meshes": {"box": {"shape": {"kind": "box"}, "material": "m"}}})");
    ASSERT_EQ(scene.textures.size(), 2u);
    const std::uint32_t a = scene.images[scene.textures[0].image].name == "a" ? 0 : 1, b = 1 - a;
    EXPECT_EQ(scene.images[scene.textures[b].image].path, dir / "b.png");
    EXPECT_EQ(scene.textures[a].wrap_u, prep::Wrap::mirror);
    EXPECT_EQ(scene.textures[a].wrap_v, prep::Wrap::clamp);
    EXPECT_EQ(scene.textures[a].mag, prep::Filter::nearest);
    EXPECT_EQ(scene.textures[a].min, prep::Filter::linear);
    EXPECT_EQ(scene.textures[a].mip, prep::MipFilter::none);
    EXPECT_EQ(scene.textures[b].wrap_u, prep::Wrap::border);
    EXPECT_EQ(scene.textures[b].wrap_v, prep::Wrap::border);
    EXPECT_EQ(scene.textures[b].mag, prep::Filter::linear);
    EXPECT_EQ(scene.textures[b].min, prep::Filter::nearest);
    EXPECT_EQ(scene.textures[b].mip, prep::MipFilter::nearest);
    const prep::Material& m = scene.materials[0];
    EXPECT_EQ(m.diffuse_map.texture, b);
    EXPECT_EQ(m.diffuse_map.uv_set, 1u);
    EXPECT_EQ(m.diffuse_map.offset, glm::vec2(0.25f, 0.5f));
    EXPECT_EQ(m.diffuse_map.scale, glm::vec2(2, 3));
    EXPECT_FLOAT_EQ(m.diffuse_map.rotation, float(pi / 2));
    EXPECT_EQ(m.diffuse_map.strength, 1.0f);
    EXPECT_EQ(m.occlusion_map.strength, 0.5f);
    EXPECT_EQ(m.specular_map.texture, a);
    EXPECT_EQ(m.emissive_map.texture, b);
    EXPECT_EQ(m.occlusion_map.texture, a);
    EXPECT_EQ(m.normal_map.texture, b);
    EXPECT_EQ(m.bump_map.texture, a);
    EXPECT_EQ(m.displacement_map.texture, b);
    EXPECT_EQ(m.displacement_scale, -0.25f);
    EXPECT_EQ(m.displacement_midlevel, 0.75f);
    EXPECT_EQ(m.displacement_kind, prep::DisplacementKind::vector_object);
    EXPECT_EQ(scene.meshes[0].face_materials, std::vector<std::uint32_t>(6, 0));
}

TEST(SceneValues, MatricesAreByColumnsAndOneScaleIsForAllAxes) {
    const prep::Scene scene = scene_of(R"("nodes": [
        {"mesh": "box", "matrix": [0,2,0,0, -3,0,0,0, 0,0,4,0, 5,6,7,1]},
        {"mesh": "box", "scale": 2}, {"mesh": "box", "scale": [2, 3, 4]}])")
                                  .scene;
    const auto moved = [&](std::size_t n) {
        return glm::dvec3(scene.nodes[n].transform * glm::dvec4(1, 10, 100, 1));
    };
    EXPECT_EQ(moved(0), glm::dvec3(5 - 30, 6 + 2, 7 + 400));
    EXPECT_EQ(moved(1), glm::dvec3(2, 20, 200));
    EXPECT_EQ(moved(2), glm::dvec3(2, 30, 400));
}

// Two mesh files with libraries of their own; the scene brings a material and a texture, too.
TEST(SceneValues, MeshFilesKeepTheirMaterialsAndTextures) {
    const test::TempDir dir;
    test::write_text(dir / "own.png", "no picture yet");
    for (const std::string name : {"a", "b"}) {
        test::write_text(dir / (name + ".mtl"), "newmtl one\nmap_Kd " + name +
                                                    "1.png\nmap_Ke shine.png\nnewmtl two\nmap_Kd " +
                                                    name + "2.png\n");
        test::write_text(dir / (name + ".obj"), "mtllib " + name +
                                                    ".mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                                    "usemtl two\nf 1 2 3\nusemtl one\nf 3 2 1\n");
    }
    const std::string head = R"({"meshprep": 1, "textures": {"t": {"file": "own.png"}},
        "materials": {"mine": {"diffuse_map": "t"}}, "meshes": {"a": {"file": "a.obj"}, "b": )";
    const auto picture = [](const prep::Scene& scene, std::size_t mesh, std::size_t face) {
        const auto& material = scene.materials[scene.meshes[mesh].face_materials.at(face)];
        const auto texture = material.diffuse_map.texture;
        return scene.images.at(scene.textures.at(texture).image).path.filename().string();
    };
    const prep::Scene scene = load(dir, head + R"({"file": "b.obj"}}})");
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(picture(scene, 0, 0), "a2.png");
    EXPECT_EQ(picture(scene, 0, 1), "a1.png");
    EXPECT_EQ(picture(scene, 1, 0), "b2.png");
    EXPECT_EQ(picture(scene, 1, 1), "b1.png");

    const prep::Scene replaced =
        load(dir, head + R"({"file": "b.obj", "materials": {"one": "mine"}}}})");
    EXPECT_EQ(picture(replaced, 0, 1), "a1.png");  // the other file's keeps its own
    EXPECT_EQ(picture(replaced, 1, 0), "b2.png");
    EXPECT_EQ(picture(replaced, 1, 1), "own.png");

    const prep::Scene all = load(dir, head + R"({"file": "b.obj", "material": "mine"}}})");
    EXPECT_EQ(picture(all, 0, 0), "a2.png");
    EXPECT_EQ(picture(all, 1, 0), "own.png");
    EXPECT_EQ(picture(all, 1, 1), "own.png");
}

// A glTF of two nodes, one below the other, twice in the scene: once below a node that is moved.
TEST(SceneValues, NodesOfMeshFilesStayBelowTheirParents) {
    const test::TempDir dir;
    test::write_text(dir / "t.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
        "nodes": [{"translation": [0, 10, 0], "children": [1]}, {"mesh": 0,
        "translation": [0, 0, 100]}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
        "min": [0, 0, 0], "max": [1, 1, 0]}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,)"
                                     R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
    const prep::Scene scene = load(dir, R"({"meshprep": 1, "meshes": {"t": {"file": "t.gltf"}},
        "nodes": [{"name": "p", "translate": [1, 0, 0]},
                  {"mesh": "t", "parent": "p", "scale": 2}, {"mesh": "t"}]})");
    const auto world = prep::world_transforms(scene);
    std::vector<glm::dvec3> places;
    for (std::size_t n = 0; n < scene.nodes.size(); ++n)
        if (scene.nodes[n].mesh != prep::no_index) places.push_back(glm::dvec3(world[n][3]));
    EXPECT_EQ(places, (std::vector<glm::dvec3>{{1, 20, 200}, {0, 10, 100}}));
}

TEST(SceneMessages, PointersEscapeTheirKeys) {
    const auto scene = parse(R"("a~b": 1)");
    ASSERT_FALSE(scene.has_value());
    EXPECT_EQ(scene.error().place, "nowhere/s.json#/a~0b");
}

TEST(SceneMessages, SuggestWhatIsNear) {
    const auto said = [](const std::string& asked) {
        const auto scene = prep::parse_scene_json(
            R"({"meshprep": 1, "materials": {"red": {}, "goldleaf": {}}, "meshes":
                {"box": {"shape": {"kind": "box"}, "material": ")" +
                asked + "\"}}}",
            "s.json");
        EXPECT_FALSE(scene.has_value());
        return scene ? std::string() : scene.error().text;
    };
    const auto suggests = [&](const std::string& asked, const std::string& name) {
        return said(asked).find("did you mean '" + name + "'?") != std::string::npos;
    };
    EXPECT_TRUE(suggests("rde", "red"));  // two letters swapped are one error of three
    EXPECT_TRUE(suggests("RED", "red"));
    EXPECT_TRUE(suggests("goldlaef", "goldleaf"));
    EXPECT_TRUE(suggests("gldlef", "goldleaf"));
    // Half of another word is no slip: all names are told instead.
    EXPECT_NE(said("gilded").find("; known: goldleaf, red"), std::string::npos) << said("gilded");
    EXPECT_NE(said("rod's").find("; known: "), std::string::npos) << said("rod's");
}

}  // namespace
