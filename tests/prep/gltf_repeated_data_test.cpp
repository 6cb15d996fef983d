// glTF files that name the same bytes again and again: what is read is shared or limited.
#include <gtest/gtest.h>

#include <filesystem>

#include "gltf_source.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "temporary_files.h"

namespace {

using Json = test::GltfSource::Json;
using test::GltfSource;

const std::vector<float> corner_values{0, 0, 0, 1, 0, 0, 0, 1, 0};

GltfSource one_triangle() {
    GltfSource d;
    d.mesh({{{"attributes", {{"POSITION", d.add_positions(corner_values)}}}}});
    return d;
}

std::string refusal_of(const GltfSource& d) {
    return test::error_of(d.read());
}

// 1 MiB of picture, four hundred times: beyond 256 MiB and 64 times the file.
TEST(GltfRepeatedData, PicturesOfOneViewAreLimited) {
    GltfSource d = one_triangle();
    const std::size_t view = d.view(std::vector<std::uint8_t>(1 << 20, 7));
    for (int i = 0; i < 400; ++i)
        d.push("images", {{"bufferView", view}, {"mimeType", "image/png"}});
    const std::string said = refusal_of(d);
    EXPECT_NE(said.find("/images/3"), std::string::npos) << said;
    EXPECT_NE(said.find("name the same data so often"), std::string::npos) << said;
    d.json["images"].erase(d.json["images"].begin() + 300, d.json["images"].end());
    const auto scene = d.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(scene->images.size(), 300u);
    EXPECT_EQ(scene->images[299].bytes.size(), std::size_t(1) << 20);
}

// By different words for one file; each file by itself may be as large as it is.
TEST(GltfRepeatedData, PicturesOfOneFileAreLimited) {
    const test::TempDir dir;
    test::write_text(dir / "a.png", std::string(8 << 20, 'a'));
    GltfSource d = one_triangle();
    std::string way;
    for (int i = 0; i < 50; ++i) {
        d.push("images", {{"uri", way + "a.png"}});
        way += "./";
    }
    d.write(dir / "a.gltf");
    const auto scene = prep::load_scene(dir / "a.gltf");
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().code, prep::ErrorCode::limit);

    // Folders of another machine lead to the file that stands here.
    GltfSource other = one_triangle();
    for (int i = 0; i < 50; ++i)
        other.push("images", {{"uri", "work" + std::to_string(i) + "/a.png"}});
    other.write(dir / "b.gltf");
    const auto sought = prep::load_scene(dir / "b.gltf");
    ASSERT_FALSE(sought);
    EXPECT_EQ(sought.error().code, prep::ErrorCode::limit);

    GltfSource e = one_triangle();
    for (int i = 0; i < 50; ++i) {
        const std::string name = std::to_string(i) + ".png";
        test::write_text(dir / name, std::string(8 << 20, 'a'));
        e.push("images", {{"uri", name}});
    }
    e.write(dir / "e.gltf");
    const auto many = prep::load_scene(dir / "e.gltf");
    EXPECT_TRUE(many) << test::error_of(many);
}

// By different words for one file of 1 MiB: it is read, and counted, once.
TEST(GltfRepeatedData, BuffersOfOneFileAreOne) {
    const test::TempDir dir;
    test::write_text(dir / "a.bin", std::string(1 << 20, 'a'));
    const GltfSource d = one_triangle();
    Json document = Json::parse(d.gltf());
    std::string way;
    for (int i = 0; i < 100; ++i) {
        document["buffers"].push_back({{"byteLength", 1}, {"uri", way + "%61.bin"}});
        way += "./";
    }
    const std::string text = document.dump();
    test::write_text(dir / "a.gltf", text);
    const auto scene = prep::load_scene(dir / "a.gltf");
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(scene->source_bytes, text.size() + 36 + (1 << 20));
}

TEST(GltfRepeatedData, SkinsReadTheirJointsAlone) {
    GltfSource d = one_triangle();
    std::vector<float> matrices(16 * 20'000, 0.5f);
    const std::size_t bind = d.add_floats("MAT4", matrices);
    const std::size_t node = d.root({{"name", "joint"}});
    for (int i = 0; i < 20'000; ++i)
        d.push("skins", {{"joints", {node}}, {"inverseBindMatrices", bind}});
    const auto scene = d.read();  // 25 GB of matrices, if each skin read all
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(scene->skins.size(), 20'000u);
    EXPECT_EQ(scene->skins[7].inverse_bind[0][3][3], 0.5f);
}

TEST(GltfRepeatedData, SparseAccessorsAreLimited) {
    GltfSource d;
    constexpr std::size_t count = 1 << 20;
    const std::size_t zeros = d.view(std::vector<float>(3 * count, 0));
    const std::size_t numbers = d.view(std::vector<std::uint8_t>{1}),
                      values = d.view(std::vector<float>{0, 1, 0});
    const std::size_t positions =
        d.accessor(Json{{"bufferView", zeros},
                        {"componentType", 5126},
                        {"count", count},
                        {"type", "VEC3"},
                        {"sparse",
                         {{"count", 1},
                          {"indices", {{"bufferView", numbers}, {"componentType", 5121}}},
                          {"values", {{"bufferView", values}}}}}});
    const std::size_t three = d.accessor(std::vector<std::uint32_t>{0, 1, 2}, "SCALAR");
    Json primitives = Json::array();
    for (int i = 0; i < 4000; ++i)  // 12 MiB each
        primitives.push_back({{"attributes", {{"POSITION", positions}}}, {"indices", three}});
    d.mesh(primitives);
    const std::string said = refusal_of(d);
    EXPECT_NE(said.find("sparse accessors are used so often"), std::string::npos) << said;
    d.json["meshes"][0]["primitives"].erase(d.json["meshes"][0]["primitives"].begin() + 20,
                                            d.json["meshes"][0]["primitives"].end());
    const auto scene = d.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(scene->meshes[0].positions[1], glm::vec3(0, 1, 0));
}

}  // namespace
