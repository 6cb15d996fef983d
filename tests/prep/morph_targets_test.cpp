// glTF morph targets: what was computed for a mesh is computed for its targets too, and what is the
// file's own follows its vertices.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "formats/gltf/gltf.h"
#include "gltf_oracle.h"
#include "mesh_files.h"
#include "npm_tools.h"
#include "prep/save.h"
#include "shared_data.h"

namespace {

using Json = nlohmann::json;
using Vectors = std::vector<glm::vec3>;

// A glTF document in memory, its buffer a data URI.
class Document {
  public:
    Json json{{"asset", {{"version", "2.0"}}}};

    template <class T>
    std::size_t add(const std::vector<T>& values, int component, const char* type) {
        const std::size_t offset = bytes_.size(), size = values.size() * sizeof(T);
        bytes_.resize(offset + (size + 3) / 4 * 4);
        std::memcpy(bytes_.data() + offset, values.data(), size);
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
        json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                     {"componentType", component},
                                     {"count", values.size()},
                                     {"type", type}});
        return json["accessors"].size() - 1;
    }
    std::size_t add(const Vectors& values) { return add(values, 5126, "VEC3"); }
    std::size_t add_positions(const Vectors& values) {
        const std::size_t accessor = add(values);
        glm::vec3 low = values[0], high = values[0];
        for (const glm::vec3& p : values) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        json["accessors"][accessor]["min"] = {low.x, low.y, low.z};
        json["accessors"][accessor]["max"] = {high.x, high.y, high.z};
        return accessor;
    }

    std::string text() {
        static const char* const digits =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string uri = "data:application/octet-stream;base64,";
        bytes_.resize((bytes_.size() + 2) / 3 * 3);
        for (std::size_t i = 0; i < bytes_.size(); i += 3) {
            const unsigned bits =
                unsigned(bytes_[i]) << 16 | unsigned(bytes_[i + 1]) << 8 | unsigned(bytes_[i + 2]);
            for (int shift = 18; shift >= 0; shift -= 6) uri += digits[bits >> shift & 63];
        }
        json["buffers"] = {{{"byteLength", bytes_.size()}, {"uri", uri}}};
        json["nodes"] = {{{"mesh", 0}}};
        json["scenes"] = {{{"nodes", {0}}}};
        return json.dump();
    }
    prep::Scene parse() {
        const std::string dump = text();
        auto scene = prep::parse_gltf(std::as_bytes(std::span(dump.data(), dump.size())));
        if (!scene) ADD_FAILURE() << prep::to_string(scene.error());
        return scene ? *std::move(scene) : prep::Scene{};
    }

  private:
    std::vector<std::uint8_t> bytes_;
};

const Vectors square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

Vectors minus_square(Vectors moved) {
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] -= square[i];
    return moved;
}
// A quarter turn about z: x → y → −x. About y: x → −z, z → x.
const Vectors turned_about_z = minus_square({{0, 0, 0}, {0, 1, 0}, {-1, 1, 0}, {-1, 0, 0}});
const Vectors turned_about_y = minus_square({{0, 0, 0}, {0, 0, -1}, {0, 1, -1}, {0, 1, 0}});

// A square in the plane z = 0, u along x, v down (from the top left), and a target for each turn.
Document turning_square(bool with_normals) {
    Document d;
    Json attributes{{"POSITION", d.add_positions(square)},
                    {"TEXCOORD_0",
                     d.add(std::vector<glm::vec2>{{0, 1}, {1, 1}, {1, 0}, {0, 0}}, 5126, "VEC2")}};
    Json about_z{{"POSITION", d.add_positions(turned_about_z)}};
    Json about_y{{"POSITION", d.add_positions(turned_about_y)}};
    if (with_normals) {
        attributes["NORMAL"] = d.add(Vectors(4, {0, 0, 1}));
        about_y["NORMAL"] = d.add(Vectors(4, {1, 0, -1}));
    }
    const std::size_t indices = d.add(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, 5123, "SCALAR");
    d.json["meshes"] = {
        {{"primitives",
          {{{"attributes", attributes}, {"indices", indices}, {"targets", {about_z, about_y}}}}}}};
    return d;
}

// What was saved, read back as plain JSON and floats.
struct SavedTargets {
    Json json;
    std::string binary;

