#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "formats/gltf/values/value_repair.h"
#include "gltf_maker.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "written_gltf.h"

namespace {

using prep::detail::normalise_weights;
using prep::detail::RawAccessor;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

template <class T>
RawAccessor set_of(const std::vector<T>& values) {
    RawAccessor raw;
    raw.component_type = sizeof(T) == 1 ? 5121 : sizeof(T) == 2 ? 5123 : 5126;
    raw.width = 4;
    raw.normalized = sizeof(T) < 4;
    raw.count = values.size() / 4;
    raw.bytes = prep::detail::SharedBytes::of(values);
    return raw;
}

template <class T>
std::vector<T> values_of(const RawAccessor& raw) {
    std::vector<T> values(raw.bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), raw.bytes.data(), raw.bytes.size());
    return values;
}

using Bytes = std::vector<std::uint8_t>;
using Shorts = std::vector<std::uint16_t>;
using Floats = std::vector<float>;

bool normalise(std::vector<RawAccessor*> sets) {
    return normalise_weights(sets);
}

TEST(SkinWeights, BytesAddUpTo255ByLargestRemainder) {
    // 100 + 50 + 50 → 127.5 + 63.75 + 63.75: the two larger remainders get the two steps.
    RawAccessor raw = set_of<std::uint8_t>({100, 50, 50, 0, 0, 0, 0, 0, 255, 0, 0, 0, 1, 1, 1, 0});
    EXPECT_TRUE(normalise({&raw}));
    EXPECT_EQ(values_of<std::uint8_t>(raw),
              (Bytes{127, 64, 64, 0, 0, 0, 0, 0, 255, 0, 0, 0, 85, 85, 85, 0}));
    EXPECT_FALSE(normalise({&raw}));
}

TEST(SkinWeights, ShortsAddUpTo65535) {
    RawAccessor raw = set_of<std::uint16_t>({1, 1, 0, 0, 65535, 65535, 0, 1});
    EXPECT_TRUE(normalise({&raw}));
    // 32767.5 each: the earlier gets the step. 32767.25 twice and 0.499996: the last gets it.
    EXPECT_EQ(values_of<std::uint16_t>(raw), (Shorts{32768, 32767, 0, 0, 32767, 32767, 0, 1}));
}

TEST(SkinWeights, SeveralSetsAreScaledTogether) {
    RawAccessor a = set_of<float>({0.5f, 0.25f, 0, 0}), b = set_of<float>({0.25f, 1, 0, 0});
    EXPECT_TRUE(normalise({&a, &b}));
    EXPECT_EQ(values_of<float>(a), (Floats{0.25f, 0.125f, 0, 0}));
    EXPECT_EQ(values_of<float>(b), (Floats{0.125f, 0.5f, 0, 0}));
    RawAccessor c = set_of<std::uint8_t>({200, 0, 0, 0}),
                d = set_of<std::uint8_t>({100, 0, 0, 100});
    EXPECT_TRUE(normalise({&c, &d}));
    EXPECT_EQ(values_of<std::uint8_t>(c), (Bytes{127, 0, 0, 0}));
    EXPECT_EQ(values_of<std::uint8_t>(d), (Bytes{64, 0, 0, 64}));
}

TEST(SkinWeights, InAMixTheFinerTakeWhatIsLeft) {
    RawAccessor bytes = set_of<std::uint8_t>({100, 50, 50, 0}),
                floats = set_of<float>({0, 0, 0, 0});
    EXPECT_TRUE(normalise({&bytes, &floats}));  // floats of 0 are no weights
    EXPECT_EQ(values_of<std::uint8_t>(bytes), (Bytes{127, 64, 64, 0}));
    EXPECT_EQ(values_of<float>(floats), (Floats{0, 0, 0, 0}));

    bytes = set_of<std::uint8_t>({255, 0, 0, 0});
    floats = set_of<float>({0, 1, 0, 0});
    EXPECT_TRUE(normalise({&floats, &bytes}));                         // in either order
    EXPECT_EQ(values_of<std::uint8_t>(bytes), (Bytes{127, 0, 0, 0}));  // 127.5 rounded down
    EXPECT_EQ(values_of<float>(floats), (Floats{0, float(128 / 255.0), 0, 0}));

    bytes = set_of<std::uint8_t>({255, 0, 0, 0});
    RawAccessor shorts = set_of<std::uint16_t>({65535, 0, 0, 0});
    EXPECT_TRUE(normalise({&bytes, &shorts}));
    EXPECT_EQ(values_of<std::uint8_t>(bytes), (Bytes{127, 0, 0, 0}));
    EXPECT_EQ(values_of<std::uint16_t>(shorts), (Shorts{128 * 257, 0, 0, 0}));
}

