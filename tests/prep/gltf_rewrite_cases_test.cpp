// glTF files whose vertices stay but whose triangles, normals or compression do not.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "formats/gltf/references.h"
#include "gltf_maker.h"
#include "gltf_source.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/save.h"
#include "written_gltf.h"

namespace {

using PlainJson = test::GltfFile::Json;
using Numbers = std::vector<double>;
using U16 = std::vector<std::uint16_t>;
using test::GltfSource;

const std::vector<float> square = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

test::GltfFile written(const prep::Result<prep::Scene>& scene, const prep::PrepareOptions& options,
                       std::vector<std::string>* notes = nullptr) {
    if (!scene) throw std::runtime_error(prep::to_string(scene.error()));
    auto prepared = prep::prepare(*scene, options);
    if (!prepared) throw std::runtime_error(prep::to_string(prepared.error()));
    const test::TempDir dir;
    prep::SaveOptions saving;
    saving.compression = prep::Compression::none;
    const auto told = prep::save_scene(*prepared, dir / "out.glb", saving);
    if (!told) throw std::runtime_error(prep::to_string(told.error()));
    if (notes) *notes = *told;
    test::GltfFile file(dir / "out.glb");
    EXPECT_EQ(file.fault(), "");
    return file;
}

test::GltfFile written(const GltfSource& source, const prep::PrepareOptions& options,
                       std::vector<std::string>* notes = nullptr) {
    const test::TempDir dir;
    source.write(dir / "in.glb");
    return written(prep::load_scene(dir / "in.glb"), options, notes);
}

GltfSource one_primitive(GltfSource d, const PlainJson& attributes, const U16& indices) {
    PlainJson primitive{{"attributes", attributes}};
    if (!indices.empty()) primitive["indices"] = d.add("SCALAR", indices);
    d.json["meshes"] = {{{"primitives", {primitive}}}};
    d.json["nodes"] = {{{"mesh", 0}}};
    return d;
}

prep::PrepareOptions nothing() {
    prep::PrepareOptions options;
    options.request.normals = options.request.tangents = prep::Request::Level::never;
    return options;
}

TEST(GltfRewrite, TrianglesThatWereTurnedAreWritten) {
    GltfSource d;
    // Three triangles about a corner of the square's middle; the last disagrees.
    const std::size_t positions =
        d.add_positions(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5f, 0.5f, 1});
    prep::PrepareOptions options = nothing();
    options.repair.orientation = true;
    const test::GltfFile file =
        written(one_primitive(d, {{"POSITION", positions}}, {0, 1, 4, 1, 2, 4, 3, 2, 4}), options);
    EXPECT_EQ(file.attribute(0, 0, "POSITION").count(), 5u);
    const auto t = file.triangles(0, 0);
    ASSERT_EQ(t.size(), 9u);
    // 2, 3, 4 in some turn of it.
    const std::size_t first = std::size_t(std::find(t.begin() + 6, t.end(), 2u) - t.begin()) - 6;
    ASSERT_LT(first, 3u);
    EXPECT_EQ(t[6 + (first + 1) % 3], 3u);
    EXPECT_EQ(t[6 + (first + 2) % 3], 4u);
}

TEST(GltfRewrite, NormalsThatWereReplacedAreWrittenThoughNoVertexSplits) {
    GltfSource d;
    const PlainJson attributes{
        {"POSITION", d.add_positions(square)},
        {"NORMAL", d.add_floats("VEC3", {1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0})},
        {"TEXCOORD_0", d.add_floats("VEC2", {0, 1, 1, 1, 1, 0, 0, 0})},
        {"TANGENT", d.add_floats("VEC4", {0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1})}};
    const GltfSource source = one_primitive(d, attributes, {0, 1, 2, 0, 2, 3});
    prep::PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    options.normals = prep::Authored::replace;
    const test::GltfFile file = written(source, options);
    EXPECT_EQ(file.attribute(0, 0, "NORMAL").values, (Numbers{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}));
    for (std::size_t v = 0; v < 4; ++v)
        EXPECT_EQ(file.attribute(0, 0, "TANGENT").at(v), (Numbers{1, 0, 0, 1}));
    // Tangents alone, too: against the UVs, and the normals are kept.
    options.normals = prep::Authored::keep;
    options.tangents = prep::Authored::replace;
    GltfSource upright = source;
    upright.json["accessors"][attributes["NORMAL"].get<std::size_t>()] =
        upright.json["accessors"][upright.add_floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})];
    const test::GltfFile turned = written(upright, options);
    for (std::size_t v = 0; v < 4; ++v)
        EXPECT_EQ(turned.attribute(0, 0, "TANGENT").at(v), (Numbers{1, 0, 0, 1}));
}

