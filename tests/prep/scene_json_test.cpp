#include "prep/scene_json.h"

#include <gtest/gtest.h>

#include <numbers>

namespace {

using prep::ErrorCode;

prep::Result<prep::JsonScene> parse(const std::string& text) {
    return prep::parse_scene_json(text, "nowhere/s.json");
}

// What stands around the part that a test is about.
std::string with(const std::string& rest) {
    return R"({"meshprep": 1, "meshes": {"a": {"shape": {"kind": "box"}}}, )" + rest + "}";
}

struct Refusal {
    std::string text;
    ErrorCode code;
    const char* place;  // after "nowhere/s.json"
    const char* says;
};

void expect(const Refusal& r) {
    const auto scene = parse(r.text);
    ASSERT_FALSE(scene.has_value()) << r.text;
    EXPECT_EQ(scene.error().code, r.code) << r.text;
    EXPECT_EQ(scene.error().place, std::string("nowhere/s.json") + r.place) << r.text;
    EXPECT_NE(scene.error().text.find(r.says), std::string::npos)
        << r.text << "\nsaid: " << scene.error().text;
}

TEST(SceneJson, ShapesHaveTheFacesAndAreaOfTheirKind) {
    const auto scene = parse(R"({"meshprep": 1, "meshes": {
        "1": {"shape": {"kind": "plane", "size": [2, 9, 3], "segments": 4, "rings": 5}},
        "2": {"shape": {"kind": "box", "size": [1, 2, 3]}},
        "3": {"shape": {"kind": "sphere", "segments": 8, "rings": 4}},
        "4": {"shape": {"kind": "cylinder", "segments": 7}},
        "5": {"shape": {"kind": "torus", "segments": 6, "rings": 5}}}})");
    ASSERT_TRUE(scene.has_value()) << to_string(scene.error());
    const auto& meshes = scene->scene.meshes;
    ASSERT_EQ(meshes.size(), 5u);
    const std::size_t faces[] = {20, 6, 32, 9, 30}, vertices[] = {30, 8, 26, 14, 30};
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(meshes[i].face_count(), faces[i]) << i;
        EXPECT_EQ(meshes[i].vertex_count(), vertices[i]) << i;
        EXPECT_EQ(meshes[i].uvs.size(), 1u) << i;
    }
    for (const glm::vec3& p : meshes[0].positions) {
        EXPECT_LE(std::abs(p.x), 1.0f);
        EXPECT_EQ(p.y, 0.0f);
        EXPECT_LE(std::abs(p.z), 1.5f);
    }
    EXPECT_EQ(scene->scene.nodes.size(), 5u);  // each mesh once
}

