// Scenes that did not come from glTF, as glTF files: every value that was put in stands in the file
// where the specification has it.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>

#include "formats/gltf/nodes/sheared_matrix.h"
#include "gltf_motion.h"
#include "mesh_files.h"
#include "model/trs.h"
#include "prep/save.h"
#include "written_gltf.h"

namespace {

using Json = test::GltfFile::Json;
using Numbers = std::vector<double>;
using Indices = std::vector<std::size_t>;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

// A triangle for each three corners; vertex v at (v, 2v, −3v) unless said otherwise.
prep::Mesh mesh_of(const std::vector<std::uint32_t>& corners, std::size_t vertices) {
    prep::Mesh mesh;
    for (std::size_t v = 0; v < vertices; ++v)
        mesh.positions.push_back({float(v), float(2 * v), -float(3 * v)});
    mesh.corner_vertices = corners;
    for (std::uint32_t c = 3; c <= corners.size(); c += 3) mesh.face_offsets.push_back(c);
    return mesh;
}

// A value of its own for every corner.
template <class T>
prep::CornerLayer<T> layer(std::size_t corners, float first, float step) {
    prep::CornerLayer<T> out;
    for (std::uint32_t c = 0; c < corners; ++c) {
        T value{};
        for (int k = 0; k < T::length(); ++k)
            value[k] = first + step * (float(c) + float(k) / float(T::length()));
        out.values.push_back(value);
        out.indices.push_back(c);
    }
    return out;
}

template <class T>
Numbers numbers(const T& v) {
    Numbers out;
    for (int k = 0; k < T::length(); ++k) out.push_back(double(v[k]));
    return out;
}

prep::Scene scene_of(prep::Mesh mesh) {
    prep::Scene scene;
    scene.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(scene);
    return scene;
}

struct Saved {
    test::GltfFile file;
    std::vector<std::string> notes;
};

Saved saved(prep::Scene scene, const std::string& name = "a.glb") {
    const test::TempDir dir;
    auto notes = prep::save_scene(test::untouched(std::move(scene)), dir / name);
    EXPECT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    test::GltfFile file(dir / name);
    EXPECT_EQ(file.fault(), "");
    return {std::move(file), notes ? *notes : std::vector<std::string>{}};
}

TEST(GltfBuild, EveryCornerKeepsItsAttributes) {
    // Two triangles of material 1 around one of material 0.
    prep::Mesh mesh = mesh_of({0, 1, 2, 2, 1, 3, 3, 4, 0}, 5);
    mesh.face_materials = {1, 0, 1};
    mesh.normals = layer<glm::vec3>(9, 0.125f, 0.5f);
    mesh.tangents = layer<glm::vec4>(9, -3, 0.25f);
    mesh.uvs = {layer<glm::vec2>(9, 7, 1), layer<glm::vec2>(9, -20, 2)};
    mesh.colors = {layer<glm::vec4>(9, 0, 0.0625f), layer<glm::vec4>(9, 0.25f, 0.03125f)};
    prep::Scene scene = scene_of(mesh);
    scene.materials.resize(2);
    for (const char* name : {"a.glb", "a.gltf"}) {
        const test::GltfFile file = saved(scene, name).file;
        ASSERT_EQ(file.json["meshes"][0]["primitives"].size(), 2u);
        for (std::size_t p = 0; p < 2; ++p) {
            EXPECT_EQ(file.primitive(0, p)["material"], p);
            const Indices corners = p == 0 ? Indices{3, 4, 5} : Indices{0, 1, 2, 6, 7, 8};
            const Indices indices = file.triangles(0, p);
            ASSERT_EQ(indices.size(), corners.size());
            const auto expect = [&](const std::string& semantic, const char* type, const auto& at) {
                const test::GltfValues values = file.attribute(0, p, semantic);
                EXPECT_EQ(values.type, type);
                EXPECT_EQ(values.component_type, 5126);
                for (std::size_t i = 0; i < indices.size(); ++i)
                    EXPECT_EQ(values.at(indices[i]), numbers(at(corners[i])))
                        << semantic << " of corner " << corners[i];
            };
            expect("POSITION", "VEC3",
                   [&](std::size_t c) { return mesh.positions[mesh.corner_vertices[c]]; });
            expect("NORMAL", "VEC3", [&](std::size_t c) { return mesh.normals.values[c]; });
            expect("TANGENT", "VEC4", [&](std::size_t c) { return mesh.tangents.values[c]; });
            expect("TEXCOORD_0", "VEC2", [&](std::size_t c) { return mesh.uvs[0].values[c]; });
            expect("TEXCOORD_1", "VEC2", [&](std::size_t c) { return mesh.uvs[1].values[c]; });
            expect("COLOR_0", "VEC4", [&](std::size_t c) { return mesh.colors[0].values[c]; });
            expect("COLOR_1", "VEC4", [&](std::size_t c) { return mesh.colors[1].values[c]; });
        }
    }
}

// The faces of a cube face their axis: each vertex is three, each with the normal of its face.
TEST(GltfBuild, SplitVerticesHaveTheNormalOfTheirFace) {
    prep::Mesh mesh;
    for (int v = 0; v < 8; ++v)
        mesh.positions.push_back({float(v & 1), float(v >> 1 & 1), float(v >> 2 & 1)});
    const std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    const glm::vec3 normals[6] = {{0, 0, -1}, {0, 0, 1},  {0, -1, 0},
                                  {0, 1, 0},  {-1, 0, 0}, {1, 0, 0}};
    for (const auto& quad : quads) {
        mesh.corner_vertices.insert(mesh.corner_vertices.end(), quad, quad + 4);
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    prep::PrepareOptions options;
    options.hard_edges.angle_degrees = 60;
    const auto prepared = prep::prepare(scene_of(mesh), options);
    ASSERT_TRUE(prepared.has_value());
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(*prepared, dir / "a.glb").has_value());
    const test::GltfFile file(dir / "a.glb");
    EXPECT_EQ(file.fault(), "");
    const Indices indices = file.triangles(0, 0);
    const test::GltfValues at = file.attribute(0, 0, "POSITION"),
                           normal = file.attribute(0, 0, "NORMAL");
    ASSERT_EQ(indices.size(), 36u);
    EXPECT_EQ(at.count(), 24u);
    for (std::size_t c = 0; c < 36; ++c) {
        const std::size_t face = c / 6;
        EXPECT_EQ(normal.at(indices[c]), numbers(normals[face]));
        bool corner_of_face = false;
        for (const std::uint32_t v : quads[face])
            corner_of_face |= at.at(indices[c]) == numbers(mesh.positions[v]);
        EXPECT_TRUE(corner_of_face) << "corner " << c;
    }
}

TEST(GltfBuild, LinesAndPointsAreOfTheirVertices) {
    prep::Mesh mesh = mesh_of({0, 1, 2}, 8);
    mesh.line_offsets = {0, 3, 5};
    mesh.line_vertices = {3, 4, 5, 6, 3};
    mesh.points = {7, 0};
    mesh.normals = layer<glm::vec3>(3, 0, 1);
    mesh.uvs = {layer<glm::vec2>(3, 0, 1)};
    for (int v = 0; v < 8; ++v) mesh.vertex_colors.push_back({float(v) / 8, 1, 0.5f, 1});
    const test::GltfFile file = saved(scene_of(mesh)).file;
    ASSERT_EQ(file.json["meshes"][0]["primitives"].size(), 3u);
    EXPECT_FALSE(file.primitive(0, 0).contains("mode"));
    EXPECT_EQ(file.primitive(0, 1)["mode"], 1);
    EXPECT_EQ(file.primitive(0, 2)["mode"], 0);
    const Indices expected[2] = {{3, 4, 4, 5, 6, 3}, {7, 0}};
    for (std::size_t p = 1; p < 3; ++p) {
        const Json& attributes = file.primitive(0, p)["attributes"];
        EXPECT_FALSE(attributes.contains("NORMAL") || attributes.contains("TEXCOORD_0"));
        const Indices indices = file.indices(0, p);
        ASSERT_EQ(indices.size(), expected[p - 1].size());
        for (std::size_t i = 0; i < indices.size(); ++i) {
            const std::size_t v = expected[p - 1][i];
            EXPECT_EQ(file.attribute(0, p, "POSITION").at(indices[i]), numbers(mesh.positions[v]));
            // A vertex of a face has its corner's colour, and here corners have none: white.
            EXPECT_EQ(file.attribute(0, p, "COLOR_0").at(indices[i]),
                      (v < 3 ? Numbers{1, 1, 1, 1} : Numbers{double(v) / 8, 1, 0.5, 1}));
        }
    }
}

TEST(GltfBuild, WhatIsNotFiniteIsLeftOutAndTold) {
    prep::Mesh mesh = mesh_of({0, 1, 2, 1, 2, 3, 4, 5, 6, 2, 4, 1}, 7);
    mesh.positions[3].y = nan;
    mesh.positions[5].z = -inf;
    mesh.line_offsets = {0, 2, 4};
    mesh.line_vertices = {0, 3, 4, 6};
    mesh.points = {5, 6};
    mesh.uvs = {layer<glm::vec2>(12, 1, 1)};
    mesh.uvs[0].values[1].y = inf;
    mesh.colors = {layer<glm::vec4>(12, 0, 0.0625f)};
    mesh.colors[0].values[0] = {-0.5f, 1.5f, nan, 1};
    const Saved out = saved(scene_of(mesh));
    const auto& file = out.file;
    ASSERT_EQ(file.json["meshes"][0]["primitives"].size(), 3u);
    const Indices corners = {0, 1, 2, 9, 10, 11}, indices = file.triangles(0, 0);
    ASSERT_EQ(indices.size(), corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const std::size_t c = corners[i];
        EXPECT_EQ(file.attribute(0, 0, "POSITION").at(indices[i]),
                  numbers(mesh.positions[mesh.corner_vertices[c]]));
        EXPECT_EQ(file.attribute(0, 0, "TEXCOORD_0").at(indices[i]),
                  c == 1 ? (Numbers{0, 0}) : numbers(mesh.uvs[0].values[c]));
        EXPECT_EQ(file.attribute(0, 0, "COLOR_0").at(indices[i]),
                  c == 0 ? (Numbers{0, 1, 0, 1}) : numbers(mesh.colors[0].values[c]));
    }
    EXPECT_EQ(file.attribute(0, 1, "POSITION").at(file.indices(0, 1)[1]),
              numbers(mesh.positions[6]));
    EXPECT_EQ(file.indices(0, 1).size(), 2u);
    EXPECT_EQ(file.indices(0, 2).size(), 1u);
    EXPECT_EQ(out.notes, (std::vector<std::string>{
                             "UVs that are not finite were written as 0",
                             "vertex colours outside 0 … 1 were clamped",
                             "2 triangles with a position that is not finite left out",
                             "1 line segment with a position that is not finite left out",
                             "1 point with a position that is not finite left out"}));
}

TEST(GltfBuild, IndicesAreTheSmallestTypeThatHoldsThem) {
    // 65535 as a 16-bit index is primitive restart: the last vertex may be 65534.
    for (const std::uint32_t vertices : {65535u, 65536u}) {
        std::vector<std::uint32_t> corners(65535);
        for (std::uint32_t c = 0; c < 65535; ++c) corners[c] = c;
        corners.insert(corners.end(), {0, 1, vertices - 1});
        const test::GltfFile file = saved(scene_of(mesh_of(corners, vertices))).file;
        const test::GltfValues indices = file.accessor(file.primitive(0, 0)["indices"]);
        EXPECT_EQ(indices.component_type, vertices == 65535 ? 5123 : 5125);
        EXPECT_EQ(indices.values.back(), double(vertices - 1));
        EXPECT_EQ(file.attribute(0, 0, "POSITION").at(vertices - 1),
                  (Numbers{double(vertices - 1), 2.0 * (vertices - 1), -3.0 * (vertices - 1)}));
    }
}

TEST(GltfBuild, NodesKeepTheirTree) {
    prep::Scene scene;
    scene.name = "stage";
    scene.meshes = {prep::Mesh{}, mesh_of({0, 1, 2}, 3)};  // the first has nothing to draw
    scene.meshes[0].name = "nothing";
    scene.meshes[1].name = "triangle";
    scene.cameras.resize(2);
    scene.nodes.resize(5);
    scene.nodes[0].name = "root";
    scene.nodes[0].mesh = 0;
    scene.nodes[1].parent = 3;
    scene.nodes[1].mesh = 1;
    const std::vector<double> matrix{0.6, 0.8, 0, 0, -2.4, 1.8, 0, 0, 0, 0, -0.1, 0, 7, 8, 9, 1};
    std::copy(matrix.begin(), matrix.end(), &scene.nodes[1].transform[0][0]);
    scene.nodes[2].parent = 0;
    scene.nodes[2].camera = 1;
    scene.nodes[3].name = "second root";
    scene.nodes[4].parent = 0;
    const Saved out = saved(scene);
    const Json& json = out.file.json;
    EXPECT_EQ(json["scene"], 0);
    EXPECT_EQ(json["scenes"], (Json{{{"name", "stage"}, {"nodes", {0, 3}}}}));
    EXPECT_EQ(json["meshes"].size(), 1u);
    EXPECT_EQ(json["meshes"][0]["name"], "triangle");
    EXPECT_EQ(out.notes, std::vector<std::string>{"mesh 'nothing' has nothing to draw: left out"});
    const Json& nodes = json["nodes"];
    ASSERT_EQ(nodes.size(), 5u);
    EXPECT_EQ(nodes[0], (Json{{"name", "root"}, {"children", {2, 4}}}));
    EXPECT_EQ(nodes[2], (Json{{"camera", 1}}));
    EXPECT_EQ(nodes[3], (Json{{"name", "second root"}, {"children", {1}}}));
    EXPECT_EQ(nodes[4], Json::object());
    EXPECT_EQ(nodes[1]["mesh"], 0);
    EXPECT_EQ(nodes[1]["matrix"].get<Numbers>(), matrix);
}

glm::dmat4 random_matrix(std::mt19937_64& random, int kind) {
    std::normal_distribution<double> number(0, 1);
    glm::dmat4 m(1.0);
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 3; ++r) m[c][r] = number(random);
    const auto flatten = [&](int column, int like) { m[column] = number(random) * m[like]; };
    if (kind == 1) flatten(2, 0);
    if (kind == 2) flatten(0, 2), flatten(1, 2);
    if (kind == 3) m[1] = glm::dvec4(0.0);
    if (kind == 4) m = glm::dmat4(glm::dmat3(0.0));
    if (kind == 5) m[1] = m[0] + 1e-5 * m[1];
    if (kind == 6 || kind == 7)
        for (int c = 0; c < 3; ++c) m[c] *= kind == 6 ? 1e-150 : 1e150;
    return m;
}

