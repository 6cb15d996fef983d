// What `render`'s options change, against light worked out by hand, and their words against the
// renderer's own values.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "command_runner.h"
#include "meshprep/commands/render_views.h"
#include "prep/image.h"
#include "prep/prepare.h"
#include "prep/scene_json.h"
#include "rast/render.h"
#include "shared_data.h"

namespace {

using test::run_here;
using test::TempDir;
using test::write_text;

prep::Image load(const std::filesystem::path& path) {
    auto image = prep::load_image(path);
    EXPECT_TRUE(image) << to_string(image.error());
    return image ? *std::move(image) : prep::Image{};
}

prep::Image drawn(const TempDir& dir, const std::string& scene,
                  const std::vector<std::string>& options, const std::string& ending = "exr") {
    write_text(dir / "scene.json", scene);
    std::vector<std::string> words{"render", (dir / "scene.json").string(), "-o",
                                   (dir / ("out." + ending)).string(), "--quiet"};
    words.insert(words.end(), options.begin(), options.end());
    const test::Ran ran = run_here(words);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return load(dir / ("out." + ending));
}

// A plane of diffuse 1/2 that faces the camera but for a turn about an axis, seen from above
// without perspective: right in the picture is +x, up is −z.
std::string plane(const std::string& rotate, const std::string& more = "") {
    return R"({"meshprep": 1, "materials": {"m": {"diffuse": 0.5, "specular": 0}},
  "meshes": {"p": {"shape": {"kind": "plane", "size": [4, 1, 4]}, "material": "m"}},
  "nodes": [{"mesh": "p", "rotate": )" +
           rotate + R"(}], "camera": {"position": [0, 5, 0], "target": [0, 0, 0],
  "up": [0, 0, -1], "height": 0.5}, "picture": {"size": [8, 8]})" +
           more + "}";
}

// Lambert's cosine, without 1/π as in MTL files; lights are seen from the camera.
TEST(RenderLights, ComeFromWhereTheirAnglesSay) {
    const TempDir dir;
    const double pi = std::numbers::pi;
    const std::string right = "[0, 0, -30]", up = "[-30, 0, 0]";  // where the plane leans to
    const struct {
        std::string rotate, light;
        double cosine;
    } cases[] = {{"[0, 0, 0]", "0,0", 1},
                 {"[0, 0, 0]", "60,0", 0.5},
                 {"[0, 0, 0]", "0,-60", 0.5},
                 {right, "60,0", std::cos(pi / 6)},
                 {right, "-50,0", std::cos(80 * pi / 180)},
                 {right, "-70,0", 0},
                 {up, "0,60", std::cos(pi / 6)},
                 {up, "0,-50", std::cos(80 * pi / 180)},
                 // Azimuth about the vertical first: at 90 it takes all, whatever the plane's tilt.
                 {"[0, 0, 0]", "45,45", 0.5}};
    for (const auto& c : cases) {
        const prep::Image picture =
            drawn(dir, plane(c.rotate), {"--light=" + c.light, "--ambient", "0"});
        EXPECT_NEAR(double(picture.at(4, 4)[0]), 0.5 * c.cosine, 1e-5) << c.rotate << c.light;
    }
}

TEST(RenderLights, AddUpAndTakeThePlaceOfTheFiles) {
    const TempDir dir;
    const std::string own = plane("[0, 0, 0]", R"(, "lights": [
        {"kind": "ambient", "intensity": 0.25},
        {"kind": "directional", "direction": [0, -1, 0], "intensity": 0.5}])");
    const auto shade = [&](const std::vector<std::string>& options) {
        return double(drawn(dir, own, options).at(4, 4)[1]);
    };
    EXPECT_NEAR(shade({}), 0.5 * (0.25 + 0.5), 1e-6);
    EXPECT_NEAR(shade({"--ambient", "0.75"}), 0.5 * (0.75 + 0.5), 1e-6);
    EXPECT_NEAR(shade({"--light", "0,0"}), 0.5 * (1 + 0.1), 1e-6);
    EXPECT_NEAR(shade({"--light", "0,0,2"}), 0.5 * (2 + 0.1), 1e-6);
    EXPECT_NEAR(shade({"--light", "0,0,0.5", "--light", "60,0,1", "--ambient", "0.2"}),
                0.5 * (0.5 + 0.5 + 0.2), 1e-6);
    EXPECT_NEAR(shade({"--exposure", "4"}), 4 * 0.5 * 0.75, 1e-6);
}

double srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

