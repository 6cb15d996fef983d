// glTF documents written back: what is carried over, and what must not be.
#include <gtest/gtest.h>

#include <stdexcept>

#include "gltf_source.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "temporary_files.h"
#include "written_gltf.h"

namespace {

using Floats = std::vector<float>;
using Json = test::GltfSource::Json;
using test::GltfSource;

GltfSource lone_triangle() {
    GltfSource d;
    d.mesh({{{"attributes", {{"POSITION", d.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}}});
    return d;
}

// Prepared with normals of its own, which splits vertices, and written back.
test::GltfFile written_back(const GltfSource& d, const test::TempDir& dir,
                            prep::PrepareOptions options = {}) {
    d.write(dir / "a.glb");
    auto scene = prep::load_scene(dir / "a.glb");
    if (!scene) throw std::runtime_error(prep::to_string(scene.error()));
    options.request.normals = prep::Request::Level::always;
    const auto prepared = prep::prepare(*std::move(scene), options);
    if (!prepared) throw std::runtime_error(prep::to_string(prepared.error()));
    const auto saved = prep::save_scene(*prepared, dir / "b.glb");
    if (!saved) throw std::runtime_error(prep::to_string(saved.error()));
    test::GltfFile file(dir / "b.glb");
    EXPECT_EQ(file.fault(), "");
    return file;
}

// "3.0" is 3, also for what is carried over.
TEST(GltfWrittenBack, IndicesWrittenAsFloatsAreKept) {
    GltfSource d = lone_triangle();
    const std::size_t picture = d.view(std::vector<std::uint8_t>{0x89, 'P', 'N', 'G'});
    d.push("images", {{"bufferView", double(picture)}, {"mimeType", "image/png"}});
    const std::size_t times = d.add_floats("SCALAR", {0, 1});
    const std::size_t moves = d.add_floats("VEC3", {0, 0, 0, 1, 2, 3});
    d.json["animations"] = {
        {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
         {"samplers", {{{"input", double(times)}, {"output", double(moves)}}}}}};
    EXPECT_NE(d.gltf().find("\"input\":" + std::to_string(times) + ".0"), std::string::npos);
    const test::TempDir dir;
    const test::GltfFile file = written_back(d, dir);
    const auto& sampler = file.json["animations"][0]["samplers"][0];
    EXPECT_EQ(file.accessor(sampler["output"]).values, (std::vector<double>{0, 0, 0, 1, 2, 3}));
    EXPECT_EQ(file.view_bytes(file.json["images"][0]["bufferView"]).substr(0, 4), "\x89PNG");
}

// Columns of small matrices are padded in files; vertices that move take theirs along.
TEST(GltfWrittenBack, MatricesByVertexKeepTheirColumns) {
    for (const bool shorts : {false, true}) {
        GltfSource d;
        // Two triangles that share an edge over a right angle: its vertices split.
        const std::size_t positions = d.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
        std::vector<std::uint8_t> bytes;
        std::vector<std::uint16_t> words;
        std::vector<std::vector<double>> matrices(4);
        for (int v = 0; v < 4; ++v)
            for (int c = 0; c < 3; ++c)
                for (int r = 0; r < 4; ++r) {
                    bytes.push_back(std::uint8_t(r < 3 ? 40 * v + 10 * c + r : 0));
                    words.push_back(std::uint16_t(bytes.back() * 7));
                    if (r < 3)
                        matrices[std::size_t(v)].push_back(shorts ? words.back() : bytes.back());
                }
        const Json matrix{{"bufferView", shorts ? d.view(words) : d.view(bytes)},
                          {"componentType", shorts ? 5123 : 5121},
                          {"count", 4},
                          {"type", "MAT3"}};
        const std::size_t twist = d.accessor(matrix);
        const std::size_t indices =
            d.accessor(std::vector<std::uint32_t>{0, 1, 2, 1, 0, 3}, "SCALAR");
        d.mesh(
            {{{"attributes", {{"POSITION", positions}, {"_TWIST", twist}}}, {"indices", indices}}});
        const test::TempDir dir;
        const test::GltfFile after = written_back(d, dir), before(dir / "a.glb");
        ASSERT_EQ(after.attribute(0, 0, "POSITION").count(), 6u);
        const auto corners = after.triangles(0, 0), file_corners = before.triangles(0, 0);
        for (std::size_t c = 0; c < 6; ++c)
            EXPECT_EQ(after.attribute(0, 0, "_TWIST").at(corners[c]), matrices[file_corners[c]])
                << c << shorts;
    }
}

TEST(GltfWrittenBack, MatricesOfRefinedMeshesAreMatrices) {
    GltfSource d;
    const std::size_t positions = d.add_positions(Floats{0, 0, 0, 1, 0, 0, 0, 1, 0});
    std::vector<float> values;
    for (int v = 0; v < 3; ++v)
        for (int k = 0; k < 16; ++k) values.push_back(float(100 * v + k));
    d.mesh({{{"attributes", {{"POSITION", positions}, {"_FRAME", d.add_floats("MAT4", values)}}}}});
    prep::PrepareOptions options;
    options.subdivide = true;
    options.subdivision.scheme = prep::SubdivisionScheme::loop;
    options.subdivision.level = 1;
    const test::TempDir dir;
    const test::GltfFile file = written_back(d, dir, options);
    const test::GltfValues frames = file.attribute(0, 0, "_FRAME");
    EXPECT_EQ(frames.type, "MAT4");
    ASSERT_EQ(frames.count(), 6u);
    // Entries of one matrix go on by 1, whatever the mask: masks sum to 1.
    for (std::size_t v = 0; v < frames.count(); ++v)
        for (std::size_t k = 0; k < 16; ++k)
            EXPECT_NEAR(frames.at(v)[k], frames.at(v)[0] + double(k), 1e-3) << v << ' ' << k;
}

// The document that is written back knows nothing of meshes that a program puts in or takes out.
TEST(GltfWrittenBack, MeshesThatAreNotTheDocumentsAreAnError) {
    for (const int change : {0, 1, 2}) {
        auto scene = lone_triangle().read();
        ASSERT_TRUE(scene) << test::error_of(scene);
        prep::Mesh own = scene->meshes[0];
        own.tied_to_file = false;
        if (change == 0) scene->meshes.push_back(own);
        if (change == 1) scene->meshes.clear(), scene->nodes.clear();
        if (change == 2) scene->meshes[0] = own;
        const auto prepared = prep::prepare(*std::move(scene), {});
        ASSERT_TRUE(prepared) << prep::to_string(prepared.error());
        const test::TempDir dir;
        const auto saved = prep::save_scene(*prepared, dir / "b.glb");
        ASSERT_FALSE(saved) << change;
        EXPECT_NE(saved.error().text.find("not those of its document"), std::string::npos);
        EXPECT_EQ(dir.names(), std::vector<std::string>{});
    }
}

// The document has nodes of its own: what a program does to the scene's would be lost.
TEST(GltfWrittenBack, NodesThatAreNotTheDocumentsAreAnError) {
    GltfSource d = lone_triangle();
    const test::TempDir dir;
    d.write(dir / "a.glb");
    const auto error_after = [&](const auto& edit) -> std::string {
        auto scene = prep::load_scene(dir / "a.glb");
        if (!scene) return prep::to_string(scene.error());
        edit(*scene);
        const auto prepared = prep::prepare(*std::move(scene));
        if (!prepared) return prep::to_string(prepared.error());
        const auto saved = prep::save_scene(*prepared, dir / "b.glb");
        return saved ? "" : prep::to_string(saved.error());
    };
    const std::string told = "the scene's nodes are not those of its document any more";
    EXPECT_EQ(error_after([](prep::Scene& s) { prep::place_scene(s, 2, prep::Axis::z); }), "");
    EXPECT_NE(error_after([](prep::Scene& s) { s.nodes[0].transform[3][0] = 5; }).find(told),
              std::string::npos);
    EXPECT_NE(error_after([](prep::Scene& s) { s.nodes.emplace_back(); }).find(told),
              std::string::npos);
    EXPECT_NE(error_after([](prep::Scene& s) {
                  s.nodes[0].trs = prep::Trs{{1, 0, 0}, {}, {}};
              }).find(told),
              std::string::npos);
    EXPECT_NE(error_after([](prep::Scene& s) {
                  prep::place_scene(s, 2, prep::Axis::y);
                  s.nodes[0].parent = prep::no_index;
              }).find(told),
              std::string::npos);
    EXPECT_NE(error_after([](prep::Scene& s) { s.nodes[0].mesh = prep::no_index; }).find(told),
              std::string::npos);
    EXPECT_EQ(error_after([](prep::Scene& s) {
                  s.nodes[0].transform[3][0] = 5;
                  s.nodes[0].trs.reset();
                  s.retained_file.reset();
                  for (prep::Mesh& m : s.meshes) m.tied_to_file = false;
              }),
              "");
    const auto moved = prep::load_scene(dir / "b.glb");
    ASSERT_TRUE(moved) << prep::to_string(moved.error());
    EXPECT_EQ(moved->nodes[0].transform[3][0], 5);
}

TEST(GltfWrittenBack, EndingsInCapitalsAreTheSameFormat) {
    auto scene = lone_triangle().read();
    ASSERT_TRUE(scene) << test::error_of(scene);
    const auto prepared = prep::prepare(*std::move(scene), {});
    ASSERT_TRUE(prepared) << prep::to_string(prepared.error());
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(*prepared, dir / "A.GLTF").has_value());
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"A.GLTF", "A.bin"}));
    EXPECT_EQ(test::file_text(dir / "A.GLTF").front(), '{');
}

}  // namespace
