#include "prep/prepare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "mesh_files.h"
#include "prep/load.h"
#include "shapes.h"

namespace {

// A cube of 8 shared corners and 6 quads, indexed apart from attributes as an OBJ would be.
prep::Mesh cube() {
    prep::Mesh mesh;
    mesh.name = "cube";
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
    mesh.corner_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    for (std::uint32_t f = 1; f <= 6; ++f) mesh.face_offsets.push_back(4 * f);
    return mesh;
}

prep::CornerLayer<glm::vec2> unit_square_uvs(std::size_t faces) {
    prep::CornerLayer<glm::vec2> layer;
    layer.values = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (std::size_t f = 0; f < faces; ++f)
        for (std::uint32_t k = 0; k < 4; ++k) layer.indices.push_back(k);
    return layer;
}

prep::Scene scene_of(prep::Mesh mesh) {
    prep::Scene scene;
    scene.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(scene);
    return scene;
}

const prep::StageReport& stage(const prep::PreparedScene& prepared, const std::string& name) {
    const auto it = std::find_if(prepared.stages.begin(), prepared.stages.end(),
                                 [&](const auto& s) { return s.stage == name; });
    EXPECT_NE(it, prepared.stages.end()) << name;
    return *it;
}

std::uint64_t count(const prep::PreparedScene& prepared, const std::string& kind) {
    for (const auto& f : prepared.findings)
        if (f.kind == kind) return f.count;
    return 0;
}

TEST(Prepare, EmptySceneIsFine) {
    const auto result = prep::prepare({});
    ASSERT_TRUE(result.has_value());
    EXPECT_TRUE(result->meshes.empty());
}

TEST(Prepare, CubeSplitsIntoTwentyFourVerticesBecauseOfHardEdges) {
    const auto result = prep::prepare(scene_of(cube()));
    ASSERT_TRUE(result.has_value());
    const prep::VertexMesh& mesh = result->meshes[0];
    EXPECT_EQ(mesh.vertex_count(), 24u);
    EXPECT_EQ(mesh.triangle_count(), 12u);
    EXPECT_EQ(result->splits.hard_edge, 16u);  // 24 vertices from 8 points
    EXPECT_EQ(result->splits.uv_seam, 0u);
    for (const glm::vec3& n : mesh.normals)
        EXPECT_EQ(std::abs(n.x) + std::abs(n.y) + std::abs(n.z), 1.0f);
}

TEST(Prepare, HardAngleOffKeepsTheCubesEightVertices) {
    prep::PrepareOptions options;
    options.hard_edges.angle_degrees.reset();
    const auto result = prep::prepare(scene_of(cube()), options);
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->meshes[0].vertex_count(), 8u);
    const float third = float(1 / std::sqrt(3.0));
    for (std::size_t v = 0; v < 8; ++v)
        EXPECT_EQ(result->meshes[0].normals[v], result->meshes[0].positions[v] * third);
}

TEST(Prepare, TangentsOnlyWhereANormalMapCallsForThem) {
    prep::Mesh mesh = cube();
    mesh.uvs.push_back(unit_square_uvs(6));
    mesh.face_materials.assign(6, 0);
    prep::Scene scene = scene_of(mesh);
    scene.materials.resize(1);
    const auto without = prep::prepare(scene);
    ASSERT_TRUE(without.has_value());
    EXPECT_TRUE(without->meshes[0].tangents.empty());
    EXPECT_FALSE(stage(*without, "tangents").run);
    EXPECT_EQ(stage(*without, "tangents").reason,
              "no material in use has a tangent-space normal map");

    scene.textures.resize(1);
    scene.materials[0].normal_map.texture = 0;
    const auto with = prep::prepare(scene);
    ASSERT_TRUE(with.has_value());
    EXPECT_TRUE(stage(*with, "tangents").run);
    const prep::VertexMesh& out = with->meshes[0];
    ASSERT_EQ(out.tangents.size(), out.vertex_count());
    for (std::size_t v = 0; v < out.vertex_count(); ++v) {
        const glm::dvec3 t(out.tangents[v]), n(out.normals[v]);
        EXPECT_NEAR(glm::length(t), 1.0, 1e-6);
        EXPECT_NEAR(glm::dot(t, n), 0.0, 1e-6);
        EXPECT_EQ(std::abs(out.tangents[v].w), 1.0f);
    }
}

