// The outside of glTF files: GLB chunks, JSON, version, buffers and their URIs; and the bounds of
// buffer views and accessors, each tried at its last good and its first bad value.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <span>

#include "formats/gltf/binary_parts.h"
#include "formats/gltf/document.h"
#include "gltf_maker.h"
#include "mesh_files.h"

namespace {

using Floats = std::vector<float>;
using Json = test::GltfMaker::Json;
using test::GltfMaker;

std::string error_of(const std::string& bytes) {
    return test::error_of(prep::parse_gltf(std::as_bytes(std::span(bytes))));
}
std::string error_of(const GltfMaker& maker) {
    return test::error_of(maker.read());
}

#define EXPECT_SAYS(error, part)                               \
    do {                                                       \
        const std::string said = (error);                      \
        EXPECT_NE(said.find(part), std::string::npos) << said; \
    } while (false)

// --- GLB -------------------------------------------------------------------------------------

std::string word(std::uint32_t value) {
    std::string out(4, '\0');
    std::memcpy(out.data(), &value, 4);
    return out;
}

struct Chunk {
    std::string type, content;
};

const std::string minimal = R"({"asset":{"version":"2.0"}} )";  // 28 bytes

std::string glb(const std::vector<Chunk>& chunks, int announce = 0, std::uint32_t version = 2) {
    std::string body;
    for (const Chunk& c : chunks)
        body += word(std::uint32_t(c.content.size())) + c.type + c.content;
    return "glTF" + word(version) + word(std::uint32_t(12 + int(body.size()) + announce)) + body;
}

TEST(Glb, ChunksStandInTheOrderOfTheSpecification) {
    const Chunk json{"JSON", minimal}, bin{std::string("BIN\0", 4), "abcd"}, other{"XTRA", "1234"};
    EXPECT_EQ(error_of(glb({json})), "no error");
    EXPECT_EQ(error_of(glb({json, bin})), "no error");
    EXPECT_EQ(error_of(glb({json, bin, other, other})), "no error");
    EXPECT_EQ(error_of(glb({json, other})), "no error");
    EXPECT_SAYS(error_of(glb({bin, json})), "the first chunk must be JSON");
    EXPECT_SAYS(error_of(glb({json, json})), "a second JSON chunk");
    EXPECT_SAYS(error_of(glb({json, bin, bin})), "the BIN chunk must be the second one");
    EXPECT_SAYS(error_of(glb({json, other, bin})), "the BIN chunk must be the second one");
}

// Writers of such files leave the padding out, or leave it out of the length alone; other programs
// read both.
TEST(Glb, ChunksOfUnevenLengthAreReadWithAWarning) {
    const std::string uneven = minimal + " ";
    const std::string bin("BIN\0", 4), pixels("abcd");
    const auto header = [](const std::string& rest) {
        return "glTF" + word(2) + word(std::uint32_t(12 + rest.size())) + rest;
    };
    const std::string chunk = word(std::uint32_t(uneven.size())) + "JSON" + uneven;
    const std::string second = word(4) + bin + pixels;
    prep::GltfOptions options;
    options.name = "uneven.glb";
    for (const std::string& file :
         {header(chunk), header(chunk + second), header(chunk + std::string(3, ' ') + second),
          header(chunk + std::string(3, ' '))}) {
        const auto scene = prep::parse_gltf(std::as_bytes(std::span(file)), options);
        ASSERT_TRUE(scene) << test::error_of(scene);
        ASSERT_EQ(scene->warnings.size(), 1u);
        EXPECT_SAYS(scene->warnings[0], "uneven.glb: a chunk's length is not a multiple of 4");
    }
}

TEST(Glb, LengthsAreThoseOfTheBytes) {
    const Chunk json{"JSON", minimal}, bin{std::string("BIN\0", 4), "abcd"};
    EXPECT_EQ(error_of(glb({json}) + "what follows the announced length is not looked at"),
              "no error");
    EXPECT_SAYS(error_of(glb({json}, 4)), "announces 52 bytes, the file has 48");
    EXPECT_SAYS(error_of(glb({json, bin}, -4)), "a chunk of 4 bytes, but only 0 are left");
    EXPECT_SAYS(error_of(glb({json, bin}, -8)), "inside a chunk header");
    EXPECT_SAYS(error_of(glb({json}, 0, 1)), "GLB version 1");
    EXPECT_SAYS(error_of(glb({})), "announces 12 bytes");
    EXPECT_SAYS(error_of(std::string("glTF") + word(2)), "shorter than a GLB header");
}

// --- JSON ------------------------------------------------------------------------------------

TEST(GltfJson, VersionsAreTwoNumbersAndTheMinimumHolds) {
    const auto with = [](const std::string& asset) {
        return error_of(R"({"asset":{)" + asset + "}}");
    };
    EXPECT_EQ(with(R"("version":"2.0")"), "no error");
    EXPECT_EQ(with(R"("version":"2.1")"), "no error") << "later 2.x get along with a reader of 2.0";
    EXPECT_EQ(with(R"("version":"2.1","minVersion":"2.0")"), "no error");
    EXPECT_SAYS(with(R"("version":"2.1","minVersion":"2.1")"), "/asset/minVersion");
    EXPECT_SAYS(with(R"("version":"1.0")"), "/asset/version");
    EXPECT_SAYS(with(R"("version":"3.0")"), "/asset/version");
    EXPECT_SAYS(with(R"("version":"2")"), "two numbers with a dot");
    EXPECT_SAYS(with(R"("version":"2.x")"), "two numbers with a dot");
    EXPECT_SAYS(with(R"("version":2.0)"), "expected a string");
    EXPECT_SAYS(with(R"("generator":"none")"), "asset.version");
}

TEST(GltfJson, BracketsInStringsAreNotNesting) {
    const auto named = [](const std::string& name) {
        return error_of(R"({"asset":{"version":"2.0"},"scenes":[{"name":")" + name + "\"}]}");
    };
    const std::string brackets(600, '[');
    EXPECT_EQ(named(brackets), "no error");
    EXPECT_EQ(named("\\\"" + brackets), "no error") << "an escaped quote ends no string";
    EXPECT_EQ(named("\\\\"), "no error");
    const auto nested = [](std::size_t depth) {
        return error_of(R"({"asset":{"version":"2.0"},"extras":)" + std::string(depth, '[') +
                        std::string(depth, ']') + "}");
    };
    EXPECT_EQ(nested(511), "no error");
    EXPECT_SAYS(nested(512), "nested more than 512 deep");
}