TEST(GltfRewrite, NormalsAloneAreWrittenThoughNoVertexSplits) {
    GltfSource d;
    const PlainJson attributes{
        {"POSITION", d.add_positions(square)},
        {"NORMAL", d.add_floats("VEC3", {1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0})}};
    prep::PrepareOptions options;
    options.normals = prep::Authored::replace;
    EXPECT_EQ(written(one_primitive(d, attributes, {0, 1, 2, 0, 2, 3}), options)
                  .attribute(0, 0, "NORMAL")
                  .values,
              (Numbers{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}));
}

// Whatever the normal, what stands in for a tangent that is not finite is unit and at right angles.
TEST(GltfRewrite, TangentsThatAreNotFiniteBecomeAnyInTheSurface) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const std::vector<float>& n : std::vector<std::vector<float>>{
             {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6f, 0, 0.8f}, {0.48f, 0.6f, 0.64f}}) {
        GltfSource d;
        std::vector<float> normals, tangents;
        for (int v = 0; v < 4; ++v) {
            normals.insert(normals.end(), n.begin(), n.end());
            tangents.insert(tangents.end(), {nan, 0, 0, 1});
        }
        const PlainJson attributes{{"POSITION", d.add_positions(square)},
                                   {"NORMAL", d.add_floats("VEC3", normals)},
                                   {"TANGENT", d.add_floats("VEC4", tangents)}};
        std::vector<std::string> notes;
        const test::GltfFile file =
            written(one_primitive(d, attributes, {0, 1, 2, 0, 2, 3}), nothing(), &notes);
        const Numbers t = file.attribute(0, 0, "TANGENT").at(0);
        EXPECT_NEAR(t[0] * t[0] + t[1] * t[1] + t[2] * t[2], 1, 1e-6);
        EXPECT_NEAR(t[0] * n[0] + t[1] * n[1] + t[2] * n[2], 0, 1e-6);
        EXPECT_EQ(t[3], 1);
        EXPECT_EQ(notes, std::vector<std::string>{
                             "tangents that are not finite were replaced by any in the surface"});
    }
}

// Triangles without indices, whose vertices at one place have skins of their own.
TEST(GltfRewrite, VerticesAtOnePlaceAreNotMadeOne) {
    GltfSource d;
    std::vector<std::uint8_t> joints;
    std::vector<float> weights, ids;
    for (std::uint8_t v = 0; v < 6; ++v) {
        joints.insert(joints.end(), {v, 0, 0, 0});
        weights.insert(weights.end(), {1, 0, 0, 0});
    }
    const PlainJson attributes{
        {"POSITION",
         d.add_positions(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0})},
        {"JOINTS_0", d.add("VEC4", joints)},
        {"WEIGHTS_0", d.add_floats("VEC4", weights)}};
    GltfSource source = one_primitive(d, attributes, {});
    source.json["skins"] = {{{"joints", {1, 2, 3, 4, 5, 6}}}};
    source.json["nodes"][0]["skin"] = 0;
    for (int j = 0; j < 6; ++j) source.json["nodes"].push_back(GltfSource::Json::object());
    const test::TempDir dir;
    source.write(dir / "in.glb");
    const test::GltfFile before(dir / "in.glb"), after = written(source, {});
    EXPECT_EQ(test::gltf_difference(before, after), "");
    for (std::size_t c = 0; c < 6; ++c)  // flat, across the seam of places
        EXPECT_EQ(after.attribute(0, 0, "NORMAL").at(after.triangles(0, 0)[c]), (Numbers{0, 0, 1}));
}

// A primitive whose target moves nothing beside one that does: the normals along their common edge
// turn alike.
TEST(GltfRewrite, TargetsTurnTheNormalsOfWhatTheyShareAnEdgeWith) {
    GltfSource d;
    const std::vector<float> left = {0, 0, 0, 1, 0, 0, 0, 1, 0},
                             right = {1, 0, 0, 1, 1, 0, 0, 1, 0};
    const std::size_t lifted = d.add_positions(std::vector<float>{0, 0, 1, 0, 0, 0, 0, 0, 0});
    const std::size_t colors = d.add_floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 0, 0});
    const std::size_t white = d.add_floats("VEC3", {0, 1, 1, 0, 1, 1, 0, 1, 1});
    d.json["meshes"] = {
        {{"primitives",
          {{{"attributes", {{"POSITION", d.add_positions(left)}}},
            {"targets", {{{"POSITION", lifted}}}}},
           {{"attributes", {{"POSITION", d.add_positions(right)}, {"COLOR_0", white}}},
            {"targets", {{{"COLOR_0", colors}}}}}}}}};
    d.json["nodes"] = {{{"mesh", 0}}};
    const test::GltfFile file = written(d, {});
    const auto at = [&](std::size_t p, double x, double y) {
        const test::GltfValues positions = file.attribute(0, p, "POSITION");
        for (std::size_t v = 0; v < positions.count(); ++v)
            if (positions.at(v) == Numbers{x, y, 0}) return file.target(0, p, 0, "NORMAL").at(v);
        return Numbers{};
    };
    EXPECT_EQ(at(0, 1, 0), at(1, 1, 0));
    EXPECT_EQ(at(0, 0, 1), at(1, 0, 1));
    EXPECT_EQ(at(1, 1, 1), (Numbers{0, 0, 0}));
    // The left triangle's alone, (1, 1, 1)/√3, minus (0, 0, 1).
    const Numbers alone = at(0, 0, 0);
    ASSERT_EQ(alone.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(alone[k], std::sqrt(1.0 / 3) - (k == 2 ? 1 : 0), 1e-6);
    EXPECT_GT(at(1, 1, 0).at(0), 0.1);
    EXPECT_EQ(file.target(0, 1, 0, "COLOR_0").values, (Numbers{0, 0, 0, 1, 0, 0, 0, 0, 0}));
}

