// OM files: what OpenMesh wrote, cut, bent and set against its promises.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "foreign_files.h"
#include "invariants.h"
#include "mesh_files.h"
#include "prep/io.h"
#include "shared_data.h"

namespace {

prep::Result<prep::Scene> parse(const std::string& text) {
    auto scene =
        prep::detail::load_om(std::as_bytes(std::span(text.data(), text.size())), "test.om");
    if (scene) {
        EXPECT_EQ(test::broken_promise(*scene), "");
    }
    return scene;
}

std::string error_of(const std::string& text) {
    const auto result = parse(text);
    return result ? "no error" : prep::to_string(result.error());
}

// Written by OpenMesh 9: a cube without its sixth side, x of 0 and 1.1, normals, UVs, colours.
std::string sample(const char* name) {
    return test::file_text(test::source_dir() / "fuzz/corpus/om" / name);
}

TEST(OpenMeshFile, ReadsDoublesAndFloats) {
    for (const bool doubles : {true, false}) {
        const auto scene = parse(sample(doubles ? "doubles.om" : "floats.om"));
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        const prep::Mesh& m = scene->meshes[0];
        ASSERT_EQ(m.vertex_count(), 8u);
        ASSERT_EQ(m.face_count(), 5u);
        EXPECT_EQ(m.positions[7], glm::vec3(1.1f, 1, 1));
        const auto first =
            std::vector<std::uint32_t>(m.corner_vertices.begin(), m.corner_vertices.begin() + 4);
        // The face 0 2 3 1 of the writer, from whichever corner OpenMesh begins.
        const std::vector<std::uint32_t> ring{0, 2, 3, 1};
        bool found = false;
        for (std::size_t turn = 0; turn < 4; ++turn) {
            bool same = true;
            for (std::size_t k = 0; k < 4; ++k) same = same && first[k] == ring[(k + turn) % 4];
            found = found || same;
        }
        EXPECT_TRUE(found);
        ASSERT_EQ(m.normals.indices.size(), m.corner_count());
        EXPECT_EQ(m.normals.values[0], glm::vec3(0, 0, 1));
        ASSERT_EQ(m.uvs.size(), 1u);
        EXPECT_EQ(m.uvs[0].values[3], glm::vec2(0.375f, 0.75f));
    }
}

TEST(OpenMeshFile, EveryTruncationIsAnError) {
    for (const char* name : {"doubles.om", "floats.om"}) {
        const std::string whole = sample(name);
        ASSERT_GT(whole.size(), 300u);
        for (std::size_t n = 0; n < whole.size(); ++n)
            EXPECT_FALSE(parse(whole.substr(0, n)).has_value()) << name << " cut to " << n;
    }
}

TEST(OpenMeshFile, EveryByteTurnedIsAnErrorOrAValidMesh) {
    const std::string whole = sample("floats.om");
    std::size_t refused = 0;
    for (std::size_t i = 0; i < whole.size(); ++i)
        for (const int bits : {0x01, 0x80, 0xff}) {
            std::string bent = whole;
            bent[i] = char(bent[i] ^ bits);
            refused += !parse(bent).has_value();  // parse() checks what is accepted
        }
    EXPECT_GT(refused, whole.size() / 4);  // header and connectivity make up more than that
}

TEST(OpenMeshFile, ErrorsNameTheByte) {
    const std::string whole = sample("floats.om");
    EXPECT_EQ(error_of("OM"), "test.om, byte 0: the file is shorter than an OM header");
    std::string bent = whole;
    bent[0] = 'P';
    EXPECT_EQ(error_of(bent), "test.om, byte 0: expected \"OM\" at the beginning: not an OM file");
    bent = whole;
    bent[3] = 0x21;
    EXPECT_EQ(error_of(bent),
              "test.om, byte 3: OM version 1 is not supported, only 2: save it anew with OpenMesh "
              "6 or later");
    bent = whole;
    for (std::size_t i = 4; i < 16; ++i) bent[i] = '\xff';
    EXPECT_EQ(error_of(bent),
              "test.om, byte 0: the header announces 4294967295 vertices, 4294967295 faces and "
              "4294967295 edges, more than the file has room for");
    bent = whole;
    bent[4] = 30;  // more vertices, still fewer than the file has bytes for
    EXPECT_NE(error_of(bent).find("test.om, byte "), std::string::npos);
}

TEST(OpenMeshFile, LoadsByEnding) {
    const auto scene = prep::load_scene(test::source_dir() / "fuzz/corpus/om/doubles.om");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].name, "doubles");
    EXPECT_EQ(scene->nodes.size(), 1u);
}

}  // namespace
