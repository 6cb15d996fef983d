// What samples/README.md says of each sample, by the checks' own counts and by the files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "prep/check.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "shared_data.h"

namespace {

const std::map<std::string, std::string> samples = {{"machine_part", "machine_part.obj"},
                                                    {"octopus", "octopus.ply"},
                                                    {"shield", "shield.gltf"},
                                                    {"room", "room.gltf"}};

prep::Scene load(const std::string& name) {
    auto scene = prep::load_scene(test::source_dir() / "samples" / name / samples.at(name));
    EXPECT_TRUE(scene.has_value()) << to_string(scene.error());
    return scene ? std::move(*scene) : prep::Scene();
}

TEST(Samples, NoneBringsNormalsOrTangents) {
    for (const auto& [name, file] : samples)
        for (const prep::Mesh& mesh : load(name).meshes) {
            EXPECT_TRUE(mesh.normals.values.empty()) << name;
            EXPECT_TRUE(mesh.tangents.values.empty()) << name;
        }
}

TEST(Samples, MachinePartIsFourSolidsWithGroupsAndTwoMaterials) {
    const prep::Scene scene = load("machine_part");
    ASSERT_EQ(scene.meshes.size(), 1u);
    const prep::Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(scene.materials.size(), 2u);
    const std::set<std::uint32_t> used(mesh.face_materials.begin(), mesh.face_materials.end());
    EXPECT_EQ(used, (std::set<std::uint32_t>{0, 1}));
    EXPECT_FALSE(mesh.face_smoothing.empty());
    const prep::MeshSummary summary = prep::check(mesh).summary;
    EXPECT_TRUE(summary.closed && summary.manifold && summary.oriented);
    EXPECT_EQ(summary.components, 4u);
    EXPECT_EQ(summary.genus, 7);  // of all four together
    EXPECT_GT(summary.volume, 0);
    std::size_t around_holes = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        around_holes += mesh.face_offsets[f + 1] - mesh.face_offsets[f] == 23;
    EXPECT_EQ(around_holes, 12u);  // two for each of six holes

    // The genus of each by Euler's V − E + F = 2 − 2g, over components found here.
    std::vector<std::uint32_t> root(mesh.vertex_count());
    for (std::uint32_t v = 0; v < root.size(); ++v) root[v] = v;
    const auto find = [&](std::uint32_t v) {
        while (root[v] != v) v = root[v] = root[root[v]];
        return v;
    };
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f] + 1; c < mesh.face_offsets[f + 1]; ++c)
            root[find(mesh.corner_vertices[c])] = find(mesh.corner_vertices[mesh.face_offsets[f]]);
    std::map<std::uint32_t, long> euler;
    std::set<std::uint32_t> vertices(mesh.corner_vertices.begin(), mesh.corner_vertices.end());
    for (const std::uint32_t v : vertices) ++euler[find(v)];
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t first = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        ++euler[find(mesh.corner_vertices[first])];
        for (std::uint32_t c = first; c < end; ++c) {
            const std::uint32_t a = mesh.corner_vertices[c];
            const std::uint32_t b = mesh.corner_vertices[c + 1 < end ? c + 1 : first];
            if (edges.insert({std::min(a, b), std::max(a, b)}).second) --euler[find(a)];
        }
    }
    std::vector<long> genera;
    for (const auto& [component, number] : euler) genera.push_back((2 - number) / 2);
    std::sort(genera.begin(), genera.end());
    EXPECT_EQ(genera, (std::vector<long>{0, 0, 0, 7}));
}

