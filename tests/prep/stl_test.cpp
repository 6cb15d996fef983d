#include "formats/stl/stl.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "mesh_files.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shapes.h"

namespace {

prep::Result<prep::Scene> parse(const std::string& text) {
    return test::parsed(prep::parse_stl, text, "test.stl");
}

std::string error_of(const std::string& text) {
    return test::error_of(parse(text));
}

template <class T>
void put(std::string& out, T value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    out.append(raw, sizeof value);
}

std::string binary(std::uint32_t announced, std::uint32_t facets, const std::string& title = "") {
    std::string out = title;
    out.resize(80, ' ');
    put(out, announced);
    for (std::uint32_t f = 0; f < facets; ++f) {
        for (int k = 0; k < 3; ++k) put(out, 0.0f);
        for (int k = 0; k < 9; ++k) put(out, float(f * 9) + float(k) + 0.1f);
        put(out, std::uint16_t(0xabcd));
    }
    return out;
}

const std::string facet =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
    "endfacet\n";

TEST(Stl, EmptySolidsOfBothKinds) {
    for (const std::string& text :
         {std::string("solid nothing\nendsolid nothing\n"), binary(0, 0)}) {
        const auto scene = parse(text);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        EXPECT_EQ(scene->meshes[0].face_count(), 0u);
    }
}

TEST(Stl, BinaryKeepsEveryBit) {
    const auto scene = parse(binary(2, 2));
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const prep::Mesh& m = scene->meshes[0];
    ASSERT_EQ(m.face_count(), 2u);
    EXPECT_EQ(m.positions[0], glm::vec3(0.1f, 1.1f, 2.1f));
    EXPECT_EQ(m.positions[5], glm::vec3(9 + 6.1f, 9 + 7.1f, 9 + 8.1f));
    EXPECT_TRUE(m.normals.empty());
}

TEST(Stl, LargeBinaryFilesAreTheSameForAnyThreads) {
    constexpr std::uint32_t count = 2 * 16384 + 5;
    const std::string text = binary(count, count);
    const auto bytes = std::as_bytes(std::span(text));
    for (const int threads : {1, 2, 8}) {
        const auto scene = prep::parse_stl(bytes, "test.stl", threads);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        const prep::Mesh& m = scene->meshes[0];
        ASSERT_EQ(m.face_count(), count);
        ASSERT_EQ(m.positions.size(), 3 * std::size_t(count));
        std::size_t wrong = 0;
        for (std::uint32_t c = 0; c < 3 * count; ++c) {
            const float first = float(c / 3 * 9) + float(c % 3 * 3) + 0.1f;
            wrong += m.positions[c].x != first || m.corner_vertices[c] != c ||
                     m.face_offsets[c / 3] != c / 3 * 3;
        }
        EXPECT_EQ(wrong, 0u);
        EXPECT_NE(scene->warnings.at(0).find("bytes of " + std::to_string(count) + " facets"),
                  std::string::npos);
    }
}

TEST(Stl, TextBeginsWithSolidInAnyCase) {
    for (const char* word : {"solid", "Solid", "SOLID", "sOlId"}) {
        const auto scene = parse(std::string(word) + " x\n" + facet + "end" + word + " x\n");
        ASSERT_TRUE(scene.has_value()) << word << ": " << prep::to_string(scene.error());
        EXPECT_EQ(scene->meshes[0].face_count(), 1u);
    }
}

TEST(Stl, ABinaryFileMayBeginWithSolid) {
    EXPECT_EQ(parse(binary(1, 1, "solid made by a CAD system"))->meshes[0].face_count(), 1u);
    // Even with bytes after the last facet, or with a cut-short end.
    const auto longer = parse(binary(1, 1, "solid x") + "tail");
    ASSERT_TRUE(longer.has_value()) << prep::to_string(longer.error());
    EXPECT_EQ(longer->meshes[0].face_count(), 1u);
    EXPECT_EQ(longer->warnings[0], "test.stl: 4 bytes after the last facet were ignored");
    EXPECT_EQ(error_of(binary(3, 2, "solid x")),
              "test.stl, byte 80: the header announces 3 facets, but there is room for 2: the file "
              "is cut short or not STL");
}

TEST(Stl, TextWithSeveralSolidsBecomesParts) {
    const auto scene = parse("solid lid\r\n" + facet + facet + "endsolid lid\nSOLID big box\n" +
                             facet + "endsolid\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const prep::Mesh& m = scene->meshes[0];
    EXPECT_EQ(m.parts, (std::vector<std::string>{"lid", "big box"}));
    EXPECT_EQ(m.face_parts, (std::vector<std::uint32_t>{0, 0, 1}));
    EXPECT_EQ(m.vertex_count(), 9u);  // nothing is shared
}

TEST(Stl, FacetsWithoutThreeCornersAreDropped) {
    const auto scene = parse(
        "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendfacet\n" +
        facet + "endsolid\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].face_count(), 1u);
    EXPECT_EQ(scene->warnings[0], "test.stl: 2 facets without exactly three corners were dropped");
}

TEST(Stl, WhatIsDroppedTakesNoCornerOfOthersAlong) {
    const std::string four =
        "facet normal 0 0 1\nouter loop\nvertex 5 0 0\nvertex 6 0 0\nvertex 6 1 0\nvertex 5 1 0\n"
        "endloop\nendfacet\n";
    const auto scene = parse("solid a\n" + facet + four + four + facet + "endsolid a\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const std::vector<glm::vec3> once{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    std::vector<glm::vec3> twice = once;
    twice.insert(twice.end(), once.begin(), once.end());
    EXPECT_EQ(scene->meshes[0].positions, twice);
    EXPECT_EQ(
        scene->warnings,
        std::vector<std::string>{"test.stl: 2 facets without exactly three corners were dropped"});
}

TEST(Stl, TextMayBeginWithAByteOrderMark) {
    const std::string text = "solid a\n" + facet + "endsolid a\n";
    const auto marked = parse("\xef\xbb\xbf" + text), plain = parse(text);
    ASSERT_TRUE(marked.has_value() && plain.has_value()) << prep::to_string(marked.error());
    EXPECT_EQ(marked->meshes[0].positions, plain->meshes[0].positions);
    // The same three bytes may be the first of a binary file's header.
    const auto bytes = parse(binary(2, 2, "\xef\xbb\xbfsolid"));
    ASSERT_TRUE(bytes.has_value()) << prep::to_string(bytes.error());
    EXPECT_EQ(bytes->meshes[0].face_count(), 2U);
}

TEST(Stl, CapitalsAreTheSameWords) {
    std::string text = "solid a\n" + facet + "endsolid a\n";
    for (char& c : text) c = char(c >= 'a' && c <= 'z' ? c - 32 : c);
    const auto scene = parse(text);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].positions,
              (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

// Neither its size nor its first word tells that it is binary: the zeros in it do.
TEST(Stl, ABinaryFileMayBeginWithSolidAndBeLongerThanItsFacets) {
    const auto scene = parse(binary(2, 2, "solid body") + "some more");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].face_count(), 2u);
    EXPECT_EQ(scene->meshes[0].positions[3], glm::vec3(9.1f, 10.1f, 11.1f));
}

TEST(Stl, NamesMayHoldTheWordFacet) {
    const auto scene = parse("solid big facet\n" + facet + "endsolid big facet\nsolid Facet\n" +
                             facet + "endsolid Facet\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->meshes[0].face_count(), 2u);
    EXPECT_EQ(scene->meshes[0].parts, (std::vector<std::string>{"big facet", "Facet"}));
}

TEST(Stl, AnyWhiteSpaceSeparatesWords) {
    const std::string text = "solid lid\n" + facet + facet + "endsolid lid\nsolid big box\n" +
                             facet + "endsolid solid box\n";
    const auto lines = parse(text);
    ASSERT_TRUE(lines.has_value()) << prep::to_string(lines.error());
    std::string one = text, many = text;
    for (char& c : one)
        if (c == '\n') c = ' ';
    for (char& c : many)
        if (c == ' ' && &c > &many[text.find("facet")] && &c < &many[text.find("endsolid")])
            c = '\n';
    for (const std::string& variant : {one, many, one + "\n\n"}) {
        const auto scene = parse(variant);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        EXPECT_EQ(test::exact_difference(lines->meshes[0], scene->meshes[0]), "") << variant;
        EXPECT_EQ(scene->meshes[0].parts, (std::vector<std::string>{"lid", "big box"}));
        EXPECT_EQ(scene->meshes[0].face_count(), 3u);
    }
    EXPECT_EQ(error_of("solid x facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 2 x"),
              "test.stl:1: expected three coordinates in 'vertex 1 2 x'");
    // Very many solids in one line take linear time.
    std::string flood;
    for (int i = 0; i < 200'000; ++i) flood += "solid a endsolid a ";
    EXPECT_TRUE(parse(flood).has_value());
    flood = "solid a ";
    for (int i = 0; i < 100'000; ++i) flood += "endsolid solid facet normal endfacet ";
    EXPECT_FALSE(parse(flood).has_value());
}

TEST(Stl, FacetsOfWhichNoneIsATriangleAreAnError) {
    EXPECT_EQ(
        error_of("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n"
                 "endfacet\nfacet\nendfacet\nendsolid\n"),
        "test.stl: none of the 2 facets has exactly three corners: there is no triangle to "
        "read");
}

TEST(Stl, AttributeBytesAreNamed) {
    EXPECT_EQ(parse(binary(2, 2))->warnings,
              std::vector<std::string>{"test.stl: the attribute bytes of 2 facets (some programs' "
                                       "colours) were not taken"});
    std::string plain = binary(1, 1);
    plain[plain.size() - 1] = plain[plain.size() - 2] = 0;
    EXPECT_EQ(parse(plain)->warnings, std::vector<std::string>{});
}

TEST(Stl, NanIsKept) {
    const auto scene = parse(
        "solid\nfacet normal nan nan nan\nouter loop\nvertex nan 0 0\nvertex 1 inf 0\nvertex 0 1 "
        "0\nendloop\nendfacet\nendsolid\n");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_TRUE(std::isnan(scene->meshes[0].positions[0].x));
    EXPECT_EQ(scene->meshes[0].positions[1].y, std::numeric_limits<float>::infinity());
}

TEST(Stl, ErrorsNameThePlace) {
    EXPECT_EQ(error_of(""),
              "test.stl: neither \"solid\" at the beginning nor a binary header of 84 bytes: not "
              "STL");
    EXPECT_EQ(error_of("solid\nfacet\nvertex 1 2\n"),
              "test.stl:3: expected three coordinates in 'vertex 1 2'");
    EXPECT_EQ(error_of("solid\nfacet\nvertex 1 2 x\n"),
              "test.stl:3: expected three coordinates in 'vertex 1 2 x'");
    EXPECT_EQ(error_of("solid\nvertex 1 2 3\n"),
              "test.stl:2: a vertex outside a facet in 'vertex 1 2 3'");
    EXPECT_EQ(error_of("solid\nendfacet\n"),
              "test.stl:2: an endfacet without its facet in 'endfacet'");
    EXPECT_EQ(error_of("solid\nfacet\nvertex 0 0 0\nfacet\n"),
              "test.stl:4: a facet inside a facet in 'facet'");
    EXPECT_EQ(error_of("solid\nfacet\nvertex 0 0 0\n"),
              "test.stl:3: the file ends inside a facet in ''");
    EXPECT_EQ(
        error_of("solid\nvertices\n"),
        "test.stl:2: expected solid, facet, outer loop, vertex, endloop, endfacet or endsolid "
        "in 'vertices'");
}

TEST(Stl, CountsThatTheFileHasNoRoomForAreRefusedAtOnce) {
    EXPECT_EQ(error_of(binary(0xffffffff, 1)),
              "test.stl, byte 80: the header announces 4294967295 facets, but there is room for 1: "
              "the file is cut short or not STL");
    const std::string whole = binary(2, 2);
    for (std::size_t n = 0; n < whole.size(); ++n)
        EXPECT_FALSE(parse(whole.substr(0, n)).has_value()) << n;
}

TEST(Stl, RoundTripKeepsEveryBitInTextAndBytes) {
    std::string text = "solid\n";
    const char* numbers[] = {"0.1", "-0.0", "1e-42", "3.4e38",     "1", "2.5",
                             "-7",  "1e-3", "0.3",   "123456.789", "5", "16777217"};
    for (int f = 0; f < 12; ++f) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (int k = 0; k < 3; ++k)
            text += std::string("vertex ") + numbers[(f + k) % 12] + " " +
                    numbers[(f * 5 + k) % 12] + " " + numbers[(f * 7 + 3 * k) % 12] + "\n";
        text += "endloop\nendfacet\n";
    }
    const auto original = parse(text + "endsolid\n");
    ASSERT_TRUE(original.has_value()) << prep::to_string(original.error());
    const test::TempDir dir;
    for (const bool ascii : {false, true}) {
        prep::SaveOptions options;
        options.ascii = ascii;
        const auto first = dir / "first.stl", second = dir / "second.stl";
        ASSERT_TRUE(prep::save_scene(test::untouched(*original), first, options).has_value());
        const auto once = prep::load_scene(first);
        ASSERT_TRUE(once.has_value()) << prep::to_string(once.error());
        EXPECT_EQ(test::exact_difference(original->meshes[0], once->meshes[0]), "");
        ASSERT_TRUE(prep::save_scene(test::untouched(*once), second, options).has_value());
        EXPECT_EQ(test::file_text(first), test::file_text(second));
    }
}

// The name of one solid is its mesh's; several are parts of theirs.
TEST(Stl, ASolidKeepsItsName) {
    const auto scene = parse("solid Left Lid \n" + facet + "endsolid Left Lid\n");
    ASSERT_TRUE(scene.has_value());
    EXPECT_EQ(scene->meshes[0].name, "Left Lid");
    EXPECT_EQ(parse("solid\n" + facet + "endsolid\n")->meshes[0].name, "test");
    const test::TempDir dir;
    prep::SaveOptions options;
    options.ascii = true;
    const auto first_line = [&](const std::string& name) {
        prep::Scene named = *scene;
        named.meshes[0].name = name;
        EXPECT_TRUE(prep::save_scene(test::untouched(named), dir / "a.stl", options).has_value());
        const std::string text = test::file_text(dir / "a.stl");
        const std::string line = text.substr(0, text.find('\n'));
        EXPECT_TRUE(text.ends_with("\nend" + line + "\n")) << text;
        const auto again = prep::load_scene(dir / "a.stl");
        EXPECT_TRUE(again.has_value() && again->meshes[0].face_count() == 1) << name;
        return line;
    };
    EXPECT_EQ(first_line("Left Lid"), "solid Left Lid");
    for (const std::string& name : {std::string("big Facets"), std::string("two\nlines"),
                                    std::string("zero\0", 5), std::string(" blank"), std::string()})
        EXPECT_EQ(first_line(name), "solid meshprep") << name;
}

TEST(Stl, WrittenFacetNormalsAreUnitAndCounterClockwise) {
    prep::Scene scene;
    scene.meshes.push_back(shapes::mesh_of({{0, 0, 0}, {1e-20f, 0, 0}, {0, 1e-20f, 0}, {0, 0, 0}},
                                           {{0, 1, 2}, {0, 1, 3}}));
    prep::instance_unused_meshes(scene);
    const test::TempDir dir;
    prep::SaveOptions options;
    options.ascii = true;
    ASSERT_TRUE(prep::save_scene(test::untouched(scene), dir / "tiny.stl", options).has_value());
    const std::string text = test::file_text(dir / "tiny.stl");
    EXPECT_NE(text.find("facet normal 0 0 1\n"), std::string::npos) << text;
    EXPECT_NE(text.find("facet normal 0 0 0\n"), std::string::npos) << text;  // degenerate
}

}  // namespace
