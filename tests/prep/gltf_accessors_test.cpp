// The values of glTF accessors: component types, normalisation, strides, sparse values and
// compressed views, against the formulas of the glTF 2.0 specification (3.6.2, 3.11) and of
// EXT_meshopt_compression, written anew here.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "formats/gltf/document.h"
#include "gltf_maker.h"
#include "mesh_files.h"

namespace {

using Floats = std::vector<float>;
using Json = test::GltfMaker::Json;
using test::GltfMaker;

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
    return std::as_bytes(std::span(values));
}

Floats floats_of(const GltfMaker& maker, std::size_t accessor) {
    const auto scene = maker.read();
    EXPECT_TRUE(scene) << test::error_of(scene);
    if (!scene) return {};
    const auto raw = prep::detail::gltf_document(*scene)->raw_accessor(accessor);
    EXPECT_TRUE(raw);
    return raw ? prep::detail::to_floats(*raw) : Floats{};
}

template <class T>
Floats read_back(const std::vector<T>& values, bool normalized) {
    GltfMaker maker;
    return floats_of(maker, maker.accessor(values, "SCALAR", normalized));
}

Floats divided(const std::vector<double>& values, double by) {
    Floats out;
    for (const double v : values) out.push_back(float(v / by));
    return out;
}

TEST(GltfAccessors, NormalizedBytesAreDividedBy255) {
    EXPECT_EQ(read_back<std::uint8_t>({0, 1, 127, 128, 254, 255}, true),
              divided({0, 1, 127, 128, 254, 255}, 255));
}

TEST(GltfAccessors, NormalizedShortsAreDividedBy65535) {
    EXPECT_EQ(read_back<std::uint16_t>({0, 1, 32767, 32768, 65534, 65535}, true),
              divided({0, 1, 32767, 32768, 65534, 65535}, 65535));
}

TEST(GltfAccessors, NormalizedSignedBytesAreDividedBy127AndMinus128IsMinusOne) {
    EXPECT_EQ(read_back<std::int8_t>({-128, -127, -1, 0, 1, 126, 127}, true),
              divided({-127, -127, -1, 0, 1, 126, 127}, 127));
}

TEST(GltfAccessors, NormalizedSignedShortsAreDividedBy32767AndMinus32768IsMinusOne) {
    EXPECT_EQ(read_back<std::int16_t>({-32768, -32767, -1, 0, 1, 32766, 32767}, true),
              divided({-32767, -32767, -1, 0, 1, 32766, 32767}, 32767));
}

TEST(GltfAccessors, WholeNumbersThatAreNotNormalizedStayThemselves) {
    EXPECT_EQ(read_back<std::int8_t>({-128, 0, 127}, false), (Floats{-128, 0, 127}));
    EXPECT_EQ(read_back<std::uint8_t>({0, 1, 255}, false), (Floats{0, 1, 255}));
    EXPECT_EQ(read_back<std::int16_t>({-32768, 5, 32767}, false), (Floats{-32768, 5, 32767}));
    EXPECT_EQ(read_back<std::uint16_t>({0, 40000, 65535}, false), (Floats{0, 40000, 65535}));
    EXPECT_EQ(read_back<std::uint32_t>({0, 70000, 1u << 31}, false),
              (Floats{0, 70000, 2147483648.0f}));
    EXPECT_EQ(read_back<float>({-1.5f, 1e-30f, 3e38f}, false), (Floats{-1.5f, 1e-30f, 3e38f}));
}

TEST(GltfAccessors, QuantizedPositionsNormalsAndUvsReachTheMesh) {
    GltfMaker maker;
    const std::size_t positions =
        maker.accessor<std::int16_t>({-32768, 0, 32767, 32767, 0, 0, 0, 16384, 0}, "VEC3", true);
    const std::size_t normals =
        maker.accessor<std::int8_t>({0, 0, 127, 0, -128, 0, 127, 0, 0}, "VEC3", true);
    const std::size_t uvs = maker.accessor<std::uint16_t>({0, 65535, 13107, 0, 1, 2}, "VEC2", true);
    const std::size_t whole = maker.accessor<std::int8_t>({-3, 4, 5, 6, 7, -8}, "VEC2");
    maker.mesh({{{"attributes",
                  {{"POSITION", positions},
                   {"NORMAL", normals},
                   {"TEXCOORD_0", uvs},
                   {"TEXCOORD_1", whole}}}}});
    maker.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const prep::Mesh& mesh = scene->meshes[0];
    EXPECT_EQ(mesh.positions,
              (std::vector<glm::vec3>{{-1, 0, 1}, {1, 0, 0}, {0, float(16384 / 32767.0), 0}}));
    EXPECT_EQ(mesh.normals.values, (std::vector<glm::vec3>{{0, 0, 1}, {0, -1, 0}, {1, 0, 0}}));
    EXPECT_EQ(mesh.uvs[0].values,
              (std::vector<glm::vec2>{
                  {0, 1}, {float(13107 / 65535.0), 0}, {float(1 / 65535.0), float(2 / 65535.0)}}));
    EXPECT_EQ(mesh.uvs[1].values, (std::vector<glm::vec2>{{-3, 4}, {5, 6}, {7, -8}}));
}

