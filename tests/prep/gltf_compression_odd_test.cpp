// Documents that contradict themselves, and values that a codec cannot hold, under compression.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "gltf_maker.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "shapes.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

using Maker = test::GltfMaker;
using PlainJson = nlohmann::json;
using prep::Compression;

// A sheet of n × n quads; positions by the caller's accessor.
Maker sheet(std::size_t position, Maker d, std::uint16_t n) {
    std::vector<std::uint16_t> indices;
    for (std::uint16_t y = 0; y < n; ++y)
        for (std::uint16_t x = 0; x < n; ++x) {
            const auto at = [&](int dx, int dy) {
                return std::uint16_t((y + dy) * (n + 1) + x + dx);
            };
            for (const auto i : {at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)})
                indices.push_back(i);
        }
    const std::size_t i = d.accessor(indices, "SCALAR");
    d.mesh({{{"attributes", {{"POSITION", position}}}, {"indices", i}}});
    return d;
}
Maker float_sheet(std::uint16_t n, float z) {
    Maker d;
    std::vector<float> places;
    for (std::uint16_t y = 0; y <= n; ++y)
        for (std::uint16_t x = 0; x <= n; ++x) places.insert(places.end(), {float(x), float(y), z});
    const std::size_t p = d.accessor(Maker::Json{{"bufferView", d.view(places)},
                                                 {"componentType", 5126},
                                                 {"count", places.size() / 3},
                                                 {"type", "VEC3"},
                                                 {"min", {0, 0, 0}},
                                                 {"max", {n, n, 0}}});
    return sheet(p, std::move(d), n);
}

std::vector<std::string> save(const Maker& maker, Compression compression,
                              const std::filesystem::path& to) {
    auto scene = maker.read();
    if (!scene) return {"reading: " + prep::to_string(scene.error())};
    prep::SaveOptions options;
    options.compression = compression;
    const auto notes = prep::save_scene(test::untouched(*std::move(scene)), to, options);
    return notes ? *notes : std::vector<std::string>{"writing: " + prep::to_string(notes.error())};
}

TEST(GltfCompressionOdd, PicturesOfAViewThatIsNotThereAreErrors) {
    Maker d = float_sheet(4, 0);
    d.json["images"] = {{{"uri", "not_there.png"}, {"bufferView", 9999999}}};
    const auto scene = d.read();
    ASSERT_FALSE(scene.has_value());
    EXPECT_NE(prep::to_string(scene.error()).find("/images/0/bufferView"), std::string::npos)
        << prep::to_string(scene.error());
}

TEST(GltfCompressionOdd, IndicesOfADracoPrimitiveThatAreNotThereAreErrors) {
    Maker d;
    Maker::Json primitive = d.draco_primitive(
        {{"POSITION", 5126, 3, false, {0, 0, 0, 4, 0, 0, 4, 4, 1, 0, 0, 0, 4, 4, 1, 0, 4, 2}}});
    primitive["indices"] = 99999;
    d.mesh({primitive});
    const auto scene = d.read();
    ASSERT_FALSE(scene.has_value());
    EXPECT_NE(prep::to_string(scene.error()).find("/meshes/0/primitives/0/indices"),
              std::string::npos)
        << prep::to_string(scene.error());
}

// Draco has them, glTF has not.
TEST(GltfCompressionOdd, TruthValuesInDracoAreErrors) {
    const auto scene = prep::load_scene(test::source_dir() / "fuzz/corpus/gltf/draco_of_bools.glb");
    ASSERT_FALSE(scene);
    EXPECT_NE(prep::to_string(scene.error()).find("its values cannot be converted"),
              std::string::npos)
        << prep::to_string(scene.error());
}

