#include "prep/requirements.h"

#include <gtest/gtest.h>

namespace {

prep::Scene textured_triangle() {
    prep::Scene scene;
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.face_offsets = {0, 3};
    mesh.corner_vertices = {0, 1, 2};
    mesh.uvs.push_back({{{0, 0}, {1, 0}, {0, 1}}, {0, 1, 2}});
    mesh.face_materials = {0};
    scene.meshes.push_back(mesh);
    scene.materials.resize(1);
    scene.materials[0].name = "brick";
    scene.textures.resize(1);
    return scene;
}

TEST(Requirements, EmptySceneNeedsNothing) {
    EXPECT_TRUE(prep::requirements({}).empty());
}

TEST(Requirements, LitFacesNeedNormalsOnly) {
    const auto r = prep::requirements(textured_triangle());
    ASSERT_EQ(r.size(), 1u);
    EXPECT_TRUE(r[0].normals.needed);
    EXPECT_EQ(r[0].normals.reason, "material 'brick' is lit");
    EXPECT_FALSE(r[0].tangents.needed);
    EXPECT_FALSE(r[0].uvs.needed);
}

TEST(Requirements, NormalMapCallsForTangentsAndNamesTheMaterial) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].normal_map.texture = 0;
    const auto r = prep::requirements(scene);
    EXPECT_TRUE(r[0].tangents.needed);
    EXPECT_EQ(r[0].tangents.reason, "material 'brick' has a tangent-space normal map");
    EXPECT_TRUE(r[0].uvs.needed);
}

TEST(Requirements, MaterialsOfVariantsAreInUse) {
    prep::Scene scene = textured_triangle();
    scene.materials.push_back(scene.materials[0]);
    scene.materials[1].name = "plaster";
    scene.materials[1].normal_map.texture = 0;
    EXPECT_FALSE(prep::requirements(scene)[0].tangents.needed);
    scene.meshes[0].variant_materials = {1};
    EXPECT_EQ(prep::requirements(scene)[0].tangents.reason,
              "material 'plaster' has a tangent-space normal map");
    scene.meshes[0].variant_materials = {7};  // the file has no such one
    EXPECT_FALSE(prep::requirements(scene)[0].tangents.needed);
}

TEST(Requirements, ObjectSpaceMapNeedsNoTangents) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].normal_map.texture = 0;
    scene.materials[0].normal_map_space = prep::NormalMapSpace::object;
    EXPECT_FALSE(prep::requirements(scene)[0].tangents.needed);
}

TEST(Requirements, NormalMapWithoutItsUvSetSaysSo) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].normal_map.texture = 0;
    scene.materials[0].normal_map.uv_set = 3;
    const auto r = prep::requirements(scene);
    EXPECT_FALSE(r[0].tangents.needed);
    EXPECT_EQ(r[0].tangents.reason, "material 'brick' has a normal map, but UV set 3 is missing");
}

TEST(Requirements, UnusedMaterialCallsForNothing) {
    prep::Scene scene = textured_triangle();
    scene.materials.resize(2);
    scene.materials[1].normal_map.texture = 0;
    EXPECT_FALSE(prep::requirements(scene)[0].tangents.needed);
}

TEST(Requirements, PointsAndLinesNeedNoNormals) {
    prep::Scene scene;
    scene.meshes.resize(1);
    scene.meshes[0].positions = {{0, 0, 0}};
    scene.meshes[0].points = {0};
    const auto r = prep::requirements(scene);
    EXPECT_FALSE(r[0].normals.needed);
    EXPECT_EQ(r[0].normals.reason, "no faces: points and lines carry no normals");
}

TEST(Requirements, UnlitMaterialsNeedNoNormals) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].unlit = true;
    EXPECT_FALSE(prep::requirements(scene)[0].normals.needed);
}

TEST(Requirements, AskedTangentsBringNormalsAlong) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].unlit = true;
    prep::Request request;
    request.tangents = prep::Request::Level::always;
    const auto r = prep::requirements(scene, request);
    EXPECT_TRUE(r[0].tangents.needed);
    EXPECT_TRUE(r[0].normals.needed);
    EXPECT_EQ(r[0].normals.reason, "tangents need normals");
}

TEST(Requirements, AskedTangentsWithoutUvsAreRefusedWithTheReason) {
    prep::Scene scene = textured_triangle();
    scene.meshes[0].uvs.clear();
    prep::Request request;
    request.tangents = prep::Request::Level::always;
    const auto r = prep::requirements(scene, request);
    EXPECT_FALSE(r[0].tangents.needed);
    EXPECT_EQ(r[0].tangents.reason, "asked for by the request, but the mesh has no UVs");
}

TEST(Requirements, FaceWithoutMaterialIsLitByTheDefaultOne) {
    prep::Scene scene = textured_triangle();
    scene.meshes[0].face_materials = {prep::no_index};
    EXPECT_EQ(prep::requirements(scene)[0].normals.reason,
              "faces without a material are lit by the default one");
}

}  // namespace