// --- strides and offsets ---------------------------------------------------------------------

TEST(GltfAccessors, InterleavedElementsAreTakenByStrideAndOffset) {
    // Per vertex: 3 floats, 2 unsigned shorts. The view ends with the last element's last byte.
    GltfMaker maker;
    std::vector<std::byte> bytes;
    for (int v = 0; v < 3; ++v) {
        const Floats position = {float(v), float(10 * v), float(100 * v)};
        const std::vector<std::uint16_t> uv = {std::uint16_t(v + 1), std::uint16_t(v + 7)};
        bytes.insert(bytes.end(), bytes_of(position).begin(), bytes_of(position).end());
        bytes.insert(bytes.end(), bytes_of(uv).begin(), bytes_of(uv).end());
    }
    maker.view(Floats{-1, -2, -3});  // so that the next view does not start the buffer
    const std::size_t view = maker.view(bytes, 16);
    const std::size_t positions = maker.accessor(
        {{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    const std::size_t uvs = maker.accessor({{"bufferView", view},
                                            {"byteOffset", 12},
                                            {"componentType", 5123},
                                            {"count", 3},
                                            {"type", "VEC2"}});
    EXPECT_EQ(floats_of(maker, positions), (Floats{0, 0, 0, 1, 10, 100, 2, 20, 200}));
    EXPECT_EQ(floats_of(maker, uvs), (Floats{1, 7, 2, 8, 3, 9}));
}

TEST(GltfAccessors, ColumnsOfSmallMatricesStartAtMultiplesOfFourBytes) {
    GltfMaker maker;
    const auto add = [&](int component, const char* type, std::size_t view) {
        return maker.accessor(
            {{"bufferView", view}, {"componentType", component}, {"count", 2}, {"type", type}});
    };
    std::vector<std::uint8_t> mat2(16, 99), mat3(24, 99);
    std::vector<std::uint16_t> mat3s(24, 999);
    Floats expected2, expected3;
    for (std::size_t m = 0; m < 2; ++m) {
        for (std::size_t c = 0; c < 2; ++c)
            for (std::size_t r = 0; r < 2; ++r) {
                mat2[8 * m + 4 * c + r] = std::uint8_t(10 * m + 2 * c + r);
                expected2.push_back(float(10 * m + 2 * c + r));
            }
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t r = 0; r < 3; ++r) {
                mat3[12 * m + 4 * c + r] = std::uint8_t(10 * m + 3 * c + r);
                mat3s[12 * m + 4 * c + r] = std::uint16_t(10 * m + 3 * c + r);
                expected3.push_back(float(10 * m + 3 * c + r));
            }
    }
    const std::size_t a = add(5121, "MAT2", maker.view(mat2)),
                      b = add(5121, "MAT3", maker.view(mat3)),
                      c = add(5123, "MAT3", maker.view(mat3s));
    EXPECT_EQ(floats_of(maker, a), expected2);
    EXPECT_EQ(floats_of(maker, b), expected3);
    EXPECT_EQ(floats_of(maker, c), expected3);
}

// --- sparse ----------------------------------------------------------------------------------

struct Sparse {
    GltfMaker maker;
    std::size_t accessor = 0;

    // Five VEC2 (10·i, 10·i + 1), or zeros, with those of `indices` replaced by (−i, −i − ½). The
    // sparse data lie behind four bytes of their views that are not theirs.
    template <class T>
    Sparse(const std::vector<T>& indices, bool has_base) {
        std::vector<T> numbers(4 / sizeof(T), T(0));
        numbers.insert(numbers.end(), indices.begin(), indices.end());
        Floats base, values{77};
        for (int i = 0; i < 5; ++i) base.insert(base.end(), {float(10 * i), float(10 * i + 1)});
        for (const T i : indices) values.insert(values.end(), {-float(i), -float(i) - 0.5f});
        Json json{{"componentType", 5126}, {"count", 5}, {"type", "VEC2"}};
        if (has_base) json["bufferView"] = maker.view(base);
        json["sparse"] = {{"count", indices.size()},
                          {"indices",
                           {{"bufferView", maker.view(numbers)},
                            {"byteOffset", 4},
                            {"componentType", test::gltf_component_type<T>()}}},
                          {"values", {{"bufferView", maker.view(values)}, {"byteOffset", 4}}}};
        accessor = maker.accessor(json);
    }
};

TEST(GltfAccessors, SparseValuesReplaceThoseOfTheirIndices) {
    const Floats expected = {0, 1, -1, -1.5f, 20, 21, 30, 31, -4, -4.5f};
    const Sparse bytes(std::vector<std::uint8_t>{1, 4}, true);
    const Sparse shorts(std::vector<std::uint16_t>{1, 4}, true);
    const Sparse words(std::vector<std::uint32_t>{1, 4}, true);
    EXPECT_EQ(floats_of(bytes.maker, bytes.accessor), expected);
    EXPECT_EQ(floats_of(shorts.maker, shorts.accessor), expected);
    EXPECT_EQ(floats_of(words.maker, words.accessor), expected);
}

TEST(GltfAccessors, SparseWithoutAViewReplacesZeros) {
    const Sparse sparse(std::vector<std::uint16_t>{0, 2, 3}, false);
    EXPECT_EQ(floats_of(sparse.maker, sparse.accessor),
              (Floats{-0.0f, -0.5f, 0, 0, -2, -2.5f, -3, -3.5f, 0, 0}));
}

TEST(GltfAccessors, SparseIndicesMustAscendStrictly) {
    for (const std::vector<std::uint16_t>& indices :
         {std::vector<std::uint16_t>{2, 2}, std::vector<std::uint16_t>{3, 1}}) {
        const auto scene = Sparse(indices, true).maker.read();
        EXPECT_NE(test::error_of(scene).find("/accessors/0/sparse/indices"), std::string::npos)
            << test::error_of(scene);
        EXPECT_NE(test::error_of(scene).find("must ascend"), std::string::npos);
    }
}

TEST(GltfAccessors, SparseIndicesEndBeforeTheAccessorsCount) {
    const auto scene = Sparse(std::vector<std::uint16_t>{1, 5}, true).maker.read();
    EXPECT_NE(test::error_of(scene).find("index 5 is out of range"), std::string::npos)
        << test::error_of(scene);
    const Sparse last(std::vector<std::uint16_t>{4}, true);
    EXPECT_EQ(floats_of(last.maker, last.accessor)[8], -4);
}

// Two primitives that share a sparse accessor and use different vertices of it.
TEST(GltfAccessors, SparseValuesAreThoseOfTheVerticesThatAPrimitiveUses) {
    GltfMaker maker;
    Json json{{"componentType", 5126}, {"count", 6}, {"type", "VEC3"}};
    Floats base;
    for (int i = 0; i < 6; ++i) base.insert(base.end(), {float(i), 0, 0});
    json["bufferView"] = maker.view(base);
    json["sparse"] = {
        {"count", 2},
        {"indices",
         {{"bufferView", maker.view(std::vector<std::uint8_t>{1, 4})}, {"componentType", 5121}}},
        {"values", {{"bufferView", maker.view(Floats{1, 1, 1, 4, 4, 4})}}}};
    const std::size_t positions = maker.accessor(json);
    const std::size_t first = maker.accessor<std::uint8_t>({0, 1, 2}, "SCALAR");
    const std::size_t second = maker.accessor<std::uint8_t>({3, 4, 5}, "SCALAR");
    maker.mesh({{{"attributes", {{"POSITION", positions}}}, {"indices", first}},
                {{"attributes", {{"POSITION", positions}}}, {"indices", second}}});
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const prep::Mesh& mesh = scene->meshes[0];
    std::vector<glm::vec3> corners;
    for (const std::uint32_t v : mesh.corner_vertices) corners.push_back(mesh.positions[v]);
    EXPECT_EQ(corners, (std::vector<glm::vec3>{
                           {0, 0, 0}, {1, 1, 1}, {2, 0, 0}, {3, 0, 0}, {4, 4, 4}, {5, 0, 0}}));
}

// --- EXT_meshopt_compression -----------------------------------------------------------------

TEST(GltfMeshopt, VertexBuffersComeBackByteForByte) {
    GltfMaker maker;
    Floats values;
    for (int i = 0; i < 100; ++i)
        values.insert(values.end(), {std::sin(float(i)), float(i * i), -float(i) / 3});
    maker.view(Floats{1, 2});
    const std::size_t view = maker.meshopt_view("ATTRIBUTES", "NONE", 100, 12, bytes_of(values));
    const std::size_t accessor = maker.accessor(
        {{"bufferView", view}, {"componentType", 5126}, {"count", 100}, {"type", "VEC3"}});
    EXPECT_EQ(floats_of(maker, accessor), values);
}

template <class T>
void expect_triangles_and_sequences(const std::vector<T>& indices) {
    GltfMaker maker;
    maker.view(Floats{1, 2});
    for (const char* mode : {"TRIANGLES", "INDICES"}) {
        const std::size_t view =
            maker.meshopt_view(mode, "", indices.size(), sizeof(T), bytes_of(indices));
        maker.accessor({{"bufferView", view},
                        {"componentType", test::gltf_component_type<T>()},
                        {"count", indices.size()},
                        {"type", "SCALAR"}});
    }
    const Floats triangles = floats_of(maker, 0), sequence = floats_of(maker, 1);
    const Floats expected(indices.begin(), indices.end());
    EXPECT_EQ(sequence, expected);
    // The triangle codec may turn a triangle's corners round, no more.
    ASSERT_EQ(triangles.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); i += 3) {
        std::size_t k = 0;
        while (k < 3 && triangles[i + k] != expected[i]) ++k;
        ASSERT_LT(k, 3u);
        EXPECT_EQ(triangles[i + (k + 1) % 3], expected[i + 1]);
        EXPECT_EQ(triangles[i + (k + 2) % 3], expected[i + 2]);
    }
}

TEST(GltfMeshopt, TrianglesAndIndexSequencesKeepTheirOrder) {
    expect_triangles_and_sequences<std::uint16_t>({0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 40000});
    expect_triangles_and_sequences<std::uint32_t>({0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 70000});
}

// x and y of a unit vector's octahedral map, in steps of 1/one; z by the third component.
template <class T>
std::vector<double> octahedral(const std::vector<T>& in) {
    const double one = in[2];
    double x = in[0] / one, y = in[1] / one;
    const double z = 1 - std::abs(x) - std::abs(y), t = std::max(-z, 0.0);
    x -= x >= 0 ? t : -t;
    y -= y >= 0 ? t : -t;
    const double length = std::sqrt(x * x + y * y + z * z);
    return {x / length, y / length, z / length, double(in[3])};
}

template <class T>
void expect_octahedral(const std::vector<std::vector<T>>& inputs, double largest) {
    GltfMaker maker;
    std::vector<T> flat;
    for (const std::vector<T>& in : inputs) flat.insert(flat.end(), in.begin(), in.end());
    const std::size_t view = maker.meshopt_view("ATTRIBUTES", "OCTAHEDRAL", inputs.size(),
                                                4 * sizeof(T), bytes_of(flat));
    const std::size_t accessor = maker.accessor({{"bufferView", view},
                                                 {"componentType", test::gltf_component_type<T>()},
                                                 {"count", inputs.size()},
                                                 {"type", "VEC4"},
                                                 {"normalized", true}});
    const Floats found = floats_of(maker, accessor);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const std::vector<double> expected = octahedral(inputs[i]);
        // The codec rounds to whole steps of 1/largest, by floats: half a step and a little.
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(double(found[4 * i + k]), expected[k], 0.51 / largest) << i << ", " << k;
        EXPECT_EQ(found[4 * i + 3], float(expected[3] / largest));
    }
}