void expect_near(const glm::dmat4& a, const glm::dmat4& b, double bound) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) EXPECT_NEAR(a[c][r], b[c][r], c == 3 ? 0 : bound) << c << r;
}

// glTF's nodes have neither shear nor, as matrices, no thickness.
TEST(GltfBuild, ShearedNodesAreANodeWithinAnother) {
    std::mt19937_64 random(5);
    for (int n = 0; n < 400; ++n) {
        SCOPED_TRACE(n);
        const glm::dmat4 m = random_matrix(random, n % 8);
        EXPECT_FALSE(prep::detail::is_scaled_rotation(m));
        const auto [outer, inner] = prep::detail::as_two_nodes(m);
        EXPECT_EQ(inner.scale, glm::dvec3(1.0));
        EXPECT_EQ(inner.translation, glm::dvec3(0.0));
        double size = 0;
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) size = std::max(size, std::abs(m[c][r]));
        expect_near(outer.matrix() * inner.matrix(), m, 4e-15 * size);
    }
    EXPECT_FALSE(prep::detail::is_scaled_rotation(glm::dmat4(std::nan(""))));
}

TEST(GltfBuild, LargeMatricesAreNumbers) {
    glm::dmat4 turned = glm::rotate(glm::dmat4(1.0), 1.0, glm::dvec3(1, 2, 3));
    turned[0] *= -4, turned[2] *= 1e-3;
    for (const double scale : {1e-6, 1.0, 1e6}) {
        glm::dmat4 m = glm::scale(turned, glm::dvec3(scale));
        m[3] = glm::dvec4(1, 2, 3, 1);
        for (const glm::dmat4& one : {m, glm::dmat4(glm::mat4(m))}) {  // rounded to floats
            EXPECT_TRUE(prep::detail::is_scaled_rotation(one));
            expect_near(prep::detail::trs_of(one).matrix(), one, (one == m ? 4e-15 : 1e-6) * scale);
        }
        prep::Scene scene = scene_of(mesh_of({0, 1, 2}, 3));
        scene.nodes[0].transform = m;
        const Saved out = saved(scene);
        const Json& node = out.file.json["nodes"][0];
        EXPECT_EQ(node.contains("matrix"), scale <= 1);
        EXPECT_EQ(node.contains("scale"), scale > 1);
        expect_near(test::GltfMotion(out.file).world(-1, 0)[0], m, 4e-15 * scale);
    }
}

