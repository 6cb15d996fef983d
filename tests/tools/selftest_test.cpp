// `inspect --selftest`, and the counts of what exact arithmetic decided.
#include "meshprep/commands/selftest.h"

#include <gtest/gtest.h>

#include <map>

#include "command_runner.h"
#include "hard_cases.h"

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
    // Every case of a shape, unless exact arithmetic takes seconds for it.
    std::vector<std::string> judged, expected;
    for (const auto& c : selftest["cases"]) judged.push_back(c["case"].get<std::string>());
    std::uint64_t triangles = 0;
    std::vector<hard_cases::Case> cases = hard_cases::measured();
    for (const hard_cases::Case& c : hard_cases::odd()) cases.push_back(c);
    for (const hard_cases::Case& c : cases) {
        const bool shape = c.axis.find(':') == std::string::npos && c.mesh.face_count() > 0;
        if (shape && c.mesh.corner_count() <= 4000) expected.push_back(c.axis);
        triangles += c.mesh.corner_count() - 2 * c.mesh.face_count();
    }
    EXPECT_EQ(judged, expected);
    EXPECT_EQ(selftest["checks"].size(), 7u);
    std::map<std::string, std::uint64_t> tried;
    for (const auto& c : selftest["checks"]) tried[c["check"]] = c["tried"];
    // Seven angles, ten turns, two precisions, 143 pairs, at the threshold and below it.
    EXPECT_EQ(tried["dihedrals exactly at the threshold, turned and scaled"],
              7u * 10 * 2 * 143 * 2);
    EXPECT_EQ(tried["faces and vertices in another order"], 10u * 24 * 12 * 4);
    EXPECT_EQ(tried["pictures without NaN and infinity"], cases.size() * 64 * 64);
    EXPECT_EQ(tried["every triangle of a picture counted"], triangles);
    const std::uint64_t twice = tried["the same bytes on 1, 2 and 8 threads"];
    EXPECT_EQ(twice % 2, 0u);
    EXPECT_GE(twice / 2, 320u * 240 + 20'000);
    EXPECT_EQ(tried["the same bytes on every instruction set"] % (twice / 2), 0u);
    for (const auto& c : selftest["checks"]) {
        EXPECT_EQ(c["wrong"], 0) << c;
        EXPECT_GT(c["tried"], 1000) << c;
    }
}

TEST(Selftest, IsOnlyWellWhereAllIs) {
    meshprep::Selftest test;
    test.cases.resize(2);
    test.checks.resize(2);
    for (auto& c : test.cases) c.ok = true;
    for (auto& c : test.checks) c.tried = 10;
    EXPECT_TRUE(test.ok());
    test.cases[1].ok = false;
    EXPECT_FALSE(test.ok());
    test.cases[1].ok = true;
    test.checks[1].wrong = 1;
    EXPECT_FALSE(test.ok());
    test.checks[1].wrong = 0;
    test.checks[0].tried = 0;  // what was not tried proves nothing
    EXPECT_FALSE(test.ok());
}

TEST(Selftest, StandsInPlaceOfFiles) {
    EXPECT_EQ(run_command({"inspect"}).exit_code, 2);
    EXPECT_EQ(run_command({"inspect", "--selftest", "mesh.obj"}).exit_code, 2);
}

TEST(ExactDecisions, AreCountedByStage) {
    const test::TempDir dir;
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