TEST(SceneJson, NodesAreScaledThenTurnedAboutXThenYThenZThenMoved) {
    const auto scene = parse(with(R"("nodes": [
        {"name": "p", "mesh": "a", "translate": [1, 2, 3], "rotate": [90, 90, 0], "scale": [1, 2, 4]},
        {"parent": "p", "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]}])"));
    ASSERT_TRUE(scene.has_value()) << to_string(scene.error());
    const glm::dmat4& m = scene->scene.nodes[0].transform;
    // (0, 1, 0) → scaled (0, 2, 0) → about X (0, 0, 2) → about Y (2, 0, 0) → (3, 2, 3).
    const glm::dvec4 p = m * glm::dvec4(0, 1, 0, 1);
    EXPECT_NEAR(p.x, 3, 1e-12);
    EXPECT_NEAR(p.y, 2, 1e-12);
    EXPECT_NEAR(p.z, 3, 1e-12);
    EXPECT_EQ(scene->scene.nodes[1].parent, 0u);
    EXPECT_EQ(scene->scene.nodes[1].transform[3], glm::dvec4(5, 6, 7, 1));
}

TEST(SceneJson, LightsAndCamerasLookAlongMinusZOfTheirNode) {
    const auto scene = parse(with(R"("lights": [
        {"kind": "spot", "position": [1, 2, 3], "direction": [0, -2, 0], "inner_cone": 10,
         "outer_cone": 30, "intensity": 5, "color": [1, 0.5, 0]}],
        "camera": {"position": [0, 0, 5], "target": [0, 0, 1], "height": 4, "near": 0.5, "far": 9})"));
    ASSERT_TRUE(scene.has_value()) << to_string(scene.error());
    const prep::Scene& s = scene->scene;
    ASSERT_EQ(s.lights.size(), 1u);
    EXPECT_FLOAT_EQ(s.lights[0].outer_cone, static_cast<float>(std::numbers::pi / 6));
    const prep::Node* spot = nullptr;
    for (const prep::Node& node : s.nodes)
        if (node.light == 0) spot = &node;
    ASSERT_NE(spot, nullptr);
    EXPECT_NEAR((spot->transform * glm::dvec4(0, 0, -1, 0)).y, -1, 1e-12);
    EXPECT_EQ(spot->transform[3], glm::dvec4(1, 2, 3, 1));
    ASSERT_EQ(s.cameras.size(), 1u);
    EXPECT_FALSE(s.cameras[0].perspective);
    EXPECT_EQ(s.cameras[0].ymag, 2);
    EXPECT_EQ(s.cameras[0].zfar, 9);
    const glm::dmat4& camera = s.nodes[s.active_camera].transform;
    EXPECT_NEAR((camera * glm::dvec4(0, 0, -1, 0)).z, -1, 1e-12);
}

TEST(SceneJson, ColoursAreSrgbTextLinearTriplesOrGrey) {
    const auto scene = parse(with(R"("materials": {"t": {"diffuse": "#ff8000"},
        "l": {"diffuse": [0.25, 0.5, 0.75], "opacity": 0.5}, "g": {"diffuse": 0.3}})"));
    ASSERT_TRUE(scene.has_value()) << to_string(scene.error());
    for (const prep::Material& m : scene->scene.materials) {
        if (m.name == "t") {
            EXPECT_EQ(m.diffuse.r, 1.0f);
            EXPECT_NEAR(m.diffuse.g, 0.2158605, 1e-6);  // IEC 61966-2-1 of 128/255
            EXPECT_EQ(m.diffuse.b, 0.0f);
        } else if (m.name == "l") {
            EXPECT_EQ(m.diffuse, glm::vec4(0.25f, 0.5f, 0.75f, 0.5f));
        } else if (m.name == "g") {
            EXPECT_EQ(m.diffuse, glm::vec4(0.3f, 0.3f, 0.3f, 1));
        }
    }
}

TEST(SceneJson, SaysWhereAndWhatIsNotJson) {
    expect({"{\"meshprep\": 1,\n  \"meshes\": }", ErrorCode::syntax, ":2:13", ""});
    expect({"", ErrorCode::syntax, ":1:1", ""});
    expect({R"({"meshprep": 1, "meshprep": 1})", ErrorCode::syntax, ":1:26", "meshprep"});
    expect({"[]", ErrorCode::invalid, "#", "not a meshprep scene"});
    expect({R"({"asset": {"version": "2.0"}})", ErrorCode::invalid, "#", "not a meshprep scene"});
}

TEST(SceneJson, SaysTheLineAndColumnOfEveryKindOfComplaint) {
    expect({"{\"meshprep\": 1,\n\n  \"a\": {\"x\": 1,\n \"x\": 2}}", ErrorCode::syntax, ":4:4",
            "the key 'x' is given twice"});
    expect({"{\"a\": {\"x\": 1}, \"b\": {\"x\": 1}} x", ErrorCode::syntax, ":1:32", ""});
    // What stands behind a NUL is part of the file.
    expect({std::string("{\"meshprep\": 1}\0 x", 18), ErrorCode::syntax, ":1:16", "NUL"});
    expect({std::string("{\"meshprep\": 1}\n\0", 17), ErrorCode::syntax, ":2:1", "NUL"});
    const auto vast = parse("{\"meshprep\": 1e999}");
    ASSERT_FALSE(vast.has_value());
    EXPECT_EQ(vast.error().text, "number overflow parsing '1e999'");
    const auto nested = [](std::size_t depth) {
        return "{\"comment\": " + std::string(depth, '[') + std::string(depth, ']') + "}";
    };
    // 64 levels, the outer object among them.
    EXPECT_EQ(parse(nested(63)).error().code, ErrorCode::invalid);
    const auto deep = parse(nested(64));
    ASSERT_FALSE(deep.has_value());
    EXPECT_EQ(deep.error().code, ErrorCode::syntax);
    EXPECT_EQ(deep.error().place, "nowhere/s.json:1:76");
    EXPECT_NE(deep.error().text.find("deeper than 64 levels"), std::string::npos);
}

TEST(SceneJson, BoundsAreInclusiveAndFiguresAreFinite) {
    const auto material = [](const std::string& rest) {
        return with(R"("materials": {"m": {)" + rest + "}}");
    };
    const auto fine = [&](const std::string& rest) {
        const auto scene = parse(material(rest));
        EXPECT_TRUE(scene.has_value()) << to_string(scene.error());
    };
    const auto refuse = [&](const std::string& rest, const char* place, const char* says) {
        const std::string text = material(rest);
        expect({text.c_str(), ErrorCode::invalid, place, says});
    };
    fine(R"("opacity": 0)");
    fine(R"("opacity": 1)");
    refuse(R"("opacity": -0.001)", "#/materials/m/opacity", "from 0 to 1, found -0.001");
    refuse(R"("opacity": 1.001)", "#/materials/m/opacity", "from 0 to 1, found 1.001");
    refuse(R"("opacity": null)", "#/materials/m/opacity", "found null");
    refuse(R"("opacity": [1, 2])", "#/materials/m/opacity", "found an array of 2");
    refuse(R"("opacity": {})", "#/materials/m/opacity", "found an object");
    refuse(R"("emissive": [1, 2])", "#/materials/m/emissive", "");
    refuse(R"("emissive": [1, 2, 3, 4])", "#/materials/m/emissive", "");
    refuse(R"("emissive": [1, 2, "3"])", "#/materials/m/emissive/2", "");
    refuse(R"("unlit": 1)", "#/materials/m/unlit", "true or false");
    refuse(R"("normal_map": "")", "#/materials/m/normal_map", "an empty one");
    refuse(R"("normal_map": ")" + std::string(41, 'x') + "\"", "#/materials/m/normal_map", "");
}

