// Files that other programs read: carriage returns alone as line ends, references to normals that
// are not there; and files with nothing in them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <tuple>

#include "formats/obj/obj.h"
#include "formats/off/off.h"
#include "formats/ply/ply.h"
#include "formats/scene_json/merge.h"
#include "formats/stl/stl.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "shared_data.h"

namespace {

std::string with_cr(std::string text) {
    std::replace(text.begin(), text.end(), '\n', '\r');
    return text;
}

prep::Result<prep::Scene> parse_obj(std::span<const std::byte> bytes, const std::string& name) {
    prep::ObjOptions options;
    options.name = name;
    return prep::parse_obj(bytes, options);
}

using Parser = prep::Result<prep::Scene> (*)(std::span<const std::byte>, const std::string&);

TEST(OddFiles, LinesMayEndWithCarriageReturns) {
    const std::tuple<Parser, const char*, std::string> files[] = {
        {parse_obj, "t.obj", "# old\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n"},
        {prep::parse_off, "t.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
        {prep::parse_stl, "t.stl",
         "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
         "endloop\nendfacet\nendsolid a\n"},
        {prep::parse_ply, "t.ply",
         "ply\nformat ascii 1.0\ncomment x\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
    };
    for (const auto& [parse, name, text] : files) {
        const auto plain = test::parsed(parse, text, name),
                   odd = test::parsed(parse, with_cr(text), name);
        ASSERT_TRUE(plain) << name << ": " << test::error_of(plain);
        ASSERT_TRUE(odd) << name << ": " << test::error_of(odd);
        EXPECT_EQ(odd->meshes[0].face_count(), 1u) << name;
        EXPECT_EQ(test::exact_difference(plain->meshes[0], odd->meshes[0]), "") << name;
    }
    // Errors count lines all the same.
    EXPECT_NE(
        test::error_of(test::parsed(parse_obj, "v 0 0 0\rv 1 x 0\r", "t.obj")).find("t.obj:2"),
        std::string::npos);
}

// The bytes behind a binary file's header are no line ends.
TEST(OddFiles, BinaryPlyBehindAHeaderOfCarriageReturnsKeepsItsBytes) {
    std::string text = with_cr(
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar red\n"
        "property uchar green\nproperty uchar blue\n"
        "property float x\nproperty float y\nproperty float z\nend_header\n");
    std::string data(15, '\0');
    data[0] = '\r';
    text += data;
    const auto scene = test::parsed(prep::parse_ply, text, "t.ply");
    ASSERT_TRUE(scene) << test::error_of(scene);
    ASSERT_EQ(scene->meshes[0].vertex_colors.size(), 1u);
    // 13 of 255, decoded from sRGB: linear below 0.04045 · 255 = 10.3, a power above.
    EXPECT_NEAR(scene->meshes[0].vertex_colors[0].r, std::pow((13 / 255.0 + 0.055) / 1.055, 2.4),
                1e-6);
}

TEST(OddFiles, MaterialLibrariesMayEndLinesWithCarriageReturns) {
    const auto library =
        prep::parse_mtl(with_cr("newmtl a\nKd 0.25 0.5 0.75\nnewmtl b\nNs 7\n"), "m.mtl", {});
    ASSERT_EQ(library.materials.size(), 2u);
    EXPECT_EQ(library.materials[1].shininess, 7.0f);
}

TEST(OddFiles, NormalsAndTextureCoordinatesThatAreNotThereAreLeftOut) {
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    auto scene = test::parsed(parse_obj, corners + "f 1//1 2//2 3//-1\n", "t.obj");
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_TRUE(scene->meshes[0].normals.empty());
    EXPECT_EQ(scene->warnings,
              std::vector<std::string>{"t.obj:4: corners name normals, of which the file has none: "
                                       "left out (3 in all)"});
    scene = test::parsed(parse_obj, corners + "vn 0 0 1\nf 1/5/1 2/6/1 3/7/1\n", "t.obj");
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_TRUE(scene->meshes[0].uvs.empty());
    EXPECT_EQ(scene->meshes[0].normals.values.size(), 1u);
    EXPECT_EQ(scene->warnings.size(), 1u);
    // Where there are some, an index beyond them is an error as ever.
    EXPECT_NE(
        test::error_of(test::parsed(parse_obj, corners + "vn 0 0 1\nf 1//2 2//1 3//1\n", "t.obj"))
            .find("normal index 2 is out of range: the file has 1"),
        std::string::npos);
}

TEST(OddFiles, AreNothingWithoutFacesLinesOrPoints) {
    const auto said = [](const std::string& text) {
        const auto scene = test::parsed(parse_obj, text, "t.obj");
        EXPECT_TRUE(scene);
        const auto some = prep::require_geometry(*scene);
        return some ? std::string("fine") : some.error().text;
    };
    EXPECT_EQ(said("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "fine");
    EXPECT_EQ(said("v 0 0 0\nv 1 0 0\nl 1 2\n"), "fine");
    EXPECT_EQ(said("v 0 0 0\np 1\n"), "fine");
    EXPECT_EQ(said("v 0 0 0\nv 1 0 0\n"), "fine");  // a point cloud
    EXPECT_NE(said("v 0 0 0\nv 1 0 0\nf 1 2\n").find("found 2 vertices"), std::string::npos);
    EXPECT_NE(said("v 0 0 0\nv 1 0 0\ncurv 0 1 1 2\nend\n").find("found 2 vertices"),
              std::string::npos);
    EXPECT_EQ(said("hello\nthere\n"),
              "no faces, lines or points are in the file; found nothing; the reader says: t.obj:1: "
              "unknown statement 'hello' was skipped (2 in all)");
}

// Programs fill scenes by hand.
TEST(OddFiles, VerticesThatAreNotThereAreNowhere) {
    const auto some = [](const prep::Mesh& mesh) {
        prep::Scene scene;
        scene.meshes.push_back(mesh);
        return prep::require_geometry(scene).has_value();
    };
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.face_offsets = {0, 3};
    mesh.corner_vertices = {0, 1, 2};
    EXPECT_TRUE(some(mesh));
    mesh.corner_vertices = {0, 1, 3};
    EXPECT_FALSE(some(mesh));
    mesh.corner_vertices = {0, 1, 0xffffffff};
    EXPECT_FALSE(some(mesh));
    mesh.corner_vertices = {0, 1};
    EXPECT_FALSE(some(mesh));
    mesh.points = {7};
    EXPECT_FALSE(some(mesh));
    mesh.points = {2};
    EXPECT_TRUE(some(mesh));
}

// Each file once, and its neighbours are not all looked at for that.
TEST(OddFiles, ManyFilesOfASceneTakeTimeInProportion) {
    const auto seconds = [](std::size_t count) {
        double best = 1e9;
        for (int k = 0; k < 3; ++k) {
            prep::Scene scene;
            prep::detail::ReadFiles files;
            const std::clock_t start = std::clock();
            for (std::size_t n = 0; n < count; ++n) {
                prep::Scene part;
                part.source = "parts/" + std::to_string(n) + ".obj";
                part.libraries = {"parts/shared.mtl"};
                prep::detail::merge_scene(scene, std::move(part), "part", files);
            }
            best = std::min(best, double(std::clock() - start) / CLOCKS_PER_SEC);
            EXPECT_EQ(scene.libraries.size(), count + 1);
        }
        return best;
    };
    // 16 times the files: 16 times the time, or 256 where all are looked at.
    EXPECT_LT(seconds(16000), 64 * seconds(1000));
}

TEST(OddFiles, CubeGlb) {
    MESHPREP_REQUIRE_SHARED(shared);
    const auto scene = prep::load_scene(shared / "real_files" / "cube.glb");
    ASSERT_TRUE(scene) << test::error_of(scene);
    EXPECT_EQ(scene->meshes[0].face_count(), 12u);
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_EQ(scene->warnings[0], "cube.glb: a chunk's length is not a multiple of 4");
}

}  // namespace