TEST(Prepare, AuthoredNormalsKeepTheirBits) {
    prep::Mesh mesh = cube();
    const glm::vec3 odd{0.6f, 0.0f, 0.8f};
    mesh.normals.values = {odd};
    mesh.normals.indices.assign(24, 0);
    const auto result = prep::prepare(scene_of(mesh));
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->meshes[0].vertex_count(), 8u);
    for (const glm::vec3& n : result->meshes[0].normals) EXPECT_EQ(n, odd);
    EXPECT_EQ(stage(*result, "normals").reason, "the file's own normals are kept");
    EXPECT_TRUE(result->findings.empty());
}

TEST(Prepare, KeepReplacesOnlyNormalsThatAreNone) {
    prep::Mesh mesh = cube();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    mesh.normals.values = {{0, 0, -1}, {0, 0, 0}, {nan, 0, 0}, {0, 0, -3}};
    mesh.normals.indices.assign(24, 0);
    mesh.normals.indices[4] = 1;
    mesh.normals.indices[5] = 2;
    mesh.normals.indices[6] = prep::no_index;
    mesh.normals.indices[0] = 3;
    const auto result = prep::prepare(scene_of(mesh));
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(count(*result, "zero-normal"), 1u);
    EXPECT_EQ(count(*result, "non-finite-normal"), 1u);
    EXPECT_EQ(count(*result, "missing-normal"), 1u);
    EXPECT_EQ(count(*result, "non-unit-normal"), 1u);
    const auto& layer = result->scene.meshes[0].normals;
    for (const std::uint32_t c : {4u, 5u, 6u})  // face 1 is the top: +Z
        EXPECT_EQ(layer.values[layer.indices[c]], glm::vec3(0, 0, 1));
    EXPECT_EQ(layer.values[layer.indices[0]], glm::vec3(0, 0, -1));  // rescaled, direction kept
    EXPECT_EQ(layer.values[layer.indices[7]], glm::vec3(0, 0, -1));  // kept though it is flipped
}

// Nothing is lit, but the normals of the file are written all the same.
TEST(Prepare, NormalsThatNothingReadsAreStillNormals) {
    prep::Mesh mesh = cube();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    mesh.normals.values = {{0, 0, -1}, {0, 0, 0}, {nan, 0, 0}};
    mesh.normals.indices.assign(24, 0);
    prep::Scene scene = scene_of(mesh);
    scene.materials.emplace_back().unlit = true;
    scene.meshes[0].face_materials.assign(6, 0);
    const auto kept = prep::prepare(scene);
    ASSERT_TRUE(kept.has_value());
    EXPECT_EQ(stage(*kept, "normals").reason.find("the file's own normals"), std::string::npos);
    EXPECT_EQ(kept->scene.meshes[0].normals.indices, mesh.normals.indices);
    scene.meshes[0].normals.indices[4] = 1;
    scene.meshes[0].normals.indices[5] = 2;
    scene.meshes[0].normals.indices[6] = prep::no_index;
    const auto mended = prep::prepare(scene);
    ASSERT_TRUE(mended.has_value());
    EXPECT_EQ(count(*mended, "zero-normal"), 1u);
    EXPECT_EQ(count(*mended, "non-finite-normal"), 1u);
    EXPECT_EQ(count(*mended, "missing-normal"), 1u);  // no file has some at a part of a face
    const auto& layer = mended->scene.meshes[0].normals;
    for (const std::uint32_t c : {4u, 5u, 6u})
        EXPECT_EQ(layer.values[layer.indices[c]], glm::vec3(0, 0, 1));
    prep::PrepareOptions options;
    options.normals = prep::Authored::replace;
    const auto replaced = prep::prepare(scene, options);
    ASSERT_TRUE(replaced.has_value());
    const auto& made = replaced->scene.meshes[0].normals;
    for (std::uint32_t c = 4; c < 8; ++c)
        EXPECT_EQ(made.values[made.indices[c]], glm::vec3(0, 0, 1));
    // A picture that does not read them has no use for a look at them.
    options.normals = prep::Authored::keep;
    options.request.consumer.exact = true;
    options.document_stays = false;
    const auto drawn = prep::prepare(scene, options);
    ASSERT_TRUE(drawn.has_value());
    EXPECT_EQ(count(*drawn, "zero-normal"), 0u);
    EXPECT_TRUE(drawn->meshes[0].normals.empty());
}

