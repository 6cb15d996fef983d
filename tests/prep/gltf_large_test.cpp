// glTF meshes so large that threads fill their arrays, and that writing lends them instead of
// copying: the same on any threads, and what was prepared is what is written.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "shapes.h"

namespace {

using prep::Compression;
using prep::Mesh;
using prep::no_index;
using prep::VertexMesh;

// Triangles of more vertices than 16 bits number, with UVs and colours at each.
Mesh large_mesh() {
    Mesh mesh = shapes::fan_triangulated(shapes::torus(300, 240));
    mesh.uvs.assign(1, {});
    mesh.colors.assign(1, {});
    for (const glm::vec3& p : mesh.positions) {
        mesh.uvs[0].values.emplace_back(p.x * 3 + p.z, p.y - p.z);
        mesh.colors[0].values.emplace_back(glm::fract(glm::abs(glm::vec4(p, p.x + p.y))));
    }
    mesh.uvs[0].indices = mesh.colors[0].indices = mesh.corner_vertices;
    return mesh;
}

prep::PrepareOptions all_anew() {
    prep::PrepareOptions options;
    options.normals = prep::Authored::replace;
    options.request.tangents = prep::Request::Level::always;
    return options;
}

// Two primitives where there are two materials.
void write_large(const std::filesystem::path& path, std::size_t materials) {
    prep::Scene scene;
    scene.materials.resize(materials);
    scene.meshes.push_back(large_mesh());
    Mesh& mesh = scene.meshes[0];
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        mesh.face_materials.push_back(std::uint32_t(f * materials / mesh.face_count()));
    scene.nodes.resize(1);
    scene.nodes[0].mesh = 0;
    const auto prepared = prep::prepare(std::move(scene), all_anew());
    ASSERT_TRUE(prepared.has_value());
    ASSERT_TRUE(prep::save_scene(*prepared, path).has_value());
}

TEST(GltfLarge, ThreadsReadTheSameMeshes) {
    const test::TempDir dir;
    for (const std::size_t materials : {std::size_t(1), std::size_t(2)}) {
        write_large(dir / "a.glb", materials);
        prep::LoadOptions options;
        options.threads = 1;
        const auto alone = prep::load_scene(dir / "a.glb", options);
        ASSERT_TRUE(alone.has_value());
        const Mesh& first = alone->meshes[0];
        Mesh expected = large_mesh();
        expected.normals = first.normals;  // which it has not
        EXPECT_EQ(test::corner_difference(first, expected), "");
        EXPECT_EQ(first.parts.size(), materials);
        for (options.threads = 2; options.threads <= 8; options.threads += 6) {
            const auto several = prep::load_scene(dir / "a.glb", options);
            ASSERT_TRUE(several.has_value());
            EXPECT_EQ(test::exact_difference(several->meshes[0], first), "")
                << options.threads << " threads";
        }
    }
}

std::array<std::uint32_t, 3> bits(const glm::vec3& v) {
    return {std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y),
            std::bit_cast<std::uint32_t>(v.z)};
}

// Corners of what is written and of what was prepared that differ.
std::size_t different_corners(const Mesh& written, const VertexMesh& prepared) {
    EXPECT_EQ(written.corner_count(), prepared.indices.size());
    std::size_t different = written.corner_count() != prepared.indices.size();
    for (std::size_t c = 0; c < written.corner_count() && c < prepared.indices.size(); ++c) {
        const std::uint32_t v = prepared.indices[c];
        const glm::vec4& tangent = written.tangents.values[written.tangents.indices[c]];
        different +=
            bits(written.positions[written.corner_vertices[c]]) != bits(prepared.positions[v]) ||
            bits(written.normals.values[written.normals.indices[c]]) != bits(prepared.normals[v]) ||
            bits(glm::vec3(tangent)) != bits(glm::vec3(prepared.tangents[v])) ||
            tangent.w != prepared.tangents[v].w ||
            written.uvs[0].values[written.uvs[0].indices[c]] != prepared.uvs[0][v] ||
            written.colors[0].values[written.colors[0].indices[c]] != prepared.colors[0][v];
    }
    return different;
}

class Rewritten {
  public:
    explicit Rewritten(std::size_t materials) {
        write_large(dir_ / "a.glb", materials);
        auto scene = prep::load_scene(dir_ / "a.glb");
        EXPECT_TRUE(scene.has_value());
        auto made = prep::prepare(*std::move(scene), all_anew());
        EXPECT_TRUE(made.has_value());
        prepared = *std::move(made);
    }
    VertexMesh& mesh() { return prepared.meshes[0]; }
    Mesh written(Compression compression = Compression::none) {
        prep::SaveOptions options;
        options.compression = compression;
        const auto saved = prep::save_scene(prepared, dir_ / "b.glb", options);
        EXPECT_TRUE(saved.has_value()) << (saved ? "" : to_string(saved.error()));
        auto scene = prep::load_scene(dir_ / "b.glb");
        EXPECT_TRUE(scene.has_value()) << (scene ? "" : to_string(scene.error()));
        return scene ? std::move(scene->meshes[0]) : Mesh();
    }
    prep::PreparedScene prepared;

  private:
    test::TempDir dir_;
};

TEST(GltfLarge, IsWrittenAsItWasPrepared) {
    for (const std::size_t materials : {std::size_t(1), std::size_t(2)}) {
        Rewritten file(materials);
        EXPECT_GT(file.mesh().positions.size(), 65'536u);
        EXPECT_EQ(different_corners(file.written(), file.mesh()), 0u);
    }
}

TEST(GltfLarge, IsWrittenWithoutVerticesThatNothingUses) {
    Rewritten file(1);
    const std::size_t before = file.mesh().positions.size();
    // The last ring of triangles goes, and with it vertices of its own.
    file.mesh().ranges[0].triangle_count -= 1000;
    file.mesh().indices.resize(file.mesh().indices.size() - 3000);
    const Mesh written = file.written();
    EXPECT_LT(written.vertex_count(), before);
    EXPECT_EQ(different_corners(written, file.mesh()), 0u);
}

TEST(GltfLarge, WhatIsNotFiniteIsMendedInCopies) {
    Rewritten file(1);
    VertexMesh& mesh = file.mesh();
    const std::uint32_t at = mesh.indices[3 * 70'000];
    mesh.normals[at].y = std::numeric_limits<float>::quiet_NaN();
    mesh.tangents[at].w = std::numeric_limits<float>::infinity();
    const Mesh written = file.written();
    VertexMesh expected = mesh;
    expected.normals[at] = {0, 0, 1};
    expected.tangents[at].w = 1;
    EXPECT_EQ(different_corners(written, expected), 0u);
    EXPECT_TRUE(std::isnan(mesh.normals[at].y)) << "the prepared mesh stays";
    // A triangle whose position is none is left out.
    mesh.normals[at] = {0, 0, 1};
    mesh.tangents[at].w = 1;
    mesh.positions[mesh.indices.back()].x = std::numeric_limits<float>::infinity();
    const Mesh fewer = file.written();
    EXPECT_LT(fewer.corner_count(), mesh.indices.size());
    EXPECT_GE(fewer.corner_count() + 30, mesh.indices.size());
}

// What is lent to a codec is read before its owner is gone.
TEST(GltfLarge, IsCompressedFromWhatIsLent) {
    Rewritten file(2);
    for (const Compression compression : {Compression::meshopt, Compression::draco}) {
        const Mesh written = file.written(compression);
        EXPECT_EQ(written.corner_count(), file.mesh().indices.size());
        EXPECT_EQ(written.vertex_count(), file.mesh().positions.size());
    }
}

}  // namespace
