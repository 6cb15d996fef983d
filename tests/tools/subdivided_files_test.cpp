// Subdivided glTF files as other programs see them: the official validator, and values by a reader
// of the tests' own.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "command_runner.h"
#include "gltf_oracle.h"
#include "npm_tools.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::run_here;
using test::TempDir;

json subdivided(const fs::path& in, const fs::path& out, std::vector<std::string> options) {
    options.insert(options.begin(), {"prepare", in.string(), "-o", out.string(), "--json"});
    const test::Ran ran = run_here(options);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    const json document = ran.json();
    return ran.exit_code == 0 ? document["files"][0] : json();
}

struct Sample {
    const char* file;  // below ../shared/corpus
    std::vector<std::string> options;
};
const std::vector<Sample> samples{
    {"CesiumMan.glb", {"--subdivide", "catmark:1"}},  // skin, animation
    {"CesiumMan.glb", {"--subdivide", "loop:1", "--max-influences", "8", "--compress", "draco"}},
    {"CesiumMan.glb", {"--subdivide", "catmark:1", "--quads", "--max-influences", "2"}},
    {"MorphStressTest.gltf", {"--subdivide", "catmark:1"}},  // morph targets
    {"MorphStressTest.gltf", {"--subdivide", "loop:2", "--tangents", "mikktspace"}},
    {"morph-stress-test.glb", {"--subdivide", "bilinear:2", "--control-points"}},
    {"heart_draco.glb", {"--subdivide", "loop:1"}},
    {"heart_draco.glb", {"--subdivide", "loop:1", "--compress", "meshopt"}},
    {"greySnapper_vertColor.glb", {"--subdivide", "loop:1"}},  // vertex colours
    {"frostAxe.glb", {"--subdivide", "catmark:1", "--quads"}},
    {"subdiv/catmark_car.obj", {"--subdivide", "catmark:1"}},
    {"subdiv/catmark_hole_test1.obj", {"--subdivide", "catmark:3"}},
    {"subdiv/catmark_nonman_edges.obj", {"--subdivide", "catmark:2"}},
    {"subdiv/catmark_fvar_bound4.obj", {"--subdivide", "catmark:2", "--face-varying", "all"}},
};

TEST(SubdividedFiles, TheFormatsValidatorFindsNoError) {
    MESHPREP_REQUIRE_SHARED(shared);
    MESHPREP_REQUIRE_NPM(validator, "gltf-validator");
    const TempDir dir;
    json list = json::array();
    const auto add = [&](const fs::path& in, const std::vector<std::string>& options) {
        const std::string number = std::to_string(list.size());
        const fs::path out = dir / ("out" + number + (list.size() % 2 ? ".gltf" : ".glb"));
        subdivided(in, out, options);
        list.push_back({{"name", in.filename().string() + " " + options[1]},
                        {"output", out.string()},
                        {"before", json::object()}});
    };
    for (const Sample& sample : samples) add(shared / "corpus" / sample.file, sample.options);
    // Scenes of several meshes, materials, maps, lights and cameras.
    add(test::source_dir() / "samples/shield/shield.gltf", {"--subdivide", "catmark:1"});
    add(test::source_dir() / "samples/room/room.gltf", {"--subdivide", "bilinear:1"});
    EXPECT_TRUE(test::validates(validator, list, dir / "list.json"))
        << "its complaints stand above";
}

// Triangles of a mesh of the input become 3 · 2 each at level 1 of catmark, 4 of loop.
TEST(SubdividedFiles, SkinWeightsSumToOneAndJointsAreTheSkins) {
    MESHPREP_REQUIRE_SHARED(shared);
    const TempDir dir;
    const test::GltfFile before(shared / "corpus/CesiumMan.glb");
    const std::size_t joints = before.json["skins"][0]["joints"].size();
    const std::size_t triangles = before.triangles(0, 0).size() / 3;
    for (const int most : {0, 1, 2, 6}) {
        SCOPED_TRACE("at most " + std::to_string(most));
        std::vector<std::string> options{"--subdivide", "catmark:1"};
        if (most > 0) options.insert(options.end(), {"--max-influences", std::to_string(most)});
        const json file = subdivided(shared / "corpus/CesiumMan.glb", dir / "out.glb", options);
        const test::GltfFile after(dir / "out.glb");
        EXPECT_EQ(after.fault(), "");
        EXPECT_EQ(after.triangles(0, 0).size() / 3, 6 * triangles);
        EXPECT_EQ(after.json["animations"].size(), before.json["animations"].size());
        EXPECT_EQ(after.json["skins"][0]["joints"].size(), joints);
        const bool second = after.primitive(0, 0)["attributes"].contains("WEIGHTS_1");
        EXPECT_EQ(second, most == 6);
        std::vector<test::GltfValues> weights, indices;
        for (int set = 0; set <= int(second); ++set) {
            weights.push_back(after.attribute(0, 0, "WEIGHTS_" + std::to_string(set)));
            indices.push_back(after.attribute(0, 0, "JOINTS_" + std::to_string(set)));
        }
        const std::size_t limit = most == 0 ? 4 : std::size_t(most);
        std::size_t largest = 0;
        for (std::size_t v = 0; v < weights[0].count(); ++v) {
            double sum = 0;
            std::set<double> used;
            for (std::size_t set = 0; set < weights.size(); ++set)
                for (std::size_t k = 0; k < 4; ++k) {
                    const double w = weights[set].at(v)[k];
                    ASSERT_GE(w, 0);
                    sum += w;
                    if (w == 0) continue;
                    ASSERT_LT(indices[set].at(v)[k], double(joints));
                    ASSERT_TRUE(used.insert(indices[set].at(v)[k]).second) << "vertex " << v;
                }
            ASSERT_NEAR(sum, 1, 1e-6) << "vertex " << v;
            largest = std::max(largest, used.size());
        }
        EXPECT_LE(largest, limit);
        EXPECT_GE(largest, std::min<std::size_t>(limit, 4));
        bool told = false;
        for (const json& finding : file["findings"]) told |= finding["kind"] == "dropped-weight";
        EXPECT_TRUE(told || most == 6);
    }
}

TEST(SubdividedFiles, WrittenNormalsAreUnit) {
    MESHPREP_REQUIRE_SHARED(shared);
    const TempDir dir;
    for (const Sample& sample : samples) {
        if (sample.options.back() == "draco" || sample.options.back() == "meshopt") continue;
        SCOPED_TRACE(sample.file);
        subdivided(shared / "corpus" / sample.file, dir / "out.glb", sample.options);
        const test::GltfFile file(dir / "out.glb");
        EXPECT_EQ(file.fault(), "");
        for (std::size_t m = 0; m < file.json["meshes"].size(); ++m)
            for (std::size_t p = 0; p < file.json["meshes"][m]["primitives"].size(); ++p) {
                const test::GltfValues n = file.attribute(m, p, "NORMAL");
                for (std::size_t v = 0; v < n.count(); ++v)
                    ASSERT_NEAR(
                        std::hypot(n.values[3 * v], n.values[3 * v + 1], n.values[3 * v + 2]), 1,
                        1e-6)
                        << "vertex " << v;
            }
    }
}

}  // namespace
