// glTF extensions by what is made of them: read, carried with a note, put right where vertices are
// split, left out where that cannot be, refused where a file requires them.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "formats/gltf/extensions.h"
#include "gltf_source.h"
#include "prep/image.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

using Json = test::GltfMaker::Json;

// A roof: two quads that meet at 90°, each as two triangles, the ridge's vertices 0 and 1 shared:
// preparing splits them.
struct Roof : test::GltfSource {
    Roof() {
        const auto positions =
            add_positions({0, 0, 1, 1, 0, 1, 0, 1, 0, 1, 1, 0, 0, -1, 0, 1, -1, 0});
        const auto indices =
            accessor(std::vector<std::uint16_t>{0, 1, 3, 0, 3, 2, 1, 0, 4, 1, 4, 5}, "SCALAR");
        primitive = {{"attributes", {{"POSITION", positions}}}, {"indices", indices}};
    }
    void uses(const std::string& name, const Json& value, bool required = false) {
        primitive["extensions"][name] = value;
        json["extensionsUsed"].push_back(name);
        if (required) json["extensionsRequired"].push_back(name);
    }
    Json primitive;
};

struct Written {
    test::GltfFile file;
    std::vector<std::string> notes;
};

// Prepared with the edge hard, and written.
Written written(Roof roof) {
    const test::TempDir dir;
    roof.mesh(Json::array({roof.primitive}));
    roof.write(dir / "in.glb");
    auto scene = prep::load_scene(dir / "in.glb");
    EXPECT_TRUE(scene) << test::error_of(scene);
    prep::PrepareOptions options;
    options.request.normals = prep::Request::Level::always;
    auto prepared = prep::prepare(std::move(*scene), options);
    EXPECT_TRUE(prepared);
    auto notes = prep::save_scene(*prepared, dir / "out.glb");
    EXPECT_TRUE(notes);
    return {test::GltfFile(dir / "out.glb"), *notes};
}

bool mentions(const std::vector<std::string>& notes, const std::string& name) {
    return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
        return note.find("extension " + name) != std::string::npos;
    });
}

std::string error_when_required(const std::string& name,
                                const std::vector<std::string>& allowed = {}) {
    Roof roof;
    roof.uses(name, Json::object(), true);
    const test::TempDir dir;
    roof.mesh(Json::array({roof.primitive}));
    roof.write(dir / "in.glb");
    prep::LoadOptions options;
    options.allowed_extensions = allowed;
    return test::error_of(prep::load_scene(dir / "in.glb", options));
}

// The ridge is one edge of the file and two of the result: it and an eave are drawn there.
TEST(GltfExtensions, OutlinesFollowTheSplit) {
    Roof roof;
    const auto outline = roof.accessor(std::vector<std::uint16_t>{0, 1, 2, 3}, "SCALAR");
    roof.uses("CESIUM_primitive_outline", {{"indices", outline}});
    const Written out = written(roof);
    const auto& primitive = out.file.primitive(0, 0);
    const test::GltfValues positions = out.file.attribute(0, 0, "POSITION");
    ASSERT_EQ(positions.count(), 8u);
    const test::GltfValues edges =
        out.file.accessor(primitive["extensions"]["CESIUM_primitive_outline"]["indices"]);
    ASSERT_EQ(edges.count() % 2, 0u);
    std::multiset<std::pair<double, double>> ends;  // y of both ends
    const std::vector<std::size_t> triangles = out.file.triangles(0, 0);
    for (std::size_t e = 0; e + 1 < edges.count(); e += 2) {
        const auto a = std::size_t(edges.values[e]), b = std::size_t(edges.values[e + 1]);
        ends.insert({positions.at(a)[1], positions.at(b)[1]});
        bool of_a_triangle = false;
        for (std::size_t t = 0; t < triangles.size(); t += 3) {
            const std::set<std::size_t> corners(triangles.begin() + std::ptrdiff_t(t),
                                                triangles.begin() + std::ptrdiff_t(t + 3));
            of_a_triangle |= corners.contains(a) && corners.contains(b);
        }
        EXPECT_TRUE(of_a_triangle);
    }
    EXPECT_EQ(ends, (std::multiset<std::pair<double, double>>{{0, 0}, {0, 0}, {1, 1}}));
}

TEST(GltfExtensions, FeaturesNumberedByVertexAreLeftOutOthersStay) {
    Roof roof;
    roof.uses("EXT_mesh_features", {{"featureIds", {{{"featureCount", 6}}}}});
    Written out = written(roof);
    EXPECT_FALSE(out.file.primitive(0, 0).contains("extensions"));
    EXPECT_TRUE(mentions(out.notes, "EXT_mesh_features"));

    Roof named;
    named.primitive["attributes"]["_FEATURE_ID_0"] = named.add_floats("SCALAR", {0, 1, 2, 3, 4, 5});
    named.uses("EXT_mesh_features", {{"featureIds", {{{"featureCount", 6}, {"attribute", 0}}}}});
    out = written(named);
    EXPECT_TRUE(out.file.primitive(0, 0)["extensions"].contains("EXT_mesh_features"));
    EXPECT_FALSE(mentions(out.notes, "EXT_mesh_features"));
    EXPECT_EQ(out.file.attribute(0, 0, "_FEATURE_ID_0").count(), 8u);
}