TEST(Prepare, RepairReplacesFlippedNormalsToo) {
    prep::Mesh mesh = cube();
    mesh.normals.values = {{0, 0, -1}};
    mesh.normals.indices.assign(24, 0);
    prep::PrepareOptions options;
    options.normals = prep::Authored::repair;
    const auto result = prep::prepare(scene_of(mesh), options);
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(count(*result, "flipped-normal"), 4u);  // the top face alone is against it
    const auto& layer = result->scene.meshes[0].normals;
    for (std::uint32_t c = 4; c < 8; ++c)
        EXPECT_EQ(layer.values[layer.indices[c]], glm::vec3(0, 0, 1));
}

TEST(Prepare, ReplaceIgnoresAuthoredNormals) {
    prep::Mesh mesh = cube();
    mesh.normals.values = {{0, 0, 1}};
    mesh.normals.indices.assign(24, 0);
    prep::PrepareOptions options;
    options.normals = prep::Authored::replace;
    const auto result = prep::prepare(scene_of(mesh), options);
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->meshes[0].vertex_count(), 24u);
}

TEST(Prepare, NewNormalsMakeAuthoredTangentsStale) {
    prep::Mesh mesh = cube();
    mesh.tangents.values = {{1, 0, 0, 1}};
    mesh.tangents.indices.assign(24, 0);
    prep::PrepareOptions options;
    options.normals = prep::Authored::replace;
    const auto result = prep::prepare(scene_of(mesh), options);
    ASSERT_TRUE(result.has_value());
    EXPECT_TRUE(result->meshes[0].tangents.empty());
    EXPECT_EQ(count(*result, "stale-tangent"), 24u);
}

// A cube whose normals are those of its faces and whose tangents are a fixed one for each face.
prep::Mesh cube_with_frames() {
    prep::Mesh mesh = cube();
    for (std::uint32_t f = 0; f < 6; ++f) {
        const auto corner = [&](std::uint32_t k) {
            return mesh.positions[mesh.corner_vertices[4 * f + k]];
        };
        const glm::vec3 along = corner(1) - corner(0);
        mesh.normals.values.push_back(glm::normalize(glm::cross(along, corner(2) - corner(1))));
        mesh.tangents.values.emplace_back(glm::normalize(along), f % 2 == 0 ? 1.0f : -1.0f);
    }
    for (std::uint32_t c = 0; c < 24; ++c) {
        mesh.normals.indices.push_back(c / 4);
        mesh.tangents.indices.push_back(c / 4);
        const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
        mesh.uvs.resize(1);
        mesh.uvs[0].values.emplace_back(p.x + 0.3f * p.z, p.y + 0.4f * p.z);
        mesh.uvs[0].indices.push_back(c);
    }
    return mesh;
}

TEST(Prepare, RescaledNormalsKeepTheirTangents) {
    prep::Mesh mesh = cube_with_frames();
    mesh.normals.values[0] *= 2.0f;
    mesh.normals.values[1] *= 0.99f;
    const std::vector<glm::vec4> before = mesh.tangents.values;
    for (const auto level : {prep::Request::Level::as_called_for, prep::Request::Level::always}) {
        prep::PrepareOptions options;
        options.request.tangents = level;
        const auto result = prep::prepare(scene_of(mesh), options);
        ASSERT_TRUE(result.has_value());
        EXPECT_EQ(count(*result, "non-unit-normal"), 8u);
        EXPECT_EQ(count(*result, "stale-tangent"), 0u);
        EXPECT_EQ(result->scene.meshes[0].tangents.values, before);
        EXPECT_EQ(result->scene.meshes[0].tangents.indices, mesh.tangents.indices);
    }
}

