// glTF files written by Draco and meshopt: what other programs decode, how large they are, and what
// of a compressed input stays as it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <map>

#include "compressed_gltf.h"
#include "formats/gltf/compression/draco_encode.h"
#include "formats/gltf/compression/meshopt_encode.h"
#include "gltf_maker.h"
#include "gltf_oracle.h"
#include "mesh_files.h"
#include "npm_tools.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using prep::Compression;
using test::by_edgebreaker;
using test::bytes_without_pictures;
using test::save;

// --- triangles as other programs decode them, in whatever order --------------------------------

// One number for the values of a corner, and for a triangle; by FNV-1a, 64 bits. Two of a million
// are the same by chance once in ten million runs.
using Triangles = std::vector<std::uint64_t>;
constexpr std::uint64_t hash_start = 0xcbf29ce484222325;
std::uint64_t hashed(std::uint64_t hash, std::uint64_t value) {
    for (int k = 0; k < 64; k += 8) hash = (hash ^ (value >> k & 0xff)) * 0x100000001b3;
    return hash;
}

// A primitive's triangles by the values of these attributes and of all morph targets; each from its
// least corner on, so that the order of triangles and their first corners do not matter.
Triangles triangles_of(const test::DecodedGltf& file, const Json& primitive,
                       const std::vector<std::string>& names) {
    std::vector<std::uint64_t> vertices(
        primitive.at("attributes").at("POSITION").at("count").get<std::size_t>(), hash_start);
    const auto add = [&](const Json& array) {
        const std::vector<double> values = file.numbers(array);
        const std::size_t width = array.at("width");
        for (std::size_t v = 0; v < vertices.size(); ++v)
            for (std::size_t k = 0; k < width; ++k)  // + 0: zeros are one
                vertices[v] =
                    hashed(vertices[v], std::bit_cast<std::uint64_t>(values[v * width + k] + 0.0));
    };
    for (const std::string& name : names) add(primitive.at("attributes").at(name));
    for (const Json& target : primitive.at("targets"))
        if (target.contains("POSITION")) add(target.at("POSITION"));
    std::vector<double> indices = file.numbers(primitive.at("indices"));
    if (primitive.at("indices").is_null())
        for (std::size_t v = 0; v < vertices.size(); ++v) indices.push_back(double(v));
    Triangles out;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        std::array<std::uint64_t, 3> t;
        for (std::size_t k = 0; k < 3; ++k) t[k] = vertices.at(std::size_t(indices[i + k]));
        t = std::min({t, {t[1], t[2], t[0]}, {t[2], t[0], t[1]}});
        out.push_back(hashed(hashed(t[0], t[1]), t[2]));
    }
    std::sort(out.begin(), out.end());
    return out;
}

struct Compared {
    std::string difference;
    std::uint64_t added_bytes = 0;  // of attributes that the input has not
    std::size_t triangles = 0;
};

