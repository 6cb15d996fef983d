// What `inspect` tells of a file, in JSON and in words, against counts made here from the file's
// faces.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <numbers>
#include <set>

#include "command_runner.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;
using test::write_text;

struct Shape {
    std::vector<glm::dvec3> vertices;
    std::vector<std::vector<std::size_t>> faces;
    std::string obj() const {
        std::string text;
        char line[80];
        for (const glm::dvec3& v : vertices) {
            std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", v.x, v.y, v.z);
            text += line;
        }
        for (const auto& face : faces) {
            text += "f";
            for (const std::size_t v : face) text += " " + std::to_string(v + 1);
            text += "\n";
        }
        return text;
    }
};

// A torus of quads, outwards, coordinates that floats hold.
Shape torus(std::size_t around, std::size_t across) {
    Shape shape;
    for (std::size_t i = 0; i < around; ++i)
        for (std::size_t j = 0; j < across; ++j) {
            const double u = 2 * std::numbers::pi * double(i) / double(around);
            const double v = 2 * std::numbers::pi * double(j) / double(across);
            const double r = 3 + std::cos(v);
            const glm::vec3 p(r * std::cos(u), r * std::sin(u), std::sin(v));
            shape.vertices.push_back(glm::dvec3(p));
        }
    const auto at = [&](std::size_t i, std::size_t j) { return i % around * across + j % across; };
    for (std::size_t i = 0; i < around; ++i)
        for (std::size_t j = 0; j < across; ++j)
            shape.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    return shape;
}

// What can be counted of a shape whose components share no vertex and whose open edges form loops
// without a common vertex.
struct Count {
    std::size_t triangles = 0, quads = 0, polygons = 0, largest_face = 0, corners = 0;
    std::size_t edges = 0, open = 0, bad = 0, mixed = 0, loops = 0, components = 0, points = 0;
    std::size_t valence = 0;
    double area = 0, volume = 0;
};
Count count(const Shape& shape) {
    Count out;
    std::vector<std::size_t> parent(shape.vertices.size()), rim(shape.vertices.size());
    for (std::size_t v = 0; v < parent.size(); ++v) parent[v] = rim[v] = v;
    const auto root = [](std::vector<std::size_t>& of, std::size_t v) {
        while (of[v] != v) v = of[v];
        return v;
    };
    std::map<std::pair<std::size_t, std::size_t>, std::pair<int, int>> edges;  // ways there, back
    std::vector<std::size_t> valence(shape.vertices.size());
    for (const auto& face : shape.faces) {
        ++(face.size() == 3 ? out.triangles : face.size() == 4 ? out.quads : out.polygons);
        out.largest_face = std::max(out.largest_face, face.size());
        out.corners += face.size();
        glm::dvec3 area(0);
        for (std::size_t k = 0; k < face.size(); ++k) {
            const std::size_t a = face[k], b = face[(k + 1) % face.size()];
            ++valence[a];
            parent[root(parent, a)] = root(parent, b);
            auto& ways = edges[std::minmax(a, b)];
            ++(a < b ? ways.first : ways.second);
            area += 0.5 * glm::cross(shape.vertices[a], shape.vertices[b]);
            if (k + 1 < face.size() && k > 0)  // a fan from the first corner
                out.volume += glm::dot(shape.vertices[face[0]],
                                       glm::cross(shape.vertices[a], shape.vertices[b])) /
                              6;
        }
        out.area += glm::length(area);
    }
    out.edges = edges.size();
    for (const auto& [edge, ways] : edges) {
        const int faces = ways.first + ways.second;
        out.bad += faces > 2;
        out.mixed += faces == 2 && ways.first != 1;
        if (faces != 1) continue;
        ++out.open;
        rim[root(rim, edge.first)] = root(rim, edge.second);
    }
    std::set<std::size_t> loops, components;
    for (const auto& [edge, ways] : edges)
        if (ways.first + ways.second == 1) loops.insert(root(rim, edge.first));
    for (std::size_t v = 0; v < valence.size(); ++v) {
        if (valence[v] == 0) continue;
        ++out.points;
        components.insert(root(parent, v));
        out.valence = std::max(out.valence, valence[v]);
    }
    out.loops = loops.size();
    out.components = components.size();
    return out;
}