TEST(GltfJson, WholeNumbersMayBeWrittenAsFloatsIfTheyAreWhole) {
    const auto indexed = [](const std::string& index) {
        return error_of(R"({"asset":{"version":"2.0"},"scene":)" + index + R"(,"scenes":[{},{}]})");
    };
    EXPECT_EQ(indexed("1"), "no error");
    EXPECT_EQ(indexed("1.0"), "no error");
    EXPECT_EQ(indexed("1e0"), "no error");
    EXPECT_SAYS(indexed("0.5"), "#/scene");
    EXPECT_SAYS(indexed("2"), "the list has 2 entries: there is no number 2");
    EXPECT_SAYS(indexed("2.0"), "#/scene");
    EXPECT_SAYS(indexed("-1"), "#/scene");
    EXPECT_SAYS(indexed("1e30"), "#/scene");
    EXPECT_SAYS(indexed("\"1\""), "#/scene");
    EXPECT_SAYS(indexed("null"), "#/scene");
}

TEST(GltfJson, AByteOrderMarkIsSkippedAndTheListsAreLists) {
    EXPECT_EQ(error_of("\xef\xbb\xbf" + minimal), "no error");
    EXPECT_SAYS(error_of("[]"), "expected a JSON object");
    EXPECT_SAYS(error_of(R"({"asset":{"version":"2.0"},"nodes":{}})"), "#/nodes");
    EXPECT_SAYS(error_of(R"({"asset":{"version":"2.0"},"nodes":[{},1]})"), "#/nodes/1");
}

// --- buffers ---------------------------------------------------------------------------------

Json triangle_of(const Json& buffer) {
    return {{"asset", {{"version", "2.0"}}},
            {"buffers", {buffer}},
            {"bufferViews", {{{"buffer", 0}, {"byteLength", 36}}}},
            {"accessors",
             {{{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}}},
            {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}}};
}

std::string triangle_bytes() {
    const Floats values = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    return {reinterpret_cast<const char*>(values.data()), 36};
}