// Any weights: integers add up exactly, none moves by more than its share allows, zeros stay.
TEST(SkinWeights, RandomVerticesAddUp) {
    std::mt19937 random(5);
    for (int k = 0; k < 20000; ++k) {
        Bytes values(8);
        int sum = 0;
        for (std::uint8_t& v : values) {
            v = random() % 3 == 0 ? std::uint8_t(0) : std::uint8_t(random() % 256);
            sum += v;
        }
        RawAccessor a = set_of(Bytes(values.begin(), values.begin() + 4));
        RawAccessor b = set_of(Bytes(values.begin() + 4, values.end()));
        EXPECT_EQ(normalise({&a, &b}), sum != 0 && sum != 255);
        Bytes after = values_of<std::uint8_t>(a);
        for (const std::uint8_t v : values_of<std::uint8_t>(b)) after.push_back(v);
        int total = 0;
        for (std::size_t i = 0; i < 8; ++i) {
            total += after[i];
            if (values[i] == 0) {
                EXPECT_EQ(after[i], 0);
            }
            if (sum > 0) {
                EXPECT_LT(std::abs(after[i] - values[i] * 255.0 / sum), 1.0);
            }
        }
        EXPECT_EQ(total, sum == 0 ? 0 : 255);
    }
}

// The validator of the format allows 2e-7 for each weight.
TEST(SkinWeights, SumsThatAreALittleOffAreScaled) {
    RawAccessor raw = set_of<float>({0.5f, 0.5005f, 0, 0, 0.5f, 0.499999f, 0, 0});
    EXPECT_TRUE(normalise({&raw}));
    const Floats after = values_of<float>(raw);
    EXPECT_NEAR(after[0], 0.5 / 1.0005, 1e-7);
    EXPECT_NEAR(after[1], 0.5005 / 1.0005, 1e-7);
    EXPECT_NEAR(after[4], 0.5 / 0.999999, 1e-7);
    EXPECT_NEAR(double(after[4]) + double(after[5]), 1, 1e-7);
}

TEST(SkinWeights, OddInputIsLeftAlone) {
    RawAccessor raw = set_of<std::uint8_t>({100, 50, 50, 0});
    raw.normalized = false;
    EXPECT_FALSE(normalise({&raw}));
    EXPECT_FALSE(normalise({}));
    RawAccessor none = set_of<float>({});
    EXPECT_FALSE(normalise({&none}));
    // Off by a rounding only.
    RawAccessor near = set_of<float>({0.3333333f, 0.3333333f, 0.3333333f, 0});
    EXPECT_FALSE(normalise({&near}));
}

// One triangle whose attributes are what the format forbids, through load, prepare and save.
struct OddFile {
    std::string json, bytes;
    std::string attributes, targets, views,
        accessors = R"({"bufferView":0,"componentType":5126,"count":3,)"
                    R"("type":"VEC3","min":[0,0,0],"max":[1,1,0]})";
    int count = 1;
    std::string more;  // members of the file