json inspected(const std::filesystem::path& path) {
    const test::Ran ran = run_here({"inspect", path.string(), "--json"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    const json document = ran.json();
    return document.contains("files") ? document["files"][0] : json();
}

void expect_counts(const json& mesh, const Count& c, std::size_t vertices) {
    EXPECT_EQ(mesh["vertices"], vertices);
    EXPECT_EQ(mesh["points"], c.points);
    EXPECT_EQ(mesh["faces"], c.triangles + c.quads + c.polygons);
    EXPECT_EQ(mesh["triangles"], c.triangles);
    EXPECT_EQ(mesh["quads"], c.quads);
    EXPECT_EQ(mesh["polygons"], c.polygons);
    EXPECT_EQ(mesh["largest_face"], c.largest_face);
    EXPECT_EQ(mesh["edges"], c.edges);
    EXPECT_EQ(mesh["open_edges"], c.open);
    EXPECT_EQ(mesh["holes"], c.loops);
    EXPECT_EQ(mesh["non_manifold_edges"], c.bad);
    EXPECT_EQ(mesh["mixed_orientation_edges"], c.mixed);
    EXPECT_EQ(mesh["components"], c.components);
    EXPECT_EQ(mesh["closed"], c.open == 0);
    EXPECT_EQ(mesh["manifold"], c.bad == 0);
    EXPECT_EQ(mesh["oriented"], c.mixed == 0);
    EXPECT_EQ(mesh["euler"], std::int64_t(c.points) - std::int64_t(c.edges) +
                                 std::int64_t(c.triangles + c.quads + c.polygons));
    EXPECT_EQ(mesh["largest_valence"], c.valence);
    EXPECT_NEAR(mesh["area"].get<double>(), c.area, 1e-5 * c.area);
}

TEST(InspectFigures, AreThoseOfAClosedSurface) {
    const TempDir dir;
    const Shape shape = torus(10, 7);
    write_text(dir / "ring.obj", shape.obj());
    const json file = inspected(dir / "ring.obj");
    const json& mesh = file["meshes"][0];
    const Count c = count(shape);
    expect_counts(mesh, c, 70);
    EXPECT_EQ(mesh["name"], "ring");
    EXPECT_EQ(mesh["genus"], 1);
    EXPECT_NEAR(mesh["volume"].get<double>(), c.volume, 1e-5 * c.volume);
    EXPECT_GT(c.volume, 0);
    glm::dvec3 low(9), high(-9);
    for (const glm::dvec3& v : shape.vertices) {
        low = glm::min(low, v);
        high = glm::max(high, v);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(mesh["low"][k].get<double>(), low[int(k)], 1e-6);
        EXPECT_NEAR(mesh["high"][k].get<double>(), high[int(k)], 1e-6);
    }
    EXPECT_EQ(file["counts"]["triangles"], 140);
    EXPECT_EQ(file["counts"]["vertices"], 70);
    EXPECT_EQ(file["counts"]["faces"], 70);
    const std::string words = run_here({"inspect", (dir / "ring.obj").string()}).out;
    EXPECT_NE(words.find("  1 mesh, 1 node, 0 materials, 0 textures\n"), std::string::npos);
    EXPECT_NE(words.find("  ring: 70 vertices, 70 quads; no attributes\n"), std::string::npos);
    EXPECT_NE(words.find("    1 component, closed, manifold, genus 1\n"), std::string::npos)
        << words;
    char line[120];
    std::snprintf(line, sizeof line, ", area %.4g, volume %.4g\n", c.area, c.volume);
    EXPECT_NE(words.find(line), std::string::npos) << words << line;
}

TEST(InspectFigures, AreThoseOfAnOpenSurfaceWithLooseParts) {
    const TempDir dir;
    // A box without lid, a pentagon, two triangles that share an edge, and a vertex for nothing.
    Shape shape;
    for (int i = 0; i < 8; ++i)
        shape.vertices.push_back({i & 1 ? 3 : 1, i & 2 ? 5 : 2, i & 4 ? 4 : 0});
    shape.faces = {{0, 2, 3, 1}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& [x, y] : {std::pair{0, 0}, {2, 0}, {2, 1}, {1, 2}, {0, 1}})
        shape.vertices.push_back({10 + x, y, 0});
    shape.faces.push_back({8, 9, 10, 11, 12});
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
        shape.vertices.push_back({20 + x, y, 0});
    shape.faces.push_back({13, 14, 15});
    shape.faces.push_back({13, 15, 16});
    shape.vertices.push_back({7, 7, 7});
    write_text(dir / "parts.obj", shape.obj() + "v 30 1 2\nv 31 1 2\nv 31 4 2\nl 19 20 21\np 21\n");
    const json file = inspected(dir / "parts.obj");
    const json& mesh = file["meshes"][0];
    expect_counts(mesh, count(shape), 21);
    EXPECT_TRUE(mesh["genus"].is_null());
    EXPECT_EQ(mesh["volume"], 0.0);
    EXPECT_EQ(mesh["line_segments"], 2);
    EXPECT_EQ(mesh["point_primitives"], 1);
    EXPECT_EQ(mesh["low"], json::array({1.0, 0.0, 0.0}));
    EXPECT_EQ(mesh["high"], json::array({31.0, 5.0, 4.0}));
    EXPECT_EQ(file["counts"]["triangles"], 5 * 2 + 3 + 2);
    EXPECT_EQ(file["counts"]["polylines"], 1);
    EXPECT_EQ(file["counts"]["points"], 1);
    std::map<std::string, std::pair<json, json>> findings;
    for (const json& f : file["findings"])
        findings[f["kind"].get<std::string>()] = {f["count"], f["places"]};
    EXPECT_EQ(findings["open-edge"].first, 4 + 5 + 4);
    EXPECT_EQ(findings["hole"].first, 3);
    EXPECT_EQ(findings["unreferenced-vertex"].first, 1);
    EXPECT_EQ(findings["unreferenced-vertex"].second, json::array({17}));
    const std::string words = run_here({"inspect", (dir / "parts.obj").string()}).out;
    EXPECT_NE(words.find("21 vertices, 2 triangles, 5 quads, 1 polygon (up to 5 corners), 2 line "
                         "segments, 1 point; no attributes\n"),
              std::string::npos)
        << words;
    EXPECT_NE(words.find("    3 components, 13 open edges in 3 loops, manifold\n"),
              std::string::npos);
    EXPECT_NE(words.find("    30 × 5 × 4 about (16, 2.5, 2), area "), std::string::npos);
    EXPECT_NE(words.find("(vertex 17)"), std::string::npos);
    // So many places as asked for, and a sign that there are more.
    const auto places = [&](const char* n) {
        const std::string text =
            run_here({"inspect", (dir / "parts.obj").string(), "--places", n}).out;
        const std::size_t at = text.find("only one face has the edge");
        const std::string line = text.substr(at, text.find('\n', at) - at);
        return line.size() > 27 ? line.substr(27) : "";
    };
    EXPECT_EQ(places("0"), "");
    const std::string two = places("2");
    EXPECT_EQ(two.substr(0, 7), "(edges ");
    EXPECT_EQ(std::count(two.begin(), two.end(), ','), 2) << two;
    EXPECT_NE(two.find(", …)"), std::string::npos);
    const std::string text =
        run_here({"inspect", (dir / "parts.obj").string(), "--places", "2"}).out;
    const std::string holes = text.substr(text.find("form a loop"));
    EXPECT_NE(holes.substr(0, holes.find('\n')).find(", …)"), std::string::npos) << holes;  // of 3
}

TEST(InspectFigures, BadEdgesAndMixedOrientationAreTold) {
    const TempDir dir;
    Shape fan{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}},
              {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
    write_text(dir / "fan.obj", fan.obj());
    json file = inspected(dir / "fan.obj");
    EXPECT_EQ(file["meshes"][0]["non_manifold_edges"], 1);
    EXPECT_EQ(file["meshes"][0]["edges"], 7);
    EXPECT_EQ(file["meshes"][0]["manifold"], false);
    EXPECT_EQ(file["findings"][0]["severity"], "warning");
    std::string words = run_here({"inspect", (dir / "fan.obj").string()}).out;
    EXPECT_NE(words.find(", not manifold"), std::string::npos) << words;
    Shape turned{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 3, 2}}};
    write_text(dir / "turned.obj", turned.obj());
    file = inspected(dir / "turned.obj");
    EXPECT_EQ(file["meshes"][0]["mixed_orientation_edges"], 1);
    EXPECT_EQ(file["meshes"][0]["oriented"], false);
    EXPECT_EQ(file["meshes"][0]["manifold"], true);
    words = run_here({"inspect", (dir / "turned.obj").string()}).out;
    EXPECT_NE(words.find(", manifold, mixed orientation"), std::string::npos) << words;
}

