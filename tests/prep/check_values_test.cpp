// check() by value: which element, how many, where, for what lies at or beside each limit.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "prep/check.h"
#include "shapes.h"

namespace {

using prep::Finding;
using prep::Mesh;
using prep::no_index;
using Indices = std::vector<std::uint32_t>;

const Finding* find(const std::vector<Finding>& findings, const std::string& kind) {
    for (const Finding& f : findings)
        if (f.kind == kind) return &f;
    return nullptr;
}

// The places of a kind; empty where there is none. Their number is the count's.
Indices places(const Mesh& mesh, const std::string& kind) {
    const prep::MeshCheck result = prep::check(mesh);
    const Finding* f = find(result.findings, kind);
    if (f == nullptr) return {};
    EXPECT_EQ(f->count, f->places.size()) << kind;
    return f->places;
}

TEST(CheckValues, AtMostEightPlacesAreListedAndAllAreCounted) {
    Mesh mesh = shapes::cube();
    for (int i = 0; i < 12; ++i) mesh.positions.emplace_back(float(i), 9.0f, 0.0f);
    const auto findings = prep::check(mesh).findings;
    const Finding* f = find(findings, "unreferenced-vertex");
    ASSERT_NE(f, nullptr);
    EXPECT_EQ(f->count, 12u);
    EXPECT_EQ(f->places, (Indices{8, 9, 10, 11, 12, 13, 14, 15}));
    EXPECT_EQ(f->place_kind, prep::PlaceKind::vertex);
    EXPECT_EQ(f->severity, prep::Severity::info);
    // A surface's points are those that it uses.
    EXPECT_EQ(prep::check(mesh).summary.points, 8u);
    EXPECT_EQ(prep::check(mesh).summary.vertices, 20u);
}

TEST(CheckValues, FindingsNameTheirMesh) {
    prep::Scene scene;
    scene.meshes = {shapes::cube(), shapes::grid(1, 1), shapes::cube()};
    const auto findings = prep::check(scene).findings;
    ASSERT_EQ(findings.size(), 2u);  // the grid's rim
    for (const Finding& f : findings) EXPECT_EQ(f.mesh, 1u) << f.kind;
}

TEST(CheckValues, CountsFacesByTheirCornersAndTheBoxWithTheOrigin) {
    Mesh mesh = shapes::mesh_of({{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {2, 4, 0}, {0, 2, 0}, {5, 1, 0}},
                                {{0, 1, 2, 3, 4}, {1, 5, 2}, {0, 1, 2, 4}});
    mesh.origin = {100, -50, 7};
    const prep::MeshSummary s = prep::check(mesh).summary;
    EXPECT_EQ(s.triangles, 1u);
    EXPECT_EQ(s.quads, 1u);
    EXPECT_EQ(s.polygons, 1u);
    EXPECT_EQ(s.corners, 12u);
    EXPECT_EQ(s.largest_face, 5u);
    EXPECT_EQ(s.low, glm::dvec3(100, -50, 7));
    EXPECT_EQ(s.high, glm::dvec3(105, -46, 7));
    // A rectangle of 4 × 2 and a gable of 2; a triangle of 1; the rectangle again.
    EXPECT_EQ(s.area, 12.0 + 1.0 + 8.0);
    // Three faces each have the corners 1 and 2.
    EXPECT_EQ(s.largest_valence, 3u);
}

TEST(CheckValues, LinesCountTheirSegments) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
    mesh.line_offsets = {0, 4, 6};
    mesh.line_vertices = {0, 1, 2, 3, 3, 0};
    mesh.points = {2, 1};
    const prep::MeshCheck result = prep::check(mesh);
    EXPECT_EQ(result.summary.line_segments, 3u + 1u);
    EXPECT_EQ(result.summary.point_primitives, 2u);
    EXPECT_EQ(find(result.findings, "isolated-point")->places, (Indices{1, 2}));
    EXPECT_EQ(find(result.findings, "empty-mesh"), nullptr);
}

TEST(CheckValues, AnyDenormalComponentIsSeen) {
    for (int k = 0; k < 3; ++k) {
        Mesh mesh = shapes::cube();
        mesh.positions[2][k] = -1e-39f;
        EXPECT_EQ(places(mesh, "denormal-vertex"), Indices{2}) << k;
        mesh.positions[2][k] = std::numeric_limits<float>::min();
        EXPECT_EQ(places(mesh, "denormal-vertex"), Indices{}) << k;
    }
}

// A float at x is rounded by up to x · 2⁻²⁴, which is 2⁻¹⁶ of the extent where x is 256 times it.
TEST(CheckValues, FarFromOriginBeginsAtTwoHundredFiftySixExtents) {
    const auto far = [](float at) {
        return shapes::mesh_of({{at, 0, 0}, {at - 3, 0, 0}, {at - 3, 4, 0}}, {{0, 1, 2}});
    };
    // The box is 3 × 4: its diagonal is 5.
    EXPECT_EQ(places(far(1280), "far-from-origin"), Indices{});
    EXPECT_EQ(places(far(1281), "far-from-origin"), Indices{0});
    EXPECT_EQ(places(far(-1278), "far-from-origin"), Indices{1});  // at −1281
}

// A corner off the plane by 1 % of the diagonal: the limit goes with the size.
TEST(CheckValues, FlatnessGoesByTheFacesSize) {
    for (const float size : {0.001f, 1.0f, 1000.0f}) {
        // Opposite corners up by h and the others down: all are off the mean plane by h.
        const auto bent = [&](double share) {
            const float h = float(share * std::sqrt(2.0)) * size;
            return shapes::polygon({{0, 0, h}, {size, 0, -h}, {size, size, h}, {0, size, -h}});
        };
        EXPECT_EQ(places(bent(0.0095), "non-planar-face"), Indices{}) << size;
        EXPECT_EQ(places(bent(0.0105), "non-planar-face"), Indices{0}) << size;
    }
}

TEST(CheckValues, AFaceIsOneKindOfDegenerate) {
    // 0: repeats a vertex; 1: collinear; both have no area.
    const Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 1}, {0, 1, 2}});
    EXPECT_EQ(places(mesh, "repeated-vertex-face"), Indices{0});
    EXPECT_EQ(places(mesh, "zero-area-face"), Indices{1});
}