TEST(GltfBuffers, LieBesideTheFileOrInItOrInTheChunk) {
    const test::TempDir dir;
    const std::string bytes = triangle_bytes();
    test::write_text(dir / "a b.bin", bytes);
    const std::string base64 = GltfMaker::base64(std::as_bytes(std::span(bytes)));
    const auto expect = [](const prep::Result<prep::Scene>& scene) {
        ASSERT_TRUE(scene) << test::error_of(scene);
        EXPECT_EQ(scene->meshes.at(0).positions,
                  (std::vector<glm::vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
    };
    test::write_text(dir / "in.gltf",
                     triangle_of({{"uri", "a%20b.bin"}, {"byteLength", 36}}).dump());
    const auto beside = prep::load_gltf(dir / "in.gltf");
    expect(beside);
    EXPECT_EQ(beside->source, dir / "in.gltf");
    EXPECT_EQ(beside->libraries, std::vector<std::filesystem::path>{dir / "a b.bin"});

    test::write_text(
        dir / "data.gltf",
        triangle_of({{"uri", "data:application/octet-stream;base64," + base64}, {"byteLength", 36}})
            .dump());
    const auto inside = prep::load_gltf(dir / "data.gltf");
    expect(inside);
    EXPECT_TRUE(inside->libraries.empty());

    std::string text = triangle_of({{"byteLength", 36}}).dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::string binary = glb({{"JSON", text}, {std::string("BIN\0", 4), bytes}});
    expect(prep::parse_gltf(std::as_bytes(std::span(binary))));
}

TEST(GltfBuffers, AFileOfTheCurrentFolderFindsWhatLiesBesideIt) {
    const test::TempDir dir;
    test::write_text(dir / "a.bin", triangle_bytes());
    test::write_text(dir / "in.gltf", triangle_of({{"uri", "a.bin"}, {"byteLength", 36}}).dump());
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(dir.path());
    const auto scene = prep::load_gltf("in.gltf");
    std::filesystem::current_path(before);
    EXPECT_EQ(test::error_of(scene), "no error");
}

TEST(GltfBuffers, HaveTheBytesThatTheyAnnounce) {
    const std::string bytes = triangle_bytes();
    const auto announced = [&](std::size_t present, std::size_t length) {
        const std::string cut = bytes.substr(0, present);
        return error_of(triangle_of({{"uri", "data:application/octet-stream;base64," +
                                                 GltfMaker::base64(std::as_bytes(std::span(cut)))},
                                     {"byteLength", length}})
                            .dump());
    };
    EXPECT_EQ(announced(36, 36), "no error");
    EXPECT_SAYS(announced(35, 36), "/buffers/0/byteLength");
    EXPECT_SAYS(announced(36, 35), "/bufferViews/0/byteLength");
}

TEST(GltfBuffers, UrisLeadNowhereButBesideTheFile) {
    const test::TempDir dir;
    test::write_text(dir / "a.bin", triangle_bytes());
    std::filesystem::create_directory(dir / "folder");
    const auto loaded = [&](const std::string& uri) {
        test::write_text(dir / "in.gltf", triangle_of({{"uri", uri}, {"byteLength", 36}}).dump());
        return test::error_of(prep::load_gltf(dir / "in.gltf"));
    };
    EXPECT_EQ(loaded("a.bin"), "no error");
    EXPECT_EQ(loaded("%61.bin"), "no error");
    EXPECT_EQ(loaded("folder/../a.bin"), "no error");
    EXPECT_SAYS(loaded((dir / "a.bin").string()), "only data: and relative URIs");
    EXPECT_SAYS(loaded("file:a.bin"), "only data: and relative URIs");
    EXPECT_SAYS(loaded("http://localhost/a.bin"), "only data: and relative URIs");
    EXPECT_SAYS(loaded("folder"), "is no regular file");
    EXPECT_SAYS(loaded("b.bin"), "'b.bin'");
    EXPECT_SAYS(loaded("data:application/octet-stream,abc"), "expected a base64 data URI");
    EXPECT_SAYS(loaded("data:application/octet-stream;base64,a*"), "expected a base64 data URI");
}

// --- views and accessors ---------------------------------------------------------------------

// Nine floats behind four that are not theirs, in a view of 52 bytes from byte 0.
GltfMaker views() {
    GltfMaker maker;
    maker.view(Floats{-1, -1, -1, -1, 1, 2, 3, 4, 5, 6, 7, 8, 9});
    maker.accessor({{"bufferView", 0},
                    {"byteOffset", 16},
                    {"componentType", 5126},
                    {"count", 3},
                    {"type", "VEC3"}});
    return maker;
}

std::string changed(const char* pointer, const Json& value) {
    GltfMaker maker = views();
    maker.json[Json::json_pointer(pointer)] = value;
    return error_of(maker);
}

TEST(GltfStructure, ViewsEndWithTheirBuffer) {
    EXPECT_EQ(changed("/bufferViews/0/byteLength", 52), "no error");
    EXPECT_SAYS(changed("/bufferViews/0/byteLength", 53), "#/bufferViews/0/byteLength");
    EXPECT_SAYS(changed("/bufferViews/0/byteOffset", 4), "#/bufferViews/0/byteLength");
    EXPECT_SAYS(changed("/bufferViews/0/byteOffset", 53), "#/bufferViews/0/byteOffset");
    EXPECT_SAYS(changed("/bufferViews/0/buffer", 1), "#/bufferViews/0/buffer");
    EXPECT_SAYS(changed("/bufferViews/0/byteStride", 2), "#/bufferViews/0/byteStride");
    EXPECT_SAYS(changed("/bufferViews/0/byteStride", 14), "#/bufferViews/0/byteStride");
    EXPECT_SAYS(changed("/bufferViews/0/byteStride", 256), "#/bufferViews/0/byteStride");
}

TEST(GltfStructure, AccessorsEndWithTheirView) {
    EXPECT_EQ(changed("/accessors/0/byteOffset", 16), "no error");
    EXPECT_SAYS(changed("/accessors/0/byteOffset", 20), "#/accessors/0/byteOffset");
    EXPECT_SAYS(changed("/accessors/0/count", 4), "#/accessors/0/byteOffset");
    EXPECT_SAYS(changed("/accessors/0/byteOffset", 15), "expected a multiple of 4");
    EXPECT_SAYS(changed("/accessors/0/byteOffset", 14), "expected a multiple of 4");
    EXPECT_SAYS(changed("/accessors/0/componentType", 5124), "#/accessors/0/componentType");
    EXPECT_SAYS(changed("/accessors/0/componentType", 5127), "#/accessors/0/componentType");
    EXPECT_SAYS(changed("/accessors/0/type", "VEC5"), "#/accessors/0/type");
    EXPECT_SAYS(changed("/accessors/0/count", 0), "#/accessors/0/count");
    EXPECT_SAYS(changed("/accessors/0/normalized", 1), "#/accessors/0/normalized");
    EXPECT_SAYS(changed("/accessors/0/bufferView", 1), "#/accessors/0/bufferView");
    // Elements wider than the stride would overlap.
    EXPECT_SAYS(changed("/bufferViews/0/byteStride", 8), "do not fit the bufferView's byteStride");
}

TEST(GltfStructure, StridedElementsNeedNoPaddingBehindTheLast) {
    GltfMaker maker = views();
    maker.json["bufferViews"][0]["byteStride"] = 20;
    maker.json["accessors"][0]["byteOffset"] = 0;  // ends at byte 2 · 20 + 12
    EXPECT_EQ(error_of(maker), "no error");
    maker.json["bufferViews"][0]["byteLength"] = 51;
    EXPECT_SAYS(error_of(maker), "#/accessors/0");
}

TEST(GltfStructure, ZerosWithoutAViewAreLimited) {
    const auto zeros = [](std::size_t accessors, std::uint64_t count) {
        GltfMaker maker;
        for (std::size_t a = 0; a < accessors; ++a)
            maker.accessor({{"componentType", 5126}, {"count", count}, {"type", "VEC4"}});
        return error_of(maker);
    };
    const std::uint64_t most = (256u << 20) / 16;  // 256 MiB
    EXPECT_EQ(zeros(1, most), "no error");
    EXPECT_SAYS(zeros(1, most + 1), "#/accessors/0/count");
    EXPECT_EQ(zeros(16, most), "no error");
    EXPECT_SAYS(zeros(17, most), "#/accessors/16/count");
}

TEST(GltfStructure, SparsePartsAreChecked) {
    const auto sparse = [](const char* pointer, const Json& value) {
        GltfMaker maker = views();
        maker.view(std::vector<std::uint16_t>{0, 1, 2, 2});
        maker.json["accessors"][0]["sparse"] = {
            {"count", 3},
            {"indices", {{"bufferView", 1}, {"componentType", 5123}}},
            {"values", {{"bufferView", 0}, {"byteOffset", 4}}}};
        maker.json["accessors"][0]["sparse"][Json::json_pointer(pointer)] = value;
        return error_of(maker);
    };
    EXPECT_EQ(sparse("/count", 3), "no error");
    EXPECT_SAYS(sparse("/count", 4), "#/accessors/0/sparse/count");
    EXPECT_SAYS(sparse("/count", 0), "#/accessors/0/sparse/count");
    EXPECT_EQ(sparse("/indices/byteOffset", 0), "no error");
    EXPECT_SAYS(sparse("/indices/byteOffset", 4), "#/accessors/0/sparse/indices");
    EXPECT_SAYS(sparse("/indices/byteOffset", 1), "expected a multiple of 2");
    EXPECT_SAYS(sparse("/indices/componentType", 5122), "#/accessors/0/sparse/indices");
    EXPECT_EQ(sparse("/values/byteOffset", 16), "no error");
    EXPECT_SAYS(sparse("/values/byteOffset", 20), "#/accessors/0/sparse/values");
    EXPECT_SAYS(sparse("/values/byteOffset", 2), "expected a multiple of 4");
    EXPECT_SAYS(sparse("/values/bufferView", 2), "#/accessors/0/sparse/values/bufferView");
    GltfMaker strided = views();
    strided.view(std::vector<std::uint32_t>{0, 1, 2}, 4);
    strided.json["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", 1}, {"componentType", 5125}}},
        {"values", {{"bufferView", 0}}}};
    EXPECT_SAYS(error_of(strided), "tightly packed");
}

