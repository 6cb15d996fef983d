// What a glTF file says beside its meshes: nodes, lights, cameras, skins, animations, scenes.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "gltf_maker.h"
#include "mesh_files.h"

namespace {

using Floats = std::vector<float>;
using Json = test::GltfMaker::Json;
using test::GltfMaker;

prep::Scene read(const GltfMaker& maker) {
    auto scene = maker.read();
    EXPECT_TRUE(scene) << test::error_of(scene);
    return scene ? *std::move(scene) : prep::Scene();
}

void expect_error(const GltfMaker& maker, const std::string& place, const std::string& text = "") {
    const std::string found = test::error_of(maker.read());
    EXPECT_NE(found.find("#" + place), std::string::npos) << place << ": " << found;
    EXPECT_NE(found.find(text), std::string::npos) << found;
}

glm::dmat4 transform(const Json& node) {
    GltfMaker maker;
    maker.root(node);
    const prep::Scene scene = read(maker);
    return scene.nodes.empty() ? glm::dmat4(0) : scene.nodes[0].transform;
}

void expect_takes(const glm::dmat4& m, const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec4 found = m * glm::dvec4(from, 1);
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(found[k], to[k], 1e-12)
            << "(" << from.x << ", " << from.y << ", " << from.z << ") [" << k << "]";
}

// --- nodes -----------------------------------------------------------------------------------

TEST(GltfNodes, RotationsAreUnitQuaternionsWithTheScalarLast) {
    const double s = std::sqrt(0.5);
    const glm::dmat4 x = transform({{"rotation", {s, 0, 0, s}}}),
                     y = transform({{"rotation", {0, s, 0, s}}}),
                     z = transform({{"rotation", {0, 0, s, s}}});
    // A quarter turn, right-handed.
    expect_takes(x, {0, 1, 0}, {0, 0, 1});
    expect_takes(x, {0, 0, 1}, {0, -1, 0});
    expect_takes(y, {0, 0, 1}, {1, 0, 0});
    expect_takes(y, {1, 0, 0}, {0, 0, -1});
    expect_takes(z, {1, 0, 0}, {0, 1, 0});
    expect_takes(z, {0, 1, 0}, {-1, 0, 0});
    const glm::dmat4 all = transform({{"rotation", {0.5, 0.5, 0.5, 0.5}}});
    expect_takes(all, {1, 2, 3}, {3, 1, 2});
}

TEST(GltfNodes, RotationsThatAreNotUnitDoNotScale) {
    expect_takes(transform({{"rotation", {1, 1, 1, 1}}}), {1, 2, 3}, {3, 1, 2});
    expect_takes(transform({{"rotation", {0.25, 0, 0, 0.25}}}), {1, 1, 0}, {1, 0, 1});
}

TEST(GltfNodes, ScaleComesFirstThenRotationThenTranslation) {
    const double s = std::sqrt(0.5);
    const glm::dmat4 m = transform(
        {{"translation", {10, 20, 30}}, {"rotation", {0, 0, s, s}}, {"scale", {2, 3, -4}}});
    expect_takes(m, {0, 0, 0}, {10, 20, 30});
    expect_takes(m, {1, 0, 0}, {10, 22, 30});
    expect_takes(m, {0, 1, 0}, {7, 20, 30});
    expect_takes(m, {0, 0, 1}, {10, 20, 26});
}

TEST(GltfNodes, MatricesAreByColumns) {
    const glm::dmat4 m =
        transform({{"matrix", {1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 10, 0, 11, 12, 13, 1}}});
    expect_takes(m, {1, 0, 0}, {12, 14, 16});
    expect_takes(m, {0, 1, 0}, {15, 17, 19});
    expect_takes(m, {0, 0, 1}, {18, 20, 23});
    expect_takes(m, {0, 0, 0}, {11, 12, 13});
    GltfMaker both;
    both.root({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}, {"scale", {1, 1, 1}}});
    expect_error(both, "/nodes/0/matrix", "a matrix and a scale");
}