TEST(CheckValues, DuplicatesHaveTheSameCycleInEitherDirection) {
    const std::vector<glm::vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    // 0: the square; 1 and 2: bow ties of the same points; 3: the square from another corner;
    // 4: backwards; 5: bow tie 1 backwards.
    const Mesh mesh = shapes::mesh_of(
        square,
        {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 1, 3, 2}, {2, 3, 0, 1}, {1, 0, 3, 2}, {3, 1, 2, 0}});
    EXPECT_EQ(places(mesh, "duplicate-face"), Indices{3});
    EXPECT_EQ(places(mesh, "opposite-face"), (Indices{4, 5}));
    // Triangles, whose backwards are their mirror images.
    EXPECT_EQ(places(shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                     {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}}),
                     "duplicate-face"),
              (Indices{2, 3}));
}

TEST(CheckValues, RimsThatEndAtACrowdedEdgeCountOneByOne) {
    // Three pages on one spine: each has a rim of two edges, from the spine to the spine.
    const prep::MeshCheck result = prep::check(shapes::book(3));
    EXPECT_EQ(result.summary.open_edges, 6u);
    EXPECT_EQ(result.summary.holes, 3u);
    // A crowded edge does not join the rims of what is on its two sides, whatever their numbers:
    // here the spine is the first half-edge of all faces.
    const Finding* hole = find(result.findings, "hole");
    ASSERT_NE(hole, nullptr);
    ASSERT_EQ(hole->places.size(), 3u);
    for (std::uint32_t page = 0; page < 3; ++page) EXPECT_EQ(hole->places[page] / 3, page);
}

TEST(CheckValues, ARepeatedCornerDoesNotCutTheRim) {
    // A square that repeats its second and its fourth corner: one rim of four edges.
    const Mesh mesh = shapes::mesh_of(
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 4, 2, 3, 5}});
    const prep::MeshSummary s = prep::check(mesh).summary;
    EXPECT_EQ(s.open_edges, 4u);
    EXPECT_EQ(s.holes, 1u);
    EXPECT_EQ(s.edges, 4u);
}

