// Compressed glTF files as people have them, and our own: they come out as small as they came.
#include <gtest/gtest.h>

#include "compressed_gltf.h"
#include "mesh_files.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;
using prep::Compression;
using test::added_bytes;
using test::by_edgebreaker;
using test::bytes_without_pictures;
using test::save;

// Files as people have them: one has triangles that rounding left without area, and gets normals.
TEST(CompressedFiles, RealFilesComeOutAsSmallBesideTheirNormals) {
    MESHPREP_REQUIRE_SHARED(shared);
    const test::TempDir dir;
    std::size_t found = 0;
    for (const char* name :
         {"real_files/cave.glb", "corpus/heart_draco.glb", "real_files/jet-fighter.glb"}) {
        const fs::path in = shared / name, out = dir / "out.glb";
        if (!fs::exists(in)) continue;
        ++found;
        save(in, out, Compression::keep);
        if (HasFatalFailure()) return;
        EXPECT_LE(bytes_without_pictures(out),
                  bytes_without_pictures(in) * 11 / 10 + added_bytes(in, out))
            << name << ": " << bytes_without_pictures(in);
        EXPECT_TRUE(by_edgebreaker(out)) << name;
        const auto before = prep::load_scene(in), after = prep::load_scene(out);
        ASSERT_TRUE(before && after);
        EXPECT_EQ(before->meshes[0].face_count(), after->meshes[0].face_count()) << name;
    }
    if (found == 0) GTEST_SKIP() << "the shared test data has no compressed files";
}

// What we compressed ourselves, with tangents computed everywhere: nothing stays as it lies.
TEST(CompressedFiles, OurOwnFilesStayAsSmallBesideTheirTangents) {
    MESHPREP_REQUIRE_SHARED(shared);
    const test::TempDir dir;
    std::size_t compared = 0;
    for (const char* name : {"CesiumMan.glb", "frostAxe.glb", "morph-stress-test.glb",
                             "NormalTangentTest.glb", "greySnapper_vertColor.glb"}) {
        if (!fs::exists(shared / "corpus" / name)) continue;
        for (const Compression method : {Compression::draco, Compression::meshopt}) {
            save(shared / "corpus" / name, dir / "in.glb", method);
            prep::PrepareOptions options;
            options.request.tangents = prep::Request::Level::always;
            save(dir / "in.glb", dir / "out.glb", Compression::keep, options);
            if (HasFatalFailure()) return;
            EXPECT_LE(bytes_without_pictures(dir / "out.glb"),
                      bytes_without_pictures(dir / "in.glb") * 11 / 10 +
                          added_bytes(dir / "in.glb", dir / "out.glb"))
                << name << ": " << bytes_without_pictures(dir / "in.glb");
            const test::GltfFile a(dir / "in.glb"), b(dir / "out.glb");
            EXPECT_EQ(a.json["extensionsRequired"], b.json["extensionsRequired"]) << name;
            ++compared;
        }
    }
    if (compared == 0) GTEST_SKIP() << "the shared test data has none of these files";
}

}  // namespace