TEST(GltfMeshopt, OctahedralFilterIsUndone) {
    expect_octahedral<std::int8_t>({{0, 0, 127, 127},
                                    {127, 0, 127, -127},
                                    {40, -30, 127, 0},
                                    {-100, 90, 127, 1},
                                    {-127, -127, 127, 2},
                                    {3, 2, 7, 5}},
                                   127);
    expect_octahedral<std::int16_t>({{0, 0, 2047, 32767},
                                     {-2047, 0, 2047, -32767},
                                     {700, -800, 2047, 0},
                                     {-1500, 1200, 2047, 9}},
                                    32767);
}

TEST(GltfMeshopt, QuaternionFilterIsUndone) {
    // Three components but the largest, in steps of 1/(√2 · one); the last word's low two bits
    // say which the largest is.
    const std::vector<std::int16_t> in = {0,    0,  0,    2047 & ~3, 300, -500, 700, 2044 | 1,
                                          -900, 20, 1100, 2044 | 2,  5,   6,    -7,  2044 | 3};
    const std::size_t count = in.size() / 4;
    GltfMaker maker;
    const std::size_t view = maker.meshopt_view("ATTRIBUTES", "QUATERNION", count, 8, bytes_of(in));
    const std::size_t accessor = maker.accessor({{"bufferView", view},
                                                 {"componentType", 5122},
                                                 {"count", count},
                                                 {"type", "VEC4"},
                                                 {"normalized", true}});
    const Floats found = floats_of(maker, accessor);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t largest = std::size_t(in[4 * i + 3] & 3);
        const double one = in[4 * i + 3] | 3;
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double c = in[4 * i + k] / one / std::sqrt(2.0);
            sum += c * c;
            EXPECT_NEAR(double(found[4 * i + (largest + 1 + k) % 4]), c, 0.51 / 32767) << i;
        }
        EXPECT_NEAR(double(found[4 * i + largest]), std::sqrt(1 - sum), 0.51 / 32767) << i;
    }
}

