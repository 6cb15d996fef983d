// glTF files through prepare and back into glTF: what preparation does not change stays what it
// was, value by value, whatever the vertices become.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gltf_source.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/save.h"
#include "written_gltf.h"

namespace {

using Json = test::GltfFile::Json;
using Numbers = std::vector<double>;
using U8 = std::vector<std::uint8_t>;
using U16 = std::vector<std::uint16_t>;
using I16 = std::vector<std::int16_t>;
using test::GltfSource;

const std::vector<float> folded = {0, 0, 0, 1, 0, 0, 1, 1, 1, 0, 1, 0};  // two triangles, a fold

std::vector<float> ramp(std::size_t n, float first, float step) {
    std::vector<float> out;
    for (std::size_t i = 0; i < n; ++i) out.push_back(first + step * float(i));
    return out;
}

template <class T>
std::vector<T> whole_ramp(std::size_t n, std::size_t step) {
    std::vector<T> out;
    for (std::size_t i = 0; i < n; ++i) out.push_back(T(i * step));
    return out;
}

// Four vertices with every kind of attribute, in many component types.
Json attributes_of(GltfSource& d) {
    return Json{{"POSITION", d.add_positions(folded)},
                {"NORMAL", d.add_floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0})},
                {"TEXCOORD_0", d.add_floats("VEC2", {0, 1, 1, 1, 1, 0, 0, 0})},
                {"TEXCOORD_1", d.add("VEC2", whole_ramp<std::uint16_t>(8, 9000), true)},
                {"TEXCOORD_2", d.add("VEC2", U8{0, 0, 9, 8, 7, 6, 5, 4}, true)},
                {"COLOR_0", d.add("VEC4", whole_ramp<std::uint8_t>(16, 16), true)},
                {"COLOR_1", d.add_floats("VEC3", ramp(12, 0, 0.0625f))},
                {"JOINTS_0", d.add("VEC4", U8{0, 1, 0, 0, 1, 2, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0})},
                {"JOINTS_1", d.add("VEC4", U16{2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0})},
                {"WEIGHTS_0", d.add_floats("VEC4", {0.5f, 0.25f, 0, 0, 0.75f, 0.125f, 0, 0, 0.0625f,
                                                    0.1875f, 0, 0, 0.125f, 0.125f, 0, 0})},
                {"WEIGHTS_1", d.add_floats("VEC4", {0.25f, 0, 0, 0, 0.125f, 0, 0, 0, 0.75f, 0, 0, 0,
                                                    0.75f, 0, 0, 0})},
                {"_TEMPERATURE", d.add_floats("SCALAR", {20.5f, -3, 7, 1e30f})}};
}