TEST(RenderTone, ExposureToneCurveAndBackgroundAreTheirFormulas) {
    const TempDir dir;
    const std::string scene = plane("[0, 0, 0]");
    const std::vector<std::string> lit = {"--light", "0,0,1", "--ambient", "0"};
    const auto level = [&](std::vector<std::string> options) {
        options.insert(options.end(), lit.begin(), lit.end());
        return double(drawn(dir, scene, options, "png").at(4, 4)[2]);
    };
    const double half = 0.51 / 255;
    EXPECT_NEAR(level({}), srgb(0.5), half);
    EXPECT_NEAR(level({"--exposure", "1.5"}), srgb(0.75), half);
    EXPECT_NEAR(level({"--exposure", "8"}), 1, half);
    EXPECT_NEAR(level({"--exposure", "8", "--tone-map", "reinhard"}), srgb(4.0 / 5), half);
    EXPECT_NEAR(level({"--tone-map", "reinhard"}), srgb(1.0 / 3), half);
    // Beside the plane: a camera that sees more.
    std::string wide = scene;
    wide.replace(wide.find("\"height\": 0.5"), 13, "\"height\": 16");
    const auto background = [&](const char* color) {
        const prep::Image picture = drawn(dir, wide, {"--background", color});
        EXPECT_EQ(picture.at(0, 0)[3], 0.0f);
        EXPECT_EQ(picture.at(4, 4)[3], 1.0f);
        return std::vector<double>(picture.at(0, 0), picture.at(0, 0) + 3);
    };
    const auto linear = [](int v) { return std::pow((v / 255.0 + 0.055) / 1.055, 2.4); };
    const std::vector<double> hex = background("#4080c0");
    EXPECT_NEAR(hex[0], linear(0x40), 1e-6);
    EXPECT_NEAR(hex[1], linear(0x80), 1e-6);
    EXPECT_NEAR(hex[2], linear(0xc0), 1e-6);
    EXPECT_NEAR(background("#0a0000")[0], 10 / 255.0 / 12.92, 1e-7);  // the straight part
    EXPECT_EQ(background("0.125,0.25,0.5"), (std::vector<double>{0.125, 0.25, 0.5}));
    EXPECT_EQ(background("0.25"), (std::vector<double>{0.25, 0.25, 0.25}));
    for (const char* wrong : {"#12345", "#12345g", "1,2", "0.1,0.2,0.3,0.4", "-1", "1000001", "#"})
        EXPECT_EQ(run_here({"render", (dir / "scene.json").string(), "-o", (dir / "x.png").string(),
                            "--background", wrong})
                      .exit_code,
                  2)
            << wrong;
}

int covered(const prep::Image& picture) {
    int count = 0;
    for (std::size_t i = 3; i < picture.pixels.size(); i += 4) count += picture.pixels[i] > 0;
    return count;
}

