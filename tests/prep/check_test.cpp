#include "prep/check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "shapes.h"

namespace {

using prep::Finding;
using prep::Mesh;

const Finding* find(const std::vector<Finding>& findings, const std::string& kind) {
    for (const Finding& f : findings)
        if (f.kind == kind) return &f;
    return nullptr;
}

std::uint64_t count(const std::vector<Finding>& findings, const std::string& kind) {
    const Finding* f = find(findings, kind);
    return f ? f->count : 0;
}

std::vector<std::string> kinds(const std::vector<Finding>& findings) {
    std::vector<std::string> result;
    for (const Finding& f : findings) result.push_back(f.kind);
    return result;
}

using Kinds = std::vector<std::string>;

TEST(Check, CubeIsClosedManifoldAndWithoutFindings) {
    const prep::MeshCheck result = prep::check(shapes::cube());
    EXPECT_EQ(kinds(result.findings), Kinds{});
    const prep::MeshSummary& s = result.summary;
    EXPECT_EQ(s.vertices, 8u);
    EXPECT_EQ(s.points, 8u);
    EXPECT_EQ(s.faces, 6u);
    EXPECT_EQ(s.quads, 6u);
    EXPECT_EQ(s.edges, 12u);
    EXPECT_EQ(s.components, 1u);
    EXPECT_EQ(s.euler, 2);
    EXPECT_EQ(s.genus, 0);
    EXPECT_EQ(s.largest_valence, 3u);
    EXPECT_TRUE(s.closed && s.manifold && s.oriented);
    EXPECT_EQ(s.area, 24.0);
    EXPECT_EQ(s.volume, 8.0);
    EXPECT_EQ(s.low, glm::dvec3(-1.0));
    EXPECT_EQ(s.high, glm::dvec3(1.0));
}

TEST(Check, SoupOfTheCubeIsTheSameSurface) {
    const prep::MeshCheck result = prep::check(shapes::soup(shapes::cube()));
    EXPECT_EQ(kinds(result.findings), Kinds{"repeated-position"});
    EXPECT_EQ(count(result.findings, "repeated-position"), 16u);
    EXPECT_EQ(result.summary.points, 8u);
    EXPECT_EQ(result.summary.euler, 2);
    EXPECT_TRUE(result.summary.closed);
}

TEST(Check, EmptyMeshSaysSo) {
    const prep::MeshCheck result = prep::check(Mesh{});
    EXPECT_EQ(kinds(result.findings), Kinds{"empty-mesh"});
    EXPECT_FALSE(result.summary.closed);
    EXPECT_EQ(result.summary.euler, 0);
}

TEST(Check, TorusHasGenusOne) {
    const prep::MeshSummary s = prep::check(shapes::torus(24, 12)).summary;
    EXPECT_EQ(s.euler, 0);
    EXPECT_EQ(s.genus, 1);
    // Inscribed in 2π²·R·r²: below it, and by no more than the second order of the steps.
    const double ideal = 2 * std::numbers::pi * std::numbers::pi * 0.16;
    EXPECT_LT(s.volume, ideal);
    EXPECT_GT(s.volume, 0.9 * ideal);
}

TEST(Check, OneTriangleIsOneHole) {
    const prep::MeshCheck result =
        prep::check(shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
    EXPECT_EQ(kinds(result.findings), (Kinds{"open-edge", "hole"}));
    EXPECT_EQ(count(result.findings, "open-edge"), 3u);
    EXPECT_EQ(find(result.findings, "open-edge")->places, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(result.summary.holes, 1u);
    EXPECT_EQ(result.summary.euler, 1);
    EXPECT_EQ(result.summary.genus, -1);
    EXPECT_EQ(result.summary.area, 0.5);
}

// Turning faces makes no loop and ends none.
TEST(Check, HolesAreCountedByLoopHoweverFacesAreTurned) {
    std::mt19937 random(3);
    const auto turned = [&](Mesh mesh) {
        for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
            if (random() % 3 == 0)
                std::reverse(mesh.corner_vertices.begin() + mesh.face_offsets[f],
                             mesh.corner_vertices.begin() + mesh.face_offsets[f + 1]);
        return mesh;
    };
    // A band of quads whose ends meet, straight or after half a turn.
    const auto band = [](bool moebius) {
        constexpr std::uint32_t count = 12;
        std::vector<glm::vec3> positions;
        std::vector<std::vector<std::uint32_t>> faces;
        for (std::uint32_t i = 0; i < count; ++i)
            for (std::uint32_t k = 0; k < 2; ++k)
                positions.emplace_back(float(i % 5), float(i), float(k));
        for (std::uint32_t i = 0; i < count; ++i) {
            const bool last = i + 1 == count;
            const std::uint32_t to = last ? 0 : 2 * i + 2, swap = last && moebius ? 1 : 0;
            faces.push_back({2 * i, to + swap, to + 1 - swap, 2 * i + 1});
        }
        return shapes::mesh_of(positions, faces);
    };
    std::vector<std::uint32_t> kept;
    for (std::uint32_t f = 0; f < 25; ++f)
        if (f != 6 && f != 18) kept.push_back(f);
    const Mesh sheet = shapes::with_face_order(shapes::grid(5, 5), kept);
    for (int k = 0; k < 50; ++k) {
        EXPECT_EQ(prep::check(turned(sheet)).summary.holes, 3U);
        EXPECT_EQ(prep::check(turned(band(false))).summary.holes, 2U);
        EXPECT_EQ(prep::check(turned(band(true))).summary.holes, 1U);
    }
}

TEST(Check, HolesAreCountedByLoop) {
    // A 5 × 5 grid without its middle and without one more face: rim and two holes.
    Mesh mesh = shapes::grid(5, 5);
    std::vector<std::uint32_t> kept;
    for (std::uint32_t f = 0; f < 25; ++f)
        if (f != 6 && f != 18) kept.push_back(f);
    mesh = shapes::with_face_order(mesh, kept);
    const prep::MeshCheck result = prep::check(mesh);
    EXPECT_EQ(result.summary.holes, 3u);
    EXPECT_EQ(result.summary.open_edges, 20u + 8u);
    EXPECT_EQ(result.summary.euler, 1 - 2);
    EXPECT_EQ(count(result.findings, "non-manifold-vertex"), 0u);
}

TEST(Check, BowTieVertexIsNotManifold) {
    const prep::MeshCheck result = prep::check(shapes::bow_tie());
    EXPECT_EQ(kinds(result.findings), Kinds{"non-manifold-vertex"});
    EXPECT_EQ(find(result.findings, "non-manifold-vertex")->places, std::vector<std::uint32_t>{0});
    EXPECT_EQ(result.summary.components, 2u);
    EXPECT_EQ(result.summary.euler, 3);  // two spheres with one vertex in common
    EXPECT_EQ(result.summary.genus, -1);
}

TEST(Check, BowTieIsFoundInASoupToo) {
    EXPECT_EQ(prep::check(shapes::soup(shapes::bow_tie())).summary.non_manifold_vertices, 1u);
}

TEST(Check, TouchingShellsWithVerticesOfTheirOwnAreManifold) {
    Mesh other = shapes::cube();
    for (glm::vec3& p : other.positions) p += glm::vec3(2.0f);  // corner to corner
    const prep::MeshCheck result = prep::check(shapes::joined(shapes::cube(), other));
    EXPECT_EQ(kinds(result.findings), Kinds{"repeated-position"});
    EXPECT_EQ(result.summary.euler, 4);
    EXPECT_EQ(result.summary.genus, 0);
}

TEST(Check, EdgesOfThreeAndMoreFaces) {
    for (const std::uint32_t faces : {3u, 5u, 64u}) {
        const prep::MeshCheck result = prep::check(shapes::book(faces));
        EXPECT_EQ(count(result.findings, "non-manifold-edge"), 1u) << faces;
        EXPECT_EQ(result.summary.edges, 1u + 2 * faces);
        EXPECT_EQ(result.summary.components, 1u);
        EXPECT_EQ(count(result.findings, "non-manifold-vertex"), 0u);
    }
}

TEST(Check, MixedOrientationIsAnEdgeNotAVertexDefect) {
    Mesh mesh = shapes::cube();
    std::reverse(mesh.corner_vertices.begin(), mesh.corner_vertices.begin() + 4);
    const prep::MeshCheck result = prep::check(mesh);
    EXPECT_EQ(kinds(result.findings), Kinds{"mixed-orientation"});
    EXPECT_EQ(count(result.findings, "mixed-orientation"), 4u);
    EXPECT_TRUE(result.summary.closed);
    EXPECT_FALSE(result.summary.oriented);
}

TEST(Check, MoebiusStripIsOneSided) {
    const prep::MeshCheck result = prep::check(shapes::moebius(12));
    EXPECT_EQ(count(result.findings, "mixed-orientation"), 1u);
    EXPECT_EQ(result.summary.euler, 0);
    EXPECT_FALSE(result.summary.closed);
}

TEST(Check, InsideOutShellButNotACavity) {
    Mesh inner = shapes::cube();
    for (glm::vec3& p : inner.positions) p *= 0.5f;
    for (std::uint32_t f = 0; f < 6; ++f)
        std::reverse(inner.corner_vertices.begin() + 4 * f,
                     inner.corner_vertices.begin() + 4 * f + 4);
    const prep::MeshCheck alone = prep::check(inner);
    EXPECT_EQ(kinds(alone.findings), Kinds{"inside-out-shell"});
    EXPECT_EQ(alone.summary.volume, -1.0);
    const prep::MeshCheck hollow = prep::check(shapes::joined(shapes::cube(), inner));
    EXPECT_EQ(kinds(hollow.findings), Kinds{});
    EXPECT_EQ(hollow.summary.volume, 7.0);
}

TEST(Check, DegenerateDuplicateAndFoldedFaces) {
    // 0: good, 1: repeats it rotated, 2: opposite, 3: repeated vertex, 4: collinear.
    const Mesh mesh =
        shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {7, 0, 0}},
                        {{0, 1, 2}, {1, 2, 0}, {2, 1, 0}, {3, 4, 3}, {3, 4, 5}});
    const auto findings = prep::check(mesh).findings;
    EXPECT_EQ(find(findings, "duplicate-face")->places, std::vector<std::uint32_t>{1});
    EXPECT_EQ(find(findings, "opposite-face")->places, std::vector<std::uint32_t>{2});
    EXPECT_EQ(find(findings, "repeated-vertex-face")->places, std::vector<std::uint32_t>{3});
    EXPECT_EQ(find(findings, "zero-area-face")->places, std::vector<std::uint32_t>{4});
}

TEST(Check, FoldedFacesLieOnEachOther) {
    const Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5f, 0.25f, 0}},
                                      {{0, 1, 2}, {1, 0, 3}});
    EXPECT_EQ(count(prep::check(mesh).findings, "folded-edge"), 1u);
    EXPECT_EQ(count(prep::check(shapes::cube()).findings, "folded-edge"), 0u);
}