    std::vector<glm::vec4> values(const Json& accessor_index) const {
        const Json& accessor = json["accessors"][accessor_index.get<std::size_t>()];
        const Json& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
        const std::size_t width = accessor["type"] == "VEC4" ? 4 : 3;
        EXPECT_EQ(accessor["componentType"], 5126);
        const char* at = binary.data() + view.value("byteOffset", std::size_t(0)) +
                         accessor.value("byteOffset", std::size_t(0));
        std::vector<glm::vec4> result(accessor["count"].get<std::size_t>(), glm::vec4(0));
        for (std::size_t i = 0; i < result.size(); ++i)
            std::memcpy(&result[i], at + i * width * 4, width * 4);
        return result;
    }
    const Json& primitive(std::size_t p = 0) const { return json["meshes"][0]["primitives"][p]; }
};

SavedTargets prepared(Document& document, prep::PrepareOptions options = {}) {
    options.request.tangents = prep::Request::Level::always;
    auto scene = prep::prepare(document.parse(), options);
    EXPECT_TRUE(scene.has_value());
    const test::TempDir dir;
    EXPECT_TRUE(prep::save_scene(*scene, dir / "out.gltf").has_value());
    return {Json::parse(test::file_text(dir / "out.gltf")), test::file_text(dir / "out.bin")};
}

void expect_all(const std::vector<glm::vec4>& values, const glm::vec3& expected) {
    ASSERT_EQ(values.size(), 4u);
    for (const glm::vec4& v : values) {
        EXPECT_NEAR(v.x, expected.x, 1e-6);
        EXPECT_NEAR(v.y, expected.y, 1e-6);
        EXPECT_NEAR(v.z, expected.z, 1e-6);
    }
}

TEST(MorphTargets, TangentsTurnWithTheShape) {
    Document document = turning_square(true);
    const SavedTargets saved = prepared(document);
    const Json& primitive = saved.primitive();
    for (const glm::vec4& t : saved.values(primitive["attributes"]["TANGENT"]))
        EXPECT_EQ(t, glm::vec4(1, 0, 0, 1));
    // (1, 0, 0) becomes (0, 1, 0), and (0, 0, −1).
    expect_all(saved.values(primitive["targets"][0]["TANGENT"]), {-1, 1, 0});
    expect_all(saved.values(primitive["targets"][1]["TANGENT"]), {-1, 0, -1});
    for (std::size_t t = 0; t < 2; ++t) {
        const auto index = primitive["targets"][t]["TANGENT"].get<std::size_t>();
        EXPECT_EQ(saved.json["accessors"][index]["type"], "VEC3");
    }
    // Authored normals keep the file's deltas: none in the first target.
    EXPECT_FALSE(primitive["targets"][0].contains("NORMAL"));
    expect_all(saved.values(primitive["targets"][1]["NORMAL"]), {1, 0, -1});
}

// The normal map samples a second set, in which u runs along y: so do the tangents and their
// deltas.
TEST(MorphTargets, TangentsFollowTheUvSetOfTheNormalMap) {
    Document document = turning_square(true);
    Json& primitive = document.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_1"] =
        document.add(std::vector<glm::vec2>{{0, 0}, {0, 1}, {1, 1}, {1, 0}}, 5126, "VEC2");
    primitive["material"] = 0;
    document.json["materials"] = {{{"normalTexture", {{"index", 0}, {"texCoord", 1}}}}};
    document.json["textures"] = {{{"source", 0}}};
    document.json["images"] = {{{"uri", "none.png"}}};
    prep::PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    const auto scene = prep::prepare(document.parse(), options);
    ASSERT_TRUE(scene.has_value());
    ASSERT_EQ(scene->requirements[0].tangent_uv_set, 1u);
    for (const glm::vec4& t : scene->meshes[0].tangents)
        EXPECT_EQ(glm::vec3(t), glm::vec3(0, 1, 0));
    // About z (0, 1, 0) becomes (−1, 0, 0); about y it stays.
    ASSERT_EQ(scene->morphs[0].size(), 2u);
    for (const glm::vec3& d : scene->morphs[0][0].tangents)
        EXPECT_NEAR(glm::distance(d, glm::vec3(-1, -1, 0)), 0, 1e-6);
    for (const glm::vec3& d : scene->morphs[0][1].tangents) EXPECT_NEAR(glm::length(d), 0, 1e-6);
    EXPECT_EQ(scene->morphs[0][0].tangents.size(), 4u);
}

