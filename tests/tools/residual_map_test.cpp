// Residual normal maps from the command line: read back from the written files with their tangents,
// texel by texel against normals of closed form; pictures against those of a far denser mesh.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <numbers>

#include "command_runner.h"
#include "prep/image.h"
#include "prep/load.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;
using test::write_text;

constexpr double two_pi = 2 * std::numbers::pi;

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}

// Heights over the whole picture, v down.
struct Waves {
    double a = 0.012;
    int f = 12;
    double height(const glm::dvec2& p) const {
        return a * std::sin(two_pi * f * p.x) * std::cos(two_pi * f * p.y);
    }
    glm::dvec2 slope(const glm::dvec2& p) const {
        const double k = two_pi * f;
        return {a * k * std::cos(k * p.x) * std::cos(k * p.y),
                -a * k * std::sin(k * p.x) * std::sin(k * p.y)};
    }
};

// A plane square in space with an affine chart: origin, two edges; and their UVs, v up as OBJ has
// it.
struct Square {
    glm::dvec3 origin, x, y;
    glm::dvec2 uv, uv_x, uv_y;
};
// Upright, mirrored, turned by a quarter, and slanting; each in its quarter of the picture.
const std::vector<Square> squares{
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.05, 0.05}, {0.4, 0}, {0, 0.4}},
    {{3, 0, 0}, {0.8, 0, 0.6}, {0, 1, 0}, {0.95, 0.05}, {-0.4, 0}, {0, 0.4}},
    {{6, 0, 0}, {0, 0, -1}, {0.6, 0.8, 0}, {0.45, 0.55}, {0, 0.4}, {-0.4, 0}},
    {{9, 0, 0}, {1, 0, 0}, {0.3, 1, 0.2}, {0.55, 0.55}, {0.4, 0}, {0.1, 0.35}},
};

std::string obj_of(const std::vector<Square>& of) {
    std::string text;
    for (const Square& s : of)
        for (const auto& [i, j] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
            const glm::dvec3 p = s.origin + double(i) * s.x + double(j) * s.y;
            const glm::dvec2 t = s.uv + double(i) * s.uv_x + double(j) * s.uv_y;
            text += fmt::format("v {} {} {}\nvt {} {}\n", p.x, p.y, p.z, t.x, t.y);
        }
    for (std::size_t k = 0; k < of.size(); ++k)
        text += fmt::format("f {0}/{0} {1}/{1} {2}/{2} {3}/{3}\n", 4 * k + 1, 4 * k + 2, 4 * k + 3,
                            4 * k + 4);
    return text;
}

// The normal of the displaced square at a point of the picture.
glm::dvec3 closed_normal(const Square& s, const Waves& waves, const glm::dvec2& at) {
    const glm::dmat2 chart(s.uv_x.x, -s.uv_x.y, s.uv_y.x, -s.uv_y.y);  // to the picture, v down
    const glm::dvec2 by_xy = glm::transpose(chart) * waves.slope(at);
    const glm::dvec3 n = glm::normalize(glm::cross(s.x, s.y));
    return glm::normalize(glm::cross(s.x + by_xy.x * n, s.y + by_xy.y * n));
}

struct Reading {  // how a reader may go wrong
    bool flip_green = false, flip_sign = false;
    double shift = 0;  // texels
    bool without = false;
};