// Each kind of data that a file refers to.
GltfSource everything() {
    GltfSource d;
    const std::size_t unused = d.add_floats("SCALAR", {1, 2, 3});
    EXPECT_EQ(unused, 0u);
    const Json attributes = attributes_of(d);
    Json targets = Json::array();
    targets.push_back({{"POSITION", d.add_positions(ramp(12, -1, 0.25f))},
                       {"TEXCOORD_0", d.add_floats("VEC2", ramp(8, 0.5f, 0.125f))}});
    // One of four elements, sparse: the others are what the view has.
    const std::size_t base = d.add_positions(ramp(12, 3, 0.5f));
    d.json["accessors"][base]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", d.add_bytes("\2\0", 2)}, {"componentType", 5123}}},
        {"values", {{"bufferView", d.add_bytes(folded.data() + 3, 12)}}}};
    d.json["accessors"][base]["min"] = {1, 0, 0};
    d.json["accessors"][base]["max"] = {7.5, 8, 8.5};
    targets.push_back(
        {{"POSITION", base}, {"COLOR_1", d.add_floats("VEC3", ramp(12, -0.5f, 0.1f))}});
    const auto elements = [&](U16 indices) { return d.add("SCALAR", indices); };
    Json mesh{
        {"name", "many"}, {"weights", {0.25, 0.5}}, {"extras", {{"targetNames", {"a", "b"}}}}};
    mesh["primitives"] = {{{"attributes", attributes},
                           {"indices", elements({0, 1, 2, 0, 2, 3})},
                           {"material", 1},
                           {"targets", targets},
                           {"extras", {{"kept", true}}}},
                          {{"attributes", attributes_of(d)},
                           {"indices", elements({3, 2, 1, 0})},
                           {"mode", 5},
                           {"targets", targets}},
                          {{"attributes", attributes_of(d)},
                           {"indices", elements({1, 2, 3, 0})},
                           {"mode", 6},
                           {"targets", targets}},
                          {{"attributes",
                            {{"POSITION", d.add_positions(folded)},
                             {"COLOR_0", d.add_floats("VEC3", ramp(12, 0, 0.0625f))}}},
                           {"indices", elements({0, 2, 1, 3})},
                           {"mode", 1},
                           {"targets", targets}},
                          {{"attributes",
                            {{"POSITION", d.add_positions(ramp(12, 1, 2))},
                             {"COLOR_1", d.add_floats("VEC3", ramp(12, 0, 0.0625f))}}},
                           {"mode", 0},
                           {"targets", targets}}};
    d.push("meshes", mesh);
    // Quantised positions: three 16-bit numbers and two bytes of padding.
    const std::size_t shorts = d.add("VEC3", I16{0, 0, 0, 32767, 0, 0, -32767, 32767, 99}, true);
    d.json["accessors"][shorts]["min"] = {-32767, 0, 0};
    d.json["accessors"][shorts]["max"] = {32767, 32767, 99};
    d.json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", shorts}}}}}}});

    const std::vector<float> times = {0, 0.5f, 2};
    d.json["animations"] = {
        {{"name", "wave"},
         {"extras", 3},
         {"channels",
          {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}},
           {{"sampler", 2}, {"target", {{"node", 2}, {"path", "translation"}}}},
           {{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}}}},
         {"samplers",
          {{{"input", d.add_floats("SCALAR", times)},
            {"output", d.add("VEC4", I16{0, 0, 0, 32767, 32767, 0, 0, 0, 0, 32767, 0, 0}, true)}},
           {{"input", d.add_floats("SCALAR", times)},
            {"interpolation", "STEP"},
            {"output", d.add_floats("SCALAR", ramp(6, 0, 0.125f))}},
           {{"input", d.add_floats("SCALAR", times)},
            {"interpolation", "CUBICSPLINE"},
            {"output", d.add_floats("VEC3", ramp(27, -3, 0.3f))}}}}}};
    for (const std::size_t k : {0u, 1u, 2u}) {
        auto& input =
            d.json["accessors"][d.json["animations"][0]["samplers"][k]["input"].get<std::size_t>()];
        input["min"] = {0};
        input["max"] = {2};
    }
    std::vector<float> inverse = ramp(48, 0.5f, 0.25f);
    for (const std::size_t j : {0u, 16u, 32u}) {
        for (const std::size_t k : {3u, 7u, 11u}) inverse[j + k] = 0;
        inverse[j + 15] = 1;
    }
    d.json["skins"] = {{{"joints", {1, 2, 3}},
                        {"skeleton", 1},
                        {"name", "bones"},
                        {"inverseBindMatrices", d.add("MAT4", inverse)}}};
    d.json["nodes"] = {
        {{"mesh", 0}, {"skin", 0}, {"name", "body"}, {"weights", {0.125, 1}}},
        {{"children", {2}}, {"rotation", {0, 0.6, 0, 0.8}}, {"extras", {{"bone", 1}}}},
        {{"children", {3}}, {"translation", {1, 2, 3}}, {"scale", {1, -2, 3}}},
        {{"name", "tip"}, {"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}},
        {{"mesh", 1},
         {"camera", 0},
         {"extensions",
          {{"KHR_lights_punctual", {{"light", 0}}},
           {"EXT_mesh_gpu_instancing",
            {{"attributes",
              {{"TRANSLATION", d.add_floats("VEC3", ramp(6, 9, 1))},
               {"_ID", d.add("SCALAR", std::vector<std::uint32_t>{7, 9})}}}}}}}}};
    d.json["scenes"] = {{{"nodes", {0, 1, 4}}, {"extras", {{"a", {1, nullptr, "x"}}}}}};
    d.json["scene"] = 0;
    d.json["cameras"] = {
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 2}, {"ymag", 3}, {"znear", 0.25}, {"zfar", 40.5}}}}};
    d.json["extensions"] = {{"KHR_lights_punctual",
                             {{"lights",
                               {{{"type", "spot"},
                                 {"color", {0.1, 0.2, 0.3}},
                                 {"intensity", 7.25},
                                 {"range", 11},
                                 {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.3}}}}}}}}};
    d.json["materials"] = {
        {{"name", "plain"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}}}},
        {{"name", "rich"},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.3},
         {"doubleSided", true},
         {"emissiveFactor", {0.3, 0.2, 0.1}},
         {"emissiveTexture", {{"index", 0}, {"texCoord", 1}}},
         {"pbrMetallicRoughness",
          {{"metallicFactor", 0.35},
           {"roughnessFactor", 0.65},
           {"baseColorTexture",
            {{"index", 0},
             {"extensions",
              {{"KHR_texture_transform",
                {{"offset", {0.1, 0.2}}, {"rotation", 0.3}, {"scale", {4, 5}}}}}}}}}},
         {"extensions",
          {{"KHR_materials_ior", {{"ior", 1.4}}},
           {"KHR_materials_emissive_strength", {{"emissiveStrength", 5.5}}}}},
         {"extras", {{"list", {1, 2, 3}}}}}};
    const std::string png = "\x89PNG\r\n\x1a\n, of which nobody asks more";
    d.json["images"] = {
        {{"bufferView", d.add_bytes(png.data(), png.size())}, {"mimeType", "image/png"}}};
    d.json["samplers"] = {
        {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9985}}};
    d.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
    d.json["extensionsUsed"] = {"KHR_lights_punctual",   "KHR_materials_ior",
                                "KHR_texture_transform", "KHR_materials_emissive_strength",
                                "KHR_mesh_quantization", "EXT_mesh_gpu_instancing"};
    d.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    d.json["asset"]["copyright"] = "nobody";
    d.json["asset"]["extras"] = {{"b", 0.1}};
    return d;
}

