// The stage of the pipeline: cages in scenes, what it says, and what a glTF document keeps.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

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

// Two squares side by side of which the second lacks UVs: its quarters lack them too, the first's
// have those of the first alone. Where no face has all of its UVs there are none, rather than zeros
// that a texture would be read at.
TEST(PrepareSubdivide, FacesWithoutUvsTakeThemFromNoOther) {
    const test::TempDir dir;
    const std::string head =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    const auto refined = [&](const std::string& faces) {
        test::write_text(dir / "a.obj", head + faces);
        auto scene = prep::load_scene(dir / "a.obj");
        EXPECT_TRUE(scene);
        auto prepared = prep::prepare(*std::move(scene), catmark(1));
        EXPECT_TRUE(prepared) << to_string(prepared.error());
        return *std::move(prepared);
    };
    const prep::PreparedScene both = refined("f 1/1 2/2 3/3 4/4\nf 2/2 5/1 6/4 3/3\n");
    const prep::PreparedScene one = refined("f 1/1 2/2 3/3 4/4\nf 2 5 6 3\n");
    // A face that has some of its UVs is as one that has none.
    const prep::PreparedScene some = refined("f 1/1 2/2 3/3 4/4\nf 2/2 5 6 3/3\n");
    const prep::PreparedScene alone = refined("f 1/1 2/2 3/3 4/4\n");
    const prep::CornerLayer<glm::vec2>& uvs = one.scene.meshes[0].uvs.at(0);
    const prep::CornerLayer<glm::vec2>& of_first = alone.scene.meshes[0].uvs.at(0);
    ASSERT_EQ(uvs.indices.size(), 32u);
    for (std::size_t c = 0; c < 32; ++c) {
        if (c >= 16) {
            EXPECT_EQ(uvs.indices[c], prep::no_index) << c;
        } else {
            EXPECT_EQ(uvs.values[uvs.indices[c]], of_first.values[of_first.indices[c]]) << c;
        }
    }
    EXPECT_EQ(uvs.values.size(), 9u);
    EXPECT_EQ(some.scene.meshes[0].uvs[0].indices, uvs.indices);
    EXPECT_EQ(some.scene.meshes[0].uvs[0].values, uvs.values);
    EXPECT_EQ(count(one, "partial-uv-set"), 0u);
    EXPECT_EQ(count(some, "partial-uv-set"), 1u);
    EXPECT_EQ(both.scene.meshes[0].uvs[0].values.size(), 15u);

    const prep::PreparedScene none = refined("f 1/1 2/2 3/3 4\nf 2 5 6 3\n");
    EXPECT_EQ(count(none, "partial-uv-set"), 1u);
    EXPECT_TRUE(none.meshes[0].uvs.empty());
    ASSERT_TRUE(prep::save_scene(none, dir / "a.glb"));
    const auto written = prep::load_scene(dir / "a.glb");
    ASSERT_TRUE(written) << to_string(written.error());
    EXPECT_TRUE(written->meshes[0].uvs.empty());
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

// A cube of two materials, as OBJ has it and as the GLB of it, which has a primitive each and
// repeats the points between them.
class CubeOfTwoPrimitives : public ::testing::Test {
  protected:
    static prep::Scene as_polygons() {
        const prep::Mesh quads = shapes::cube();
        shapes::Faces triangles;
        for (std::size_t c = 0; c < quads.corner_count(); c += 4) {
            const auto* v = &quads.corner_vertices[c];
            triangles.insert(triangles.end(), {{v[0], v[1], v[2]}, {v[0], v[2], v[3]}});
        }
        prep::Mesh cube = shapes::mesh_of(quads.positions, triangles);
        cube.face_materials.assign(12, 1);
        std::fill_n(cube.face_materials.begin(), 4, 0);
        prep::Scene scene = scene_of(std::move(cube));
        scene.materials.resize(2);
        return scene;
    }
    // Written, and read again.
    prep::Scene in_a_file(const prep::PreparedScene& prepared) const {
        const auto written = prep::save_scene(prepared, folder_ / "cube.glb");
        EXPECT_TRUE(written) << written.error().text;
        auto read = prep::load_scene(folder_ / "cube.glb");
        EXPECT_TRUE(read) << read.error().text;
        return *std::move(read);
    }
    prep::Scene as_document() const { return in_a_file(*prep::prepare(as_polygons())); }

    // Of the triangles as others read them: welded by bits.
    static void expect_closed_and_inside(const prep::Scene& scene, float radius) {
        std::map<std::array<float, 3>, std::uint32_t> points;
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
        std::size_t triangles = 0;
        const prep::Mesh& mesh = scene.meshes[0];
        for (std::size_t f = 0; f < mesh.face_count(); ++f, ++triangles)
            for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
                const auto number = [&](std::uint32_t corner) {
                    const glm::vec3& p = mesh.positions[mesh.corner_vertices[corner]];
                    EXPECT_LE(glm::length(p), radius);
                    return points
                        .try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(points.size()))
                        .first->second;
                };
                const std::uint32_t end = mesh.face_offsets[f + 1];
                ++sides[{number(c), number(c + 1 < end ? c + 1 : mesh.face_offsets[f])}];
            }
        for (const auto& [side, n] : sides) {
            ASSERT_EQ(n, 1);
            ASSERT_TRUE(sides.contains({side.second, side.first}));
        }
        EXPECT_EQ(points.size() + triangles, sides.size() / 2 + 2);
    }

  private:
    test::TempDir folder_;
};

