// KHR_mesh_quantization, written: the numbers of the file as the specification reads them, against
// those of the source, and what is told of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gltf_oracle.h"
#include "gltf_source.h"
#include "mesh_files.h"
#include "npm_tools.h"
#include "prep/load.h"
#include "prep/save.h"
#include "saved_in_memory.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

using Json = test::GltfFile::Json;
using Numbers = std::vector<double>;
using prep::Compression;
using prep::Quantization;
using prep::QuantizationReport;
using test::GltfSource;
using U16 = std::vector<std::uint16_t>;
using U8 = std::vector<std::uint8_t>;

constexpr int side = 12;  // vertices

// A bent sheet far from the origin, with all four attributes; UVs from 0 to `tiles`.
Json sheet(GltfSource& d, float tiles = 1) {
    std::vector<float> p, n, t, uv;
    U16 indices;
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
            const double u = double(i) / (side - 1), v = double(j) / (side - 1);
            const double a = 0.3 + 2.1 * u, b = 0.2 + 1.3 * v;
            p.insert(p.end(),
                     {float(100 + 3 * u), float(-7 + v), float(0.7 * std::sin(5 * u * v))});
            n.insert(n.end(), {float(std::cos(a) * std::cos(b)), float(std::sin(a) * std::cos(b)),
                               float(std::sin(b))});
            t.insert(t.end(),
                     {float(-std::sin(a)), float(std::cos(a)), 0, (i + j) % 3 == 0 ? -1.0f : 1.0f});
            uv.insert(uv.end(), {float(u) * tiles, float(v * v)});
            if (i + 1 == side || j + 1 == side) continue;
            const auto at = std::uint16_t(j * side + i);
            for (const int k : {0, 1, side + 1, 0, side + 1, side})
                indices.push_back(std::uint16_t(at + k));
        }
    return {{"attributes",
             {{"POSITION", d.add_positions(p)},
              {"NORMAL", d.add_floats("VEC3", n)},
              {"TANGENT", d.add_floats("VEC4", t)},
              {"TEXCOORD_0", d.add_floats("VEC2", uv)}}},
            {"indices", d.add("SCALAR", indices)}};
}

GltfSource one_sheet(float tiles = 1) {
    GltfSource d;
    Json primitive = sheet(d, tiles);
    d.mesh({primitive});
    return d;
}

struct Written {
    test::GltfFile before, after;
    QuantizationReport report;
    std::vector<std::string> notes;
    std::string again;  // what a second reading of the file complains of
};

Written written(const GltfSource& source, const Quantization& bits,
                const std::string& name = "b.glb", Compression compression = Compression::none) {
    const test::TempDir dir;
    source.write(dir / "a.glb");
    auto scene = prep::load_scene(dir / "a.glb");
    if (!scene) throw std::runtime_error(prep::to_string(scene.error()));
    const prep::PreparedScene prepared = test::untouched(*std::move(scene));
    prep::SaveOptions options;
    options.quantization = bits;
    options.compression = compression;
    QuantizationReport report;
    options.quantized = &report;
    auto notes = prep::save_scene(prepared, dir / name, options);
    if (!notes) throw std::runtime_error(prep::to_string(notes.error()));
    if (name.ends_with(".glb")) test::expect_same_in_memory(prepared, options, dir / name, *notes);
    const auto again = prep::load_scene(dir / name);
    return {test::GltfFile(dir / "a.glb"), test::GltfFile(dir / name), report, *notes,
            again ? "" : prep::to_string(again.error())};
}

