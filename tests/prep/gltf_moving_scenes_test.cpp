// Scenes that come from no glTF file, with skins, targets and animations: what is written, by the
// places that its vertices have.
#include <gtest/gtest.h>

#include <cmath>

#include "gltf_motion.h"
#include "gltf_source.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "written_gltf.h"

namespace {

using Json = test::GltfFile::Json;

// `columns` quads in a row, at x from 0 on, plus `far` along x.
prep::Mesh strip(std::uint32_t columns, double far) {
    prep::Mesh mesh;
    std::vector<glm::dvec3> points;
    for (std::uint32_t c = 0; c <= columns; ++c)
        for (int y = 0; y < 2; ++y) points.push_back({far + c + 0.1, y, 0});
    for (std::uint32_t c = 0; c < columns; ++c) {
        mesh.corner_vertices.insert(mesh.corner_vertices.end(),
                                    {2 * c, 2 * c + 2, 2 * c + 3, 2 * c + 1});
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    prep::set_positions(mesh, points);
    mesh.indexed_by_vertex = true;
    return mesh;
}

std::shared_ptr<const std::vector<float>> floats(std::vector<float> values) {
    return std::make_shared<const std::vector<float>>(std::move(values));
}

struct Written {
    explicit Written(prep::Scene scene) {
        auto prepared = prep::prepare(std::move(scene));
        EXPECT_TRUE(prepared);
        const auto saved = prep::save_scene(*prepared, dir / "a.glb");
        EXPECT_TRUE(saved) << prep::to_string(saved.error());
        notes = *saved;
        file.emplace(dir / "a.glb");
        EXPECT_EQ(file->fault(), "");
    }
    test::TempDir dir;
    std::vector<std::string> notes;
    std::optional<test::GltfFile> file;
};

// Every vertex of a mesh a million away has a joint that moves it by its own column number.
prep::Scene skinned(std::uint32_t columns, double far) {
    prep::Scene scene;
    scene.meshes.push_back(strip(columns, far));
    prep::Mesh& mesh = scene.meshes[0];
    prep::Node node;
    node.mesh = 0;
    node.skin = 0;
    scene.nodes.push_back(node);
    prep::Skin skin;
    prep::SkinInfluences set;
    for (std::uint32_t c = 0; c <= columns; ++c) {
        prep::Node joint;
        joint.trs = prep::Trs{};
        joint.trs->translation = {0, 0, c};
        joint.transform = joint.trs->matrix();
        skin.joints.push_back(std::uint32_t(scene.nodes.size()));
        skin.inverse_bind.emplace_back(1.0f);
        scene.nodes.push_back(joint);
        for (int y = 0; y < 2; ++y) {
            set.joints.push_back({c, 0, 0, 0});
            set.weights.push_back({3, 0, 0, 0});  // not normalised
        }
    }
    mesh.skin_influences.push_back(set);
    scene.skins.push_back(skin);
    return scene;
}

TEST(GltfMovingScenes, JointsBeyondAByteAndMeshesFarFromZero) {
    for (const double far : {0.0, 1e8}) {
        SCOPED_TRACE(far);
        prep::Scene scene = skinned(300, far);
        const glm::dvec3 origin = scene.meshes[0].origin;
        EXPECT_EQ(far != 0, origin != glm::dvec3(0.0));
        const Written written(std::move(scene));
        for (const auto& v : test::GltfMotion(*written.file).vertices(-1, 0)) {
            const double column = std::floor(v.world.x - far);
            EXPECT_EQ(v.world.z, column);
            EXPECT_NEAR(v.world.x, origin.x + double(v.base[0]), far * 1e-7);
        }
        const Json& attributes = written.file->primitive(0, 0)["attributes"];
        const std::size_t joints = attributes["JOINTS_0"];
        EXPECT_EQ(written.file->json["accessors"][joints]["componentType"], 5123);
    }
}

prep::Scene morphed(double far) {
    prep::Scene scene;
    scene.meshes.push_back(strip(40, far));
    prep::Mesh& mesh = scene.meshes[0];
    // One moves a vertex, which is written sparse; the other all, among them along y alone.
    mesh.morph_targets.resize(2);
    mesh.morph_targets[0].name = "one";
    mesh.morph_targets[0].positions = {
        {7, std::make_shared<const std::vector<glm::vec3>>(1, glm::vec3(0, 5, 0))}};
    mesh.morph_targets[1].name = "all";
    mesh.morph_targets[1].weight = 0.5f;
    mesh.morph_targets[1].positions = {
        {0, std::make_shared<const std::vector<glm::vec3>>(82, glm::vec3(0, 0, 2))}};
    prep::Node node;
    node.mesh = 0;
    node.trs = prep::Trs{};
    scene.nodes.push_back(node);
    prep::Animation animation;
    animation.samplers.push_back(
        {prep::Interpolation::linear, floats({0, 2}), floats({0, 0, 1, 0})});
    animation.samplers.push_back(
        {prep::Interpolation::linear, floats({0, 2}), floats({0, 0, 0, 10, 0, 0})});
    animation.channels.push_back({0, 0, prep::AnimationPath::weights});
    animation.channels.push_back({1, 0, prep::AnimationPath::translation});
    scene.animations.push_back(animation);
    return scene;
}

TEST(GltfMovingScenes, WeightsMoveTheMeshWhereverItsNodeIs) {
    for (const double far : {0.0, 1e8}) {
        SCOPED_TRACE(far);
        const Written written(morphed(far));
        EXPECT_TRUE(written.notes.empty());
        const test::GltfMotion motion(*written.file);
        const auto rest = motion.vertices(-1, 0), half = motion.vertices(0, 1);
        ASSERT_EQ(rest.size(), half.size());
        int moved = 0;
        for (std::size_t v = 0; v < rest.size(); ++v) {
            EXPECT_EQ(rest[v].world.z, 1);  // half of 2 at rest
            EXPECT_EQ(half[v].world.z, 0);
            EXPECT_NEAR(half[v].world.x - rest[v].world.x, 5, 1e-7 * (far + 1));
            moved += half[v].world.y - rest[v].world.y == 2.5;
        }
        EXPECT_EQ(moved, 1);
        const Json& mesh = written.file->json["meshes"][0];
        EXPECT_EQ(mesh["extras"]["targetNames"], Json({"one", "all"}));
        const std::size_t one = mesh["primitives"][0]["targets"][0]["POSITION"];
        EXPECT_TRUE(written.file->json["accessors"][one].contains("sparse"));
    }
}

TEST(GltfMovingScenes, WhatNamesNoNodeOrHasNoKeysIsLeftOutAndCounted) {
    prep::Scene scene = morphed(0);
    prep::Animation& animation = scene.animations[0];
    animation.channels.push_back({1, 99, prep::AnimationPath::translation});
    animation.channels.push_back({99, 0, prep::AnimationPath::scale});
    animation.samplers.push_back({});
    animation.channels.push_back({2, 0, prep::AnimationPath::scale});
    scene.nodes[0].skin = 0;
    scene.skins.push_back({"empty", {}, {}});
    const Written written(std::move(scene));
    EXPECT_EQ(written.notes, (std::vector<std::string>{
                                 "3 animation channels without keys or a node to move left out",
                                 "1 skin without joints, or of a mesh without weights, left out"}));
    EXPECT_EQ(written.file->json["animations"][0]["channels"].size(), 2u);
    EXPECT_FALSE(written.file->json.contains("skins"));
}

// Scaled and turned before it is prepared: a mesh with a camera and a light at (1, 2, 3).
TEST(PlaceScene, ScalesLengthsAndTurnsTheAxisToY) {
    for (const prep::Axis up : {prep::Axis::x, prep::Axis::y, prep::Axis::z}) {
        prep::Scene scene;
        scene.meshes.push_back(strip(1, 0));
        prep::Node node;
        node.camera = 0;
        node.light = 0;
        node.transform[3] = glm::dvec4(1, 2, 3, 1);
        scene.nodes.push_back(node);
        scene.cameras.emplace_back().zfar = 10;
        scene.lights.emplace_back().range = 4;
        prep::place_scene(scene, 0.5, up);
        const auto world = prep::world_transforms(scene);
        const glm::dvec3 expected = up == prep::Axis::x   ? glm::dvec3(-1, 0.5, 1.5)
                                    : up == prep::Axis::y ? glm::dvec3(0.5, 1, 1.5)
                                                          : glm::dvec3(0.5, 1.5, -1);
        EXPECT_EQ(glm::dvec3(world[0][3]), expected);
        EXPECT_EQ(scene.nodes[1].mesh, 0u);  // meshes without a node are placed, too
        EXPECT_EQ(scene.nodes[1].parent, 2u);
        EXPECT_EQ(scene.cameras[0].zfar, 5);
        EXPECT_EQ(scene.lights[0].range, 2);
        EXPECT_LT(glm::length(glm::dvec3((scene.nodes[2].trs->matrix() * glm::dvec4(1, 2, 3, 1))) -
                              expected),
                  1e-15);
    }
}

TEST(PlaceScene, NothingIsAddedWhereNothingChanges) {
    prep::Scene scene;
    scene.meshes.push_back(strip(1, 0));
    prep::place_scene(scene, 1, prep::Axis::y);
    EXPECT_TRUE(scene.nodes.empty());
}

test::GltfSource document(const Json& scenes) {
    test::GltfSource d;
    d.json["meshes"] = {
        {{"primitives",
          {{{"attributes",
             {{"POSITION", d.add_positions(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0})}}}}}}}};
    d.json["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}, {"zfar", 8}}}}};
    d.json["nodes"] = {{{"mesh", 0}, {"translation", {0, 0, 2}}}, {{"camera", 0}}};
    d.json["scenes"] = scenes;
    return d;
}

TEST(PlaceScene, DocumentsThatComeFromGltfGetANodeAboveTheirRoots) {
    const test::TempDir dir;
    document({{{"nodes", {0}}}, {{"nodes", {1}}}}).write(dir / "in.glb");
    auto scene = prep::load_scene(dir / "in.glb");
    ASSERT_TRUE(scene) << prep::to_string(scene.error());
    prep::place_scene(*scene, 2, prep::Axis::z);
    auto prepared = prep::prepare(*std::move(scene));
    ASSERT_TRUE(prepared);
    const auto saved = prep::save_scene(*prepared, dir / "out.glb");
    ASSERT_TRUE(saved) << prep::to_string(saved.error());
    const test::GltfFile file(dir / "out.glb");
    EXPECT_EQ(file.fault(), "");
    const auto world = test::GltfMotion(file).world(-1, 0);
    EXPECT_LT(glm::length(glm::dvec3(world[0][3]) - glm::dvec3(0, 4, 0)), 1e-12);
    EXPECT_EQ(file.json["scenes"][0]["nodes"], Json({2}));
    EXPECT_EQ(file.json["nodes"][3]["children"], Json({1}));
    EXPECT_EQ(file.json["cameras"][0]["perspective"]["zfar"], 16);
}

// Lengths in the scene's unit, at rest and as they are animated; a sampler that something else
// shares keeps its keys for that.
TEST(PlaceScene, LengthsOfTheDocumentFollowWithTheirKeys) {
    const test::TempDir dir;
    test::GltfSource d = document({{{"nodes", {0, 1}}}});
    d.json["extensionsUsed"] = {"KHR_materials_volume", "KHR_animation_pointer"};
    d.json["materials"] = {
        {{"extensions",
          {{"KHR_materials_volume", {{"thicknessFactor", 0.5}, {"attenuationDistance", 3}}}}}}};
    d.json["meshes"][0]["primitives"][0]["material"] = 0;
    const std::size_t times = d.add_floats("SCALAR", {0, 1}), keys = d.add_floats("SCALAR", {4, 6});
    Json channels = Json::array();
    const std::string volume = "/materials/0/extensions/KHR_materials_volume/";
    for (const std::string& pointer :
         {std::string("/cameras/0/perspective/zfar"), volume + "thicknessFactor",
          volume + "attenuationDistance", std::string("/cameras/0/perspective/yfov")})
        channels.push_back(
            {{"sampler", 0},
             {"target",
              {{"path", "pointer"},
               {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
    d.json["animations"] = {
        {{"channels", channels}, {"samplers", {{{"input", times}, {"output", keys}}}}}};
    d.write(dir / "in.glb");
    auto scene = prep::load_scene(dir / "in.glb");
    ASSERT_TRUE(scene) << prep::to_string(scene.error());
    prep::place_scene(*scene, 10, prep::Axis::y);
    auto prepared = prep::prepare(*std::move(scene));
    ASSERT_TRUE(prepared);
    const auto saved = prep::save_scene(*prepared, dir / "out.glb");
    ASSERT_TRUE(saved) << prep::to_string(saved.error());
    const test::GltfFile file(dir / "out.glb");
    EXPECT_EQ(file.fault(), "");
    const Json& stored = file.json["materials"][0]["extensions"]["KHR_materials_volume"];
    EXPECT_EQ(stored["attenuationDistance"], 30);
    EXPECT_EQ(stored["thicknessFactor"], 0.5);  // in the mesh's own unit
    const Json& animation = file.json["animations"][0];
    for (std::size_t c = 0; c < 4; ++c) {
        const auto sampler = animation["channels"][c]["sampler"].get<std::size_t>();
        const double scale = c == 0 || c == 2 ? 10 : 1;
        EXPECT_EQ(file.accessor(animation["samplers"][sampler]["output"].get<std::size_t>()).values,
                  (std::vector<double>{4 * scale, 6 * scale}))
            << c;
        EXPECT_EQ(animation["samplers"][sampler]["input"], animation["samplers"][0]["input"]);
    }
    EXPECT_EQ(animation["samplers"].size(), 2u);  // however many channels play the same keys
}

// A mesh that no node has is no reason to leave the others where they were.
TEST(PlaceScene, DocumentsWithUnusedMeshesAreScaledTooAndThoseWithoutScenesAreAnError) {
    const test::TempDir dir;
    test::GltfSource unused = document({{{"nodes", {0, 1}}}});
    unused.json["meshes"].push_back(unused.json["meshes"][0]);
    unused.write(dir / "in.glb");
    auto scene = prep::load_scene(dir / "in.glb");
    ASSERT_TRUE(scene) << prep::to_string(scene.error());
    prep::place_scene(*scene, 2, prep::Axis::y);
    auto prepared = prep::prepare(*std::move(scene));
    ASSERT_TRUE(prepared);
    ASSERT_TRUE(prep::save_scene(*prepared, dir / "out.glb").has_value());
    const test::GltfFile file(dir / "out.glb");
    EXPECT_EQ(file.json["scenes"][0]["nodes"], Json({2}));
    EXPECT_EQ(file.json["nodes"][2]["scale"], Json({2, 2, 2}));
    EXPECT_EQ(file.json["meshes"].size(), 2u);

    test::GltfSource none = document({{{"nodes", {0, 1}}}});
    none.json.erase("scenes");
    none.write(dir / "none.glb");
    scene = prep::load_scene(dir / "none.glb");
    ASSERT_TRUE(scene) << prep::to_string(scene.error());
    prep::place_scene(*scene, 2, prep::Axis::y);
    prepared = prep::prepare(*std::move(scene));
    ASSERT_TRUE(prepared);
    const auto saved = prep::save_scene(*prepared, dir / "never.glb");
    ASSERT_FALSE(saved);
    EXPECT_NE(saved.error().text.find("--scale"), std::string::npos);
}

TEST(PlaceScene, ScenesThatShareRootsAreAnError) {
    const test::TempDir dir;
    document({{{"nodes", {0, 1}}}, {{"nodes", {1}}}}).write(dir / "in.glb");
    auto scene = prep::load_scene(dir / "in.glb");
    ASSERT_TRUE(scene);
    prep::place_scene(*scene, 2, prep::Axis::y);
    auto prepared = prep::prepare(*std::move(scene));
    ASSERT_TRUE(prepared);
    const auto saved = prep::save_scene(*prepared, dir / "out.glb");
    ASSERT_FALSE(saved);
    EXPECT_NE(saved.error().text.find("--scale"), std::string::npos);
    EXPECT_EQ(dir.names(), std::vector<std::string>{"in.glb"});
}

}  // namespace