TEST(GltfBuild, WhatIsInShearedNodesStaysInItsPlace) {
    std::mt19937_64 random(6);
    prep::Scene scene = scene_of(mesh_of({0, 1, 2}, 3));
    scene.cameras.resize(1);
    scene.nodes.assign(5, {});
    scene.nodes[0].name = "sheared";
    scene.nodes[0].mesh = 0;
    scene.nodes[1].parent = 0;
    scene.nodes[2].parent = 1;
    scene.nodes[2].camera = 0;
    scene.nodes[3].parent = 2;
    scene.nodes[3].mesh = 0;
    scene.nodes[4].mesh = 0;
    for (const int n : {0, 2, 3, 4})
        scene.nodes[std::size_t(n)].transform = random_matrix(random, 0);
    scene.nodes[4].transform[2] = glm::dvec4(0.0);  // flat
    std::vector<glm::dmat4> expected;
    for (const prep::Node& node : scene.nodes)
        expected.push_back(node.parent == prep::no_index ? node.transform
                                                         : expected[node.parent] * node.transform);
    const Saved out = saved(scene);
    const Json& nodes = out.file.json["nodes"];
    ASSERT_EQ(nodes.size(), 9u);
    EXPECT_EQ(nodes[0]["name"], "sheared");
    EXPECT_EQ(nodes[0]["mesh"], 0);
    EXPECT_EQ(nodes[2]["camera"], 0);
    for (const Json& node : nodes) EXPECT_FALSE(node.contains("matrix"));
    const auto world = test::GltfMotion(out.file).world(-1, 0);
    for (std::size_t n = 0; n < 5; ++n)
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r)
                EXPECT_NEAR(world[n][c][r], expected[n][c][r], 1e-13) << n << c << r;
}

