// OM files: what OpenMesh wrote, cut, bent and set against its promises.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "formats/foreign_files.h"
#include "invariants.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "shared_data.h"

namespace {

prep::Result<prep::Scene> parse_om(const std::string& text) {
    auto scene =
        prep::detail::load_om(std::as_bytes(std::span(text.data(), text.size())), "test.om");
    if (scene) {
        EXPECT_EQ(test::broken_promise(*scene), "");
    }
    return scene;
}

std::string om_error(const std::string& text) {
    const auto result = parse_om(text);
    return result ? "no error" : prep::to_string(result.error());
}

// Written by OpenMesh 9: a cube without its sixth side, x of 0 and 1.1, normals, UVs, colours.
std::string sample(const char* name) {
    return test::file_text(test::source_dir() / "fuzz/corpus/om" / name);
}

TEST(OpenMeshFile, ReadsDoublesAndFloats) {
    for (const bool doubles : {true, false}) {
        const auto scene = parse_om(sample(doubles ? "doubles.om" : "floats.om"));
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
        // The bytes 1, 2, 3 in sRGB, on its straight part.
        ASSERT_EQ(m.colors.size(), 1u);
        EXPECT_EQ(m.colors[0].indices, m.corner_vertices);
        for (int k = 0; k < 3; ++k)
            EXPECT_FLOAT_EQ(m.colors[0].values[7][k], float((k + 1) / 255.0 / 12.92));
        EXPECT_EQ(m.colors[0].values[7].a, 1.0f);
        EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
    }
}

TEST(OpenMeshFile, ChunksThatAreNotTakenAreNamed) {
    const std::string text = sample("floats.om");
    const auto chunk = [](unsigned entity, unsigned type, unsigned dim, bool named) {
        const unsigned head = unsigned(named) << 1 | entity << 2 | type << 5 | (dim - 1) << 11;
        return std::string{char(head & 255), char(head >> 8)};
    };
    using namespace std::string_literals;
    const std::string of_faces = chunk(2, 4, 3, false) + std::string(5 * 3, 'f');
    const std::string with_alpha = chunk(0, 4, 4, false) + std::string(8 * 4, 'a');
    const std::string custom = chunk(0, 6, 1, true) + "\4heat\6double"s + "\10\0\0\0"s + "12345678";
    const auto scene = parse_om(text.substr(0, text.size() - 2) + of_faces + with_alpha + custom +
                                text.substr(text.size() - 2));
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_EQ(scene->warnings[0],
              "test.om: what was not taken: faces' colours, vertices' colours, heat");
}

// Written by OpenMesh 9 with Options::Status: the cube with a double by vertex, a text by face, an
// int by edge and one of the mesh, all of them persistent, and with every kind of status.
TEST(OpenMeshFile, PropertiesAndStatusAsOpenMeshWritesThemAreNamed) {
    const auto scene = parse_om(sample("extras.om"));
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].vertex_count(), 8u);
    EXPECT_EQ(scene->meshes[0].face_count(), 5u);
    EXPECT_EQ(scene->meshes[0].positions[7], glm::vec3(1.1f, 1, 1));
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_EQ(scene->warnings[0],
              "test.om: what was not taken: vertices' status, edges' status, half-edges' status, "
              "faces' status, curvature, label, crease, meta");
}

// Until 2.1 nothing says what type a property is of.
TEST(OpenMeshFile, OlderPropertiesHaveNoTypeName) {
    using namespace std::string_literals;
    std::string text = sample("floats.om");
    text[3] = 0x41;
    text.insert(text.size() - 2, "\xc2\0"s + "\4heat"s + "\10\0\0\0"s + "12345678");
    const auto scene = parse_om(text);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_EQ(scene->warnings[0], "test.om: what was not taken: heat");
}

TEST(OpenMeshFile, NamesLongerThanTheFileAreErrors) {
    using namespace std::string_literals;
    std::string text = sample("floats.om");
    text.resize(text.size() - 2);
    const std::string at = "test.om, byte " + std::to_string(text.size());
    for (const std::string& rest : {""s, "\xff"s, "\4hea"s, "\4heat"s, "\4heat\xff"s})
        EXPECT_EQ(om_error(text + "\xc2\0"s + rest), at + ": a chunk's name is cut short");
    EXPECT_EQ(om_error(text + "\xc2\0\4heat\6double\1\0"s), at + ": a property is cut short");
    EXPECT_EQ(om_error(text + "\xc2\0\4heat\6double\xff\xff\xff\xff"s),
              at + ": a chunk of 4294967295 bytes, but only 0 are left");
}

TEST(OpenMeshFile, EveryTruncationIsAnError) {
    for (const char* name : {"doubles.om", "floats.om", "extras.om"}) {
        const std::string whole = sample(name);
        ASSERT_GT(whole.size(), 300u);
        for (std::size_t n = 0; n < whole.size(); ++n)
            EXPECT_FALSE(parse_om(whole.substr(0, n)).has_value()) << name << " cut to " << n;
    }
}

TEST(OpenMeshFile, EveryByteTurnedIsAnErrorOrAValidMesh) {
    for (const char* name : {"floats.om", "extras.om"}) {
        const std::string whole = sample(name);
        std::size_t refused = 0;
        for (std::size_t i = 0; i < whole.size(); ++i)
            for (const int bits : {0x01, 0x80, 0xff}) {
                std::string bent = whole;
                bent[i] = char(bent[i] ^ bits);
                refused += !parse_om(bent).has_value();  // parse_om() checks what is accepted
            }
        EXPECT_GT(refused, whole.size() / 4);  // header and connectivity make up more than that
    }
}

