// The shapes of scene files against their closed forms: where their points lie, which way they
// face, how large they are, and which way their textures run.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "prep/check.h"
#include "prep/face_normals.h"
#include "prep/scene_json.h"

namespace {

using prep::Mesh;
constexpr double pi = std::numbers::pi;

// The mesh of a scene file that has this shape and nothing else.
Mesh shape(const std::string& members) {
    const auto scene = prep::parse_scene_json(
        R"({"meshprep": 1, "meshes": {"a": {"shape": {)" + members + "}}}}", "nowhere/s.json");
    EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    return scene ? scene->scene.meshes.at(0) : Mesh{};
}

glm::vec3 position(const Mesh& mesh, std::size_t corner) {
    return mesh.positions[mesh.corner_vertices[corner]];
}
glm::vec2 uv(const Mesh& mesh, std::size_t corner) {
    return mesh.uvs[0].values[mesh.uvs[0].indices[corner]];
}

// Closed, outward, and nothing mirrored: what is written in the texture can be read on it.
prep::MeshSummary expect_solid(const Mesh& mesh) {
    const prep::MeshCheck result = prep::check(mesh);
    const prep::MeshSummary& s = result.summary;
    EXPECT_TRUE(s.closed && s.manifold && s.oriented);
    EXPECT_EQ(s.mirrored_uv_faces, 0u);
    for (const prep::Finding& f : result.findings)
        EXPECT_TRUE(f.kind == "non-planar-face") << f.kind;
    return s;
}

TEST(SceneShapes, PlaneHasItsSizesAndItsUvsFromTheCorner) {
    const Mesh mesh = shape(R"("kind": "plane", "size": [2, 9, 3], "segments": 4, "rings": 5)");
    EXPECT_EQ(mesh.face_count(), 20u);
    const prep::MeshSummary s = prep::check(mesh).summary;
    EXPECT_EQ(s.low, glm::dvec3(-1, 0, -1.5));
    EXPECT_EQ(s.high, glm::dvec3(1, 0, 1.5));
    EXPECT_NEAR(s.area, 6, 1e-6);
    EXPECT_EQ(s.mirrored_uv_faces, 0u);
    for (const glm::dvec3& area : prep::face_normals(prep::MeshView(mesh)).area_vectors)
        EXPECT_GT(area.y, 0);
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::vec3 p = position(mesh, c);
        EXPECT_NEAR(uv(mesh, c).x, p.x / 2 + 0.5f, 1e-6);
        EXPECT_NEAR(uv(mesh, c).y, p.z / 3 + 0.5f, 1e-6);
    }
}

TEST(SceneShapes, BoxHasItsThreeSizesAndTheWholeTextureOnEachFace) {
    const Mesh mesh = shape(R"("kind": "box", "size": [1, 2, 3])");
    const prep::MeshSummary s = expect_solid(mesh);
    EXPECT_EQ(s.low, glm::dvec3(-0.5, -1, -1.5));
    EXPECT_EQ(s.high, glm::dvec3(0.5, 1, 1.5));
    EXPECT_DOUBLE_EQ(s.volume, 6);
    EXPECT_DOUBLE_EQ(s.area, 2 * (2 + 3 + 6));
    for (std::uint32_t f = 0; f < 6; ++f) {
        glm::vec2 sum(0.0f);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const glm::vec2 t = uv(mesh, 4 * f + k);
            EXPECT_TRUE((t.x == 0 || t.x == 1) && (t.y == 0 || t.y == 1));
            sum += t;
            // The picture stands upright on the sides: its lower edge is below.
            const glm::vec3 p = position(mesh, 4 * f + k);
            const glm::dvec3 n = prep::face_normals(prep::MeshView(mesh)).area_vectors[f];
            if (n.y == 0) {
                EXPECT_EQ(t.y, p.y > 0 ? 0.0f : 1.0f);
            }
        }
        EXPECT_EQ(sum, glm::vec2(2, 2));
    }
}