double length(const Numbers& a) {
    return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

double degrees_apart(const Numbers& a, const Numbers& b) {
    const Numbers cross{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                        a[0] * b[1] - a[1] * b[0]};
    const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    return std::atan2(length(cross), dot) * 180 / M_PI;
}

// The only node that has the mesh: a child that scales and moves.
const Json& node_of(const test::GltfFile& file, std::size_t mesh) {
    for (const Json& node : file.json["nodes"])
        if (node.contains("mesh") && node["mesh"] == mesh) return node;
    throw std::runtime_error("no node has the mesh");
}

Numbers placed(const Json& node, Numbers p) {
    for (std::size_t k = 0; k < 3; ++k)
        p[k] = (node.contains("scale") ? node["scale"][k].get<double>() : 1.0) * p[k] +
               (node.contains("translation") ? node["translation"][k].get<double>() : 0.0);
    return p;
}

// The largest errors of each attribute, by the file's own numbers.
std::vector<double> errors_of(const Written& w) {
    std::vector<double> worst(4, 0);
    const auto before = [&](const char* name) { return w.before.attribute(0, 0, name); };
    const auto after = [&](const char* name) { return w.after.attribute(0, 0, name); };
    const auto p = before("POSITION"), q = after("POSITION");
    Numbers low = p.at(0), high = low;
    for (std::size_t i = 0; i < p.count(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p.at(i)[k]);
            high[k] = std::max(high[k], p.at(i)[k]);
        }
    const double diagonal = length({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
    const Json& node = node_of(w.after, 0);
    for (std::size_t i = 0; i < p.count(); ++i) {
        Numbers apart = placed(node, q.at(i));
        for (std::size_t k = 0; k < 3; ++k) apart[k] -= p.at(i)[k];
        worst[0] = std::max(worst[0], length(apart) / diagonal);
        worst[1] = std::max(worst[1], degrees_apart(before("NORMAL").at(i), after("NORMAL").at(i)));
        worst[2] =
            std::max(worst[2], degrees_apart(before("TANGENT").at(i), after("TANGENT").at(i)));
        for (std::size_t k = 0; k < 2; ++k)
            worst[3] = std::max(
                worst[3], std::abs(before("TEXCOORD_0").at(i)[k] - after("TEXCOORD_0").at(i)[k]));
    }
    return worst;
}

bool lists(const Json& json, const char* list) {
    const auto it = json.find(list);
    return it != json.end() &&
           std::find(it->begin(), it->end(), Json("KHR_mesh_quantization")) != it->end();
}

TEST(GltfQuantize, ErrorsAreThoseThatAreTold) {
    for (const Quantization& bits : {Quantization{16, 16, 16, 16}, Quantization{11, 10, 9, 12},
                                     Quantization{8, 8, 8, 8}, Quantization{4, 12, 15, 5}}) {
        SCOPED_TRACE(bits.positions);
        const Written w = written(one_sheet(), bits);
        EXPECT_EQ(w.after.fault(), "");
        EXPECT_EQ(w.again, "");
        EXPECT_TRUE(w.notes.empty() && w.report.remarks.empty());
        EXPECT_TRUE(lists(w.after.json, "extensionsUsed"));
        EXPECT_TRUE(lists(w.after.json, "extensionsRequired"));
        // Half a step to each side, at most.
        const double grid = std::sqrt(3.0) / 2 / (std::exp2(bits.positions) - 1);
        const auto turn = [](int b) {
            return std::asin(std::sqrt(3.0) / 2 / (std::exp2(b - 1) - 1)) * 180 / M_PI;
        };
        const std::vector<double> bounds = {grid, 1.1 * turn(bits.normals),
                                            1.1 * turn(bits.tangents),
                                            0.502 / (std::exp2(bits.uvs) - 1)};
        const std::vector<double> worst = errors_of(w);
        for (std::size_t r = 0; r < 4; ++r) {
            SCOPED_TRACE(prep::quantization_rows[r].name);
            const prep::QuantizationError& told = w.report.rows[r];
            EXPECT_EQ(told.bits, bits.*prep::quantization_rows[r].bits);
            EXPECT_EQ(told.values, std::uint64_t(side * side));
            EXPECT_EQ(told.kept, 0u);
            EXPECT_NEAR(told.largest, worst[r], 1e-9 * (1 + worst[r]));
            EXPECT_LE(worst[r], bounds[r]);
            EXPECT_GT(worst[r], bounds[r] / 20);
            EXPECT_GT(told.mean, 0);
            EXPECT_LT(told.mean, told.largest);
        }
        for (std::size_t i = 0; i < std::size_t(side * side); ++i)
            ASSERT_EQ(w.after.attribute(0, 0, "TANGENT").at(i)[3],
                      w.before.attribute(0, 0, "TANGENT").at(i)[3]);
    }
}

TEST(GltfQuantize, ValuesTakeTheSmallestTypeThatHoldsThem) {
    const auto types = [](const Quantization& bits) {
        const Written w = written(one_sheet(), bits);
        std::vector<int> out;
        for (const char* name : {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0"})
            out.push_back(w.after.attribute(0, 0, name).component_type);
        return out;
    };
    EXPECT_EQ(types({8, 8, 8, 8}), (std::vector<int>{5121, 5120, 5120, 5121}));
    EXPECT_EQ(types({9, 9, 9, 9}), (std::vector<int>{5123, 5122, 5122, 5123}));
    EXPECT_EQ(types({0, 8, 0, 0}), (std::vector<int>{5126, 5120, 5126, 5126}));
    // UVs from 0 to 1 as 16 bits are glTF's own.
    EXPECT_FALSE(lists(written(one_sheet(), {0, 0, 0, 16}).after.json, "extensionsRequired"));
}

TEST(GltfQuantize, WhatIsRoundedAlreadyStaysAsItIs) {
    const Quantization bits{12, 8, 16, 16};
    const test::TempDir dir;
    const GltfSource source = one_sheet();
    source.write(dir / "a.glb");
    const auto pass = [&](const char* from, const char* to) {
        auto scene = prep::load_scene(dir / from);
        prep::SaveOptions options;
        options.quantization = bits;
        ASSERT_TRUE(prep::save_scene(test::untouched(*std::move(scene)), dir / to, options));
    };
    pass("a.glb", "b.glb");
    pass("b.glb", "c.glb");
    const test::GltfFile b(dir / "b.glb"), c(dir / "c.glb");
    EXPECT_EQ(b.json["nodes"], c.json["nodes"]);  // no grid on top of the grid
    for (const char* name : {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0"})
        EXPECT_EQ(b.attribute(0, 0, name), c.attribute(0, 0, name)) << name;
}

TEST(GltfQuantize, UvsBeyondOneStayFloatsAndThatIsTold) {
    const Written w = written(one_sheet(3), {16, 12, 12, 16});
    EXPECT_EQ(w.after.attribute(0, 0, "TEXCOORD_0"), w.before.attribute(0, 0, "TEXCOORD_0"));
    EXPECT_EQ(w.report.rows[3].values, 0u);
    EXPECT_EQ(w.report.rows[3].kept, std::uint64_t(side * side));
    EXPECT_TRUE(w.notes.empty());  // nothing is lost
    ASSERT_EQ(w.report.remarks.size(), 1u);
    EXPECT_NE(w.report.remarks[0].find("uvs outside 0 … 1"), std::string::npos)
        << w.report.remarks[0];
}

// Where the grid has no place, positions stay as they are; all else is rounded.
TEST(GltfQuantize, PositionsWithoutAPlaceForTheirGridStay) {
    const auto stays = [](const GltfSource& source, const std::string& why) {
        SCOPED_TRACE(why);
        const Written w = written(source, {16, 12, 12, 16});
        EXPECT_EQ(w.after.attribute(0, 0, "POSITION"), w.before.attribute(0, 0, "POSITION"));
        EXPECT_EQ(w.after.attribute(0, 0, "NORMAL").component_type, 5122);
        EXPECT_EQ(w.after.json["nodes"].size(), 1u);
        EXPECT_EQ(node_of(w.after, 0), w.after.json["nodes"][0]);
        EXPECT_EQ(w.report.rows[0].kept, std::uint64_t(side * side));
        const auto& remarks = w.report.remarks;
        EXPECT_TRUE(std::any_of(remarks.begin(), remarks.end(), [&](const std::string& remark) {
            return remark.find(why) != std::string::npos;
        }));
    };
    GltfSource instances = one_sheet();
    instances.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    instances.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", instances.add_floats("VEC3", {0, 0, 0, 5, 0, 0})}};
    stays(instances, "with instances");
    GltfSource thick = one_sheet();
    thick.json["extensionsUsed"] = {"KHR_materials_volume"};
    thick.json["materials"] = {
        {{"extensions", {{"KHR_materials_volume", {{"thicknessFactor", 1}}}}}}};
    thick.json["meshes"][0]["primitives"][0]["material"] = 0;
    stays(thick, "lengths of their own");
    GltfSource physics = one_sheet();
    physics.json["extensionsUsed"] = {"KHR_physics_rigid_bodies"};
    stays(physics, "KHR_physics_rigid_bodies");
}

// A sheet with two joints, a target of which the weight is animated, under a node that is moved.
GltfSource rig(bool with_matrices) {
    GltfSource d;
    Json primitive = sheet(d);
    std::vector<float> weights, moves, turns;
    U8 joints;
    for (int v = 0; v < side * side; ++v) {
        const float w = float(v % 7) / 8;
        joints.insert(joints.end(), {0, 1, 0, 0});
        weights.insert(weights.end(), {w, 1 - w, 0, 0});
        moves.insert(moves.end(), {0.01f * float(v % 5), -0.3f, float(v) * 0.002f});
        turns.insert(turns.end(), {0, 0.1f, 0});
    }
    primitive["attributes"]["JOINTS_0"] = d.add("VEC4", joints);
    primitive["attributes"]["WEIGHTS_0"] = d.add_floats("VEC4", weights);
    primitive["targets"] = {
        {{"POSITION", d.add_positions(moves)}, {"NORMAL", d.add_floats("VEC3", turns)}}};
    d.json["meshes"] = {{{"primitives", {primitive}}, {"weights", {0.25}}}};
    d.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"weights", {0.5}}, {"translation", {4, 5, 6}}},
                       {{"translation", {1, 2, 3}}, {"children", {2}}},
                       {{"rotation", {0.5, 0.5, 0.5, 0.5}}}};
    d.json["skins"] = {{{"joints", {1, 2}}}};
    if (with_matrices)
        d.json["skins"][0]["inverseBindMatrices"] =
            d.add_floats("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, -2, -3, 1,
                                  0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 2,  -1, 7,  1});
    d.json["scenes"] = {{{"nodes", {0, 1}}}};
    d.json["animations"] = {
        {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}},
         {"samplers",
          {{{"input", d.accessor({{"bufferView", d.view(std::vector<float>{0, 1})},
                                  {"componentType", 5126},
                                  {"count", 2},
                                  {"type", "SCALAR"},
                                  {"min", {0}},
                                  {"max", {1}}})},
            {"output", d.add_floats("SCALAR", {0, 1})}}}}}};
    return d;
}

// Where inverse bind matrices and weights put a vertex, joints at rest in the joints' own spaces:
// joint by joint, so that no error hides behind another.
std::vector<Numbers> bound(const test::GltfFile& file, std::size_t v, bool with_target) {
    Numbers p = file.attribute(0, 0, "POSITION").at(v);
    if (with_target)
        for (std::size_t k = 0; k < 3; ++k) p[k] += file.target(0, 0, 0, "POSITION").at(v)[k];
    const Json& skin = file.json["skins"][node_of(file, 0)["skin"].get<std::size_t>()];
    std::vector<Numbers> out;
    for (std::size_t j = 0; j < 2; ++j) {
        if (!skin.contains("inverseBindMatrices")) {
            out.push_back(p);
            continue;
        }
        const Numbers m = file.accessor(skin["inverseBindMatrices"].get<std::size_t>()).at(j);
        Numbers at(3);
        for (std::size_t k = 0; k < 3; ++k)
            at[k] = m[k] * p[0] + m[4 + k] * p[1] + m[8 + k] * p[2] + m[12 + k];
        out.push_back(at);
    }
    return out;
}

TEST(GltfQuantize, SkinsAndMorphTargetsStandWhereTheyDid) {
    for (const bool with_matrices : {true, false}) {
        const Written w = written(rig(with_matrices), {14, 12, 12, 16});
        EXPECT_EQ(w.after.fault(), "");
        EXPECT_EQ(w.again, "");
        EXPECT_TRUE(w.notes.empty() && w.report.remarks.empty());
        const double step = node_of(w.after, 0)["scale"][0].get<double>();
        EXPECT_NEAR(step, 3 / (std::exp2(14) - 1), 1e-9);
        for (std::size_t v = 0; v < std::size_t(side * side); ++v)
            for (const bool with_target : {false, true}) {
                const auto a = bound(w.before, v, with_target), b = bound(w.after, v, with_target);
                for (std::size_t j = 0; j < 2; ++j) {
                    const Numbers apart{a[j][0] - b[j][0], a[j][1] - b[j][1], a[j][2] - b[j][2]};
                    // A step's half diagonal for the point and for what moves it, and floats'
                    // rounding at 100.
                    ASSERT_LE(length(apart), (with_target ? 2 : 1) * step * 0.867 + 2e-5);
                }
            }
        EXPECT_EQ(w.after.json["skins"].size(), 1u);
        EXPECT_EQ(w.after.target(0, 0, 0, "POSITION").component_type, 5122);
        EXPECT_EQ(w.after.target(0, 0, 0, "NORMAL"), w.before.target(0, 0, 0, "NORMAL"));
        // Its weights went along, and so did what animates them.
        const Json& node = node_of(w.after, 0);
        EXPECT_EQ(node["weights"], Json({0.5}));
        EXPECT_EQ(w.after.json["meshes"][0]["weights"], Json({0.25}));
        const auto target = w.after.json["animations"][0]["channels"][0]["target"]["node"];
        EXPECT_EQ(w.after.json["nodes"][target.get<std::size_t>()], node);
        EXPECT_EQ(w.after.json["nodes"][0]["translation"], Json({4, 5, 6}));
        EXPECT_EQ(w.after.json["nodes"][0]["children"], Json({target}));
        EXPECT_FALSE(w.after.json["nodes"][0].contains("mesh"));
    }
}

// Two meshes of one skin, each with a grid of its own.
TEST(GltfQuantize, ASkinThatTwoMeshesShareIsCopied) {
    GltfSource d = rig(true);
    GltfSource::Json other = d.json["meshes"][0];
    std::vector<float> places(std::size_t(3 * side * side), 2);
    places[0] = 7;
    other["primitives"][0]["attributes"]["POSITION"] = d.add_positions(places);
    d.json["meshes"].push_back(other);
    d.json["nodes"].push_back({{"mesh", 1}, {"skin", 0}});
    d.json["scenes"][0]["nodes"].push_back(3);
    const Written w = written(d, {14, 12, 12, 16});
    EXPECT_EQ(w.after.fault(), "");
    ASSERT_EQ(w.after.json["skins"].size(), 2u);
    for (const std::size_t mesh : {0, 1}) {
        const Json& skin = w.after.json["skins"][node_of(w.after, mesh)["skin"].get<std::size_t>()];
        // The first joint's matrix moves by (−1, −2, −3): the grid's origin is what is beside that.
        const Numbers m = w.after.accessor(skin["inverseBindMatrices"].get<std::size_t>()).at(0);
        EXPECT_NEAR(m[12] + 1, node_of(w.after, mesh)["translation"][0].get<double>(), 1e-4);
        EXPECT_NEAR(m[0], node_of(w.after, mesh)["scale"][0].get<double>(), 1e-9);
    }
}

// A crowd: nodes of one mesh and one skin need no skin each.
TEST(GltfQuantize, NodesOfOneMeshKeepOneSkin) {
    GltfSource d = rig(true);
    for (int k = 0; k < 3; ++k) {
        d.json["nodes"].push_back({{"mesh", 0}, {"skin", 0}});
        d.json["scenes"][0]["nodes"].push_back(3 + k);
    }
    const Written w = written(d, {14, 12, 12, 16});
    EXPECT_EQ(w.after.fault(), "");
    EXPECT_EQ(w.after.json["skins"].size(), 1u);
    std::size_t nodes = 0;
    for (const Json& node : w.after.json["nodes"]) {
        if (!node.contains("mesh")) continue;
        ++nodes;
        EXPECT_EQ(node.value("skin", -1), 0);
    }
    EXPECT_EQ(nodes, 4u);
}

// Pointers to weights go where the weights went, others stay.
TEST(GltfQuantize, AnimationPointersFollowTheWeights) {
    GltfSource d = rig(true);
    d.json["extensionsUsed"] = {"KHR_animation_pointer"};
    const std::vector<std::string> pointers{"/nodes/0/weights", "/nodes/0/weights/0",
                                            "/nodes/0/translation", "/nodes/1/weights",
                                            "/meshes/0/weights"};
    for (const std::string& pointer : pointers)
        d.json["animations"][0]["channels"].push_back(
            {{"sampler", 0},
             {"target",
              {{"path", "pointer"},
               {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
    const Written w = written(d, {14, 12, 12, 16});
    const Json& channels = w.after.json["animations"][0]["channels"];
    const auto pointer = [&](std::size_t channel) {
        return channels.at(channel)["target"]["extensions"]["KHR_animation_pointer"]["pointer"]
            .get<std::string>();
    };
    const std::string child =
        "/nodes/" + std::to_string(channels.at(0)["target"]["node"].get<std::size_t>());
    EXPECT_NE(child, "/nodes/0");
    EXPECT_EQ(pointer(1), child + "/weights");
    EXPECT_EQ(pointer(2), child + "/weights/0");
    for (const std::size_t k : {3, 4, 5}) EXPECT_EQ(pointer(k), pointers[k - 1]);
}

// Values by corner, in the order of the triangles' values: whatever the order of the vertices.
std::vector<Numbers> corners_of(const std::filesystem::path& file) {
    const auto scene = prep::load_scene(file);
    if (!scene) throw std::runtime_error(prep::to_string(scene.error()));
    std::vector<Numbers> out;
    for (const prep::Mesh& mesh : scene->meshes)
        for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
            const glm::vec3 p = mesh.positions[mesh.corner_vertices[c]];
            const glm::vec3 n = mesh.normals.values[mesh.normals.indices[c]];
            const glm::vec2 uv = mesh.uvs[0].values[mesh.uvs[0].indices[c]];
            out.push_back({p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y});
        }
    std::sort(out.begin(), out.end());
    return out;
}

TEST(GltfQuantize, CompressionComesAfterItAndChangesNothing) {
    const test::TempDir dir;
    const GltfSource source = one_sheet();
    source.write(dir / "a.glb");
    const auto save = [&](const char* from, const char* to, Compression compression) {
        auto scene = prep::load_scene(dir / from);
        prep::SaveOptions options;
        options.quantization = {12, 8, 10, 12};
        options.compression = compression;
        ASSERT_TRUE(prep::save_scene(test::untouched(*std::move(scene)), dir / to, options));
    };
    save("a.glb", "plain.glb", Compression::none);
    save("a.glb", "draco.glb", Compression::draco);
    save("a.glb", "meshopt.glb", Compression::meshopt);
    const auto plain = corners_of(dir / "plain.glb");
    EXPECT_EQ(corners_of(dir / "draco.glb"), plain);
    EXPECT_EQ(corners_of(dir / "meshopt.glb"), plain);
    // A file that came compressed is compressed by the same codec again.
    const auto uses = [&](const char* name, const char* extension) {
        const Json used = test::GltfFile(dir / name).json["extensionsRequired"];
        return std::find(used.begin(), used.end(), Json(extension)) != used.end();
    };
    save("draco.glb", "draco2.glb", Compression::keep);
    save("meshopt.glb", "meshopt2.glb", Compression::keep);
    EXPECT_TRUE(uses("draco2.glb", "KHR_draco_mesh_compression"));
    EXPECT_TRUE(uses("draco2.glb", "KHR_mesh_quantization"));
    EXPECT_TRUE(uses("meshopt2.glb", "EXT_meshopt_compression"));
    // 48 bytes a vertex became 24; indices and JSON stayed.
    EXPECT_LT(std::filesystem::file_size(dir / "plain.glb"),
              std::filesystem::file_size(dir / "a.glb") * 3 / 4);
}

TEST(GltfQuantize, TheValidatorFindsNoErrorsInIt) {
    MESHPREP_REQUIRE_NPM(validator, "gltf-validator");
    const test::TempDir dir;
    Json list = Json::array();
    const auto add = [&](const GltfSource& source, const std::string& name,
                         const Quantization& bits, Compression compression) {
        source.write(dir / "in.glb");
        auto scene = prep::load_scene(dir / "in.glb");
        prep::SaveOptions options;
        options.quantization = bits;
        options.compression = compression;
        ASSERT_TRUE(prep::save_scene(test::untouched(*std::move(scene)), dir / name, options));
        list.push_back(
            {{"name", name}, {"output", (dir / name).string()}, {"before", Json::object()}});
    };
    int count = 0;
    for (const Compression c : {Compression::none, Compression::draco, Compression::meshopt})
        for (const Quantization& bits :
             {Quantization{16, 16, 16, 16}, Quantization{8, 8, 8, 8}, Quantization{5, 9, 11, 7}})
            for (const char* ending : {".glb", ".gltf"}) {
                add(one_sheet(), std::to_string(count++) + ending, bits, c);
                add(rig(bits.positions == 8), std::to_string(count++) + ending, bits, c);
            }
    EXPECT_TRUE(test::validates(validator, list, dir / "list.json"))
        << "its complaints stand above";
}

TEST(GltfQuantize, WhatCannotBeIsAnError) {
    const test::TempDir dir;
    auto scene = one_sheet().read();
    const prep::PreparedScene prepared = test::untouched(*std::move(scene));
    prep::SaveOptions options;
    options.quantization.normals = 12;
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.off"}) {
        const auto notes = prep::save_scene(prepared, dir / name, options);
        ASSERT_FALSE(notes.has_value());
        EXPECT_EQ(notes.error().code, prep::ErrorCode::unsupported);
        EXPECT_NE(notes.error().text.find("write .glb or .gltf"), std::string::npos);
    }
    for (const prep::QuantizationRow& row : prep::quantization_rows)
        for (const int bits : {-1, row.least - 1, row.most + 1}) {
            options.quantization = {};
            options.quantization.*row.bits = bits;
            const auto notes = prep::save_scene(prepared, dir / "a.glb", options);
            ASSERT_FALSE(notes.has_value());
            EXPECT_EQ(notes.error().code, prep::ErrorCode::invalid);
            EXPECT_NE(notes.error().text.find(row.name), std::string::npos);
        }
    EXPECT_TRUE(dir.names().empty());
}

// Numbers that no grid holds, and boxes without an extent.
TEST(GltfQuantize, OddMeshesAreWrittenAsTheyCanBe) {
    const auto with_positions = [](const std::vector<float>& p) {
        GltfSource d;
        d.mesh({{{"attributes", {{"POSITION", d.add_positions(p)}}}}});
        return d;
    };
    const Quantization bits{16, 16, 16, 16};
    const Written point = written(with_positions({5, 5, 5, 5, 5, 5, 5, 5, 5}), bits);
    EXPECT_EQ(placed(node_of(point.after, 0), point.after.attribute(0, 0, "POSITION").at(1)),
              (Numbers{5, 5, 5}));
    EXPECT_EQ(point.report.rows[0].largest, 0);
    const Written tiny = written(with_positions({0, 0, 0, 1e-38f, 0, 0, 0, 1e-38f, 0}), bits);
    EXPECT_EQ(tiny.after.attribute(0, 0, "POSITION"), tiny.before.attribute(0, 0, "POSITION"));
    EXPECT_EQ(tiny.report.rows[0].kept, 3u);
    const Written huge = written(with_positions({-3e38f, 0, 0, 3e38f, 0, 0, 0, 3e38f, 0}), bits);
    EXPECT_EQ(huge.after.fault(), "");
    EXPECT_LT(huge.report.rows[0].largest, 1.4e-5);
}

// Numbers beyond floats in steps of the grid: the whole mesh stays as it is.
TEST(GltfQuantize, WhatFloatsDoNotHoldInStepsStays) {
    GltfSource moved;
    moved.mesh(
        {{{"attributes",
           {{"POSITION", moved.add_positions({0, 0, 0, 1e-30f, 0, 0, 0, 1e-30f, 0})}}},
          {"targets", {{{"POSITION", moved.add_positions({0, 0, 1e4f, 0, 0, 0, 0, 0, 0})}}}}}});
    GltfSource skinned = rig(true);
    skinned.json["skins"][0]["inverseBindMatrices"] =
        skinned.add_floats("MAT4", {1e37f, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,
                                    1,     0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    for (const GltfSource& source : {moved, skinned}) {
        const Written w = written(source, {16, 0, 0, 0});
        EXPECT_EQ(w.after.fault(), "");
        EXPECT_EQ(w.after.attribute(0, 0, "POSITION"), w.before.attribute(0, 0, "POSITION"));
        EXPECT_EQ(w.after.target(0, 0, 0, "POSITION"), w.before.target(0, 0, 0, "POSITION"));
        EXPECT_EQ(w.after.json["nodes"].size(), w.before.json["nodes"].size());
        EXPECT_EQ(w.report.rows[0].values, 0u);
        EXPECT_FALSE(w.report.remarks.empty());
    }
}

// A material that a variant alone has counts, too.
TEST(GltfQuantize, LengthsOfVariantsMaterialsStay) {
    GltfSource d = one_sheet();
    d.json["extensionsUsed"] = {"KHR_materials_volume", "KHR_materials_variants"};
    d.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "glass"}}};
    d.json["materials"] = {GltfSource::Json::object(),
                           {{"extensions", {{"KHR_materials_volume", {{"thicknessFactor", 1}}}}}}};
    auto& primitive = d.json["meshes"][0]["primitives"][0];
    primitive["material"] = 0;
    primitive["extensions"]["KHR_materials_variants"]["mappings"] = {
        {{"material", 1}, {"variants", {0}}}};
    const Written w = written(d, {16, 0, 0, 0});
    EXPECT_EQ(w.after.attribute(0, 0, "POSITION"), w.before.attribute(0, 0, "POSITION"));
}

// Of a direction its length says nothing: short ones keep all bits, long ones are no reason to
// stay.
TEST(GltfQuantize, DirectionsOfAnyLengthAreRoundedAlike) {
    GltfSource d;
    Json primitive{{"attributes",
                    {{"POSITION", d.add_positions({0, 0, 0, 1, 0, 0})},
                     {"NORMAL", d.add_floats("VEC3", {0.002f, 0.001f, 0.0003f, 3, 2, 1})}}},
                   {"mode", 1}};
    d.mesh({primitive});
    const Written w = written(d, {0, 8, 0, 0});
    EXPECT_EQ(w.report.rows[1].values, 2u);
    const auto before = w.before.attribute(0, 0, "NORMAL"),
               after = w.after.attribute(0, 0, "NORMAL");
    for (const std::size_t i : {0, 1}) EXPECT_LT(degrees_apart(before.at(i), after.at(i)), 0.4);
}

}  // namespace