TEST(Prepare, OnlyTheTangentsOfReplacedNormalsAreNew) {
    prep::Mesh mesh = cube_with_frames();
    for (std::uint32_t c = 20; c < 24; ++c) mesh.normals.indices[c] = prep::no_index;
    mesh.tangents.values[5] = {0.6f, 0.0f, 0.8f, 1.0f};  // of a normal that is not there
    for (const auto level : {prep::Request::Level::as_called_for, prep::Request::Level::always}) {
        prep::PrepareOptions options;
        options.request.tangents = level;
        const auto result = prep::prepare(scene_of(mesh), options);
        ASSERT_TRUE(result.has_value()) << prep::to_string(result.error());
        EXPECT_EQ(count(*result, "missing-normal"), 4u);
        EXPECT_EQ(count(*result, "stale-tangent"), 4u);
        const prep::Mesh& out = result->scene.meshes[0];
        for (std::uint32_t c = 0; c < 24; ++c) {
            const glm::vec4 t = out.tangents.values[out.tangents.indices[c]];
            if (c < 20) {
                EXPECT_EQ(t, mesh.tangents.values[c / 4]);
                continue;
            }
            const glm::vec3 n = out.normals.values[out.normals.indices[c]];
            EXPECT_NEAR(glm::dot(glm::vec3(t), n), 0.0f, 1e-6f);
            EXPECT_NEAR(glm::length(glm::vec3(t)), 1.0f, 1e-6f);
        }
    }
    mesh.uvs.clear();  // nothing to compute them from
    const auto without = prep::prepare(scene_of(mesh), {});
    ASSERT_TRUE(without.has_value()) << prep::to_string(without.error());
    EXPECT_TRUE(without->meshes[0].tangents.empty());
    EXPECT_EQ(count(*without, "stale-tangent"), 24u);
}

TEST(Prepare, ReplacedNormalsLeaveNoValueBehind) {
    prep::Mesh mesh = cube_with_frames();
    mesh.normals.values[3] = glm::vec3(std::numeric_limits<float>::quiet_NaN());
    const auto result = prep::prepare(scene_of(mesh), {});
    ASSERT_TRUE(result.has_value());
    for (const glm::vec3& n : result->scene.meshes[0].normals.values)
        EXPECT_NEAR(glm::length(n), 1, 1e-6);
}

TEST(Prepare, CarriedTangentsAreFramesWithoutUvsToo) {
    prep::Mesh mesh = cube_with_frames();
    mesh.uvs.clear();
    mesh.tangents.values[0] = {0, 0, 0, 1};
    mesh.tangents.values[1] *= glm::vec4(3, 3, 3, 0.75);
    mesh.tangents.indices[8] = prep::no_index;
    for (const auto authored :
         {prep::Authored::keep, prep::Authored::replace, prep::Authored::repair}) {
        prep::PrepareOptions options;
        options.tangents = authored;
        options.request.tangents = prep::Request::Level::always;
        const auto result = prep::prepare(scene_of(mesh), options);
        ASSERT_TRUE(result.has_value()) << prep::to_string(result.error());
        EXPECT_EQ(count(*result, "zero-tangent"), 4u);
        EXPECT_EQ(count(*result, "missing-tangent"), 1u);
        EXPECT_EQ(count(*result, "non-unit-tangent"), 4u);
        const prep::Mesh& out = result->scene.meshes[0];
        for (std::uint32_t c = 0; c < 24; ++c) {
            const glm::vec4 t = out.tangents.values[out.tangents.indices[c]];
            const glm::vec3 n = out.normals.values[out.normals.indices[c]];
            EXPECT_NEAR(glm::dot(glm::vec3(t), n), 0.0f, 1e-6f) << c;
            EXPECT_NEAR(glm::length(glm::vec3(t)), 1.0f, 1e-6f) << c;
            EXPECT_EQ(std::abs(t.w), 1.0f) << c;
            if (c > 8) {
                EXPECT_EQ(t, mesh.tangents.values[c / 4]) << c;
            }
        }
    }
}