// A Draco primitive that has nothing to draw is written as it came, accessors included.
TEST(GltfCompressionOdd, QuantisingLeavesDracoPrimitivesWithoutPositions) {
    const test::TempDir dir;
    Maker d;
    Maker::Json primitive = d.draco_primitive(
        {{"POSITION", 5126, 3, false, {0, 0, 0, 4, 0, 0, 4, 4, 1, 0, 0, 0, 4, 4, 1, 0, 4, 2}},
         {"NORMAL",
          5126,
          3,
          false,
          {1e5, 0, 0.8, 0.8, 0, 0.6, 0, 0.6, 0.8, 1e5, 0, 0.8, 0, 0.6, 0.8, 0, 0.8, 0.6}}});
    primitive["attributes"]["_PLACE"] = primitive["attributes"]["POSITION"];
    primitive["attributes"].erase("POSITION");
    d.mesh({primitive});
    const auto scene = d.read();
    ASSERT_TRUE(scene) << prep::to_string(scene.error());
    for (const Compression c : {Compression::keep, Compression::none, Compression::meshopt}) {
        prep::SaveOptions options;
        options.compression = c;
        options.quantization = {8, 8, 8, 8};
        prep::Scene copy = *scene;
        ASSERT_TRUE(prep::save_scene(test::untouched(std::move(copy)), dir / "a.glb", options));
        const auto again = prep::load_scene(dir / "a.glb");
        EXPECT_TRUE(again) << prep::to_string(again.error());
    }
}

// One whose faces a repair removes is written as it came too: a grid of whole numbers, and the node
// that takes it back, would move what it has.
TEST(GltfCompressionOdd, QuantisingMovesNoDracoPrimitiveThatIsWrittenAsItCame) {
    const test::TempDir dir;
    Maker d = float_sheet(4, 0);
    Maker::Json bad = d.draco_primitive(
        {{"POSITION", 5126, 3, false, {0, 0, 9, 1, 0, 9, 2, 0, 9, 1, 0, 9, 2, 0, 9, 4, 0, 9}}});
    d.json["meshes"][0]["primitives"][1] = std::move(bad);
    auto scene = d.read();
    ASSERT_TRUE(scene) << prep::to_string(scene.error());
    const auto sorted = [](std::vector<glm::vec3> points) {  // Draco has an order of its own
        std::sort(points.begin(), points.end(), [](const glm::vec3& a, const glm::vec3& b) {
            return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
        });
        return points;
    };
    const std::vector<glm::vec3> before = sorted(scene->meshes[0].positions);
    prep::PrepareOptions options;
    options.repair.degenerate_faces = true;
    const auto prepared = prep::prepare(*std::move(scene), options);
    ASSERT_TRUE(prepared) << prep::to_string(prepared.error());
    ASSERT_EQ(prepared->meshes[0].triangle_count(), 32u);  // the sheet's
    prep::SaveOptions save;
    save.quantization = {8, 8, 8, 8};
    ASSERT_TRUE(prep::save_scene(*prepared, dir / "a.glb", save));
    const auto again = prep::load_scene(dir / "a.glb");
    ASSERT_TRUE(again) << prep::to_string(again.error());
    EXPECT_EQ(sorted(again->meshes[0].positions), before);
    EXPECT_EQ(again->nodes.size(), 1u);
}

TEST(GltfCompressionOdd, AListOfExtensionsThatIsNoListBecomesOne) {
    const test::TempDir dir;
    for (const Compression c : {Compression::draco, Compression::meshopt})
        for (const PlainJson& odd : {PlainJson::object(), PlainJson("x"), PlainJson(3)}) {
            Maker d = float_sheet(12, 0);
            d.json["extensionsUsed"] = odd;
            EXPECT_EQ(save(d, c, dir / "a.glb"), std::vector<std::string>{}) << odd;
            const PlainJson used = test::GltfFile(dir / "a.glb").json["extensionsUsed"];
            EXPECT_EQ(used,
                      PlainJson::array({c == Compression::draco ? "KHR_draco_mesh_compression"
                                                                : "EXT_meshopt_compression"}));
        }
}