struct Rewritten {
    test::GltfFile before, after;
    std::vector<std::string> notes;
    prep::PreparedScene prepared;
    std::string difference(const std::vector<std::string>& ignored = {"NORMAL", "TANGENT"}) const {
        return test::gltf_difference(before, after, ignored);
    }
};

Rewritten rewritten(const GltfSource& source, const prep::PrepareOptions& options,
                    const std::string& to = "out.glb", const std::string& from = "in.glb") {
    const test::TempDir dir;
    source.write(dir / from);
    auto scene = prep::load_scene(dir / from);
    if (!scene) throw std::runtime_error(prep::to_string(scene.error()));
    auto prepared = prep::prepare(*std::move(scene), options);
    if (!prepared) throw std::runtime_error(prep::to_string(prepared.error()));
    auto notes = prep::save_scene(*prepared, dir / to);
    if (!notes) throw std::runtime_error(prep::to_string(notes.error()));
    Rewritten out{test::GltfFile(dir / from), test::GltfFile(dir / to), *std::move(notes),
                  *std::move(prepared)};
    EXPECT_EQ(out.after.fault(), "");
    return out;
}

prep::PrepareOptions nothing() {
    prep::PrepareOptions options;
    options.request.normals = options.request.tangents = prep::Request::Level::never;
    return options;
}

// Flat normals, and tangents for all that has UVs: nearly every vertex splits.
prep::PrepareOptions all_new() {
    prep::PrepareOptions options;
    options.request.normals = options.request.tangents = prep::Request::Level::always;
    options.normals = options.tangents = prep::Authored::replace;
    options.hard_edges.angle_degrees = 0;
    return options;
}

TEST(GltfRewrite, WithNothingToDoEveryValueStays) {
    for (const char* to : {"out.glb", "out.gltf"}) {
        const Rewritten out = rewritten(everything(), nothing(), to);
        EXPECT_EQ(out.difference({}), "");
        EXPECT_EQ(out.notes, std::vector<std::string>{});
        EXPECT_EQ(out.after.json["asset"]["copyright"], "nobody");
        EXPECT_NE(out.after.json["asset"]["generator"].get<std::string>().find("meshprep"),
                  std::string::npos);
        ASSERT_EQ(out.after.json["buffers"].size(), 1u);
    }
}