class ResidualMap : public testing::Test {
  protected:
    std::string heights(const std::string& name, std::uint32_t size) {
        prep::Image image{.width = size, .height = size, .channels = 1, .pixels = {}};
        for (std::uint32_t y = 0; y < size; ++y)
            for (std::uint32_t x = 0; x < size; ++x)
                image.pixels.push_back(float(waves_.height({(x + 0.5) / size, (y + 0.5) / size})));
        EXPECT_TRUE(prep::save_image(dir_ / name, image, prep::PixelType::f32));
        return (dir_ / name).string();
    }
    test::Ran prepared(const std::string& obj, const std::string& output,
                       std::vector<std::string> options) {
        write_text(dir_ / "in.obj", obj);
        options.insert(options.begin(), {"prepare", (dir_ / "in.obj").string(), "-o",
                                         (dir_ / output).string(), "--json"});
        return run_here(options);
    }
    // Angles between what the written file says at the map's texels and the closed form: of texels
    // a whole one inside the charts.
    std::vector<double> angles(const std::string& file, const Reading& reading) {
        std::vector<double> result;
        const auto scene = prep::load_scene(dir_ / file);
        EXPECT_TRUE(scene) << to_string(scene.error());
        if (!scene || scene->materials.empty() || !scene->materials[0].normal_map) return {180};
        const prep::Material& material = scene->materials[0];
        const auto image =
            prep::load_image(scene->images[scene->textures[material.normal_map.texture].image]);
        EXPECT_TRUE(image);
        if (!image || image->channels != 3) return {180};
        const double size = image->width;
        for (const prep::Mesh& mesh : scene->meshes) {
            EXPECT_FALSE(mesh.tangents.empty());
            for (std::size_t f = 0; f < mesh.face_count(); ++f) {
                std::array<glm::dvec2, 3> uv;
                std::array<glm::dvec3, 3> normal, tangent;
                double sign = 1;
                glm::dvec3 middle(0.0);
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::size_t c = mesh.face_offsets[f] + k;
                    const auto& set = mesh.uvs[material.normal_map.uv_set];
                    uv[k] = glm::dvec2(set.values[set.indices[c]]);
                    normal[k] = glm::dvec3(mesh.normals.values[mesh.normals.indices[c]]);
                    const glm::vec4 t = mesh.tangents.values[mesh.tangents.indices[c]];
                    tangent[k] = glm::dvec3(glm::vec3(t));
                    sign = double(t.w);
                    middle += glm::dvec3(mesh.positions[mesh.corner_vertices[c]]) / 3.0;
                }
                const auto which = std::size_t(std::clamp((middle.x + 1) / 3, 0.0, 3.9));
                const Square& square = squares[which];
                const auto [low_x, high_x] = std::minmax({uv[0].x, uv[1].x, uv[2].x});
                const auto [low_y, high_y] = std::minmax({uv[0].y, uv[1].y, uv[2].y});
                const glm::dmat2 edges(uv[1] - uv[0], uv[2] - uv[0]);
                for (double y = std::ceil(low_y * size - 0.5); y + 0.5 <= high_y * size; ++y)
                    for (double x = std::ceil(low_x * size - 0.5); x + 0.5 <= high_x * size; ++x) {
                        const glm::dvec2 at((x + 0.5) / size, (y + 0.5) / size);
                        const glm::dvec2 w = glm::inverse(edges) * (at - uv[0]);
                        const glm::dvec3 weights(1 - w.x - w.y, w.x, w.y);
                        if (std::min({weights.x, weights.y, weights.z}) < 0) continue;
                        if (!well_inside(square, at, 1.5 / size)) continue;
                        const glm::dvec3 n =
                            weights.x * normal[0] + weights.y * normal[1] + weights.z * normal[2];
                        const glm::dvec3 t = weights.x * tangent[0] + weights.y * tangent[1] +
                                             weights.z * tangent[2];
                        const glm::dvec3 b = (reading.flip_sign ? -sign : sign) * glm::cross(n, t);
                        glm::dvec3 c = texel(*image, x + reading.shift, y);
                        if (reading.flip_green) c.y = -c.y;
                        if (reading.without) c = {0, 0, 1};
                        result.push_back(degrees_between(c.x * t + c.y * b + c.z * n,
                                                         closed_normal(square, waves_, at)));
                    }
            }
        }
        std::sort(result.begin(), result.end());
        return result;
    }
    static bool well_inside(const Square& s, const glm::dvec2& at, double by) {
        const glm::dmat2 chart(s.uv_x, s.uv_y);
        const glm::dvec2 w = glm::inverse(chart) * (glm::dvec2(at.x, 1 - at.y) - s.uv);
        const double margin = by / 0.3;
        return std::min({w.x, w.y, 1 - w.x, 1 - w.y}) > margin;
    }
    // Between two texels of a row, linearly.
    static glm::dvec3 texel(const prep::Image& image, double x, double y) {
        const double last = image.width - 1, column = std::floor(x);
        const auto at = [&](double i) {
            const float* c = image.at(std::uint32_t(std::clamp(i, 0.0, last)), std::uint32_t(y));
            return glm::dvec3(2 * double(c[0]) - 1, 2 * double(c[1]) - 1, 2 * double(c[2]) - 1);
        };
        return glm::mix(at(column), at(column + 1), x - column);
    }
    static double p99(const std::vector<double>& sorted) {
        return sorted[sorted.size() * 99 / 100];
    }
    static bool has(const json& file, const std::string& kind) {
        for (const json& finding : file["findings"])
            if (finding["kind"] == kind) return true;
        return false;
    }
    Waves waves_;
    TempDir dir_;
};