TEST_F(CubeOfTwoPrimitives, StaysClosedWhereItIsSubdividedOrDisplaced) {
    ASSERT_EQ(as_document().meshes[0].parts.size(), 2U);
    for (const auto scheme : {prep::SubdivisionScheme::catmark, prep::SubdivisionScheme::loop})
        for (const bool displaced : {false, true}) {
            prep::PrepareOptions options = catmark();
            options.subdivision.scheme = scheme;
            if (displaced) {
                options.displacement.noise.emplace().scale = 0.05;
                options.tessellate = true;
                options.tessellation.max_triangles = 500;
            }
            const auto prepared = prep::prepare(as_document(), options);
            ASSERT_TRUE(prepared) << prepared.error().text;
            const prep::Scene written = in_a_file(*prepared);
            EXPECT_EQ(written.meshes[0].parts.size(), 2U);
            // The corners are at √3, and on no limit surface.
            expect_closed_and_inside(written, 1.4F);
            const auto polygons = prep::prepare(as_polygons(), options);
            EXPECT_EQ(written.meshes[0].face_count(), polygons->meshes[0].triangle_count());
        }
}

// Linings, the same faces turned over, and decals are surfaces of their own: the cube below is what
// it is without them.
TEST_F(CubeOfTwoPrimitives, IsNotJoinedToWhatLiesOnIt) {
    const auto points_of = [](const prep::Scene& scene, std::uint32_t part) {
        std::set<std::array<float, 3>> points;
        const prep::Mesh& mesh = scene.meshes[0];
        for (std::size_t f = 0; f < mesh.face_count(); ++f)
            for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
                if (mesh.face_parts[f] == part) {
                    const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
                    points.insert({p.x, p.y, p.z});
                }
        return points;
    };
    prep::Scene alone = as_polygons();
    alone.meshes[0].face_materials.assign(12, 0);
    prep::PrepareOptions options = catmark(1);
    options.subdivision.scheme = prep::SubdivisionScheme::loop;
    const auto refined = prep::prepare(in_a_file(*prep::prepare(alone)), options);
    ASSERT_TRUE(refined) << refined.error().text;
    const std::set<std::array<float, 3>> expected = points_of(in_a_file(*refined), 0);
    for (const std::size_t faces : {std::size_t(12), std::size_t(2), std::size_t(1)}) {
        prep::Scene covered = alone;
        prep::Mesh& mesh = covered.meshes[0];
        for (std::size_t f = 0; f < faces; ++f) {
            for (const std::size_t c : {3 * f, 3 * f + 2, 3 * f + 1}) {
                mesh.positions.push_back(mesh.positions[mesh.corner_vertices[c]]);
                mesh.corner_vertices.push_back(std::uint32_t(mesh.positions.size() - 1));
            }
            mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
            mesh.face_materials.push_back(1);
        }
        const auto prepared = prep::prepare(in_a_file(*prep::prepare(covered)), options);
        ASSERT_TRUE(prepared) << prepared.error().text;
        const prep::Scene written = in_a_file(*prepared);
        EXPECT_EQ(points_of(written, 0), expected) << faces;
        EXPECT_GT(count(*prepared, "parts-apart"), 0U);
        if (faces == 12) {
            EXPECT_EQ(points_of(written, 1).size(), expected.size());  // rounded otherwise
        }
    }
    EXPECT_EQ(count(*prep::prepare(as_document(), options), "parts-apart"), 0U);
}