TEST(MorphTargets, ComputedNormalsTurnWithTheShape) {
    Document document = turning_square(false);
    const SavedTargets saved = prepared(document);
    const Json& targets = saved.primitive()["targets"];
    expect_all(saved.values(targets[0]["NORMAL"]), {0, 0, 0});
    expect_all(saved.values(targets[1]["NORMAL"]), {1, 0, -1});
    expect_all(saved.values(targets[0]["TANGENT"]), {-1, 1, 0});
    expect_all(saved.values(targets[1]["TANGENT"]), {-1, 0, -1});
}

TEST(MorphTargets, DeltasThatBelongedToReplacedNormalsGo) {
    Document document = turning_square(true);
    // The file's own deltas point elsewhere.
    Json& target = document.json["meshes"][0]["primitives"][0]["targets"][1];
    target["NORMAL"] = document.add(Vectors(4, {0, 1, -1}));
    prep::PrepareOptions options;
    options.normals = prep::Authored::replace;
    const SavedTargets saved = prepared(document, options);
    expect_all(saved.values(saved.primitive()["targets"][1]["NORMAL"]), {1, 0, -1});
}

TEST(MorphTargets, StayAsTheyAreWhereTheFilesTangentsAreKept) {
    Document document = turning_square(true);
    Json& primitive = document.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TANGENT"] =
        document.add(std::vector<glm::vec4>(4, {1, 0, 0, 1}), 5126, "VEC4");
    primitive["targets"][0]["TANGENT"] = document.add(Vectors(4, {-0.5f, 0.5f, 0}));
    const SavedTargets saved = prepared(document);
    expect_all(saved.values(saved.primitive()["targets"][0]["TANGENT"]), {-0.5f, 0.5f, 0});
    EXPECT_FALSE(saved.primitive()["targets"][1].contains("TANGENT"));
}

TEST(MorphTargets, SplitVerticesTakeTheirDeltasAlong) {
    // Two triangles in a plane, each with UVs of its own orientation, so that the vertices on their
    // common edge split; the target moves every vertex by another amount.
    Document d;
    const Vectors deltas{{0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}};
    const std::vector<glm::vec2> uvs{{0, 0}, {1, 0}, {1, 1}, {1, 0}};
    d.json["meshes"] = {
        {{"primitives",
          {{{"attributes",
             {{"POSITION", d.add_positions(square)},
              {"NORMAL", d.add(Vectors(4, {0, 0, 1}))},
              {"TEXCOORD_0", d.add(uvs, 5126, "VEC2")}}},
            {"indices", d.add(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, 5123, "SCALAR")},
            {"targets", {{{"POSITION", d.add_positions(deltas)}}}}}}}}};
    const SavedTargets saved = prepared(d);
    const Json& primitive = saved.primitive();
    const auto positions = saved.values(primitive["attributes"]["POSITION"]);
    const auto moved = saved.values(primitive["targets"][0]["POSITION"]);
    ASSERT_EQ(positions.size(), 6u);
    ASSERT_EQ(moved.size(), 6u);
    for (std::size_t v = 0; v < 6; ++v)
        for (std::size_t s = 0; s < 4; ++s)
            if (glm::vec3(positions[v]) == square[s]) {
                EXPECT_EQ(moved[v].z, deltas[s].z);
            }
    EXPECT_EQ(saved.values(primitive["targets"][0]["TANGENT"]).size(), 6u);
}

