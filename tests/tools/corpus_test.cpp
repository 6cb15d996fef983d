// Every mesh file of the shared corpus through `meshprep prepare` to GLB (glTF files also to
// .gltf), judged by the official validator: no errors, and as many of everything as the input had.
// What they hold is compared by prep/gltf_corpus_test and prep/written_corpus_test.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <set>

#include "command_runner.h"
#include "gltf_oracle.h"
#include "npm_tools.h"
#include "shared_data.h"

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
void judge(const fs::path& validator, const test::TemporaryDirectory& dir,
           const nlohmann::json& list) {
    EXPECT_TRUE(test::validates(validator, list, dir / "list.json"))
        << "the judge's complaints stand above";
}

TEST(Corpus, EveryMeshBecomesValidGltfAndNothingIsLost) {
    MESHPREP_REQUIRE_SHARED(shared);
    MESHPREP_REQUIRE_NPM(validator, "gltf-validator");
    const test::TemporaryDirectory dir;
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
    const test::TemporaryDirectory dir;
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
            nlohmann::json::parse(test::read_text(file.string() + ".report.json"), nullptr, false);
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

}  // namespace