    OddFile() {
        const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        add_bytes(positions, 36);
    }
    void add_bytes(const void* data, std::size_t size) {
        views += (views.empty() ? "" : ",") + std::string(R"({"buffer":0,"byteOffset":)") +
                 std::to_string(bytes.size()) + R"(,"byteLength":)" + std::to_string(size) + "}";
        bytes.append(static_cast<const char*>(data), size);
    }
    template <class T>
    void add(const std::string& name, const std::string& type, const std::vector<T>& values) {
        add_bytes(values.data(), values.size() * sizeof(T));
        accessors += R"(,{"bufferView":)" + std::to_string(count) + R"(,"componentType":)" +
                     (sizeof(T) == 1 ? "5121" : "5126") + R"(,"count":3,"type":")" + type + "\"" +
                     (sizeof(T) == 1 && name[0] == 'W' ? R"(,"normalized":true)" : "") + "}";
        attributes += ",\"" + name + "\":" + std::to_string(count++);
    }
    prep::Result<std::vector<std::string>> save(const test::TempDir& dir) const {
        test::write_text(
            dir / "in.gltf",
            R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0)" +
                attributes + "}" +
                (targets.empty() ? std::string() : ",\"targets\":[{" + targets + "}]") +
                R"(}]}],"accessors":[)" + accessors + R"(],"bufferViews":[)" + views +
                R"(],"buffers":[{"uri":"in.bin","byteLength":)" + std::to_string(bytes.size()) +
                "}]" + more + "}");
        test::write_text(dir / "in.bin", bytes);
        auto scene = prep::load_scene(dir / "in.gltf");
        if (!scene) return std::move(scene).error();
        return prep::save_scene(test::untouched(*std::move(scene)), dir / "out.gltf");
    }
};