TEST(SceneJson, NumbersTooLargeForAFloatAreRefused) {
    const auto refuse = [](const std::string& rest, const char* place, const char* says) {
        const std::string text = with(rest);
        expect({text.c_str(), ErrorCode::invalid, place, says});
    };
    refuse(R"("nodes": [{"mesh": "a", "translate": [0, 1e39, 0]}])", "#/nodes/0/translate/1",
           "too large");
    refuse(R"("nodes": [{"mesh": "a", "translate": [0, 0]}])", "#/nodes/0/translate",
           "3 numbers, found an array of 2");
    refuse(R"("nodes": [{"mesh": "a", "translate": [0, 0, 0, 0]}])", "#/nodes/0/translate",
           "3 numbers, found an array of 4");
    refuse(R"("nodes": [{"mesh": 1}])", "#/nodes/0/mesh", "expected a string, found 1");
}

TEST(SceneJson, SaysWhereAndWhatContradictsTheFormat) {
    expect({R"({"meshprep": 2, "meshes": {"a": {"shape": {"kind": "box"}}}})",
            ErrorCode::unsupported, "#/meshprep", "version 2"});
    expect({R"({"meshprep": 1, "meshes": {}})", ErrorCode::invalid, "#", "no meshes"});
    expect({R"({"meshprep": 1, "meshs": {}})", ErrorCode::invalid, "#/meshs", "meshes"});
    expect({R"({"meshprep": 1, "meshes": {"a": {"shape": {"kind": "bax"}}}})", ErrorCode::invalid,
            "#/meshes/a/shape/kind", "box"});
    expect({R"({"meshprep": 1, "meshes": {"a": {"shape": {"kind": "sphere", "radius": -1}}}})",
            ErrorCode::invalid, "#/meshes/a/shape/radius", "-1"});
    expect({R"({"meshprep": 1, "meshes": {"a": {"shape": {"kind": "sphere", "radius": "1"}}}})",
            ErrorCode::invalid, "#/meshes/a/shape/radius", "number"});
    expect({R"({"meshprep": 1, "meshes": {"a": {"shape": {"kind": "box", "radius": 1}}}})",
            ErrorCode::invalid, "#/meshes/a/shape/radius", "no 'radius'"});
    expect({R"({"meshprep": 1, "meshes": {"a/b": {}}})", ErrorCode::invalid, "#/meshes/a~1b",
            "'file' or a 'shape'"});
    expect({R"({"meshprep": 1, "meshes": {"a": {"file": "x.obj", "shape": {"kind": "box"}}}})",
            ErrorCode::invalid, "#/meshes/a", "not both"});
    expect({R"({"meshprep": 1, "meshes": {"a": {"file": "x.obj"}}})", ErrorCode::io,
            "#/meshes/a/file", "x.obj"});
}