Compared compare(const test::DecodedGltf& a, const test::DecodedGltf& b, bool frames) {
    Compared out;
    const Json &x = a.json.at("meshes"), &y = b.json.at("meshes");
    if (x.size() != y.size()) return {"number of meshes"};
    for (std::size_t m = 0; m < x.size(); ++m)
        for (std::size_t p = 0; p < x[m].at("primitives").size(); ++p) {
            const Json &u = x[m]["primitives"][p], &v = y[m].at("primitives").at(p);
            if (u.at("mode") != 4) continue;
            std::vector<std::string> names;
            for (const auto& item : u.at("attributes").items()) {
                const bool frame = item.key() == "NORMAL" || item.key() == "TANGENT";
                if (!frames && frame) continue;
                if (!v.at("attributes").contains(item.key())) {
                    if (!frame) out.difference = "lost: " + item.key();
                    continue;
                }
                // Those that do not add up to 1 are made to.
                if (!item.key().starts_with("WEIGHTS_")) names.push_back(item.key());
            }
            const auto count_added = [&](const Json& old, const Json& now) {
                for (const auto& item : now.items())
                    if (!old.contains(item.key()))
                        out.added_bytes += item.value().at("count").get<std::uint64_t>() *
                                           item.value().at("width").get<std::uint64_t>() * 4;
            };
            count_added(u.at("attributes"), v.at("attributes"));
            for (std::size_t t = 0; t < u.at("targets").size(); ++t)
                count_added(u["targets"][t], v.at("targets").at(t));
            const Triangles before = triangles_of(a, u, names), after = triangles_of(b, v, names);
            out.triangles += before.size();
            if (before != after)
                out.difference = "mesh " + std::to_string(m) + ", primitive " + std::to_string(p) +
                                 ": " + std::to_string(before.size()) + " triangles, " +
                                 std::to_string(after.size()) + " came back, not the same";
        }
    for (const char* list : {"animations", "skins"}) {
        const auto numbers = [&](const test::DecodedGltf& file) {
            std::vector<std::vector<double>> all;
            for (const Json& item : file.json.at(list)) {
                if (item.contains("inverseBindMatrices"))
                    all.push_back(file.numbers(item["inverseBindMatrices"]));
                if (item.contains("samplers"))
                    for (const Json& sampler : item["samplers"])
                        for (const char* part : {"input", "output"})
                            all.push_back(file.numbers(sampler.at(part)));
            }
            return all;
        };
        if (numbers(a) != numbers(b)) out.difference = list;
    }
    for (const char* list : {"images", "materials", "nodes"})
        if (x.size() && a.json.at(list).size() != b.json.at(list).size()) out.difference = list;
    return out;
}

std::vector<fs::path> corpus_files(const fs::path& shared) {
    std::vector<fs::path> out;
    for (const auto& entry : fs::recursive_directory_iterator(shared / "corpus")) {
        const fs::path& file = entry.path();
        if ((file.extension() == ".glb" || file.extension() == ".gltf") &&
            file.string().find("gltf-validator") == std::string::npos)
            out.push_back(file);
    }
    std::sort(out.begin(), out.end());
    return out;
}

// What another program compressed comes out as small: within a tenth, and the bytes of attributes
// that were added; every value as it was. With tangents everywhere nothing can stay as it lies.
void compressed_files_stay_small(bool tangents) {
    MESHPREP_REQUIRE_SHARED(shared);
    MESHPREP_REQUIRE_GLTF_TRANSFORM(modules);
    const test::TempDir dir;
    Json list = Json::array();
    for (const fs::path& file : corpus_files(shared))
        for (const char* method : {"edgebreaker", "sequential", "exact", "meshopt", "filter"})
            list.push_back({{"input", file.string()},
                            {"output", (dir / (std::to_string(list.size()) + ".glb")).string()},
                            {"method", method}});
    test::write_text(dir / "list.json", list.dump());
    const std::string command =
        "node '" + (test::source_dir() / "tests/tools/compress_gltf.mjs").string() + "' '" +
        modules.string() + "' '" + (dir / "list.json").string() + "' >/dev/null 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0);
    std::vector<fs::path> files;
    prep::PrepareOptions options;
    if (tangents) options.request.tangents = prep::Request::Level::always;
    for (const Json& item : list) {
        const fs::path in = item["output"].get<std::string>();
        if (!fs::exists(in)) continue;
        files.push_back(in);
        files.push_back(dir / ("out" + std::to_string(files.size()) + ".glb"));
        save(files[files.size() - 2], files.back(), Compression::keep, options);
        SCOPED_TRACE(item.dump());
        if (::testing::Test::HasFatalFailure()) return;
    }
    const auto decoded = test::decode_gltf(modules, files, dir.path());
    ASSERT_TRUE(decoded.has_value());
    std::size_t compared = 0, triangles = 0;
    for (std::size_t i = 0; i < files.size(); i += 2) {
        const test::DecodedGltf &before = (*decoded)[i], &after = (*decoded)[i + 1];
        ASSERT_FALSE(before.json.contains("error")) << files[i] << before.json["error"];
        ASSERT_FALSE(after.json.contains("error")) << files[i] << after.json["error"];
        const Compared told = compare(before, after, false);
        SCOPED_TRACE(list[i / 2].dump());
        EXPECT_EQ(told.difference, "");
        // Filters make whole numbers of directions, which the other program does not declare.
        Json required = before.json["extensionsRequired"];
        if (list[i / 2]["method"] == "filter") required.push_back("KHR_mesh_quantization");
        EXPECT_EQ(required, after.json["extensionsRequired"]);
        const std::uint64_t was = bytes_without_pictures(files[i]),
                            is = bytes_without_pictures(files[i + 1]);
        EXPECT_LE(is, was * 11 / 10 + told.added_bytes) << was;
        ++compared;
        triangles += told.triangles;
    }
    std::cout << compared << " files, " << triangles << " triangles\n";
    EXPECT_GE(compared, 60u);
    EXPECT_GE(triangles, 100000u);
}