TEST(GltfNodes, ChildrenStandInTheirParentsSpace) {
    GltfMaker maker;
    maker.push("nodes", {{"translation", {1, 0, 0}}});
    const double s = std::sqrt(0.5);
    maker.push("nodes", {{"rotation", {0, 0, s, s}}, {"children", {0}}});
    maker.root({{"translation", {0, 0, 5}}, {"scale", {2, 2, 2}}, {"children", {1}}});
    const prep::Scene scene = read(maker);
    ASSERT_EQ(scene.nodes.size(), 3u);
    EXPECT_EQ(scene.nodes[0].parent, 1u);
    EXPECT_EQ(scene.nodes[1].parent, 2u);
    EXPECT_EQ(scene.nodes[2].parent, prep::no_index);
    const std::vector<glm::dmat4> world = prep::world_transforms(scene);
    expect_takes(world[0], {0, 0, 0}, {0, 2, 5});
    expect_takes(world[0], {1, 0, 0}, {0, 4, 5});
    expect_takes(world[1], {1, 0, 0}, {0, 2, 5});
}

TEST(GltfNodes, HaveOneParentAndAreNotTheirOwnAncestors) {
    GltfMaker twice;
    twice.push("nodes", Json::object());
    twice.push("nodes", {{"children", {0}}});
    twice.push("nodes", {{"children", {0}}});
    expect_error(twice, "/nodes/2/children/0", "another parent: 1");
    GltfMaker circle;
    circle.push("nodes", {{"children", {1}}});
    circle.push("nodes", {{"children", {2}}});
    circle.push("nodes", {{"children", {0}}});
    expect_error(circle, "/nodes/0", "its own ancestor");
    GltfMaker beyond;
    beyond.push("nodes", {{"children", {1}}});
    expect_error(beyond, "/nodes/0/children/0", "has 1 entries");
}

// --- scenes ----------------------------------------------------------------------------------

GltfMaker with_triangle() {
    GltfMaker maker;
    const std::size_t positions = maker.accessor(Floats{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    maker.push("meshes", {{"primitives", {{{"attributes", {{"POSITION", positions}}}}}}});
    return maker;
}

TEST(GltfScenes, OnlyNodesOfTheChosenSceneShowWhatTheyHave) {
    GltfMaker maker = with_triangle();
    maker.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}});
    maker.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    Json everything{{"mesh", 0}, {"camera", 0}};
    everything["extensions"]["KHR_lights_punctual"]["light"] = 0;
    for (int n = 0; n < 4; ++n) maker.push("nodes", everything);  // 3 is below 1
    maker.json["nodes"][1]["children"] = {3};
    maker.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
    const auto shown = [&] {
        const prep::Scene scene = read(maker);
        std::vector<std::uint32_t> nodes;
        for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
            const prep::Node& node = scene.nodes[n];
            EXPECT_EQ(node.mesh, node.camera);
            EXPECT_EQ(node.mesh, node.light);
            if (node.mesh == 0) nodes.push_back(n);
        }
        EXPECT_EQ(scene.active_camera, nodes.empty() ? prep::no_index : nodes[0]);
        return nodes;
    };
    using Nodes = std::vector<std::uint32_t>;
    EXPECT_EQ(shown(), (Nodes{0})) << "the first scene, where none is chosen";
    maker.json["scene"] = 1;
    EXPECT_EQ(shown(), (Nodes{1, 3}));
    maker.json.erase("scene");
    maker.json.erase("scenes");
    EXPECT_EQ(shown(), (Nodes{0, 1, 2, 3})) << "no scenes at all";
    maker.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {3}}}};
    expect_error(maker, "/scenes/1/nodes/0", "not a root");
    maker.json["scenes"] = {{{"nodes", {0}}}};
    maker.json["scene"] = 1;
    expect_error(maker, "/scene", "has 1 entries");
}