TEST(GltfExtensions, PolygonsStayWhereTheirTrianglesStillBeginWithOneVertex) {
    Roof roof;
    roof.uses("FB_ngon_encoding", Json::object());
    EXPECT_TRUE(written(roof).file.primitive(0, 0)["extensions"].contains("FB_ngon_encoding"));
    const std::vector<std::uint32_t> same{0, 0, 1, 2, 3}, apart{0, 0, 1, 2, 3};
    const std::vector<std::uint32_t> one{0, 2, 3, 0, 3, 4}, two{0, 2, 3, 1, 3, 4};
    EXPECT_TRUE(prep::detail::keeps_polygons({same, one}));
    EXPECT_FALSE(prep::detail::keeps_polygons({apart, two})) << "a polygon fell apart";
    const std::vector<std::uint32_t> merged{0, 1, 2, 3, 4};
    EXPECT_TRUE(prep::detail::keeps_polygons({merged, two})) << "two stay two";
}

TEST(GltfExtensions, OnesThatMergeVerticesByNumberAreLeftOut) {
    Roof roof;
    roof.uses("EXT_mesh_manifold", {{"manifoldPrimitive", Json::object()}});
    const Written out = written(roof);
    EXPECT_FALSE(out.file.primitive(0, 0).contains("extensions"));
    EXPECT_TRUE(mentions(out.notes, "EXT_mesh_manifold"));
}

// Nothing is split where no edge is hard and normals are there: numbers are as they were.
TEST(GltfExtensions, AnUnchangedPrimitiveKeepsThemAll) {
    Roof roof;
    roof.primitive["attributes"]["NORMAL"] =
        roof.add_floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    roof.uses("EXT_mesh_manifold", {{"manifoldPrimitive", Json::object()}});
    roof.uses("EXT_mesh_features", {{"featureIds", {{{"featureCount", 6}}}}});
    const Written out = written(roof);
    EXPECT_EQ(out.file.primitive(0, 0)["extensions"].size(), 2u);
    EXPECT_FALSE(mentions(out.notes, "EXT_mesh_manifold"));
}

TEST(GltfExtensions, RequiredOnesAreReadCarriedOrRefused) {
    for (const prep::detail::GltfExtension& row : prep::detail::gltf_extensions()) {
        using enum prep::detail::ExtensionUse;
        const std::string name(row.name);
        const auto plain = prep::detail::required_extension(name, {});
        const auto allowed = prep::detail::required_extension(name, {name});
        const auto any = prep::detail::required_extension(name, {"all"});
        const bool harmless = row.use == read || row.use == carried || row.use == remapped;
        EXPECT_EQ(plain.has_value(), harmless) << name;
        EXPECT_EQ(allowed.has_value(), row.use != undecodable) << name;
        EXPECT_EQ(any.has_value(), row.use != undecodable) << name;
        if (plain) {
            EXPECT_EQ(plain->empty(), row.use == read) << name;
        }
        EXPECT_EQ(row.reason.empty(), row.use == read) << name;
    }
    EXPECT_EQ(error_when_required("KHR_node_visibility"), "no error");
    EXPECT_NE(error_when_required("EXT_mesh_manifold").find("merges vertices by their numbers"),
              std::string::npos);
    EXPECT_NE(error_when_required("VENDOR_new").find("--allow-extension VENDOR_new"),
              std::string::npos);
    EXPECT_EQ(error_when_required("VENDOR_new", {"VENDOR_new"}), "no error");
    EXPECT_EQ(error_when_required("VENDOR_new", {"all"}), "no error");
    EXPECT_NE(error_when_required("VENDOR_new", {"VENDOR_other"}), "no error");
}

TEST(GltfExtensions, ThePageSaysOfEachWhatTheTableSays) {
    const std::string page = test::file_text(test::source_dir() / "docs" / "gltf-extensions.md");
    const char* const uses[] = {"read", "carried", "remapped", "per vertex", "undecodable"};
    std::string table = "| extension | made of it | it |\n|---|---|---|\n";
    for (const prep::detail::GltfExtension& row : prep::detail::gltf_extensions())
        table += "| " + std::string(row.name) + " | " + uses[std::size_t(row.use)] + " | " +
                 (row.reason.empty() ? "is obeyed" : std::string(row.reason)) + " |\n";
    EXPECT_NE(page.find(table + "\n"), std::string::npos) << table;
}

// Neither of the two is large; nor is what is made of them.
TEST(PackedPictures, AreOfTheSizeOfTheLargest) {
    const test::TempDir dir;
    prep::Image wide, high;
    wide.width = high.height = 300;
    wide.height = high.width = 1;
    wide.channels = high.channels = 1;
    wide.pixels.assign(300, 0.25f);
    high.pixels.assign(300, 0.75f);
    ASSERT_TRUE(prep::save_image(dir / "wide.png", wide).has_value());
    ASSERT_TRUE(prep::save_image(dir / "high.png", high).has_value());
    prep::ImageRef ref;
    for (const char* name : {"wide.png", "high.png"}) {
        auto source = std::make_shared<prep::ImageRef>();
        source->path = dir / name;
        ref.channels.push_back({.source = source});
    }
    const auto image = prep::load_image(ref);
    ASSERT_TRUE(image.has_value());
    EXPECT_EQ(std::size_t(image->width) * image->height, 300u);
}

TEST(GltfExtensions, JetFighterGlb) {
    MESHPREP_REQUIRE_SHARED(shared);
    const auto scene = prep::load_scene(shared / "real_files" / "jet-fighter.glb");
    ASSERT_TRUE(scene) << test::error_of(scene);
    ASSERT_FALSE(scene->warnings.empty());
    EXPECT_NE(scene->warnings[0].find("KHR_texture_basisu is carried"), std::string::npos)
        << scene->warnings[0];
    ASSERT_FALSE(scene->images.empty());
    for (const prep::Texture& texture : scene->textures)
        EXPECT_LT(texture.image, scene->images.size());
    const auto image = prep::load_image(scene->images[0]);
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().code, prep::ErrorCode::unsupported);
}

}  // namespace