TEST(GltfCompression, CompressedFilesComeOutAsSmallWithTheirValues) {
    compressed_files_stay_small(false);
}

TEST(GltfCompression, FilesThatGetTangentsStayAsSmallBesideThem) {
    compressed_files_stay_small(true);
}

TEST(GltfCompression, WhatWasNotRoundedLosesNothing) {
    MESHPREP_REQUIRE_SHARED(shared);
    MESHPREP_REQUIRE_GLTF_TRANSFORM(modules);
    const test::TempDir dir;
    std::vector<fs::path> files;
    for (const fs::path& file : corpus_files(shared)) {
        const std::string at = std::to_string(files.size());
        files.push_back(dir / (at + "none.glb"));
        files.push_back(dir / (at + "draco.glb"));
        files.push_back(dir / (at + "meshopt.glb"));
        save(file, files[files.size() - 3], Compression::none);
        save(files[files.size() - 3], files[files.size() - 2], Compression::draco);
        save(files[files.size() - 3], files.back(), Compression::meshopt);
        if (HasFatalFailure()) return;
        // What is not rounded and keeps its order gains nothing by Draco but a head.
        EXPECT_LE(bytes_without_pictures(files[files.size() - 2]),
                  bytes_without_pictures(files[files.size() - 3]) * 101 / 100)
            << file;
        EXPECT_LT(bytes_without_pictures(files.back()),
                  bytes_without_pictures(files[files.size() - 3]))
            << file;
    }
    const auto decoded = test::decode_gltf(modules, files, dir.path());
    ASSERT_TRUE(decoded.has_value());
    for (std::size_t i = 0; i < files.size(); ++i) {
        ASSERT_FALSE((*decoded)[i].json.contains("error")) << (*decoded)[i].json["error"];
        if (i % 3 == 0) continue;
        EXPECT_EQ(compare((*decoded)[i / 3 * 3], (*decoded)[i], true).difference, "") << files[i];
        EXPECT_EQ(
            (*decoded)[i].json["extensionsRequired"],
            Json::array({i % 3 == 1 ? "KHR_draco_mesh_compression" : "EXT_meshopt_compression"}));
    }
}

// --- one at a time -------------------------------------------------------------------------------

using Maker = test::GltfMaker;