TEST(InspectFigures, AttributesAndMaterialsAreThoseOfTheFile) {
    const TempDir dir;
    write_text(dir / "m.mtl",
               "newmtl a\nmap_Kd c.png\nmap_Ks s.png\nnorm n.png\nmap_Ke e.png\nmap_bump b.png\n"
               "disp d.png\nnewmtl plain\n");
    write_text(dir / "m.obj",
               "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
               "vn 0 0 1\nusemtl a\ns 1\nf 1/1/1 2/2/1 3/3/1\nf 2/1/1 4/3/1 3/2/1\n");
    const json file = inspected(dir / "m.obj");
    const json& mesh = file["meshes"][0];
    EXPECT_EQ(mesh["has_normals"], true);
    EXPECT_EQ(mesh["has_tangents"], false);
    EXPECT_EQ(mesh["uv_sets"], 1);
    EXPECT_EQ(mesh["color_sets"], 0);
    EXPECT_EQ(mesh["smoothing_groups"], true);
    EXPECT_EQ(mesh["mirrored_uv_faces"], 1);  // the second
    ASSERT_EQ(file["materials"].size(), 2u);
    EXPECT_EQ(file["materials"][0]["name"], "a");
    EXPECT_EQ(file["materials"][0]["maps"], (json{{"diffuse", "c.png"},
                                                  {"specular", "s.png"},
                                                  {"emissive", "e.png"},
                                                  {"normal", "n.png"},
                                                  {"bump", "b.png"},
                                                  {"displacement", "d.png"}}));
    EXPECT_EQ(file["materials"][1]["maps"], json::object());
    const std::string words = run_here({"inspect", (dir / "m.obj").string()}).out;
    EXPECT_NE(words.find("; normals, 1 UV set, smoothing groups\n"), std::string::npos) << words;
    EXPECT_NE(words.find("  a: diffuse map c.png, specular map s.png, emissive map e.png, normal "
                         "map n.png, bump map b.png, displacement map d.png\n"),
              std::string::npos)
        << words;
    EXPECT_EQ(words.find("plain:"), std::string::npos);
}