TEST(GltfScenes, ExtensionsThatAreRequiredAndNotReadAreRefused) {
    GltfMaker maker = with_triangle();
    maker.json["extensionsRequired"] = {"KHR_texture_transform", "EXT_not_there"};
    expect_error(maker, "/extensionsRequired/1", "EXT_not_there");
    maker.json["extensionsRequired"] = {"KHR_texture_transform", "KHR_lights_punctual"};
    read(maker);
    maker.json["extensionsUsed"] = {"EXT_not_there"};
    read(maker);
}

// --- lights and cameras ----------------------------------------------------------------------

TEST(GltfLights, EveryMemberIsRead) {
    GltfMaker maker;
    maker.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::parse(R"([
        {"type": "spot", "name": "s", "color": [0.1, 0.2, 0.3], "intensity": 40, "range": 50,
         "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.75}},
        {"type": "spot", "spot": {}},
        {"type": "directional", "color": [0.5, 0, 1], "intensity": 0},
        {"type": "point", "range": 7}])");
    Json node;
    node["extensions"]["KHR_lights_punctual"]["light"] = 3;
    maker.root(node);
    const prep::Scene scene = read(maker);
    ASSERT_EQ(scene.lights.size(), 4u);
    EXPECT_EQ(scene.nodes[0].light, 3u);
    const prep::Light& spot = scene.lights[0];
    EXPECT_EQ(spot.name, "s");
    EXPECT_EQ(spot.kind, prep::LightKind::spot);
    EXPECT_EQ(spot.color, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(spot.intensity, 40);
    EXPECT_EQ(spot.range, 50);
    EXPECT_EQ(spot.inner_cone, 0.25f);
    EXPECT_EQ(spot.outer_cone, 0.75f);
    const prep::Light& plain = scene.lights[1];
    EXPECT_EQ(plain.color, glm::vec3(1));
    EXPECT_EQ(plain.intensity, 1);
    EXPECT_EQ(plain.range, 0) << "no limit";
    EXPECT_EQ(plain.inner_cone, 0);
    EXPECT_FLOAT_EQ(plain.outer_cone, std::numbers::pi_v<float> / 4);
    EXPECT_EQ(scene.lights[2].kind, prep::LightKind::directional);
    EXPECT_EQ(scene.lights[2].color, glm::vec3(0.5f, 0, 1));
    EXPECT_EQ(scene.lights[2].intensity, 0);
    EXPECT_EQ(scene.lights[3].kind, prep::LightKind::point);
    EXPECT_EQ(scene.lights[3].range, 7);
    maker.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 4;
    expect_error(maker, "/nodes/0/extensions/KHR_lights_punctual/light");
    maker.json["extensions"]["KHR_lights_punctual"]["lights"][1]["type"] = "ambient";
    expect_error(maker, "/extensions/KHR_lights_punctual/lights/1/type");
}

TEST(GltfCameras, EveryMemberIsRead) {
    GltfMaker maker;
    maker.json["cameras"] = Json::parse(R"([
        {"type": "perspective", "name": "p",
         "perspective": {"yfov": 0.7, "aspectRatio": 1.5, "znear": 0.25, "zfar": 90}},
        {"type": "perspective", "perspective": {"yfov": 1.1, "znear": 2}},
        {"type": "orthographic",
         "orthographic": {"xmag": 3, "ymag": -4, "znear": 0, "zfar": 5}},
        {"type": "perspective", "perspective": {"yfov": 3.2, "znear": 1}}])");
    const prep::Scene scene = read(maker);
    ASSERT_EQ(scene.cameras.size(), 4u);
    const prep::Camera &p = scene.cameras[0], &endless = scene.cameras[1], &flat = scene.cameras[2],
                       &wide = scene.cameras[3];
    EXPECT_EQ(p.name, "p");
    EXPECT_TRUE(p.perspective);
    EXPECT_EQ(p.yfov, 0.7);
    EXPECT_EQ(p.aspect, 1.5);
    EXPECT_EQ(p.znear, 0.25);
    EXPECT_EQ(p.zfar, 90);
    EXPECT_EQ(endless.yfov, 1.1);
    EXPECT_EQ(endless.aspect, 0) << "the picture's";
    EXPECT_EQ(endless.znear, 2);
    EXPECT_EQ(endless.zfar, 0) << "infinite";
    EXPECT_FALSE(flat.perspective);
    EXPECT_EQ(flat.xmag, 3);
    EXPECT_EQ(flat.ymag, -4);
    EXPECT_EQ(flat.znear, 0);
    EXPECT_EQ(flat.zfar, 5);
    EXPECT_LT(wide.yfov, std::numbers::pi) << "a picture this wide has no edge";
    EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(GltfCameras, NumbersThatMakeNoPictureAreRefusedAtTheirPlace) {
    const auto refused = [](const char* kind, const char* lens, const std::string& key) {
        GltfMaker maker;
        maker.push("cameras", {{"type", kind}, {kind, Json::parse(lens)}});
        expect_error(maker, "/cameras/0/" + std::string(kind) + "/" + key);
    };
    refused("perspective", R"({"znear": 1})", "yfov");
    refused("perspective", R"({"yfov": 0, "znear": 1})", "yfov");
    refused("perspective", R"({"yfov": 1, "znear": 0})", "znear");
    refused("perspective", R"({"yfov": 1, "znear": 1, "zfar": 1})", "zfar");
    refused("perspective", R"({"yfov": 1, "znear": 1, "aspectRatio": 0})", "aspectRatio");
    refused("orthographic", R"({"xmag": 0, "ymag": 1, "znear": 0, "zfar": 1})", "xmag");
    refused("orthographic", R"({"xmag": 1, "ymag": 0, "znear": 0, "zfar": 1})", "ymag");
    refused("orthographic", R"({"xmag": 1, "ymag": 1, "znear": 2, "zfar": 2})", "zfar");
    refused("orthographic", R"({"xmag": 1, "ymag": 1, "znear": 0})", "zfar");
}

// --- skins and animations --------------------------------------------------------------------

// Three joints whose inverse bind matrices hold 0 … 47; two sets of joints and weights.
struct Skinned {
    GltfMaker maker = with_triangle();
    std::size_t matrices = 0;

    Skinned(std::uint8_t joint, std::uint8_t weight, std::uint16_t second_joint,
            float second_weight) {
        for (int n = 0; n < 3; ++n) maker.root({{"translation", {n, 0, 0}}});
        maker.root({{"mesh", 0}, {"skin", 0}});
        Floats values;
        for (int i = 0; i < 48; ++i) values.push_back(float(i));
        matrices = maker.accessor(values, "MAT4");
        maker.push("skins",
                   {{"name", "bones"}, {"joints", {2, 0, 1}}, {"inverseBindMatrices", matrices}});
        Json& attributes = maker.json["meshes"][0]["primitives"][0]["attributes"];
        std::vector<std::uint8_t> joints(12), weights(12);
        std::vector<std::uint16_t> second_joints(12);
        Floats second_weights(12);
        joints[9] = joint, weights[9] = weight;
        second_joints[6] = second_joint, second_weights[6] = second_weight;
        attributes["JOINTS_0"] = maker.accessor(joints, "VEC4");
        attributes["WEIGHTS_0"] = maker.accessor(weights, "VEC4", true);
        attributes["JOINTS_1"] = maker.accessor(second_joints, "VEC4");
        attributes["WEIGHTS_1"] = maker.accessor(second_weights, "VEC4");
    }
};

TEST(GltfSkins, JointsKeepTheirOrderAndMatricesTheirColumns) {
    Skinned skinned(2, 255, 2, 1);
    const prep::Scene scene = read(skinned.maker);
    ASSERT_EQ(scene.skins.size(), 1u);
    const prep::Skin& skin = scene.skins[0];
    EXPECT_EQ(skin.name, "bones");
    EXPECT_EQ(skin.joints, (std::vector<std::uint32_t>{2, 0, 1}));
    ASSERT_EQ(skin.inverse_bind.size(), 3u);
    for (int j = 0; j < 3; ++j)
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r)
                EXPECT_EQ(skin.inverse_bind[std::size_t(j)][c][r], float(16 * j + 4 * c + r));
    EXPECT_EQ(scene.nodes[3].skin, 0u);
    skinned.maker.json["skins"][0].erase("inverseBindMatrices");
    const prep::Scene without = read(skinned.maker);
    EXPECT_EQ(without.skins.at(0).inverse_bind, std::vector<glm::mat4>(3, glm::mat4(1)));
}

