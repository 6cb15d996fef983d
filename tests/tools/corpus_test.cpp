// Every mesh file of the shared corpus through `meshprep prepare` to GLB (glTF files also to
// .gltf), judged by the official validator: no errors, and as many of everything as the input had.
// What they hold is compared by prep/gltf_corpus_test and prep/written_corpus_test.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>

#include "command_runner.h"
#include "gltf_oracle.h"
#include "npm_tools.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

namespace fs = std::filesystem;

std::string lower_ending(const fs::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending;
}

bool is_gltf(const fs::path& path) {
    return lower_ending(path) == ".glb" || lower_ending(path) == ".gltf";
}

std::vector<fs::path> mesh_files(const fs::path& corpus) {
    const std::set<std::string> endings{".obj", ".ply", ".stl", ".off", ".glb", ".gltf"};
    std::vector<fs::path> out;
    for (auto it = fs::recursive_directory_iterator(corpus); it != fs::end(it); ++it) {
        if (it->is_directory() && it->path().filename() == "gltf-validator")
            it.disable_recursion_pending();
        else if (endings.contains(lower_ending(it->path())))
            out.push_back(it->path());
    }
    std::sort(out.begin(), out.end());
    return out;
}

// `list`: {"name", "input", "output", "before"} of each file, as validate_gltf.mjs reads it.
void judge(const fs::path& validator, const test::TempDir& dir, const nlohmann::json& list) {
    EXPECT_TRUE(test::validates(validator, list, dir / "list.json"))
        << "the judge's complaints stand above";
}

TEST(Corpus, EveryMeshBecomesValidGltfAndNothingIsLost) {
    MESHPREP_REQUIRE_SHARED(shared);
    MESHPREP_REQUIRE_NPM(validator, "gltf-validator");
    const test::TempDir dir;
    const fs::path corpus = shared / "corpus";
    nlohmann::json list = nlohmann::json::array();
    for (const fs::path& file : mesh_files(corpus)) {
        SCOPED_TRACE(file.string());
        for (const char* ending : {".glb", ".gltf"}) {
            if (!is_gltf(file) && std::string(ending) == ".gltf") continue;
            const std::string name = fs::relative(file, corpus).generic_string();
            std::string flat = name + ending;
            std::replace(flat.begin(), flat.end(), '/', '-');
            const test::Ran ran = test::run_command(
                {"prepare", file.string(), "-o", (dir / flat).string(), "--json"});
            ASSERT_EQ(ran.exit_code, 0) << ran.err;
            const nlohmann::json stated = ran.json().at("files").at(0).at("before");
            // Input that is glTF is counted by the judge itself.
            const nlohmann::json before =
                is_gltf(file) ? nlohmann::json()
                              : nlohmann::json{{"vertices", stated.at("vertices")},
                                               {"triangles", stated.at("triangles")},
                                               {"materials", stated.at("materials")}};
            list.push_back({{"name", name + " → " + (ending + 1)},
                            {"input", file.string()},
                            {"output", (dir / flat).string()},
                            {"before", before}});
        }
    }
    EXPECT_GE(list.size(), 70u);
    judge(validator, dir, list);
}

// The validator's own test files: what is invalid is refused with its place or carried, never a
// crash; what the validator finds no error in is converted to a file it finds no error in.
TEST(Corpus, TheValidatorsFilesAreRefusedWithTheirPlaceOrConverted) {
    MESHPREP_REQUIRE_SHARED(shared);
    MESHPREP_REQUIRE_NPM(validator, "gltf-validator");
    const test::TempDir dir;
    const fs::path root = shared / "corpus" / "gltf-validator";
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(root))
        if (is_gltf(entry.path())) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    EXPECT_GE(files.size(), 130u);
    nlohmann::json list = nlohmann::json::array();
    std::size_t refused = 0, converted = 0;
    for (const fs::path& file : files) {
        const std::string name = fs::relative(file, root).generic_string();
        SCOPED_TRACE(name);
        std::string flat = name + ".glb";
        std::replace(flat.begin(), flat.end(), '/', '-');
        const test::Ran ran =
            test::run_command({"prepare", file.string(), "-o", (dir / flat).string()});
        const auto report =
            nlohmann::json::parse(test::file_text(file.string() + ".report.json"), nullptr, false);
        ASSERT_TRUE(report.is_object());
        const bool valid = report.at("issues").at("numErrors") == 0;
        if (ran.exit_code == 1) {
            ++refused;
            // Valid, but it asks for a reader of glTF 2.1.
            const bool too_new = name == "asset/min_version_valid.gltf";
            EXPECT_TRUE(!valid || too_new) << "refused without cause: " << ran.err;
            EXPECT_NE(ran.err.find(file.filename().string()), std::string::npos) << ran.err;
            EXPECT_FALSE(fs::exists(dir / flat)) << "half an output";
            continue;
        }
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        ++converted;
        if (!valid) continue;
        list.push_back(
            {{"name", name}, {"input", file.string()}, {"output", (dir / flat).string()}});
    }
    std::cout << files.size() << " files: " << refused << " refused, " << converted
              << " converted, of these " << list.size() << " without an error of the validator\n";
    judge(validator, dir, list);
}

