// Values at the edge of what text and bytes hold: floats far from zero, nodes without thickness,
// colours of PLY, the alpha that OBJ has none of.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "shapes.h"

namespace {

using Notes = std::vector<std::string>;

prep::Scene placed(prep::Mesh mesh, const glm::dmat4& transform = glm::dmat4(1.0)) {
    prep::Scene scene;
    scene.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(scene);
    scene.nodes[0].transform = transform;
    return scene;
}

Notes saved(prep::Scene scene, const std::filesystem::path& path, bool ascii = false,
            const prep::PrepareOptions& prepare = {}) {
    const auto prepared = prep::prepare(std::move(scene), prepare);
    EXPECT_TRUE(prepared) << to_string(prepared.error());
    prep::SaveOptions options;
    options.ascii = ascii;
    const auto notes = prep::save_scene(*prepared, path, options);
    EXPECT_TRUE(notes) << to_string(notes.error());
    return *notes;
}

prep::Mesh loaded(const std::filesystem::path& path) {
    const auto scene = prep::load_scene(path);
    EXPECT_TRUE(scene) << to_string(scene.error());
    return scene->meshes.at(0);
}

bool has(const Notes& notes, const std::string& text) {
    return std::find(notes.begin(), notes.end(), text) != notes.end();
}

// Corners of a box a million away are multiples of 1/16 (four million: 1/4), and a float's shortest
// digits are some other number: a reader that takes text for doubles moves them.
TEST(WrittenText, FarFloatsComeBackToTheBit) {
    for (const float far : {1e6F, -3e5F, 4e6F}) {
        prep::Mesh mesh = shapes::cube();
        for (glm::vec3& p : mesh.positions) p = glm::vec3(far, 0.5F * far, far) + 0.1875F * p;
        const test::TempDir dir;
        for (const char* const name : {"a.obj", "a.off", "a.ply", "a.stl"}) {
            SCOPED_TRACE(name);
            saved(placed(mesh), dir / name, true);
            const prep::Mesh read = loaded(dir / name);
            std::vector<std::array<double, 3>> got, wanted;
            for (const glm::vec3& p : read.positions) {
                const glm::dvec3 at = read.origin + glm::dvec3(p);
                got.push_back({at.x, at.y, at.z});
            }
            for (const glm::vec3& p : mesh.positions) wanted.push_back({p.x, p.y, p.z});
            for (auto* list : {&got, &wanted}) {
                std::sort(list->begin(), list->end());
                list->erase(std::unique(list->begin(), list->end()), list->end());
            }
            EXPECT_EQ(got, wanted);
        }
    }
    // Near ones are written as short as ever.
    const test::TempDir dir;
    prep::Mesh near = shapes::cube();
    for (glm::vec3& p : near.positions) p *= 0.1F;
    saved(placed(near), dir / "a.obj");
    EXPECT_NE(test::file_text(dir / "a.obj").find("v -0.1 "), std::string::npos)
        << test::file_text(dir / "a.obj").substr(0, 200);
}

// A node that leaves a line or a point leaves no normal: those of the mesh stay, none is zero.
TEST(WrittenText, NodesWithoutThicknessLeaveNormalsOfLengthOne) {
    for (const glm::dvec3& scale : {glm::dvec3(1, 0, 0), glm::dvec3(0.0), glm::dvec3(1, 0, 1)}) {
        glm::dmat4 flat(1.0);
        for (int k = 0; k < 3; ++k) flat[k][k] = scale[k];
        for (const char* const name : {"a.obj", "a.off", "a.ply"}) {
            SCOPED_TRACE(name);
            const test::TempDir dir;
            saved(placed(shapes::cube(), flat), dir / name);
            const prep::Mesh read = loaded(dir / name);
            ASSERT_FALSE(read.normals.empty());
            for (const glm::vec3& n : read.normals.values)
                EXPECT_NEAR(glm::length(n), 1, 1e-6) << n.x << ' ' << n.y << ' ' << n.z;
        }
    }
}

prep::Mesh colored(const glm::vec4& color) {
    prep::Mesh mesh = shapes::cube();
    mesh.colors.resize(1);
    mesh.colors[0].values = {color};
    mesh.colors[0].indices.assign(mesh.corner_count(), 0);
    return mesh;
}

TEST(WrittenText, PlyTellsThatColorsWereRounded) {
    const std::string rounded = "PLY's colours are bytes here: they were rounded to them";
    const test::TempDir dir;
    EXPECT_TRUE(has(saved(placed(colored({0.3F, 0, 1, 1})), dir / "a.ply"), rounded));
    EXPECT_TRUE(has(saved(placed(colored({0, 0, 1, 0.3F})), dir / "a.ply"), rounded));
    EXPECT_FALSE(has(saved(placed(colored({0, 0, 1, 1})), dir / "a.ply"), rounded));
    // Bytes that were read are those that are written.
    saved(placed(colored({0.3F, 0.7F, 0.01F, 0.6F})), dir / "a.ply");
    const auto again = prep::load_scene(dir / "a.ply");
    ASSERT_TRUE(again);
    EXPECT_FALSE(has(saved(*again, dir / "b.ply"), rounded));
}

// Vertices of a subdivided surface have no colours of their own beside those of its corners.
TEST(WrittenText, NoAlphaIsToldWhereThereIsNone) {
    const std::string alpha = "OBJ holds colours without alpha: left out";
    prep::Mesh mesh = colored({0.5F, 1, 0, 1});
    mesh.vertex_colors.assign(mesh.vertex_count(), {1, 0, 0, 1});
    mesh.line_vertices = {0, 1};
    mesh.line_offsets = {0, 2};
    prep::PrepareOptions options;
    options.subdivide = true;
    options.subdivision.level = 1;
    const test::TempDir dir;
    EXPECT_FALSE(has(saved(placed(mesh), dir / "a.obj"), alpha));
    EXPECT_FALSE(has(saved(placed(mesh), dir / "a.obj", false, options), alpha));
    EXPECT_TRUE(has(saved(placed(colored({0.5F, 1, 0, 0.5F})), dir / "a.obj"), alpha));
}

TEST(WrittenText, LinesAndPointsThatAreNowhereAreTold) {
    prep::Mesh mesh;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {nan, 0, 0}};
    mesh.line_vertices = {0, 1, 2, 0, 1};
    mesh.line_offsets = {0, 3, 5};
    mesh.points = {2, 0};
    const test::TempDir dir;
    const Notes notes = saved(placed(mesh), dir / "a.glb");
    EXPECT_TRUE(has(notes, "1 line segment with a position that is not finite left out"));
    EXPECT_TRUE(has(notes, "1 point with a position that is not finite left out"));
    const prep::Mesh read = loaded(dir / "a.glb");
    EXPECT_EQ(read.points.size(), 1U);
    EXPECT_EQ(read.line_vertices.size() - (read.line_offsets.size() - 1), 2U);  // segments
}

}  // namespace