TEST(Prepare, SoupSharesItsVertices) {
    prep::Mesh mesh = cube(), soup;
    for (std::uint32_t c = 0; c < 24; ++c) {
        soup.positions.push_back(mesh.positions[mesh.corner_vertices[c]]);
        soup.corner_vertices.push_back(c);
    }
    soup.face_offsets = mesh.face_offsets;
    prep::PrepareOptions options;
    options.hard_edges.angle_degrees.reset();
    const auto result = prep::prepare(scene_of(soup), options);
    ASSERT_TRUE(result.has_value());
    EXPECT_TRUE(stage(*result, "weld").run);
    EXPECT_EQ(result->meshes[0].vertex_count(), 8u);
    const float third = float(1 / std::sqrt(3.0));
    for (std::size_t v = 0; v < result->meshes[0].vertex_count(); ++v)
        EXPECT_EQ(result->meshes[0].normals[v], result->meshes[0].positions[v] * third);
}

TEST(Prepare, SoupKeepsItsVerticesWhereWeldingIsOff) {
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.corner_vertices = {0, 1, 2, 3, 4, 5};
    mesh.face_offsets = {0, 3, 6};
    EXPECT_EQ(prep::prepare(scene_of(mesh))->meshes[0].vertex_count(), 4u);
    prep::PrepareOptions options;
    options.weld = prep::WeldMode::none;
    EXPECT_EQ(prep::prepare(scene_of(mesh), options)->meshes[0].vertex_count(), 6u);
}

// The two sides of a roof that bends by 20°, as primitives of one glTF mesh: each has its own copy
// of the ridge, and no attribute that would show it.
TEST(Prepare, NormalsOfAGltfAreSmoothAcrossPrimitives) {
    const std::string gltf =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1},)"
        R"({"attributes":{"POSITION":0},"indices":2}]}],"accessors":[)"
        R"({"bufferView":0,"componentType":5126,"count":6,"type":"VEC3"},)"
        R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"},)"
        R"({"bufferView":1,"byteOffset":12,"componentType":5123,"count":6,"type":"SCALAR"}],)"
        R"("bufferViews":[{"buffer":0,"byteLength":72},{"buffer":0,"byteOffset":72,)"
        R"("byteLength":24}],"buffers":[{"uri":"a.bin","byteLength":96}]})";
    const test::TempDir dir;
    test::write_text(dir / "a.gltf", gltf);
    const float low = -float(std::tan(10 * 3.14159265358979 / 180));
    const float positions[18] = {0, 0, 0, 0, 1, 0, -1, 0, low, -1, 1, low, 1, 0, low, 1, 1, low};
    const std::uint16_t indices[12] = {0, 1, 3, 0, 3, 2, 0, 4, 5, 0, 5, 1};
    std::string bytes(96, '\0');
    std::memcpy(bytes.data(), positions, 72);
    std::memcpy(bytes.data() + 72, indices, 24);
    test::write_text(dir / "a.bin", bytes);
    const auto scene = prep::load_scene(dir / "a.gltf");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    // The largest distance of a ridge normal from straight up.
    const auto bend = [](const prep::PreparedScene& prepared) {
        const prep::VertexMesh& mesh = prepared.meshes[0];
        EXPECT_GE(mesh.vertex_count(), 6u);
        float most = 0;
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
            if (mesh.positions[v].x == 0)
                most = std::max(most, glm::length(mesh.normals[v] - glm::vec3(0, 0, 1)));
        return most;
    };
    const auto smooth = prep::prepare(*scene);
    ASSERT_TRUE(smooth.has_value());
    EXPECT_TRUE(stage(*smooth, "weld").run);
    EXPECT_EQ(smooth->meshes[0].vertex_count(), 8u);  // the primitives keep their own
    EXPECT_LT(bend(*smooth), 1e-6f);
    prep::Scene merged = *scene;  // as in a scene of several files
    merged.retained_file.reset();
    for (prep::Mesh& mesh : merged.meshes) mesh.tied_to_file = false;
    const auto part = prep::prepare(merged);
    ASSERT_TRUE(part.has_value());
    EXPECT_LT(bend(*part), 1e-6f);
    prep::PrepareOptions options;
    options.weld = prep::WeldMode::none;
    const auto apart = prep::prepare(*scene, options);
    ASSERT_TRUE(apart.has_value());
    EXPECT_EQ(stage(*apart, "weld").reason, "switched off");
    EXPECT_NEAR(bend(*apart), 2 * std::sin(5 * 3.14159265358979 / 180), 1e-6);
}