// A sheet and its lining: their borders have two faces, and still are none of a pillow. A decal
// that is cut along the other diagonal repeats no face.
TEST_F(CubeOfTwoPrimitives, LinedSheetsAndDecalsCutOtherwiseStayApart) {
    const std::vector<glm::vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    for (const bool lining : {true, false}) {
        std::vector<glm::vec3> positions = square;
        positions.insert(positions.end(), square.begin(), square.end());
        const shapes::Faces faces = lining
                                        ? shapes::Faces{{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}}
                                        : shapes::Faces{{0, 1, 2}, {0, 2, 3}, {4, 5, 7}, {5, 6, 7}};
        prep::Mesh mesh = shapes::mesh_of(positions, faces);
        if (!lining) {  // the sheet goes on around it
            for (const glm::vec2 p : {glm::vec2(0.5F, -1), {2, 0.5F}, {0.5F, 2}, {-1, 0.5F}})
                mesh.positions.emplace_back(p.x, p.y, 0.0F);
            for (std::uint32_t k = 0; k < 4; ++k) {
                for (const std::uint32_t v : {(k + 1) % 4, k, 8 + k})
                    mesh.corner_vertices.push_back(v);
                mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
            }
        }
        mesh.face_materials.assign(mesh.face_count(), 0);
        mesh.face_materials[2] = mesh.face_materials[3] = 1;
        prep::Scene scene = scene_of(std::move(mesh));
        scene.materials.resize(2);
        prep::PrepareOptions options = catmark(1);
        options.subdivision.scheme = prep::SubdivisionScheme::loop;
        const auto prepared = prep::prepare(in_a_file(*prep::prepare(scene)), options);
        ASSERT_TRUE(prepared) << prepared.error().text;
        EXPECT_EQ(count(*prepared, "parts-apart"), 4U) << lining;
    }
}

// Where only one of the primitives has skin weights, the other's points, which come first, have
// none to move them by.
TEST_F(CubeOfTwoPrimitives, PointsBetweenPrimitivesHaveTheWeightsOfOne) {
    prep::Scene scene = as_document();
    prep::Mesh& mesh = scene.meshes[0];
    prep::SkinInfluences& set = mesh.skin_influences.emplace_back();
    set.joints.assign(mesh.vertex_count(), glm::u16vec4(0));
    set.weights.assign(mesh.vertex_count(), glm::vec4(0.0F));
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            if (mesh.face_parts[f] == 1) set.weights[mesh.corner_vertices[c]].x = 1;
    const auto prepared = prep::prepare(std::move(scene), catmark(1));
    ASSERT_TRUE(prepared) << prepared.error().text;
    const prep::Mesh& refined = prepared->scene.meshes[0];
    for (std::size_t f = 0; f < refined.face_count(); ++f)
        for (std::uint32_t c = refined.face_offsets[f]; c < refined.face_offsets[f + 1]; ++c)
            if (refined.face_parts[f] == 1) {
                const std::uint32_t v = refined.file_vertex(refined.corner_vertices[c]);
                EXPECT_NEAR(refined.skin_influences[0].weights[v].x, 1, 1e-6);
            }
}