TEST(GltfMeshopt, ExponentialFilterIsUndone) {
    // 24 bits of mantissa, eight of exponent, both signed.
    const auto packed = [](int exponent, int mantissa) {
        return std::int32_t(std::uint32_t(exponent) << 24 | (std::uint32_t(mantissa) & 0xffffff));
    };
    const std::vector<std::int32_t> in = {packed(0, 5),    packed(-3, -7),     packed(10, 8388607),
                                          packed(-20, -1), packed(100, 3),     packed(-100, 1),
                                          packed(0, 0),    packed(4, -500000), packed(1, 1)};
    const Floats expected = {5,
                             -0.875f,
                             std::ldexp(8388607.0f, 10),
                             std::ldexp(-1.0f, -20),
                             std::ldexp(3.0f, 100),
                             std::ldexp(1.0f, -100),
                             0,
                             -8e6f,
                             2};
    GltfMaker maker;
    const std::size_t view = maker.meshopt_view("ATTRIBUTES", "EXPONENTIAL", 3, 12, bytes_of(in));
    const std::size_t accessor = maker.accessor(
        {{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    EXPECT_EQ(floats_of(maker, accessor), expected);
}

TEST(GltfMeshopt, WhatCannotBeDecodedIsRefusedAtItsPlace) {
    const std::string at = "/bufferViews/0/extensions/EXT_meshopt_compression";
    const Floats values(64, 1.0f);
    const auto error = [&](const std::string& key, const Json& value) {
        GltfMaker maker;
        const std::size_t view = maker.meshopt_view("ATTRIBUTES", "NONE", 16, 16, bytes_of(values));
        maker.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value;
        const std::size_t positions = maker.accessor(
            {{"bufferView", view}, {"componentType", 5126}, {"count", 12}, {"type", "VEC3"}});
        maker.mesh({{{"attributes", {{"POSITION", positions}}}}});
        return test::error_of(maker.read());
    };
    EXPECT_EQ(error("filter", "NONE"), "no error");
    EXPECT_NE(error("mode", "STRIPS").find(at + "/mode"), std::string::npos);
    EXPECT_NE(error("filter", "ZIP").find(at + "/filter"), std::string::npos);
    EXPECT_NE(error("filter", "QUATERNION").find(at + "/byteStride"), std::string::npos);
    EXPECT_NE(error("filter", "OCTAHEDRAL").find(at + "/byteStride"), std::string::npos);
    EXPECT_NE(error("mode", "TRIANGLES").find(at + "/byteStride"), std::string::npos);
    EXPECT_NE(error("byteOffset", 1).find(at + "/byteLength"), std::string::npos);
    EXPECT_NE(error("byteLength", 3).find("cannot be decoded"), std::string::npos);
}

// --- set numbers -----------------------------------------------------------------------------

TEST(GltfAccessors, SetsHaveNumbersOfOneOrTwoDigits) {
    using prep::detail::set_number;
    EXPECT_EQ(set_number("TEXCOORD_0", "TEXCOORD_"), 0u);
    EXPECT_EQ(set_number("TEXCOORD_10", "TEXCOORD_"), 10u);
    EXPECT_EQ(set_number("JOINTS_07", "JOINTS_"), 7u);
    EXPECT_EQ(set_number("TEXCOORD_", "TEXCOORD_"), std::nullopt);
    EXPECT_EQ(set_number("TEXCOORD_100", "TEXCOORD_"), std::nullopt);
    EXPECT_EQ(set_number("TEXCOORD_1x", "TEXCOORD_"), std::nullopt);
    EXPECT_EQ(set_number("_TEXCOORD_1", "TEXCOORD_"), std::nullopt);
}

}  // namespace