TEST(GltfSkins, MatricesAreThereForEveryJoint) {
    Skinned skinned(0, 255, 0, 0);
    skinned.maker.json["accessors"][skinned.matrices]["count"] = 2;
    expect_error(skinned.maker, "/skins/0/inverseBindMatrices", "each of 3 joints");
}

TEST(GltfSkins, JointsWithWeightAreJointsOfTheSkin) {
    const std::string place = "/meshes/0/primitives/0/attributes/JOINTS_";
    read(Skinned(2, 255, 2, 0.5f).maker);
    expect_error(Skinned(3, 255, 0, 0).maker, place + "0", "joint 3 is used");
    expect_error(Skinned(0, 255, 3, 0.5f).maker, place + "1", "joint 3 is used");
    // Without weight a joint's number means nothing; each set has weights of its own.
    read(Skinned(3, 0, 9, 0).maker);
}

GltfMaker animated(const std::string& path, const char* type) {
    GltfMaker maker = with_triangle();
    maker.root({{"mesh", 0}});
    const std::size_t input = maker.accessor(Floats{0, 1}, "SCALAR");
    const std::size_t output =
        maker.accessor(Floats(2 * std::size_t(type[0] == 'V' ? type[3] - '0' : 1)), type);
    Json animation;
    animation["samplers"] = {{{"input", input}, {"output", output}}};
    animation["channels"] = {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}};
    maker.push("animations", animation);
    return maker;
}