// Positions are floats about an origin that floats cannot hold: nodes carry it in doubles.
TEST(GltfBuild, MeshesFarFromZeroStayInTheirPlace) {
    const glm::dvec3 origin(5000000.1, -3000000.7, 10.3);
    for (const bool turned : {false, true}) {
        prep::Scene scene;
        scene.meshes = {prep::Mesh{}, mesh_of({0, 1, 2}, 3), mesh_of({2, 1, 0}, 3)};
        scene.meshes[1].origin = origin;
        scene.meshes[2].origin = -origin;
        scene.nodes.resize(3);
        scene.nodes[0].mesh = 1;
        scene.nodes[1].parent = turned ? 0 : prep::no_index;
        scene.nodes[2].mesh = 2;
        // x → y → −x, then moved.
        const glm::dmat4 matrix(0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1);
        if (turned) scene.nodes[0].transform = scene.nodes[2].transform = matrix;
        const Json nodes = saved(scene).file.json["nodes"];
        const Json first = {{"translation", {origin.x, origin.y, origin.z}}, {"mesh", 0}};
        const Json second = {{"translation", {-origin.x, -origin.y, -origin.z}}, {"mesh", 1}};
        if (!turned) {
            EXPECT_EQ(nodes, Json({first, Json::object(), second}));
            continue;
        }
        const Json places = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1};
        EXPECT_EQ(nodes, Json({{{"matrix", places}, {"children", {1, 3}}},
                               Json::object(),
                               {{"matrix", places}, {"children", {4}}},
                               first,
                               second}));
    }
}

