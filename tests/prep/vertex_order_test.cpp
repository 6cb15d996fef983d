// Triangles and vertices in another order: nothing but places may change, and what the order is
// worth is judged by a cache of the test's own.
#include "prep/output/vertex_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "gltf_maker.h"
#include "mesh_files.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "prep/split_vertices.h"
#include "shapes.h"
#include "written_gltf.h"

namespace {

using prep::Mesh;
using prep::VertexMesh;
using Index = std::uint32_t;
using Indices = std::vector<Index>;
using Triangle = std::array<Index, 3>;

// Vertices that are not among the last 16 shaded, first in, first out.
std::uint64_t shaded(const Indices& indices) {
    std::deque<Index> cache;
    std::uint64_t misses = 0;
    for (const Index v : indices) {
        if (std::find(cache.begin(), cache.end(), v) != cache.end()) continue;
        ++misses;
        cache.push_back(v);
        if (cache.size() > 16) cache.pop_front();
    }
    return misses;
}
std::uint64_t shaded(const VertexMesh& mesh) {
    std::uint64_t sum = 0;
    for (const VertexMesh::Range& r : mesh.ranges) {
        const auto first = mesh.indices.begin() + std::ptrdiff_t(r.first_triangle) * 3;
        sum += shaded(Indices(first, first + std::ptrdiff_t(r.triangle_count) * 3));
    }
    return sum;
}

Mesh scrambled(const Mesh& mesh, unsigned seed) {
    std::mt19937_64 random(seed);
    const Mesh moved =
        shapes::with_vertex_order(mesh, shapes::random_order(mesh.vertex_count(), random));
    return shapes::with_face_order(moved, shapes::random_order(mesh.face_count(), random));
}

// A torus in random order with values of every kind, two materials, lines and points.
Mesh decorated(unsigned seed) {
    Mesh mesh = scrambled(shapes::fan_triangulated(shapes::torus(40, 24)), seed);
    const std::size_t corners = mesh.corner_count();
    mesh.uvs.resize(1);
    mesh.colors.resize(1);
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
        mesh.normals.values.emplace_back(float(v), 1, 0);
        mesh.uvs[0].values.emplace_back(float(v) / 64, 0.5f);
        mesh.colors[0].values.emplace_back(float(v) / 1024, 0, 1, 1);
    }
    mesh.normals.indices = mesh.uvs[0].indices = mesh.colors[0].indices = mesh.corner_vertices;
    for (std::size_t c = 0; c < corners; c += 29) {  // seams
        mesh.uvs[0].values.emplace_back(float(c), 7);
        mesh.uvs[0].indices[c] = Index(mesh.uvs[0].values.size() - 1);
    }
    for (Index f = 0; f < mesh.face_count(); ++f)
        mesh.face_materials.push_back(mesh.positions[mesh.corner_vertices[3 * f]].x > 0 ? 1 : 0);
    mesh.positions.emplace_back(5, 5, 5);
    mesh.line_offsets = {0, 3};
    mesh.line_vertices = {Index(mesh.vertex_count() - 1), 3, 4};
    mesh.points = {7, Index(mesh.vertex_count() - 1)};
    return mesh;
}

VertexMesh split_of(const Mesh& mesh) {
    auto out = prep::split(mesh);
    EXPECT_TRUE(out.has_value());
    return *std::move(out);
}

template <class T>
void expect_moved(const std::vector<T>& now, const std::vector<T>& before, const Indices& old,
                  const char* what) {
    ASSERT_EQ(now.size(), before.size()) << what;
    for (std::size_t v = 0; v < now.size(); ++v)
        ASSERT_EQ(std::memcmp(&now[v], &before[old[v]], sizeof(T)), 0) << what << " of " << v;
}