// A document's own counts, read from its JSON: as text and as GLB.
TEST(InspectFigures, AreThoseOfTheDocument) {
    const TempDir dir;
    test::GltfText gltf;
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    gltf.add({"a",
              positions,
              {},
              {},
              {},
              {0, 1, 2},
              R"("material":1,"targets":[{"POSITION":0},{"POSITION":0},{"POSITION":0}])",
              R"("skin":0)"});
    gltf.add({"b",
              positions,
              {},
              {},
              {},
              {0, 1, 2},
              R"("targets":[{"POSITION":2}]},{"attributes":{"POSITION":2},"indices":3)",
              R"("camera":0,"extensions":{"KHR_lights_punctual":{"light":1}})"});
    EXPECT_EQ(gltf.add_scalars({0, 1, 2}), 4u);
    const std::string text = gltf.text(
        R"("materials":[{"name":"m"},{"name":"n"}],"cameras":[{"type":"perspective",)"
        R"("perspective":{"yfov":1,"znear":0.1}}],"skins":[{"joints":[0,1]}],)"
        R"("images":[{"uri":"x.png"},{"uri":"y.png"},{"uri":"z.png"}],)"
        R"("textures":[{"source":0},{"source":1},{"source":2},{"source":0}],)"
        R"("extensionsUsed":["KHR_lights_punctual","X_unknown"],"extensions":{)"
        R"("KHR_lights_punctual":{"lights":[{"type":"point"},{"type":"point"}]}},)"
        R"("animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},)"
        R"({"sampler":0,"target":{"node":1,"path":"translation"}}],"samplers":[{"input":4,)"
        R"("output":0}]},{"channels":[{"sampler":0,"target":{"node":0,"path":"scale"}}],)"
        R"("samplers":[{"input":4,"output":0}]}])");
    write_text(dir / "d.gltf", text);
    std::string padded = text;
    while (padded.size() % 4 != 0) padded += ' ';
    const auto word = [](std::size_t value) {
        std::string bytes;
        for (int k = 0; k < 4; ++k) bytes += char(value >> (8 * k) & 255);
        return bytes;
    };
    write_text(dir / "d.glb",
               "glTF" + word(2) + word(20 + padded.size()) + word(padded.size()) + "JSON" + padded);
    for (const char* name : {"d.gltf", "d.glb"}) {
        const json file = inspected(dir / name);
        EXPECT_EQ(file["gltf"], (json{{"nodes", 2},
                                      {"meshes", 2},
                                      {"primitives", 3},
                                      {"morph_targets", 4},
                                      {"skins", 1},
                                      {"animations", 2},
                                      {"animation_channels", 3},
                                      {"cameras", 1},
                                      {"lights", 2},
                                      {"materials", 2},
                                      {"textures", 4},
                                      {"images", 3},
                                      {"extensions", {"KHR_lights_punctual", "X_unknown"}}}))
            << name;
        EXPECT_EQ(file["counts"]["meshes"], 2);
        EXPECT_EQ(file["counts"]["triangles"], 3);
        EXPECT_EQ(file["counts"]["materials"], 2);
        EXPECT_EQ(file["counts"]["textures"], 4);
        const std::string words = run_here({"inspect", (dir / name).string()}).out;
        EXPECT_NE(words.find("2 meshes, 2 nodes, 2 materials, 4 textures, 2 lights, 1 camera, 1 "
                             "skins, 2 animations, 4 morph targets\n"),
                  std::string::npos)
            << words;
        EXPECT_NE(words.find("  extensions: KHR_lights_punctual, X_unknown\n"), std::string::npos);
    }
}