// A square cut along its diagonal, each half with vertices of its own, which differ in nothing but
// in what the target does to their normals: about y by an eighth, one half to each side.
TEST(MorphTargets, WeldedVerticesKeepTheDeltasOfTheirCorners) {
    Document d;
    const Vectors positions{square[0], square[1], square[2], square[0], square[2], square[3]};
    const std::vector<glm::vec2> uvs{{0, 1}, {1, 1}, {1, 0}, {0, 1}, {1, 0}, {0, 0}};
    const float root = std::sqrt(0.5f);
    const glm::vec3 one(root, 0, root - 1), other(-root, 0, root - 1);
    d.json["meshes"] = {
        {{"primitives",
          {{{"attributes",
             {{"POSITION", d.add_positions(positions)},
              {"NORMAL", d.add(Vectors(6, {0, 0, 1}))},
              {"TEXCOORD_0", d.add(uvs, 5126, "VEC2")}}},
            {"indices", d.add(std::vector<std::uint16_t>{0, 1, 2, 3, 4, 5}, 5123, "SCALAR")},
            {"targets", {{{"NORMAL", d.add(Vectors{one, one, one, other, other, other})}}}}}}}}};
    prep::PrepareOptions options;
    options.repair.weld_tolerance = 0;
    const SavedTargets saved = prepared(d, options);
    const Json& primitive = saved.primitive();
    const auto written = saved.values(primitive["attributes"]["POSITION"]);
    const auto turned = saved.values(primitive["targets"][0]["NORMAL"]);
    const auto tangents = saved.values(primitive["targets"][0]["TANGENT"]);
    ASSERT_EQ(written.size(), 6u);
    ASSERT_EQ(turned.size(), 6u);
    ASSERT_EQ(tangents.size(), 6u);
    std::size_t ones = 0;
    for (std::size_t v = 0; v < 6; ++v) {
        const bool is_one = glm::vec3(turned[v]) == one;
        ones += is_one;
        EXPECT_EQ(glm::vec3(turned[v]), is_one ? one : other);
        // (1, 0, 0) on the plane of the turned normal.
        EXPECT_NEAR(tangents[v].x, root - 1, 1e-6);
        EXPECT_NEAR(tangents[v].y, 0, 1e-6);
        EXPECT_NEAR(tangents[v].z, is_one ? -root : root, 1e-6);
    }
    EXPECT_EQ(ones, 3u);
}

TEST(MorphTargets, PrimitivesThatShareAccessorsWriteTheVerticesTheyUse) {
    // One set of accessors for two triangles that share no vertex.
    Document d;
    const Vectors positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    const Vectors deltas{{0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}, {0, 0, 5}, {0, 0, 6}};
    // Colours that differ from zero at one vertex only, as a sparse accessor.
    const std::size_t place = d.add(std::vector<std::uint16_t>{4}, 5123, "SCALAR");
    const std::size_t value = d.add(std::vector<glm::vec4>{{0.25f, 0.5f, 0.75f, 1}}, 5126, "VEC4");
    const std::size_t colors = d.add(std::vector<glm::vec4>(6, glm::vec4(0)), 5126, "VEC4");
    d.json["accessors"][colors]["sparse"] = {
        {"count", 1},
        {"indices",
         {{"bufferView", d.json["accessors"][place]["bufferView"]}, {"componentType", 5123}}},
        {"values", {{"bufferView", d.json["accessors"][value]["bufferView"]}}}};
    const Json attributes{
        {"POSITION", d.add_positions(positions)},
        {"COLOR_0", colors},
        {"NORMAL", d.add(Vectors(6, {0, 0, 1}))},
        {"TEXCOORD_0", d.add(std::vector<glm::vec2>{{0, 1}, {1, 1}, {0, 0}, {0, 1}, {1, 1}, {0, 0}},
                             5126, "VEC2")}};
    const Json target{{"POSITION", d.add_positions(deltas)}};
    Json primitives = Json::array();
    for (const std::vector<std::uint16_t>& indices :
         {std::vector<std::uint16_t>{0, 1, 2}, std::vector<std::uint16_t>{3, 4, 5}})
        primitives.push_back({{"attributes", attributes},
                              {"indices", d.add(indices, 5123, "SCALAR")},
                              {"targets", {target}}});
    d.json["meshes"] = {{{"primitives", primitives}}};
    const SavedTargets saved = prepared(d);
    for (std::size_t p = 0; p < 2; ++p) {
        const auto written = saved.values(saved.primitive(p)["attributes"]["POSITION"]);
        const auto moved = saved.values(saved.primitive(p)["targets"][0]["POSITION"]);
        ASSERT_EQ(written.size(), 3u);
        ASSERT_EQ(moved.size(), 3u);
        const auto coloured = saved.values(saved.primitive(p)["attributes"]["COLOR_0"]);
        ASSERT_EQ(coloured.size(), 3u);
        for (std::size_t v = 0; v < 3; ++v) {
            EXPECT_EQ(coloured[v],
                      3 * p + v == 4 ? glm::vec4(0.25f, 0.5f, 0.75f, 1) : glm::vec4(0));
            EXPECT_EQ(glm::vec3(written[v]), positions[3 * p + v]);
            EXPECT_EQ(moved[v].z, deltas[3 * p + v].z);
        }
        // Tilted along x by 1 in 1: (1, 0, 0) becomes (1, 0, 1)/√2 before it is turned to the
        // plane of the normal, which the target leaves as it is.
        for (const glm::vec4& t : saved.values(saved.primitive(p)["targets"][0]["TANGENT"])) {
            EXPECT_NEAR(t.x, 0, 1e-6);
            EXPECT_NEAR(t.y, 0, 1e-6);
            EXPECT_NEAR(t.z, 0, 1e-6);
        }
    }
}