void expect_places_alone(const Mesh& mesh, const VertexMesh& before, const VertexMesh& now,
                         const Indices& old) {
    Indices sorted = old;
    std::sort(sorted.begin(), sorted.end());
    ASSERT_EQ(sorted.size(), before.vertex_count());
    for (Index v = 0; v < sorted.size(); ++v) ASSERT_EQ(sorted[v], v);
    expect_moved(now.positions, before.positions, old, "positions");
    expect_moved(now.normals, before.normals, old, "normals");
    expect_moved(now.source_vertices, before.source_vertices, old, "source vertices");
    expect_moved(now.source_corners, before.source_corners, old, "source corners");
    expect_moved(now.split_reasons, before.split_reasons, old, "reasons");
    ASSERT_EQ(now.uvs.size(), before.uvs.size());
    for (std::size_t s = 0; s < now.uvs.size(); ++s)
        expect_moved(now.uvs[s], before.uvs[s], old, "uvs");
    ASSERT_EQ(now.colors.size(), before.colors.size());
    for (std::size_t s = 0; s < now.colors.size(); ++s)
        expect_moved(now.colors[s], before.colors[s], old, "colours");
    for (const auto& [list, was] : {std::pair(&now.lines, &before.lines),
                                    {&now.points, &before.points},
                                    {&now.corner_vertices, &before.corner_vertices}}) {
        ASSERT_EQ(list->size(), was->size());
        for (std::size_t i = 0; i < list->size(); ++i)
            ASSERT_EQ((*list)[i] == prep::no_index ? prep::no_index : old[(*list)[i]], (*was)[i]);
    }
    // Each range has the triangles that it had, of the same faces, with their corners in order.
    ASSERT_EQ(now.ranges.size(), before.ranges.size());
    for (std::size_t r = 0; r < now.ranges.size(); ++r) {
        const VertexMesh::Range& range = now.ranges[r];
        ASSERT_EQ(range.first_triangle, before.ranges[r].first_triangle);
        ASSERT_EQ(range.triangle_count, before.ranges[r].triangle_count);
        ASSERT_EQ(range.material, before.ranges[r].material);
        std::multiset<std::pair<Index, Triangle>> here, there;
        for (Index t = range.first_triangle; t < range.first_triangle + range.triangle_count; ++t) {
            const Index *n = &now.indices[3 * t], *b = &before.indices[3 * t];
            here.insert({now.triangle_faces[t], {old[n[0]], old[n[1]], old[n[2]]}});
            there.insert({before.triangle_faces[t], {b[0], b[1], b[2]}});
        }
        ASSERT_TRUE(here == there) << "range " << r;
    }
    ASSERT_EQ(now.triangle_faces.size(), mesh.face_count());
}

TEST(VertexOrder, PlacesChangeAndNothingElse) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        const Mesh mesh = decorated(seed);
        const VertexMesh before = split_of(mesh);
        ASSERT_EQ(before.ranges.size(), 2u);
        VertexMesh now = before;
        const prep::Reordered done = prep::optimize_order(now);
        ASSERT_NO_FATAL_FAILURE(expect_places_alone(mesh, before, now, done.old_vertices));
        std::uint64_t moved = 0;
        for (std::size_t v = 0; v < done.old_vertices.size(); ++v)
            moved += done.old_vertices[v] != v;
        EXPECT_EQ(done.change.vertices, moved);
        moved = 0;
        for (std::size_t t = 0; t < now.triangle_count(); ++t)
            moved += now.triangle_faces[t] != before.triangle_faces[t];
        EXPECT_EQ(done.change.triangles, moved);
        EXPECT_GT(moved, now.triangle_count() / 2);
    }
}

// Fetched in order: every vertex that a triangle names first is the next one.
TEST(VertexOrder, VerticesStandAsTrianglesNameThem) {
    VertexMesh mesh = split_of(decorated(4));
    prep::optimize_order(mesh);
    Index next = 0;
    for (const Index v : mesh.indices) {
        ASSERT_LE(v, next);
        next += v == next;
    }
    EXPECT_EQ(next + 1, mesh.vertex_count());  // the vertex of a line alone is last
}

TEST(VertexOrder, CostsAreThoseOfACacheAndFall) {
    VertexMesh mesh = split_of(scrambled(shapes::fan_triangulated(shapes::torus(60, 40)), 5));
    const std::uint64_t before = shaded(mesh);
    const prep::OrderChange change = prep::optimize_order(mesh).change;
    EXPECT_EQ(change.before.shaded, before);
    EXPECT_EQ(change.after.shaded, shaded(mesh));
    EXPECT_EQ(prep::order_cost(mesh).shaded, shaded(mesh));
    EXPECT_DOUBLE_EQ(change.after.acmr, double(shaded(mesh)) / double(mesh.triangle_count()));
    EXPECT_DOUBLE_EQ(change.after.atvr, double(shaded(mesh)) / double(mesh.vertex_count()));
    EXPECT_GT(change.before.acmr, 2.5);  // random order
    EXPECT_LT(change.after.acmr, 0.8);
    EXPECT_GE(change.after.atvr, 1.0);
}