TEST(GltfMend, ForbiddenValuesAreReplacedAndNamed) {
    OddFile file;
    file.add<float>("NORMAL", "VEC3", {0, 0, 1, nan, 0, 1, 0, 0, 1});
    file.add<float>("TANGENT", "VEC4", {1, 0, 0, 1, inf, 0, 0, 1, 1, 0, 0, nan});
    file.add<float>("TEXCOORD_0", "VEC2", {0.5f, nan, -inf, 2, 3, 4});
    file.add<float>("COLOR_0", "VEC3", {2, nan, -1, 0.5f, 1, 0, inf, -inf, 0.25f});
    file.add<std::uint8_t>("JOINTS_0", "VEC4", std::vector<std::uint8_t>(12, 0));
    file.add<float>("WEIGHTS_0", "VEC4", {0.5f, 0.5f, nan, -1, 2, 0, 0, 0, 1, 0, 0, 0});
    const test::TempDir dir;
    const auto notes = file.save(dir);
    ASSERT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    EXPECT_EQ(*notes, (std::vector<std::string>{
                          "UVs that are not finite were written as 0",
                          "vertex colours outside 0 … 1 were clamped",
                          "skin weights that are negative or not finite were written as 0",
                          "skin weights that do not add up to 1 were rescaled",
                          "normals that are not finite were written as (0, 0, 1)",
                          "tangents that are not finite were replaced by any in the surface",
                          "signs of tangents that are not finite were written as 1"}));
    const auto out = prep::load_scene(dir / "out.gltf");
    ASSERT_TRUE(out.has_value()) << prep::to_string(out.error());
    const prep::Mesh& mesh = out->meshes[0];
    EXPECT_EQ(mesh.uvs[0].values, (std::vector<glm::vec2>{{0.5f, 0}, {0, 2}, {3, 4}}));
    EXPECT_EQ(mesh.colors[0].values,
              (std::vector<glm::vec4>{{1, 0, 0, 1}, {0.5f, 1, 0, 1}, {1, 0, 0.25f, 1}}));
    EXPECT_EQ(mesh.normals.values, std::vector<glm::vec3>(3, glm::vec3(0, 0, 1)));
    for (const glm::vec4& t : mesh.tangents.values) {
        EXPECT_EQ(t.z, 0.0f);
        EXPECT_EQ(glm::length(glm::vec3(t)), 1.0f);
        EXPECT_EQ(t.w, 1.0f);
    }
    const std::string binary = test::file_text(dir / "out.bin");
    const float weights[12] = {0.5f, 0.5f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    EXPECT_NE(binary.find(std::string(reinterpret_cast<const char*>(weights), 48)),
              std::string::npos);
}

TEST(GltfMend, WhatMorphTargetsAddToColoursKeepsItsSign) {
    OddFile file;
    file.add<float>("COLOR_0", "VEC3", {1, 0, 1, 0.5f, 1, 0, 1, 0, 0.25f});
    const std::vector<float> deltas = {-0.5f, 0.25f, 2, 0, 0, 0, -1, 0, 0};
    const std::string own = file.attributes;
    file.add<float>("COLOR_0", "VEC3", deltas);
    file.targets = file.attributes.substr(own.size() + 1);
    file.attributes = own;
    const test::TempDir dir;
    const auto notes = file.save(dir);
    ASSERT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    EXPECT_EQ(*notes, std::vector<std::string>{});
    EXPECT_NE(test::file_text(dir / "out.bin")
                  .find(std::string(reinterpret_cast<const char*>(deltas.data()), 36)),
              std::string::npos);
}

TEST(GltfMend, OddValuesThatAreCarriedOverAreTold) {
    OddFile file;
    const std::string own = file.attributes;
    file.add<float>("TIMES", "SCALAR", {0, 1, 2});
    file.add<float>("GOOD", "VEC3", {0, 0, 0, 1, 1, 1, 2, 2, 2});
    file.add<float>("ODD", "VEC3", {0, 0, 0, 1, nan, 1, 2, 2, 2});
    file.attributes = own;
    const auto channel = [](const char* path, int sampler) {
        return std::string(R"({"target":{"node":0,"path":")") + path + R"("},"sampler":)" +
               std::to_string(sampler) + "}";
    };
    file.more = R"(,"animations":[{"samplers":[{"input":1,"output":2},{"input":1,"output":3}],)"
                R"("channels":[)" +
                channel("translation", 0) + "," + channel("scale", 1) + "]}]";
    const test::TempDir dir;
    const auto notes = file.save(dir);
    ASSERT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    ASSERT_EQ(notes->size(), 2u);
    EXPECT_NE((*notes)[0].find("(accessors of the source: 3)"), std::string::npos) << (*notes)[0];
    EXPECT_NE((*notes)[1].find("bounds"), std::string::npos) << (*notes)[1];
}

TEST(GltfMend, NormalsOfPointsThatOtherFormatsDoNotKeepAreTold) {
    OddFile file;
    file.add<float>("NORMAL", "VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
    file.attributes += R"(},"mode":0,"extras":{"a":0)";
    const test::TempDir dir;
    const auto kept = file.save(dir);
    ASSERT_TRUE(kept.has_value()) << prep::to_string(kept.error());
    EXPECT_EQ(*kept, std::vector<std::string>{});
    auto scene = prep::load_scene(dir / "in.gltf");
    ASSERT_TRUE(scene.has_value());
    const auto notes = prep::save_scene(test::untouched(*std::move(scene)), dir / "out.ply");
    ASSERT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    ASSERT_EQ(notes->size(), 1u);
    EXPECT_NE((*notes)[0].find("those of 1 primitive were left out"), std::string::npos);
}

TEST(GltfMend, GoodValuesKeepTheirBytesWithoutANote) {
    OddFile file;
    file.add<float>("TEXCOORD_0", "VEC2", {0.5f, 1e30f, -7, 2, 3, 4});
    file.add<std::uint8_t>("JOINTS_0", "VEC4", std::vector<std::uint8_t>(12, 0));
    file.add<std::uint8_t>("WEIGHTS_0", "VEC4", {255, 0, 0, 0, 127, 128, 0, 0, 0, 0, 0, 255});
    const test::TempDir dir;
    const auto notes = file.save(dir);
    ASSERT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    EXPECT_EQ(*notes, std::vector<std::string>{});
    EXPECT_EQ(test::file_text(dir / "out.bin"), file.bytes);
}

// A triangle with normals, so that nothing of it is written anew, and an animation. Views of vertex
// data are without strides; `positions` has a view of its own.
struct CarriedFile : test::GltfMaker {
    std::size_t positions = accessor(Floats{0, 0, 0, 4, 0, 0, 0, 2, 0}, "VEC3");
    Json attributes{{"POSITION", positions},
                    {"NORMAL", accessor(Floats{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")}};
    std::size_t times = accessor(Floats{0, 1, 2.5f}, "SCALAR");

    CarriedFile() {
        set_bounds({0, 0, 0}, {4, 2, 0});
        json["accessors"][times]["min"] = {0};
        json["accessors"][times]["max"] = {2.5};
    }
    void set_bounds(const Json& low, const Json& high) {
        json["accessors"][positions]["min"] = low;
        json["accessors"][positions]["max"] = high;
    }
    // An accessor of three elements in a view that is there.
    std::size_t part(std::size_t view, std::size_t offset, const char* type, int component = 5126,
                     std::size_t count = 3) {
        return accessor({{"bufferView", view},
                         {"byteOffset", offset},
                         {"componentType", component},
                         {"normalized", component != 5126},
                         {"count", count},
                         {"type", type}});
    }
    void finish() {
        mesh(Json::array({{{"attributes", attributes}}}));
        const std::size_t moves = accessor(Floats{0, 0, 0, 1, 0, 0, 2, 0, 0}, "VEC3");
        push("animations",
             {{"samplers", Json::array({{{"input", times}, {"output", moves}}})},
              {"channels", Json::array({{{"sampler", 0},
                                         {"target", {{"node", 0}, {"path", "translation"}}}}})}});
    }
};

// `judged`: by rules of the format that are written without a look at the code.
std::vector<std::string> carry(const CarriedFile& made, const test::TempDir& dir,
                               bool judged = true) {
    test::write_text(dir / "in.glb", made.glb());
    auto scene = prep::load_scene(dir / "in.glb");
    if (!scene) return {"not read: " + prep::to_string(scene.error())};
    const auto notes = prep::save_scene(test::untouched(*std::move(scene)), dir / "out.glb");
    EXPECT_EQ(notes && judged ? test::GltfFile(dir / "out.glb").fault() : "", "");
    return notes ? *notes : std::vector<std::string>{"not saved: " + to_string(notes.error())};
}

const std::vector<std::string> bounds_note{
    "bounds of accessors that were missing or wrong were computed"};
const std::vector<std::string> views_note{
    "vertex data that was not aligned, or shared a view without a stride, got a stride or views of "
    "its own"};
const std::vector<std::string> extensions_note{
    "extensions that are used and were not declared are declared"};

TEST(GltfMend, BoundsOfWhatIsCarriedOverAreThoseOfItsValues) {
    const test::TempDir dir;
    using Json = test::GltfFile::Json;
    const auto bounds = [&](const char* key) {
        const test::GltfFile out(dir / "out.glb");
        return out
            .json["accessors"][out.primitive(0, 0)["attributes"]["POSITION"].get<std::size_t>()]
            .value(key, Json());
    };
    CarriedFile good;
    good.finish();
    EXPECT_EQ(carry(good, dir), std::vector<std::string>{});
    CarriedFile wrong;
    wrong.set_bounds({0, 0, 0}, {4, 1.5, 0});
    wrong.finish();
    EXPECT_EQ(carry(wrong, dir), bounds_note);
    EXPECT_EQ(bounds("min"), Json({0, 0, 0}));
    EXPECT_EQ(bounds("max"), Json({4, 2, 0}));
    CarriedFile missing;
    missing.json["accessors"][missing.positions].erase("min");
    missing.finish();
    EXPECT_EQ(carry(missing, dir), bounds_note);
    EXPECT_EQ(bounds("min"), Json({0, 0, 0}));
    CarriedFile timeless;
    timeless.json["accessors"][timeless.times].erase("max");
    timeless.finish();
    EXPECT_EQ(carry(timeless, dir), bounds_note);
    const test::GltfFile out(dir / "out.glb");
    const auto input = out.json["animations"][0]["samplers"][0]["input"].get<std::size_t>();
    EXPECT_EQ(out.json["accessors"][input]["max"], Json({2.5}));
    // Of others bounds are only put right where there are any; large indices are no floats.
    CarriedFile others;
    const std::size_t normals = others.attributes["NORMAL"].get<std::size_t>();
    others.json["accessors"][normals]["min"] = {0, 0, -1};
    const std::size_t ids = others.accessor(std::vector<std::uint32_t>{16777217, 1, 2}, "SCALAR");
    others.json["accessors"][ids]["max"] = {16777217};
    others.attributes["_ID"] = ids;
    others.finish();
    EXPECT_EQ(carry(others, dir, false), bounds_note);  // the judge takes all for floats
    const test::GltfFile mended(dir / "out.glb");
    const Json& of = mended.primitive(0, 0)["attributes"];
    const Json& said = mended.json["accessors"][of["NORMAL"].get<std::size_t>()];
    EXPECT_EQ(said["min"], Json({0, 0, 1}));
    EXPECT_FALSE(said.contains("max"));
    EXPECT_EQ(mended.json["accessors"][of["_ID"].get<std::size_t>()]["max"], Json({16777217}));
}

TEST(GltfMend, CarriedVertexDataIsAlignedAndSharesNoViewWithoutAStride) {
    const test::TempDir dir;
    const auto uv = [&] {
        const test::GltfFile out(dir / "out.glb");
        return out.attribute(0, 0, "TEXCOORD_0").values;
    };
    const auto view = [&](const char* name) {
        const test::GltfFile out(dir / "out.glb");
        const auto a = out.primitive(0, 0)["attributes"][name].get<std::size_t>();
        EXPECT_EQ(out.json["accessors"][a].value("byteOffset", 0) % 4, 0);
        return out.json["accessors"][a]["bufferView"].get<std::size_t>();
    };
    // Three bytes each, one behind the other.
    CarriedFile tight;
    const Bytes colors{255, 0, 0, 0, 255, 0, 0, 0, 255};
    tight.attributes["COLOR_0"] = tight.part(tight.view(colors), 0, "VEC3", 5121);
    tight.finish();
    EXPECT_EQ(carry(tight, dir), views_note);
    const test::GltfFile out(dir / "out.glb");
    EXPECT_EQ(out.attribute(0, 0, "COLOR_0").values,
              (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
    EXPECT_EQ(out.json["bufferViews"][view("COLOR_0")]["byteStride"], 4);
    // At a multiple of two bytes.
    CarriedFile shifted;
    const Shorts shorts{7, 0, 0, 65535, 0, 0, 65535, 7};
    shifted.attributes["TEXCOORD_0"] = shifted.part(shifted.view(shorts), 2, "VEC2", 5123);
    shifted.finish();
    EXPECT_EQ(carry(shifted, dir), views_note);
    EXPECT_EQ(uv(), (std::vector<double>{0, 0, 1, 0, 0, 1}));
    EXPECT_EQ(view("TEXCOORD_0") != view("NORMAL"), true);
    // Two of one size in a view that says no stride get it; with one, they stay as they are.
    for (const std::size_t stride : {0, 8}) {
        CarriedFile shared;
        const std::size_t both =
            shared.view(Floats{0, 0, 1, 0, 0, 1, 0.5f, 0, 0, 0.5f, 0.5f, 0.5f}, stride);
        for (std::size_t k = 0; k < 2; ++k)
            shared.attributes["TEXCOORD_" + std::to_string(k)] = shared.part(both, 24 * k, "VEC2");
        shared.finish();
        EXPECT_EQ(carry(shared, dir), stride ? std::vector<std::string>{} : views_note);
        EXPECT_EQ(uv(), (std::vector<double>{0, 0, 1, 0, 0, 1}));
        EXPECT_EQ(view("TEXCOORD_0"), view("TEXCOORD_1"));
        EXPECT_EQ(
            test::GltfFile(dir / "out.glb").json["bufferViews"][view("TEXCOORD_0")]["byteStride"],
            8);
    }
    // Of two sizes: a view each.
    CarriedFile mixed;
    const std::size_t both = mixed.view(Floats{0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1});
    mixed.attributes["TEXCOORD_0"] = mixed.part(both, 0, "VEC2");
    mixed.attributes["COLOR_0"] = mixed.part(both, 24, "VEC3");
    mixed.finish();
    EXPECT_EQ(carry(mixed, dir), views_note);
    EXPECT_EQ(uv(), (std::vector<double>{0, 0, 1, 0, 0, 1}));
    EXPECT_NE(view("TEXCOORD_0"), view("COLOR_0"));
    // A view that others read as well, times of an animation here, gets no stride.
    CarriedFile others;
    const std::size_t all = others.view(Floats{0, 0, 1, 0, 0, 1, 0.5f, 0, 0, 0.5f, 1, 1, 0, 1, 2});
    others.attributes["TEXCOORD_0"] = others.part(all, 0, "VEC2");
    others.attributes["TEXCOORD_1"] = others.part(all, 24, "VEC2");
    others.times = others.part(all, 48, "SCALAR");
    others.json["accessors"][others.times]["min"] = {0};
    others.json["accessors"][others.times]["max"] = {2};
    others.finish();
    EXPECT_EQ(carry(others, dir), views_note);
    EXPECT_EQ(uv(), (std::vector<double>{0, 0, 1, 0, 0, 1}));
    EXPECT_NE(view("TEXCOORD_0"), view("TEXCOORD_1"));
    const test::GltfFile moved(dir / "out.glb");
    const auto input = moved.json["animations"][0]["samplers"][0]["input"].get<std::size_t>();
    EXPECT_EQ(moved.accessor(input).values, (std::vector<double>{0, 1, 2}));
    // Columns of byte matrices keep their room; that their view says no stride is told.
    CarriedFile matrices;
    const std::size_t view_of_both = matrices.view(Bytes(72, 7));
    matrices.attributes["_A"] = matrices.part(view_of_both, 0, "MAT3", 5121);
    matrices.attributes["_B"] = matrices.part(view_of_both, 36, "VEC4", 5121);
    matrices.finish();
    const auto told = carry(matrices, dir, false);
    ASSERT_EQ(told.size(), 2U);
    EXPECT_NE(told[1].find("was kept so: matrices"), std::string::npos) << told[1];
    EXPECT_EQ(test::GltfFile(dir / "out.glb").attribute(0, 0, "_A").values,
              std::vector<double>(27, 7.0 / 255));
    // Those that name the same bytes again and again are not copied for each.
    CarriedFile many;
    constexpr std::size_t vertices = 3000;
    const std::size_t same = many.view(Floats(3 * vertices, 0.5f));
    many.attributes["POSITION"] = many.accessor(Floats(3 * vertices, 0.0f), "VEC3");
    many.attributes["NORMAL"] = many.accessor(Floats(3 * vertices, 0.57735f), "VEC3");
    for (std::size_t k = 0; k < 200; ++k)
        many.attributes["_A" + std::to_string(k)] =
            many.part(same, 0, k % 2 ? "VEC2" : "VEC3", 5126, vertices);
    many.finish();
    const auto kept = carry(many, dir, false);
    EXPECT_NE(kept.back().find("four times the file's bytes"), std::string::npos) << kept.back();
    EXPECT_LT(std::filesystem::file_size(dir / "out.glb"),
              16 * std::filesystem::file_size(dir / "in.glb"));  // 50 times without a limit
}

TEST(GltfMend, ExtensionsThatAreUsedAreDeclared) {
    const test::TempDir dir;
    using Json = test::GltfFile::Json;
    const auto list = [&](const char* key) {
        return test::GltfFile(dir / "out.glb").json.value(key, Json());
    };
    CarriedFile lit;
    lit.finish();
    lit.json["materials"] = {{{"name", "m"},
                              {"extras", {{"extensions", {{"NOT_ONE", 1}}}}},
                              {"extensions", {{"KHR_materials_unlit", Json::object()}}}}};
    lit.json["extensionsUsed"] = {"KHR_texture_transform"};
    EXPECT_EQ(carry(lit, dir), extensions_note);
    EXPECT_EQ(list("extensionsUsed"), Json({"KHR_texture_transform", "KHR_materials_unlit"}));
    EXPECT_EQ(list("extensionsRequired"), Json());
    // What an extension that nobody knows refers to is kept, declared or not.
    CarriedFile unknown;
    unknown.finish();
    const std::size_t data = unknown.accessor(Floats{7, 8, 9}, "SCALAR");
    unknown.json["scenes"][0]["extensions"] = {{"ACME_data", {{"accessor", data}}}};
    carry(unknown, dir);
    EXPECT_EQ(list("extensionsUsed"), Json({"ACME_data"}));
    EXPECT_EQ(test::GltfFile(dir / "out.glb").accessor(data).values,
              (std::vector<double>{7, 8, 9}));
    // Positions of 16 bits are what KHR_mesh_quantization allows.
    CarriedFile whole;
    whole.attributes["POSITION"] =
        whole.accessor({{"bufferView", whole.view(Shorts{0, 0, 0, 0, 4, 0, 0, 0, 0, 2, 0, 0}, 8)},
                        {"componentType", 5123},
                        {"count", 3},
                        {"type", "VEC3"},
                        {"min", {0, 0, 0}},
                        {"max", {4, 2, 0}}});
    whole.finish();
    EXPECT_EQ(carry(whole, dir), extensions_note);
    EXPECT_EQ(list("extensionsUsed"), Json({"KHR_mesh_quantization"}));
    EXPECT_EQ(list("extensionsRequired"), Json({"KHR_mesh_quantization"}));
}

// Where a primitive is written anew (a vertex is not used), normals of bytes stay if they are as
// the format asks, and are made floats if not.
TEST(GltfMend, NormalsOfBytesStayWhereTheyAreUnit) {
    const test::TempDir dir;
    for (const int z : {127, 126, 64, 0}) {
        for (const bool normalized : {true, false}) {
            CarriedFile file;
            const auto step = std::int8_t(z);
            const std::vector<std::int8_t> bytes{0, 0, step, 0, 0, 0, step, 0,
                                                 0, 0, step, 0, 0, 0, step, 0};
            file.attributes["POSITION"] =
                file.accessor(Floats{0, 0, 0, 4, 0, 0, 0, 2, 0, 9, 9, 9}, "VEC3");
            file.attributes["NORMAL"] = file.accessor({{"bufferView", file.view(bytes, 4)},
                                                       {"componentType", 5120},
                                                       {"normalized", normalized},
                                                       {"count", 4},
                                                       {"type", "VEC3"}});
            file.json["extensionsUsed"] = {"KHR_mesh_quantization"};
            file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
            file.mesh(test::GltfMaker::Json::array(
                {{{"attributes", file.attributes},
                  {"indices", file.accessor(Shorts{0, 1, 2}, "SCALAR")}}}));
            auto read = file.read();
            ASSERT_TRUE(read) << to_string(read.error());
            const auto prepared = prep::prepare(*std::move(read));
            ASSERT_TRUE(prepared) << to_string(prepared.error());
            ASSERT_TRUE(prep::save_scene(*prepared, dir / "out.glb"));
            const test::GltfValues out = test::GltfFile(dir / "out.glb").attribute(0, 0, "NORMAL");
            ASSERT_EQ(out.count(), 3U);
            EXPECT_EQ(out.component_type, normalized && z == 127 ? 5120 : 5126) << z;
            EXPECT_EQ(out.at(0), (std::vector<double>{0, 0, 1})) << z;
        }
    }
}

}  // namespace
