// Morph targets in files that are written: where they lead stays, and what is lost of them is told.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gltf_source.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "written_gltf.h"

namespace {

constexpr double height = 0.4;

// A square that is one point at rest: its target makes it grow.
test::GltfSource growing_square() {
    test::GltfSource d;
    const auto h = float(height);
    const test::GltfSource::Json targets = {
        {{"POSITION", d.add_positions({0, 0, 0, h, 0, 0, h, h, 0, 0, h, 0})}}};
    d.mesh({{{"attributes", {{"POSITION", d.add_positions({1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3})}}},
             {"indices", d.add("SCALAR", std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})},
             {"targets", targets}}});
    return d;
}

TEST(GltfTargets, WhatGrowsFromOnePointGrowsAsFarWhenItIsQuantised) {
    const test::TempDir dir;
    growing_square().write(dir / "a.glb");
    for (const int bits : {8, 14, 16}) {
        prep::SaveOptions options;
        options.quantization.positions = bits;
        prep::QuantizationReport report;
        options.quantized = &report;
        auto scene = prep::load_scene(dir / "a.glb");
        ASSERT_TRUE(scene);
        ASSERT_TRUE(prep::save_scene(test::untouched(*std::move(scene)), dir / "b.glb", options));
        const test::GltfFile before(dir / "a.glb"), after(dir / "b.glb");
        EXPECT_EQ(after.fault(), "");
        double scale = 0;
        for (const auto& node : after.json["nodes"])
            if (node.contains("mesh")) scale = node["scale"][0].get<double>();
        double worst = 0;
        for (std::size_t v = 0; v < 4; ++v) {
            const auto a = before.target(0, 0, 0, "POSITION").at(v),
                       b = after.target(0, 0, 0, "POSITION").at(v);
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k) sum += std::pow(scale * b[k] - a[k], 2);
            worst = std::max(worst, std::sqrt(sum));
        }
        EXPECT_LE(worst, height / (std::exp2(bits) - 1) * 0.867 + 1e-7) << bits;
        // Of what has no size of its own, errors are told as parts of what it grows by.
        EXPECT_NEAR(report.rows[0].largest, worst / height, 1e-6) << bits;
        EXPECT_EQ(report.rows[0].values, 8u);
    }
}

TEST(GltfTargets, WhatSubdividedMeshesLoseOfThemIsTold) {
    test::GltfSource d = growing_square();
    auto& primitive = d.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["POSITION"] = d.add_positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    const std::size_t uvs = d.add_floats("VEC2", {0, 0, 1, 0, 1, 1, 0, 1});
    primitive["attributes"]["TEXCOORD_0"] = uvs;
    for (const bool with_uvs : {true, false}) {
        if (with_uvs)
            primitive["targets"][0]["TEXCOORD_0"] = uvs;
        else
            primitive["targets"][0].erase("TEXCOORD_0");
        const test::TempDir dir;
        d.write(dir / "a.glb");
        auto scene = prep::load_scene(dir / "a.glb");
        ASSERT_TRUE(scene);
        prep::PrepareOptions options;
        options.subdivide = true;
        options.subdivision.level = 1;
        auto prepared = prep::prepare(*std::move(scene), options);
        ASSERT_TRUE(prepared) << prep::to_string(prepared.error());
        const auto notes = prep::save_scene(*prepared, dir / "b.glb");
        ASSERT_TRUE(notes) << prep::to_string(notes.error());
        EXPECT_EQ(std::count(notes->begin(), notes->end(),
                             "left out of subdivided meshes: what morph targets change of "
                             "TEXCOORD_0"),
                  with_uvs ? 1 : 0);
    }
}

}  // namespace