// A grid of n × n quads with normals that lean, UVs and a morph target.
Maker grid(std::size_t n, bool targets, const std::string& extension = "") {
    Maker d;
    std::vector<float> places, normals, uvs, deltas;
    std::vector<std::uint16_t> indices;
    for (std::size_t y = 0; y <= n; ++y)
        for (std::size_t x = 0; x <= n; ++x) {
            const float u = float(x) / float(n), v = float(y) / float(n);
            places.insert(places.end(), {u, v, 0.1f * std::sin(7 * u + 3 * v)});
            const float l = std::sqrt(1 + 0.04f * u * u);
            normals.insert(normals.end(), {0.2f * u / l, 0, 1 / l});
            uvs.insert(uvs.end(), {u, 1 - v});
            deltas.insert(deltas.end(), {0, 0, float(x * 1000 + y)});
        }
    for (std::size_t y = 0; y < n; ++y)
        for (std::size_t x = 0; x < n; ++x) {
            const auto at = [&](std::size_t dx, std::size_t dy) {
                return std::uint16_t((y + dy) * (n + 1) + x + dx);
            };
            for (const auto i : {at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)})
                indices.push_back(i);
        }
    Maker::Json position{{"bufferView", d.view(places)}, {"componentType", 5126},
                         {"count", places.size() / 3},   {"type", "VEC3"},
                         {"min", {0, 0, -0.1f}},         {"max", {1, 1, 0.1f}}};
    Maker::Json primitive{{"attributes",
                           {{"POSITION", d.accessor(std::move(position))},
                            {"NORMAL", d.accessor(normals, "VEC3")},
                            {"TEXCOORD_0", d.accessor(uvs, "VEC2")}}},
                          {"indices", d.accessor(indices, "SCALAR")}};
    if (targets) {
        primitive["targets"] = {{{"POSITION", d.accessor(deltas, "VEC3")}}};
        Maker::Json& moved = d.json["accessors"].back();
        moved["min"] = {0, 0, 0};
        moved["max"] = {0, 0, deltas.back()};
    }
    if (!extension.empty()) {
        primitive["extensions"][extension] = Maker::Json::object();
        d.json["extensionsUsed"] = {extension};
    }
    d.mesh({primitive});
    return d;
}

// The file that a document becomes; `to` is read anew.
prep::Scene written(const Maker& maker, Compression compression, const fs::path& to) {
    auto scene = maker.read();
    if (!scene) throw std::runtime_error(prep::to_string(scene.error()));
    const prep::PreparedScene prepared = test::untouched(*std::move(scene));
    prep::SaveOptions options;
    options.compression = compression;
    const auto notes = prep::save_scene(prepared, to, options);
    if (!notes) throw std::runtime_error(prep::to_string(notes.error()));
    auto again = prep::load_scene(to);
    if (!again) throw std::runtime_error(prep::to_string(again.error()));
    return *std::move(again);
}

TEST(GltfCompression, MorphTargetsKeepTheOrderOfVertices) {
    const test::TempDir dir;
    const prep::Scene plain = written(grid(9, true), Compression::none, dir / "a.glb"),
                      draco = written(grid(9, true), Compression::draco, dir / "b.glb");
    EXPECT_FALSE(by_edgebreaker(dir / "b.glb"));
    EXPECT_EQ(draco.meshes[0].positions, plain.meshes[0].positions);
    EXPECT_EQ(draco.meshes[0].corner_vertices, plain.meshes[0].corner_vertices);
    ASSERT_EQ(draco.meshes[0].morph_targets.size(), 1u);
    written(grid(9, false), Compression::draco, dir / "c.glb");
    EXPECT_TRUE(by_edgebreaker(dir / "c.glb"));
}

TEST(GltfCompression, ExtensionsThatSpeakOfTheOrderKeepIt) {
    const test::TempDir dir;
    const Maker maker = grid(5, false, "FB_ngon_encoding");
    const prep::Scene plain = written(maker, Compression::none, dir / "a.glb");
    for (const Compression c : {Compression::draco, Compression::meshopt}) {
        const prep::Scene scene = written(maker, c, dir / "b.glb");
        EXPECT_EQ(scene.meshes[0].corner_vertices, plain.meshes[0].corner_vertices)
            << prep::name_of(c);
        EXPECT_EQ(scene.meshes[0].positions, plain.meshes[0].positions);
    }
}