TEST(GltfBuild, LightsKeepTheirKindColourRangeAndCones) {
    prep::Scene scene = scene_of(mesh_of({0, 1, 2}, 3));
    using prep::LightKind;
    for (const LightKind kind :
         {LightKind::directional, LightKind::ambient, LightKind::point, LightKind::spot}) {
        prep::Light light;
        light.kind = kind;
        light.color = {0.25f, 0.5f, 0.75f};
        light.intensity = 3 + float(scene.lights.size());
        light.range = 20 + float(scene.lights.size());
        light.inner_cone = 0.25f;
        light.outer_cone = 0.5f;
        light.name = "light " + std::to_string(scene.lights.size());
        prep::Node node;
        node.light = std::uint32_t(scene.lights.size());
        scene.nodes.push_back(node);
        scene.lights.push_back(light);
    }
    // Colours above 1 are not allowed: the same light is brighter.
    scene.lights[2].color = {0.5f, 4, 2};
    scene.lights[3].range = 0;
    const Saved out = saved(scene);
    const Json& json = out.file.json;
    EXPECT_EQ(out.notes, std::vector<std::string>{"1 ambient light left out: glTF has none"});
    EXPECT_EQ(json["extensionsUsed"], Json::array({"KHR_lights_punctual"}));
    EXPECT_EQ(json["extensions"]["KHR_lights_punctual"]["lights"],
              (Json{{{"type", "directional"},
                     {"color", {0.25, 0.5, 0.75}},
                     {"intensity", 3},
                     {"name", "light 0"}},
                    {{"type", "point"},
                     {"color", {0.125, 1, 0.5}},
                     {"intensity", 20},  // 5 · 4
                     {"range", 22},
                     {"name", "light 2"}},
                    {{"type", "spot"},
                     {"color", {0.25, 0.5, 0.75}},
                     {"intensity", 6},
                     {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}},
                     {"name", "light 3"}}}));
    const auto light_of = [&](std::size_t node) {
        return json["nodes"][node].value("/extensions/KHR_lights_punctual/light"_json_pointer, -1);
    };
    EXPECT_EQ(light_of(1), 0);
    EXPECT_EQ(light_of(2), -1);  // the ambient one
    EXPECT_EQ(light_of(3), 1);
    EXPECT_EQ(light_of(4), 2);
}

