// What repairs do to the data of glTF files that is by vertex: corners keep their attributes. And
// what variants of materials call for.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "prep/scene_json.h"

namespace {

using Floats = std::vector<float>;

// One primitive of float attributes.
struct File {
    std::string attributes, views, accessors, bytes;
    int count = 0;

    void add_view(const void* data, std::size_t size) {
        views += (views.empty() ? "" : ",") + std::string(R"({"buffer":0,"byteOffset":)") +
                 std::to_string(bytes.size()) + R"(,"byteLength":)" + std::to_string(size) + "}";
        bytes.append(static_cast<const char*>(data), size);
    }
    void add(const std::string& name, const std::string& type, int width, const Floats& values) {
        add_view(values.data(), values.size() * sizeof(float));
        accessors += (count == 0 ? "" : ",") + std::string(R"({"bufferView":)") +
                     std::to_string(count) + R"(,"componentType":5126,"count":)" +
                     std::to_string(values.size() / std::size_t(width)) + R"(,"type":")" + type +
                     "\"" + (count == 0 ? R"(,"min":[0,0,0],"max":[2,2,0])" : "") + "}";
        attributes += (count == 0 ? "\"" : ",\"") + name + "\":" + std::to_string(count);
        ++count;
    }
    std::string text(const std::vector<std::uint32_t>& indices) {
        add_view(indices.data(), indices.size() * 4);
        return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
               R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{)" +
               attributes + R"(},"indices":)" + std::to_string(count) + R"(}]}],"accessors":[)" +
               accessors + R"(,{"bufferView":)" + std::to_string(count) +
               R"(,"componentType":5125,"count":)" + std::to_string(indices.size()) +
               R"(,"type":"SCALAR"}],"bufferViews":[)" + views +
               R"(],"buffers":[{"uri":"in.bin","byteLength":)" + std::to_string(bytes.size()) +
               "}]}";
    }
};

prep::Result<prep::Scene> repaired(const test::TempDir& dir, File file,
                                   const std::vector<std::uint32_t>& indices,
                                   const prep::RepairOptions& repair) {
    test::write_text(dir / "in.gltf", file.text(indices));
    test::write_text(dir / "in.bin", file.bytes);
    auto scene = prep::load_scene(dir / "in.gltf");
    if (!scene) return std::move(scene).error();
    prep::PrepareOptions options;
    options.repair = repair;
    const auto prepared = prep::prepare(*std::move(scene), options);
    if (!prepared) return prepared.error();
    if (auto saved = prep::save_scene(*prepared, dir / "out.gltf"); !saved)
        return std::move(saved).error();
    return prep::load_scene(dir / "out.gltf");
}

template <class T>
std::vector<T> by_corner(const prep::CornerLayer<T>& layer) {
    std::vector<T> values;
    for (const std::uint32_t i : layer.indices) values.push_back(layer.values[i]);
    return values;
}

// Two quads that share two points, with a seam of UVs, colours and a custom attribute between them.
TEST(GltfRepair, WeldedCornersKeepTheirAttributes) {
    const std::vector<std::uint32_t> indices = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
    const Floats u = {0, 0.4f, 0.4f, 0, 0.6f, 1, 1, 0.6f};
    Floats uvs, colors, custom;
    for (std::size_t v = 0; v < 8; ++v) {
        uvs.insert(uvs.end(), {u[v], 0.25f * float(v % 4)});
        colors.insert(colors.end(), {float(v) / 8, 0.5f, 0.25f});
        custom.push_back(float(v));
    }
    File file;
    file.add("POSITION", "VEC3", 3,
             {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 0, 2, 0, 0, 2, 1, 0, 1, 1, 0});
    file.add("TEXCOORD_0", "VEC2", 2, uvs);
    file.add("COLOR_0", "VEC3", 3, colors);
    file.add("_CUSTOM", "SCALAR", 1, custom);
    const test::TempDir dir;
    prep::RepairOptions repair;
    repair.weld_tolerance = 0;
    const auto out = repaired(dir, file, indices, repair);
    ASSERT_TRUE(out.has_value()) << prep::to_string(out.error());
    const prep::Mesh& mesh = out->meshes[0];
    ASSERT_EQ(mesh.corner_count(), indices.size());
    const std::vector<glm::vec2> uv = by_corner(mesh.uvs[0]);
    const std::vector<glm::vec4> color = by_corner(mesh.colors[0]);
    const std::string binary = test::file_text(dir / "out.bin");
    for (std::size_t c = 0; c < indices.size(); ++c) {
        const std::size_t v = indices[c];
        EXPECT_EQ(uv[c], glm::vec2(uvs[2 * v], uvs[2 * v + 1])) << c;
        EXPECT_EQ(color[c], glm::vec4(colors[3 * v], 0.5f, 0.25f, 1)) << c;
    }
    // The seam stays open: eight vertices, each with its own value.
    EXPECT_EQ(mesh.vertex_count(), 8u);
    for (const float value : custom)
        EXPECT_NE(binary.find(std::string(reinterpret_cast<const char*>(&value), 4)),
                  std::string::npos)
            << value;
}