TEST(Check, NonFiniteAndDenormalVertices) {
    Mesh mesh = shapes::cube();
    mesh.positions[3].x = std::numeric_limits<float>::quiet_NaN();
    mesh.positions[5].y = std::numeric_limits<float>::infinity();
    mesh.positions[6].z = 1e-40f;
    const prep::MeshCheck result = prep::check(mesh);
    EXPECT_EQ(find(result.findings, "non-finite-vertex")->places,
              (std::vector<std::uint32_t>{3, 5}));
    EXPECT_EQ(find(result.findings, "non-finite-vertex")->severity, prep::Severity::error);
    EXPECT_EQ(find(result.findings, "denormal-vertex")->places, std::vector<std::uint32_t>{6});
    EXPECT_TRUE(std::isfinite(result.summary.area));
    EXPECT_TRUE(std::isfinite(result.summary.high.x));
}

TEST(Check, UnreferencedVerticesAndPoints) {
    Mesh mesh = shapes::cube();
    mesh.positions.push_back({9, 9, 9});
    mesh.positions.push_back({8, 8, 8});
    mesh.points = {9};
    const prep::MeshCheck result = prep::check(mesh);
    EXPECT_EQ(find(result.findings, "unreferenced-vertex")->places, std::vector<std::uint32_t>{8});
    EXPECT_EQ(find(result.findings, "isolated-point")->places, std::vector<std::uint32_t>{9});
    EXPECT_EQ(result.summary.high, glm::dvec3(8.0));  // what nothing uses does not count
}

