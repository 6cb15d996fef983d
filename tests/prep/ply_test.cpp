#include "formats/ply/ply.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "mesh_files.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shapes.h"

namespace {

prep::Result<prep::Scene> parse_ply(const std::string& text) {
    return test::parsed(prep::parse_ply, text, "test.ply");
}

std::string ply_error(const std::string& text) {
    return test::error_of(parse_ply(text));
}

std::string ply_header(const std::string& format, const std::string& lines) {
    return "ply\nformat " + format + " 1.0\n" + lines + "end_header\n";
}

const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string face_indices = "property list uchar int vertex_indices\n";

template <class T>
void put(std::string& out, T value, bool big) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (big) std::reverse(raw, raw + sizeof value);
    out.append(raw, sizeof value);
}

TEST(Ply, EmptyMeshInEveryEncoding) {
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        const auto scene = parse_ply(ply_header(format, "element vertex 0\n" + xyz));
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        EXPECT_EQ(scene->meshes[0].vertex_count(), 0u);
        EXPECT_TRUE(scene->meshes[0].points.empty());
    }
}

TEST(Ply, TheSameMeshInAllThreeEncodings) {
    // Every scalar type once: positions in double and float, skipped ones in between.
    const std::string lines =
        "comment made for a test\nobj_info too\nelement vertex 3\nproperty double x\n"
        "property float32 y\nproperty short z\nproperty char skipped\nproperty uint8 red\n"
        "property ushort green\nproperty uint blue\nproperty int8 also\n"
        "element face 1\nproperty list ushort uint vertex_index\n"
        "element other 2\nproperty list int double values\nproperty int32 n\n";
    const double x[] = {0.1, 1e300, -0.0};
    const float y[] = {0.1f, 1e-42f, 3.5f};
    std::string ascii = ply_header("ascii", lines);
    for (int v = 0; v < 3; ++v) {
        char line[200];
        std::snprintf(line, sizeof line, "%.17g %.9g %d -5 255 65535 4294967295 7\n", x[v],
                      double(y[v]), v - 1);
        ascii += line;
    }
    ascii += "3 0 1 2\n2 1.5 2.5 9\n0 8\n";
    const auto text = parse_ply(ascii);
    ASSERT_TRUE(text.has_value()) << prep::to_string(text.error());
    const prep::Mesh& m = text->meshes[0];
    EXPECT_EQ(m.positions[1].y, 1e-42f);
    EXPECT_EQ(m.positions[0].z, -1.0f);
    EXPECT_TRUE(std::signbit(m.positions[2].x));
    EXPECT_EQ(m.colors[0].values[0], glm::vec4(1.0f));
    for (const bool big : {false, true}) {
        std::string raw = ply_header(big ? "binary_big_endian" : "binary_little_endian", lines);
        for (int v = 0; v < 3; ++v) {
            put(raw, x[v], big);
            put(raw, y[v], big);
            put(raw, std::int16_t(v - 1), big);
            put(raw, std::int8_t(-5), big);
            put(raw, std::uint8_t(255), big);
            put(raw, std::uint16_t(65535), big);
            put(raw, std::uint32_t(4294967295u), big);
            put(raw, std::int8_t(7), big);
        }
        put(raw, std::uint16_t(3), big);
        for (std::uint32_t k = 0; k < 3; ++k) put(raw, k, big);
        put(raw, std::int32_t(2), big);
        put(raw, 1.5, big);
        put(raw, 2.5, big);
        put(raw, std::int32_t(9), big);
        put(raw, std::int32_t(0), big);
        put(raw, std::int32_t(8), big);
        const auto scene = parse_ply(raw);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        EXPECT_EQ(test::exact_difference(m, scene->meshes[0]), "") << (big ? "big" : "little");
    }
}