TEST(Prepare, TwoSidedSheetStaysTwoSurfaces) {
    // Two coincident sheets of opposite direction, bent by 40°, each with vertices of its own:
    // welding must not make their common edges non-manifold.
    prep::Mesh mesh;
    const float h = float(std::tan(40.0 * 3.14159265358979 / 180.0));
    for (int side = 0; side < 2; ++side)
        for (const glm::vec3 p : {glm::vec3(-1, 0, 0), glm::vec3(0, 0, 0), glm::vec3(1, h, 0),
                                  glm::vec3(-1, 0, 1), glm::vec3(0, 0, 1), glm::vec3(1, h, 1)})
            mesh.positions.push_back(p);
    mesh.corner_vertices = {0, 3, 4, 1, 1, 4, 5, 2, 6, 7, 10, 9, 7, 8, 11, 10};
    mesh.face_offsets = {0, 4, 8, 12, 16};
    prep::PrepareOptions options;
    options.weld = prep::WeldMode::exact;
    const auto result = prep::prepare(scene_of(mesh), options);
    ASSERT_TRUE(result.has_value());
    const auto& layer = result->scene.meshes[0].normals;
    // Smooth across the bend on either side, and the sides point against each other.
    EXPECT_EQ(layer.indices[3], layer.indices[4]);
    EXPECT_EQ(layer.indices[9], layer.indices[12]);
    EXPECT_EQ(layer.values[layer.indices[3]], -layer.values[layer.indices[9]]);
}

TEST(Prepare, PointsAndLinesPassThrough) {
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {9, 9, 9}};
    mesh.line_offsets = {0, 3};
    mesh.line_vertices = {0, 1, 2};
    mesh.points = {2};
    const auto result = prep::prepare(scene_of(mesh));
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->meshes[0].vertex_count(), 3u);  // the unused fourth is dropped
    EXPECT_EQ(result->meshes[0].lines, (std::vector<std::uint32_t>{0, 1, 1, 2}));
    EXPECT_EQ(result->meshes[0].points, (std::vector<std::uint32_t>{2}));
    EXPECT_FALSE(stage(*result, "normals").run);
}

TEST(Prepare, BadAngleIsAnErrorThatNamesTheMesh) {
    prep::PrepareOptions options;
    options.hard_edges.angle_degrees = 200;
    const auto result = prep::prepare(scene_of(cube()), options);
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().code, prep::ErrorCode::invalid);
    EXPECT_EQ(result.error().place, "mesh 'cube'");
}