// The largest error of each row of the report, by the files' own numbers: positions and what
// targets move, where the node with the mesh puts them, over the mesh's diagonal; degrees; UVs.
struct ReadBack {
    double positions = 0, normals = 0, tangents = 0, uvs = 0;
    std::size_t targets = 0, skinned = 0;
};

double degrees_apart(const std::vector<double>& x, const std::vector<double>& y) {
    const double sine =
        std::hypot(x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]);
    return std::atan2(sine, x[0] * y[0] + x[1] * y[1] + x[2] * y[2]) * 180 / M_PI;
}

ReadBack read_back(const test::GltfFile& plain, const test::GltfFile& rounded) {
    using Numbers = std::vector<double>;
    const auto length = [](const Numbers& a) { return std::hypot(a[0], a[1], a[2]); };
    const auto apart = [&](const Numbers& a, const Numbers& b) {
        return length({a[0] - b[0], a[1] - b[1], a[2] - b[2]});
    };
    ReadBack out;
    for (std::size_t m = 0; m < plain.json["meshes"].size(); ++m) {
        Numbers scale{1, 1, 1}, origin{0, 0, 0}, low(3, 1e300), high(3, -1e300);
        for (const auto& node : rounded.json["nodes"])
            if (node.value("mesh", -1) == int(m)) {
                scale = node.value("scale", scale);
                origin = node.value("translation", origin);
            }
        const std::size_t primitives = plain.json["meshes"][m]["primitives"].size();
        for (std::size_t p = 0; p < primitives; ++p) {
            const auto points = plain.attribute(m, p, "POSITION");
            for (std::size_t v = 0; v < points.count(); ++v)
                for (std::size_t k = 0; k < 3; ++k) {
                    low[k] = std::min(low[k], points.at(v)[k]);
                    high[k] = std::max(high[k], points.at(v)[k]);
                }
        }
        const double diagonal = apart(low, high);
        const auto moved = [&](const test::GltfValues& a, const test::GltfValues& b,
                               const Numbers& from) {
            ASSERT_EQ(a.count(), b.count());
            for (std::size_t v = 0; v < a.count(); ++v) {
                Numbers at = b.at(v);
                for (std::size_t k = 0; k < 3; ++k) at[k] = scale[k] * at[k] + from[k];
                out.positions = std::max(out.positions, apart(at, a.at(v)) / diagonal);
            }
        };
        for (std::size_t p = 0; p < primitives; ++p) {
            const auto& one = plain.primitive(m, p);
            EXPECT_EQ(plain.indices(m, p), rounded.indices(m, p));
            for (const auto& [name, accessor] : one["attributes"].items()) {
                const auto a = plain.attribute(m, p, name), b = rounded.attribute(m, p, name);
                if (name == "POSITION") {
                    moved(a, b, origin);
                } else if (name == "NORMAL" || name == "TANGENT") {
                    double& worst = name == "NORMAL" ? out.normals : out.tangents;
                    for (std::size_t v = 0; v < a.count(); ++v)
                        worst = std::max(worst, degrees_apart(a.at(v), b.at(v)));
                } else if (name.starts_with("TEXCOORD")) {
                    for (std::size_t i = 0; i < a.values.size(); ++i)
                        out.uvs = std::max(out.uvs, std::abs(a.values[i] - b.values[i]));
                } else {
                    EXPECT_EQ(a, b) << name;  // joints and weights, colours
                    out.skinned += name == "JOINTS_0";
                }
            }
            for (std::size_t t = 0; t < one.value("targets", nlohmann::json::array()).size(); ++t)
                for (const auto& [name, accessor] : one["targets"][t].items()) {
                    ++out.targets;
                    const auto a = plain.target(m, p, t, name), b = rounded.target(m, p, t, name);
                    if (name == "POSITION")
                        moved(a, b, {0, 0, 0});
                    else
                        EXPECT_EQ(a, b) << name;
                }
        }
    }
    return out;
}

