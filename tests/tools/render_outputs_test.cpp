// What `meshprep render` writes: buffers, crops, cameras, sequences, bands.
#include "meshprep/files/render_outputs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "command_runner.h"
#include "prep/image.h"

namespace {

using test::file_text;
using test::run_here;
using test::TempDir;
using test::write_text;

prep::Image load(const std::filesystem::path& path,
                 prep::ImageChannels channels = prep::ImageChannels::color) {
    auto image = prep::load_image(path, channels);
    EXPECT_TRUE(image) << to_string(image.error());
    return image ? *std::move(image) : prep::Image{};
}

// Runs `render` and expects it to work.
test::Ran render(const std::filesystem::path& in, const std::filesystem::path& out,
                 std::vector<std::string> more) {
    std::vector<std::string> all = {"render", in.string(), "-o", out.string(), "--json"};
    all.insert(all.end(), more.begin(), more.end());
    test::Ran ran = run_here(all);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return ran;
}

// A square from −1 to 1 in the plane z = 0, facing +z, with the whole UV square.
constexpr const char* square =
    "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "f 1/1 2/2 3/3 4/4\n";

TEST(RenderBuffers, HoldWhatIsAtEachPixel) {
    const TempDir dir;
    write_text(dir / "square.obj", square);
    // Half the picture's height is 2 units: the square fills the middle 16 x 16 of 32 x 32 pixels,
    // seen from a distance of 5.
    const std::vector<std::string> view = {"--size",    "32x32", "--look-from", "0,0,5",
                                           "--look-at", "0,0,0", "--ortho",     "4"};
    std::vector<std::string> all = view;
    all.insert(all.end(), {"--buffers", "all"});
    const auto ran = render(dir / "square.obj", dir / "a.png", all);
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"a.barycentric.exr", "a.depth.exr", "a.id.exr",
                                                     "a.normal.exr", "a.png", "a.position.exr",
                                                     "a.uv.exr", "square.obj"}));
    EXPECT_EQ(ran.json()["outputs"].size(), 7u);
    const prep::Image depth = load(dir / "a.depth.exr"),
                      id = load(dir / "a.id.exr", prep::ImageChannels::all),
                      normal = load(dir / "a.normal.exr"), uv = load(dir / "a.uv.exr"),
                      barycentric = load(dir / "a.barycentric.exr"),
                      position = load(dir / "a.position.exr");
    ASSERT_EQ(depth.channels, 2u);
    ASSERT_EQ(id.channels, 2u);
    ASSERT_EQ(normal.channels, 3u);
    ASSERT_EQ(uv.channels, 2u);
    ASSERT_EQ(barycentric.channels, 3u);
    ASSERT_EQ(position.channels, 3u);
    int triangles[2] = {0, 0};
    for (std::uint32_t y = 0; y < 32; ++y)
        for (std::uint32_t x = 0; x < 32; ++x) {
            SCOPED_TRACE(std::to_string(x) + " " + std::to_string(y));
            const bool inside = x >= 8 && x < 24 && y >= 8 && y < 24;
            // EXR keeps its channels by name: "Z" before "depth", "instance" before "triangle".
            if (!inside) {
                EXPECT_TRUE(std::isinf(depth.at(x, y)[0]));
                EXPECT_EQ(depth.at(x, y)[1], 0.0f);
                EXPECT_EQ(id.integers[2 * (32 * y + x)], 0xffffffffu);
                EXPECT_EQ(id.integers[2 * (32 * y + x) + 1], 0xffffffffu);
                EXPECT_EQ(normal.at(x, y)[2], 0.0f);
                EXPECT_EQ(position.at(x, y)[0], 0.0f);
                continue;
            }
            EXPECT_NEAR(depth.at(x, y)[0], 5, 1e-5);
            EXPECT_GT(depth.at(x, y)[1], 0.0f);
            EXPECT_EQ(id.integers[2 * (32 * y + x)], 0u);
            const std::uint32_t triangle = id.integers[2 * (32 * y + x) + 1];
            EXPECT_LT(triangle, 2u);
            ++triangles[triangle < 2 ? triangle : 0];
            EXPECT_EQ(normal.at(x, y)[2], 1.0f);
            const double wx = (x + 0.5) / 8 - 2, wy = 2 - (y + 0.5) / 8;
            EXPECT_NEAR(position.at(x, y)[0], wx, 1e-6);
            EXPECT_NEAR(position.at(x, y)[1], wy, 1e-6);
            EXPECT_NEAR(position.at(x, y)[2], 0, 1e-6);
            EXPECT_NEAR(uv.at(x, y)[0], (wx + 1) / 2, 1e-6);
            // glTF's origin: v grows downwards.
            EXPECT_NEAR(uv.at(x, y)[1], (1 - wy) / 2, 1e-6);
            const float* b = barycentric.at(x, y);
            EXPECT_NEAR(b[0] + b[1] + b[2], 1, 1e-6);
        }
    // Halves of 16 x 16 pixels, the diagonal's 16 to either of them.
    EXPECT_EQ(triangles[0] + triangles[1], 256);
    EXPECT_NEAR(triangles[0], 128, 8);

    // All of them in one file: the same values.
    std::vector<std::string> one = view;
    one.insert(one.end(), {"--buffers", "uv,position", "--buffer-file", (dir / "b.exr").string()});
    render(dir / "square.obj", dir / "b.png", one);
    const prep::Image both = load(dir / "b.exr", prep::ImageChannels::all);
    EXPECT_EQ(both.channel_names, (std::vector<std::string>{"P.X", "P.Y", "P.Z", "UV.U", "UV.V"}));
    ASSERT_EQ(both.channels, 5u);
    for (std::uint32_t y = 0; y < 32; ++y)
        for (std::uint32_t x = 0; x < 32; ++x) {
            for (int k = 0; k < 3; ++k) ASSERT_EQ(both.at(x, y)[k], position.at(x, y)[k]);
            for (int k = 0; k < 2; ++k) ASSERT_EQ(both.at(x, y)[3 + k], uv.at(x, y)[k]);
        }
}