// A cage whose coordinates floats hold, a million away, where a float's steps are a third of its
// edges: its surface is that of the same cage at zero, moved.
TEST(PrepareSubdivide, FarCagesHaveTheSurfaceOfNearOnes) {
    const glm::vec3 far(1e6F, -5e5F, 1e6F);
    prep::Mesh near = shapes::cube();
    for (glm::vec3& p : near.positions) p *= 0.125F;
    prep::Mesh moved = near;
    for (glm::vec3& p : moved.positions) p += far;
    for (std::size_t v = 0; v < near.vertex_count(); ++v)
        ASSERT_EQ(moved.positions[v] - far, near.positions[v]);
    const auto of_near = prep::prepare(scene_of(near), catmark(3));
    const auto of_moved = prep::prepare(scene_of(moved), catmark(3));
    ASSERT_TRUE(of_near && of_moved);
    const prep::VertexMesh &a = of_near->meshes[0], &b = of_moved->meshes[0];
    ASSERT_EQ(a.vertex_count(), b.vertex_count());
    for (std::size_t v = 0; v < a.vertex_count(); ++v) {
        const glm::dvec3 back = b.origin + glm::dvec3(b.positions[v]) - glm::dvec3(far);
        // Half a step of floats of the cage's size, in each of three coordinates, twice.
        ASSERT_LT(glm::length(back - glm::dvec3(a.positions[v])), 1e-7) << v;
    }
    // A vertex that no face uses says nothing of where the cage is; adaptive triangles as well.
    prep::Mesh loose = moved;
    loose.positions.emplace_back(0.0F);
    loose.points = {std::uint32_t(loose.vertex_count() - 1)};
    prep::PrepareOptions fine;
    fine.tessellate = true;
    fine.tessellation.edge_length = 0.03;
    for (const prep::PrepareOptions& options : {catmark(3), fine}) {
        const auto here = prep::prepare(scene_of(near), options);
        const auto there = prep::prepare(scene_of(loose), options);
        ASSERT_TRUE(here) << to_string(here.error());
        ASSERT_TRUE(there) << to_string(there.error());
        EXPECT_EQ(there->meshes[0].triangle_count(), here->meshes[0].triangle_count());
        EXPECT_NE(there->meshes[0].origin, glm::dvec3(0.0));
    }
    // A document's node has the mesh where it is: its new points are rounded, and that is told.
    test::TempDir folder;
    const auto first = prep::prepare(scene_of(moved));
    ASSERT_TRUE(first && prep::save_scene(*first, folder / "far.glb"));
    auto scene = prep::load_scene(folder / "far.glb");
    ASSERT_TRUE(scene);
    prep::Scene copy = *scene;
    const auto rounded = prep::prepare(*std::move(scene), catmark(1));
    ASSERT_TRUE(rounded);
    EXPECT_EQ(count(*rounded, "far-from-origin"), 1u);
    prep::PrepareOptions other = catmark(1);
    other.document_stays = false;
    const auto exact = prep::prepare(std::move(copy), other);
    ASSERT_TRUE(exact);
    EXPECT_EQ(count(*exact, "far-from-origin"), 0u);
    EXPECT_NE(exact->meshes[0].origin, glm::dvec3(0.0));
    EXPECT_EQ(count(*of_moved, "far-from-origin"), 0u);
}