// Patches that look outward come before those that they may hide: a small ball inside a large one.
TEST(VertexOrder, WhatLiesOutsideComesFirst) {
    Mesh inner = shapes::fan_triangulated(shapes::uv_sphere(24, 12));
    for (glm::vec3& p : inner.positions) p *= 0.2f;
    // The inner one looks inward, so that the outer one's outside stands above all.
    for (std::size_t c = 0; c < inner.corner_count(); c += 3)
        std::swap(inner.corner_vertices[c + 1], inner.corner_vertices[c + 2]);
    const Index inner_faces = Index(inner.face_count());
    VertexMesh mesh =
        split_of(shapes::joined(inner, shapes::fan_triangulated(shapes::uv_sphere(24, 12))));
    ASSERT_LT(mesh.triangle_faces[0], inner_faces);
    prep::optimize_order(mesh);
    EXPECT_GE(mesh.triangle_faces.front(), inner_faces);
    EXPECT_LT(mesh.triangle_faces.back(), inner_faces);
}

TEST(VertexOrder, IsNeverWorseHoweverOddTheMesh) {
    std::mt19937_64 random(6);
    for (int k = 0; k < 60; ++k) {
        Mesh mesh = shapes::random_triangles(3 + std::size_t(k), 1 + std::size_t(k) * 7, random);
        if (k % 3 == 0)
            for (std::size_t v = 0; v < mesh.vertex_count(); v += 2)
                mesh.positions[v].y = k % 2 ? std::numeric_limits<float>::quiet_NaN()
                                            : std::numeric_limits<float>::infinity();
        if (k % 5 == 0)  // the same face again, and one of a single point
            for (int i = 0; i < 6; ++i) {
                mesh.corner_vertices.push_back(mesh.corner_vertices[i < 3 ? std::size_t(i) : 0]);
                if (i % 3 == 2) mesh.face_offsets.push_back(Index(mesh.corner_count()));
            }
        VertexMesh now = split_of(mesh), before = now;
        const prep::Reordered done = prep::optimize_order(now);
        ASSERT_NO_FATAL_FAILURE(expect_places_alone(mesh, before, now, done.old_vertices)) << k;
        EXPECT_LE(shaded(now), shaded(before)) << k;
    }
    // Poles of more triangles than meshoptimizer is given of a vertex at a time.
    for (const Index around : {1023u, 1024u, 1025u, 8000u}) {
        const Mesh mesh = scrambled(shapes::fan(around), around);
        VertexMesh now = split_of(mesh), before = now;
        const Indices old = prep::optimize_order(now).old_vertices;
        ASSERT_NO_FATAL_FAILURE(expect_places_alone(mesh, before, now, old));
        EXPECT_LT(shaded(now), around + around / 7);  // the rim once, and now and then the pole
    }
    // Rows that the cache holds as a whole are in the best order that there is.
    for (std::uint32_t width = 1; width < 7; ++width) {
        VertexMesh rows = split_of(shapes::fan_triangulated(shapes::grid(width, 200)));
        ASSERT_EQ(shaded(rows), rows.vertex_count()) << width;
        prep::optimize_order(rows);
        EXPECT_EQ(shaded(rows), rows.vertex_count()) << width;
    }
}

TEST(VertexOrder, EmptyMeshesAndPointsAlone) {
    VertexMesh nothing;
    EXPECT_EQ(prep::optimize_order(nothing).change.after.acmr, 0);
    VertexMesh points;
    points.positions = {{1, 0, 0}, {2, 0, 0}};
    points.points = {1, 0};
    EXPECT_EQ(prep::optimize_order(points).old_vertices, (Indices{0, 1}));
    EXPECT_EQ(points.points, (Indices{1, 0}));
}

prep::PrepareOptions optimized(bool on = true) {
    prep::PrepareOptions options;
    options.optimize = on;
    return options;
}