// The picture of docs/normals.md: with its groups every vertex of a chamfer is several; as a
// pillow, smooth over all edges, each point has one normal and one vertex a material.
TEST(Samples, MachinePartIsCrispByItsGroupsAndAPillowWithout) {
    const auto prepared = [](bool groups, double angle) {
        prep::PrepareOptions options;
        options.hard_edges.smoothing_groups = groups;
        options.hard_edges.angle_degrees = angle;
        auto result = prep::prepare(load("machine_part"), options);
        EXPECT_TRUE(result.has_value()) << to_string(result.error());
        return result ? std::move(*result) : prep::PreparedScene();
    };
    const prep::PreparedScene crisp = prepared(true, 180), pillow = prepared(false, 180);
    EXPECT_EQ(pillow.splits.hard_edge + pillow.splits.smoothing_group, 0u);
    EXPECT_GT(crisp.splits.smoothing_group, 1000u);
    // Flat against an axis, or not: a lid's corners have its normal only where its rim is hard.
    const auto along_axes = [](const prep::PreparedScene& scene) {
        std::size_t count = 0;
        for (const glm::vec3& n : scene.meshes[0].normals)
            count += std::abs(n.x) == 1 || std::abs(n.y) == 1 || std::abs(n.z) == 1;
        return double(count) / double(scene.meshes[0].normals.size());
    };
    EXPECT_GT(along_axes(crisp), 0.2);
    EXPECT_LT(along_axes(pillow), 0.02);
}

TEST(Samples, OctopusIsOneClosedSurfaceOfQuads) {
    const prep::Scene scene = load("octopus");
    ASSERT_EQ(scene.meshes.size(), 1u);
    const prep::MeshSummary summary = prep::check(scene.meshes[0]).summary;
    EXPECT_TRUE(summary.closed && summary.manifold && summary.oriented);
    EXPECT_EQ(summary.components, 1u);
    EXPECT_EQ(summary.quads, summary.faces);
    EXPECT_TRUE(scene.meshes[0].uvs.empty());
    EXPECT_TRUE(scene.materials.empty());
    const auto prepared = prep::prepare(scene);
    ASSERT_TRUE(prepared.has_value());
    EXPECT_EQ(prepared->splits.hard_edge, 0u);  // smooth everywhere
}

TEST(Samples, ShieldIsSplitAlongItsMirrorLine) {
    const prep::Scene scene = load("shield");
    std::uint64_t mirrored = 0, textured = 0;
    bool with = false, without = false;
    const auto prepared = prep::prepare(scene);
    ASSERT_TRUE(prepared.has_value());
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        const prep::MeshSummary summary = prep::check(scene.meshes[m]).summary;
        mirrored += summary.mirrored_uv_faces;
        for (std::size_t f = 0; f < scene.meshes[m].face_count(); ++f)
            textured += scene.meshes[m].uvs.at(0).indices[3 * f] != prep::no_index;
        for (const prep::Material& material : scene.materials)
            (material.normal_map && material.diffuse_map ? with : without) = true;
    }
    EXPECT_TRUE(with && without);
    EXPECT_EQ(2 * mirrored, textured);  // the left half of the front
    EXPECT_GT(prepared->splits.mirrored_uv, 0u);
    // The vertices that were split stand on the middle line, where the halves met.
    std::size_t on_the_line = 0;
    for (const prep::Mesh& mesh : scene.meshes)
        for (const glm::vec3& p : mesh.positions) on_the_line += p.x == 0;
    EXPECT_LE(prepared->splits.mirrored_uv, on_the_line);
}

TEST(Samples, RoomHasItsLightsItsCameraAndRepeatingTextures) {
    const prep::Scene scene = load("room");
    ASSERT_EQ(scene.lights.size(), 2u);
    std::set<prep::LightKind> kinds;
    for (const prep::Light& light : scene.lights) kinds.insert(light.kind);
    EXPECT_EQ(kinds,
              (std::set<prep::LightKind>{prep::LightKind::directional, prep::LightKind::point}));
    EXPECT_EQ(scene.cameras.size(), 1u);
    std::size_t normal_maps = 0;
    for (const prep::Material& material : scene.materials)
        if (material.normal_map) {
            ++normal_maps;
            const prep::Texture& texture = scene.textures.at(material.normal_map.texture);
            EXPECT_EQ(texture.wrap_u, prep::Wrap::repeat);
            EXPECT_EQ(texture.wrap_v, prep::Wrap::repeat);
        }
    EXPECT_GE(normal_maps, 2u);  // walls and floor
    float farthest = 0;
    for (const prep::Mesh& mesh : scene.meshes)
        for (const auto& layer : mesh.uvs)
            for (const glm::vec2& uv : layer.values)
                farthest = std::max({farthest, std::abs(uv.x), std::abs(uv.y)});
    EXPECT_GT(farthest, 1.5f);  // they do repeat
}

}  // namespace