TEST(GltfRewrite, SplitVerticesTakeAllTheirAttributesAlong) {
    const Rewritten out = rewritten(everything(), all_new());
    EXPECT_EQ(out.difference(), "");
    // The fold is sharp: each half has its own normal.
    const auto normals = out.after.attribute(0, 0, "NORMAL");
    const auto triangles = out.after.triangles(0, 0);
    ASSERT_EQ(triangles.size(), 6u);
    EXPECT_EQ(normals.count(), 6u);
    const double r = std::sqrt(0.5);
    const Numbers expected[2] = {{0, -r, r}, {-r, 0, r}};
    for (std::size_t c = 0; c < 6; ++c)
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(normals.at(triangles[c])[k], expected[c / 3][k], 1e-6) << c;
    for (std::size_t p = 0; p < 3; ++p)
        EXPECT_TRUE(out.after.primitive(0, p)["attributes"].contains("TANGENT")) << p;
    for (const std::size_t p : {3u, 4u}) {
        EXPECT_FALSE(out.after.primitive(0, p)["attributes"].contains("NORMAL")) << p;
        EXPECT_EQ(out.after.primitive(0, p)["mode"], out.before.primitive(0, p)["mode"]);
    }
    // No primitive says strip or fan any more.
    for (std::size_t p = 0; p < 3; ++p) EXPECT_FALSE(out.after.primitive(0, p).contains("mode"));
}

// Those that no primitive, animation, skin or instance refers to.
std::size_t unused_accessors(const Json& json) {
    std::vector<bool> used(json["accessors"].size(), false);
    const auto mark_all = [&](const Json& list) {
        for (const Json& index : list) used.at(index.get<std::size_t>()) = true;
    };
    for (const Json& mesh : json["meshes"])
        for (const Json& p : mesh["primitives"]) {
            mark_all(p["attributes"]);
            if (p.contains("indices")) mark_all(Json::array({p["indices"]}));
            for (const Json& target : p.value("targets", Json::array())) mark_all(target);
        }
    for (const Json& animation : json["animations"])
        for (const Json& s : animation["samplers"])
            mark_all(Json::array({s["input"], s["output"]}));
    for (const Json& skin : json["skins"]) mark_all(Json::array({skin["inverseBindMatrices"]}));
    for (const Json& node : json["nodes"])
        mark_all(node.value("/extensions/EXT_mesh_gpu_instancing/attributes"_json_pointer,
                            Json::object()));
    return std::size_t(std::count(used.begin(), used.end(), false));
}

TEST(GltfRewrite, WhatNothingRefersToGoesUnlessAnExtensionMightReferToIt) {
    const Rewritten out = rewritten(everything(), nothing());
    EXPECT_EQ(unused_accessors(out.before.json), 1u);
    EXPECT_EQ(unused_accessors(out.after.json), 0u);
    std::size_t bytes = 0;
    for (const Json& view : out.after.json["bufferViews"])
        bytes += (view["byteLength"].get<std::size_t>() + 3) / 4 * 4;
    EXPECT_EQ(out.after.json["buffers"][0]["byteLength"], bytes);

    GltfSource source = everything();
    source.json["extensionsUsed"].push_back("VENDOR_unknown");
    source.json["extensions"]["VENDOR_unknown"] = {{"accessor", 0}};
    const Rewritten kept = rewritten(source, all_new());
    EXPECT_EQ(kept.difference(), "");
    EXPECT_EQ(kept.after.accessor(0).values, (Numbers{1, 2, 3}));
    for (std::size_t i = 0; i < kept.before.json["accessors"].size(); ++i)
        EXPECT_EQ(kept.after.accessor(i), kept.before.accessor(i)) << i;
    EXPECT_EQ(kept.notes,
              std::vector<std::string>{
                  "an extension is in use that may refer to any data: none was dropped"});
}