TEST(GltfBuild, ConesOfAQuarterTurnAreNoWiderThanThat) {
    prep::Scene scene;
    scene.lights.emplace_back();
    scene.lights[0].kind = prep::LightKind::spot;
    scene.lights[0].outer_cone = float(std::acos(-1.0) / 2);  // the nearest float, which is above
    scene.nodes.emplace_back();
    scene.nodes[0].light = 0;
    const Saved out = saved(scene);
    const Json& spot = out.file.json["extensions"]["KHR_lights_punctual"]["lights"][0]["spot"];
    EXPECT_LE(spot["outerConeAngle"].get<double>(), std::acos(-1.0) / 2);
    EXPECT_GT(spot["outerConeAngle"].get<double>(), std::acos(-1.0) / 2 - 1e-6);
}

TEST(GltfBuild, CamerasKeepTheirLens) {
    prep::Scene scene = scene_of(mesh_of({0, 1, 2}, 3));
    scene.cameras.resize(3);
    scene.cameras[0].name = "near";
    scene.cameras[0].yfov = 0.7;
    scene.cameras[0].aspect = 1.5;
    scene.cameras[0].znear = 0.1;
    scene.cameras[0].zfar = 100.1;
    scene.cameras[1].yfov = 1.1;
    scene.cameras[1].znear = 0.3;
    scene.cameras[2].perspective = false;
    scene.cameras[2].xmag = 2.2;
    scene.cameras[2].ymag = 3.3;
    scene.cameras[2].znear = 0.4;
    scene.cameras[2].zfar = 50.5;
    EXPECT_EQ(
        saved(scene).file.json["cameras"],
        (Json{{{"name", "near"},
               {"type", "perspective"},
               {"perspective",
                {{"yfov", 0.7}, {"aspectRatio", 1.5}, {"znear", 0.1}, {"zfar", 100.1}}}},
              {{"type", "perspective"}, {"perspective", {{"yfov", 1.1}, {"znear", 0.3}}}},
              {{"type", "orthographic"},
               {"orthographic", {{"xmag", 2.2}, {"ymag", 3.3}, {"znear", 0.4}, {"zfar", 50.5}}}}}));
}

// glTF asks for a width: a square picture's, where the camera takes any picture's.
TEST(GltfBuild, OrthographicCamerasWithoutAWidthAreSquare) {
    prep::Scene scene = scene_of(mesh_of({0, 1, 2}, 3));
    scene.cameras.resize(1);
    scene.cameras[0].perspective = false;
    scene.cameras[0].xmag = 0;
    scene.cameras[0].ymag = 3.5;
    scene.cameras[0].zfar = 9;
    const Json lens = saved(scene).file.json["cameras"][0]["orthographic"];
    EXPECT_EQ(lens["xmag"], 3.5);
    EXPECT_EQ(lens["ymag"], 3.5);
}