TEST(OpenMeshFile, ErrorsNameTheByte) {
    const std::string whole = sample("floats.om");
    EXPECT_EQ(om_error("OM"), "test.om, byte 0: the file is shorter than an OM header");
    std::string bent = whole;
    bent[0] = 'P';
    EXPECT_EQ(om_error(bent), "test.om, byte 0: expected \"OM\" at the beginning: not an OM file");
    bent = whole;
    bent[3] = 0x21;
    EXPECT_EQ(om_error(bent),
              "test.om, byte 3: OM version 1 is not supported, only 2: save it anew with OpenMesh "
              "6 or later");
    bent = whole;
    for (std::size_t i = 4; i < 16; ++i) bent[i] = '\xff';
    EXPECT_EQ(om_error(bent),
              "test.om, byte 0: the header announces 4294967295 vertices, 4294967295 faces and "
              "4294967295 edges, more than the file has room for");
    bent = whole;
    bent[4] = 30;  // more vertices, still fewer than the file has bytes for
    EXPECT_NE(om_error(bent).find("test.om, byte "), std::string::npos);
}

template <class T>
void put_all(std::string& out, std::initializer_list<T> values) {
    for (const T value : values) {
        char raw[sizeof value];
        std::memcpy(raw, &value, sizeof value);
        out.append(raw, sizeof value);
    }
}

// A chunk's head: entity (0 vertices, 2 faces, 6 half-edges, 7 none), type (0 positions,
// 7 connectivity), values of one signed byte or one float, so many of them.
void head(std::string& out, unsigned entity, unsigned type, bool floats, unsigned count) {
    put_all<std::uint16_t>(out, {std::uint16_t(entity << 2 | type << 5 | 1u << 9 |
                                               (floats ? 1u << 10 : 0u) | (count - 1) << 11)});
}

// A file of half-edges (next, vertex they lead to, face), one of each vertex and each face.
std::string om(std::uint32_t vertices, std::uint32_t faces,
               const std::vector<std::array<std::int8_t, 3>>& halfedges,
               std::initializer_list<std::int8_t> outgoing,
               std::initializer_list<std::int8_t> of_faces) {
    std::string out = "OMP\x40";
    put_all<std::uint32_t>(out, {vertices, faces, std::uint32_t(halfedges.size() / 2)});
    head(out, 0, 0, true, 3);
    for (std::uint32_t v = 0; v < vertices; ++v)
        put_all<float>(out, {float(v % 2), float(v / 2), 0.0f});
    head(out, 6, 7, false, 3);
    for (const auto& h : halfedges) put_all<std::int8_t>(out, {h[0], h[1], h[2]});
    head(out, 0, 7, false, 1);
    put_all<std::int8_t>(out, outgoing);
    head(out, 2, 7, false, 1);
    put_all<std::int8_t>(out, of_faces);
    head(out, 7, 0, false, 1);
    return out;
}

TEST(OpenMeshFile, FacesHaveThreeEdgesAtLeast) {
    // Half-edges 2k and 2k + 1 are the sides of edge k: 0 1 2 round the face, the others outside.
    const auto triangle =
        parse_om(om(3, 1, {{2, 1, 0}, {5, 0, -1}, {4, 2, 0}, {1, 1, -1}, {0, 0, 0}, {3, 2, -1}},
                    {0, 2, 4}, {0}));
    ASSERT_TRUE(triangle.has_value()) << prep::to_string(triangle.error());
    EXPECT_EQ(triangle->meshes[0].corner_count(), 3u);
    EXPECT_EQ(triangle->meshes[0].positions[2], glm::vec3(0, 1, 0));
    EXPECT_EQ(om_error(om(2, 1, {{2, 1, 0}, {3, 0, -1}, {0, 0, 0}, {1, 1, -1}}, {0, 2}, {0})),
              "test.om: the half-edges do not form closed faces");
}

TEST(OpenMeshFile, IndicesBeyondTheLastAreRefusedBeforeOpenMeshSeesThem) {
    const std::vector<std::array<std::int8_t, 3>> good{{2, 1, 0},  {5, 0, -1}, {4, 2, 0},
                                                       {1, 1, -1}, {0, 0, 0},  {3, 2, -1}};
    const auto refused = [](const std::string& text, int element) {
        const std::string says =
            "an index of the connectivity is out of range, in element " + std::to_string(element);
        EXPECT_NE(om_error(text).find(says), std::string::npos) << om_error(text);
    };
    const int counts[3] = {6, 3, 1};  // half-edges, vertices, faces
    for (std::size_t part = 0; part < 3; ++part)
        for (const int value : {counts[part], 127, -2}) {
            auto bad = good;
            bad[4][part] = std::int8_t(value);
            refused(om(3, 1, bad, {0, 2, 4}, {0}), 4);
        }
    for (const std::int8_t value : {std::int8_t(6), std::int8_t(-2)}) {
        refused(om(3, 1, good, {0, value, 4}, {0}), 1);
        refused(om(3, 1, good, {0, 2, 4}, {value}), 0);
    }
    // None is a value for a face's side and a vertex's way out alone.
    for (std::size_t part = 0; part < 2; ++part) {
        auto bad = good;
        bad[4][part] = -1;
        refused(om(3, 1, bad, {0, 2, 4}, {0}), 4);
    }
    refused(om(3, 1, good, {0, 2, 4}, {-1}), 0);
}

TEST(OpenMeshFile, LoadsByEnding) {
    const auto scene = prep::load_scene(test::source_dir() / "fuzz/corpus/om/doubles.om");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].name, "doubles");
    EXPECT_EQ(scene->nodes.size(), 1u);
}

}  // namespace