TEST(GltfCompression, TrianglesWithTwoCornersInOnePlaceStay) {
    const test::TempDir dir;
    Maker d;
    const std::vector<float> places = {0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 1, 0};
    Maker::Json position{{"bufferView", d.view(places)},
                         {"componentType", 5126},
                         {"count", 4},
                         {"type", "VEC3"},
                         {"min", {0, 0, 0}},
                         {"max", {1, 1, 0}}};
    const std::size_t p = d.accessor(std::move(position));
    const std::size_t i = d.accessor(std::vector<std::uint16_t>{0, 1, 2, 1, 2, 3}, "SCALAR");
    d.mesh({{{"attributes", {{"POSITION", p}}}, {"indices", i}}});
    EXPECT_EQ(written(d, Compression::draco, dir / "a.glb").meshes[0].face_count(), 2u);
    EXPECT_TRUE(by_edgebreaker(dir / "a.glb"));  // vertices of their own at one place
    // The same vertex twice is no edge to follow.
    Maker twice;
    const std::size_t q = twice.accessor(Maker::Json{{"bufferView", twice.view(places)},
                                                     {"componentType", 5126},
                                                     {"count", 4},
                                                     {"type", "VEC3"},
                                                     {"min", {0, 0, 0}},
                                                     {"max", {1, 1, 0}}});
    const std::size_t j = twice.accessor(std::vector<std::uint16_t>{0, 1, 2, 1, 2, 2}, "SCALAR");
    twice.mesh({{{"attributes", {{"POSITION", q}}}, {"indices", j}}});
    EXPECT_EQ(written(twice, Compression::draco, dir / "b.glb").meshes[0].face_count(), 2u);
    EXPECT_FALSE(by_edgebreaker(dir / "b.glb"));
}

// How the first primitive of a file came.
prep::detail::DracoCoding coding_of(const fs::path& file) {
    const auto scene = prep::load_scene(file);
    const prep::GltfDocument& document = *prep::detail::gltf_document(*scene);
    return *prep::detail::draco_coding(document, document.json["meshes"][0]["primitives"][0], "");
}