TEST(RenderBuffers, PerspectiveDistanceIsAlongTheView) {
    const TempDir dir;
    write_text(dir / "square.obj", square);
    render(dir / "square.obj", dir / "a.png",
           {"--size", "33x33", "--look-from", "0,0,3", "--look-at", "0,0,0", "--fov", "30",
            "--buffers", "depth,position"});
    const prep::Image depth = load(dir / "a.depth.exr"), position = load(dir / "a.position.exr");
    for (std::uint32_t y = 0; y < 33; ++y)
        for (std::uint32_t x = 0; x < 33; ++x) {
            EXPECT_NEAR(depth.at(x, y)[0], 3, 3e-6) << x << " " << y;
            const double t = 3 * std::tan(15 * 3.14159265358979 / 180);
            // Corners lie on the grid of 1/256 pixels: half a step of it, 1.6/33 wide, is 1e-4.
            EXPECT_NEAR(position.at(x, y)[0], ((x + 0.5) / 16.5 - 1) * t, 1e-4);
        }
}

TEST(RenderBuffers, UnknownOnesAreUsageErrors) {
    const TempDir dir;
    write_text(dir / "square.obj", square);
    const std::string in = (dir / "square.obj").string(), out = (dir / "a.png").string();
    for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
             {"--buffers", "depth,colour"},
             {"--buffer-file", "x.exr"},
             {"--crop", "1,2,3"},
             {"--crop", "0,0,0x4"},
             {"--crop", "30,0,4x4", "--size", "32x32"},
             {"--look-at", "0,0,0"},
             {"--look-from", "1,2"},
             {"--look-from", "1,2,3", "--camera", "1,2"},
             {"--look-from", "1,2,3", "--look-at", "1,2,3"},
             {"--buffers", "depth", "--buffer-file", "x.png"},
             {"--fov", "180"},
             {"--fov", "nan"},
             {"--ortho", "0"},
             {"--ortho", "3", "--fov", "40"},
             {"--turntable", "0"},
             {"--max-anisotropy", "17"},
             {"--turntable", "4", "--buffers", "uv", "--buffer-file", "x.exr"},
             {"--band-memory", "0"}}) {
        std::vector<std::string> all = {"render", in, "-o", out};
        all.insert(all.end(), more.begin(), more.end());
        EXPECT_EQ(run_here(all).exit_code, 2) << more[0] << " " << more[1];
    }
    EXPECT_EQ(run_here({"render", in, "-o", (dir / "a%03d.png").string()}).exit_code, 2);
    EXPECT_EQ(dir.names(), std::vector<std::string>{"square.obj"});
}

