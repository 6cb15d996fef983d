// What `render` does where nothing is said, against the defaults that docs/rendering.md and
// docs/scene-format.md name.
#include <gtest/gtest.h>

#include <cmath>

#include "command_runner.h"
#include "prep/prepare.h"
#include "rast/render.h"
#include "shared_data.h"

namespace {

using test::file_text;
using test::run_here;
using test::TempDir;

// A slanted, textured floor and a ball that is lit from a side; a sheet seen from behind.
const char* const scene = R"({"meshprep": 1,
  "textures": {"c": {"file": "brick.png"}, "n": {"file": "n.png"}},
  "materials": {"ball": {"diffuse": 0.7, "normal_map": "n"}, "floor": {"diffuse_map": "c"}},
  "meshes": {"ball": {"shape": {"kind": "sphere", "segments": 12, "rings": 8}, "material": "ball"},
    "floor": {"shape": {"kind": "plane", "size": [8, 1, 8]}, "material": "floor"}},
  "nodes": [{"mesh": "ball", "translate": [0, 1, 0]}, {"mesh": "floor"},
    {"mesh": "floor", "translate": [0, 2, -1], "rotate": [-90, 0, 0], "scale": 0.1}]})";

TEST(RenderDefaults, AreThoseOfThePages) {
    const TempDir dir;
    const std::filesystem::path room = test::source_dir() / "samples/room";
    std::filesystem::copy_file(room / "brick_color.png", dir / "brick.png");
    std::filesystem::copy_file(room / "brick_normal.png", dir / "n.png");
    test::write_text(dir / "scene.json", scene);
    const auto draw = [&](std::vector<std::string> options) {
        std::vector<std::string> words = {"render",    (dir / "scene.json").string(),
                                          "-o",        (dir / "a.png").string(),
                                          "--size",    "40x30",
                                          "--buffers", "depth"};
        words.insert(words.end(), options.begin(), options.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return file_text(dir / "a.png") + file_text(dir / "a.depth.exr");
    };
    const std::string nothing = draw({});
    for (const auto& [option, value, another] :
         std::vector<std::array<const char*, 3>>{{"--shading", "normal-mapped", "phong"},
                                                 {"--filter", "sampler", "nearest"},
                                                 {"--filter", "trilinear", "ewa"},
                                                 {"--samples", "1", "2"},
                                                 {"--supersample", "1", "2"},
                                                 {"--coverage", "samples", "area"},
                                                 {"--cull", "by-material", "none"},
                                                 {"--background", "#000000", "#000010"},
                                                 {"--tone-map", "off", "reinhard"},
                                                 {"--exposure", "1", "1.1"},
                                                 {"--depth", "float", "fixed16"},
                                                 {"--camera", "30,20", "30,21"},
                                                 {"--camera", "30,20,1", "30,20,1.1"}}) {
        EXPECT_TRUE(draw({option, value}) == nothing) << option << " " << value;
        EXPECT_FALSE(draw({option, another}) == nothing) << option << " " << another;
    }
    for (const char* filter : {"anisotropic", "ewa"}) {
        const std::string plain = draw({"--filter", filter});
        EXPECT_TRUE(draw({"--filter", filter, "--max-anisotropy", "8"}) == plain);
        EXPECT_FALSE(draw({"--filter", filter, "--max-anisotropy", "2"}) == plain);
    }
    const std::string lit = draw({"--light", "30,40"});
    EXPECT_TRUE(draw({"--light", "30,40,1", "--ambient", "0.1"}) == lit);
    EXPECT_TRUE(draw({"--look-from", "3,4,9", "--up", "0,1,0"}) == draw({"--look-from", "3,4,9"}));
    for (const char* up : {"0,1e300,0", "0,1e-300,0"})  // a direction of any length
        EXPECT_TRUE(draw({"--look-from", "3,4,9", "--up", up}) == draw({"--look-from", "3,4,9"}));
}

TEST(RenderDefaults, PicturesAre1024By768AndBandsHold64Mebibytes) {
    const prep::PreparedScene nothing;
    const auto plain = rast::plan(nothing, {});
    ASSERT_TRUE(plain);
    EXPECT_EQ(plain->request.width, 1024u);
    EXPECT_EQ(plain->request.height, 768u);
    rast::RenderRequest large;
    large.width = large.height = 16384;
    const auto plan = rast::plan(nothing, large);
    ASSERT_TRUE(plan);
    // Colour and depth are 16 and 4 bytes a pixel; whichever are kept, a band fills most of 64 MiB.
    const double row = 16384, most = double(64u << 20);
    EXPECT_GE(double(plan->band_rows), most / (row * 20) - 1);
    EXPECT_LE(double(plan->band_rows), most / (row * 4));
    large.band_bytes = std::size_t(64) << 20;
    const auto given = rast::plan(nothing, large);
    ASSERT_TRUE(given);
    EXPECT_EQ(given->band_rows, plan->band_rows);
}

}  // namespace