TEST(Inspect, EachFileHasItsOwnVerdictAndOneFailureIsTheExitCode) {
    const TempDir dir;
    write_text(dir / "good.obj", test::cube_obj());
    write_text(dir / "bad.obj", "v 0 0 0\nf 1 2 3\n");
    const std::string good = (dir / "good.obj").string(), bad = (dir / "bad.obj").string();
    const test::Ran ran = run_here({"inspect", bad, good, "--json"});
    EXPECT_EQ(ran.exit_code, 1);
    const json files = ran.json()["files"];
    ASSERT_EQ(files.size(), 2u);
    EXPECT_EQ(files[0]["input"], bad);
    EXPECT_EQ(files[0]["status"], "failed");
    EXPECT_NE(files[0]["error"]["place"].get<std::string>().find("bad.obj:2"), std::string::npos);
    EXPECT_EQ(files[1]["status"], "ok");
    EXPECT_EQ(files[1]["meshes"][0]["quads"], 6);
    EXPECT_EQ(run_here({"inspect", good, good}).exit_code, 0);
    EXPECT_EQ(run_here({"inspect", good, bad}).exit_code, 1);
    // What is grave is said first, wherever it was found.
    write_text(dir / "order.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 0\nf 1//1 2//1 3//2\n");
    const std::string order = run_here({"inspect", (dir / "order.obj").string()}).out;
    ASSERT_NE(order.find("zero-normal"), std::string::npos) << order;
    EXPECT_LT(order.find("zero-normal"), order.find("open-edge"));
    // --strict: warnings fail, what is merely told does not.
    write_text(dir / "open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string open = (dir / "open.obj").string();
    EXPECT_EQ(run_here({"inspect", open, "--strict"}).exit_code, 0);
    write_text(dir / "twice.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\n");
    const std::string twice = (dir / "twice.obj").string();
    EXPECT_EQ(run_here({"inspect", twice}).exit_code, 0);
    EXPECT_EQ(run_here({"inspect", twice, "--strict"}).exit_code, 1);
    EXPECT_EQ(run_here({"inspect", twice, open, "--strict"}).exit_code, 1);  // not the last alone
}

TEST(Inspect, WhatIsLeftOutOfLongListsIsTold) {
    const TempDir dir;
    // A glTF file of 103 meshes, a triangle without area each, 101 materials with maps and 20
    // without.
    const json primitives = {{{"attributes", {{"POSITION", 0}}}}};
    json document = {{"asset", {{"version", "2.0"}}},
                     {"accessors",
                      {{{"componentType", 5126},
                        {"count", 3},
                        {"type", "VEC3"},
                        {"min", {0, 0, 0}},
                        {"max", {0, 0, 0}}}}}};
    for (int m = 0; m < 103; ++m) document["meshes"].push_back({{"primitives", primitives}});
    document["images"] = {{{"uri", "none.png"}}};
    document["textures"] = {{{"source", 0}}};
    const json mapped = {{"baseColorTexture", {{"index", 0}}}};
    for (int m = 0; m < 101; ++m)
        document["materials"].push_back({{"pbrMetallicRoughness", mapped}});
    for (int m = 0; m < 20; ++m) document["materials"].push_back({{"name", "plain"}});
    write_text(dir / "many.gltf", document.dump());
    const test::Ran ran = run_here({"inspect", (dir / "many.gltf").string()});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_NE(ran.out.find("… and 3 more meshes\n"), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("… and 1 more material with maps\n"), std::string::npos) << ran.out;
}

}  // namespace