TEST(Check, FarFromOriginLosesPrecision) {
    Mesh mesh = shapes::cube();
    for (glm::vec3& p : mesh.positions) p += 1e6f;
    EXPECT_EQ(count(prep::check(mesh).findings, "far-from-origin"), 1u);
    Mesh centred = shapes::cube();
    centred.origin = glm::dvec3(1e6);
    const prep::MeshCheck result = prep::check(centred);
    EXPECT_EQ(count(result.findings, "far-from-origin"), 0u);
    EXPECT_EQ(result.summary.high, glm::dvec3(1000001.0));
}

TEST(Check, NonPlanarPolygon) {
    Mesh mesh = shapes::grid(1, 1);
    EXPECT_EQ(count(prep::check(mesh).findings, "non-planar-face"), 0u);
    mesh.positions[3].z = 0.5f;
    EXPECT_EQ(count(prep::check(mesh).findings, "non-planar-face"), 1u);
}

TEST(Check, AuthoredNormalsAndTangents) {
    Mesh mesh = shapes::grid(1, 1);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    mesh.normals.values = {{0, 0, 1}, {0, 0, -1}, {0, 0, 0}, {nan, 0, 1}, {0, 0, 2}};
    mesh.normals.indices = {1, 2, 3, 4};
    mesh.tangents.values = {{1, 0, 0, 1}, {0, 0, 0, 1}, {0, 0, 1, 1}, {1, 0, 0, 0}, {2, 0, 0, 1}};
    mesh.tangents.indices = {1, 3, 4, 2};
    const auto findings = prep::check(mesh).findings;
    const auto place = [&](const char* kind) { return find(findings, kind)->places; };
    EXPECT_EQ(place("flipped-normal"), std::vector<std::uint32_t>{0});
    EXPECT_EQ(place("zero-normal"), std::vector<std::uint32_t>{1});
    EXPECT_EQ(place("non-finite-normal"), std::vector<std::uint32_t>{2});
    EXPECT_EQ(place("non-unit-normal"), std::vector<std::uint32_t>{3});
    EXPECT_EQ(place("zero-tangent"), std::vector<std::uint32_t>{0});
    EXPECT_EQ(place("tangent-sign"), std::vector<std::uint32_t>{1});
    EXPECT_EQ(place("non-unit-tangent"), std::vector<std::uint32_t>{2});
    EXPECT_EQ(place("non-orthogonal-tangent"), std::vector<std::uint32_t>{3});
}