// KHR_mesh_quantization: bounds are of the numbers as stored, normalised or not.
TEST(GltfCompressionOdd, BoundsOfNormalisedIntegersAreTheStoredNumbers) {
    const test::TempDir dir;
    constexpr std::uint16_t n = 12;
    Maker d;
    std::vector<std::int16_t> places;
    for (std::uint16_t y = 0; y <= n; ++y)
        for (std::uint16_t x = 0; x <= n; ++x)
            places.insert(places.end(), {std::int16_t(2000 * x), std::int16_t(-1000 * y), 7, 0});
    const std::size_t p = d.accessor(Maker::Json{{"bufferView", d.view(places, 8)},
                                                 {"componentType", 5122},
                                                 {"normalized", true},
                                                 {"count", places.size() / 4},
                                                 {"type", "VEC3"},
                                                 {"min", {0, -12000, 7}},
                                                 {"max", {24000, 0, 7}}});
    d = sheet(p, std::move(d), n);
    d.json["extensionsUsed"] = d.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    EXPECT_EQ(save(d, Compression::draco, dir / "a.glb"), std::vector<std::string>{});
    const test::GltfFile file(dir / "a.glb");
    const PlainJson& primitive = file.primitive(0, 0);
    ASSERT_TRUE(primitive["extensions"].contains("KHR_draco_mesh_compression"));
    const PlainJson& position =
        file.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
    EXPECT_EQ(position["min"], PlainJson::array({0, -12000, 7}));
    EXPECT_EQ(position["max"], PlainJson::array({24000, 0, 7}));
    const auto before = d.read(), after = prep::load_scene(dir / "a.glb");
    ASSERT_TRUE(before && after);
    for (const glm::vec3& q : after->meshes[0].positions)
        EXPECT_NE(
            std::find(before->meshes[0].positions.begin(), before->meshes[0].positions.end(), q),
            before->meshes[0].positions.end());
}

TEST(GltfCompressionOdd, PositionsThatAreNotFiniteStayUncompressed) {
    const test::TempDir dir;
    for (const float z : {std::nanf(""), INFINITY, -INFINITY}) {
        const std::vector<std::string> notes =
            save(float_sheet(12, z), Compression::draco, dir / "a.glb");
        EXPECT_NE(std::find(notes.begin(), notes.end(),
                            "1 primitive that Draco cannot hold left uncompressed"),
                  notes.end())
            << ::testing::PrintToString(notes);
        const test::GltfFile file(dir / "a.glb");
        for (const PlainJson& accessor : file.json["accessors"])
            for (const char* bound : {"min", "max"}) {
                if (!accessor.contains(bound)) continue;
                for (const PlainJson& number : accessor[bound]) EXPECT_TRUE(number.is_number());
            }
    }
}

// Draco takes time by the square of a point's triangles where it changes the order.
TEST(GltfCompressionOdd, PolesOfVeryManyTrianglesKeepTheirOrder) {
    const test::TempDir dir;
    for (const std::uint32_t around : {1000u, 5000u}) {
        const prep::Mesh fan = shapes::fan(around);
        std::vector<float> points;
        for (const glm::vec3& p : fan.positions) points.insert(points.end(), {p.x, p.y, p.z});
        Maker d;
        const Maker::Json attributes{{"POSITION", d.accessor(points, "VEC3")}};
        d.mesh(
            {{{"attributes", attributes}, {"indices", d.accessor(fan.corner_vertices, "SCALAR")}}});
        auto scene = d.read();
        ASSERT_TRUE(scene) << prep::to_string(scene.error());
        const std::vector<glm::vec3> before = scene->meshes[0].positions;
        prep::SaveOptions options;
        options.compression = Compression::draco;
        ASSERT_TRUE(
            prep::save_scene(test::untouched(*std::move(scene)), dir / "cone.glb", options));
        const auto again = prep::load_scene(dir / "cone.glb");
        ASSERT_TRUE(again) << prep::to_string(again.error());
        EXPECT_EQ(again->meshes[0].face_count(), around);
        EXPECT_EQ(again->meshes[0].positions == before, around > 4096);
    }
}

}  // namespace