// Nor without a far plane: it lies behind what is drawn, and readers take it.
TEST(GltfBuild, OrthographicCamerasWithoutAFarPlaneSeeAllThatIsDrawn) {
    prep::Scene scene = scene_of(mesh_of({0, 1, 2}, 3));  // as far as (2, 4, −6)
    scene.cameras.resize(1);
    scene.cameras[0].perspective = false;
    scene.cameras[0].znear = 0.5;
    prep::Node node;
    node.camera = 0;
    node.transform[3] = {0, 0, 40, 1};
    scene.nodes.push_back(node);
    const auto far_of = [](const prep::Scene& s) {
        return saved(s).file.json["cameras"][0]["orthographic"]["zfar"].get<double>();
    };
    EXPECT_GT(far_of(scene), 46);
    EXPECT_LT(far_of(scene), 60);
    scene.cameras[0].zfar = 41.5;
    EXPECT_EQ(far_of(scene), 41.5);
    // Nothing is drawn: beyond the near plane all the same.
    prep::Scene empty = scene_of(mesh_of({0, 1, 2}, 3));
    empty.cameras = scene.cameras;
    empty.cameras[0].zfar = 0;
    EXPECT_GT(far_of(empty), 0.5);
}

// JSON has no way to write them.
TEST(GltfBuild, NumbersOfScenesThatAreNotFiniteAreAnErrorWithTheirPlace) {
    for (const char* name : {"a.glb", "a.gltf"}) {
        prep::Scene scene;
        scene.cameras.emplace_back();
        scene.nodes.emplace_back();
        scene.nodes[0].camera = 0;
        const test::TempDir dir;
        const auto error_now = [&] {
            const auto saved = prep::save_scene(test::untouched(scene), dir / name);
            return saved ? "" : prep::to_string(saved.error());
        };
        EXPECT_EQ(error_now(), "");
        std::filesystem::remove(dir / name);
        scene.nodes[0].transform[3][1] = inf;
        EXPECT_EQ(error_now(), (dir / name).string() +
                                   ": the number at /nodes/0/matrix/13 is not finite, and glTF "
                                   "holds no such");
        scene.nodes[0].transform = glm::dmat4(1.0);
        scene.cameras[0].yfov = nan;
        EXPECT_EQ(error_now(), (dir / name).string() +
                                   ": the number at /cameras/0/perspective/yfov is not finite, "
                                   "and glTF holds no such");
        EXPECT_FALSE(std::filesystem::exists(dir / name));
    }
}

TEST(GltfBuild, TheBinaryIsNamedByAUri) {
    const test::TempDir dir;
    const std::string name = "a b#%c\303\244";  // ä in UTF-8
    ASSERT_TRUE(
        prep::save_scene(test::untouched(scene_of(mesh_of({0, 1, 2}, 3))), dir / (name + ".gltf"))
            .has_value());
    EXPECT_EQ(dir.names(), (std::vector<std::string>{name + ".bin", name + ".gltf"}));
    const test::GltfFile file(dir / (name + ".gltf"));
    EXPECT_EQ(file.json["buffers"][0]["uri"], "a%20b%23%25c%C3%A4.bin");
    EXPECT_EQ(file.fault(), "");
}

// A vertex that no triangle uses and that no file may hold, where all else is one primitive's.
TEST(GltfBuild, UnusedVertexThatIsNotFiniteIsLeftOut) {
    prep::Mesh mesh = mesh_of({0, 1, 2, 2, 1, 3}, 4);
    prep::PreparedScene prepared = test::untouched(scene_of(mesh));
    prep::VertexMesh& out = prepared.meshes[0];
    ASSERT_EQ(out.ranges.size(), 1u);
    out.positions.insert(out.positions.begin(), {0, nan, 0});
    for (std::uint32_t& i : out.indices) ++i;
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(prepared, dir / "a.glb").has_value());
    const test::GltfFile file(dir / "a.glb");
    EXPECT_EQ(file.fault(), "");
    const test::GltfValues positions = file.attribute(0, 0, "POSITION");
    const Indices indices = file.triangles(0, 0);
    ASSERT_EQ(indices.size(), 6u);
    for (std::size_t c = 0; c < 6; ++c)
        EXPECT_EQ(positions.at(indices[c]), numbers(mesh.positions[mesh.corner_vertices[c]]));
    EXPECT_EQ(file.json["accessors"][0]["count"], 4);
}

}  // namespace