TEST(GltfRewrite, DracoIsUndone) {
    test::GltfMaker d;
    const Numbers places = {0, 0, 0, 4, 0, 0, 4, 4, 1, 0, 0, 0, 4, 4, 1, 0, 4, 2};
    const Numbers joints = {1, 2, 0, 0, 2, 1, 0, 0, 0, 1, 0, 0, 1, 2, 0, 0, 0, 1, 0, 0, 2, 0, 0, 0};
    d.mesh({d.draco_primitive(
        {{"POSITION", 5126, 3, false, places}, {"JOINTS_0", 5121, 4, false, joints}})});
    d.json["extensionsUsed"].push_back("KHR_materials_unlit");
    for (const bool flat : {false, true}) {
        const test::GltfFile file = written(d.read(), flat ? prep::PrepareOptions{} : nothing());
        EXPECT_EQ(file.json["extensionsUsed"], PlainJson::array({"KHR_materials_unlit"}));
        EXPECT_FALSE(file.json.contains("extensionsRequired"));
        EXPECT_FALSE(file.primitive(0, 0).contains("extensions"));
        // The encoder may begin with any triangle, and each with any corner.
        const auto corners = file.triangles(0, 0);
        ASSERT_EQ(corners.size(), 6u);
        std::vector<bool> seen(6, false);
        for (const std::size_t i : corners) {
            Numbers found = file.attribute(0, 0, "POSITION").at(i);
            const Numbers joint = file.attribute(0, 0, "JOINTS_0").at(i);
            bool known = false;
            for (std::size_t c = 0; c < 6 && !known; ++c) {
                const auto from = [&](const Numbers& list, std::size_t width) {
                    return Numbers(list.begin() + std::ptrdiff_t(width * c),
                                   list.begin() + std::ptrdiff_t(width * (c + 1)));
                };
                if (seen[c] || found != from(places, 3) || joint != from(joints, 4)) continue;
                seen[c] = known = true;
            }
            EXPECT_TRUE(known);
        }
    }
}

TEST(GltfRewrite, MeshoptIsUndone) {
    test::GltfMaker d;
    const std::vector<float> places = square;
    const std::size_t view =
        d.meshopt_view("ATTRIBUTES", "NONE", 4, 12, std::as_bytes(std::span(places)));
    const std::size_t positions = d.accessor({{"bufferView", view},
                                              {"componentType", 5126},
                                              {"count", 4},
                                              {"type", "VEC3"},
                                              {"min", {0, 0, 0}},
                                              {"max", {1, 1, 0}}});
    const std::size_t indices = d.accessor(U16{0, 1, 2, 0, 2, 3}, "SCALAR");
    d.mesh({{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}});
    for (const bool with_normals : {false, true}) {
        const test::GltfFile file =
            written(d.read(), with_normals ? prep::PrepareOptions{} : nothing());
        EXPECT_EQ(file.attribute(0, 0, "POSITION").values, Numbers(square.begin(), square.end()));
        EXPECT_EQ(file.json.dump().find("EXT_meshopt_compression"), std::string::npos);
    }
}

// Vertices that lie together and vertices that do not are numbered in two ways.
TEST(GltfRewrite, NumbersVerticesInTheirOrder) {
    for (const std::vector<std::uint32_t>& indices : {std::vector<std::uint32_t>{7, 9, 7, 12, 8, 9},
                                                      {},
                                                      {5, 5, 5},
                                                      {4'000'000'000, 3, 70, 3}}) {
        const std::set<std::uint32_t> expected(indices.begin(), indices.end());
        std::vector<std::uint32_t> places = indices;
        const std::vector<std::uint32_t> used = prep::detail::number_anew(places);
        EXPECT_EQ(used, std::vector<std::uint32_t>(expected.begin(), expected.end()));
        ASSERT_EQ(places.size(), indices.size());
        for (std::size_t i = 0; i < indices.size(); ++i) EXPECT_EQ(used.at(places[i]), indices[i]);
    }
}

}  // namespace