TEST(VertexOrder, BlendedTrianglesKeepTheirOrder) {
    prep::Scene scene;
    scene.materials.resize(2);
    scene.materials[1].alpha_mode = prep::AlphaMode::blend;
    scene.meshes.push_back(decorated(7));
    scene.nodes.emplace_back().mesh = 0;
    const auto plain = prep::prepare(scene, optimized(false));
    const auto out = prep::prepare(scene, optimized());
    ASSERT_TRUE(plain && out);
    EXPECT_FALSE(plain->orders[0]);
    ASSERT_TRUE(out->orders[0]);
    const VertexMesh& now = out->meshes[0];
    for (const VertexMesh::Range& r : now.ranges) {
        const auto faces = [&](const VertexMesh& mesh) {
            const auto first = mesh.triangle_faces.begin() + r.first_triangle;
            return Indices(first, first + r.triangle_count);
        };
        EXPECT_EQ(faces(now) == faces(plain->meshes[0]), r.material == 1) << r.material;
        if (r.material == 1) {
            EXPECT_EQ(out->orders[0]->kept_triangles, r.triangle_count);
        }
    }
    // A variant that blends may take the place of any material.
    scene.meshes[0].variant_materials = {1};
    const auto variant = prep::prepare(scene, optimized());
    ASSERT_TRUE(variant);
    EXPECT_EQ(variant->orders[0]->triangles, 0u);
    EXPECT_EQ(variant->meshes[0].triangle_faces, plain->meshes[0].triangle_faces);
}

// --- glTF files ----------------------------------------------------------------------------

// A curved sheet with everything that is told by vertex, its triangles in random order.
test::GltfMaker sheet(const nlohmann::ordered_json& more = nlohmann::ordered_json::object()) {
    test::GltfMaker gltf;
    const Mesh mesh = scrambled(shapes::fan_triangulated(shapes::grid(20, 12)), 8);
    std::vector<float> positions, uvs, weights, ids, moved;
    std::vector<std::uint8_t> joints;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
        const glm::vec3& p = mesh.positions[v];
        positions.insert(positions.end(), {p.x, p.y, 0.05f * p.x * p.x});
        uvs.insert(uvs.end(), {p.x / 20, p.y / 12});
        moved.insert(moved.end(), {0, 0, 0.01f * p.x * p.y});
        joints.insert(joints.end(), {0, 1, 0, 0});
        const float w = p.x / 20;
        weights.insert(weights.end(), {1 - w, w, 0, 0});
        ids.push_back(float(v));
    }
    const auto bounded = [&](const std::vector<float>& values) {
        const std::size_t a = gltf.accessor(values, "VEC3");
        std::array<float, 3> low = {values[0], values[1], values[2]}, high = low;
        for (std::size_t i = 0; i < values.size(); ++i) {
            low[i % 3] = std::min(low[i % 3], values[i]);
            high[i % 3] = std::max(high[i % 3], values[i]);
        }
        gltf.json["accessors"][a]["min"] = low;
        gltf.json["accessors"][a]["max"] = high;
        return a;
    };
    nlohmann::ordered_json primitive{{"attributes",
                                      {{"POSITION", bounded(positions)},
                                       {"TEXCOORD_0", gltf.accessor(uvs, "VEC2")},
                                       {"JOINTS_0", gltf.accessor(joints, "VEC4")},
                                       {"WEIGHTS_0", gltf.accessor(weights, "VEC4")},
                                       {"_ID", gltf.accessor(ids, "SCALAR")}}},
                                     {"targets", {{{"POSITION", bounded(moved)}}}},
                                     {"indices", gltf.accessor(mesh.corner_vertices, "SCALAR")}};
    primitive.update(more);
    gltf.json["meshes"] = {{{"primitives", {primitive}}}};
    gltf.json["skins"] = {{{"joints", {1, 2}}}};
    gltf.json["nodes"] = {
        {{"mesh", 0}, {"skin", 0}}, {{"children", {2}}}, nlohmann::json::object()};
    gltf.json["scenes"] = {{{"nodes", {0, 1}}}};
    gltf.json["scene"] = 0;
    return gltf;
}

// The triangles by all that is told of their corners, targets included.
std::multiset<std::vector<double>> triangles(const test::GltfFile& file) {
    const auto& primitive = file.primitive(0, 0);
    std::vector<test::GltfValues> values;
    for (const auto& item : primitive["attributes"].items())
        values.push_back(file.attribute(0, 0, item.key()));
    for (const auto& item : primitive["targets"][0].items())
        values.push_back(file.target(0, 0, 0, item.key()));
    std::multiset<std::vector<double>> all;
    const std::vector<std::size_t> indices = file.triangles(0, 0);
    for (std::size_t t = 0; t < indices.size(); t += 3) {
        std::vector<double> one;
        for (std::size_t k = 0; k < 3; ++k)
            for (const test::GltfValues& v : values)
                for (const double x : v.at(indices[t + k])) one.push_back(x);
        all.insert(std::move(one));
    }
    return all;
}

