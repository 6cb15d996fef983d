#include "formats/off/off.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mesh_files.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shapes.h"

namespace {

prep::Result<prep::Scene> parse_off(const std::string& text) {
    return test::parsed(prep::parse_off, text, "test.off");
}

std::string off_error(const std::string& text) {
    return test::error_of(parse_off(text));
}

TEST(Off, ReadsPolygonsCommentsAndCarriageReturns) {
    const auto scene = parse_off(
        "OFF # a comment\r\n\r\n# another\r\n5 2 0\r\n0 0 0\r\n1 0 0\r\n1 1 0\r\n0 1 0\r\n9 9 9\r\n"
        "4 0 1 2 3\r\n3 0 1 4 # last\r\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const prep::Mesh& m = scene->meshes[0];
    EXPECT_EQ(m.face_offsets, (std::vector<std::uint32_t>{0, 4, 7}));
    EXPECT_EQ(m.corner_vertices[6], 4u);
}

TEST(Off, CountsMayStandInTheFirstLineAndTheWordMayBeMissing) {
    for (const char* begin :
         {"OFF 3 1 0\n", "3 1 0\n", "3 1\n", "OFF\n3 1\n", "\xef\xbb\xbfOFF\n3 1 0\n",
          "\xef\xbb\xbf"
          "3 1 0\n"}) {
        const auto scene = parse_off(std::string(begin) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
        ASSERT_TRUE(scene.has_value()) << begin << prep::to_string(scene.error());
        EXPECT_EQ(scene->meshes[0].face_count(), 1u);
    }
}

TEST(Off, EveryPrefixTogether) {
    // Geomview's order: position, w, normal, colour, texture.
    const auto scene = parse_off(
        "STCN4OFF\n3 1 0\n2 4 6 2 0 0 1 0.5 0 0 1 0.25 0.25\n1 0 0 1 0 0 1 0 1 0 0.5 1 0\n"
        "0 1 0 1 0 0 1 0 0 1.0 0 1\n3 0 1 2\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const prep::Mesh& m = scene->meshes[0];
    EXPECT_EQ(m.positions[0], glm::vec3(1, 2, 3));
    EXPECT_EQ(m.normals.values[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(m.colors[0].values[0], glm::vec4(0.5f, 0, 0, 1));
    EXPECT_EQ(m.colors[0].values[1], glm::vec4(0, 1, 0, 0.5f));
    EXPECT_EQ(m.colors[0].values[2], glm::vec4(0, 0, 1, 1));  // three components
    EXPECT_EQ(m.uvs[0].values[0], glm::vec2(0.25f, 0.75f));
    EXPECT_EQ(m.uvs[0].values[2], glm::vec2(0, 0));
}

TEST(Off, IntegerColoursAreBytesEvenBesideFractionalUvs) {
    const auto scene = parse_off(
        "STCOFF\n3 1 0\n0 0 0 255 0 188 0.5 0.5\n1 0 0 0 255 0 255 0.5 0.5\n0 1 0 0 0 255 0.5 "
        "0.5\n3 0 1 2\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const auto& colors = scene->meshes[0].colors[0].values;
    EXPECT_EQ(colors[0].r, 1.0f);
    EXPECT_NEAR(colors[0].b, 0.5, 0.004);  // sRGB: 188/255 is a half to within a byte's step
    EXPECT_EQ(colors[1], glm::vec4(0, 1, 0, 1));
    EXPECT_EQ(scene->meshes[0].uvs[0].values[2], glm::vec2(0.5f));
}

TEST(Off, FacesKeepTheirColoursAtAllTheirCorners) {
    const auto scene = parse_off(
        "OFF\n4 5 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3 0 188 255 51\n2 0 1\n"
        "3 0 1 3 0.25 0.5 1.0 # three\n3 1 2 3 0.5 0.5 0.5 0.75\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->warnings, std::vector<std::string>{});
    const prep::Mesh& mesh = scene->meshes[0];
    ASSERT_EQ(mesh.face_count(), 4u);
    ASSERT_EQ(mesh.colors.size(), 1u);
    // 188 of 255 by IEC 61966-2-1; alpha is no light.
    const glm::vec4 expected[] = {
        {1, 1, 1, 1}, {0, 0.5028865f, 1, 0.2f}, {0.25f, 0.5f, 1, 1}, {0.5f, 0.5f, 0.5f, 0.75f}};
    for (std::size_t f = 0; f < 4; ++f)
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            for (int k = 0; k < 4; ++k)
                EXPECT_NEAR(mesh.colors[0].values[mesh.colors[0].indices[c]][k], expected[f][k],
                            1e-6)
                    << f;
}

TEST(Off, ColoursThatHaveNoPlaceAreTold) {
    const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
    const std::vector<std::string> told{
        "test.off: colours that are numbers of a list, or of lines, were skipped"};
    for (const char* face : {"3 0 1 2 7\n", "3 0 1 2 7 8\n", "2 0 1 255 0 0\n"}) {
        const auto scene = parse_off("OFF\n3 1 0\n" + points + face);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        EXPECT_EQ(scene->warnings, told) << face;
        EXPECT_TRUE(scene->meshes[0].colors.empty()) << face;
    }
    const auto both =
        parse_off("COFF\n3 1 0\n0 0 0 0 255 0\n1 0 0 0 255 0\n0 1 0 0 255 0\n3 0 1 2 255 0 0\n");
    ASSERT_TRUE(both.has_value()) << prep::to_string(both.error());
    EXPECT_EQ(both->meshes[0].colors[0].values, std::vector<glm::vec4>(3, glm::vec4(0, 1, 0, 1)));
    EXPECT_EQ(both->warnings,
              std::vector<std::string>{
                  "test.off: colours of faces were skipped: vertices have their own"});
}

TEST(Off, ValuesBehindThoseOfVerticesAreTold) {
    const auto scene =
        parse_off("OFF\n3 1 0\n0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 0\n3 0 1 2\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_NE(scene->warnings[0].find("colours are of COFF files"), std::string::npos);
}

TEST(Off, SegmentsAndPointClouds) {
    const auto scene = parse_off("OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n2 0 1\n1 2\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].line_vertices, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_EQ(
        scene->warnings,
        (std::vector<std::string>{"test.off: 1 faces with fewer than two corners were dropped"}));
    const auto cloud = parse_off("NOFF\n2 0 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n");
    ASSERT_TRUE(cloud.has_value());
    EXPECT_EQ(cloud->meshes[0].points, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_TRUE(cloud->meshes[0].normals.empty());
    EXPECT_EQ(cloud->warnings,
              std::vector<std::string>{
                  "test.off: normals of points were not taken: only faces have them here"});
    const auto nothing = parse_off("OFF\n0 0 0\n");
    ASSERT_TRUE(nothing.has_value());
    EXPECT_EQ(nothing->meshes[0].vertex_count(), 0u);
}

TEST(Off, PointsKeepTheirColours) {
    const auto scene = parse_off("COFF\n2 0 0\n0 0 0 1 0 0 1\n1 0 0 0.5 0.25 0 0.125\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].vertex_colors[1], glm::vec4(0.5f, 0.25f, 0, 0.125f));
    // What programs write of 1.0 and 0.0 is no byte beside fractions, nor where all are such.
    EXPECT_EQ(scene->meshes[0].vertex_colors[0], glm::vec4(1, 0, 0, 1));
    const auto ones = parse_off("COFF\n2 0 0\n0 0 0 0 1 0\n1 0 0 0 0 1 1\n");
    ASSERT_TRUE(ones.has_value()) << prep::to_string(ones.error());
    EXPECT_EQ(ones->meshes[0].vertex_colors[0], glm::vec4(0, 1, 0, 1));
    EXPECT_EQ(ones->meshes[0].vertex_colors[1], glm::vec4(0, 0, 1, 1));
    const auto fewer = parse_off("COFF\n2 0 0\n0 0 0 255\n1 0 0 0 255\n");
    ASSERT_TRUE(fewer.has_value()) << prep::to_string(fewer.error());
    EXPECT_EQ(fewer->meshes[0].vertex_colors[1], glm::vec4(0, 1, 1, 1));
    const auto bytes = parse_off("COFF\n2 0 0\n0 0 0 255 0 0\n1 0 0 0 188 0 51\n");
    ASSERT_TRUE(bytes.has_value()) << prep::to_string(bytes.error());
    ASSERT_EQ(bytes->meshes[0].vertex_colors.size(), 2u);
    EXPECT_EQ(bytes->meshes[0].vertex_colors[0], glm::vec4(1, 0, 0, 1));
    // 188 of 255 by IEC 61966-2-1; alpha is no light.
    EXPECT_NEAR(bytes->meshes[0].vertex_colors[1].g, 0.5028865, 1e-6);
    EXPECT_FLOAT_EQ(bytes->meshes[0].vertex_colors[1].a, 0.2f);
}

TEST(Off, ErrorsNameTheLine) {
    EXPECT_EQ(off_error(""), "test.off:0: the file is empty");
    EXPECT_EQ(off_error("OFF\n"), "test.off:1: the file ends after its first line");
    EXPECT_EQ(off_error("nOFF\n3\n"),
              "test.off:1: only the prefixes ST, C, N and 4 of OFF are supported in 'nOFF'");
    EXPECT_EQ(off_error("OFF BINARY\n"),
              "test.off:1: binary OFF is not supported: save it as text in 'OFF BINARY'");
    EXPECT_EQ(off_error("OFF\n3 x 0\n"),
              "test.off:2: expected OFF and the numbers of vertices, faces and edges in '3 x 0'");
    EXPECT_EQ(off_error("OFF\n-3 1 0\n"),
              "test.off:2: expected OFF and the numbers of vertices, faces and edges in '-3 1 0'");
    EXPECT_EQ(off_error("OFF\n2 0 0\n0 0 0\n0 0 0 0\n").substr(0, 8), "no error");
    EXPECT_EQ(off_error("OFF\n2 0 0\n0 0 0\n0 zero 0\n"),
              "test.off:4: expected coordinates in '0 zero 0'");
    EXPECT_EQ(off_error("OFF\n2 0 0\n0 0 0 0 0 0\n"),
              "test.off:3: the file ends after 1 of 2 vertices");
    const std::string mesh = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
    EXPECT_EQ(off_error(mesh), "test.off:5: the file ends after 0 of 1 faces");
    EXPECT_EQ(off_error(mesh + "3 0 1 3\n"),
              "test.off:6: vertex index 3 is out of range: the file has 3 in '3 0 1 3'");
    EXPECT_EQ(off_error(mesh + "3 0 1 -1\n"),
              "test.off:6: vertex index -1 is out of range: the file has 3 in '3 0 1 -1'");
    EXPECT_EQ(off_error(mesh + "3 0 1\n"), "test.off:6: expected 3 vertex indices in '3 0 1'");
    EXPECT_EQ(off_error(mesh + "-3 0 1 2\n"),
              "test.off:6: expected a number of corners in '-3 0 1 2'");
    EXPECT_EQ(off_error("STOFF\n1 0 0\n0 0 0 0.5\n"),
              "test.off:3: expected texture coordinates in '0 0 0 0.5'");
}

// Geomview's manual: numbers are separated by blanks or ends of lines alike.
TEST(Off, NumbersGoOnInTheNextLine) {
    const auto scene = parse_off(
        "NOFF 4\n2\n5\n0 0 0\n0 0 1\n1 0\n0 # here, too\n\n0 0 1\n1 1 0 0 0 1\n0\n1\n0\n0\n0\n1\n"
        "4\n0 1\n2 3 0.5 0.25 0.125\n3 0 1\n2\n");
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(scene->warnings,
              std::vector<std::string>{"test.off:19: read as the rest of the face before, and what "
                                       "is left of it as its colour"});
    const prep::Mesh& mesh = scene->meshes[0];
    EXPECT_EQ(mesh.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh.normals.values, std::vector<glm::vec3>(4, {0, 0, 1}));
    EXPECT_EQ(mesh.corner_vertices, (std::vector<std::uint32_t>{0, 1, 2, 3, 0, 1, 2}));
    EXPECT_EQ(mesh.face_offsets, (std::vector<std::uint32_t>{0, 4, 7}));
    ASSERT_EQ(mesh.colors.size(), 1u);
    EXPECT_EQ(mesh.colors[0].values[mesh.colors[0].indices[0]], glm::vec4(0.5f, 0.25f, 0.125f, 1));
    // Without the number of edges, the third line is a vertex.
    const auto no_edges = parse_off("OFF\n3\n1\n5 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    ASSERT_TRUE(no_edges) << test::error_of(no_edges);
    EXPECT_EQ(no_edges->meshes[0].positions[0].x, 5);
}

TEST(Off, AnElementThatIsTooShortTakesNothingOfTheNext) {
    EXPECT_EQ(off_error("OFF\n3 1 0\n0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
              "test.off:4: expected coordinates in '1 0 0'");
    EXPECT_EQ(off_error("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n2 0 1\n"),
              "test.off:7: the file ends after 1 of 2 faces; line 7 was read as the rest of the "
              "one before");
    // Also where a line more makes up for it.
    EXPECT_EQ(off_error("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2\n3 0 1 2\n4 0 1 2 3\n"),
              "test.off:9: the file goes on after its faces; line 8 was read as the rest of the "
              "one before in '4 0 1 2 3'");
    const std::string rest = "1 0 0 1 0 0\n0 1 0 1 0 0\n0 1 1 1 0 0\n3 0 1 2\n";
    EXPECT_EQ(off_error("COFF\n3 1 0\n0 0\n" + rest),
              "test.off:4: expected coordinates in '1 0 0 1 0 0'");
    EXPECT_EQ(off_error("COFF\n3 1 0\n0 0\n0 0 1\n" + rest),
              "test.off:4: expected coordinates in '0 0 1'");
    EXPECT_EQ(off_error("STOFF\n3 1 0\n0 0\n0 0 1 0.5 0.5\n" + rest).substr(0, 11), "test.off:4:");
}

TEST(Off, CountsThatTheFileHasNoRoomForAreRefusedAtOnce) {
    for (const char* counts : {"4000000000 0 0", "0 4000000000 0", "9223372036854775807 0 0"})
        EXPECT_NE(off_error("OFF\n" + std::string(counts) + "\n0 0 0\n")
                      .find("test.off:2: the header announces"),
                  std::string::npos)
            << counts;
    EXPECT_NE(off_error("OFF\n99999999999999999999 0 0\n").find("test.off:2: expected OFF"),
              std::string::npos);
    EXPECT_EQ(off_error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n9223372036854775807 0 1 2\n"),
              "test.off:6: expected 9223372036854775807 vertex indices in '9223372036854775807 0 1 "
              "2'");
}

TEST(Off, RoundTripKeepsEveryBit) {
    prep::Scene original;
    prep::Mesh mesh = shapes::mesh_of(
        {{0.1f, -0.0f, 1e-42f}, {3.4e38f, 0, 1}, {1, 1, 1}, {0, 1, -7.25f}, {5, 5, 5}},
        {{0, 1, 2, 3}, {4, 2, 1}, {0, 1, 2, 3, 4}, {1, 1, 2}});
    for (int v = 0; v < 5; ++v) mesh.normals.values.push_back({float(v) / 3, 1, 0});
    mesh.uvs.emplace_back();
    mesh.colors.emplace_back();
    for (int v = 0; v < 5; ++v) {
        mesh.uvs[0].values.push_back({float(v) / 7, float(v) / 11});
        mesh.colors[0].values.push_back({1, float(v) / 5, 0, v == 2 ? 1.0f : float(v) / 3});
    }
    mesh.normals.indices = mesh.uvs[0].indices = mesh.colors[0].indices = mesh.corner_vertices;
    original.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(original);
    const test::TempDir dir;
    const auto first = dir / "first.off", second = dir / "second.off";
    ASSERT_TRUE(prep::save_scene(test::untouched(original), first).has_value());
    const auto once = prep::load_scene(first);
    ASSERT_TRUE(once.has_value()) << prep::to_string(once.error());
    EXPECT_EQ(test::corner_difference(original.meshes[0], once->meshes[0]), "");
    ASSERT_TRUE(prep::save_scene(test::untouched(*once), second).has_value());
    EXPECT_EQ(test::file_text(first), test::file_text(second));
}

TEST(Off, RoundTripFarFromTheOriginKeepsEveryBit) {
    const auto scene = parse_off(
        "OFF\n4 1 0\n5000000.1 -3000000.7 10.3\n5000001.1 -3000000.7 10.3\n5000001.1 -3000001.9 "
        "10.3\n5000000.123456789 -3000001.7 11.3\n4 0 1 2 3\n");
    ASSERT_TRUE(scene.has_value());
    EXPECT_NE(scene->meshes[0].origin, glm::dvec3(0.0));
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(test::untouched(*scene), dir / "far.off").has_value());
    const auto again = prep::load_scene(dir / "far.off");
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    EXPECT_EQ(test::exact_difference(scene->meshes[0], again->meshes[0]), "");
}

}  // namespace
