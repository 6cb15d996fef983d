// Skins and morph targets of vertices that repairs weld, split and make: docs/repair.md, "skins and
// what morph targets move go by the vertex".
#include <gtest/gtest.h>

#include <cmath>

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
using test::GltfSource;

// Two quads side by side; 4 and 7 stand where 1 and 2 do, `gap` to the right. Vertex v has the
// joints v and 7 − v, with weights of its own, and moves by (0, 0, v) in the target.
GltfSource two_quads(float gap) {
    GltfSource d;
    const float x = 1 + gap;
    U8 joints;
    std::vector<float> weights, moves, turns, ids, uvs;
    for (std::uint8_t v = 0; v < 8; ++v) {
        joints.insert(joints.end(), {v, std::uint8_t(7 - v), 0, 0});
        weights.insert(weights.end(), {float(v + 1) / 16, 1 - float(v + 1) / 16, 0, 0});
        moves.insert(moves.end(), {0, 0, float(v)});
        turns.insert(turns.end(), {float(v) / 8, 0, 0});
        ids.push_back(100 + float(v));
        uvs.insert(uvs.end(), {float(v) / 8, float(v % 3)});
    }
    d.json["meshes"] = {
        {{"primitives",
          {{{"attributes",
             {{"POSITION", d.add_positions(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0,
                                                              x, 0, 0, 2, 0, 0, 2, 1, 0, x, 1, 0})},
              {"NORMAL", d.add_floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1,
                                               0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})},
              {"TEXCOORD_0", d.add_floats("VEC2", uvs)},
              {"_ID", d.add_floats("SCALAR", ids)},
              {"JOINTS_0", d.add("VEC4", joints)},
              {"WEIGHTS_0", d.add_floats("VEC4", weights)}}},
            {"indices", d.add("SCALAR", U16{4, 5, 6, 4, 6, 7, 0, 1, 2, 0, 2, 3})},
            {"targets",
             {{{"POSITION", d.add_positions(moves)},
               {"NORMAL", d.add_floats("VEC3", turns)}}}}}}}}};
    d.json["skins"] = {{{"joints", {1, 2, 3, 4, 5, 6, 7, 8}}}};
    d.json["nodes"] = {{{"mesh", 0}, {"skin", 0}}};
    for (int j = 0; j < 8; ++j) d.json["nodes"].push_back({{"name", "joint"}});
    d.json["scenes"] = {{{"nodes", {0, 1, 2, 3, 4, 5, 6, 7, 8}}}};
    return d;
}

test::GltfFile repaired(const GltfSource& source, const prep::RepairOptions& repair) {
    const test::TempDir dir;
    source.write(dir / "in.glb");
    auto scene = prep::load_scene(dir / "in.glb");
    if (!scene) throw std::runtime_error(prep::to_string(scene.error()));
    prep::PrepareOptions options;
    options.repair = repair;
    const auto prepared = prep::prepare(*std::move(scene), options);
    if (!prepared) throw std::runtime_error(prep::to_string(prepared.error()));
    const auto notes = prep::save_scene(*prepared, dir / "out.glb");
    EXPECT_TRUE(notes.has_value());
    test::GltfFile file(dir / "out.glb");
    EXPECT_EQ(file.fault(), "");
    return file;
}