TEST(RenderCommand, ChoicesThatWouldChangeNothingAreErrors) {
    const TempDir dir;
    const std::string in = (dir / "scene.json").string();
    write_text(dir / "scene.json",
               R"({"meshprep": 1, "meshes": {"ball": {"shape": {"kind": "sphere"}}},
                   "camera": {"position": [0, 0, 5], "target": [0, 0, 0], "height": 3},
                   "picture": {"size": [16, 16]}})");
    // Linear files have no tone curve; "off" says what they do.
    for (const std::string ending : {"exr", "hdr"}) {
        const std::string out = (dir / ("a." + ending)).string();
        const test::Ran ran = run_here({"render", in, "-o", out, "--tone-map", "reinhard"});
        EXPECT_EQ(ran.exit_code, 2);
        EXPECT_NE(ran.err.find("--tone-map"), std::string::npos) << ran.err;
    }
    // The file's own camera is orthographic.
    const std::string out = (dir / "a.png").string();
    const test::Ran ran = run_here({"render", in, "-o", out, "--fov", "40"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("--fov"), std::string::npos) << ran.err;
    EXPECT_EQ(dir.names(), std::vector<std::string>{"scene.json"});
    EXPECT_EQ(run_here({"render", in, "-o", out, "--fov", "40", "--camera", "0,0"}).exit_code, 0);
    const std::string linear = (dir / "a.exr").string();
    EXPECT_EQ(run_here({"render", in, "-o", linear, "--tone-map", "off"}).exit_code, 0);
}

TEST(RenderCrop, IsThePartOfTheWholePicture) {
    const TempDir dir;
    write_text(dir / "sphere.obj", test::sphere_obj(24, 16));
    render(dir / "sphere.obj", dir / "whole.png", {"--size", "120x90"});
    render(dir / "sphere.obj", dir / "part.png", {"--size", "120x90", "--crop", "37,21,50x41"});
    const prep::Image whole = load(dir / "whole.png"), part = load(dir / "part.png");
    ASSERT_EQ(part.width, 50u);
    ASSERT_EQ(part.height, 41u);
    for (std::uint32_t y = 0; y < 41; ++y)
        for (std::uint32_t x = 0; x < 50; ++x)
            for (int c = 0; c < 3; ++c)
                ASSERT_EQ(part.at(x, y)[c], whole.at(x + 37, y + 21)[c]) << x << " " << y;
    // The scene's or the default size decides where --size is not given.
    const auto ran = run_here({"render", (dir / "sphere.obj").string(), "-o",
                               (dir / "none.png").string(), "--crop", "1000,0,100x100"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("1024x768"), std::string::npos) << ran.err;
}

TEST(RenderCamera, PlacesAndOrbitsAgree) {
    const TempDir dir;
    write_text(dir / "sphere.obj", test::sphere_obj(24, 16));
    const std::vector<std::string> size = {"--size", "64x64", "--ortho", "3"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.end(), size.begin(), size.end());
        return more;
    };
    render(dir / "sphere.obj", dir / "orbit.png", with({"--camera", "90,0"}));
    render(dir / "sphere.obj", dir / "place.png", with({"--look-from", "8,0,0"}));
    EXPECT_TRUE(file_text(dir / "orbit.png") == file_text(dir / "place.png"));
    render(dir / "sphere.obj", dir / "other.png", with({"--look-from", "2,8,0"}));
    EXPECT_TRUE(file_text(dir / "orbit.png") != file_text(dir / "other.png"));
    // Turned about the axis of view by half a turn: upside down.
    render(dir / "sphere.obj", dir / "over.exr", with({"--look-from", "0,3,8", "--no-textures"}));
    render(dir / "sphere.obj", dir / "under.exr",
           with({"--look-from", "0,3,8", "--up=0,-1,0", "--no-textures"}));
    const prep::Image over = load(dir / "over.exr"), under = load(dir / "under.exr");
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x)
            ASSERT_EQ(over.at(x, y)[3], under.at(63 - x, 63 - y)[3]) << x << " " << y;
}

TEST(RenderTurntable, WritesASequenceAroundTheScene) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const auto ran = render(dir / "cube.obj", dir / "t.exr",
                            {"--turntable", "8", "--size", "64x48", "--camera", "10,20"});
    std::vector<std::string> names = {"cube.obj"};
    for (int n = 0; n < 8; ++n) names.push_back("t_00" + std::to_string(n) + ".exr");
    EXPECT_EQ(dir.names(), names);
    EXPECT_EQ(ran.json()["outputs"].size(), 8u);
    // A cube looks alike from every quarter turn, as lights stand with the camera; and not from an
    // eighth. Edges may fall on the other side of a sample by rounding.
    const auto apart = [&](int a, int b) {
        const prep::Image one = load(dir / ("t_00" + std::to_string(a) + ".exr"));
        const prep::Image two = load(dir / ("t_00" + std::to_string(b) + ".exr"));
        int differ = 0;
        for (std::size_t i = 0; i < one.pixels.size(); ++i)
            differ += std::abs(one.pixels[i] - two.pixels[i]) > 1e-4f;
        return differ;
    };
    for (const int n : {2, 4, 6}) EXPECT_LT(apart(0, n), 20) << n;
    EXPECT_GT(apart(0, 1), 500);
    EXPECT_LT(apart(1, 3), 20);
}