TEST(CheckValues, GenusAddsUpOverComponents) {
    Mesh torus = shapes::torus(12, 8);
    for (glm::vec3& p : torus.positions) p.x += 10;
    const prep::MeshSummary two = prep::check(shapes::joined(shapes::cube(), torus)).summary;
    EXPECT_EQ(two.components, 2u);
    EXPECT_EQ(two.euler, 2 + 0);
    EXPECT_EQ(two.genus, 0 + 1);
}

Mesh inside_out(Mesh mesh) {
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        std::reverse(mesh.corner_vertices.begin() + mesh.face_offsets[f],
                     mesh.corner_vertices.begin() + mesh.face_offsets[f + 1]);
    return mesh;
}

Mesh moved(Mesh mesh, float scale, const glm::vec3& by) {
    for (glm::vec3& p : mesh.positions) p = scale * p + by;
    return mesh;
}

TEST(CheckValues, OnlyWhatLiesInsideAnOutwardShellIsACavity) {
    const Mesh cube = shapes::cube();
    // Inside another that is inside out itself: no cavity.
    const Mesh nested = shapes::joined(inside_out(cube), inside_out(moved(cube, 0.5f, {})));
    EXPECT_EQ(places(nested, "inside-out-shell"), (Indices{0, 6}));
    // Half of it sticks out, upwards or downwards.
    for (const float by : {1.0f, -1.0f})
        EXPECT_EQ(places(shapes::joined(cube, inside_out(moved(cube, 0.5f, glm::vec3(by)))),
                         "inside-out-shell"),
                  Indices{6});
    EXPECT_EQ(places(shapes::joined(cube, inside_out(moved(cube, 0.5f, glm::vec3(0.25f)))),
                     "inside-out-shell"),
              Indices{});
}

// Against the definition: every box of an outward shell around it, one after the other.
TEST(CheckValues, CavitiesAmongManyShells) {
    std::uint32_t state = 1;
    const auto random = [&state] {
        state = state * 1664525u + 1013904223u;
        return float(state >> 8) / float(1 << 24);
    };
    struct Box {
        glm::vec3 at;
        float scale;
        bool turned;
    };
    std::vector<Box> boxes;
    const Mesh cube = shapes::cube();
    Mesh all;
    Indices expected;
    for (int i = 0; i < 400; ++i)
        boxes.push_back({{10 * random(), 10 * random(), 10 * random()},
                         0.1f + 2 * random() * random(),
                         random() < 0.5f});
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const Mesh one = moved(cube, boxes[i].scale, boxes[i].at);
        all = i == 0 ? (boxes[i].turned ? inside_out(one) : one)
                     : shapes::joined(all, boxes[i].turned ? inside_out(one) : one);
        if (!boxes[i].turned) continue;
        bool cavity = false;
        for (const Box& o : boxes) {
            const glm::vec3 apart = glm::abs(o.at - boxes[i].at);
            const float room = o.scale - boxes[i].scale;  // the cube goes from -1 to 1
            cavity |= !o.turned && apart.x < room && apart.y < room && apart.z < room;
        }
        if (!cavity) expected.push_back(std::uint32_t(6 * i));
    }
    ASSERT_GT(expected.size(), 20u);
    const prep::MeshCheck result = prep::check(all);
    const Finding* found = find(result.findings, "inside-out-shell");
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->count, expected.size());
    expected.resize(Finding::max_places);
    EXPECT_EQ(found->places, expected);
}

