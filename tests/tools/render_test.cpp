// `meshprep render` from outside.
#include <gtest/gtest.h>

#include <set>

#include "command_runner.h"
#include "shared_data.h"

namespace {

using test::read_text;
using test::run_command;
using test::TemporaryDirectory;
using test::write_text;

// A textured plane seen at a slant, so that filters differ.
std::string slanted_floor(const std::string& picture) {
    return R"({"meshprep": 1,
  "textures": {"brick": {"file": "brick.png"}},
  "materials": {"floor": {"diffuse_map": "brick"}},
  "meshes": {"floor": {"shape": {"kind": "plane", "size": [8, 1, 8]}, "material": "floor"}},
  "camera": {"orbit": {"elevation": 8}},
  "picture": )" +
           picture + "}";
}

TEST(Render, SceneFilesTakeEveryFilterWordOfTheCommandLine) {
    const TemporaryDirectory dir;
    std::filesystem::copy_file(test::source_dir() / "samples/room/brick_color.png",
                               dir / "brick.png");
    write_text(dir / "plain.json", slanted_floor(R"({"size": [96, 64]})"));
    std::set<std::string> pictures;
    for (const std::string word :
         {"nearest", "bilinear", "trilinear", "bicubic", "anisotropic", "ripmap", "ewa"}) {
        SCOPED_TRACE(word);
        write_text(dir / "scene.json",
                   slanted_floor(R"({"size": [96, 64], "filter": ")" + word + "\"}"));
        const test::Ran by_file = run_command({"render", (dir / "scene.json").string(), "-o",
                                               (dir / "by_file.png").string(), "--quiet"});
        ASSERT_EQ(by_file.exit_code, 0) << by_file.err;
        const test::Ran by_option =
            run_command({"render", (dir / "plain.json").string(), "-o",
                         (dir / "by_option.png").string(), "--filter", word, "--quiet"});
        ASSERT_EQ(by_option.exit_code, 0) << by_option.err;
        const std::string bytes = read_text(dir / "by_file.png");
        EXPECT_EQ(bytes, read_text(dir / "by_option.png"));
        pictures.insert(bytes);
    }
    EXPECT_EQ(pictures.size(), 7u);
}

}  // namespace