std::uint64_t shaded(const test::GltfFile& file) {
    const std::vector<std::size_t> indices = file.triangles(0, 0);
    return shaded(Indices(indices.begin(), indices.end()));
}

struct Written {
    test::GltfFile file;
    std::vector<std::string> notes;
};

class OptimizedGltf : public ::testing::Test {
  protected:
    Written written(const prep::Scene& scene, const prep::PrepareOptions& options,
                    prep::Compression compression = prep::Compression::keep) {
        const auto prepared = prep::prepare(scene, options);
        EXPECT_TRUE(prepared);
        const std::filesystem::path path = dir_ / "out.glb";
        prep::SaveOptions save;
        save.compression = compression;
        const auto notes = prep::save_scene(*prepared, path, save);
        EXPECT_TRUE(notes) << notes.error().text;
        test::GltfFile file(path);
        if (compression == prep::Compression::keep || compression == prep::Compression::none) {
            EXPECT_EQ(file.fault(), "");
        }
        return {std::move(file), *notes};
    }
    test::TempDir dir_;
};

TEST_F(OptimizedGltf, SkinsTargetsAndOtherAttributesGoAlong) {
    const auto scene = sheet().read();
    ASSERT_TRUE(scene);
    for (const bool tangents : {false, true}) {
        prep::PrepareOptions plain, better = optimized();
        if (tangents)
            plain.request.tangents = better.request.tangents = prep::Request::Level::always;
        const Written a = written(*scene, plain), b = written(*scene, better);
        EXPECT_EQ(b.notes, a.notes);
        EXPECT_EQ(b.file.primitive(0, 0)["targets"][0].size(), tangents ? 3u : 2u);
        EXPECT_TRUE(triangles(a.file) == triangles(b.file)) << tangents;
        EXPECT_LT(2 * shaded(b.file), shaded(a.file));
    }
}

TEST_F(OptimizedGltf, FilesBuiltFromOtherFormatsToo) {
    const auto parsed = sheet().read();
    ASSERT_TRUE(parsed);
    prep::Scene scene = *parsed;
    scene.retained_file.reset();  // as if another format had brought it
    for (Mesh& mesh : scene.meshes) mesh.tied_to_file = false;
    const Written a = written(scene, optimized(false)), b = written(scene, optimized());
    EXPECT_TRUE(triangles(a.file) == triangles(b.file));
    EXPECT_LT(2 * shaded(b.file), shaded(a.file));
}

// The order is there before anything is packed, and packing by meshopt keeps it.
TEST_F(OptimizedGltf, CompressionComesAfter) {
    const auto scene = sheet().read();
    ASSERT_TRUE(scene);
    const Written plain = written(*scene, optimized());
    written(*scene, optimized(), prep::Compression::meshopt);
    const auto packed = prep::load_scene(dir_ / "out.glb");
    ASSERT_TRUE(packed);
    const Written unpacked = written(*packed, optimized(false), prep::Compression::none);
    EXPECT_EQ(shaded(unpacked.file), shaded(plain.file));
    EXPECT_TRUE(triangles(unpacked.file).size() == triangles(plain.file).size());
    EXPECT_EQ(unpacked.file.attribute(0, 0, "_ID").values,
              plain.file.attribute(0, 0, "_ID").values);
    // So does Draco where there are targets.
    EXPECT_TRUE(written(*scene, optimized(), prep::Compression::draco).notes.empty());
}