TEST(SceneJson, SaysWhichReferenceLeadsNowhereOrInACircle) {
    const auto refuse = [](const std::string& rest, const char* place, const char* says) {
        const std::string text = with(rest);
        expect({text.c_str(), ErrorCode::invalid, place, says});
    };
    refuse(R"("nodes": [{"mesh": "b"}])", "#/nodes/0/mesh", "'a'");
    refuse(R"("nodes": [{"name": "n", "parent": "m"}])", "#/nodes/0/parent", "no node");
    refuse(R"("nodes": [{"name": "n"}, {"name": "n"}])", "#/nodes/1/name", "too");
    refuse(R"("nodes": [{"name": "n", "parent": "m"}, {"name": "m", "parent": "n"}])",
           "#/nodes/0/parent", "its own ancestor");
    refuse(R"("nodes": [{"name": "n", "parent": "n"}])", "#/nodes/0/parent", "its own ancestor");
    refuse(R"("nodes": [{"matrix": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1], "scale": 2}])", "#/nodes/0",
           "either");
    refuse(R"("materials": {"m": {"normal_map": "t"}})", "#/materials/m/normal_map", "texture");
    refuse(R"("lights": [{"kind": "spot", "position": [0,0,0]}])", "#/lights/0", "direction");
    refuse(R"("lights": [{"kind": "directional", "direction": [0,0,0]}])", "#/lights/0/direction",
           "no length");
    refuse(R"("camera": {"position": [1,1,1], "target": [1,1,1]})", "#/camera/target", "stands");
    refuse(R"("camera": {"position": [0,9,0], "target": [0,0,0]})", "#/camera/up", "along");
    refuse(R"("camera": {"position": [0,0,1], "target": [0,0,0], "height": 2, "fov": 30})",
           "#/camera/fov", "perspective");
    refuse(R"("camera": {"position": [0,0,1], "target": [0,0,0], "near": 2, "far": 1})",
           "#/camera/far", "beyond");
}

TEST(SceneJson, OrbitsTakeALensAndNoPlace) {
    const auto refuse = [](const std::string& more, const char* place, const char* says) {
        const std::string text = with(R"("camera": {"orbit": {}, )" + more + "}");
        expect({text.c_str(), ErrorCode::invalid, place, says});
    };
    refuse(R"("position": [0,0,1])", "#/camera", "no position");
    refuse(R"("target": [0,0,1])", "#/camera", "no position");
    refuse(R"("up": [0,0,1])", "#/camera/up", "+Y");
    refuse(R"("fov": 30, "height": 2)", "#/camera/fov", "perspective");
    refuse(R"("near": 2, "far": 2)", "#/camera/far", "beyond");
}

