// What files say of meshes whose triangles and vertices were put in another order.
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "mesh_files.h"
#include "prep/load.h"
#include "prep/output/vertex_order.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "shapes.h"

namespace {

// Triangles in random order.
prep::Mesh scrambled(const prep::Mesh& mesh) {
    std::mt19937_64 random(3);
    return shapes::with_face_order(mesh, shapes::random_order(mesh.face_count(), random));
}

prep::PreparedScene prepared(std::vector<prep::Mesh> meshes, bool optimize) {
    prep::Scene scene;
    for (prep::Mesh& mesh : meshes) {
        prep::Node node;
        node.mesh = std::uint32_t(scene.meshes.size());
        scene.meshes.push_back(std::move(mesh));
        scene.nodes.push_back(std::move(node));
    }
    prep::PrepareOptions options;
    options.optimize = optimize;
    auto result = prep::prepare(std::move(scene), options);
    EXPECT_TRUE(result);
    return *std::move(result);
}

using Notes = std::vector<std::string>;

Notes notes_of(const prep::PreparedScene& scene, const char* name,
               prep::Compression compression = prep::Compression::none) {
    const test::TempDir dir;
    prep::SaveOptions options;
    options.compression = compression;
    const auto notes = prep::save_scene(scene, dir / name, options);
    EXPECT_TRUE(notes) << notes.error().text;
    return *notes;
}

TEST(OrderedFiles, DracosOwnOrderIsNoted) {
    const prep::Mesh sheet = scrambled(shapes::fan_triangulated(shapes::grid(20, 20)));
    // Edgebreaker would lose a triangle with two corners in one place: all stay as they are.
    prep::Mesh folded = sheet;
    folded.corner_vertices[1] = folded.corner_vertices[0];
    const std::string rest =
        " in Draco's order, not in the optimized one: --compress meshopt or none keeps that";
    const auto draco = prep::Compression::draco;
    EXPECT_EQ(notes_of(prepared({sheet}, true), "a.glb", draco), Notes{"1 primitive is" + rest});
    EXPECT_EQ(notes_of(prepared({sheet, folded, sheet}, true), "a.glb", draco),
              Notes{"2 primitives are" + rest});
    EXPECT_EQ(notes_of(prepared({folded}, true), "a.glb", draco), Notes{});
    EXPECT_EQ(notes_of(prepared({sheet}, false), "a.glb", draco), Notes{});
    EXPECT_EQ(notes_of(prepared({sheet}, true), "a.glb"), Notes{});
}

// Also where a program has put them in another order after they were split.
TEST(OrderedFiles, UnusedVerticesAreCounted) {
    prep::Mesh mesh = scrambled(shapes::fan_triangulated(shapes::cube()));
    for (int i = 0; i < 3; ++i) mesh.positions.emplace_back(9, 9, i);
    prep::PreparedScene scene = prepared({mesh}, false);
    const Notes before = notes_of(scene, "a.ply");
    ASSERT_EQ(before, Notes{"3 vertices that no face, line or point uses left out"});
    prep::optimize_order(scene.meshes[0]);
    EXPECT_EQ(notes_of(scene, "a.ply"), before);
}

}  // namespace