TEST(GltfAnimations, ValuesHaveTheTypeOfTheirPath) {
    const std::pair<const char*, const char*> right[] = {{"translation", "VEC3"},
                                                         {"rotation", "VEC4"},
                                                         {"scale", "VEC3"},
                                                         {"weights", "SCALAR"},
                                                         {"pointer", "VEC2"}};
    for (const auto& [path, type] : right) {
        EXPECT_EQ(test::error_of(animated(path, type).read()), "no error") << path;
        if (path != std::string("pointer"))
            expect_error(animated(path, "VEC2"), "/animations/0/channels/0/sampler",
                         "has \"VEC2\"");
    }
    expect_error(animated("rotation", "VEC3"), "/animations/0/channels/0/sampler");
    expect_error(animated("scale", "VEC4"), "/animations/0/channels/0/sampler");
}

TEST(GltfAnimations, ReferencesLeadSomewhere) {
    const auto refused = [](const char* pointer, const Json& value, const std::string& place) {
        GltfMaker maker = animated("translation", "VEC3");
        maker.json["animations"][0][Json::json_pointer(pointer)] = value;
        expect_error(maker, "/animations/0" + place);
    };
    refused("/samplers/0/input", 99, "/samplers/0/input");
    refused("/samplers/0/input", 0, "/samplers/0/input");  // VEC3: positions
    refused("/samplers/0/output", 99, "/samplers/0/output");
    refused("/channels/0/sampler", 1, "/channels/0/sampler");
    refused("/channels/0/target/node", 1, "/channels/0/target/node");
    refused("/channels/0/target/path", 1, "/channels/0/target/path");
    refused("/channels", Json::array(), "/channels");
}

}  // namespace
