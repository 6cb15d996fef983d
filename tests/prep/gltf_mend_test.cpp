#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "formats/gltf/values/value_repair.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/save.h"

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
    ASSERT_EQ(notes->size(), 1u);
    EXPECT_NE((*notes)[0].find("(accessors of the source: 3)"), std::string::npos) << (*notes)[0];
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

}  // namespace