TEST(Check, UvFaults) {
    Mesh mesh = shapes::grid(5, 1);
    mesh.uvs.resize(1);
    auto& uv = mesh.uvs[0];
    const float nan = std::numeric_limits<float>::quiet_NaN();
    // v points down: the first square is the right way round, the second mirrored.
    uv.values = {{0, 1}, {1, 1}, {1, 0}, {0, 0}, {nan, 0}, {5000, 0}};
    uv.indices = {0, 1, 2, 3, 1, 0, 3, 2, 0, 0, 0, 0, 0, 4, 2, 3, 0, 1, 5, prep::no_index};
    const auto findings = prep::check(mesh).findings;
    const auto place = [&](const char* kind) { return find(findings, kind)->places; };
    EXPECT_EQ(place("mirrored-uv"), std::vector<std::uint32_t>{1});
    EXPECT_EQ(place("degenerate-uv"), std::vector<std::uint32_t>{2});
    EXPECT_EQ(place("non-finite-uv"), std::vector<std::uint32_t>{13});
    EXPECT_EQ(place("huge-uv"), std::vector<std::uint32_t>{18});
    EXPECT_EQ(place("missing-uv"), std::vector<std::uint32_t>{19});
}

TEST(Check, SceneKnowsWhatItsMaterialsNeed) {
    prep::Scene scene;
    scene.meshes = {shapes::cube(), shapes::cube()};
    scene.meshes[0].face_materials = {0, 0, 1, 1, 7, prep::no_index};
    scene.materials.resize(2);
    scene.textures.resize(1);
    scene.materials[1].diffuse_map.texture = 0;
    const prep::SceneCheck result = prep::check(scene);
    ASSERT_EQ(result.meshes.size(), 2u);
    EXPECT_EQ(count(result.findings, "missing-uv"), 8u);
    EXPECT_EQ(find(result.findings, "missing-uv")->places.front(), 8u);
    EXPECT_EQ(find(result.findings, "unknown-material")->places, std::vector<std::uint32_t>{4});
    for (const Finding& f : result.findings) EXPECT_EQ(f.mesh, 0u);
}

TEST(Check, ThreadsChangeNothing) {
    std::mt19937_64 random(7);
    const Mesh mesh = shapes::random_triangles(3000, 20000, random);
    prep::CheckOptions options;
    options.threads = 1;
    const prep::MeshCheck one = prep::check(mesh, 0, options);
    for (const int threads : {2, 3, 8}) {
        options.threads = threads;
        const prep::MeshCheck many = prep::check(mesh, 0, options);
        ASSERT_EQ(kinds(one.findings), kinds(many.findings));
        for (std::size_t i = 0; i < one.findings.size(); ++i) {
            EXPECT_EQ(one.findings[i].count, many.findings[i].count);
            EXPECT_EQ(one.findings[i].places, many.findings[i].places);
        }
        EXPECT_EQ(one.summary.euler, many.summary.euler);
        EXPECT_EQ(one.summary.area, many.summary.area);
    }
}

}  // namespace
