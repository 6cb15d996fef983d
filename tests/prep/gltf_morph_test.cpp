// The shapes that a glTF file's morph targets lead to: base plus deltas, by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "gltf_maker.h"
#include "mesh_files.h"
#include "pipeline/morph_targets.h"

namespace {

using Floats = std::vector<float>;
using Json = test::GltfMaker::Json;
using Vectors = std::vector<glm::vec3>;
using prep::no_index;
using test::GltfMaker;

// Three vectors (first + 1, first + 2, first + 3), (first + 4, …
Floats counted(float first) {
    Floats out;
    for (int i = 1; i <= 9; ++i) out.push_back(first + float(i));
    return out;
}

// Two primitives of three vertices: the first with two targets, the other with one more that moves
// nothing but normals. Deltas are quantized, sparse, or plain.
GltfMaker two_primitives() {
    GltfMaker maker;
    const auto add = [&](const Floats& values) { return maker.accessor(values, "VEC3"); };
    const std::size_t a = add(counted(0)), b = add(counted(100));
    const std::size_t normals = add({0, 0, 1, 0, 0, 1, 0, 0, 1});
    const std::size_t plain = add({0.5f, 0.25f, 0.125f, 1, 2, 3, -4, -5, -6});
    const std::size_t bytes =
        maker.accessor<std::int8_t>({127, 0, -127, -128, 0, 0, 0, 0, 127}, "VEC3", true);
    const std::size_t sparse = maker.accessor(
        {{"componentType", 5126},
         {"count", 3},
         {"type", "VEC3"},
         {"sparse",
          {{"count", 1},
           {"indices",
            {{"bufferView", maker.view(std::vector<std::uint8_t>{1})}, {"componentType", 5121}}},
           {"values", {{"bufferView", maker.view(Floats{7, 8, 9})}}}}}});
    const std::size_t turns = add({3, 0, 3, 0, -1, -1, 0, 0, -1});
    maker.mesh({{{"attributes", {{"POSITION", a}}},
                 {"targets", {{{"POSITION", plain}}, {{"POSITION", sparse}}}}},
                {{"attributes", {{"POSITION", b}, {"NORMAL", normals}}},
                 {"targets", {{{"POSITION", bytes}}, Json::object(), {{"NORMAL", turns}}}}},
                {{"attributes", {{"POSITION", add(counted(200))}}},
                 {"targets", Json::array({Json::object()})}}});
    return maker;
}

prep::detail::MorphShape shape(const prep::Scene& scene, std::size_t target) {
    return prep::detail::morph_shape(scene.meshes[0], scene.meshes[0].morph_targets.at(target));
}

TEST(GltfMorph, ShapesAreTheBasePlusTheDeltasOfTheirTarget) {
    const auto scene = two_primitives().read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(prep::morph_target_count(*scene), 3u) << "the most that a primitive has";
    const prep::detail::MorphShape first = shape(*scene, 0), second = shape(*scene, 1);
    EXPECT_TRUE(first.moves);
    EXPECT_TRUE(first.normal_deltas.empty());
    EXPECT_EQ(first.positions, (Vectors{{1.5f, 2.25f, 3.125f},
                                        {5, 7, 9},
                                        {3, 3, 3},
                                        {102, 102, 102},
                                        {103, 105, 106},
                                        {107, 108, 110},
                                        {201, 202, 203},
                                        {204, 205, 206},
                                        {207, 208, 209}}));
    Vectors base = scene->meshes[0].positions;
    base[1] += glm::vec3(7, 8, 9);
    EXPECT_EQ(second.positions, base);
}

TEST(GltfMorph, WeightsAtRestAreTheMeshs) {
    auto maker = two_primitives();
    maker.json["meshes"][0]["weights"] = {0.25, 1, 1e300};
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const auto& targets = scene->meshes[0].morph_targets;
    ASSERT_EQ(targets.size(), 3u);
    EXPECT_EQ(targets[0].weight, 0.25f);
    EXPECT_EQ(targets[1].weight, 1.0f);
    EXPECT_EQ(targets[2].weight, 0.0f);
}

TEST(GltfMorph, NormalsAreTurnedByTheirDeltasAndUnitAgain) {
    const auto scene = two_primitives().read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const prep::detail::MorphShape third = shape(*scene, 2);
    EXPECT_FALSE(third.moves);
    EXPECT_EQ(third.positions, scene->meshes[0].positions);
    const auto normals = prep::detail::morphed_normals(scene->meshes[0], third.normal_deltas);
    ASSERT_EQ(normals.indices.size(), 9u);
    for (std::size_t c : {0, 1, 2, 6, 7, 8}) EXPECT_EQ(normals.indices[c], no_index);
    const auto at = [&](std::size_t c) { return normals.values[normals.indices[c]]; };
    EXPECT_NEAR(at(3).x, 0.6, 1e-7);  // (3, 0, 4) / 5
    EXPECT_NEAR(at(3).z, 0.8, 1e-7);
    EXPECT_EQ(at(4), glm::vec3(0, -1, 0));
    EXPECT_EQ(at(5), glm::vec3(0)) << "what is turned to nothing stays nothing";
}

// Corners that came from several vertices of the file and share one since: each has the delta of
// its own.
TEST(GltfMorph, WeldedMeshesTakeTheDeltasOfTheVerticesInTheFile) {
    const auto scene = two_primitives().read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    prep::Mesh mesh = scene->meshes[0];
    // Vertices 0 and 1 go, and the second primitive's corners 3 and 4 share a vertex.
    mesh.positions = {mesh.positions[2], mesh.positions[4], mesh.positions[5]};
    mesh.file_vertices = {2, 4, 5};
    mesh.face_offsets = {0, 3};
    mesh.corner_vertices = {1, 1, 2};
    mesh.corner_file_vertices = {3, 4, 5};
    mesh.normals.values = {{0, 0, 1}};
    mesh.normals.indices = {0, 0, no_index};
    const auto made = prep::detail::morph_shape(mesh, mesh.morph_targets.at(0));
    EXPECT_EQ(made.positions, (Vectors{{3, 3, 3}, {103, 105, 106}, {107, 108, 110}}));
    const auto turned = prep::detail::morph_shape(mesh, mesh.morph_targets.at(2));
    EXPECT_EQ(turned.normal_deltas, (Vectors{{3, 0, 3}, {0, -1, -1}, {0, 0, -1}}));
    const auto normals = prep::detail::morphed_normals(mesh, turned.normal_deltas);
    ASSERT_EQ(normals.indices.size(), 3u);
    EXPECT_NE(normals.indices[0], normals.indices[1]) << "one before, two now";
    EXPECT_NEAR(normals.values[normals.indices[0]].x, 0.6, 1e-7);
    EXPECT_EQ(normals.values[normals.indices[1]], glm::vec3(0, -1, 0));
    EXPECT_EQ(normals.indices[2], no_index);
}

// Primitives that share accessors keep the vertices that they use, and these have their own deltas.
TEST(GltfMorph, DeltasFollowTheVerticesThatAPrimitiveUses) {
    GltfMaker maker;
    Floats positions, deltas;
    for (int i = 0; i < 6; ++i) {
        positions.insert(positions.end(), {float(i), 0, 0});
        deltas.insert(deltas.end(), {0, float(10 * i), 0});
    }
    const std::size_t base = maker.accessor(positions, "VEC3"),
                      target = maker.accessor(deltas, "VEC3");
    Json primitives = Json::array();
    for (const std::vector<std::uint8_t>& indices :
         {std::vector<std::uint8_t>{5, 0, 2}, std::vector<std::uint8_t>{1, 4, 3}})
        primitives.push_back({{"attributes", {{"POSITION", base}}},
                              {"indices", maker.accessor(indices, "SCALAR")},
                              {"targets", {{{"POSITION", target}}}}});
    maker.mesh(primitives);
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const prep::Mesh& mesh = scene->meshes[0];
    ASSERT_EQ(mesh.vertex_count(), 6u);
    const Vectors moved = shape(*scene, 0).positions;
    Floats numbers;
    for (const std::uint32_t v : mesh.corner_vertices) {
        EXPECT_EQ(moved[v].y, 10 * moved[v].x);
        numbers.push_back(moved[v].x);
    }
    EXPECT_EQ(numbers, (Floats{5, 0, 2, 1, 4, 3}));
}

}  // namespace