TEST(GltfCompression, DracoKeepsTheStepsOfItsInput) {
    using Form = prep::detail::DracoValues::Form;
    const test::TempDir dir;
    prep::detail::DracoSource source;
    source.attributes.reserve(2);
    auto& positions =
        source.attributes.emplace_back("POSITION", prep::detail::RawAccessor{}).second;
    auto& normals = source.attributes.emplace_back("NORMAL", prep::detail::RawAccessor{}).second;
    const std::vector<float> places = {0, 0, 0, 3, 0, 0, 3, 5, 1, 0, 4, 2};
    const std::vector<float> up = {0, 0.6f, 0.8f, 0, 0, 1, 0.6f, 0, 0.8f, 0, 0, 1};
    for (auto* raw : {&positions, &normals}) {
        raw->width = 3;
        raw->count = 4;
        const auto bytes = std::as_bytes(std::span(raw == &positions ? places : up));
        raw->bytes = prep::detail::SharedBytes::lent(bytes);
    }
    source.indices = {0, 1, 2, 0, 2, 3};
    prep::detail::DracoCoding coding;
    coding.values["POSITION"] = {Form::grid, 11, {-1, -1, -1}, 8};
    coding.values["NORMAL"] = {Form::octahedral, 9, {}, 0};
    const auto made = prep::detail::encode_draco(source, coding);
    ASSERT_TRUE(made.has_value());
    Maker d;
    const std::size_t view = d.view(std::span<const std::byte>(made->bytes));
    const auto accessor = [&](bool bounded) {
        Maker::Json out{{"componentType", 5126}, {"count", made->vertices}, {"type", "VEC3"}};
        if (bounded) {
            out["min"] = made->least;
            out["max"] = made->most;
        }
        return d.accessor(std::move(out));
    };
    Maker::Json primitive{
        {"attributes", {{"POSITION", accessor(true)}, {"NORMAL", accessor(false)}}}};
    primitive["indices"] =
        d.accessor(Maker::Json{{"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}});
    primitive["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", view},
        {"attributes",
         {{"POSITION", made->ids.at("POSITION")}, {"NORMAL", made->ids.at("NORMAL")}}}};
    d.json["extensionsUsed"] = d.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    d.mesh({primitive});
    // Facets: other normals, and vertices apart.
    auto scene = d.read();
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const std::vector<glm::vec3> before = scene->meshes[0].positions;
    prep::PrepareOptions options;
    options.normals = prep::Authored::replace;
    options.hard_edges.angle_degrees = 0;
    const auto prepared = prep::prepare(*std::move(scene), options);
    ASSERT_TRUE(prepared.has_value());
    ASSERT_TRUE(prep::save_scene(*prepared, dir / "out.glb").has_value());
    const prep::detail::DracoCoding after = coding_of(dir / "out.glb");
    const auto& grid = after.values.at("POSITION");
    EXPECT_EQ(grid.form, Form::grid);
    EXPECT_EQ(grid.bits, 11);
    EXPECT_EQ(grid.origin, (std::vector<float>{-1, -1, -1}));
    EXPECT_EQ(grid.range, 8);
    EXPECT_EQ(after.values.at("NORMAL").form, Form::octahedral);
    EXPECT_EQ(after.values.at("NORMAL").bits, 9);
    const auto again = prep::load_scene(dir / "out.glb");
    ASSERT_EQ(again->meshes[0].vertex_count(), 6u);
    for (const glm::vec3& q : again->meshes[0].positions)
        EXPECT_NE(std::find(before.begin(), before.end(), q), before.end());
}

// A grid that a file states but that cannot hold the values: the encoder takes one of its own.
TEST(GltfCompression, GridsThatCannotHoldTheValuesAreNotUsed) {
    using Form = prep::detail::DracoValues::Form;
    prep::detail::DracoSource source;
    auto& positions =
        source.attributes.emplace_back("POSITION", prep::detail::RawAccessor{}).second;
    const std::vector<float> places = {0, 0, 0, 3, 0, 0, 3, 5, 1, 0, 4, 2};
    positions.width = 3;
    positions.count = 4;
    const auto bytes = std::as_bytes(std::span(places));
    positions.bytes = prep::detail::SharedBytes::lent(bytes);
    source.indices = {0, 1, 2, 0, 2, 3};
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (const float range : {0.0f, -8.0f, 4.0f, infinity, std::nanf("")}) {
        prep::detail::DracoCoding coding;
        coding.values["POSITION"] = {Form::grid, 14, {0, 0, 0}, range};
        const auto made = prep::detail::encode_draco(source, coding);
        ASSERT_TRUE(made.has_value()) << range;
        const std::vector<float> most = {3, 5, 2};
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(made->least[k], 0, 1e-3f) << range;
            EXPECT_NEAR(made->most[k], most[k], 1e-3f) << range;
        }
    }
}

// The extension's stride is the view's, which need not divide it; and it knows no indices of a
// byte.
TEST(GltfCompression, WhatMeshoptCannotHoldIsTold) {
    const test::TempDir dir;
    Maker d;
    std::vector<float> places;
    std::vector<std::uint8_t> indices;
    for (std::uint8_t i = 0; i < 60; ++i) {
        places.insert(places.end(), {float(i % 6), float(i / 6), 0, 0});
        if (i >= 2) indices.insert(indices.end(), {i, std::uint8_t(i - 1), std::uint8_t(i - 2)});
    }
    places.pop_back();
    Maker::Json position{{"bufferView", d.view(places, 16)},
                         {"componentType", 5126},
                         {"count", 60},
                         {"type", "VEC3"},
                         {"min", {0, 0, 0}},
                         {"max", {5, 9, 0}}};
    const std::size_t p = d.accessor(std::move(position));
    d.mesh({{{"attributes", {{"POSITION", p}}}, {"indices", d.accessor(indices, "SCALAR")}}});
    auto scene = d.read();
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const std::vector<glm::vec3> before = scene->meshes[0].positions;
    prep::SaveOptions options;
    options.compression = Compression::meshopt;
    const auto notes = prep::save_scene(test::untouched(*std::move(scene)), dir / "a.glb", options);
    ASSERT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    EXPECT_NE(std::find(notes->begin(), notes->end(),
                        "2 bufferViews that meshopt cannot hold left uncompressed"),
              notes->end());
    const auto again = prep::load_scene(dir / "a.glb");
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    EXPECT_EQ(again->meshes[0].positions, before);
}

TEST(GltfCompression, WhatChangesNothingStaysByteForByte) {
    const test::TempDir dir;
    for (const Compression c : {Compression::draco, Compression::meshopt}) {
        written(grid(9, false), c, dir / "a.glb");
        save(dir / "a.glb", dir / "b.glb", Compression::keep);
        if (HasFatalFailure()) return;
        EXPECT_EQ(test::file_text(dir / "a.glb"), test::file_text(dir / "b.glb"))
            << prep::name_of(c);
        save(dir / "b.glb", dir / "c.glb", Compression::none);
        EXPECT_EQ(test::GltfFile(dir / "c.glb").json.dump().find("compression"), std::string::npos);
    }
}

TEST(GltfCompression, TheSameBytesForAnyThreadCount) {
    const test::TempDir dir;
    for (const Compression c : {Compression::draco, Compression::meshopt})
        for (const int threads : {1, 2, 7}) {
            prep::PrepareOptions options;
            options.threads = threads;
            options.request.tangents = prep::Request::Level::always;
            written(grid(30, false), c, dir / "in.glb");
            save(dir / "in.glb", dir / (std::to_string(threads) + ".glb"), Compression::keep,
                 options);
            EXPECT_EQ(test::file_text(dir / "1.glb"),
                      test::file_text(dir / (std::to_string(threads) + ".glb")));
        }
}

TEST(GltfCompression, PrimitivesOfTheSameDataShareThem) {
    const test::TempDir dir;
    Maker d = grid(9, false);
    d.json["meshes"][0]["primitives"].push_back(d.json["meshes"][0]["primitives"][0]);
    written(d, Compression::draco, dir / "a.glb");
    EXPECT_EQ(test::GltfFile(dir / "a.glb").json["bufferViews"].size(), 1u);
}

TEST(GltfCompression, TheValidatorFindsNoErrorsInIt) {
    MESHPREP_REQUIRE_NPM(validator, "gltf-validator");
    const test::TempDir dir;
    Json list = Json::array();
    for (const Compression c : {Compression::draco, Compression::meshopt})
        for (const char* ending : {".glb", ".gltf"}) {
            const std::string name = std::string(prep::name_of(c)) + ending;
            written(grid(9, ending == std::string(".glb")), c, dir / name);
            list.push_back({{"name", name}, {"output", (dir / name).string()}});
            list.back()["before"] = Json::object();
        }
    EXPECT_TRUE(test::validates(validator, list, dir / "list.json"))
        << "its complaints stand above";
}

TEST(GltfCompression, OtherFormatsHaveNone) {
    const test::TempDir dir;
    auto scene = grid(2, false).read();
    const prep::PreparedScene prepared = test::untouched(*std::move(scene));
    for (const Compression c : {Compression::draco, Compression::meshopt}) {
        prep::SaveOptions options;
        options.compression = c;
        const auto notes = prep::save_scene(prepared, dir / "a.obj", options);
        ASSERT_FALSE(notes.has_value());
        EXPECT_EQ(notes.error().code, prep::ErrorCode::unsupported);
        EXPECT_NE(notes.error().text.find(prep::name_of(c)), std::string::npos);
    }
    EXPECT_TRUE(dir.names().empty());
    EXPECT_TRUE(prep::save_scene(prepared, dir / "a.obj").has_value());
}

TEST(MeshoptEncoder, RefusesWhatTheCodecsDoNotTake) {
    using prep::detail::MeshoptMode;
    const std::vector<std::byte> zeros(1200);
    const auto takes = [&](MeshoptMode mode, std::size_t stride, std::size_t size) {
        return prep::detail::encode_meshopt(mode, stride, std::span(zeros).first(size)).has_value();
    };
    EXPECT_TRUE(takes(MeshoptMode::attributes, 12, 1200));
    EXPECT_FALSE(takes(MeshoptMode::attributes, 6, 1200));
    EXPECT_FALSE(takes(MeshoptMode::attributes, 260, 1040));
    EXPECT_FALSE(takes(MeshoptMode::attributes, 16, 1000));
    EXPECT_TRUE(takes(MeshoptMode::indices, 2, 400));
    EXPECT_FALSE(takes(MeshoptMode::indices, 1, 400));
    EXPECT_TRUE(takes(MeshoptMode::triangles, 4, 1200));
    EXPECT_FALSE(takes(MeshoptMode::triangles, 4, 400));
    EXPECT_FALSE(takes(MeshoptMode::attributes, 4, 0));
}

}  // namespace
