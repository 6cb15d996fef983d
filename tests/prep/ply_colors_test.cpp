// Colours of faces in PLY files, and what the reader leaves out.
#include <gtest/gtest.h>

#include "formats/ply/ply.h"
#include "mesh_files.h"

namespace {

prep::Result<prep::Scene> parse_colors(const std::string& text) {
    return test::parsed(prep::parse_ply, text, "test.ply");
}

std::string color_header(const std::string& format, const std::string& lines) {
    return "ply\nformat " + format + " 1.0\n" + lines + "end_header\n";
}

const std::string points = "property float x\nproperty float y\nproperty float z\n";
const std::string indices = "property list uchar int vertex_indices\n";
const std::string color_bytes = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

// As MeshLab and CloudCompare write them: flat faces, not one blended colour a vertex.
TEST(PlyColors, FacesKeepTheirColoursAtAllTheirCorners) {
    const auto scene = parse_colors(
        color_header("ascii", "element vertex 4\n" + points + "element tristrips 1\n" +
                                  "property list int int vertex_indices\nelement face 4\n" +
                                  indices + color_bytes) +
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 3\n"
        "3 0 1 2 255 0 0\n2 0 1 9 9 9\n4 0 1 2 3 0 0 255\n3 0 2 3 255 0 0\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const prep::Mesh& mesh = scene->meshes[0];
    ASSERT_EQ(mesh.face_count(), 4u);  // a line is no face
    ASSERT_EQ(mesh.colors.size(), 1u);
    const glm::vec4 expected[] = {{1, 1, 1, 1}, {1, 0, 0, 1}, {0, 0, 1, 1}, {1, 0, 0, 1}};
    for (std::size_t f = 0; f < 4; ++f)
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            EXPECT_EQ(mesh.colors[0].values[mesh.colors[0].indices[c]], expected[f]) << f;
    EXPECT_EQ(scene->warnings, std::vector<std::string>{
                                   "test.ply: 1 faces with fewer than three corners were dropped"});
}

TEST(PlyColors, ColoursOfVerticesGoBeforeThoseOfFaces) {
    const auto scene =
        parse_colors(color_header("ascii", "element face 1\n" + indices + color_bytes +
                                               "element vertex 3\n" + points + color_bytes) +
                     "3 0 1 2 255 0 0\n0 0 0 0 255 0\n1 0 0 0 255 0\n1 1 0 0 255 0\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->meshes[0].colors.size(), 1u);
    EXPECT_EQ(scene->meshes[0].colors[0].values, std::vector<glm::vec4>(3, glm::vec4(0, 1, 0, 1)));
    EXPECT_EQ(scene->warnings,
              std::vector<std::string>{"test.ply: properties that were not taken: face red, face "
                                       "green, face blue"});
}

TEST(PlyColors, WhatIsNotTakenIsTold) {
    const std::string vertices = "element vertex 3\n" + points;
    const std::string points = "0 0 0\n1 0 0\n1 1 0\n";
    const auto warnings = [&](const std::string& lines, const std::string& rest) {
        const auto scene = parse_colors(color_header("ascii", vertices + lines) + points + rest);
        EXPECT_TRUE(scene) << prep::to_string(scene.error());
        return scene->warnings;
    };
    EXPECT_EQ(warnings("element edge 1\nproperty int vertex1\nproperty int vertex2\n" + color_bytes,
                       "0 1 255 0 0\n"),
              std::vector<std::string>{"test.ply: properties that were not taken: edge red, edge "
                                       "green, edge blue"});
    EXPECT_EQ(
        warnings("element face 1\n" + indices + "property list uchar float texcoord\n",
                 "3 0 1 2 4 0 0 1 0\n"),
        std::vector<std::string>{"test.ply: 1 face has a texcoord list of another length than "
                                 "two a corner: left out"});
    EXPECT_EQ(warnings("element face 1\n" + indices, "3 0 1 2\n\n"), std::vector<std::string>{});
    EXPECT_EQ(warnings("element face 1\n" + indices, "3 0 1 2\n3 0 1 2\n"),
              std::vector<std::string>{"test.ply: 7 bytes after the last element were left out"});
}

TEST(PlyColors, PartOfAColourIsNone) {
    const auto scene =
        parse_colors(color_header("ascii", "element vertex 3\n" + points + "element face 1\n" +
                                               indices + "property uchar red\n") +
                     "0 0 0\n1 0 0\n1 1 0\n3 0 1 2 255\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_TRUE(scene->meshes[0].colors.empty());
    EXPECT_EQ(scene->warnings,
              std::vector<std::string>{"test.ply: properties that were not taken: face red"});
}

TEST(PlyColors, PropertiesOfStripsAreTold) {
    const auto scene = parse_colors(
        color_header("ascii", "element vertex 3\n" + points + "element tristrips 1\n" +
                                  "property list int int vertex_indices\n" + color_bytes) +
        "0 0 0\n1 0 0\n1 1 0\n3 0 1 2 255 0 0\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->warnings,
              std::vector<std::string>{"test.ply: properties that were not taken: tristrips red, "
                                       "tristrips green, tristrips blue"});
}

TEST(PlyColors, CornersWithoutUvsHaveThoseOfTheirVertices) {
    const auto scene = parse_colors(
        color_header("ascii", "element vertex 3\n" + points +
                                  "property float s\nproperty float t\nelement face 2\n" + indices +
                                  "property list uchar float texcoord\n") +
        "0 0 0 0.25 0.25\n1 0 0 0.5 0.5\n1 1 0 0.75 0.75\n"
        "3 0 1 2 6 0 0 1 0 1 1\n3 2 1 0 0\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const prep::Mesh& mesh = scene->meshes[0];
    ASSERT_EQ(mesh.uvs.size(), 1u);
    const glm::vec2 expected[] = {{0, 1},         {1, 1},       {1, 0},
                                  {0.75f, 0.25f}, {0.5f, 0.5f}, {0.25f, 0.75f}};
    for (std::size_t c = 0; c < 6; ++c)
        EXPECT_EQ(mesh.uvs[0].values[mesh.uvs[0].indices[c]], expected[c]) << c;
    EXPECT_EQ(scene->warnings,
              std::vector<std::string>{
                  "test.ply: UVs of vertices were taken where faces have none alone"});
    const auto both = parse_colors(
        color_header("ascii", "element vertex 3\n" + points +
                                  "property float s\nproperty float t\nelement face 1\n" + indices +
                                  "property list uchar float texcoord\n") +
        "0 0 0 0.25 0.25\n1 0 0 0.5 0.5\n1 1 0 0.75 0.75\n3 0 1 2 6 0 0 1 0 1 1\n");
    ASSERT_TRUE(both.has_value()) << prep::to_string(both.error());
    EXPECT_EQ(both->meshes[0].uvs[0].values.size(), 3u);
    EXPECT_EQ(both->warnings, std::vector<std::string>{});
    EXPECT_EQ(both->remarks, std::vector<std::string>{
                                 "test.ply: UVs of vertices were left out: faces have theirs"});
}

}  // namespace