TEST(Ply, NormalsUvsAndColoursFollowTheCorners) {
    const auto scene =
        parse_ply(ply_header("ascii", "element vertex 3\n" + xyz +
                                          "property float nx\nproperty float ny\nproperty "
                                          "float nz\nproperty float s\nproperty float t\n"
                                          "property float red\nproperty float green\n"
                                          "property float blue\nproperty uchar alpha\n"
                                          "element face 1\n" +
                                          face_indices) +
                  "0 0 0 0 0 1 0.25 0.25 2 0 0 51\n1 0 0 0 0 1 1 0 0 1 0 255\n"
                  "0 1 0 0 1 0 0 1 0 0 1 0\n3 2 1 0\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const prep::Mesh& m = scene->meshes[0];
    EXPECT_EQ(m.normals.indices, (std::vector<std::uint32_t>{2, 1, 0}));
    EXPECT_EQ(m.normals.values[2], glm::vec3(0, 1, 0));
    EXPECT_EQ(m.uvs[0].values[0], glm::vec2(0.25f, 0.75f));      // the origin moves to the top
    EXPECT_EQ(m.colors[0].values[0], glm::vec4(2, 0, 0, 0.2f));  // floats are linear as they are
}

TEST(Ply, TangentsAreReadAsTheyAreWrittenButOnlyWithNormals) {
    const std::string tangents =
        "property float tx\nproperty float ty\nproperty float tz\nproperty float tw\n";
    const std::string normals = "property float nx\nproperty float ny\nproperty float nz\n";
    const std::string face = "element face 1\n" + face_indices;
    const std::string text =
        ply_header("ascii", "element vertex 3\n" + xyz + normals + tangents + face) +
        "0 0 0 0 0 1 1 0 0 -1\n1 0 0 0 0 1 0.6 0.8 0 1\n"
        "0 1 0 0 0 1 0 1 0 1\n3 2 1 0\n";
    const auto scene = parse_ply(text);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
    const prep::Mesh& m = scene->meshes[0];
    EXPECT_EQ(m.tangents.indices, (std::vector<std::uint32_t>{2, 1, 0}));
    ASSERT_EQ(m.tangents.values.size(), 3u);
    EXPECT_EQ(m.tangents.values[0], glm::vec4(1, 0, 0, -1));
    EXPECT_EQ(m.tangents.values[1], glm::vec4(0.6f, 0.8f, 0, 1));

    const test::TempDir dir;
    const auto saved = prep::save_scene(test::untouched(*scene), dir / "a.ply");
    ASSERT_TRUE(saved.has_value()) << prep::to_string(saved.error());
    const auto again = prep::load_scene(dir / "a.ply");
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    const prep::Mesh& back = again->meshes[0];
    ASSERT_EQ(back.tangents.indices.size(), 3u);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(back.tangents.values[back.tangents.indices[c]],
                  m.tangents.values[m.tangents.indices[c]]);

    const auto alone = parse_ply(ply_header("ascii", "element vertex 3\n" + xyz + tangents + face) +
                                 "0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n0 1 0 1 0 0 1\n3 0 1 2\n");
    ASSERT_TRUE(alone.has_value()) << prep::to_string(alone.error());
    EXPECT_TRUE(alone->meshes[0].tangents.empty());
    EXPECT_EQ(alone->warnings,
              std::vector<std::string>{"test.ply: properties that were not taken: vertex tx, "
                                       "vertex ty, vertex tz, vertex tw"});
}

TEST(Ply, ByteColoursAreSrgb) {
    const auto scene =
        parse_ply(ply_header("ascii", "element vertex 1\n" + xyz +
                                          "property uchar red\nproperty uchar green\n"
                                          "property uchar blue\n") +
                  "0 0 0 188 0 255\n");
    ASSERT_TRUE(scene.has_value());
    // 188/255 is a half to within the step of a byte (IEC 61966-2-1).
    EXPECT_NEAR(scene->meshes[0].vertex_colors[0].r, 0.5, 0.004);
    EXPECT_EQ(scene->meshes[0].vertex_colors[0].b, 1.0f);
    EXPECT_EQ(scene->meshes[0].points, (std::vector<std::uint32_t>{0}));
}

// Values that the other sign of their type would change; the quick way to them is text's.
TEST(Ply, IntegersAreOfTheirSignAndWidth) {
    for (const bool big : {false, true}) {
        std::string text =
            ply_header(big ? "binary_big_endian" : "binary_little_endian",
                       "element vertex 1\nproperty int8 x\nproperty uint8 y\nproperty int16 z\n"
                       "property uint16 nx\nproperty int32 ny\nproperty uint32 nz\n"
                       "element face 1\n" +
                           face_indices);
        put(text, std::int8_t(-100), big);
        put(text, std::uint8_t(200), big);
        put(text, std::int16_t(-30000), big);
        put(text, std::uint16_t(60000), big);
        put(text, std::int32_t(-(1 << 30)), big);
        put(text, std::uint32_t(3u << 30), big);
        put(text, std::uint8_t(3), big);
        for (int k = 0; k < 3; ++k) put(text, std::int32_t(0), big);
        const auto scene = parse_ply(text);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        EXPECT_EQ(scene->meshes[0].positions[0], glm::vec3(-100, 200, -30000));
        EXPECT_EQ(scene->meshes[0].normals.values[0],
                  glm::vec3(60000, -1073741824.0f, 3221225472.0f));
    }
}

TEST(Ply, PropertiesAreKnownByAllTheirNames) {
    const auto scene =
        parse_ply(ply_header("ascii", "element vertex 1\n" + xyz +
                                          "property float texture_u\nproperty float "
                                          "texture_v\nproperty float diffuse_red\n"
                                          "property float diffuse_green\nproperty float "
                                          "diffuse_blue\nelement face 1\n" +
                                          face_indices) +
                  "1 2 3 0.25 0.125 0.5 0.75 1\n3 0 0 0\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->meshes[0].uvs.size(), 1u);
    EXPECT_EQ(scene->meshes[0].uvs[0].values[0], glm::vec2(0.25f, 0.875f));
    ASSERT_EQ(scene->meshes[0].colors.size(), 1u);
    EXPECT_EQ(scene->meshes[0].colors[0].values[0], glm::vec4(0.5f, 0.75f, 1, 1));
    EXPECT_TRUE(scene->warnings.empty());
}

TEST(Ply, TexcoordListsAreUvsPerCorner) {
    const auto scene =
        parse_ply(ply_header("ascii", "element vertex 3\n" + xyz + "element face 3\n" +
                                          face_indices + "property list uchar float texcoord\n") +
                  "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n3 0 1 2 0\n3 2 1 0 6 0 0 1 0 0 1\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const auto& uv = scene->meshes[0].uvs[0];
    const auto none = prep::no_index;
    EXPECT_EQ(uv.indices, (std::vector<std::uint32_t>{0, 1, 2, none, none, none, 3, 4, 5}));
    EXPECT_EQ(uv.values[2], glm::vec2(0, 0));
}

TEST(Ply, TristripsTurnEveryOtherTriangle) {
    const auto scene =
        parse_ply(ply_header("ascii", "element vertex 5\n" + xyz +
                                          "element tristrips 1\nproperty list int int "
                                          "vertex_indices\n") +
                  "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n9 0 1 2 3 -1 2 3 4 -1\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].corner_vertices,
              (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3, 2, 3, 4}));
}

TEST(Ply, EdgesAndShortFaces) {
    const auto scene = parse_ply(
        ply_header("ascii", "element vertex 3\n" + xyz + "element face 2\n" + face_indices +
                                "element edge 1\nproperty int vertex1\nproperty "
                                "int vertex2\n") +
        "0 0 0\n1 0 0\n0 1 0\n2 0 1\n3 0 1 2\n1 2\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].line_vertices, (std::vector<std::uint32_t>{1, 2}));
    EXPECT_EQ(scene->meshes[0].face_count(), 1u);
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_EQ(scene->warnings[0], "test.ply: 1 faces with fewer than three corners were dropped");
}

TEST(Ply, LinesBesideFacesKeepTheColoursOfTheirVertices) {
    const auto scene = parse_ply(
        ply_header("ascii", "element vertex 5\n" + xyz +
                                "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                                "element face 1\n" +
                                face_indices +
                                "element edge 1\nproperty int vertex1\nproperty int vertex2\n") +
        "0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 0\n5 0 0 0 255 0\n6 0 0 0 255 0\n"
        "3 0 1 2\n3 4\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->meshes[0].vertex_colors.size(), 5u);
    const test::TempDir dir;
    for (const char* name : {"a.ply", "a.obj", "a.off"}) {
        const auto saved = prep::save_scene(test::untouched(*scene), dir / name);
        ASSERT_TRUE(saved) << prep::to_string(saved.error());
        const auto again = prep::load_scene(dir / name);
        ASSERT_TRUE(again) << prep::to_string(again.error());
        const prep::Mesh& mesh = again->meshes[0];
        ASSERT_EQ(mesh.line_vertices.size(), 2u) << name;
        for (const std::uint32_t v : mesh.line_vertices) {
            ASSERT_LT(v, mesh.vertex_colors.size()) << name;
            EXPECT_EQ(mesh.vertex_colors[v], glm::vec4(0, 1, 0, 1)) << name;
        }
        for (const glm::vec4& c : mesh.colors[0].values)
            EXPECT_TRUE(c == glm::vec4(0, 1, 0, 1) || c == glm::vec4(1, 0, 0, 1)) << name;
    }
}

TEST(Ply, OfManyThatAreNotTakenTheNumberIsTold) {
    std::string head =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\n";
    std::string row = "0 0 0", names;
    for (int i = 0; i < 15; ++i) {
        head += "property float q" + std::to_string(i) + "\n";
        row += " 1";
        if (i < 12) names += (i > 0 ? ", vertex q" : "vertex q") + std::to_string(i);
    }
    const auto scene = parse_ply(head + "end_header\n" + row + "\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->warnings,
              std::vector<std::string>{"test.ply: properties that were not taken: " + names +
                                       " and 3 more"});
}

TEST(Ply, WhatIsNotTakenIsNamedOnce) {
    const auto faces = parse_ply(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty float quality\nproperty float nx\nelement face 2\n"
        "property list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
        "element camera 1\nproperty float view\nend_header\n0 0 0 1 0\n1 0 0 1 0\n0 1 0 1 0\n"
        "3 0 1 2 255 0\n3 0 2 1 255 0\n5\n");
    ASSERT_TRUE(faces.has_value()) << prep::to_string(faces.error());
    EXPECT_EQ(faces->warnings,
              std::vector<std::string>{"test.ply: properties that were not taken: vertex quality, "
                                       "vertex nx, face red, face green, camera view"});
    const auto cloud = parse_ply(
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
        "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n"
        "0 0 0 1 0 0\n1 0 0 0 1 0\n");
    ASSERT_TRUE(cloud.has_value());
    EXPECT_EQ(cloud->warnings,
              std::vector<std::string>{
                  "test.ply: normals of points were not taken: only faces have them here"});
}

TEST(Ply, OfPropertiesThatMeanTheSameTheFirstCounts) {
    const auto twice = parse_ply(ply_header("ascii",
                                            "element vertex 1\nproperty float x\nproperty float y\n"
                                            "property float z\nproperty float x\n") +
                                 "1 2 3 4\n");
    ASSERT_TRUE(twice.has_value()) << prep::to_string(twice.error());
    EXPECT_EQ(twice->meshes[0].positions[0], glm::vec3(1, 2, 3));
    EXPECT_EQ(twice->warnings,
              std::vector<std::string>{"test.ply: properties that were not taken: vertex x"});
    // Faces that have corners twice may be either.
    EXPECT_NE(
        ply_error(ply_header("ascii", "element vertex 3\n" + xyz + "element face 1\n" +
                                          face_indices + "property list uchar int vertex_index\n") +
                  "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 3 0 2 1\n")
            .find("two lists of corners"),
        std::string::npos);
}

TEST(Ply, MayBeginWithAByteOrderMark) {
    for (const char* format : {"ascii", "binary_little_endian"}) {
        std::string text = "\xef\xbb\xbf" + ply_header(format, "element vertex 1\n" + xyz);
        if (format[0] == 'a')
            text += "1 2 3\n";
        else
            for (const float v : {1.0f, 2.0f, 3.0f}) put(text, v, false);
        const auto scene = parse_ply(text);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        EXPECT_EQ(scene->meshes[0].positions[0], glm::vec3(1, 2, 3));
    }
}

TEST(Ply, NanAndInfinityAreKept) {
    const auto scene =
        parse_ply(ply_header("ascii", "element vertex 1\n" + xyz) + "nan inf -inf\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_TRUE(std::isnan(scene->meshes[0].positions[0].x));
    EXPECT_EQ(scene->meshes[0].positions[0].z, -std::numeric_limits<float>::infinity());
}

TEST(Ply, HeaderErrorsNameTheLine) {
    EXPECT_EQ(ply_error("plx\n"), "test.ply:1: expected \"ply\": not a PLY file in 'plx'");
    EXPECT_EQ(ply_error("ply\nformat text 1.0\n"),
              "test.ply:2: unknown format in 'format text 1.0'");
    EXPECT_EQ(ply_error("ply\nend_header\n"),
              "test.ply:2: the header names no format in 'end_header'");
    EXPECT_EQ(ply_error("ply\nproperty float x\n"),
              "test.ply:2: a property before any element in 'property float x'");
    EXPECT_EQ(ply_error("ply\nelement vertex -1\n"),
              "test.ply:2: expected a number of elements in 'element vertex -1'");
    EXPECT_EQ(ply_error("ply\nelement vertex many\n"),
              "test.ply:2: expected a number of elements in 'element vertex many'");
    EXPECT_EQ(ply_error("ply\nelement v 1\nproperty quad x\n"),
              "test.ply:3: unknown property type in 'property quad x'");
    EXPECT_EQ(ply_error("ply\nelement v 1\nproperty list float int x\n"),
              "test.ply:3: expected an integer type for the list's length in 'property list float "
              "int x'");
    EXPECT_EQ(ply_error("ply\nwhat is this\n"),
              "test.ply:2: unknown header line in 'what is this'");
    EXPECT_EQ(ply_error("ply\nformat ascii 1.0\n"),
              "test.ply:2: the header has no end_header: not a PLY file or cut short");
    EXPECT_EQ(ply_error(""),
              "test.ply:0: the header has no end_header: not a PLY file or cut short");
}

TEST(Ply, TextErrorsNameTheLine) {
    const std::string mesh =
        ply_header("ascii", "element vertex 3\n" + xyz + "element face 1\n" + face_indices);
    // The header takes nine lines.
    EXPECT_EQ(ply_error(mesh + "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n"),
              "test.ply:11: the file ends or is malformed in vertex 1 of 3");
    EXPECT_EQ(ply_error(mesh + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"),
              "test.ply:13: vertex index 7 is out of range: the file has 3");
    EXPECT_EQ(ply_error(mesh + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"),
              "test.ply:13: a vertex index that is none");
    EXPECT_EQ(ply_error(mesh + "0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n"),
              "test.ply:13: a vertex index that is none");
    EXPECT_EQ(ply_error(mesh + "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n"),
              "test.ply:13: the file ends or is malformed in face 0 of 1");
    EXPECT_EQ(ply_error(mesh + "0 0 0\n1 0 0\n0 1 0\n200 0 1 2\n"),
              "test.ply:13: the file ends or is malformed in face 0 of 1");
}

TEST(Ply, ElementErrorsSayWhatIsMissing) {
    EXPECT_EQ(ply_error(ply_header("ascii", "element vertex 1\nproperty float x\n") + "0\n"),
              "test.ply:6: vertices without x, y and z");
    EXPECT_EQ(ply_error(ply_header("ascii", "element vertex 1\n" + xyz +
                                                "element face 1\nproperty "
                                                "int q\n") +
                        "0 0 0\n1\n"),
              "test.ply:11: faces without a list of vertex_indices");
    EXPECT_EQ(ply_error(ply_header("ascii", "element vertex 1\n" + xyz +
                                                "element edge 1\nproperty "
                                                "int vertex1\n") +
                        "0 0 0\n1\n"),
              "test.ply:11: an edge without two vertex indices");
    EXPECT_EQ(
        ply_error(ply_header("ascii", "element vertex 1\n" + xyz + "element vertex 1\n" + xyz) +
                  "0 0 0\n0 0 0\n"),
        "test.ply:12: a second element \"vertex\"");
}

TEST(Ply, CountsThatTheFileHasNoRoomForAreRefusedAtOnce) {
    const std::string vertex = "element vertex 4000000000\n" + xyz;
    EXPECT_EQ(ply_error(ply_header("binary_little_endian", vertex) + "12345678"),
              "test.ply, byte 124: the header announces 4000000000 of vertex, but there is room "
              "for 0");
    EXPECT_EQ(ply_error(ply_header("ascii", vertex) + "0 0 0\n"),
              "test.ply:8: the header announces 4000000000 of vertex, but there is room for 1");
    // Elements without properties take no bytes; their number alone must not keep us busy.
    for (const char* name : {"face", "tristrips", "other", "edge", "vertex"})
        EXPECT_NE(
            ply_error(ply_header("ascii", "element " + std::string(name) + " 18446744073709551\n")),
            "no error")
            << name;
    EXPECT_EQ(ply_error(ply_header("ascii",
                                   "element vertex 0\n" + xyz + "element tristrips 4294967294\n")),
              "no error");
    // A list's length alone.
    std::string list = ply_header("binary_little_endian",
                                  "element face 1\nproperty list uint uint vertex_indices\n");
    put(list, std::uint32_t(0xfffffff0), false);
    EXPECT_NE(ply_error(list).find("the file ends or is malformed in face 0 of 1"),
              std::string::npos);
}

TEST(Ply, EveryTruncationIsAnErrorOrSmaller) {
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        std::string whole =
            ply_header(format, "element vertex 3\n" + xyz + "element face 1\n" + face_indices);
        if (std::string(format) == "ascii") {
            whole += "0 0 0\n10 0 0\n0 10 0\n3 0 1 2\n";
        } else {
            const bool big = std::string(format) == "binary_big_endian";
            for (int v = 0; v < 9; ++v) put(whole, float(v), big);
            put(whole, std::uint8_t(3), big);
            for (int v = 0; v < 3; ++v) put(whole, v, big);
        }
        ASSERT_TRUE(parse_ply(whole).has_value());
        // Text may lose its last line end.
        const std::size_t last = std::string(format) == "ascii" ? whole.size() - 1 : whole.size();
        for (std::size_t n = 0; n < last; ++n)
            EXPECT_FALSE(parse_ply(whole.substr(0, n)).has_value()) << format << " cut to " << n;
    }
}

prep::Scene awkward_scene() {
    prep::Scene scene;
    prep::Mesh mesh = shapes::mesh_of(
        {{0.1f, -0.0f, 1e-42f}, {3.4e38f, 0, 1}, {1, 1, 1}, {0, 1, -7.25f}, {5, 5, 5}},
        {{0, 1, 2, 3}, {4, 2, 1}, {0, 1, 2, 3, 4}, {1, 1, 2}});
    mesh.name = "awkward";
    for (int v = 0; v < 5; ++v) {
        mesh.normals.values.push_back({float(v) / 3, 1, 0});
    }
    mesh.normals.indices = mesh.corner_vertices;
    mesh.uvs.emplace_back();
    for (int v = 0; v < 5; ++v) mesh.uvs[0].values.push_back({float(v) / 7, float(v) / 11});
    mesh.uvs[0].indices = mesh.corner_vertices;
    scene.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(scene);
    return scene;
}

// A line is an element: what it holds beyond the header's properties is nobody's.
TEST(Ply, LinesMayHoldMoreThanTheHeaderNames) {
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
    const auto scene = test::parsed(
        prep::parse_ply, header + "0 0 0 7 8\n1 0 0\n\n0 1 0\n3 0 1 2 9 1 1 1\n3 2 1 0\n", "t.ply");
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(scene->meshes[0].corner_vertices, (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 0}));
    EXPECT_EQ(scene->warnings, std::vector<std::string>{
                                   "t.ply: 2 lines have more values than the header names: what "
                                   "is beyond was left out"});
    // So it is where lines follow the last element, and where one goes on in the next line.
    const auto longer =
        test::parsed(prep::parse_ply,
                     header + "0 0 0 7\n1 0 0 7\n0 1 0 7\n3 0 1 2 7\n3 2 1 0 7\nend 4\n", "t.ply");
    ASSERT_TRUE(longer) << test::error_of(longer);
    EXPECT_EQ(longer->meshes[0].corner_vertices, scene->meshes[0].corner_vertices);
    EXPECT_EQ(longer->meshes[0].positions[2], glm::vec3(0, 1, 0));
    const std::vector<std::string> told{
        "t.ply: 5 lines have more values than the header names: what is beyond was left out",
        "t.ply: 5 bytes after the last element were left out"};
    EXPECT_EQ(longer->warnings, told);
    const auto spread = test::parsed(prep::parse_ply,
                                     header + "0 0 0\n1 0 0\n0 1 0\n3\n0 1 2\n3\n2 1 0\n", "t.ply");
    ASSERT_TRUE(spread) << test::error_of(spread);
    EXPECT_EQ(spread->meshes[0].corner_vertices, scene->meshes[0].corner_vertices);
    // Also where lines of several elements and elements of several lines are as many as elements.
    for (const char* text : {"0 0 0 1 0 0\n0 1 0\n3\n0 1 2\n3\n2 1 0\n",
                             "0\n0\n0\n1\n0\n0\n0\n1\n0\n3 0 1 2 3 2 1 0\n"}) {
        const auto mixed = test::parsed(prep::parse_ply, header + text, "t.ply");
        ASSERT_TRUE(mixed) << test::error_of(mixed);
        EXPECT_EQ(mixed->meshes[0].positions, scene->meshes[0].positions);
        EXPECT_EQ(mixed->meshes[0].corner_vertices, scene->meshes[0].corner_vertices);
        EXPECT_TRUE(mixed->warnings.empty());
    }
    // With fewer lines than elements the values alone count.
    const auto dense =
        test::parsed(prep::parse_ply, header + "0 0 0 1 0 0 0 1 0\n3 0 1 2 3 2 1 0\n", "t.ply");
    ASSERT_TRUE(dense) << test::error_of(dense);
    EXPECT_EQ(dense->meshes[0].corner_vertices, scene->meshes[0].corner_vertices);
    EXPECT_TRUE(dense->warnings.empty());
}

TEST(Ply, RoundTripKeepsEveryBitInTextAndBytes) {
    const test::TempDir dir;
    prep::Scene original = awkward_scene();
    for (const bool ascii : {false, true}) {
        prep::SaveOptions options;
        options.ascii = ascii;
        const auto first = dir / "first.ply", second = dir / "second.ply";
        const auto saved = prep::save_scene(test::untouched(original), first, options);
        ASSERT_TRUE(saved.has_value()) << prep::to_string(saved.error());
        const auto once = prep::load_scene(first);
        ASSERT_TRUE(once.has_value()) << prep::to_string(once.error());
        EXPECT_EQ(test::corner_difference(original.meshes[0], once->meshes[0]), "");
        ASSERT_TRUE(prep::save_scene(test::untouched(*once), second, options).has_value());
        EXPECT_EQ(test::file_text(first), test::file_text(second));
    }
}

TEST(Ply, RoundTripKeepsEveryByteOfColour) {
    std::string text =
        ply_header("ascii", "element vertex 768\n" + xyz +
                                "property uchar red\nproperty uchar green\nproperty "
                                "uchar blue\nproperty uchar alpha\nelement face 256\n" +
                                face_indices);
    for (int v = 0; v < 768; ++v) {
        const std::string c = std::to_string(v / 3), d = std::to_string(255 - v / 3);
        text += std::to_string(v) + " 0 0 " + c + " " + d + " 7 " + c + "\n";
    }
    for (int f = 0; f < 768; f += 3)
        text += "3 " + std::to_string(f) + " " + std::to_string(f + 1) + " " +
                std::to_string(f + 2) + "\n";
    const auto scene = parse_ply(text);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const test::TempDir dir;
    const auto path = dir / "colours.ply";
    ASSERT_TRUE(prep::save_scene(test::untouched(*scene), path).has_value());
    const auto again = prep::load_scene(path);
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    EXPECT_EQ(test::exact_difference(scene->meshes[0], again->meshes[0]), "");
}

TEST(Ply, RoundTripFarFromTheOriginKeepsEveryBit) {
    std::string text = ply_header("ascii",
                                  "element vertex 4\nproperty double x\nproperty double y\n"
                                  "property double z\nelement face 2\n" +
                                      face_indices);
    text +=
        "5000000.1 -3000000.7 10.3\n5000001.1 -3000000.7 10.3\n5000001.1 -3000001.9 10.3\n"
        "5000000.123456789 -3000001.7 11.3\n3 0 1 2\n3 0 2 3\n";
    const auto scene = parse_ply(text);
    ASSERT_TRUE(scene.has_value());
    EXPECT_NE(scene->meshes[0].origin, glm::dvec3(0.0));
    const test::TempDir dir;
    const auto path = dir / "far.ply";
    ASSERT_TRUE(prep::save_scene(test::untouched(*scene), path).has_value());
    const auto again = prep::load_scene(path);
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    EXPECT_EQ(test::exact_difference(scene->meshes[0], again->meshes[0]), "");
}

}  // namespace