// Thin slabs on each other, a small cube turned inside out in each gap: wherever a box of several
// slabs is, the cubes between them are in it.
TEST(CheckValues, GapsBetweenManyShellsAreNoCavities) {
    constexpr int slabs = 20'000;
    std::vector<glm::vec3> positions;
    shapes::Faces faces;
    const Mesh cube = shapes::cube();
    const auto add = [&](const glm::vec3& half, float z, bool turned) {
        const auto base = std::uint32_t(positions.size());
        for (const glm::vec3& p : cube.positions)
            positions.push_back(half * p + glm::vec3(0, 0, z));
        for (std::uint32_t f = 0; f < 6; ++f) {
            std::vector<std::uint32_t> face;
            for (std::uint32_t c = 0; c < 4; ++c)
                face.push_back(base + cube.corner_vertices[4 * f + (turned ? 3 - c : c)]);
            faces.push_back(face);
        }
    };
    for (int i = 0; i < slabs; ++i) {
        add({1e5f, 1e5f, 0.25f}, float(2 * i), false);
        add({0.25f, 0.25f, 0.25f}, float(2 * i + 1), true);
    }
    const prep::MeshCheck result = prep::check(shapes::mesh_of(positions, faces));
    const Finding* found = find(result.findings, "inside-out-shell");
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->count, std::uint64_t(slabs));
}

// Two polygons of no area, back to back along a line: each of their 50,000 edges leads into the
// other. Looking at all edges of the other for each way would take an hour.
TEST(CheckValues, FlatPolygonsOfManyCornersEnd) {
    constexpr std::uint32_t n = 50'000;
    std::vector<glm::vec3> line(n);
    Indices there(n), back(n);
    for (std::uint32_t i = 0; i < n; ++i) {
        line[i] = {float(i), 0, 0};
        there[i] = i;
        back[i] = n - 1 - i;
    }
    const prep::MeshCheck result = prep::check(shapes::mesh_of(line, {there, back}));
    const Finding* found = find(result.findings, "zero-area-face");
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->count, 2u);
}

// A shell is named by its first face, whatever order its faces are met in.
TEST(CheckValues, ShellsAreNamedByTheirFirstFace) {
    std::mt19937_64 random(11);
    const Mesh two = shapes::joined(moved(shapes::icosphere(1), 1.0f, {5, 0, 0}),
                                    inside_out(shapes::icosphere(1)));
    for (int i = 0; i < 5; ++i) {
        const Indices order = shapes::random_order(two.face_count(), random);
        std::uint32_t first = 0;
        while (order[first] < two.face_count() / 2) ++first;
        EXPECT_EQ(places(shapes::with_face_order(two, order), "inside-out-shell"), Indices{first});
    }
}

// The sum about zero would lose what the volume is: 4·10⁸ times the shell's size squared.
TEST(CheckValues, VolumesFarFromZeroAreThoseNear) {
    const Mesh near = moved(shapes::icosphere(2), 0.75f, {});
    const glm::vec3 far(1 << 24, -(1 << 23), 1 << 22);
    Mesh moved_away = near;
    for (glm::vec3& p : moved_away.positions) p = (p * 64.0f + far);
    Mesh back = moved_away;
    for (glm::vec3& p : back.positions) p -= far;
    const double volume = prep::check(back).summary.volume;
    EXPECT_GT(volume, 300000);
    // All coordinates are multiples of a half below 2²⁴: the same shape, exactly.
    EXPECT_NEAR(prep::check(moved_away).summary.volume, volume, 1e-9 * volume);
}

TEST(CheckValues, NormalsAreHeldAgainstTheirFaces) {
    Mesh mesh = shapes::grid(1, 1);             // faces +z
    const float step = 0.0066f, far = 0.0069f;  // on both sides of 0.00674
    mesh.normals.values = {{1, 0, 0}, {0.8f, 0, -0.6f}, {0, 0, -3}, {0, 0, 1 - step}};
    mesh.normals.indices = {0, 1, 2, 3};
    // At a right angle is not against the face; what is too long may be against it as well.
    EXPECT_EQ(places(mesh, "flipped-normal"), (Indices{1, 2}));
    EXPECT_EQ(places(mesh, "non-unit-normal"), Indices{2});
    mesh.normals.values = {{0, 0, 1 - far}, {0, 0, 1 + far}, {0, 0, 1 + step}, {0, 0, 1}};
    mesh.normals.indices = {0, 1, 2, no_index};
    EXPECT_EQ(places(mesh, "non-unit-normal"), (Indices{0, 1}));
    EXPECT_EQ(places(mesh, "missing-normal"), Indices{3});
}