TEST(GltfStructure, CompressedViewsHoldWhatTheyAnnounceAndNoMoreThanTheCodecsCan) {
    const auto compressed = [](std::uint64_t count, std::uint64_t length) {
        GltfMaker maker;
        const Floats values(64, 1.0f);
        maker.meshopt_view("ATTRIBUTES", "NONE", 16, 16, std::as_bytes(std::span(values)));
        Json& view = maker.json["bufferViews"][0];
        view["byteLength"] = length;
        view["extensions"]["EXT_meshopt_compression"]["count"] = count;
        view["extensions"]["EXT_meshopt_compression"]["byteLength"] = 40;
        // The buffer that the view stands for; what is in it is the first one's.
        maker.push("buffers",
                   {{"byteLength", 40},
                    {"uri", "data:application/octet-stream;base64," + std::string(56, 'A')}});
        maker.push("buffers", {{"byteLength", length}});
        return error_of(maker);
    };
    const std::string place = "#/bufferViews/0/extensions/EXT_meshopt_compression/count";
    EXPECT_EQ(compressed(16, 256), "no error") << "looked into only when it is used";
    EXPECT_SAYS(compressed(15, 256), place);
    EXPECT_SAYS(compressed(17, 256), place);
    EXPECT_SAYS(compressed(1 << 20, 16 << 20), place);
}