TEST(GltfRewrite, VerticesBeyond65535GetWideIndices) {
    for (const std::size_t vertices : {65535u, 65536u}) {
        GltfSource d;
        std::vector<float> positions;
        std::vector<std::uint32_t> indices;
        for (std::size_t v = 0; v < vertices; ++v) {
            positions.insert(positions.end(), {float(v / 3), float(v % 3), float(v % 3 * v % 7)});
            if (v < 65535) indices.push_back(std::uint32_t(v));
        }
        indices.insert(indices.end(), {0, 1, std::uint32_t(vertices - 1)});
        std::reverse(indices.begin(), indices.end());
        // One that is not finite is mended: all of the primitive is written anew.
        std::vector<float> uvs(2 * vertices, 0.25f);
        uvs[7] = std::numeric_limits<float>::infinity();
        const Json attributes{{"POSITION", d.add_positions(positions)},
                              {"TEXCOORD_0", d.add_floats("VEC2", uvs)}};
        d.json["meshes"] = {
            {{"primitives",
              {{{"attributes", attributes}, {"indices", d.add("SCALAR", indices)}}}}}};
        d.json["nodes"] = {{{"mesh", 0}}};
        const Rewritten out = rewritten(d, nothing());
        const auto written = out.after.accessor(out.after.primitive(0, 0)["indices"]);
        EXPECT_EQ(written.component_type, vertices == 65535 ? 5123 : 5125);
        EXPECT_EQ(out.after.attribute(0, 0, "TEXCOORD_0").at(3), (Numbers{0.25, 0}));
        const auto corners = out.after.triangles(0, 0);
        ASSERT_EQ(corners.size(), indices.size());
        const auto at = out.after.attribute(0, 0, "POSITION");
        for (std::size_t c = 0; c < corners.size(); c += 997)
            EXPECT_EQ(at.at(corners[c])[0], positions[3 * indices[c]]) << c;
    }
}

// Two primitives of one mesh, the first of a material with a normal map.
TEST(GltfRewrite, OnlyPrimitivesThatNeedTangentsGetThem) {
    GltfSource d;
    Json primitives = Json::array();
    for (const int material : {0, 1, 1}) {
        Json attributes{{"POSITION", d.add_positions(folded)},
                        {"TEXCOORD_0", d.add_floats("VEC2", {0, 1, 1, 1, 1, 0, 0, 0})}};
        primitives.push_back({{"attributes", attributes},
                              {"indices", d.add("SCALAR", U16{0, 1, 2, 0, 2, 3})},
                              {"material", material}});
    }
    // The third has some of its own, and keeps having some.
    primitives[2]["attributes"]["TANGENT"] =
        d.add_floats("VEC4", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
    d.json["meshes"] = {{{"primitives", primitives}}};
    d.json["nodes"] = {{{"mesh", 0}}};
    d.json["images"] = {{{"uri", "gone.png"}}};
    d.json["textures"] = {{{"source", 0}}};
    d.json["materials"] = {{{"normalTexture", {{"index", 0}}}}, {{"doubleSided", true}}};
    const auto has = [](const Rewritten& out, std::size_t p) {
        return out.after.primitive(0, p)["attributes"].contains("TANGENT");
    };
    const Rewritten out = rewritten(d, {});
    EXPECT_TRUE(has(out, 0));
    EXPECT_FALSE(has(out, 1));
    EXPECT_TRUE(has(out, 2));
    prep::PrepareOptions always;
    always.request.tangents = prep::Request::Level::always;
    EXPECT_TRUE(has(rewritten(d, always), 1));
    EXPECT_EQ(out.notes, std::vector<std::string>{
                             "image 0 could not be read: the output still names its file"});
    EXPECT_EQ(out.after.json["images"], (Json{{{"uri", "gone.png"}}}));
}

TEST(GltfRewrite, TangentsOfNormalsThatWereReplacedGo) {
    GltfSource d;
    d.json["meshes"] = {
        {{"primitives",
          {{{"attributes",
             {{"POSITION", d.add_positions(folded)},
              {"NORMAL", d.add_floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})},
              {"TANGENT", d.add_floats("VEC4", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1})}}},
            {"indices", d.add("SCALAR", U16{0, 1, 2, 0, 2, 3})}}}}}};
    d.json["nodes"] = {{{"mesh", 0}}};
    prep::PrepareOptions options;
    EXPECT_EQ(rewritten(d, options).difference({}), "");
    options.normals = prep::Authored::replace;
    const Rewritten out = rewritten(d, options);
    EXPECT_FALSE(out.after.primitive(0, 0)["attributes"].contains("TANGENT"));
    EXPECT_TRUE(out.after.primitive(0, 0)["attributes"].contains("NORMAL"));
}

