// The stage of the pipeline: cages in scenes, what it says, and what a glTF document keeps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "shapes.h"
#include "shared_data.h"

namespace {

prep::Scene scene_of(prep::Mesh mesh) {
    prep::Scene scene;
    scene.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(scene);
    return scene;
}

prep::PrepareOptions catmark(int level = 2) {
    prep::PrepareOptions options;
    options.subdivide = true;
    options.subdivision.level = level;
    return options;
}

std::uint64_t count(const prep::PreparedScene& prepared, const std::string& kind) {
    for (const auto& f : prepared.findings)
        if (f.kind == kind) return f.count;
    return 0;
}

const prep::StageReport* stage(const prep::PreparedScene& prepared, const std::string& name) {
    for (const auto& s : prepared.stages)
        if (s.stage == name) return &s;
    return nullptr;
}

TEST(PrepareSubdivide, NothingIsSaidWhereNothingIsAsked) {
    const auto prepared = prep::prepare(scene_of(shapes::cube()));
    ASSERT_TRUE(prepared);
    EXPECT_EQ(stage(*prepared, "subdivide"), nullptr);
    EXPECT_EQ(prepared->meshes[0].triangle_count(), 12U);
}

TEST(PrepareSubdivide, NormalsOfTheLimitSurfaceStand) {
    prep::PrepareOptions options = catmark();
    options.normals = prep::Authored::replace;
    const auto prepared = prep::prepare(scene_of(shapes::cube()), options);
    ASSERT_TRUE(prepared) << prepared.error().text;
    EXPECT_EQ(prepared->meshes[0].triangle_count(), 6U * 16 * 2);
    ASSERT_TRUE(stage(*prepared, "subdivide"));
    EXPECT_TRUE(stage(*prepared, "subdivide")->run);
    EXPECT_FALSE(stage(*prepared, "normals")->run);
    const auto direct = prep::subdivide(shapes::cube());
    ASSERT_TRUE(direct);
    const prep::VertexMesh& out = prepared->meshes[0];
    EXPECT_EQ(out.vertex_count(), direct->mesh.vertex_count());  // smooth: nothing is split
    for (std::size_t v = 0; v < out.vertex_count(); ++v)
        EXPECT_EQ(out.positions[v], direct->mesh.positions[out.source_vertices[v]]);
}

TEST(PrepareSubdivide, HardEdgesAreThoseOfTheCageAlone) {
    // A box of sharp edges: 24 corners in the cage, and edges are hard at every level.
    prep::PrepareOptions options = catmark(3);
    options.crease_hard_edges = true;
    options.hard_edges.angle_degrees = 60;
    const auto sharp = prep::prepare(scene_of(shapes::cube()), options);
    ASSERT_TRUE(sharp) << sharp.error().text;
    const prep::VertexMesh& box = sharp->meshes[0];
    for (std::size_t v = 0; v < box.vertex_count(); ++v) {
        const glm::vec3 p = glm::abs(box.positions[v]), n = glm::abs(box.normals[v]);
        EXPECT_NEAR(std::max({p.x, p.y, p.z}), 1, 1e-6);  // on the box still
        EXPECT_NEAR(std::max({n.x, n.y, n.z}), 1, 1e-6);  // and flat
    }
    EXPECT_EQ(box.vertex_count(), 6U * 81);
    // Control points have normals computed: no angle of the refined faces makes an edge hard.
    options = catmark(1);
    options.subdivision.control_points = true;
    options.hard_edges.angle_degrees = 1;
    const auto smooth = prep::prepare(scene_of(shapes::cube()), options);
    ASSERT_TRUE(smooth);
    EXPECT_EQ(smooth->meshes[0].vertex_count(), 26U);
}

TEST(PrepareSubdivide, TriangulatedQuadsAreToldAndRecovered) {
    const prep::Mesh triangles = shapes::fan_triangulated(shapes::cube());
    const auto told = prep::prepare(scene_of(triangles), catmark());
    ASSERT_TRUE(told);
    EXPECT_EQ(count(*told, "triangulated-cage"), 12U);
    prep::PrepareOptions options = catmark();
    options.recover_quads = true;
    const auto recovered = prep::prepare(scene_of(triangles), options);
    ASSERT_TRUE(recovered);
    EXPECT_EQ(count(*recovered, "triangulated-cage"), 0U);
    EXPECT_EQ(recovered->meshes[0].triangle_count(), 6U * 16 * 2);
    options = catmark();
    options.subdivision.scheme = prep::SubdivisionScheme::loop;
    const auto loop = prep::prepare(scene_of(triangles), options);
    ASSERT_TRUE(loop) << loop.error().text;
    EXPECT_EQ(count(*loop, "triangulated-cage"), 0U);
    EXPECT_EQ(loop->meshes[0].triangle_count(), 12U * 16);
}

// A seam beside a crease of 6,000 edges, where one of its vertices has creases of its own.
TEST(PrepareSubdivide, SeamsThatAreApproximateAreTold) {
    constexpr std::uint32_t length = 6000, middle = 2 * (length + 1);
    prep::Mesh strip = shapes::grid(length, 4);
    for (std::uint32_t x = 0; x < length; ++x)
        strip.subdivision.creases.push_back({middle + x, middle + x + 1, 9.75F});
    const std::uint32_t v = length + 1 + 10;  // on the seam
    strip.subdivision.creases.push_back({v, v - (length + 1), 1.5F});
    strip.subdivision.creases.push_back({v, v + 1, 2.5F});
    prep::CornerLayer<glm::vec2> uvs;
    for (std::uint32_t c = 0; c < strip.corner_count(); ++c) {
        const glm::vec3 p = strip.positions[strip.corner_vertices[c]];
        uvs.indices.push_back(c);
        uvs.values.emplace_back(p.x, p.y + p.z + (c < 4 * length ? 0.0F : 9.0F));
    }
    strip.uvs.push_back(std::move(uvs));
    for (const prep::FaceVaryingRule rule :
         {prep::FaceVaryingRule::corners_only, prep::FaceVaryingRule::corners_plus1}) {
        prep::PrepareOptions options = catmark(0);
        options.subdivision.face_varying = rule;
        const auto prepared = prep::prepare(scene_of(strip), options);
        ASSERT_TRUE(prepared) << prepared.error().text;
        EXPECT_EQ(count(*prepared, "approximate-seams"),
                  rule == prep::FaceVaryingRule::corners_only ? 0U : 1U);
    }
}

TEST(PrepareSubdivide, ErrorsNameTheMesh) {
    prep::Mesh bad = shapes::cube();
    bad.name = "box";
    prep::PrepareOptions options = catmark();
    options.subdivision.scheme = prep::SubdivisionScheme::loop;
    const auto refused = prep::prepare(scene_of(bad), options);
    ASSERT_FALSE(refused);
    EXPECT_NE(to_string(refused.error()).find("triangle"), std::string::npos);
    EXPECT_NE(to_string(refused.error()).find("box"), std::string::npos)
        << to_string(refused.error());
}

// What is left of a document's primitive must be its refinement, never the cage.
TEST(PrepareSubdivide, PrimitivesWithoutALimitAreAnErrorNotTheCage) {
    test::TempDir folder;
    const auto first = prep::prepare(scene_of(shapes::grid(2, 2)));
    ASSERT_TRUE(first);
    ASSERT_TRUE(prep::save_scene(*first, folder / "open.glb"));
    auto scene = prep::load_scene(folder / "open.glb");
    ASSERT_TRUE(scene) << scene.error().text;
    prep::PrepareOptions options = catmark(1);
    options.subdivision.boundary = prep::BoundaryRule::none;
    const auto prepared = prep::prepare(*std::move(scene), options);
    if (!prepared) return;  // refused earlier is as good
    const auto written = prep::save_scene(*prepared, folder / "out.glb");
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().text.find("boundary"), std::string::npos) << written.error().text;
    EXPECT_FALSE(std::filesystem::exists(folder / "out.glb"));
}

