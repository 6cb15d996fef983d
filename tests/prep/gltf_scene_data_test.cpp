// What the scene model holds of a glTF file beside faces: transforms in their parts, animations,
// joints and weights, attributes of other names.
#include <gtest/gtest.h>

#include "gltf_maker.h"
#include "mesh_files.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "written_gltf.h"

namespace {

using Floats = std::vector<float>;
using Joints = glm::vec<4, std::uint16_t>;
using Json = test::GltfMaker::Json;
using test::GltfMaker;

const Floats corner{0, 0, 0, 1, 0, 0, 0, 1, 0};

// Two triangles, the second with joints, weights and an attribute that the first lacks.
GltfMaker two_parts() {
    GltfMaker maker;
    const auto add = [&](const Floats& values, const char* type) {
        return maker.accessor(values, type);
    };
    const std::size_t joints =
        maker.accessor<std::uint8_t>({0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
    const std::size_t weights = add({0.25f, 0.75f, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}, "VEC4");
    maker.mesh({{{"attributes", {{"POSITION", add(corner, "VEC3")}}}},
                {{"attributes",
                  {{"POSITION", add({5, 0, 0, 6, 0, 0, 5, 1, 0}, "VEC3")},
                   {"JOINTS_0", joints},
                   {"WEIGHTS_0", weights},
                   {"_HEAT", add({1, 2, 3, 4, 5, 6}, "VEC2")}}}}});
    return maker;
}

TEST(GltfSceneData, JointsAndWeightsAreByVertexOfTheFile) {
    const auto scene = two_parts().read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const prep::Mesh& mesh = scene->meshes[0];
    ASSERT_EQ(mesh.skin_influences.size(), 1u);
    const prep::SkinInfluences& set = mesh.skin_influences[0];
    EXPECT_EQ(set.joints, (std::vector<Joints>{Joints(0), Joints(0), Joints(0), Joints(0, 1, 0, 0),
                                               Joints(1, 0, 0, 0), Joints(1, 0, 0, 0)}));
    EXPECT_EQ(set.weights, (std::vector<glm::vec4>{{0, 0, 0, 0},
                                                   {0, 0, 0, 0},
                                                   {0, 0, 0, 0},
                                                   {0.25f, 0.75f, 0, 0},
                                                   {1, 0, 0, 0},
                                                   {0.5f, 0.5f, 0, 0}}));
}

TEST(GltfSceneData, AttributesOfOtherNamesKeepTheirNumbers) {
    const auto scene = two_parts().read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    ASSERT_EQ(scene->meshes[0].vertex_attributes.size(), 1u);
    const prep::VertexAttribute& heat = scene->meshes[0].vertex_attributes[0];
    EXPECT_EQ(heat.name, "_HEAT");
    EXPECT_EQ(heat.width, 2u);
    EXPECT_EQ(heat.values, (Floats{0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6}));
}

// Primitives may have one name in several types: as read, and refined, where each is written in
// its own.
TEST(GltfSceneData, AttributesOfOneNameKeepTheTypeOfEachPrimitive) {
    const std::vector<std::pair<const char*, std::size_t>> types = {
        {"SCALAR", 1}, {"VEC3", 3}, {"MAT2", 4}, {"VEC2", 2}};
    for (const std::size_t turn : {0, 1, 2, 3}) {
        GltfMaker maker;
        Json primitives = Json::array();
        for (std::size_t p = 0; p < 4; ++p) {
            const auto& [type, width] = types[(p + turn) % 4];
            Floats values, points = corner;
            for (std::size_t k = 0; k < 3 * width; ++k) values.push_back(float(100 * p + k + 1));
            for (std::size_t k = 0; k < 9; k += 3) points[k] += 5 * float(p);
            primitives.push_back({{"attributes",
                                   {{"POSITION", maker.accessor(points, "VEC3")},
                                    {"_HEAT", maker.accessor(values, type)}}}});
        }
        maker.mesh(primitives);
        auto scene = maker.read();
        ASSERT_TRUE(scene) << test::error_of(scene);
        EXPECT_EQ(scene->meshes[0].vertex_attributes.at(0).width, 4u);
        prep::PrepareOptions options;
        options.subdivide = true;
        options.subdivision.level = 1;
        options.subdivision.scheme = prep::SubdivisionScheme::bilinear;
        const auto prepared = prep::prepare(*std::move(scene), options);
        ASSERT_TRUE(prepared) << prep::to_string(prepared.error());
        const test::TempDir dir;
        ASSERT_TRUE(prep::save_scene(*prepared, dir / "out.glb"));
        const test::GltfFile file(dir / "out.glb");
        for (std::size_t p = 0; p < 4; ++p) {
            const auto& [type, width] = types[(p + turn) % 4];
            const std::size_t accessor = file.primitive(0, p)["attributes"]["_HEAT"];
            EXPECT_EQ(file.json["accessors"][accessor]["type"], type);
            // The triangle's points have what they had.
            const test::GltfValues heat = file.accessor(accessor),
                                   points = file.attribute(0, p, "POSITION");
            std::size_t found = 0;
            for (std::size_t v = 0; v < points.count(); ++v)
                for (std::size_t c = 0; c < 3; ++c)
                    if (points.at(v)[0] == corner[3 * c] + 5 * double(p) &&
                        points.at(v)[1] == corner[3 * c + 1]) {
                        ++found;
                        for (std::size_t k = 0; k < width; ++k)
                            EXPECT_EQ(heat.at(v)[k], double(100 * p + c * width + k + 1));
                    }
            EXPECT_EQ(found, 3u);
        }
    }
}

// Removing the first triangle's vertices renumbers the mesh; the file's data stay where they are
// and are found through the way back.
TEST(GltfSceneData, RepairsAndSplitsKeepTheWayBackToTheFilesVertices) {
    auto scene = two_parts().read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    prep::Mesh& mesh = scene->meshes[0];
    mesh.face_offsets = {0, 3};
    mesh.corner_vertices = {3, 4, 5};
    mesh.face_parts = {1};
    mesh.face_materials.resize(1);
    prep::PrepareOptions options;
    options.repair.isolated_vertices = true;
    const auto prepared = prep::prepare(*std::move(scene), options);
    ASSERT_TRUE(prepared) << prep::to_string(prepared.error());
    const prep::Mesh& after = prepared->scene.meshes[0];
    ASSERT_EQ(after.vertex_count(), 3u);
    const prep::VertexMesh& split = prepared->meshes[0];
    for (std::size_t v = 0; v < split.vertex_count(); ++v) {
        const std::uint32_t in_file = after.file_vertex(split.source_vertices[v]);
        EXPECT_EQ(after.corner_file_vertex(split.source_corners[v]), in_file);
        EXPECT_EQ(after.vertex_attributes[0].values.at(2 * in_file), 1 + 2 * float(in_file - 3));
        EXPECT_EQ(split.positions[v].x, in_file == 4 ? 6 : 5);
    }
}

TEST(GltfSceneData, NodesSayTheirPartsWhereTheFileDoes) {
    GltfMaker maker = two_parts();
    maker.json["nodes"] = {
        {{"mesh", 0}, {"translation", {1, 2, 3}}, {"rotation", {0, 0, 2, 0}}, {"scale", {1, 2, 4}}},
        {{"mesh", 0}, {"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 7, 8, 9, 1}}}};
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const prep::Node &parts = scene->nodes[0], &matrix = scene->nodes[1];
    ASSERT_TRUE(parts.trs.has_value());
    EXPECT_EQ(parts.trs->translation, glm::dvec3(1, 2, 3));
    EXPECT_EQ(parts.trs->rotation, glm::dquat(0, 0, 0, 1)) << "half a turn about z, made unit";
    EXPECT_EQ(parts.trs->scale, glm::dvec3(1, 2, 4));
    EXPECT_EQ(parts.transform, parts.trs->matrix());
    EXPECT_EQ(parts.transform * glm::dvec4(1, 1, 1, 1), glm::dvec4(0, 0, 7, 1));
    EXPECT_FALSE(matrix.trs.has_value());
    EXPECT_EQ(matrix.transform[3], glm::dvec4(7, 8, 9, 1));
}

TEST(GltfSceneData, AnimationsHaveTheirKeys) {
    GltfMaker maker = two_parts();
    const std::size_t times = maker.accessor(Floats{0, 0.5f}, "SCALAR");
    const std::size_t turns =
        maker.accessor<std::int16_t>({0, 0, 0, 32767, 0, 0, 32767, 0}, "VEC4", true);
    const std::size_t moves = maker.accessor(Floats{1, 2, 3, 4, 5, 6}, "VEC3");
    maker.json["nodes"] = {{{"mesh", 0}}};
    maker.json["animations"] = {
        {{"name", "wave"},
         {"samplers",
          {{{"input", times}, {"output", turns}, {"interpolation", "STEP"}},
           {{"input", times}, {"output", moves}}}},
         {"channels",
          {{{"sampler", 1}, {"target", {{"node", 0}, {"path", "translation"}}}},
           {{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}},
           {{"sampler", 1}, {"target", {{"path", "pointer"}}}}}}}};
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    ASSERT_EQ(scene->animations.size(), 1u);
    const prep::Animation& wave = scene->animations[0];
    EXPECT_EQ(wave.name, "wave");
    ASSERT_EQ(wave.samplers.size(), 2u);
    EXPECT_EQ(wave.samplers[0].interpolation, prep::Interpolation::step);
    EXPECT_EQ(wave.samplers[1].interpolation, prep::Interpolation::linear);
    EXPECT_EQ(*wave.samplers[0].times, (Floats{0, 0.5f}));
    EXPECT_EQ(wave.samplers[0].times, wave.samplers[1].times) << "one list for both";
    EXPECT_EQ(*wave.samplers[0].values, (Floats{0, 0, 0, 1, 0, 0, 1, 0}));
    EXPECT_EQ(*wave.samplers[1].values, (Floats{1, 2, 3, 4, 5, 6}));
    ASSERT_EQ(wave.channels.size(), 3u);
    EXPECT_EQ(wave.channels[0].sampler, 1u);
    EXPECT_EQ(wave.channels[0].node, 0u);
    EXPECT_EQ(wave.channels[0].path, prep::AnimationPath::translation);
    EXPECT_EQ(wave.channels[1].path, prep::AnimationPath::rotation);
    EXPECT_EQ(wave.channels[2].path, prep::AnimationPath::other);
    EXPECT_EQ(wave.channels[2].node, prep::no_index);
}

// Another reader may fill a mesh's targets: the pipeline asks for no format.
TEST(GltfSceneData, TargetsOfAnyMeshGetTheirOwnNormals) {
    prep::Scene scene;
    prep::Mesh& mesh = scene.meshes.emplace_back();
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.face_offsets = {0, 3};
    mesh.corner_vertices = {0, 1, 2};
    // The third vertex moves from y to z: the normal from +z to -y.
    mesh.morph_targets.push_back(
        {{{2, std::make_shared<const std::vector<glm::vec3>>(1, glm::vec3(0, -1, 1))}}, {}, {}});
    prep::instance_unused_meshes(scene);
    prep::PrepareOptions options;
    options.request.normals = prep::Request::Level::always;
    const auto prepared = prep::prepare(std::move(scene), options);
    ASSERT_TRUE(prepared) << prep::to_string(prepared.error());
    ASSERT_EQ(prepared->morphs[0].size(), 1u);
    const test::TempDir dir;
    const auto notes = prep::save_scene(*prepared, dir / "a.glb");
    ASSERT_TRUE(notes) << prep::to_string(notes.error());
    EXPECT_TRUE(notes->empty());
    EXPECT_EQ(prepared->morphs[0][0].normals, (std::vector<glm::vec3>(3, glm::vec3(0, -1, -1))));
}

}  // namespace