TEST(RenderTurntable, AllPicturesOrNone) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    write_text(dir / "t_002.png", "mine");
    const std::string in = (dir / "cube.obj").string();
    const auto ran = run_here({"render", in, "-o", (dir / "t.png").string(), "--turntable", "4",
                               "--size", "16x16", "--no-overwrite"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("t_002.png"), std::string::npos) << ran.err;
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"cube.obj", "t_002.png"}));
    EXPECT_EQ(file_text(dir / "t_002.png"), "mine");
    render(dir / "cube.obj", dir / "u-%d.png", {"--turntable", "2", "--size", "16x16"});
    EXPECT_EQ(dir.names(),
              (std::vector<std::string>{"cube.obj", "t_002.png", "u-0.png", "u-1.png"}));
}

TEST(RenderTurntable, NamesFollowThePattern) {
    using meshprep::sequence_name;
    EXPECT_EQ(sequence_name("a/b.png", 7, 36), "a/b_007.png");
    EXPECT_EQ(sequence_name("b.png", 12, 5000), "b_0012.png");
    EXPECT_EQ(sequence_name("a/b.%04d.exr", 7, 36), "a/b.0007.exr");
    EXPECT_EQ(sequence_name("%d.png", 7, 36), "7.png");
    EXPECT_EQ(sequence_name("50%.png", 7, 36), "50%_007.png");
    EXPECT_FALSE(meshprep::pattern_digits("50%.png"));
    EXPECT_FALSE(meshprep::pattern_digits("a%x_%"));
}

TEST(RenderBands, GiveTheSameBytes) {
    const TempDir dir;
    write_text(dir / "sphere.obj", test::sphere_obj(48, 32));
    for (const std::string ending : {"png", "exr"}) {
        const std::vector<std::string> common = {"--size", "1100x700", "--buffers", "depth,id"};
        std::vector<std::string> banded = common;
        banded.insert(banded.end(), {"--band-memory", "1"});
        const auto whole = render(dir / "sphere.obj", dir / ("whole." + ending), common);
        const auto bands = render(dir / "sphere.obj", dir / ("bands." + ending), banded);
        EXPECT_EQ(whole.json()["plan"]["band_rows"], 700);
        EXPECT_LT(bands.json()["plan"]["band_rows"], 40);
        for (const std::string& name :
             std::vector<std::string>{"." + ending, ".depth.exr", ".id.exr"})
            EXPECT_TRUE(file_text(dir / ("whole" + name)) == file_text(dir / ("bands" + name)))
                << name;
    }
}

TEST(RenderOutputs, TwoOutputsOfOneNameAreRefused) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::textured_cube_obj());
    const test::Ran ran =
        run_here({"render", (dir / "cube.obj").string(), "-o", (dir / "a.exr").string(), "--size",
                  "16x16", "--buffers", "uv", "--buffer-file", (dir / "./a.exr").string()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("two outputs"), std::string::npos) << ran.err;
    EXPECT_EQ(dir.names(), std::vector<std::string>{"cube.obj"});
}

TEST(RenderOutputs, RadianceFilesHoldThreeChannels) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const test::Ran ran = run_here(
        {"render", (dir / "cube.obj").string(), "-o", (dir / "a.hdr").string(), "--size", "16x16"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(file_text(dir / "a.hdr").substr(0, 2), "#?");
}

TEST(RenderOutputs, TurntablesTurnAlsoSeenFromAbove) {
    const TempDir dir;
    write_text(dir / "flag.obj", "v 0 0 0\nv 3 0 0\nv 0 0 -1\nf 1 2 3\n");
    const test::Ran ran =
        run_here({"render", (dir / "flag.obj").string(), "-o", (dir / "t.png").string(), "--size",
                  "32x32", "--camera", "0,90", "--turntable", "4", "--cull", "none"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    std::set<std::string> pictures;
    for (const char* name : {"t_000.png", "t_001.png", "t_002.png", "t_003.png"})
        pictures.insert(file_text(dir / name));
    EXPECT_EQ(pictures.size(), 4u);
}

}  // namespace
