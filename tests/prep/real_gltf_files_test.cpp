// glTF files as people have them (the manifest of ../shared/real_files says where from), each with
// what it once showed.
#include <gtest/gtest.h>

#include "compressed_gltf.h"
#include "mesh_files.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

namespace fs = std::filesystem;
using Json = test::GltfFile::Json;

// Normal maps of the clearcoat are all that some of its materials have: they call for tangents as
// others do, and nothing else does.
TEST(RealGltfFiles, ClearCoatTestGltf) {
    MESHPREP_REQUIRE_SHARED(shared);
    const fs::path in = shared / "real_files/ClearCoat/ClearCoatTest.gltf";
    if (!fs::exists(in)) GTEST_SKIP() << in << " is not there";
    const test::TempDir dir;
    test::save(in, dir / "out.glb", prep::Compression::keep);
    if (HasFatalFailure()) return;
    const test::GltfFile out(dir / "out.glb");
    EXPECT_EQ(out.fault(), "");
    std::size_t of_clearcoat = 0, others = 0;
    for (const Json& mesh : out.json["meshes"])
        for (const Json& primitive : mesh["primitives"]) {
            const Json& material = out.json["materials"][primitive["material"].get<std::size_t>()];
            const bool coat = material.value("extensions", Json::object())
                                  .value("KHR_materials_clearcoat", Json::object())
                                  .contains("clearcoatNormalTexture");
            const bool any = coat || material.contains("normalTexture");
            EXPECT_EQ(primitive["attributes"].contains("TANGENT"), any) << material["name"];
            of_clearcoat += coat && !material.contains("normalTexture");
            others += !any;
        }
    EXPECT_GT(of_clearcoat, 0u);
    EXPECT_GT(others, 0u);
}

// 0.69 MB of Draco came out as 14.9 MB; it has no normals, which are added.
TEST(RealGltfFiles, CaveGlb) {
    MESHPREP_REQUIRE_SHARED(shared);
    const fs::path in = shared / "real_files/cave.glb";
    if (!fs::exists(in)) GTEST_SKIP() << in << " is not there";
    const test::TempDir dir;
    test::save(in, dir / "out.glb", prep::Compression::keep);
    if (HasFatalFailure()) return;
    EXPECT_LE(fs::file_size(dir / "out.glb"),
              fs::file_size(in) * 11 / 10 + test::added_bytes(in, dir / "out.glb"));
    EXPECT_TRUE(test::by_edgebreaker(dir / "out.glb"));
}

}  // namespace