TEST(MorphTargets, TheFormatsValidatorFindsNoFault) {
    MESHPREP_REQUIRE_NPM(validator, "gltf-validator");
    for (const bool with_normals : {false, true}) {
        Document document = turning_square(with_normals);
        const test::TempDir dir;
        test::write_text(dir / "in.gltf", document.text());
        prep::PrepareOptions options;
        options.request.tangents = prep::Request::Level::always;
        const auto scene = prep::prepare(document.parse(), options);
        ASSERT_TRUE(scene.has_value());
        ASSERT_TRUE(prep::save_scene(*scene, dir / "out.glb").has_value());
        const Json list{{{"name", "turning square"},
                         {"input", (dir / "in.gltf").string()},
                         {"output", (dir / "out.glb").string()},
                         {"before", nullptr}}};
        EXPECT_TRUE(test::validates(validator, list, dir / "list.json"))
            << "its complaints stand above";
    }
}

// Targets that share their data cost a file three bytes each, and each of them a whole mesh when
// tangents are made: 2^26 vectors and 16 for each byte are the limit.
TEST(MorphTargets, ManyTimesTheirFileAreRefused) {
    constexpr std::uint32_t side = 200;
    constexpr std::size_t corners = 6 * side * side;
    Document d;
    Vectors positions;
    std::vector<glm::vec2> uvs;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i <= side; ++i) {
        for (std::uint32_t j = 0; j <= side; ++j) {
            positions.push_back({float(i), float(j), 0});
            uvs.push_back({float(i) / side, float(j) / side});
            if (i == side || j == side) continue;
            const std::uint32_t a = i * (side + 1) + j, b = a + side + 1;
            indices.insert(indices.end(), {a, b, b + 1, a, b + 1, a + 1});
        }
    }
    ASSERT_EQ(indices.size(), corners);
    const Json target{{"POSITION", d.add_positions(Vectors(positions.size(), {0, 0, 1}))}};
    const Json attributes{{"POSITION", d.add_positions(positions)},
                          {"TEXCOORD_0", d.add(uvs, 5126, "VEC2")}};
    const Json primitive{{"attributes", attributes}, {"indices", d.add(indices, 5125, "SCALAR")}};
    const auto prepare_with = [&](std::size_t targets) {
        d.json["meshes"] = {{{"primitives", {primitive}}}};
        Json& list = d.json["meshes"][0]["primitives"][0]["targets"];
        for (std::size_t t = 0; t < targets; ++t) list.push_back(target);
        prep::PrepareOptions options;
        options.request.tangents = prep::Request::Level::always;
        return prep::prepare(d.parse(), options);
    };
    const auto few = prepare_with(2);
    EXPECT_TRUE(few.has_value()) << prep::to_string(few.error());

    const auto many = prepare_with(1000);  // of 240,000 corners, in a file of about 4 MB
    ASSERT_FALSE(many.has_value());
    EXPECT_EQ(many.error().code, prep::ErrorCode::limit);
    EXPECT_NE(many.error().text.find("1000 morph targets of 240000 corners"), std::string::npos)
        << many.error().text;
}

TEST(MorphTargets, DeltasThatAreNotFiniteSpoilNothing) {
    Document document = turning_square(false);
    Json& targets = document.json["meshes"][0]["primitives"][0]["targets"];
    const float nan = std::numeric_limits<float>::quiet_NaN();
    targets[0]["POSITION"] = document.add(Vectors(4, {nan, 0, 0}));
    const SavedTargets saved = prepared(document);
    for (const glm::vec4& t : saved.values(saved.primitive()["targets"][0]["TANGENT"]))
        EXPECT_TRUE(std::isfinite(t.x + t.y + t.z));
}

}  // namespace