// Too few triangles for the waves: the map says what they do not, in each file's own tangents.
TEST_F(ResidualMap, TexelsAndTangentsMakeTheSurfacesNormals) {
    const std::string map = heights("waves.exr", 512);
    for (const auto& [bits, most] : {std::pair("16", 1.5), std::pair("8", 2.0)}) {
        const std::string file = std::string("out") + bits + ".glb";
        const test::Ran ran = prepared(
            obj_of(squares), file,
            {"--displace", map, "--height-midlevel", "0", "--height-filter", "bicubic",
             "--max-triangles", "1500", "--residual-normal-map", "256", "--residual-bits", bits});
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        const json told = ran.json()["files"][0];
        ASSERT_EQ(told["residual_maps"].size(), 1U);
        EXPECT_EQ(told["residual_maps"][0]["size"], 256);
        EXPECT_EQ(told["residual_maps"][0]["bits"], std::stoi(bits));
        EXPECT_EQ(told["residual_maps"][0]["overlapping"], 0);
        EXPECT_FALSE(has(told, "residual-overlap"));
        // The charts' part of the picture: three of 0.16, one of 0.14, and the texels on borders.
        EXPECT_NEAR(told["residual_maps"][0]["texels"].get<double>() / (256 * 256), 0.62, 0.02);
        const auto scene = prep::load_scene(dir_ / file);
        ASSERT_TRUE(scene && scene->images.size() == 1U);
        EXPECT_EQ(prep::load_image(scene->images[0])->integer_bits, std::stoi(bits));
        const std::vector<double> found = angles(file, {});
        ASSERT_GT(found.size(), 25'000U);
        std::printf("%s bits: p99 %.3f, without %.1f, half a texel off %.2f\n", bits, p99(found),
                    p99(angles(file, {.without = true})), p99(angles(file, {.shift = 0.5})));
        RecordProperty("p99_of_" + std::string(bits), std::to_string(p99(found)));
        EXPECT_LE(p99(found), most) << bits;
        const std::vector<double> bare = angles(file, {.without = true});
        EXPECT_GT(p99(bare), 10) << "the triangles alone should not carry the waves";
        double mean = 0;
        for (const double a : bare) mean += a / double(bare.size());
        EXPECT_NEAR(told["residual_maps"][0]["mean_degrees"].get<double>(), mean, 0.05 * mean);
        // What the check would find: each by far.
        EXPECT_GT(p99(angles(file, {.flip_green = true})), 5 * most);
        EXPECT_GT(p99(angles(file, {.flip_sign = true})), 5 * most);
        EXPECT_GT(p99(angles(file, {.shift = 0.5})), 1.2 * most);
    }
}

// Where triangles carry all there is, the map is level.
TEST_F(ResidualMap, IsLevelWhereTheTrianglesAreTheSurface) {
    const test::Ran ran = prepared(obj_of(squares), "flat.glb",
                                   {"--edge-length", "0.5", "--residual-normal-map", "64"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json map = ran.json()["files"][0]["residual_maps"][0];
    EXPECT_LT(map["largest_degrees"].get<double>(), 0.01);
    const auto scene = prep::load_scene(dir_ / "flat.glb");
    ASSERT_TRUE(scene);
    const auto image = prep::load_image(scene->images[0]);
    ASSERT_TRUE(image);
    EXPECT_EQ(image->integer_bits, 16);
    for (std::size_t i = 0; i < image->pixels.size(); ++i)
        EXPECT_NEAR(image->pixels[i], i % 3 == 2 ? 1.0 : 0.5, 2e-5);
}

// Against 200,000 triangles: the picture comes closer with more triangles, and closer with the map.
TEST_F(ResidualMap, PicturesComeCloserToTheTruth) {
    const std::string map = heights("waves.exr", 512);
    const std::string obj = obj_of({squares[0]});
    const auto picture = [&](const std::string& name, std::vector<std::string> options) {
        options.insert(options.begin(), {"--displace", map, "--height-midlevel", "0"});
        EXPECT_EQ(prepared(obj, name + ".glb", options).exit_code, 0);
        const std::string png = (dir_ / (name + ".exr")).string();
        const test::Ran ran = run_here({"render", (dir_ / (name + ".glb")).string(), "-o", png,
                                        "--size", "256x256", "--camera", "20,50"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        const auto image = prep::load_image(png);
        EXPECT_TRUE(image);
        return image ? image->pixels : std::vector<float>(1);
    };
    const std::vector<float> truth = picture("truth", {"--max-triangles", "200k"});
    const auto error = [&](const std::vector<float>& other) {
        EXPECT_EQ(other.size(), truth.size());
        double sum = 0;
        for (std::size_t i = 0; i < truth.size(); ++i)
            sum += double(other[i] - truth[i]) * double(other[i] - truth[i]);
        return std::sqrt(sum / double(truth.size()));
    };
    double last = 1e9, last_with = 1e9;
    for (const char* count : {"200", "800", "3200"}) {
        const double bare = error(picture("bare", {"--max-triangles", count}));
        const double with =
            error(picture("with", {"--max-triangles", count, "--residual-normal-map", "512"}));
        EXPECT_LT(with, bare) << count;
        EXPECT_LT(bare, last) << count;
        EXPECT_LT(with, last_with) << count;
        last = bare;
        last_with = with;
    }
}

TEST_F(ResidualMap, GoesIntoEveryKindOfFile) {
    const std::string map = heights("waves.exr", 128);
    const std::vector<std::string> options{"--displace",      map,   "--height-midlevel",     "0",
                                           "--max-triangles", "400", "--residual-normal-map", "64"};
    for (const char* name : {"a.glb", "a.gltf", "a.obj"}) {
        ASSERT_EQ(prepared(obj_of(squares), name, options).exit_code, 0) << name;
        const auto scene = prep::load_scene(dir_ / name);
        ASSERT_TRUE(scene) << to_string(scene.error());
        ASSERT_EQ(scene->materials.size(), 1U) << name;
        ASSERT_TRUE(scene->materials[0].normal_map) << name;
        const auto image = prep::load_image(
            scene->images[scene->textures[scene->materials[0].normal_map.texture].image]);
        ASSERT_TRUE(image) << name;
        EXPECT_EQ(image->width, 64U) << name;
    }
    // A glTF document that is written back gets it as well, with or without a material of its own.
    ASSERT_EQ(prepared(obj_of(squares), "plain.glb", {}).exit_code, 0);
    std::vector<std::string> again{"prepare", (dir_ / "plain.glb").string(), "-o",
                                   (dir_ / "again.glb").string(), "--json"};
    again.insert(again.end(), options.begin(), options.end());
    const test::Ran ran = run_here(again);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const auto scene = prep::load_scene(dir_ / "again.glb");
    ASSERT_TRUE(scene) << to_string(scene.error());
    ASSERT_EQ(scene->materials.size(), 1U);
    EXPECT_TRUE(scene->materials[0].normal_map);
    EXPECT_EQ(scene->meshes[0].face_materials[0], 0U);
    EXPECT_FALSE(scene->meshes[0].tangents.empty());
}

// With textures of its own, heights in the second set of UVs, and its material as it was.
TEST_F(ResidualMap, DocumentsThatAreWrittenBackReadAsWell) {
    ASSERT_TRUE(prep::save_image(
        dir_ / "red.png", {.width = 1, .height = 1, .channels = 3, .pixels = {1.0F, 0.0F, 0.0F}}));
    constexpr std::uint32_t size = 512;
    prep::Image image{.width = size, .height = size, .channels = 1, .pixels = {}};
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x)
            image.pixels.push_back(
                float(0.5 + 20 * waves_.height({(x + 0.5) / size, (y + 0.5) / size})));
    ASSERT_TRUE(prep::save_image(dir_ / "heights.png", image, prep::PixelType::u16));
    write_text(dir_ / "red.mtl", "newmtl red\nmap_Kd red.png\n");
    ASSERT_EQ(
        prepared("mtllib red.mtl\nusemtl red\n" + obj_of(squares), "first.gltf", {}).exit_code, 0);
    json document = json::parse(test::file_text(dir_ / "first.gltf"));
    document["images"].push_back({{"uri", "heights.png"}});
    document["textures"].push_back({{"source", document["images"].size() - 1}});
    document["materials"][0]["extras"]["displacement"] = {
        {"texture", {{"index", document["textures"].size() - 1}, {"texCoord", 1}}},
        {"scale", 0.05},
        {"midlevel", 0.5}};
    json& attributes = document["meshes"][0]["primitives"][0]["attributes"];
    attributes["TEXCOORD_1"] = attributes["TEXCOORD_0"];
    write_text(dir_ / "second.gltf", document.dump());
    for (const char* name : {"again.glb", "again.gltf"}) {
        const test::Ran ran =
            run_here({"prepare", (dir_ / "second.gltf").string(), "-o", (dir_ / name).string(),
                      "--displace", "materials", "--height-filter", "bicubic", "--max-triangles",
                      "1500", "--residual-normal-map", "256"});
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        const auto scene = prep::load_scene(dir_ / name);
        ASSERT_TRUE(scene) << to_string(scene.error());
        ASSERT_TRUE(scene->materials[0].normal_map) << name;
        EXPECT_EQ(scene->materials[0].normal_map.uv_set, 1U) << name;
        EXPECT_TRUE(scene->materials[0].diffuse_map) << name;
        EXPECT_EQ(scene->materials[0].diffuse_map.uv_set, 0U) << name;
        EXPECT_FALSE(scene->materials[0].displacement_map) << name;
        const std::vector<double> found = angles(name, {});
        ASSERT_GT(found.size(), 25'000U) << name;
        EXPECT_LE(p99(found), 1.5) << name;
    }
}

// Rings around a chart, the picture's other side included: each the mean of the one before.
TEST_F(ResidualMap, TexelsAroundChartsContinueThem) {
    waves_ = {.a = 0.1, .f = 3};
    const std::string map = heights("waves.exr", 256);
    const Square square{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0.25}, {0.5, 0}, {0, 0.5}};
    ASSERT_EQ(prepared(obj_of({square}), "chart.glb",
                       {"--displace", map, "--height-midlevel", "0", "--max-triangles", "4",
                        "--residual-normal-map", "256"})
                  .exit_code,
              0);
    const auto scene = prep::load_scene(dir_ / "chart.glb");
    ASSERT_TRUE(scene);
    const auto image = prep::load_image(scene->images[0]);
    ASSERT_TRUE(image);
    int steep = 0;
    for (double y = 72; y < 184; ++y)
        for (const double inside : {0.0, 127.0}) {
            const double step = inside == 0 ? 255 : 1;
            glm::dvec3 mean(0.0);
            for (const double row : {y - 1, y, y + 1})
                mean += glm::normalize(texel(*image, inside, row));
            const auto ring = [&](int k) {
                return texel(*image, std::fmod(inside + k * step, 256.0), y);
            };
            EXPECT_LE(degrees_between(ring(1), mean), 0.1) << y;
            for (const int k : {2, 3})
                EXPECT_LE(degrees_between(ring(k), ring(k - 1)), 2) << k << " " << y;
            steep += degrees_between(mean, {0, 0, 1}) > 20;
        }
    EXPECT_GT(steep, 60) << "a picture that is level there would pass";
}

// Pictures beside an OBJ file are named after it: not over the heights they were made of.
TEST_F(ResidualMap, HeightsAreNotWrittenOver) {
    const std::string map = heights("heights.exr", 64);
    const auto run = [&](const std::string& heights_file) {
        return prepared(obj_of(squares), "rock.obj",
                        {"--displace", heights_file, "--height-midlevel", "0", "--max-triangles",
                         "100", "--residual-normal-map", "16"});
    };
    ASSERT_EQ(run(map).exit_code, 0);
    std::filesystem::path written;
    for (const auto& entry : std::filesystem::directory_iterator(dir_.path()))
        if (entry.path().extension() == ".png") written = entry.path();
    ASSERT_FALSE(written.empty());
    const auto image = prep::load_image(map);
    ASSERT_TRUE(image && prep::save_image(written, *image, prep::PixelType::u16));
    const std::string before = test::file_text(written);
    const test::Ran over = run(written.string());
    EXPECT_EQ(over.exit_code, 1);
    EXPECT_NE(over.err.find(written.filename().string()), std::string::npos) << over.err;
    EXPECT_TRUE(test::file_text(written) == before);
}

TEST_F(ResidualMap, EachDisplacedMaterialHasItsOwn) {
    heights("waves.exr", 128);
    write_text(dir_ / "two.mtl",
               "newmtl raised\ndisp waves.exr\nnewmtl plain\nnewmtl higher\ndisp -mm 0 2 "
               "waves.exr\n");
    std::string obj = "mtllib two.mtl\n" + obj_of(squares);
    std::size_t at = 0;
    for (const char* name : {"raised", "plain", "higher", "higher"}) {
        at = obj.find("\nf ", at) + 1;
        const std::string line = std::string("usemtl ") + name + "\n";
        obj.insert(at, line);
        at += line.size();
    }
    const test::Ran ran = prepared(
        obj, "two.glb",
        {"--displace", "materials", "--max-triangles", "600", "--residual-normal-map", "64"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json maps = ran.json()["files"][0]["residual_maps"];
    ASSERT_EQ(maps.size(), 2U);
    EXPECT_EQ(maps[0]["material_name"], "raised");
    EXPECT_EQ(maps[1]["material_name"], "higher");
    EXPECT_LT(1.5 * maps[0]["texels"].get<double>(), maps[1]["texels"].get<double>());
    const auto scene = prep::load_scene(dir_ / "two.glb");
    ASSERT_TRUE(scene);
    for (const prep::Material& m : scene->materials)
        EXPECT_EQ(bool(m.normal_map), m.name != "plain") << m.name;
}

TEST_F(ResidualMap, FindingsSayWhatIsLeftOut) {
    const std::string map = heights("waves.exr", 128);
    const std::vector<std::string> options{"--displace",      map,   "--height-midlevel",     "0",
                                           "--max-triangles", "400", "--residual-normal-map", "64"};
    // A normal map of the material's own stays.
    ASSERT_TRUE(prep::save_image(
        dir_ / "own.png", {.width = 1, .height = 1, .channels = 3, .pixels = {0.5F, 0.5F, 1.0F}}));
    write_text(dir_ / "own.mtl", "newmtl own\nnorm own.png\n");
    const test::Ran own =
        prepared("mtllib own.mtl\nusemtl own\n" + obj_of(squares), "own.glb", options);
    ASSERT_EQ(own.exit_code, 0) << own.err;
    const json kept = own.json()["files"][0];
    EXPECT_TRUE(has(kept, "no-residual-map"));
    EXPECT_FALSE(kept.contains("residual_maps"));
    const auto scene = prep::load_scene(dir_ / "own.glb");
    ASSERT_TRUE(scene);
    EXPECT_EQ(prep::load_image(scene->images[0])->width, 1U);
    // Charts over each other; beside the picture they are the same charts.
    std::vector<Square> same{squares[0], squares[0]};
    same[1].origin.x += 2;
    for (const double tile : {0.0, 1.0, -3.0}) {
        same[1].uv.x = squares[0].uv.x + tile;
        const test::Ran over = prepared(obj_of(same), "over.glb", options);
        ASSERT_EQ(over.exit_code, 0) << over.err;
        const json file = over.json()["files"][0];
        EXPECT_TRUE(has(file, "residual-overlap")) << tile;
        EXPECT_EQ(file["residual_maps"][0]["overlapping"], file["residual_maps"][0]["texels"]);
    }
    // Alone in another tile it is a chart like any other.
    same.erase(same.begin());
    const test::Ran beside = prepared(obj_of(same), "beside.glb", options);
    EXPECT_FALSE(has(beside.json()["files"][0], "residual-overlap"));
    // So far away in a row of texels that walking there would take an hour.
    const test::Ran far = prepared(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt -900000 0\nvt -899999.5 0\nvt -900000 0.5\nf 1/1 2/2 3/3\n",
        "far.glb", {"--edge-length", "2", "--residual-normal-map", "512"});
    ASSERT_EQ(far.exit_code, 0) << far.err;
    EXPECT_NEAR(far.json()["files"][0]["residual_maps"][0]["texels"].get<double>(), 256 * 256 / 2,
                0.25 * 256 * 256 / 2);
    // A picture that repeats over and over holds no charts.
    same[0].uv_x *= 200;
    const test::Ran tiled = prepared(obj_of(same), "tiled.glb", options);
    ASSERT_EQ(tiled.exit_code, 0) << tiled.err;
    EXPECT_TRUE(has(tiled.json()["files"][0], "no-residual-map"));
    EXPECT_FALSE(tiled.json()["files"][0].contains("residual_maps"));
    // Nor does a mesh without UVs.
    const test::Ran bare = prepared("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "bare.glb",
                                    {"--edge-length", "0.5", "--residual-normal-map", "64"});
    ASSERT_EQ(bare.exit_code, 0) << bare.err;
    EXPECT_TRUE(has(bare.json()["files"][0], "no-residual-map"));
}

TEST_F(ResidualMap, SameBytesWithAnyNumberOfThreads) {
    const std::string map = heights("waves.exr", 256);
    std::string first;
    for (const char* threads : {"1", "2", "5"}) {
        ASSERT_EQ(prepared(obj_of(squares), "t.glb",
                           {"--displace", map, "--height-midlevel", "0", "--max-triangles", "900",
                            "--residual-normal-map", "200", "--threads", threads})
                      .exit_code,
                  0);
        const std::string bytes = test::file_text(dir_ / "t.glb");
        if (first.empty()) first = bytes;
        EXPECT_TRUE(bytes == first) << threads;
    }
}

TEST_F(ResidualMap, MistakesAreUsageErrors) {
    for (const auto& [options, says] :
         {std::pair(std::vector<std::string>{"--residual-normal-map", "0"}, "8192"),
          std::pair(std::vector<std::string>{"--residual-normal-map", "9000"}, "8192"),
          std::pair(std::vector<std::string>{"--residual-normal-map", "2.5"}, "2.5"),
          std::pair(std::vector<std::string>{"--residual-bits", "8"}, "--residual-normal-map"),
          std::pair(
              std::vector<std::string>{"--residual-normal-map", "64", "--residual-bits", "12"},
              "12")}) {
        const test::Ran ran = prepared(obj_of(squares), "no.glb", options);
        EXPECT_EQ(ran.exit_code, 2) << ran.err;
        EXPECT_NE(ran.err.find(says), std::string::npos) << ran.err;
    }
    const test::Ran off =
        prepared(obj_of(squares), "no.glb", {"--residual-normal-map", "64", "--tangents", "none"});
    EXPECT_EQ(off.exit_code, 1) << off.err;
}

}  // namespace