// A document keeps its lines and points, and no set is left out of faces that had none of it.
TEST(PrepareSubdivide, NothingIsToldAsLostThatTheDocumentKeeps) {
    prep::Mesh mesh = shapes::cube();
    const auto corners = std::uint32_t(mesh.vertex_count());
    mesh.positions.insert(mesh.positions.end(), {{3, 0, 0}, {4, 0, 0}});
    mesh.line_vertices = {corners, corners + 1};
    mesh.line_offsets = {0, 2};
    mesh.points = {corners};
    mesh.vertex_colors.assign(mesh.vertex_count(), {1, 0, 0, 1});
    test::TempDir folder;
    const auto first = prep::prepare(scene_of(mesh));
    ASSERT_TRUE(first && prep::save_scene(*first, folder / "a.glb"));
    prep::PrepareOptions adaptive;
    adaptive.tessellate = true;
    adaptive.tessellation.edge_length = 0.5;
    for (const prep::PrepareOptions& options : {catmark(1), adaptive}) {
        auto scene = prep::load_scene(folder / "a.glb");
        ASSERT_TRUE(scene);
        const auto prepared = prep::prepare(*std::move(scene), options);
        ASSERT_TRUE(prepared) << to_string(prepared.error());
        EXPECT_EQ(count(*prepared, "loose-parts-left-out"), 0u);
        EXPECT_EQ(count(*prepared, "partial-color-set"), 0u);
        ASSERT_TRUE(prep::save_scene(*prepared, folder / "b.glb"));
        const auto written = prep::load_scene(folder / "b.glb");
        ASSERT_TRUE(written);
        EXPECT_EQ(written->meshes[0].points.size(), 1u);
        EXPECT_EQ(written->meshes[0].line_vertices.size(), 2u);
    }
    const auto lost = prep::prepare(scene_of(mesh), adaptive);
    ASSERT_TRUE(lost);
    EXPECT_EQ(count(*lost, "loose-parts-left-out"), 2u);
}

// Materials that get no residual map keep their own normal maps, and tangents along their UV sets.
TEST(PrepareSubdivide, ResidualMapsLeaveTheOthersTheirUvSets) {
    prep::Mesh mesh = shapes::grid(3, 1);
    mesh.uvs.resize(2);
    for (const glm::vec3& p : mesh.positions) {
        mesh.uvs[0].values.emplace_back(p.x / 4, p.y / 4);
        mesh.uvs[1].values.emplace_back(p.y / 4, p.x / 4);
    }
    mesh.uvs[0].indices = mesh.uvs[1].indices = mesh.corner_vertices;
    mesh.face_materials = {0, 1, 2};
    prep::Scene scene = scene_of(mesh);
    scene.textures.resize(1);
    scene.materials.resize(3);
    scene.materials[0].normal_map.texture = scene.materials[1].normal_map.texture = 0;
    scene.materials[1].normal_map.uv_set = 1;
    prep::PrepareOptions options;
    options.tessellate = true;
    options.tessellation.edge_length = 5;
    options.displacement.residual.emplace().size = 8;
    const auto prepared = prep::prepare(std::move(scene), options);
    ASSERT_TRUE(prepared) << to_string(prepared.error());
    const prep::Mesh& out = prepared->scene.meshes[0];
    std::array<std::size_t, 3> faces{};
    for (std::uint32_t f = 0; f < out.face_count(); ++f) {
        const std::uint32_t material = out.face_materials[f];
        const prep::TextureRef& map = prepared->scene.materials[material].normal_map;
        ++faces[std::min<std::size_t>(material, 2)];
        for (std::uint32_t c = out.face_offsets[f]; map && c < out.face_offsets[f + 1]; ++c)
            EXPECT_LT(glm::length(glm::vec3(out.tangents.values[out.tangents.indices[c]]) -
                                  (map.uv_set == 1 ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0))),
                      1e-6F)
                << material;
    }
    EXPECT_EQ(prepared->scene.materials[1].normal_map.uv_set, 1u);
    for (const std::size_t count : faces) EXPECT_GT(count, 0u);
}

}  // namespace
