// `inspect --selftest`, and the counts of what exact arithmetic decided.
#include <gtest/gtest.h>

#include "command_runner.h"

namespace {

using test::run_command;

TEST(Selftest, PassesAndSaysWhatItFound) {
    const test::Ran ran = run_command({"inspect", "--selftest", "--json"});
    EXPECT_EQ(ran.exit_code, 0);
    const auto json = ran.json();
    ASSERT_TRUE(json.is_object());
    const auto& selftest = json["selftest"];
    EXPECT_EQ(selftest["ok"], true);
    EXPECT_GT(selftest["cases"].size(), 70u);
    for (const auto& c : selftest["cases"]) {
        EXPECT_LE(c["accurate_degrees"], 1e-9) << c;
        EXPECT_LE(c["rounded_degrees"], 5e-6) << c;
        EXPECT_LE(c["fast_degrees"], selftest["bounds_degrees"]["fast"]) << c;
    }
    EXPECT_EQ(selftest["checks"].size(), 7u);
    for (const auto& c : selftest["checks"]) {
        EXPECT_EQ(c["wrong"], 0) << c;
        EXPECT_GT(c["tried"], 1000) << c;
    }
}

TEST(Selftest, StandsInPlaceOfFiles) {
    EXPECT_EQ(run_command({"inspect"}).exit_code, 2);
    EXPECT_EQ(run_command({"inspect", "--selftest", "mesh.obj"}).exit_code, 2);
}

TEST(ExactDecisions, AreCountedByStage) {
    const test::TemporaryDirectory dir;
    test::write_text(dir / "cube.obj", test::cube_obj());
    const auto decided = [&](const char* angle) {
        const auto json =
            run_command({"prepare", (dir / "cube.obj").string(), "-o", (dir / "cube.glb").string(),
                         "--hard-angle", angle, "--json"})
                .json();
        for (const auto& stage : json["files"][0]["stages"])
            if (stage["stage"] == "hard edges") return stage["decided_exactly"].get<int>();
        return -1;
    };
    EXPECT_EQ(decided("90"), 12);  // every edge is exactly at the threshold
    EXPECT_EQ(decided("60"), 0);
}

}  // namespace
