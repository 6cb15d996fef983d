// Primitives of glTF meshes: what each mode makes of its indices (glTF 2.0, 3.7.2.1), attributes
// and materials of several primitives in one mesh, Draco, and what contradicts itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <set>

#include "gltf_maker.h"
#include "invariants.h"
#include "mesh_files.h"

namespace {

using Floats = std::vector<float>;
using Indices = std::vector<std::uint32_t>;
using Json = test::GltfMaker::Json;
using test::GltfMaker;

// Positions (i, i², 0) for i from `first`.
std::size_t add_positions(GltfMaker& maker, int count, int first = 0) {
    Floats values;
    for (int i = first; i < first + count; ++i)
        values.insert(values.end(), {float(i), float(double(i) * i), 0});
    return maker.accessor(values, "VEC3");
}

// One after the other: a strip's other primitive, so that indices do not start at the mesh's first
// vertex; then six vertices of this mode with these indices, or none.
prep::Mesh of_mode(int mode, const std::vector<std::uint8_t>& indices) {
    GltfMaker maker;
    const std::size_t other = add_positions(maker, 3, 100);
    Json primitive{{"attributes", {{"POSITION", add_positions(maker, 6)}}}, {"mode", mode}};
    if (!indices.empty()) primitive["indices"] = maker.accessor(indices, "SCALAR");
    maker.mesh({{{"attributes", {{"POSITION", other}}}}, primitive});
    auto scene = maker.read();
    EXPECT_TRUE(scene) << test::error_of(scene);
    return scene ? scene->meshes[0] : prep::Mesh();
}

// The x of the positions behind a list of vertices, which are the numbers they have above.
Indices numbers(const prep::Mesh& mesh, const Indices& vertices) {
    Indices out;
    for (const std::uint32_t v : vertices) out.push_back(std::uint32_t(mesh.positions[v].x));
    return out;
}

// Without the three corners of the other primitive.
Indices corners(const prep::Mesh& mesh) {
    const Indices all = numbers(mesh, mesh.corner_vertices);
    return {all.begin() + 3, all.end()};
}

TEST(GltfModes, TrianglesTakeThreeEach) {
    EXPECT_EQ(corners(of_mode(4, {5, 0, 3, 1, 1, 2})), (Indices{5, 0, 3, 1, 1, 2}));
    EXPECT_EQ(corners(of_mode(4, {})), (Indices{0, 1, 2, 3, 4, 5}));
}

TEST(GltfModes, StripsTurnEveryOtherTriangle) {
    // p_i = {v_i, v_(i+1+i%2), v_(i+2−i%2)}
    EXPECT_EQ(corners(of_mode(5, {})), (Indices{0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4}));
    EXPECT_EQ(corners(of_mode(5, {4, 2, 0, 5})), (Indices{4, 2, 0, 2, 5, 0}));
}

TEST(GltfModes, FansTurnAboutTheFirstVertex) {
    // p_i = {v_(i+1), v_(i+2), v_0}
    EXPECT_EQ(corners(of_mode(6, {})), (Indices{1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0}));
    EXPECT_EQ(corners(of_mode(6, {3, 5, 1, 0})), (Indices{5, 1, 3, 1, 0, 3}));
}

TEST(GltfModes, LinesTakeTwoEachStripsAllAndLoopsCloseThem) {
    const prep::Mesh lines = of_mode(1, {0, 3, 2, 5}), strip = of_mode(3, {4, 1, 2}),
                     loop = of_mode(2, {4, 1, 2});
    EXPECT_EQ(numbers(lines, lines.line_vertices), (Indices{0, 3, 2, 5}));
    EXPECT_EQ(lines.line_offsets, (Indices{0, 2, 4}));
    EXPECT_EQ(numbers(strip, strip.line_vertices), (Indices{4, 1, 2}));
    EXPECT_EQ(strip.line_offsets, (Indices{0, 3}));
    EXPECT_EQ(numbers(loop, loop.line_vertices), (Indices{4, 1, 2, 4}));
    EXPECT_EQ(loop.line_offsets, (Indices{0, 4}));
    EXPECT_EQ(loop.face_count(), 1u) << "the other primitive's";
}

TEST(GltfModes, PointsAreTheirVertices) {
    const prep::Mesh mesh = of_mode(0, {5, 5, 2});
    EXPECT_EQ(numbers(mesh, mesh.points), (Indices{5, 5, 2}));
    const prep::Mesh all = of_mode(0, {});
    EXPECT_EQ(numbers(all, all.points), (Indices{0, 1, 2, 3, 4, 5}));
}

TEST(GltfModes, IndicesThatAreLeftOverAreToldOf) {
    const auto warnings = [](int mode, std::size_t count) {
        GltfMaker maker;
        const std::vector<std::uint8_t> indices(count, 1);
        maker.mesh({{{"attributes", {{"POSITION", add_positions(maker, 3)}}},
                     {"mode", mode},
                     {"indices", maker.accessor(indices, "SCALAR")}}});
        const auto scene = maker.read();
        return scene ? scene->warnings.size() : 99;
    };
    for (const int mode : {0, 1, 2, 3, 4, 5, 6}) {
        const std::size_t each = mode == 4 ? 3 : mode == 1 ? 2 : 1;
        const std::size_t least = mode >= 4 ? 3 : mode == 0 ? 1 : 2;
        for (std::size_t count = 1; count < 8; ++count)
            EXPECT_EQ(warnings(mode, count), count < least || count % each != 0 ? 1u : 0u)
                << "mode " << mode << ", " << count << " indices";
    }
}

// --- several primitives ----------------------------------------------------------------------

TEST(GltfPrimitives, FacesHaveThePartAndMaterialOfTheirPrimitive) {
    GltfMaker maker;
    maker.json["materials"] = Json::array({Json::object(), Json::object(), Json::object()});
    const std::size_t a = add_positions(maker, 6), b = add_positions(maker, 4, 10);
    maker.mesh({{{"attributes", {{"POSITION", a}}}, {"material", 2}},
                {{"attributes", {{"POSITION", b}}}, {"mode", 5}},
                {{"attributes", {{"POSITION", add_positions(maker, 3)}}}, {"material", 1}}});
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const prep::Mesh& mesh = scene->meshes[0];
    EXPECT_EQ(mesh.face_materials, (Indices{2, 2, prep::no_index, prep::no_index, 1}));
    EXPECT_EQ(mesh.face_parts, (Indices{0, 0, 1, 1, 2}));
    EXPECT_EQ(mesh.parts.size(), 3u);
}

TEST(GltfPrimitives, VariantsNameEveryMaterialOnceAndOnlyThoseThatAreThere) {
    GltfMaker maker;
    maker.json["materials"] = Json::array({Json::object(), Json::object(), Json::object()});
    Json mappings = Json::array();
    for (const int material : {2, 0, 2, 3})
        mappings.push_back({{"material", material}, {"variants", {0}}});
    Json primitive{{"attributes", {{"POSITION", add_positions(maker, 3)}}}};
    primitive["extensions"]["KHR_materials_variants"]["mappings"] = mappings;
    maker.mesh(Json::array({primitive}));
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(scene->meshes[0].variant_materials, (Indices{0, 2}));
}

TEST(GltfPrimitives, CornersHaveTheAttributesOfTheirOwnPrimitiveOnly) {
    GltfMaker maker;
    const std::size_t normals = maker.accessor(Floats{0, 0, 1, 0, 1, 0, 1, 0, 0}, "VEC3");
    const std::size_t uvs = maker.accessor(Floats{1, 2, 3, 4, 5, 6}, "VEC2");
    const std::size_t rgba =
        maker.accessor<std::uint8_t>({255, 0, 0, 51, 0, 255, 0, 102, 0, 0, 255, 0}, "VEC4", true);
    const std::size_t rgb = maker.accessor(Floats{1.5f, 0.5f, 0, 0, 0.5f, 1, 0, -0.25f, 0}, "VEC3");
    const std::size_t a = add_positions(maker, 3), b = add_positions(maker, 3, 3),
                      c = add_positions(maker, 3, 6);
    maker.mesh({{{"attributes", {{"POSITION", a}, {"COLOR_0", rgba}}}},
                {{"attributes", {{"POSITION", b}, {"NORMAL", normals}, {"COLOR_0", rgb}}}},
                {{"attributes", {{"POSITION", c}, {"TEXCOORD_1", uvs}}}}});
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const prep::Mesh& mesh = scene->meshes[0];
    const auto at = [](const auto& layer, std::size_t corner) {
        return layer.values.at(layer.indices.at(corner));
    };
    const auto has = [](const auto& layer, std::size_t corner) {
        return layer.indices.at(corner) != prep::no_index;
    };
    ASSERT_EQ(mesh.uvs.size(), 2u);
    EXPECT_TRUE(mesh.uvs[0].empty());
    ASSERT_EQ(mesh.colors.size(), 1u);
    for (std::size_t corner = 0; corner < 9; ++corner) {
        EXPECT_EQ(has(mesh.normals, corner), corner / 3 == 1) << corner;
        EXPECT_EQ(has(mesh.colors[0], corner), corner / 3 < 2) << corner;
        EXPECT_EQ(has(mesh.uvs[1], corner), corner / 3 == 2) << corner;
    }
    EXPECT_EQ(at(mesh.normals, 3), glm::vec3(0, 0, 1));
    EXPECT_EQ(at(mesh.normals, 5), glm::vec3(1, 0, 0));
    EXPECT_EQ(at(mesh.uvs[1], 7), glm::vec2(3, 4));
    EXPECT_EQ(at(mesh.colors[0], 0), glm::vec4(1, 0, 0, float(51 / 255.0)));
    EXPECT_EQ(at(mesh.colors[0], 1), glm::vec4(0, 1, 0, float(102 / 255.0)));
    EXPECT_EQ(at(mesh.colors[0], 2), glm::vec4(0, 0, 1, 0));
    EXPECT_EQ(at(mesh.colors[0], 3), glm::vec4(1, 0.5f, 0, 1)) << "RGB is opaque";
    EXPECT_EQ(at(mesh.colors[0], 4), glm::vec4(0, 0.5f, 1, 1));
    EXPECT_EQ(at(mesh.colors[0], 5), glm::vec4(0, 0, 0, 1)) << "within 0 and 1";
}

TEST(GltfPrimitives, PointCloudsHaveTheirColoursByVertexWhiteWhereThereAreNone) {
    GltfMaker maker;
    const std::size_t colors = maker.accessor(Floats{1, 0, 0.25f, 0, 0.5f, 1}, "VEC3");
    const std::size_t a = add_positions(maker, 2), b = add_positions(maker, 1, 5);
    maker.mesh({{{"attributes", {{"POSITION", a}, {"COLOR_0", colors}}}, {"mode", 0}},
                {{"attributes", {{"POSITION", b}}}, {"mode", 0}}});
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(scene->meshes[0].vertex_colors,
              (std::vector<glm::vec4>{{1, 0, 0.25f, 1}, {0, 0.5f, 1, 1}, {1, 1, 1, 1}}));
}

// Joints without weights, weights without joints, and a number that is left out.
TEST(GltfPrimitives, SetsOfJointsThatAreNotWholeMoveNothing) {
    GltfMaker maker;
    const std::size_t joints =
        maker.accessor(std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, "VEC4");
    const std::size_t weights = maker.accessor(Floats{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
    const std::size_t a = add_positions(maker, 3), b = add_positions(maker, 3, 5);
    maker.mesh({{{"attributes", {{"POSITION", a}, {"JOINTS_0", joints}, {"WEIGHTS_3", weights}}}},
                {{"attributes", {{"POSITION", b}, {"JOINTS_1", joints}, {"WEIGHTS_1", weights}}}}});
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(test::broken_promise(*scene), "");
    const std::vector<prep::SkinInfluences>& sets = scene->meshes[0].skin_influences;
    ASSERT_EQ(sets.size(), 4u);
    for (const std::size_t s : {std::size_t(0), std::size_t(1), std::size_t(2), std::size_t(3)}) {
        ASSERT_EQ(sets[s].joints.size(), 6u) << s;
        ASSERT_EQ(sets[s].weights.size(), 6u) << s;
    }
    EXPECT_EQ(sets[0].joints[1].y, 6);
    EXPECT_EQ(sets[0].weights[1], glm::vec4(0.0f));
    EXPECT_EQ(sets[1].weights[1], glm::vec4(0.0f));
    EXPECT_EQ(sets[1].weights[4], glm::vec4(1, 0, 0, 0));
    EXPECT_EQ(sets[2].weights, std::vector<glm::vec4>(6, glm::vec4(0.0f)));
    EXPECT_EQ(sets[3].weights[1], glm::vec4(1, 0, 0, 0));
}

TEST(GltfPrimitives, VerticesOfPrimitivesBeforeAndAfterTheOneWithColoursAreWhite) {
    GltfMaker maker;
    const std::size_t colors = maker.accessor(Floats{1, 0, 0.25f, 0, 0.5f, 1}, "VEC3");
    const std::size_t a = add_positions(maker, 1), b = add_positions(maker, 2, 5);
    const std::size_t c = add_positions(maker, 1, 9);
    maker.mesh({{{"attributes", {{"POSITION", a}}}, {"mode", 0}},
                {{"attributes", {{"POSITION", b}, {"COLOR_0", colors}}}, {"mode", 1}},
                {{"attributes", {{"POSITION", c}}}, {"mode", 0}}});
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(
        scene->meshes[0].vertex_colors,
        (std::vector<glm::vec4>{{1, 1, 1, 1}, {1, 0, 0.25f, 1}, {0, 0.5f, 1, 1}, {1, 1, 1, 1}}));
}

TEST(GltfPrimitives, TangentsAndElevenUvSetsKeepTheirNumbers) {
    GltfMaker maker;
    Json attributes{
        {"POSITION", add_positions(maker, 3)},
        {"TANGENT", maker.accessor<std::int8_t>({127, 0, 0, 127, 0, 127, 0, -127, 0, 0, -127, 127},
                                                "VEC4", true)}};
    for (int set = 0; set < 11; ++set) {
        const float s = float(set);
        attributes["TEXCOORD_" + std::to_string(set)] =
            maker.accessor(Floats{s, 0, s, 1, s, 2}, "VEC2");
    }
    maker.mesh({{{"attributes", attributes}}});
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const prep::Mesh& mesh = scene->meshes[0];
    EXPECT_EQ(mesh.tangents.values,
              (std::vector<glm::vec4>{{1, 0, 0, 1}, {0, 1, 0, -1}, {0, 0, -1, 1}}));
    ASSERT_EQ(mesh.uvs.size(), 11u);
    for (std::size_t set = 0; set < 11; ++set)
        EXPECT_EQ(mesh.uvs[set].values[2], glm::vec2(float(set), 2));
}

// --- Draco -----------------------------------------------------------------------------------

// A tetrahedron's faces, each with UVs, normals and colours of its own, so that vertices of the
// decoded mesh share positions.
struct Tetrahedron {
    std::vector<double> positions, uvs, normals, colors, custom;
    Tetrahedron() {
        const double p[4][3] = {{0, 0, 0}, {1, 0.25, 0}, {0, 2, 0.5}, {0.125, 0, 3}};
        const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
        for (int f = 0; f < 4; ++f)
            for (int k = 0; k < 3; ++k) {
                positions.insert(positions.end(), p[faces[f][k]], p[faces[f][k]] + 3);
                uvs.insert(uvs.end(), {40000.0 + f, 65535.0 - k});
                normals.insert(normals.end(), {double(f == 0), double(f == 1), double(f > 1)});
                colors.insert(colors.end(), {200.0 + f, 10.0 * k, 255, 3.0 * f});
                custom.push_back(-100.0 + f);
            }
    }
    std::vector<GltfMaker::DracoAttribute> attributes() const {
        return {{"POSITION", 5126, 3, false, positions},
                {"TEXCOORD_0", 5123, 2, true, uvs},
                {"NORMAL", 5126, 3, false, normals},
                {"COLOR_0", 5121, 4, true, colors},
                {"_CUSTOM", 5120, 1, false, custom}};
    }
};

// The triangles of a list of corners with their values, each begun with its least corner.
std::multiset<std::vector<float>> turned(const std::vector<Floats>& corners) {
    std::multiset<std::vector<float>> out;
    for (std::size_t f = 0; f < corners.size(); f += 3) {
        std::array<Floats, 3> t = {corners[f], corners[f + 1], corners[f + 2]};
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        Floats all;
        for (const Floats& c : t) all.insert(all.end(), c.begin(), c.end());
        out.insert(all);
    }
    return out;
}

TEST(GltfDraco, TrianglesComeBackWithTheirValuesAndTheirSide) {
    const Tetrahedron in;
    GltfMaker maker;
    maker.mesh({maker.draco_primitive(in.attributes())});
    const auto scene = maker.read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const prep::Mesh& mesh = scene->meshes[0];
    ASSERT_EQ(mesh.face_count(), 4u);
    ASSERT_EQ(mesh.vertex_count(), 12u);
    std::vector<Floats> expected, found;
    for (std::size_t c = 0; c < 12; ++c) {
        Floats e, f;
        for (std::size_t k = 0; k < 3; ++k) e.push_back(float(in.positions[3 * c + k]));
        for (std::size_t k = 0; k < 2; ++k) e.push_back(float(in.uvs[2 * c + k] / 65535));
        for (std::size_t k = 0; k < 3; ++k) e.push_back(float(in.normals[3 * c + k]));
        for (std::size_t k = 0; k < 4; ++k) e.push_back(float(in.colors[4 * c + k] / 255));
        const std::uint32_t v = mesh.corner_vertices[c];
        const auto add = [&](const auto& value) {
            for (int k = 0; k < int(value.length()); ++k) f.push_back(value[k]);
        };
        add(mesh.positions[v]);
        add(mesh.uvs[0].values[mesh.uvs[0].indices[c]]);
        add(mesh.normals.values[mesh.normals.indices[c]]);
        add(mesh.colors[0].values[mesh.colors[0].indices[c]]);
        expected.push_back(e);
        found.push_back(f);
    }
    EXPECT_EQ(turned(found), turned(expected));
}

TEST(GltfDraco, DataThatLackAnAttributeOrAreCutAreRefusedAtTheirPlace) {
    const std::string at = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
    const Tetrahedron in;
    const auto error = [&](auto&& change) {
        GltfMaker maker;
        Json primitive = maker.draco_primitive(in.attributes());
        change(maker.json, primitive["extensions"]["KHR_draco_mesh_compression"]);
        maker.mesh({primitive});
        return test::error_of(maker.read());
    };
    const auto no_change = [](Json&, Json&) {};
    EXPECT_EQ(error(no_change), "no error");
    EXPECT_NE(error([](Json&, Json& e) {
                  e["attributes"]["NORMAL"] = 99;
              }).find(at + "/attributes/NORMAL"),
              std::string::npos);
    EXPECT_NE(error([](Json&, Json& e) { e.erase("bufferView"); }).find(at + "/bufferView"),
              std::string::npos);
    EXPECT_NE(error([](Json& json, Json&) {
                  json["bufferViews"][0]["byteLength"] = 40;
              }).find(at + ": Draco"),
              std::string::npos)
        << error([](Json& json, Json&) { json["bufferViews"][0]["byteLength"] = 40; });
}

// --- what contradicts itself -----------------------------------------------------------------

// The error of a file with this one primitive, whose POSITION is that of `vertices` vertices.
std::string primitive_error(int vertices, const std::function<void(GltfMaker&, Json&)>& change) {
    GltfMaker maker;
    Json primitive{{"attributes", {{"POSITION", add_positions(maker, vertices)}}}};
    change(maker, primitive);
    maker.mesh(Json::array({primitive}));
    return test::error_of(maker.read());
}

TEST(GltfPrimitives, AnIndexOfAsManyVerticesAsThereAreIsOutOfRange) {
    const auto with = [](std::uint16_t index) {
        return primitive_error(3, [&](GltfMaker& maker, Json& primitive) {
            primitive["indices"] = maker.accessor<std::uint16_t>({0, 1, index}, "SCALAR");
        });
    };
    EXPECT_EQ(with(2), "no error");
    EXPECT_NE(with(3).find("/meshes/0/primitives/0/indices"), std::string::npos);
    EXPECT_NE(with(3).find("index 3 (number 2) is out of range"), std::string::npos);
}

TEST(GltfPrimitives, TheLargestIndexOfATypeMeansRestartAndIsRefused) {
    const auto bytes = primitive_error(300, [](GltfMaker& maker, Json& primitive) {
        primitive["indices"] = maker.accessor<std::uint8_t>({0, 1, 255}, "SCALAR");
    });
    EXPECT_NE(bytes.find("primitive restart"), std::string::npos) << bytes;
    const auto shorts = primitive_error(65540, [](GltfMaker& maker, Json& primitive) {
        primitive["indices"] = maker.accessor<std::uint16_t>({0, 1, 65535}, "SCALAR");
    });
    EXPECT_NE(shorts.find("primitive restart"), std::string::npos) << shorts;
    const auto fine = primitive_error(65540, [](GltfMaker& maker, Json& primitive) {
        primitive["indices"] = maker.accessor<std::uint32_t>({0, 255, 65535}, "SCALAR");
    });
    EXPECT_EQ(fine, "no error");
}

TEST(GltfPrimitives, AttributesAndTargetsHaveAsManyElementsAsThereAreVertices) {
    for (const int count : {2, 4}) {
        const auto attribute = primitive_error(3, [&](GltfMaker& maker, Json& primitive) {
            primitive["attributes"]["NORMAL"] = add_positions(maker, count);
        });
        EXPECT_NE(attribute.find("/meshes/0/primitives/0/attributes/NORMAL"), std::string::npos)
            << attribute;
        const auto target = primitive_error(3, [&](GltfMaker& maker, Json& primitive) {
            primitive["targets"] = {{{"POSITION", add_positions(maker, count)}}};
        });
        EXPECT_NE(target.find("/meshes/0/primitives/0/targets/0/POSITION"), std::string::npos)
            << target;
    }
}

TEST(GltfPrimitives, AttributesHaveTheTypesOfTheirMeaning) {
    const auto error = [](const std::string& semantic, const char* type, auto example) {
        return primitive_error(3, [&](GltfMaker& maker, Json& primitive) {
            const std::size_t width = std::size_t(type[3] - '0');
            primitive["attributes"][semantic] =
                maker.accessor(std::vector<decltype(example)>(3 * width), type);
        });
    };
    EXPECT_EQ(error("TEXCOORD_0", "VEC2", 0.0f), "no error");
    EXPECT_NE(error("TEXCOORD_0", "VEC3", 0.0f).find("needs 2 components"), std::string::npos);
    EXPECT_NE(error("NORMAL", "VEC2", 0.0f).find("needs 3 components"), std::string::npos);
    EXPECT_NE(error("TANGENT", "VEC3", 0.0f).find("needs 4 components"), std::string::npos);
    EXPECT_NE(error("COLOR_0", "VEC2", 0.0f).find("needs 3 or 4"), std::string::npos);
    EXPECT_NE(error("JOINTS_0", "VEC4", 0.0f).find("unsigned whole"), std::string::npos);
    EXPECT_NE(error("NORMAL", "VEC3", std::uint32_t(0)).find("unsigned 32-bit"), std::string::npos);
    const auto target = primitive_error(3, [](GltfMaker& maker, Json& primitive) {
        primitive["targets"] = {{{"NORMAL", maker.accessor(Floats(6), "VEC2")}}};
    });
    EXPECT_NE(target.find("a target's NORMAL must be VEC3"), std::string::npos) << target;
}

}  // namespace
