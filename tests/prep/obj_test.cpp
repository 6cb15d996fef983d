#include "formats/obj/obj.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "mesh_files.h"
#include "prep/load.h"
#include "shared_data.h"

namespace {

prep::Result<prep::Scene> parse(const std::string& text, int threads = 0) {
    prep::ObjOptions options;
    options.name = "test.obj";
    options.threads = threads;
    return prep::parse_obj(std::as_bytes(std::span(text.data(), text.size())), options);
}

std::string error_of(const std::string& text) {
    const auto result = parse(text);
    return result ? "no error" : prep::to_string(result.error());
}

TEST(Obj, EmptyFileIsAnEmptyMesh) {
    const auto scene = parse("");
    ASSERT_TRUE(scene.has_value());
    EXPECT_EQ(scene->meshes[0].vertex_count(), 0u);
    EXPECT_EQ(scene->meshes[0].face_count(), 0u);
}

TEST(Obj, ReadsCornersInAllFourForms) {
    const auto scene = parse(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.25\nvn 0 0 1\n"
        "f 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 3/1/1\n");
    ASSERT_TRUE(scene.has_value());
    const prep::Mesh& m = scene->meshes[0];
    ASSERT_EQ(m.face_count(), 4u);
    ASSERT_EQ(m.uvs.size(), 1u);
    EXPECT_EQ(m.uvs[0].values[0], glm::vec2(0.25f, 0.75f));  // top-left origin
    EXPECT_EQ(m.uvs[0].indices[0], prep::no_index);
    EXPECT_EQ(m.uvs[0].indices[3], 0u);
    EXPECT_EQ(m.normals.indices[5], prep::no_index);
    EXPECT_EQ(m.normals.indices[6], 0u);
}

TEST(Obj, NegativeIndicesCountBackFromTheirLine) {
    const auto scene = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -1 -2 -3\n");
    ASSERT_TRUE(scene.has_value());
    EXPECT_EQ(scene->meshes[0].corner_vertices, (std::vector<std::uint32_t>{0, 1, 2, 3, 2, 1}));
}

TEST(Obj, ContinuationsCommentsAndCarriageReturns) {
    const auto good =
        parse("# v nonsense\r\nv 0 0 \\\r\n0\r\nv 1 0 0 # x\r\nv 0 1 0\r\nf 1 2 \\\n3 # ok\r\n");
    ASSERT_TRUE(good.has_value()) << prep::to_string(good.error());
    EXPECT_EQ(good->meshes[0].positions[1], glm::vec3(1, 0, 0));
    EXPECT_EQ(good->meshes[0].face_count(), 1u);
}

TEST(Obj, CommentsEndAnyLine) {
    const auto scene = parse(
        "v 0 0 0 # a\nv 1 0 0#b\nv 1 1 0 #\nv 0 1 0 1 0.5 0 # with a colour\nvt 0.5 # u alone\n"
        "vt 0.5 0.25#c\nvn 0 0 1 # up\ns 3 # group\nf 1 2 3#c\nf 1/1/1 3/2/1 4/2/1 # 9 9 9\n"
        "l 1 2 # 3\np 4#1\nt crease 2/1/0 0 1 2.0 # sharp\n#\ng # not a name\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const prep::Mesh& m = scene->meshes[0];
    EXPECT_EQ(m.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(m.corner_vertices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(m.uvs[0].values, (std::vector<glm::vec2>{{0.5f, 1}, {0.5f, 0.75f}}));
    EXPECT_EQ(m.normals.values, std::vector<glm::vec3>{glm::vec3(0, 0, 1)});
    EXPECT_EQ(m.face_smoothing, (std::vector<std::uint32_t>{3, 3}));
    EXPECT_EQ(m.line_vertices, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_EQ(m.points, std::vector<std::uint32_t>{3});
    EXPECT_EQ(m.subdivision.creases.size(), 1u);
    EXPECT_EQ(scene->warnings, std::vector<std::string>{});
    EXPECT_EQ(error_of("v 0 0 # 0\n"), "test.obj:1: expected three coordinates in 'v 0 0 # 0'");
}

// Exporters write names such as "Material #25": a # belongs to the name, unless only the name in
// front of it is known.
TEST(Obj, NamesKeepTheirHash) {
    const test::TempDir dir;
    test::write_text(dir / "a.mtl", "newmtl Material #25\nnewmtl red\nKd 1 0 0 # red\n");
    test::write_text(dir / "a.obj",
                     "mtllib a.mtl # the library\nv 0 0 0\nv 1 0 0\nv 0 1 0\ng part #1\n"
                     "usemtl Material #25\nf 1 2 3\nusemtl red # the red one\nf 1 2 3\n"
                     "usemtl blue #2\nf 1 2 3\n");
    const auto scene = prep::load_scene(dir / "a.obj");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].parts, std::vector<std::string>{"part #1"});
    EXPECT_EQ(scene->meshes[0].face_materials, (std::vector<std::uint32_t>{0, 1, 2}));
    ASSERT_EQ(scene->materials.size(), 3u);
    EXPECT_EQ(scene->materials[0].name, "Material #25");
    EXPECT_EQ(scene->materials[1].diffuse, glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(
        scene->warnings,
        std::vector<std::string>{"material 'blue #2' is in no library: the default look is used"});
}

TEST(Obj, Utf16AndBinaryAreRefused) {
    const std::string why =
        "test.obj:1: this is UTF-16 or no text; expected OBJ as ASCII or UTF-8: save it so";
    EXPECT_EQ(error_of(std::string("v\0 \0000", 5)), why);
    EXPECT_EQ(error_of("\xff\xfev"), why);
    EXPECT_EQ(error_of("\xfe\xff"), why);
    EXPECT_EQ(error_of(std::string("v 0 0 0\n\0\0v 1 0 0\n", 18)).substr(0, 26),
              "test.obj:2: a zero byte: t");  // a hole in the file
    EXPECT_EQ(error_of(std::string("v 0 0 0\nab\0c 1\n", 15)),
              "test.obj:2: a zero byte: this is no OBJ text (binary, or UTF-16) in 'ab?c'");
}

TEST(Obj, AGroupWithoutANameIsNone) {
    const auto scene = parse("g\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    ASSERT_TRUE(scene.has_value());
    EXPECT_TRUE(scene->meshes[0].parts.empty());
    EXPECT_TRUE(scene->meshes[0].face_parts.empty());
}

TEST(Obj, SmoothingGroupsMaterialsAndParts) {
    const auto scene = parse(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\no body\ns 1\nusemtl red\nf 1 2 3\ng lid\ns off\nusemtl blue\n"
        "f 1 2 3\nusemtl red\ns 7\nf 3 2 1\n");
    ASSERT_TRUE(scene.has_value());
    const prep::Mesh& m = scene->meshes[0];
    EXPECT_EQ(m.face_smoothing, (std::vector<std::uint32_t>{1, 0, 7}));
    EXPECT_EQ(m.face_materials, (std::vector<std::uint32_t>{0, 1, 0}));
    EXPECT_EQ(m.parts, (std::vector<std::string>{"body", "body/lid"}));
    EXPECT_EQ(m.face_parts, (std::vector<std::uint32_t>{0, 1, 1}));
    EXPECT_EQ(scene->materials[1].name, "blue");
}

TEST(Obj, SmoothingOffThroughoutIsNoInformation) {
    const auto scene = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\ns off\nf 1 2 3\n");
    ASSERT_TRUE(scene.has_value());
    EXPECT_TRUE(scene->meshes[0].face_smoothing.empty());
}

TEST(Obj, SubdivisionTags) {
    const auto scene = parse(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nt crease 3/2/0 0 1 2 5.0 0.1\n"
        "t corner 1/1/0 3 2.5\nt hole 1/0/0 0\nt interpolateboundary 1/0/0 2\n");
    ASSERT_TRUE(scene.has_value());
    const prep::SubdivisionTags& tags = scene->meshes[0].subdivision;
    ASSERT_EQ(tags.creases.size(), 2u);
    EXPECT_EQ(tags.creases[1], (prep::EdgeMark{1, 2, 0.1f}));
    EXPECT_EQ(tags.corners[0], (prep::VertexMark{3, 2.5f}));
    EXPECT_EQ(tags.holes, (std::vector<std::uint32_t>{0}));
    EXPECT_EQ(tags.interpolate_boundary, 2);
}

TEST(Obj, VertexColoursOfBytesAreTakenForThoseOfOne) {
    for (const bool bytes : {true, false}) {
        const std::string text = std::string("v 0 0 0 51 0 255\nv 1 0 0 0 ") +
                                 (bytes ? "102" : "102.5") + " 1\nv 0 1 0 0 0 0\nf 1 2 3\n";
        const auto scene = parse(text);
        ASSERT_TRUE(scene) << prep::to_string(scene.error());
        const auto& values = scene->meshes[0].colors[0].values;
        EXPECT_EQ(values[0], bytes ? glm::vec4(0.2f, 0, 1, 1) : glm::vec4(51, 0, 255, 1));
        EXPECT_EQ(scene->warnings.size(), bytes ? 1u : 0u);
    }
    // One without a colour is white in either case.
    const auto some =
        parse("v 9 0 0\nv 0 0 0 255 0 0\nv 1 0 0\nv 0 1 0 0 51 0\nf 2 3 4\nf 1 2 3\n");
    ASSERT_TRUE(some) << prep::to_string(some.error());
    EXPECT_EQ(some->meshes[0].colors[0].values,
              (std::vector<glm::vec4>{glm::vec4(1), {1, 0, 0, 1}, glm::vec4(1), {0, 0.2f, 0, 1}}));
}

TEST(Obj, VertexColoursFollowTheCorners) {
    const auto scene = parse("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n");
    ASSERT_TRUE(scene.has_value());
    ASSERT_EQ(scene->meshes[0].colors.size(), 1u);
    EXPECT_EQ(scene->meshes[0].colors[0].values[1], glm::vec4(0, 1, 0, 1));
}

TEST(Obj, ErrorsNameTheLineTheFindingAndTheExpectation) {
    EXPECT_EQ(error_of("v 0 0 0\nv 1 x 0\n"),
              "test.obj:2: expected a number (coordinate 2) in 'v 1 x 0'");
    EXPECT_EQ(error_of("v 0 0 0\n\n# c\nf 1 2 3\n"),
              "test.obj:4: vertex index 2 is out of range: the file has 1");
    EXPECT_EQ(
        error_of("v 0 0 0\nv 0 0 0\nf -1 -2 -3\n"),
        "test.obj:3: relative vertex index reaches 1 before the first vertex; 2 are in the file");
    EXPECT_EQ(error_of("v 0 0 0\nvt 0 0\nf 1/4 1/4 1/4\n"),
              "test.obj:3: texture coordinate index 4 is out of range: the file has 1");
    EXPECT_NE(error_of("v 0 0 0\nf 1 0 1\n").find("test.obj:2: expected v, v/vt"),
              std::string::npos);
    EXPECT_NE(error_of("v 0 0 0\nf 99999999999999999999 1 1\n").find("test.obj:2:"),
              std::string::npos);
    EXPECT_EQ(error_of("v 0 0\n"), "test.obj:1: expected three coordinates in 'v 0 0'");
    EXPECT_EQ(error_of("v 0 0 0\nt crease 2/1/0 0 5 1.0\n"),
              "test.obj:2: the tag's vertex 5 is out of range: there are 1");
    EXPECT_EQ(
        error_of("t crease 999999999999/1/0 0 5 1.0\n"),
        "test.obj:1: expected counts such as 2/1/0 in the tag 'crease 999999999999/1/0 0 5 1.0'");
}

TEST(Obj, FacesWithTooFewCornersAreDroppedWithAWarning) {
    const auto scene = parse("v 0 0 0\nv 1 0 0\nf 1 2\nf 1 1 2\n");
    ASSERT_TRUE(scene.has_value());
    EXPECT_EQ(scene->meshes[0].face_count(), 1u);
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_EQ(scene->warnings[0],
              "test.obj:3: elements with too few corners were dropped (1 in all)");
}

TEST(Obj, FarOffDecimalCoordinatesAreCentred) {
    const auto scene = parse("v 5000000.1 0 0\nv 5000001.1 0 0\nv 5000000.1 1 0\nf 1 2 3\n");
    ASSERT_TRUE(scene.has_value());
    const prep::Mesh& m = scene->meshes[0];
    // The centre is 5000000.6; the diagonal √2, so the grid is 1/16.
    EXPECT_EQ(m.origin.x, 5000000.625);
    EXPECT_NEAR(m.positions[0].x, -0.525, 3e-8);  // a float's half ulp at 0.525
    EXPECT_NEAR(m.positions[1].x, 0.475, 3e-8);
}

TEST(Obj, FarOffFloatCoordinatesKeepTheirBits) {
    const auto scene = parse("v 5000000 0 0\nv 5000001 0 0\nv 5000000 1 0\nf 1 2 3\n");
    ASSERT_TRUE(scene.has_value());
    EXPECT_EQ(scene->meshes[0].origin, glm::dvec3(0.0));
    EXPECT_EQ(scene->meshes[0].positions[1].x, 5000001.0f);
}

TEST(Obj, SameResultForAnyThreadCountAcrossBlocks) {
    // Long enough for several blocks; relative indices and state changes cross their borders.
    std::string text;
    for (int i = 0; i < 90000; ++i) {
        text += "v " + std::to_string(i * 0.37) + " " + std::to_string(i % 71) + " 0.5\n";
        text += "vt 0." + std::to_string(i % 1000) + " 0.25\n";
        if (i % 1000 == 0)
            text +=
                "g part" + std::to_string(i / 9000) + "\ns " + std::to_string(i / 1000 % 5) + "\n";
        if (i > 40000) text += "f -1/-1 -20000/-20000 " + std::to_string(i / 3) + "/1\n";
    }
    const auto one = parse(text, 1);
    ASSERT_TRUE(one.has_value()) << prep::to_string(one.error());
    ASSERT_GT(text.size(), std::size_t(4) << 20);
    EXPECT_EQ(one->meshes[0].corner_vertices[0], 40001u);
    EXPECT_EQ(one->meshes[0].corner_vertices[1], 20002u);
    for (const int threads : {2, 3, 8}) {
        const auto many = parse(text, threads);
        ASSERT_TRUE(many.has_value());
        EXPECT_EQ(many->meshes[0].positions, one->meshes[0].positions);
        EXPECT_EQ(many->meshes[0].corner_vertices, one->meshes[0].corner_vertices);
        EXPECT_EQ(many->meshes[0].uvs[0].indices, one->meshes[0].uvs[0].indices);
        EXPECT_EQ(many->meshes[0].face_smoothing, one->meshes[0].face_smoothing);
        EXPECT_EQ(many->meshes[0].face_parts, one->meshes[0].face_parts);
    }
}

// "# exported to C:\\" is a comment to its end, and no more.
TEST(Obj, CommentsTakeNoOtherLine) {
    const auto scene =
        parse("# made by C:\\out\\\nv 0 0 0\nv 1 0 0\n  # and C:\\\r\nv 0 1 0\nf 1 \\\n2 3\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].vertex_count(), 3u);
    EXPECT_EQ(scene->meshes[0].face_count(), 1u);
}

// As Microsoft's library writes what is no number; a comment may follow a number at once.
TEST(Obj, WhatIsNoNumberIsNotAComment) {
    const auto read = parse("v 1.#QNAN 0 -1.#IND\nv 1 0 -1.#INF00\nv 3 4 5.#I say\nf 1 2 3\n");
    ASSERT_TRUE(read.has_value()) << prep::to_string(read.error());
    const auto& p = read->meshes[0].positions;
    EXPECT_TRUE(std::isnan(p[0].x) && p[0].y == 0 && std::isnan(p[0].z));
    EXPECT_EQ(p[1].z, -std::numeric_limits<float>::infinity());
    EXPECT_EQ(p[2], glm::vec3(3, 4, 5));
}

TEST(Obj, VerticesAloneAreAPointCloud) {
    const auto scene = parse("v 1 2 3 1 0 0\nv 4 5 6 0 1 0\nvn 0 0 1\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].points, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_EQ(scene->meshes[0].vertex_colors[1], glm::vec4(0, 1, 0, 1));
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_NE(scene->warnings[0].find("normals of points were not taken"), std::string::npos);
    // Not those that something else is made of.
    for (const char* of : {"l 1 2\n", "p 1\n", "f 1 2\n", "curv 0 1 1 2\n"})
        EXPECT_LT(parse("v 1 2 3\nv 4 5 6\n" + std::string(of))->meshes[0].points.size(), 2u) << of;
}

TEST(Mtl, ReadsColoursMapsAndOptions) {
    const auto lib = prep::parse_mtl(
        "newmtl a b\nKd 0.1 0.2 0.3\nKs 0.5\nNs 2000\nd 0.5\nTr 0.9\nKe 1 2 3\n"
        "map_Kd -s 2 3 1 -o 0.5 0.25 my tex.png\nbump -bm 0.7 wall_nm.tga\nmap_Bump h.png\n",
        "m.mtl", "dir");
    ASSERT_EQ(lib.materials.size(), 1u);
    const prep::Material& m = lib.materials[0];
    EXPECT_EQ(m.name, "a b");
    EXPECT_EQ(m.diffuse, glm::vec4(0.1f, 0.2f, 0.3f, 0.5f));
    EXPECT_EQ(m.specular, glm::vec3(0.5f));
    EXPECT_EQ(m.shininess, 2000.0f);
    EXPECT_EQ(m.emissive, glm::vec3(1, 2, 3));
    EXPECT_EQ(m.alpha_mode, prep::AlphaMode::blend);
    ASSERT_TRUE(bool(m.diffuse_map));
    EXPECT_EQ(m.diffuse_map.scale, glm::vec2(2, 3));
    // v runs upwards in the file: the point v = 1 (ours 0) samples 3 · 1 + 0.25, ours 1 − 3.25.
    EXPECT_EQ(m.diffuse_map.offset, glm::vec2(0.5f, -2.25f));
    EXPECT_EQ(lib.images[lib.textures[m.diffuse_map.texture].image].name, "my tex.png");
    ASSERT_TRUE(bool(m.normal_map));  // the name says that the bump map is a normal map
    EXPECT_EQ(m.normal_map.strength, 0.7f);
    ASSERT_TRUE(bool(m.bump_map));
}

TEST(Mtl, NonsenseIsAWarningNeverAnError) {
    const auto lib = prep::parse_mtl("Kd 1 1 1\nnewmtl a\nKd red\nmap_Kd\n", "m.mtl", "");
    ASSERT_EQ(lib.materials.size(), 1u);
    ASSERT_EQ(lib.warnings.size(), 3u);
    EXPECT_EQ(lib.warnings[0], "m.mtl:1: 'kd' before the first newmtl was skipped");
}

TEST(Obj, ReadsTheCorpus) {
    MESHPREP_REQUIRE_SHARED(shared);
    struct Expected {
        const char* file;
        std::size_t positions, faces;
    };
    // Statement counts of the files (grep -c '^v ', '^f ').
    for (const Expected& e :
         {Expected{"stanford-bunny.obj", 35947, 69451}, Expected{"beast.obj", 32311, 32364},
          Expected{"diablo3_pose/diablo3_pose.obj", 2519, 5022},
          Expected{"subdiv/catmark_cube_creases1.obj", 8, 6}}) {
        const auto scene = prep::load_obj(shared / "corpus" / e.file);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        EXPECT_EQ(scene->meshes[0].vertex_count(), e.positions) << e.file;
        EXPECT_EQ(scene->meshes[0].face_count(), e.faces) << e.file;
    }
}

// Those of lines have no place in a mesh.
TEST(Obj, TextureCoordinatesOfLinesAreToldAsLeftOut) {
    const auto scene = parse("v 0 0 0\nv 1 0 0\nvt 0 0\nl 1 2\nl 1/1 2/1\nl 2/1 1/1\n");
    ASSERT_TRUE(scene.has_value());
    EXPECT_EQ(scene->warnings,
              std::vector<std::string>{"test.obj:5: lines and points have no texture coordinates "
                                       "here: left out (2 in all)"});
}

TEST(Obj, ThirdTextureCoordinatesAreToldUnlessZero) {
    const auto warnings = [](const std::string& uvs) {
        const auto scene = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + uvs + "f 1/1 2/2 3/2\n");
        EXPECT_TRUE(scene.has_value());
        return scene->warnings;
    };
    EXPECT_EQ(warnings("vt 0 1 0\nvt 1 0 0.000\n"), std::vector<std::string>{});
    EXPECT_EQ(warnings("vt 0 1 0\nvt 1 0 0.5\n"),
              std::vector<std::string>{"test.obj:5: texture coordinates have two values here: the "
                                       "third was left out (1 in all)"});
}

TEST(Obj, MaterialsOfLinesAreToldAsLeftOut) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\n";
    const auto warnings = [](const std::string& text) {
        const auto scene = parse(text);
        EXPECT_TRUE(scene.has_value());
        std::vector<std::string> of_lines;
        for (const std::string& warning : scene->warnings)
            if (warning.find("lines and points") != std::string::npos) of_lines.push_back(warning);
        return of_lines;
    };
    EXPECT_EQ(warnings(vertices + "l 1 2\np 1\nusemtl red\n"), std::vector<std::string>{});
    EXPECT_EQ(warnings(vertices + "l 1 2\nusemtl red\np 1\nl 2 1\n"),
              std::vector<std::string>{"test.obj:5: lines and points have no material here: left "
                                       "out (2 in all)"});
    // The first of them in another block than the statement: a block has 1 MiB.
    std::string far = vertices + "l 1 2\nusemtl red\n";
    for (int i = 0; i < 40000; ++i) far += "# " + std::string(60, '-') + "\n";
    EXPECT_EQ(warnings(far + "l 1 2\n"),
              std::vector<std::string>{"test.obj:40005: lines and points have no material here: "
                                       "left out (1 in all)"});
}

}  // namespace