// What the mesh has no layer for keeps corners apart by itself, and normal maps do not.
TEST(GltfRepair, WeldedCornersKeepWhatHasNoLayer) {
    File file;
    file.add("POSITION", "VEC3", 3,
             {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 0, 2, 0, 0, 2, 1, 0, 1, 1, 0});
    file.add("_ID", "SCALAR", 1, {10, 11, 12, 13, 14, 15, 16, 17});
    const test::TempDir dir;
    prep::RepairOptions repair;
    repair.weld_tolerance = 0;
    repair.orientation = true;
    repair.degenerate_faces = true;
    const auto out = repaired(dir, file, {0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 6, 7}, repair);
    ASSERT_TRUE(out.has_value()) << prep::to_string(out.error());
    EXPECT_EQ(out->meshes[0].vertex_count(), 8u);
    const std::string binary = test::file_text(dir / "out.bin");
    for (float id = 10; id < 18; ++id)
        EXPECT_NE(binary.find(std::string(reinterpret_cast<const char*>(&id), 4)),
                  std::string::npos)
            << id;
}

// What the format forbids is mended in layers that repairs changed, too.
TEST(GltfRepair, LayersThatAreWrittenAnewAreValid) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    File file;
    file.add("POSITION", "VEC3", 3, {0, 0, 0, 2, 0, 0, 0, 2, 0, 1, 0, 0, 2, 2, 0});
    file.add("TEXCOORD_0", "VEC2", 2, {0, 0, 1, 0, 0, 1, 0.9f, 0.9f, nan, 1});
    file.add("COLOR_0", "VEC3", 3, {1.5f, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1, nan, -1, 0.5f});
    const test::TempDir dir;
    prep::RepairOptions repair;
    repair.degenerate_faces = true;
    const auto out = repaired(dir, file, {0, 1, 2, 0, 3, 1, 2, 1, 4}, repair);
    ASSERT_TRUE(out.has_value()) << prep::to_string(out.error());
    for (const glm::vec2& t : out->meshes[0].uvs[0].values)
        EXPECT_TRUE(std::isfinite(t.x) && std::isfinite(t.y));
    for (const glm::vec4& c : out->meshes[0].colors[0].values)
        for (int k = 0; k < 3; ++k) EXPECT_TRUE(c[k] >= 0 && c[k] <= 1) << c[k];
}