// Small pieces, pieces that are kept as they are, and what is lent, in one order.
TEST(BinaryParts, AreInOrderHoweverTheyCame) {
    std::vector<std::byte> expected;
    unsigned next = 0;
    const auto bytes = [&](std::size_t size) {
        std::vector<std::byte> made;
        for (std::size_t i = 0; i < size; ++i) made.push_back(std::byte(next++ * 7919 >> 3));
        expected.insert(expected.end(), made.begin(), made.end());
        return made;
    };
    prep::detail::BinaryParts binary;
    EXPECT_TRUE(binary.empty());
    EXPECT_TRUE(binary.joined().empty());
    const std::vector<std::byte> lent = [&] {
        binary.append(bytes(3));
        binary.append(bytes(65536));  // closes what was appended before it
        binary.append(bytes(5));
        return bytes(70000);
    }();
    binary.take(prep::detail::SharedBytes::lent(lent));
    binary.take({});
    binary.append(bytes(65535));
    binary.append(bytes(2));
    binary.take(bytes(9));  // small: copied behind the others
    binary.take(bytes(65536));
    binary.append(bytes(1));
    EXPECT_EQ(binary.size(), expected.size());
    EXPECT_TRUE(binary.joined() == expected);
    const auto parts = binary.parts();
    EXPECT_EQ(std::count_if(parts.begin(), parts.end(),
                            [&](const auto& part) { return part.data() == lent.data(); }),
              1);
    binary.pad();
    while (expected.size() % 4 != 0) expected.emplace_back();
    EXPECT_TRUE(binary.joined() == expected);
    binary.pad();
    EXPECT_EQ(binary.size(), expected.size());
}

}  // namespace