// A glTF file repeats points at seams; the surface must not come apart there, and skins, morph
// targets and animations are still there when it was written.
TEST(PrepareSubdivide, GltfDocumentsKeepWhatElseIsInThem) {
    MESHPREP_REQUIRE_SHARED(shared);
    test::TempDir folder;
    for (const char* name : {"CesiumMan.glb", "MorphStressTest.gltf", "heart_draco.glb"}) {
        SCOPED_TRACE(name);
        auto scene = prep::load_scene(shared / "corpus" / name);
        ASSERT_TRUE(scene) << scene.error().text;
        const prep::Scene before = *scene;
        auto prepared = prep::prepare(*std::move(scene), catmark(1));
        ASSERT_TRUE(prepared) << prepared.error().text;
        const auto written = prep::save_scene(*prepared, folder / "out.glb");
        ASSERT_TRUE(written) << written.error().text;
        const auto again = prep::load_scene(folder / "out.glb");
        ASSERT_TRUE(again) << again.error().text;
        EXPECT_EQ(again->skins.size(), before.skins.size());
        EXPECT_EQ(again->animations.size(), before.animations.size());
        EXPECT_EQ(again->materials.size(), before.materials.size());
        ASSERT_EQ(again->meshes.size(), before.meshes.size());
        for (std::size_t m = 0; m < before.meshes.size(); ++m) {
            const prep::Mesh &from = before.meshes[m], &to = again->meshes[m];
            // Each triangle became three quads, each of two triangles.
            EXPECT_EQ(to.face_count(), 6 * from.face_count());
            EXPECT_EQ(to.morph_targets.size(), from.morph_targets.size());
            EXPECT_EQ(to.uvs.size(), from.uvs.size());
            EXPECT_EQ(to.skin_influences.size(), from.skin_influences.size());
            EXPECT_EQ(to.parts.size(), from.parts.size());
            for (const prep::MorphTarget& target : to.morph_targets)
                EXPECT_FALSE(target.positions.empty());
            for (const glm::vec3& n : to.normals.values) ASSERT_NEAR(glm::length(n), 1, 1e-5);
        }
    }
}

}  // namespace