// Files with skins, morph targets or both: the validator has nothing to say, skins, targets and
// what moves them are as they were, and the errors are those that the report tells.
TEST(Corpus, QuantizedFilesAreValidWithMorphsAndSkinsAndTheErrorsTold) {
    MESHPREP_REQUIRE_SHARED(shared);
    MESHPREP_REQUIRE_NPM(validator, "gltf-validator");
    const test::TempDir dir;
    nlohmann::json list = nlohmann::json::array();
    std::size_t targets = 0, skinned = 0, rows = 0;
    for (const char* const name : {"CesiumMan.glb", "MorphStressTest.gltf", "morph-stress-test.glb",
                                   "clothFolds.glb", "DamagedHelmet/DamagedHelmet.gltf"})
        for (const char* const bits : {"auto", "positions=11,normals=9,tangents=9,uvs=12"})
            for (const char* const ending : {".glb", ".gltf"}) {
                SCOPED_TRACE(std::string(name) + " " + bits);
                const fs::path file = shared / "corpus" / name;
                const fs::path plain = dir / ("plain" + std::string(ending));
                const fs::path rounded = dir / (std::to_string(list.size()) + ending);
                ASSERT_EQ(
                    test::run_command({"prepare", file.string(), "-o", plain.string()}).exit_code,
                    0);
                const test::Ran ran =
                    test::run_command({"prepare", file.string(), "-o", rounded.string(),
                                       "--quantize", bits, "--json"});
                ASSERT_EQ(ran.exit_code, 0) << ran.err;
                const test::GltfFile before(plain), after(rounded);
                EXPECT_EQ(after.fault(), "");
                const ReadBack own = read_back(before, after);
                targets += own.targets;
                skinned += own.skinned;
                const auto told = ran.json()["files"][0]["quantized"];
                const std::pair<int, double> measured[] = {
                    {0, own.positions}, {1, own.normals}, {2, own.tangents}, {3, own.uvs}};
                for (const auto& [row, error] : measured) {
                    SCOPED_TRACE(told[row]["attribute"]);
                    if (told[row]["values"] == 0) {  // none there, or UVs beyond 0 … 1
                        EXPECT_EQ(error, 0);
                        continue;
                    }
                    ++rows;
                    EXPECT_GT(error, 0);
                    // Scales and translations of nodes are floats in the file, or nearly.
                    EXPECT_NEAR(told[row]["largest"].get<double>() / error, 1, 1e-3);
                }
                nlohmann::json counts;
                const auto& json = before.json;
                std::size_t channels = 0, all_targets = 0;
                for (const auto& a : json.value("animations", nlohmann::json::array()))
                    channels += a["channels"].size();
                for (const auto& mesh : json["meshes"])
                    for (const auto& p : mesh["primitives"])
                        all_targets += p.value("targets", nlohmann::json::array()).size();
                for (const char* const kind : {"skins", "animations", "meshes", "textures"})
                    counts[kind] = json.value(kind, nlohmann::json::array()).size();
                counts["channels"] = channels;
                counts["targets"] = all_targets;
                list.push_back({{"name", std::string(name) + " " + bits + " " + ending},
                                {"output", rounded.string()},
                                {"before", counts}});
            }
    EXPECT_GE(targets, 64u);
    EXPECT_GE(rows, 50u);
    EXPECT_GE(skinned, 4u);
    judge(validator, dir, list);
}

}  // namespace