// Pictures beside the source move into the buffer, as they are.
TEST(GltfRewrite, PicturesBesideTheFileMoveIntoIt) {
    const test::TempDir dir;
    test::write_text(dir / "a b.png", "\x89PNG\r\n\x1a\n, one");
    test::write_text(dir / "c.jpg", "\xff\xd8\xff, another");
    GltfSource d;
    d.json["images"] = {{{"uri", "a%20b.png"}}, {{"uri", "c.jpg"}, {"name", "see"}}};
    d.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
    d.json["materials"] = {{{"emissiveTexture", {{"index", 0}}}},
                           {{"emissiveTexture", {{"index", 1}}}}};
    d.write(dir / "in.gltf");
    const auto scene = prep::load_scene(dir / "in.gltf");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_TRUE(prep::save_scene(test::untouched(*scene), dir / "out.glb").has_value());
    const test::GltfFile out(dir / "out.glb");
    EXPECT_EQ(out.fault(), "");
    EXPECT_EQ(out.json["images"],
              (Json{{{"name", "a%20b.png"}, {"mimeType", "image/png"}, {"bufferView", 0}},
                    {{"name", "see"}, {"mimeType", "image/jpeg"}, {"bufferView", 1}}}));
    EXPECT_EQ(out.view_bytes(0), test::file_text(dir / "a b.png"));
    EXPECT_EQ(out.view_bytes(1), test::file_text(dir / "c.jpg"));
    EXPECT_EQ(out.json["materials"], Json(d.json["materials"]));
}

TEST(GltfRewrite, TrianglesThatAreNotFiniteAreLeftOutAndTheirVerticesWithThem) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    GltfSource d;
    std::vector<float> positions = folded;
    positions.insert(positions.end(), {5, nan, 5, 6, 6, 6});
    const std::size_t position = d.add_positions(positions);
    d.json["accessors"][position]["min"] = {0, 0, 0};
    d.json["accessors"][position]["max"] = {6, 6, 6};
    Json attributes{{"POSITION", position}, {"_ID", d.add_floats("SCALAR", ramp(6, 10, 1))}};
    d.json["meshes"] = {
        {{"primitives",
          {{{"attributes", attributes},
            {"indices", d.add("SCALAR", U16{0, 1, 2, 1, 4, 2, 0, 2, 3, 5, 0, 4, 4, 1, 0})}}}}}};
    d.json["nodes"] = {{{"mesh", 0}}};
    const Rewritten out = rewritten(d, nothing());
    const auto corners = out.after.triangles(0, 0);
    const std::vector<std::size_t> expected = {0, 1, 2, 0, 2, 3};
    ASSERT_EQ(corners.size(), expected.size());
    EXPECT_EQ(out.after.attribute(0, 0, "POSITION").count(), 4u);
    for (std::size_t c = 0; c < corners.size(); ++c)
        EXPECT_EQ(out.after.attribute(0, 0, "_ID").at(corners[c]),
                  Numbers{10.0 + double(expected[c])});
    EXPECT_EQ(out.notes,
              std::vector<std::string>{"3 triangles with a position that is not finite left out"});
}

TEST(GltfRewrite, EmptyListsGo) {
    GltfSource d;
    d.json["meshes"] = {{{"primitives",
                          {{{"attributes", {{"POSITION", d.add_positions(folded)}}},
                            {"indices", d.add("SCALAR", U16{0, 1, 2})}}}}}};
    d.json["nodes"] = {{{"mesh", 0}, {"children", Json::array()}}};
    d.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", Json::array()}, {"name", "empty"}}};
    d.json["cameras"] = Json::array();
    d.json["materials"] = Json::array();
    const Json json = rewritten(d, nothing()).after.json;
    EXPECT_FALSE(json.contains("cameras") || json.contains("materials"));
    EXPECT_EQ(json["nodes"], (Json{{{"mesh", 0}}}));
    EXPECT_EQ(json["scenes"], (Json{{{"nodes", {0}}}, {{"name", "empty"}}}));
}

}  // namespace