TEST(SceneShapes, SphereIsRoundAndItsTextureRunsFromXTowardsMinusZ) {
    const std::uint32_t segments = 24, rings = 12;
    const Mesh mesh = shape(R"("kind": "sphere", "radius": 2, "segments": 24, "rings": 12)");
    const prep::MeshSummary s = expect_solid(mesh);
    EXPECT_EQ(s.euler, 2);
    EXPECT_EQ(mesh.vertex_count(), 2u + (rings - 1) * segments);
    for (const glm::vec3& p : mesh.positions) EXPECT_NEAR(glm::length(p), 2, 1e-6);
    // Inscribed: by the second order of the steps smaller than the ball.
    EXPECT_LT(s.volume, 4.0 / 3 * pi * 8);
    EXPECT_GT(s.volume, 4.0 / 3 * pi * 8 * 0.97);
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::dvec3 p(position(mesh, c));
        const glm::dvec2 t(uv(mesh, c));
        EXPECT_NEAR(std::cos(pi * t.y), p.y / 2, 1e-6);
        const double across = std::sqrt(p.x * p.x + p.z * p.z);
        if (across < 1e-6) continue;
        EXPECT_NEAR(std::cos(2 * pi * t.x), p.x / across, 1e-6);
        EXPECT_NEAR(std::sin(2 * pi * t.x), -p.z / across, 1e-6);
    }
}

TEST(SceneShapes, CylinderHasAPrismsVolumeAndDiscsOnItsCaps) {
    const std::uint32_t segments = 7;
    const Mesh mesh = shape(R"("kind": "cylinder", "radius": 2, "height": 3, "segments": 7)");
    const prep::MeshSummary s = expect_solid(mesh);
    const double base = 0.5 * segments * 4 * std::sin(2 * pi / segments);
    EXPECT_NEAR(s.volume, 3 * base, 1e-5);
    EXPECT_NEAR(s.area, 2 * base + 3 * segments * 4 * std::sin(pi / segments), 1e-5);
    for (std::uint32_t cap = 0; cap < 2; ++cap) {
        const std::uint32_t f = segments + cap;
        ASSERT_EQ(mesh.face_offsets[f + 1] - mesh.face_offsets[f], segments);
        const double y = position(mesh, mesh.face_offsets[f]).y;
        EXPECT_EQ(y, cap == 0 ? 1.5 : -1.5);
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const glm::vec3 p = position(mesh, c);
            // From the cap's own side +X is to the right; +Z is down on top and up below.
            EXPECT_NEAR(uv(mesh, c).x, 0.5 + p.x / 4, 1e-6);
            EXPECT_NEAR(uv(mesh, c).y, 0.5 + (cap == 0 ? 1 : -1) * p.z / 4, 1e-6);
        }
    }
}

TEST(SceneShapes, TorusHasPappusVolumeAndItsUvs) {
    const std::uint32_t segments = 40, sides = 10;
    const Mesh mesh =
        shape(R"("kind": "torus", "radius": 3, "tube": 0.5, "segments": 40, "rings": 10)");
    const prep::MeshSummary s = expect_solid(mesh);
    EXPECT_EQ(s.genus, 1);
    // A polygon of `sides` corners that goes around in steps: area times the way of its centre,
    // each step a chord.
    const double section = 0.5 * sides * 0.25 * std::sin(2 * pi / sides);
    const double way = segments * std::sin(2 * pi / segments) * 3;
    EXPECT_NEAR(s.volume, section * way, 1e-3 * section * way);
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::dvec3 p(position(mesh, c));
        const glm::dvec2 t(uv(mesh, c));
        const double from_axis = std::sqrt(p.x * p.x + p.z * p.z);
        EXPECT_NEAR(std::cos(2 * pi * t.x), p.x / from_axis, 1e-6);
        EXPECT_NEAR(std::sin(2 * pi * t.x), -p.z / from_axis, 1e-6);
        EXPECT_NEAR(3 + 0.5 * std::cos(2 * pi * t.y), from_axis, 1e-6);
        EXPECT_NEAR(-0.5 * std::sin(2 * pi * t.y), p.y, 1e-6);  // v runs down
    }
}

TEST(SceneShapes, QuarterTurnsLieOnTheAxes) {
    for (const Mesh& mesh :
         {shape(R"("kind": "sphere", "radius": 1, "segments": 8, "rings": 4)"),
          shape(R"("kind": "cylinder", "radius": 1, "height": 2, "segments": 8)"),
          shape(R"("kind": "torus", "radius": 2, "tube": 1, "segments": 8, "rings": 8)")})
        for (const glm::vec3& p : mesh.positions)
            for (int k = 0; k < 3; ++k) EXPECT_TRUE(p[k] == 0 || std::abs(p[k]) > 1e-3f) << p[k];
}

}  // namespace