// An extension that numbers triangles says something wrong of another order, even where each vertex
// keeps its number: a tetrahedron's third and fourth triangle name no new one.
TEST_F(OptimizedGltf, WhatNumbersTrianglesIsLeftOutWhereTheyMoved) {
    const std::vector<glm::vec3> points = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
    const std::vector<Triangle> faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    std::array<std::size_t, 4> order = {0, 1, 2, 3};
    int moved = 0, stayed = 0;
    do {
        Indices numbers(4, prep::no_index), indices;
        std::vector<float> positions, normals;
        for (const std::size_t f : order)
            for (const Index v : faces[f]) {
                if (numbers[v] == prep::no_index) {
                    numbers[v] = Index(positions.size() / 3);
                    const glm::vec3 n = glm::normalize(points[v]);
                    positions.insert(positions.end(), {points[v].x, points[v].y, points[v].z});
                    normals.insert(normals.end(), {n.x, n.y, n.z});
                }
                indices.push_back(numbers[v]);
            }
        test::GltfMaker gltf;
        const std::size_t position = gltf.accessor(positions, "VEC3");
        gltf.json["accessors"][position]["min"] = {-1, -1, -1};
        gltf.json["accessors"][position]["max"] = {1, 1, 1};
        nlohmann::ordered_json primitive;
        primitive["attributes"] = {{"POSITION", position},
                                   {"NORMAL", gltf.accessor(normals, "VEC3")}};
        primitive["indices"] = gltf.accessor(indices, "SCALAR");
        primitive["extensions"]["MSFT_meshlet"]["x"] = 1;
        gltf.json["extensionsUsed"] = {"MSFT_meshlet"};
        gltf.mesh(nlohmann::ordered_json::array({primitive}));
        const auto scene = gltf.read();
        ASSERT_TRUE(scene);
        const auto prepared = prep::prepare(*scene, optimized());
        ASSERT_TRUE(prepared && prepared->orders[0]);
        const bool same = prepared->orders[0]->triangles == 0;
        EXPECT_EQ(prepared->orders[0]->vertices, 0u);
        const Written out = written(*scene, optimized());
        EXPECT_EQ(out.file.primitive(0, 0).contains("extensions"), same);
        ++(same ? stayed : moved);
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_GT(moved, 0);
    EXPECT_GT(stayed, 0);
}

// Quads as two triangles each, of which every vertex has its own number as an attribute; the quads
// in random order, vertices too or as triangles name them.
nlohmann::ordered_json quads(test::GltfMaker& gltf, bool as_named = false) {
    const Mesh grid = shapes::grid(16, 9);
    std::mt19937_64 random(9);
    Indices places = shapes::random_order(grid.vertex_count(), random);
    const Indices faces = shapes::random_order(grid.face_count(), random);
    if (as_named) {
        Index next = 0;
        std::fill(places.begin(), places.end(), prep::no_index);
        for (const Index f : faces)
            for (std::size_t k = 0; k < 4; ++k)
                if (Index& p = places[grid.corner_vertices[4 * std::size_t(f) + k]];
                    p == prep::no_index)
                    p = next++;
    }
    std::vector<float> positions(3 * grid.vertex_count()), normals, ids;
    for (Index v = 0; v < grid.vertex_count(); ++v) {
        std::memcpy(&positions[3 * std::size_t(places[v])], &grid.positions[v], 12);
        normals.insert(normals.end(), {0, 0, 1});
        ids.push_back(float(v));
    }
    Indices indices;
    for (const Index f : faces) {
        const Index* const q = &grid.corner_vertices[4 * std::size_t(f)];
        for (const int k : {0, 1, 2, 0, 2, 3}) indices.push_back(places[q[k]]);
    }
    const std::size_t position = gltf.accessor(positions, "VEC3");
    gltf.json["accessors"][position]["min"] = {0, 0, 0};
    gltf.json["accessors"][position]["max"] = {16, 9, 0};
    nlohmann::ordered_json primitive;
    primitive["attributes"] = {{"POSITION", position},
                               {"NORMAL", gltf.accessor(normals, "VEC3")},
                               {"_ID", gltf.accessor(ids, "SCALAR")}};
    primitive["indices"] = gltf.accessor(indices, "SCALAR");
    return primitive;
}

// FB_ngon_encoding as its specification decodes it: successive triangles that begin with one vertex
// are one polygon.
std::multiset<std::set<double>> polygons(const test::GltfFile& file) {
    const std::vector<double> ids = file.attribute(0, 0, "_ID").values;
    const std::vector<std::size_t> indices = file.triangles(0, 0);
    std::multiset<std::set<double>> all;
    std::set<double> one;
    for (std::size_t t = 0; t < indices.size(); t += 3) {
        if (t > 0 && indices[t] != indices[t - 3]) all.insert(std::exchange(one, {}));
        for (std::size_t k = 0; k < 3; ++k) one.insert(ids[indices[t + k]]);
    }
    all.insert(one);
    return all;
}

TEST_F(OptimizedGltf, PolygonsThatAreToldByOrderStayWhole) {
    for (const auto compression : {prep::Compression::keep, prep::Compression::meshopt}) {
        test::GltfMaker gltf;
        nlohmann::ordered_json primitive = quads(gltf);
        primitive["extensions"]["FB_ngon_encoding"] = nlohmann::ordered_json::object();
        gltf.json["extensionsUsed"] = {"FB_ngon_encoding"};
        gltf.mesh(nlohmann::ordered_json::array({primitive}));
        const auto scene = gltf.read();
        ASSERT_TRUE(scene);
        const std::multiset<std::set<double>> before = polygons(written(*scene, {}).file);
        ASSERT_EQ(before.size(), 144u);
        written(*scene, optimized(), compression);
        const auto packed = prep::load_scene(dir_ / "out.glb");
        ASSERT_TRUE(packed);
        const Written out = written(*packed, optimized(false), prep::Compression::none);
        EXPECT_TRUE(out.file.primitive(0, 0)["extensions"].contains("FB_ngon_encoding"));
        EXPECT_TRUE(polygons(out.file) == before);
        EXPECT_EQ(prep::prepare(*scene, optimized())->orders[0]->kept_triangles, 288u);
    }
}

// Nobody knows what it numbers: nothing moves, neither of the primitive nor for another one's sake.
TEST_F(OptimizedGltf, WhatAnUnknownExtensionMayNumberStays) {
    test::GltfMaker gltf;
    nlohmann::ordered_json plain = quads(gltf), other = quads(gltf);
    other["extensions"]["ACME_edges"]["triangles"] = {0, 5};
    gltf.json["extensionsUsed"] = {"ACME_edges"};
    gltf.mesh(nlohmann::ordered_json::array({plain, other}));
    const auto scene = gltf.read();
    ASSERT_TRUE(scene);
    const Written before = written(*scene, {}), now = written(*scene, optimized());
    EXPECT_NE(now.file.triangles(0, 0), before.file.triangles(0, 0));
    EXPECT_EQ(now.file.triangles(0, 1), before.file.triangles(0, 1));
    EXPECT_EQ(now.file.attribute(0, 1, "_ID").values, before.file.attribute(0, 1, "_ID").values);
    EXPECT_TRUE(now.file.primitive(0, 1)["extensions"].contains("ACME_edges"));
    EXPECT_EQ(now.notes, before.notes);
}

// A primitive whose triangles stay keeps what numbers them, whatever moves beside it.
TEST_F(OptimizedGltf, WhatNumbersTrianglesStaysWithThoseThatStay) {
    test::GltfMaker gltf;
    nlohmann::ordered_json opaque = quads(gltf), blended = quads(gltf, true);
    blended["extensions"]["MSFT_meshlet"]["x"] = 1;
    blended["material"] = 0;
    blended["attributes"].erase("NORMAL");  // these are made: it is written anew
    gltf.json["materials"] = {{{"alphaMode", "BLEND"}}};
    gltf.json["extensionsUsed"] = {"MSFT_meshlet"};
    opaque["extensions"]["MSFT_meshlet"]["x"] = 2;
    gltf.mesh(nlohmann::ordered_json::array({opaque, blended}));
    auto scene = gltf.read();
    ASSERT_TRUE(scene);
    const Written out = written(*scene, optimized());
    EXPECT_FALSE(out.file.primitive(0, 0).contains("extensions"));
    EXPECT_EQ(std::count_if(out.notes.begin(), out.notes.end(),
                            [](const std::string& note) {
                                return note.find("extension MSFT_meshlet") != std::string::npos &&
                                       note.find("left out there") != std::string::npos;
                            }),
              1);
    EXPECT_TRUE(out.file.primitive(0, 1).contains("extensions"));
    EXPECT_TRUE(out.file.primitive(0, 1)["attributes"].contains("NORMAL"));
}

TEST_F(OptimizedGltf, OtherFormatsKeepPolygonsInOrder) {
    const auto scene = sheet().read();
    ASSERT_TRUE(scene);
    const auto prepared = prep::prepare(*scene, optimized());
    ASSERT_TRUE(prepared);
    for (const char* name : {"x.obj", "x.ply", "x.stl", "x.off"}) {
        const auto notes = prep::save_scene(*prepared, dir_ / name);
        ASSERT_FALSE(notes) << name;
        EXPECT_EQ(notes.error().code, prep::ErrorCode::unsupported);
        EXPECT_NE(notes.error().text.find("--optimize"), std::string::npos) << notes.error().text;
        EXPECT_FALSE(std::filesystem::exists(dir_ / name));
    }
}

}  // namespace
