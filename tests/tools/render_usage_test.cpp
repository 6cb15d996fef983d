// What `render` refuses before it reads anything, and numbers a scene file cannot hold.
#include <gtest/gtest.h>

#include "command_runner.h"

namespace {

using test::run_here;
using test::TempDir;

TEST(RenderUsage, RefusesWaysUpThatAreNone) {
    const TempDir dir;
    test::write_text(dir / "cube.obj", test::cube_obj());
    const auto run = [&](std::vector<std::string> more) {
        std::vector<std::string> all = {
            "render", (dir / "cube.obj").string(), "-o", (dir / "a.png").string(), "--size", "8x8"};
        all.insert(all.end(), more.begin(), more.end());
        return run_here(all);
    };
    const test::Ran zero = run({"--look-from", "1,2,3", "--up", "0,0,0"});
    EXPECT_EQ(zero.exit_code, 2);
    EXPECT_NE(zero.err.find("--up"), std::string::npos) << zero.err;
    const test::Ran along = run({"--look-from", "0,5,0", "--look-at", "0,1,0", "--up", "0,-3,0"});
    EXPECT_EQ(along.exit_code, 2);
    EXPECT_NE(along.err.find("along the view"), std::string::npos) << along.err;
    const test::Ran over = run({"--look-from", "0.5,5,0.5", "--up", "0,2,0"});  // of the centre
    EXPECT_EQ(over.exit_code, 1);
    EXPECT_NE(over.err.find("to the scene's centre"), std::string::npos) << over.err;
    const test::Ran inside = run({"--look-from", "0.5,0.5,0.5", "--up", "0,2,0"});
    EXPECT_NE(inside.err.find("--look-from is the scene's centre"), std::string::npos)
        << inside.err;
    EXPECT_EQ(run({"--buffers", ""}).exit_code, 2);
    EXPECT_EQ(dir.names(), std::vector<std::string>{"cube.obj"});
    // Looking straight down without a wish is fine, as are other ways up.
    EXPECT_EQ(run({"--look-from", "0,5,0", "--look-at", "0,1,0"}).exit_code, 0);
    EXPECT_EQ(run({"--look-from", "0,5,0", "--look-at", "0,1,0", "--up", "1,1,0"}).exit_code, 0);
}

TEST(SceneNumbers, SayThatTheyAreTooLargeAndTheLimit) {
    const TempDir dir;
    for (const std::string number : {"1e39", "-1e39"}) {
        test::write_text(dir / "s.json",
                         R"({"meshprep": 1, "meshes": {"m": {"shape": {"kind": "sphere"}}},
                             "nodes": [{"mesh": "m", "translate": [)" +
                             number + ", 0, 0]}]}");
        const test::Ran ran =
            run_here({"render", (dir / "s.json").string(), "-o", (dir / "a.png").string()});
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_NE(ran.err.find("at most 1e+30 in size, found"), std::string::npos) << ran.err;
        EXPECT_NE(ran.err.find("too large"), std::string::npos) << ran.err;
    }
}

}  // namespace