// Material 0, a variant's, has its normal map on the second UV set, the mesh's own on the first.
TEST(GltfVariants, NormalMapsOfTheirMaterialsGetTangentsBehindTheMeshsOwn) {
    const Floats first = {0, 0, 1, 0, 0, 1}, second = {0, 0, 0, 1, 1, 0};
    const auto tangents = [&](const std::string& own) {
        File file;
        file.add("POSITION", "VEC3", 3, {0, 0, 0, 2, 0, 0, 0, 2, 0});
        file.add("TEXCOORD_0", "VEC2", 2, first);
        file.add("TEXCOORD_1", "VEC2", 2, second);
        const test::TempDir dir;
        std::string text = file.text({0, 1, 2});
        const std::string primitive = R"("indices":3)";
        text.insert(text.find(primitive) + primitive.size(),
                    R"(,"material":1,"extensions":{"KHR_materials_variants":{"mappings":[)"
                    R"({"material":0,"variants":[0]},{"material":9,"variants":[0]}]}})");
        text.pop_back();
        text +=
            R"(,"extensionsUsed":["KHR_materials_variants"],"extensions":)"
            R"({"KHR_materials_variants":{"variants":[{"name":"a"}]}},"images":[{"uri":"n.png"}],)"
            R"("textures":[{"source":0}],"materials":[)"
            R"({"normalTexture":{"index":0,"texCoord":1}},)" +
            own + "]}";
        test::write_text(dir / "in.gltf", text);
        test::write_text(dir / "in.bin", file.bytes);
        auto scene = prep::load_scene(dir / "in.gltf");
        EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        EXPECT_EQ(scene->meshes[0].variant_materials, std::vector<std::uint32_t>{0});
        const auto prepared = prep::prepare(*std::move(scene), {});
        EXPECT_TRUE(prepared.has_value());
        EXPECT_TRUE(prep::save_scene(*prepared, dir / "out.gltf").has_value());
        const auto out = prep::load_scene(dir / "out.gltf");
        return out->meshes[0].tangents.values;
    };
    const std::vector<glm::vec4> plain = tangents("{}");
    ASSERT_FALSE(plain.empty());
    EXPECT_EQ(glm::vec3(plain[0]), glm::vec3(0, 1, 0));
    const std::vector<glm::vec4> own = tangents(R"({"normalTexture":{"index":0}})");
    ASSERT_FALSE(own.empty());
    EXPECT_EQ(glm::vec3(own[0]), glm::vec3(1, 0, 0));
}

// Beside another file in a scene: materials are numbered through.
TEST(GltfVariants, AreThoseOfTheirFileInSceneFiles) {
    const test::TempDir dir;
    File file;
    file.add("POSITION", "VEC3", 3, {0, 0, 0, 2, 0, 0, 0, 2, 0});
    std::string text = file.text({0, 1, 2});
    const std::string primitive = R"("indices":1)";
    text.insert(text.find(primitive) + primitive.size(),
                R"(,"material":1,"extensions":{"KHR_materials_variants":{"mappings":[)"
                R"({"material":0,"variants":[0]}]}})");
    text.pop_back();
    text += R"(,"extensionsUsed":["KHR_materials_variants"],"extensions":)"
            R"({"KHR_materials_variants":{"variants":[{"name":"a"}]}},)"
            R"("materials":[{"name":"other"},{"name":"own"}]})";
    test::write_text(dir / "in.gltf", text);
    test::write_text(dir / "in.bin", file.bytes);
    const auto scene = prep::parse_scene_json(
        R"({"meshprep": 1, "meshes": {"a": {"file": "in.gltf"}, "b": {"file": "in.gltf"}}})",
        dir / "s.json");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const prep::Scene& both = scene->scene;
    ASSERT_EQ(both.meshes.size(), 2u);
    for (const prep::Mesh& mesh : both.meshes) {
        ASSERT_EQ(mesh.variant_materials.size(), 1u);
        EXPECT_EQ(both.materials.at(mesh.variant_materials[0]).name, "other");
        EXPECT_EQ(both.materials.at(mesh.face_materials.at(0)).name, "own");
    }
    EXPECT_NE(both.meshes[0].variant_materials, both.meshes[1].variant_materials);
}

// A triangle without area along the bottom of another: its middle point is put into that edge, with
// the UV in between, which no vertex of the file has.
TEST(GltfRepair, CornersPutIntoAnEdgeHaveTheUvInBetween) {
    File file;
    file.add("POSITION", "VEC3", 3, {0, 0, 0, 2, 0, 0, 0, 2, 0, 1, 0, 0});
    file.add("TEXCOORD_0", "VEC2", 2, {0, 0, 1, 0, 0, 1, 0.9f, 0.9f});
    const test::TempDir dir;
    prep::RepairOptions repair;
    repair.degenerate_faces = true;
    const auto out = repaired(dir, file, {0, 1, 2, 0, 3, 1}, repair);
    ASSERT_TRUE(out.has_value()) << prep::to_string(out.error());
    const prep::Mesh& mesh = out->meshes[0];
    const std::vector<glm::vec2> uv = by_corner(mesh.uvs[0]);
    std::size_t found = 0;
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::vec3 p = mesh.positions[mesh.corner_vertices[c]];
        EXPECT_EQ(uv[c], glm::vec2(p) / 2.0f) << c;
        found += p.x == 1;
    }
    EXPECT_GT(found, 0u);
}

}  // namespace