// What nothing would read.
TEST(SceneJson, MapsWithoutAStrengthTakeNone) {
    for (const char* const map : {"diffuse_map", "specular_map", "emissive_map"}) {
        const std::string text = with(R"("materials": {"m": {")" + std::string(map) +
                                      R"(": {"texture": "t", "strength": 0.5}}})");
        const std::string place = "#/materials/m/" + std::string(map) + "/strength";
        expect({text.c_str(), ErrorCode::invalid, place.c_str(), "multiplies"});
    }
    const std::string text = with(R"("materials": {"m": {"normal_map_space": "object",
        "normal_map": {"texture": "t", "strength": 2}}})");
    expect({text.c_str(), ErrorCode::invalid, "#/materials/m/normal_map/strength", "object space"});
    // That of 1 changes nothing: what is missing here is the texture.
    const std::string whole =
        with(R"("materials": {"m": {"diffuse_map": {"texture": "t", "strength": 1}}})");
    expect({whole.c_str(), ErrorCode::invalid, "#/materials/m/diffuse_map/texture", "texture"});
    for (const char* const map : {"occlusion_map", "normal_map", "bump_map", "displacement_map"}) {
        const std::string good = with(R"("materials": {"m": {")" + std::string(map) +
                                      R"(": {"texture": "t", "strength": 0.5}}})");
        expect({good.c_str(), ErrorCode::invalid,
                ("#/materials/m/" + std::string(map) + "/texture").c_str(), "texture"});
    }
}

TEST(SceneJson, PicturesAskForWhatTheCommandOffers) {
    const auto refuse = [](const std::string& picture, const char* place, const char* says) {
        const std::string text = with("\"picture\": " + picture);
        expect({text.c_str(), ErrorCode::invalid, place, says});
    };
    refuse(R"({"samples": 3})", "#/picture/samples", "1, 2, 4, 8 or 16");
    refuse(R"({"samples": "4"})", "#/picture/samples", "1, 2, 4, 8 or 16");
    refuse(R"({"supersample": 17})", "#/picture/supersample", "16");
    refuse(R"({"supersample": 1.5})", "#/picture/supersample", "whole");
    refuse(R"({"max_anisotropy": 0})", "#/picture/max_anisotropy", "1");
    refuse(R"({"coverage": "areas"})", "#/picture/coverage", "area");
    refuse(R"({"coverage": "area", "samples": 4})", "#/picture/coverage", "samples");
    refuse(R"({"exposure": 0})", "#/picture/exposure", "1e-06");
}

TEST(SceneJson, ShapesHaveTheFewestPartsThatMakeThem) {
    const auto refuse = [](const std::string& shape, const char* place, const char* says) {
        const std::string text = R"({"meshprep": 1, "meshes": {"a": {"shape": )" + shape + "}}}";
        expect({text.c_str(), ErrorCode::invalid, place, says});
    };
    refuse(R"({"kind": "sphere", "segments": 2})", "#/meshes/a/shape/segments", "3 that make");
    refuse(R"({"kind": "cylinder", "segments": 1})", "#/meshes/a/shape/segments", "3 that make");
    refuse(R"({"kind": "sphere", "rings": 1})", "#/meshes/a/shape/rings", "2 that make");
    refuse(R"({"kind": "torus", "rings": 2})", "#/meshes/a/shape/rings", "3 that make");
    refuse(R"({"kind": "torus", "segments": 2})", "#/meshes/a/shape/segments", "3 that make");
}

TEST(SceneJson, GeneratedShapesAreLimitedTogether) {
    expect({R"({"meshprep": 1, "meshes": {"a": {"shape":
               {"kind": "sphere", "segments": 16777216, "rings": 2}}}})",
            ErrorCode::limit, "#/meshes/a/shape", "33554432 faces, over 2^24"});
    expect({R"({"meshprep": 1, "meshes": {"a": {"shape": {"kind": "plane", "segments": 64}},
               "b": {"shape": {"kind": "plane", "segments": 4096, "rings": 4096}}}})",
            ErrorCode::limit, "#/meshes/b/shape", "64 in the shapes before it"});
}

}  // namespace