TEST(Prepare, SameBytesForAnyThreadCount) {
    prep::Mesh mesh;  // a wavy grid large enough for many blocks of work
    constexpr std::uint32_t n = 200;
    for (std::uint32_t y = 0; y <= n; ++y)
        for (std::uint32_t x = 0; x <= n; ++x) {
            mesh.positions.push_back(
                {float(x), float(y), float(3 * std::sin(0.7 * x) * std::cos(0.9 * y))});
        }
    prep::CornerLayer<glm::vec2> uv;
    for (const glm::vec3& p : mesh.positions) uv.values.push_back({p.x / n, p.y / n});
    for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x) {
            const std::uint32_t a = y * (n + 1) + x;
            for (const std::uint32_t v : {a, a + 1, a + n + 2, a + n + 1}) {
                mesh.corner_vertices.push_back(v);
                uv.indices.push_back(v);
            }
            mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        }
    mesh.uvs.push_back(uv);
    prep::PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    options.hard_edges.angle_degrees = 45;
    options.threads = 1;
    const auto one = prep::prepare(scene_of(mesh), options);
    ASSERT_TRUE(one.has_value());
    ASSERT_GT(one->splits.hard_edge, 0u);
    for (const int threads : {2, 3, 8}) {
        options.threads = threads;
        const auto many = prep::prepare(scene_of(mesh), options);
        ASSERT_TRUE(many.has_value());
        EXPECT_EQ(many->meshes[0].positions, one->meshes[0].positions);
        EXPECT_EQ(many->meshes[0].normals, one->meshes[0].normals);
        EXPECT_EQ(many->meshes[0].tangents, one->meshes[0].tangents);
        EXPECT_EQ(many->meshes[0].indices, one->meshes[0].indices);
    }
}

// Doubles of the normals are what the walk around each point does not give.
TEST(Prepare, BothWaysToNormalsGiveTheSameVertices) {
    std::mt19937_64 random(31);
    prep::Mesh surface = shapes::fan_triangulated(shapes::torus(50, 24));
    shapes::jitter(surface, 0.05f, random);
    for (const bool soup : {false, true})
        for (const auto weld : {prep::WeldMode::none, prep::WeldMode::exact}) {
            SCOPED_TRACE(std::to_string(soup) + std::to_string(weld == prep::WeldMode::exact));
            prep::PrepareOptions options;
            options.weld = weld;
            options.hard_edges.angle_degrees = 20;
            const prep::Mesh mesh = soup ? shapes::soup(surface) : surface;
            const auto walked = prep::prepare(scene_of(mesh), options);
            options.normal.keep_doubles = true;
            const auto general = prep::prepare(scene_of(mesh), options);
            ASSERT_TRUE(walked.has_value());
            ASSERT_TRUE(general.has_value());
            const prep::VertexMesh &a = walked->meshes[0], &b = general->meshes[0];
            ASSERT_EQ(a.normals.size(), a.vertex_count());
            EXPECT_EQ(a.positions, b.positions);
            EXPECT_EQ(a.normals, b.normals);
            EXPECT_EQ(a.indices, b.indices);
            EXPECT_EQ(a.source_corners, b.source_corners);
            EXPECT_EQ(a.split_reasons, b.split_reasons);
            EXPECT_EQ(walked->splits.hard_edge, general->splits.hard_edge);
        }
}

// Lines may have normals where no face has any: a layer without values is none.
TEST(Prepare, NoNormalsAreMadeUpWhereNothingIsLit) {
    prep::Mesh mesh = cube();
    mesh.normals.values = {{1, 0, 0}};
    mesh.normals.indices.assign(24, prep::no_index);
    mesh.face_materials.assign(6, 0);
    prep::Scene scene = scene_of(mesh);
    scene.materials.emplace_back().unlit = true;
    const auto none = prep::prepare(scene);
    ASSERT_TRUE(none.has_value());
    EXPECT_TRUE(none->meshes[0].normals.empty());
    // Half of the faces have their own: the others' are those of their planes.
    std::fill(scene.meshes[0].normals.indices.begin(), scene.meshes[0].normals.indices.begin() + 12,
              0);
    const auto half = prep::prepare(scene);
    ASSERT_TRUE(half.has_value());
    EXPECT_EQ(count(*half, "missing-normal"), 12u);
    const prep::Mesh& made = half->scene.meshes[0];
    for (std::uint32_t f = 3; f < 6; ++f) {
        const auto at = [&](std::uint32_t k) {
            return made.positions[made.corner_vertices[4 * f + k]];
        };
        const glm::vec3 plane = glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0)));
        for (std::uint32_t c = 4 * f; c < 4 * f + 4; ++c)
            EXPECT_LT(glm::length(made.normals.values[made.normals.indices[c]] - plane), 1e-6F);
    }
}

}  // namespace
