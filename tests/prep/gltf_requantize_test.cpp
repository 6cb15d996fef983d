// Files that were quantised are quantised again: nothing moves a second time.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "gltf_source.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/save.h"
#include "written_gltf.h"

namespace {

// Made unit anew, one in some of them would get another code, a step further from the first.
TEST(GltfRequantize, RoundedDirectionsKeepTheirCodes) {
    test::GltfSource d;
    std::vector<float> positions, normals;
    for (int i = 0; i < 5000; ++i) {  // a spiral from pole to pole (Saff and Kuijlaars 1997)
        const double z = 1 - (2 * i + 1) / 5000.0, angle = 2.399963229728653 * i;
        const double r = std::sqrt(1 - z * z);
        normals.insert(normals.end(),
                       {float(r * std::cos(angle)), float(r * std::sin(angle)), float(z)});
        positions.insert(positions.end(), {float(i), 0, 0});
    }
    d.mesh(
        {{{"attributes",
           {{"POSITION", d.add_positions(positions)}, {"NORMAL", d.add_floats("VEC3", normals)}}},
          {"mode", 0}}});
    const test::TempDir dir;
    d.write(dir / "0.glb");
    for (const int bits : {8, 12, 16}) {
        for (const auto& [from, to] : {std::pair("0.glb", "1.glb"), std::pair("1.glb", "2.glb")}) {
            auto scene = prep::load_scene(dir / from);
            ASSERT_TRUE(scene.has_value());
            prep::SaveOptions options;
            options.quantization = {0, bits, 0, 0};
            ASSERT_TRUE(prep::save_scene(test::untouched(*std::move(scene)), dir / to, options));
        }
        const test::GltfFile once(dir / "1.glb"), twice(dir / "2.glb");
        EXPECT_EQ(once.attribute(0, 0, "NORMAL"), twice.attribute(0, 0, "NORMAL")) << bits;
    }
}

}  // namespace