// The vertices of the file that were written at each corner, by where they are and by what they
// have.
void expect_welded(const test::GltfFile& file, float gap) {
    const std::size_t corner_vertex[12] = {4, 5, 6, 4, 6, 7, 0, 1, 2, 0, 2, 3};
    const std::size_t welded[8] = {0, 1, 2, 3, 1, 5, 6, 2};  // the earlier one of each pair
    const float x[8] = {0, 1, 1, 0, 1 + gap, 2, 2, 1 + gap};
    const auto corners = file.triangles(0, 0);
    ASSERT_EQ(corners.size(), 12u);
    for (std::size_t c = 0; c < 12; ++c) {
        const std::size_t own = corner_vertex[c], point = welded[own];
        SCOPED_TRACE("corner " + std::to_string(c) + ", vertex " + std::to_string(own));
        const auto value = [&](const char* name) {
            return file.attribute(0, 0, name).at(corners[c]);
        };
        // By the point.
        EXPECT_EQ(value("POSITION")[0], x[point]);
        EXPECT_EQ(value("JOINTS_0"), (Numbers{double(point), 7.0 - double(point), 0, 0}));
        EXPECT_EQ(value("WEIGHTS_0"),
                  (Numbers{double(point + 1) / 16, 1 - double(point + 1) / 16, 0, 0}));
        EXPECT_EQ(file.target(0, 0, 0, "POSITION").at(corners[c]), (Numbers{0, 0, double(point)}));
        // By the corner.
        EXPECT_EQ(value("TEXCOORD_0"), (Numbers{double(own) / 8, double(own % 3)}));
        EXPECT_EQ(value("_ID"), Numbers{100 + double(own)});
        EXPECT_EQ(file.target(0, 0, 0, "NORMAL").at(corners[c]), (Numbers{double(own) / 8, 0, 0}));
    }
}

TEST(GltfSkins, WeldedVerticesHaveThePlaceAndTheSkinOfTheEarlier) {
    prep::RepairOptions repair;
    repair.weld_tolerance = 0;
    expect_welded(repaired(two_quads(0), repair), 0);
    repair.weld_tolerance = 0.01;
    expect_welded(repaired(two_quads(0.0078125f), repair), 0.0078125f);
}

TEST(GltfSkins, VerticesApartKeepTheirOwn) {
    prep::RepairOptions repair;
    repair.weld_tolerance = 0;
    const GltfSource source = two_quads(0.0078125f);
    const test::TempDir dir;
    source.write(dir / "in.glb");
    EXPECT_EQ(test::gltf_difference(test::GltfFile(dir / "in.glb"), repaired(source, repair), {}),
              "");
}

// A pyramid without its base: the triangles that close it are of the rim's vertices.
TEST(GltfSkins, TrianglesThatCloseAHoleHaveTheirVerticesSkin) {
    GltfSource d;
    const std::vector<float> positions = {0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 1, 1, 1};
    U8 joints(20, 0);
    std::vector<float> weights(20, 0.0f), moves;
    for (std::uint8_t v = 0; v < 5; ++v) {
        joints[4 * std::size_t(v)] = v;
        weights[4 * std::size_t(v)] = 1;
        moves.insert(moves.end(), {float(v), 1, 2});
    }
    d.json["meshes"] = {{{"primitives",
                          {{{"attributes",
                             {{"POSITION", d.add_positions(positions)},
                              {"JOINTS_0", d.add("VEC4", joints)},
                              {"WEIGHTS_0", d.add_floats("VEC4", weights)}}},
                            {"indices", d.add("SCALAR", U16{0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4})},
                            {"targets", {{{"POSITION", d.add_positions(moves)}}}}}}}}};
    d.json["skins"] = {{{"joints", {1, 2, 3, 4, 5}}}};
    d.json["nodes"] = {{{"mesh", 0}, {"skin", 0}}};
    for (int j = 0; j < 5; ++j) d.json["nodes"].push_back(GltfSource::Json::object());
    prep::RepairOptions repair;
    repair.hole_edges = 100;
    const test::GltfFile file = repaired(d, repair);
    const auto corners = file.triangles(0, 0);
    ASSERT_EQ(corners.size(), 18u);
    for (const std::size_t c : corners) {
        const Numbers at = file.attribute(0, 0, "POSITION").at(c);
        double v = -1;
        for (std::size_t k = 0; k < 5; ++k)
            if (at == Numbers{positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]})
                v = double(k);
        EXPECT_EQ(file.attribute(0, 0, "JOINTS_0").at(c), (Numbers{v, 0, 0, 0}));
        EXPECT_EQ(file.attribute(0, 0, "WEIGHTS_0").at(c), (Numbers{1, 0, 0, 0}));
        EXPECT_EQ(file.target(0, 0, 0, "POSITION").at(c), (Numbers{v, 1, 2}));
    }
}

}  // namespace
