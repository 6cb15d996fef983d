// Options do what they say wherever they are taken, and are refused where they would do nothing.
#include <gtest/gtest.h>

#include "command_runner.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::file_text;
using test::run_here;
using test::TempDir;
using test::write_text;

// What the reader met counts like what the check found.
TEST(OptionEffects, StrictInspectionFailsOnWarningsOfTheReader) {
    const TempDir dir;
    const std::string sound = (dir / "cube.obj").string(), odd = (dir / "odd.obj").string();
    write_text(sound, test::cube_obj());
    write_text(odd, "mtllib none.mtl\n" + test::cube_obj());
    for (const bool strict : {false, true}) {
        std::vector<std::string> words{"inspect", odd, sound, "--json"};
        if (strict) words.emplace_back("--strict");
        const test::Ran ran = run_here(words);
        const json document = ran.json();
        ASSERT_EQ(document["files"][0]["warnings"].size(), 1u) << ran.out;
        for (const json& finding : document["files"][0]["findings"])
            ASSERT_EQ(finding["severity"], "info");
        EXPECT_EQ(document["summary"]["with_warnings"], 1);
        EXPECT_EQ(ran.exit_code, strict ? 1 : 0);
    }
    EXPECT_EQ(run_here({"inspect", sound, "--strict"}).exit_code, 0);
}

TEST(OptionEffects, AListOfLaddersWritesNoFiles) {
    const TempDir dir;
    for (const char* const option : {"-o", "--csv", "--svg", "--png"}) {
        const std::string to = (dir / "out.html").string();
        const test::Ran ran = run_here({"cost", "--list", option, to});
        EXPECT_EQ(ran.exit_code, 2) << option;
        EXPECT_NE(ran.err.find("--list: measures nothing; it takes no -o"), std::string::npos)
            << ran.err;
        EXPECT_EQ(ran.out, "") << option;
    }
    EXPECT_EQ(run_here({"cost", "--list"}).exit_code, 0);
}

// What requires an extension that nobody knows is described all the same.
TEST(OptionEffects, InspectionTakesNoLeaveForExtensions) {
    const TempDir dir;
    const std::string file = (dir / "a.gltf").string();
    test::GltfText gltf;
    gltf.add({"a", {0, 0, 0, 1, 0, 0, 0, 1, 0}, {}, {}, {}, {0, 1, 2}, "", ""});
    write_text(file, gltf.text(R"("extensionsUsed":["VENDOR_new"],)"
                               R"("extensionsRequired":["VENDOR_new"])"));
    const std::string out = (dir / "a.glb").string();
    EXPECT_EQ(run_here({"prepare", file, "-o", out}).exit_code, 1);
    EXPECT_EQ(run_here({"prepare", file, "-o", out, "--allow-extension", "all"}).exit_code, 0);
    EXPECT_EQ(run_here({"inspect", file}).exit_code, 0);
    EXPECT_EQ(run_here({"inspect", file, "--allow-extension", "all"}).exit_code, 2);
}

}  // namespace
