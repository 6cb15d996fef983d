// OBJ and MTL, value by value: lines that the quick reader leaves to the thorough one, and files of
// several blocks (a block ends at the first line end behind a multiple of 1 MiB).
#include <gtest/gtest.h>

#include <string>

#include "formats/obj/obj.h"
#include "mesh_files.h"

namespace {

using Indices = std::vector<std::uint32_t>;

prep::Result<prep::Scene> parse(const std::string& text) {
    prep::ObjOptions options;
    options.name = "test.obj";
    return prep::parse_obj(std::as_bytes(std::span(text.data(), text.size())), options);
}

prep::Mesh mesh_of(const std::string& text) {
    auto scene = parse(text);
    EXPECT_TRUE(scene.has_value()) << test::error_of(scene);
    return scene ? scene->meshes[0] : prep::Mesh();
}

// 16,400 lines of 64 characters: more than a block.
constexpr std::size_t filler_lines = 16400;
std::string filler() {
    std::string text;
    const std::string line = "#" + std::string(62, '-') + "\n";
    for (std::size_t i = 0; i < filler_lines; ++i) text += line;
    return text;
}

TEST(ObjValues, WeightsDivideWithColoursAndWithout) {
    const prep::Mesh mesh =
        mesh_of("v 2 4 6 2\nv 2 4 6 2 0.25 0.5 0.75\nv 1 1 1 0.1 0.2 0.3\nf 1 2 3\n");
    EXPECT_EQ(mesh.positions, (std::vector<glm::vec3>{{1, 2, 3}, {1, 2, 3}, {1, 1, 1}}));
    ASSERT_EQ(mesh.colors.size(), 1u);
    EXPECT_EQ(mesh.colors[0].indices, (Indices{0, 1, 2}));
    // White where the file says none.
    EXPECT_EQ(
        mesh.colors[0].values,
        (std::vector<glm::vec4>{{1, 1, 1, 1}, {0.25f, 0.5f, 0.75f, 1}, {0.1f, 0.2f, 0.3f, 1}}));
}

TEST(ObjValues, UnusualNumbersAreTheSameNumbers) {
    const prep::Mesh plain = mesh_of(
        "v 1 2.5 -300\nv 0 0 0\nv 0 1 0\nvt 0.25 0.125\nvn 0 0.5 -1\nf 1/1/1 2/1/1 3/1/1\n");
    for (const char* first :
         {"v +1 +2.5 -3e2\nv 0 0 0\nv 0 1 0\nvt +0.25 125e-3\nvn 0 5e-1 -1\n",
          "v\t1\t2.5\t-300\nv 0 0 0\nv 0 1 0\nvt 0.25 0.125 0\nvn\t0 0.5 -1\n",
          "  v 1 2.5 -300 # far\n v 0 0 0\nv 0 1 0\n vt 0.25 .125\n vn 0 .5 -1.\n"}) {
        const prep::Mesh other = mesh_of(std::string(first) + "f 1/1/1 2/1/1 3/1/1\n");
        EXPECT_EQ(test::exact_difference(plain, other), "") << first;
    }
    EXPECT_EQ(plain.positions[0], glm::vec3(1, 2.5f, -300));
    EXPECT_EQ(plain.uvs[0].values[0], glm::vec2(0.25f, 0.875f));
    EXPECT_EQ(plain.normals.values[0], glm::vec3(0, 0.5f, -1));
    // A texture coordinate may be one number alone.
    EXPECT_EQ(mesh_of("v 0 0 0\nvt 0.5\nf 1/1 1/1 1/1\n").uvs[0].values[0], glm::vec2(0.5f, 1));
}

TEST(ObjValues, AByteOrderMarkIsNoPartOfTheFirstStatement) {
    const auto scene = parse("\xef\xbb\xbfv 1 2 3\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    ASSERT_TRUE(scene.has_value()) << test::error_of(scene);
    EXPECT_EQ(scene->meshes[0].positions[0], glm::vec3(1, 2, 3));
    EXPECT_EQ(scene->meshes[0].corner_vertices, (Indices{0, 1, 2}));
    EXPECT_TRUE(scene->warnings.empty());
}

TEST(ObjValues, FacesOfOldFilesAreFaces) {
    EXPECT_EQ(mesh_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nfo 3 1 2\n").corner_vertices, (Indices{2, 0, 1}));
}

TEST(ObjValues, ContinuedLinesCountEach) {
    EXPECT_EQ(test::error_of(parse("v 0 0 \\\n\\\n0\nv 1 0 0\nf 1 2 9\n")),
              "test.obj:5: vertex index 9 is out of range: the file has 2");
}

TEST(ObjValues, BothBoundaryRulesAreRead) {
    const auto tags = mesh_of(
                          "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nt interpolateboundary 1/0/0 2\n"
                          "t facevaryinginterpolateboundary 1/0/0 3\n")
                          .subdivision;
    EXPECT_EQ(tags.interpolate_boundary, 2);
    EXPECT_EQ(tags.face_varying_boundary, 3);
}

// "a#1" is not "a" with a comment: that takes a blank before the #.
TEST(ObjValues, NamesThatHoldAHashAreOthers) {
    const auto scene = parse(
        "v 0 0 0\nusemtl a\nf 1 1 1\nusemtl a#1\nf 1 1 1\nusemtl a #1\nf 1 1 1\nusemtl b #1\n"
        "f 1 1 1\n");
    ASSERT_TRUE(scene.has_value());
    std::vector<std::string> names;
    for (const prep::Material& m : scene->materials) names.push_back(m.name);
    EXPECT_EQ(names, (std::vector<std::string>{"a", "a#1", "b #1"}));
    EXPECT_EQ(scene->meshes[0].face_materials, (Indices{0, 1, 0, 2}));
}

TEST(ObjBlocks, ColoursStayWithTheirVertices) {
    const prep::Mesh mesh = mesh_of("v 0 0 0\nv 1 0 0\n" + filler() +
                                    "v 0 1 0 0.25 0.5 0.75\nv 0 2 0\nf 1 2 3\nf 2 3 4\n");
    ASSERT_EQ(mesh.colors.size(), 1u);
    EXPECT_EQ(mesh.colors[0].values,
              (std::vector<glm::vec4>{
                  {1, 1, 1, 1}, {1, 1, 1, 1}, {0.25f, 0.5f, 0.75f, 1}, {1, 1, 1, 1}}));
}

TEST(ObjBlocks, MessagesCountTheLinesOfTheFile) {
    EXPECT_EQ(test::error_of(parse("v 0 0 0\n" + filler() + "f 1 1 9\n")),
              "test.obj:" + std::to_string(filler_lines + 2) +
                  ": vertex index 9 is out of range: the file has 1");
    EXPECT_EQ(test::error_of(parse("v 0 0 0\n" + filler() + "f -1 -1 -2\n")),
              "test.obj:" + std::to_string(filler_lines + 2) +
                  ": relative vertex index reaches 1 before the first vertex; 1 are in the file");
    const auto scene = parse("\nzonk\n" + filler() + "zonk\nzonk\n");
    ASSERT_TRUE(scene.has_value());
    EXPECT_EQ(scene->warnings, std::vector<std::string>{
                                   "test.obj:2: unknown statement 'zonk' was skipped (3 in all)"});
}

// The first line end behind 1 MiB is one that continues.
TEST(ObjBlocks, AContinuedLineIsNotCut) {
    const std::string head = "v 0 0 0\nv 1 0 0\nv 0 1 0\n#";
    const std::string text =
        head + std::string((1u << 20) - 4 - head.size(), '-') + "\nf 1 2 \\\n3\nf 3 2 1\n";
    ASSERT_EQ(text.find("\\\n"), (1u << 20) + 3);
    const auto scene = parse(text);
    ASSERT_TRUE(scene.has_value());
    EXPECT_EQ(scene->meshes[0].corner_vertices, (Indices{0, 1, 2, 2, 1, 0}));
    EXPECT_TRUE(scene->warnings.empty());
}

// Whether floats hold the coordinates is a question to all blocks.
TEST(ObjBlocks, OneBlockOfDecimalsIsEnoughForAnOrigin) {
    for (const bool first : {true, false}) {
        const std::string decimal = "v 5000000.1 0 0\nv 5000001.3 0 0\n";
        const std::string whole = "v 5000000 1 0\n";
        const prep::Mesh mesh =
            mesh_of((first ? decimal : whole) + filler() + (first ? whole : decimal) + "f 1 2 3\n");
        const std::size_t at = first ? 0 : 1;
        // Half an ulp of a float below 2, where float at 5,000,000 has steps of 0.5.
        EXPECT_NEAR(mesh.origin.x + double(mesh.positions[at].x), 5000000.1, 6e-8);
        EXPECT_NEAR(mesh.origin.x + double(mesh.positions[at + 1].x), 5000001.3, 6e-8);
    }
}

TEST(MtlValues, AScaleOfOneValueLeavesTheHeightAlone) {
    const auto library = prep::parse_mtl("newmtl a\nmap_Kd -s 2 a.png\n", "m.mtl", ".");
    EXPECT_EQ(library.materials[0].diffuse_map.scale, glm::vec2(2, 1));
    EXPECT_EQ(library.materials[0].diffuse_map.offset, glm::vec2(0, 0));
}

// The picture's lower left corner is v = 0 in the file: uv · s + o from there.
TEST(MtlValues, OffsetsAndScalesBeginAtTheBottom) {
    const auto library =
        prep::parse_mtl("newmtl a\nmap_Kd -s 2 4 1 -o 0.25 0.5 0 a.png\n", "m.mtl", ".");
    const prep::TextureRef& map = library.materials[0].diffuse_map;
    for (const glm::vec2 file_uv : {glm::vec2(0, 0), glm::vec2(0.125f, 0.75f)}) {
        const glm::vec2 drawn = file_uv * glm::vec2(2, 4) + glm::vec2(0.25f, 0.5f);
        const glm::vec2 ours(file_uv.x, 1 - file_uv.y);
        EXPECT_EQ(ours * map.scale + map.offset, glm::vec2(drawn.x, 1 - drawn.y));
    }
}

TEST(MtlValues, OpacityOutlivesTheColourBehindIt) {
    const auto library =
        prep::parse_mtl("newmtl a\nd 0.5\nKd 1 0.5 0\nnewmtl b\nKd 0.25\n", "m.mtl", ".");
    EXPECT_EQ(library.materials[0].diffuse, glm::vec4(1, 0.5f, 0, 0.5f));
    EXPECT_EQ(library.materials[0].alpha_mode, prep::AlphaMode::blend);
    EXPECT_EQ(library.materials[1].diffuse, glm::vec4(0.25f, 0.25f, 0.25f, 1));
}

}  // namespace