TEST(CheckValues, TangentsLeanByTheirAngleNotTheirLength) {
    Mesh mesh = shapes::grid(1, 1);
    mesh.normals.values = {{0, 0, 1}, {0, 0, 10}};
    mesh.normals.indices = {0, 0, 1, 0};
    // Sines of 0.009 and of 0.011; lengths 1, 0.1 and 10; one has no length at all.
    mesh.tangents.values = {
        {1, 0, 0.009f, 1}, {0.1f, 0, 0.0011f, -1}, {10, 0, 0.09f, 0.5f}, {0, 0, 0, -1}};
    mesh.tangents.indices = {0, 1, 2, 3};
    EXPECT_EQ(places(mesh, "non-orthogonal-tangent"), Indices{1});
    EXPECT_EQ(places(mesh, "tangent-sign"), Indices{2});
    EXPECT_EQ(places(mesh, "non-unit-tangent"), (Indices{1, 2}));
    EXPECT_EQ(places(mesh, "zero-tangent"), Indices{3});
    mesh.tangents.indices = {0, no_index, 0, no_index};
    EXPECT_EQ(places(mesh, "missing-tangent"), (Indices{1, 3}));
}

TEST(CheckValues, UvsFarFromZeroInAnyDirectionAreHuge) {
    Mesh mesh = shapes::grid(1, 1);
    mesh.uvs.resize(1);
    mesh.uvs[0].indices = {0, 1, 2, 3};
    mesh.uvs[0].values = {{-2049, 0}, {0, -3000}, {2048, -2048}, {0, 2049}};
    EXPECT_EQ(places(mesh, "huge-uv"), (Indices{0, 1, 3}));
}

TEST(CheckValues, UvAreasAreThoseOfTheWholeFace) {
    // A dart in the texture, listed from a tip: its first triangle runs the other way round.
    Mesh mesh = shapes::grid(1, 1);
    mesh.uvs.resize(1);
    mesh.uvs[0].indices = {0, 1, 2, 3};
    mesh.uvs[0].values = {{0, 0}, {2, 1}, {4, 0}, {1, 2}};
    EXPECT_EQ(places(mesh, "mirrored-uv"), Indices{0});
    std::reverse(mesh.uvs[0].values.begin(), mesh.uvs[0].values.end());
    EXPECT_EQ(places(mesh, "mirrored-uv"), Indices{});
    EXPECT_EQ(places(mesh, "degenerate-uv"), Indices{});
    // A cross of two triangles of one area each: none in sum.
    mesh.uvs[0].values = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
    EXPECT_EQ(places(mesh, "degenerate-uv"), Indices{0});
    // That a face without area has UVs without is no news.
    for (glm::vec3& p : mesh.positions) p = {p.x, p.x, p.x};
    EXPECT_EQ(places(mesh, "degenerate-uv"), Indices{});
}

TEST(CheckValues, MaterialsLackTheSetsThatTheirMapsSample) {
    using Map = prep::TextureRef prep::Material::*;
    const Map maps[] = {&prep::Material::diffuse_map,      &prep::Material::specular_map,
                        &prep::Material::emissive_map,     &prep::Material::occlusion_map,
                        &prep::Material::normal_map,       &prep::Material::bump_map,
                        &prep::Material::displacement_map, &prep::Material::metallic_roughness_map};
    for (const Map map : maps) {
        prep::Scene scene;
        Mesh mesh = shapes::grid(2, 1);
        mesh.uvs.resize(1);
        for (const glm::vec3& p : mesh.positions) mesh.uvs[0].values.emplace_back(p.x, 1 - p.y);
        mesh.uvs[0].indices = mesh.corner_vertices;
        mesh.face_materials = {0, 1};
        scene.meshes = {mesh};
        scene.textures.resize(1);
        scene.materials.resize(2);
        (scene.materials[1].*map).texture = 0;
        EXPECT_EQ(find(prep::check(scene).findings, "missing-uv"), nullptr);
        (scene.materials[1].*map).uv_set = 1;
        const auto findings = prep::check(scene).findings;
        ASSERT_NE(find(findings, "missing-uv"), nullptr);
        EXPECT_EQ(find(findings, "missing-uv")->places, (Indices{4, 5, 6, 7}));
        EXPECT_EQ(find(findings, "missing-uv")->severity, prep::Severity::warning);
    }
}

}  // namespace
