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

}  // namespace