TEST(RenderCameras, AnglesHeightsAndDistancesAreInUnits) {
    const TempDir dir;
    // A square of two units, from a distance of 5: what part of 40 x 40 pixels it fills.
    write_text(dir / "square.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
    const auto fills = [&](std::vector<std::string> options) {
        std::vector<std::string> words = {"render", (dir / "square.obj").string(),
                                          "-o",     (dir / "a.exr").string(),
                                          "--size", "40x40",
                                          "--quiet"};
        words.insert(words.end(), options.begin(), options.end());
        EXPECT_EQ(run_here(words).exit_code, 0);
        return std::sqrt(covered(load(dir / "a.exr"))) / 40;
    };
    const std::vector<std::string> from = {"--look-from", "0,0,5", "--look-at", "0,0,0"};
    const auto with = [&](std::vector<std::string> options) {
        options.insert(options.end(), from.begin(), from.end());
        return options;
    };
    EXPECT_NEAR(fills(with({"--fov", "90"})), 1.0 / 5, 1e-9);   // half height 5
    EXPECT_NEAR(fills(with({"--fov", "53.1301"})), 0.4, 1e-9);  // 2 atan(1/2): 2.5
    EXPECT_NEAR(fills(with({"--ortho", "5"})), 2.0 / 5, 1e-9);
    EXPECT_NEAR(fills(with({"--ortho", "2.5"})), 2.0 / 2.5, 1e-9);
    // The orbit's distance 1 fits the square; twice as far it fills half as much.
    const double one = fills({"--camera", "0,0"}), two = fills({"--camera", "0,0,2"});
    EXPECT_GT(one, 0.85);
    EXPECT_NEAR(two / one, 0.5, 0.05);
    EXPECT_NEAR(fills({"--camera", "0,0", "--ortho", "fit"}), 0.95, 0.05);
    // Azimuth 0 is seen from +z; from +x and −z nothing of the square's front is.
    EXPECT_EQ(fills({"--camera", "180,0", "--cull", "back"}), 0.0);
    EXPECT_NEAR(fills({"--camera", "60,0", "--ortho", "4"}), 0.5 * std::sqrt(0.5), 0.03);
    // From the side only the elevation tells: from above, the horizon tilts away.
    EXPECT_NEAR(fills({"--camera", "0,60", "--ortho", "4"}), 0.5 * std::sqrt(0.5), 0.03);
}

// What scene files say of their cameras, on a square of two units that faces them, or a box.
std::string seen(const std::string& shape, const std::string& camera) {
    return R"({"meshprep": 1, "meshes": {"p": {"shape": )" + shape +
           R"(}}, "nodes": [{"mesh": "p", "rotate": [)" +
           (shape.find("plane") != std::string::npos ? "90" : "0") + R"(, 0, 0]}], "camera": {)" +
           camera + "}}";
}

// A unit is so many pixels, whatever the picture's form.
TEST(RenderCameras, HeightsOfSceneFilesAreThePictures) {
    const TempDir dir;
    const std::string square = R"({"kind": "plane", "size": [2, 1, 2]})";
    for (const auto& [size, height] : {std::pair("40x80", 80), {"80x40", 40}, {"60x60", 60}}) {
        const double side = 2 * height / 4.0;
        for (const char* const camera : {R"("position": [0, 0, 5], "target": [0, 0, 0])",
                                         R"("orbit": {"azimuth": 0, "elevation": 0})"})
            EXPECT_EQ(covered(drawn(dir, seen(square, std::string(camera) + R"(, "height": 4)"),
                                    {"--size", size})),
                      int(side * side))
                << size << camera;
    }
}

// Of a box of two units seen from the front: how high its front is in the picture.
TEST(RenderCameras, OrbitsOfSceneFilesHaveTheirLens) {
    const TempDir dir;
    const auto fills = [&](const std::string& camera, std::vector<std::string> options = {}) {
        options.insert(options.end(), {"--size", "200x200"});
        const std::string orbit = R"("orbit": {"azimuth": 0, "elevation": 0, "distance": 2})";
        return std::sqrt(covered(drawn(
                   dir, seen(R"({"kind": "box", "size": [2, 2, 2]})", orbit + camera), options))) /
               200;
    };
    // The box fits with a margin of 8 % from 1 + 1.08 / tan(fov / 2): twice as far, the front's
    // half height of 1 is seen from 1 + 2.16 / tan(fov / 2) (rast/view.h).
    const auto front = [](double fov) {
        const double tangent = std::tan(fov / 2);
        return 1 / (tangent * (1 + 2.16 / tangent));
    };
    EXPECT_NEAR(fills(""), front(0.6), 0.011);
    EXPECT_NEAR(fills(R"(, "fov": 90)"), front(std::numbers::pi / 2), 0.011);
    EXPECT_NEAR(fills(R"(, "fov": 20)", {"--fov", "90"}), front(std::numbers::pi / 2), 0.011);
    EXPECT_NEAR(fills(R"(, "height": 4)"), 0.5, 0.001);
    EXPECT_NEAR(fills(R"(, "height": 4)", {"--ortho", "8"}), 0.25, 0.001);
    EXPECT_NEAR(fills(R"(, "fov": 90)", {"--ortho", "8"}), 0.25, 0.001);
    // The front is 3.16 away; behind it are back faces alone.
    EXPECT_GT(fills(R"(, "fov": 90, "near": 3.1)"), 0.3);
    EXPECT_EQ(fills(R"(, "fov": 90, "near": 3.2)"), 0);
    EXPECT_GT(fills(R"(, "fov": 90, "far": 3.2)"), 0.3);
    EXPECT_EQ(fills(R"(, "fov": 90, "far": 3.1)"), 0);
    // 1 + 2.16 / tan 0.3 = 7.98 without perspective.
    EXPECT_GT(fills(R"(, "height": 4, "near": 7.9)"), 0.4);
    EXPECT_EQ(fills(R"(, "height": 4, "near": 8.1)"), 0);
    EXPECT_GT(fills(R"(, "height": 4, "far": 8.1)"), 0.4);
    EXPECT_EQ(fills(R"(, "height": 4, "far": 7.9)"), 0);
    // A plane that is named has the other one move.
    EXPECT_EQ(fills(R"(, "far": 0.001)"), 0);
    EXPECT_EQ(fills(R"(, "height": 4, "near": 1000)"), 0);
    // Another projection has planes of its own.
    EXPECT_GT(fills(R"(, "far": 3.1)", {"--ortho", "4"}), 0.4);
    const test::Ran none = run_here({"render", (dir / "scene.json").string(), "-o",
                                     (dir / "a.png").string(), "--fov", "30", "--quiet"});
    EXPECT_EQ(none.exit_code, 0) << none.err;
    write_text(dir / "flat.json", seen(R"({"kind": "box"})", R"("orbit": {}, "height": 4)"));
    const test::Ran flat = run_here(
        {"render", (dir / "flat.json").string(), "-o", (dir / "a.png").string(), "--fov", "30"});
    EXPECT_EQ(flat.exit_code, 1);
    EXPECT_NE(flat.err.find("--fov is an angle of perspective"), std::string::npos) << flat.err;
}

// Nor do views for errors in pixels, made of the scene as it is read, change planes that are named.
TEST(RenderCameras, PlanesOfSceneFilesStayInViewsForPixelErrors) {
    const TempDir dir;
    for (const char* const lens : {R"("fov": 40)", R"("height": 4)"}) {
        write_text(dir / "s.json",
                   seen(R"({"kind": "box"})",
                        std::string(R"("orbit": {}, )") + lens + R"(, "near": 0.25, "far": 77)"));
        auto loaded = prep::load_scene_json(dir / "s.json", {});
        ASSERT_TRUE(loaded) << to_string(loaded.error());
        const meshprep::CameraWishes camera;
        const meshprep::ViewChoices choices{camera, 0, loaded->orbit};
        const auto screens = meshprep::screen_views(choices, loaded->scene, 1);
        ASSERT_TRUE(screens);
        const auto prepared = prep::prepare(std::move(loaded->scene));
        ASSERT_TRUE(prepared);
        const auto views = meshprep::drawn_views(*screens, choices, *prepared, 1);
        ASSERT_EQ(views.size(), 1u);
        EXPECT_EQ(views[0]->znear, 0.25);
        EXPECT_EQ(views[0]->zfar, 77);
    }
}

// Camera nodes by their names, their cameras' names, and their numbers among the cameras.
TEST(RenderCameras, AreFoundByNameAndNumber) {
    const TempDir dir;
    test::GltfText gltf;
    gltf.add({"m",
              {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0},
              {},
              {},
              {},
              {0, 1, 2, 0, 2, 3},
              "",
              R"("children":[1,2])"});
    std::string text = gltf.text(
        R"("cameras":[{"name":"lens","type":"orthographic","orthographic":{"xmag":2,"ymag":2,)"
        R"("znear":0.1,"zfar":10}},{"type":"orthographic","orthographic":{"xmag":4,"ymag":4,)"
        R"("znear":0.1,"zfar":10}}])");
    const std::string root = R"("children":[1,2]})";
    text.insert(text.find(root) + root.size(),
                R"(,{"camera":0,"translation":[0,0,5]},{"name":"far 1","camera":1,)"
                R"("translation":[0,0,5]})");
    write_text(dir / "a.gltf", text);
    const auto fills = [&](const char* camera) {
        const test::Ran ran =
            run_here({"render", (dir / "a.gltf").string(), "-o", (dir / "a.exr").string(), "--size",
                      "16x16", "--quiet", "--camera", camera});
        return ran.exit_code == 0 ? std::sqrt(covered(load(dir / "a.exr"))) / 16 : -1.0;
    };
    EXPECT_EQ(fills("lens"), 0.5);
    EXPECT_EQ(fills("0"), 0.5);
    EXPECT_EQ(fills("far 1"), 0.25);
    EXPECT_EQ(fills("1"), 0.25);
    EXPECT_EQ(fills("2"), -1);
    const test::Ran none = run_here(
        {"render", (dir / "a.gltf").string(), "-o", (dir / "a.png").string(), "--camera", "side"});
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_NE(none.err.find("no camera 'side' in the scene; it has 0 'lens', 1 'far 1'"),
              std::string::npos)
        << none.err;
    write_text(dir / "cube.obj", test::cube_obj());
    const test::Ran bare = run_here({"render", (dir / "cube.obj").string(), "-o",
                                     (dir / "a.png").string(), "--camera", "side"});
    EXPECT_NE(bare.err.find("it has none: give --camera AZIMUTH,ELEVATION"), std::string::npos);
}

// A ball with a normal map, a floor at a slant, and two sheets seen from behind.
std::string everything(const std::string& picture) {
    return R"({"meshprep": 1, "textures": {"c": {"file": "brick.png"}, "n": {"file": "n.png"}},
  "materials": {"ball": {"diffuse": 0.7, "normal_map": "n"}, "floor": {"diffuse_map": "c"},
    "one": {"diffuse": 0.5}, "two": {"diffuse": 0.3, "double_sided": true}},
  "meshes": {"ball": {"shape": {"kind": "sphere", "segments": 12, "rings": 8}, "material": "ball"},
    "floor": {"shape": {"kind": "plane", "size": [8, 1, 8]}, "material": "floor"},
    "one": {"shape": {"kind": "plane"}, "material": "one"},
    "two": {"shape": {"kind": "plane"}, "material": "two"}},
  "nodes": [{"mesh": "ball", "translate": [0, 1, 0]}, {"mesh": "floor"},
    {"mesh": "one", "translate": [-1.5, 2, 0], "rotate": [-90, 0, 0]},
    {"mesh": "two", "translate": [1.5, 2, 0], "rotate": [-90, 0, 0]}],
  "camera": {"position": [0.3, 2, 6], "target": [0, 1, 0], "fov": 40},
  "picture": {"size": [48, 36])" +
           picture + "}}";
}

// The words of the command line and of scene files, each against the value it names.
TEST(RenderWords, NameTheRenderersChoices) {
    const TempDir dir;
    const std::filesystem::path room = test::source_dir() / "samples/room";
    std::filesystem::copy_file(room / "brick_color.png", dir / "brick.png");
    std::filesystem::copy_file(room / "brick_normal.png", dir / "n.png");
    write_text(dir / "scene.json", everything(""));
    auto loaded = prep::load_scene_json(dir / "scene.json", {});
    ASSERT_TRUE(loaded) << to_string(loaded.error());
    const auto prepared = prep::prepare(std::move(loaded->scene));
    ASSERT_TRUE(prepared);
    rast::SceneRenderer renderer(*prepared);
    std::vector<std::vector<float>> pictures;  // of the words of one option
    const auto expect_word = [&](const char* option, const char* word,
                                 const rast::RenderRequest& request, bool in_files = true) {
        SCOPED_TRACE(std::string(option) + " " + word);
        rast::RenderRequest sized = request;
        sized.width = 48;
        sized.height = 36;
        const auto plan = rast::plan(*prepared, sized);
        ASSERT_TRUE(plan);
        rast::Frame frame;
        ASSERT_TRUE(renderer.render(*plan, frame));
        std::vector<float> expected;
        for (const glm::vec4& c : frame.color)
            expected.insert(expected.end(), {c.r, c.g, c.b, c.a});
        const prep::Image by_option =
            drawn(dir, everything(""), {std::string("--") + option, word});
        EXPECT_TRUE(by_option.pixels == expected);
        if (in_files) {
            const std::string key = std::string(R"(, ")") + option + R"(": ")" + word + "\"";
            EXPECT_TRUE(drawn(dir, everything(key), {}).pixels == expected);
        }
        EXPECT_EQ(std::count(pictures.begin(), pictures.end(), expected), 0);
        pictures.push_back(expected);
    };
    rast::RenderRequest r;
    using rast::Shading;
    for (const auto& [word, value] : {std::pair{"flat", Shading::flat},
                                      {"gouraud", Shading::gouraud},
                                      {"phong", Shading::phong},
                                      {"normal-mapped", Shading::normal_mapped}}) {
        r = {};
        r.shading = value;
        expect_word("shading", word, r);
    }
    using rast::Cull;
    pictures.clear();
    for (const auto& [word, value] : {std::pair{"by-material", Cull::by_material},
                                      {"back", Cull::back},
                                      {"front", Cull::front},
                                      {"none", Cull::none}}) {
        r = {};
        r.cull = value;
        expect_word("cull", word, r);
    }
    using rast::TextureFilter;
    pictures.clear();
    for (const auto& [word, value] : {std::pair{"nearest", TextureFilter::nearest},
                                      {"bilinear", TextureFilter::bilinear},
                                      {"nearest-mip", TextureFilter::nearest_mip},
                                      {"trilinear", TextureFilter::trilinear},
                                      {"bicubic", TextureFilter::bicubic},
                                      {"anisotropic", TextureFilter::anisotropic},
                                      {"ripmap", TextureFilter::ripmap},
                                      {"ewa", TextureFilter::ewa}}) {
        r = {};
        r.filter = value;
        expect_word("filter", word, r);
    }
    pictures.clear();
    r = {};
    expect_word("filter", "sampler", r);
    pictures.clear();
    expect_word("coverage", "samples", r);
    r.coverage = rast::Coverage::area;
    expect_word("coverage", "area", r);
    pictures.clear();
    r = {};
    r.samples = 4;
    expect_word("samples", "4", r, false);
    r = {};
    r.supersample = 3;
    expect_word("supersample", "3", r, false);
    // What options say goes before what the file says.
    for (const auto& [key, options] :
         {std::pair<const char*, std::vector<std::string>>{", \"shading\": \"flat\"",
                                                           {"--shading", "normal-mapped"}},
          {", \"cull\": \"none\"", {"--cull", "by-material"}},
          {", \"background\": 1", {"--background", "0"}},
          {", \"exposure\": 3", {"--exposure", "1"}},
          {", \"samples\": 4", {"--samples", "1"}},
          {", \"max_anisotropy\": 2, \"filter\": \"ewa\"",
           {"--filter", "trilinear", "--max-anisotropy", "4"}}})
        EXPECT_TRUE(drawn(dir, everything(key), options).pixels ==
                    drawn(dir, everything(""), {}).pixels)
            << key;
    // Without textures only the materials' own colours are left.
    EXPECT_EQ(drawn(dir, plane("[0, 0, 0]"), {"--no-textures"}).pixels,
              drawn(dir, plane("[0, 0, 0]"), {}).pixels);
    EXPECT_NE(drawn(dir, everything(""), {"--no-textures"}).pixels,
              drawn(dir, everything(""), {}).pixels);
}

TEST(RenderUsage, WrongNumbersAreUsageErrors) {
    const TempDir dir;
    write_text(dir / "c.obj", test::cube_obj());
    for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
             {"--size", "10.5x10"},    {"--size", "32769x10"},   {"--size", "10x10x10"},
             {"--camera", "10,91"},    {"--camera", "10,20,0"},  {"--camera", "1,2,3,4"},
             {"--light", "1,2,-1"},    {"--light", "1,2,3,4"},   {"--look-from", "1,2,3,4"},
             {"--crop", "0,0,4x4,1"},  {"--crop", "0.5,0,4x4"},  {"--buffers", "depth,,x"},
             {"--fov", "0"},           {"--fov", "179.5"},       {"--ortho", "-1"},
             {"--ambient", "-0.1"},    {"--ambient", "101"},     {"--exposure", "0"},
             {"--samples", "3"},       {"--supersample", "17"},  {"--max-anisotropy", "0"},
             {"--coverage", "exact"},  {"--depth", "double"},    {"--tone-map", "filmic"},
             {"--shading", "Phong"},   {"--cull", "all"},        {"--filter", "lanczos"},
             {"--turntable", "10001"}, {"--light", "1,2,1.1e9"}, {"--light", "1,2,1e39"}}) {
        std::vector<std::string> words = {"render", (dir / "c.obj").string(), "-o",
                                          (dir / "x.png").string()};
        words.insert(words.end(), more.begin(), more.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 2) << more[0] << " " << more[1];
        EXPECT_NE(ran.err.find(more[0]), std::string::npos) << ran.err;
    }
    const auto pair = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words = {"render", (dir / "c.obj").string(), "-o",
                                          (dir / "x.png").string()};
        words.insert(words.end(), more.begin(), more.end());
        return run_here(words).exit_code;
    };
    EXPECT_EQ(pair({"--coverage", "area", "--samples", "4"}), 2);
    EXPECT_EQ(pair({"--coverage", "area", "--samples", "1", "--size", "8x8"}), 0);
    EXPECT_EQ(pair({"--crop", "4,4,5x4", "--size", "8x8"}), 2);
    EXPECT_EQ(pair({"--crop", "4,4,4x5", "--size", "8x8"}), 2);
    EXPECT_EQ(pair({"--crop", "4,4,4x4", "--size", "8x8"}), 0);
    EXPECT_EQ(pair({"--supersample", "16", "--size", "2049x8"}), 2);
    EXPECT_EQ(pair({"--light", "1,2,1e9", "--size", "8x8"}), 0);
}

}  // namespace
