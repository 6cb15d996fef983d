// What `render --buffers` writes, value by value, against rays through the pixels' centres that are
// worked out here.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <numbers>

#include "command_runner.h"
#include "prep/image.h"

namespace {

using test::run_here;
using test::TempDir;
using test::write_text;

constexpr std::uint32_t none = 0xffffffffu;

// A picture's channels by name.
struct Picture {
    prep::Image image;
    std::map<std::string, std::uint32_t> channel;
    float at(const char* name, std::uint32_t x, std::uint32_t y) const {
        return image.at(x, y)[channel.at(name)];
    }
    std::uint32_t integer(const char* name, std::uint32_t x, std::uint32_t y) const {
        const std::size_t pixel = std::size_t(y) * image.width + x;
        return image.integers[pixel * image.channels + channel.at(name)];
    }
};
Picture load(const std::filesystem::path& path) {
    Picture out;
    auto image = prep::load_image(path, prep::ImageChannels::all);
    EXPECT_TRUE(image) << to_string(image.error());
    if (!image) return out;
    out.image = *std::move(image);
    for (std::uint32_t k = 0; k < out.image.channels; ++k)
        out.channel[out.image.channel_names[k]] = k;
    return out;
}

void render(const std::filesystem::path& in, const std::filesystem::path& out,
            const std::vector<std::string>& more) {
    std::vector<std::string> all = {"render", in.string(), "-o", out.string(), "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    const test::Ran ran = run_here(all);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
}

// A triangle's barycentrics of a point in the plane of two of its axes.
glm::dvec3 barycentrics(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b,
                        const glm::dvec2& c) {
    const auto area = [](const glm::dvec2& u, const glm::dvec2& v, const glm::dvec2& w) {
        return (v.x - u.x) * (w.y - u.y) - (v.y - u.y) * (w.x - u.x);
    };
    const double all = area(a, b, c);
    return {area(p, b, c) / all, area(p, c, a) / all, area(p, a, b) / all};
}

// Seven triangles in three meshes, flat, beside each other: every pixel knows its own.
TEST(RenderBuffers, IdsAreTheTriangleInItsMeshAndTheNode) {
    const TempDir dir;
    struct Placed {
        std::uint32_t node, triangle;
        glm::dvec2 corners[3];
    };
    std::vector<Placed> placed;
    test::GltfText gltf;
    const std::size_t counts[] = {1, 4, 2};
    double x = -4;
    for (std::uint32_t m = 0; m < 3; ++m) {
        std::vector<float> positions;
        std::vector<std::uint32_t> indices;
        for (std::uint32_t t = 0; t < counts[m]; ++t) {
            // The last triangle of a mesh is the leftmost: its number is no place.
            const double left = x + 1.0 * double(counts[m] - 1 - t);
            const glm::dvec2 corners[3] = {{left, -0.9}, {left + 0.95, -0.7}, {left + 0.3, 0.9}};
            placed.push_back({m, t, {corners[0], corners[1], corners[2]}});
            for (const glm::dvec2& c : corners) {
                indices.push_back(std::uint32_t(positions.size() / 3));
                positions.insert(positions.end(), {float(c.x - 0.5 * m), float(c.y), 0.0f});
            }
        }
        x += double(counts[m]);
        const std::string node =
            m == 0 ? "" : R"("translation":[)" + std::to_string(0.5 * m) + ",0,0]";
        gltf.add({"m", positions, {}, {}, {}, indices, "", node});
    }
    write_text(dir / "a.gltf", gltf.text());
    render(dir / "a.gltf", dir / "a.png",
           {"--size", "80x20", "--look-from=-0.5,0,5", "--look-at=-0.5,0,0", "--ortho", "2",
            "--buffers", "id"});
    const Picture id = load(dir / "a.id.exr");
    ASSERT_EQ(id.channel.size(), 2u);
    EXPECT_EQ(id.image.integer_channels, 3u);  // both are integers
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> seen;
    for (std::uint32_t j = 0; j < 20; ++j)
        for (std::uint32_t i = 0; i < 80; ++i) {
            const glm::dvec2 p((i + 0.5) / 10 - 4.5, 1 - (j + 0.5) / 10);
            std::pair<std::uint32_t, std::uint32_t> expected{none, none};
            bool near_edge = false;
            for (const Placed& t : placed) {
                const glm::dvec3 b = barycentrics(p, t.corners[0], t.corners[1], t.corners[2]);
                const double least = std::min({b.x, b.y, b.z});
                near_edge |= std::abs(least) < 0.01;
                if (least > 0) expected = {t.triangle, t.node};
            }
            if (near_edge) continue;
            ++seen[expected];
            EXPECT_EQ(id.integer("triangle", i, j), expected.first) << i << " " << j;
            EXPECT_EQ(id.integer("instance", i, j), expected.second) << i << " " << j;
        }
    EXPECT_EQ(seen.size(), 8u);  // all triangles, and nothing
}

// Two triangles of a slanted rectangle, with a normal and a UV of its own at every corner.
const glm::dvec3 corners[4] = {
    {-1.5, -1, 0.75}, {1.5, -1, -0.75}, {1.5, 1, -0.75}, {-1.5, 1, 0.75}};
const glm::dvec3 normals[4] = {{0, 0, 1}, {0.6, 0, 0.8}, {0, 0.6, 0.8}, {0.48, 0.6, 0.64}};
const glm::dvec2 uvs[4] = {{0.1, 0.2}, {0.9, 0.3}, {0.8, 0.7}, {0.2, 0.6}};
const std::size_t faces[2][3] = {{1, 2, 0}, {3, 0, 2}};

std::string slanted() {
    std::string text;
    char line[200];
    for (int i = 0; i < 4; ++i) {
        std::snprintf(line, sizeof line, "v %g %g %g\nvn %g %g %g\nvt %g %g\n", corners[i].x,
                      corners[i].y, corners[i].z, normals[i].x, normals[i].y, normals[i].z,
                      uvs[i].x, 1 - uvs[i].y);  // OBJ's origin is at the bottom
        text += line;
    }
    for (const auto& f : faces) {
        text += "f";
        for (const std::size_t v : f) {
            const std::string n = std::to_string(v + 1);
            text += " " + n + "/" + n + "/" + n;
        }
        text += "\n";
    }
    return text;
}

// A camera from its definition: where it stands, its axes, half a picture's height at distance 1.
struct Eye {
    glm::dvec3 eye, right, up, back;
    double half = 0;
    Eye(const glm::dvec3& from, const glm::dvec3& at, double fov_degrees) : eye(from) {
        back = glm::normalize(from - at);
        right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
        up = glm::cross(back, right);
        half = std::tan(fov_degrees / 2 * std::numbers::pi / 180);
    }
    glm::dvec3 ray(double x, double y, double width, double height) const {
        return right * ((2 * x / width - 1) * half * width / height) +
               up * ((1 - 2 * y / height) * half) - back;
    }
};

// What is at a pixel of the slanted rectangle; nothing where the ray misses or grazes an edge.
struct Hit {
    bool hit = false, near_edge = false;
    std::uint32_t triangle = none;
    double distance = 0;  // along the view
    glm::dvec3 position, barycentric, normal;
    glm::dvec2 uv;
};
Hit trace(const glm::dvec3& from, const glm::dvec3& ray) {
    const glm::dvec3 normal =
        glm::cross(corners[1] - corners[0], corners[2] - corners[0]);  // of the plane
    Hit out;
    out.distance = glm::dot(corners[0] - from, normal) / glm::dot(ray, normal);
    out.position = from + ray * out.distance;
    const auto flat = [](const glm::dvec3& p) { return glm::dvec2(p.x, p.y); };
    for (std::uint32_t t = 0; t < 2; ++t) {
        const std::size_t* f = faces[t];
        const glm::dvec3 b = barycentrics(flat(out.position), flat(corners[f[0]]),
                                          flat(corners[f[1]]), flat(corners[f[2]]));
        const double least = std::min({b.x, b.y, b.z});
        out.near_edge |= std::abs(least) < 0.02;
        if (least < 0) continue;
        out.hit = true;
        out.triangle = t;
        out.barycentric = b;
        out.normal =
            glm::normalize(b.x * normals[f[0]] + b.y * normals[f[1]] + b.z * normals[f[2]]);
        out.uv = b.x * uvs[f[0]] + b.y * uvs[f[1]] + b.z * uvs[f[2]];
    }
    return out;
}

TEST(RenderBuffers, PerspectiveValuesAreThoseOfTheRays) {
    const TempDir dir;
    write_text(dir / "a.obj", slanted());
    const std::uint32_t width = 48, height = 36;
    const std::vector<std::string> view = {"--size",    "48x36",         "--look-from", "1,2,3.5",
                                           "--look-at", "0.25,-0.125,0", "--fov",       "40",
                                           "--cull",    "none"};
    std::vector<std::string> all = view;
    all.insert(all.end(), {"--buffers", "all"});
    render(dir / "a.obj", dir / "a.png", all);
    std::map<std::string, Picture> files;
    for (const char* name : {"depth", "id", "normal", "uv", "barycentric", "position"})
        files[name] = load(dir / ("a." + std::string(name) + ".exr"));
    const Eye eye({1, 2, 3.5}, {0.25, -0.125, 0}, 40);
    double nearest = 1e9;  // of the scene's box
    for (int k = 0; k < 8; ++k) {
        const glm::dvec3 corner(k & 1 ? 1.5 : -1.5, k & 2 ? 1 : -1, k & 4 ? 0.75 : -0.75);
        nearest = std::min(nearest, glm::dot(eye.eye - corner, eye.back));
    }
    int hits[2] = {0, 0};
    // Corners lie on the grid of 1/256 pixels: half a step of it is 1.4e-4 of the picture's height
    // at distance 4, slanted surfaces lengthen that.
    const double near = 1e-3;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            SCOPED_TRACE(std::to_string(x) + " " + std::to_string(y));
            const Hit hit = trace(eye.eye, eye.ray(x + 0.5, y + 0.5, width, height));
            if (hit.near_edge) continue;
            const auto at = [&](const char* file, const char* channel) {
                return double(files[file].at(channel, x, y));
            };
            EXPECT_EQ(files["id"].integer("triangle", x, y), hit.triangle);
            EXPECT_EQ(files["id"].integer("instance", x, y), hit.hit ? 0 : none);
            if (!hit.hit) {
                EXPECT_TRUE(std::isinf(at("depth", "Z")) && at("depth", "Z") > 0);
                EXPECT_EQ(at("depth", "depth"), 0.0);
                for (const auto& [file, channels] :
                     {std::pair{"normal", "N"}, {"barycentric", "B"}, {"position", "P"}})
                    for (const char* axis : {".X", ".Y", ".Z"})
                        EXPECT_EQ(at(file, (std::string(channels) + axis).c_str()), 0.0) << file;
                EXPECT_EQ(at("uv", "UV.U"), 0.0);
                continue;
            }
            ++hits[hit.triangle];
            EXPECT_NEAR(at("depth", "Z"), hit.distance, 2 * near);
            // 1 at the near plane, 0 infinitely far.
            EXPECT_NEAR(at("depth", "depth"), 0.99 * nearest / hit.distance, near);
            const char* axes[] = {"X", "Y", "Z"};
            for (int k = 0; k < 3; ++k) {
                const auto of = [&](const char* letter) {
                    return std::string(letter) + "." + axes[k];
                };
                EXPECT_NEAR(at("position", of("P").c_str()), hit.position[k], 2 * near) << k;
                EXPECT_NEAR(at("barycentric", of("B").c_str()), hit.barycentric[k], near) << k;
                EXPECT_NEAR(at("normal", of("N").c_str()), hit.normal[k], near) << k;
            }
            EXPECT_NEAR(at("uv", "UV.U"), hit.uv.x, near);
            EXPECT_NEAR(at("uv", "UV.V"), hit.uv.y, near);
        }
    EXPECT_GT(hits[0], 100);
    EXPECT_GT(hits[1], 100);

    // All of them in one file: the same numbers, channel by channel.
    all.insert(all.end(), {"--buffer-file", (dir / "one.exr").string()});
    render(dir / "a.obj", dir / "b.png", all);
    const Picture one = load(dir / "one.exr");
    EXPECT_EQ(one.channel.size(), 2u + 2 + 3 + 2 + 3 + 3);
    for (const auto& [name, file] : files)
        for (const auto& [channel, k] : file.channel) {
            ASSERT_EQ(one.channel.count(channel), 1u) << channel;
            bool same = true;
            for (std::uint32_t y = 0; y < height; ++y)
                for (std::uint32_t x = 0; x < width; ++x)
                    same = same && (name == "id" ? one.integer(channel.c_str(), x, y) ==
                                                       file.integer(channel.c_str(), x, y)
                                                 : one.at(channel.c_str(), x, y) ==
                                                       file.at(channel.c_str(), x, y));
            EXPECT_TRUE(same) << channel;
        }
    EXPECT_EQ(one.image.integer_channels,
              1u << one.channel.at("triangle") | 1u << one.channel.at("instance"));
}

TEST(RenderBuffers, WithoutPerspectiveDepthFallsEvenly) {
    const TempDir dir;
    write_text(dir / "a.obj", slanted());
    // From behind: the normals that are lit point to the eye.
    render(dir / "a.obj", dir / "a.png",
           {"--size", "48x32", "--look-from", "0,0,-4", "--look-at", "0,0,0", "--ortho", "2.5",
            "--cull", "none", "--buffers", "depth,normal"});
    const Picture depth = load(dir / "a.depth.exr"), normal = load(dir / "a.normal.exr");
    const auto at = [&](std::uint32_t x) { return depth.at("depth", x, 16); };
    const auto z = [&](std::uint32_t x) { return depth.at("Z", x, 16); };
    // Seen from behind, x runs to the left: 2.5 / 32 a pixel, and z = −x / 2.
    for (const std::uint32_t i : {10u, 24u, 38u}) {
        const double x = -((i + 0.5) - 24) * 2.5 / 32;
        EXPECT_NEAR(double(z(i)), 4 - x / 2, 1e-3) << i;
    }
    EXPECT_NEAR(double(at(10) - at(24)) / double(at(10) - at(38)),
                double(z(24) - z(10)) / double(z(38) - z(10)), 1e-4);
    EXPECT_GT(std::max(at(10), at(38)), std::min(at(10), at(38)) + 0.3f);
    EXPECT_EQ(at(10) > at(38), z(10) < z(38));
    for (std::uint32_t x = 8; x < 40; ++x) EXPECT_LT(normal.at("N.Z", x, 16), 0) << x;
}

// k / 2^16 is what sixteen bits hold.
TEST(RenderBuffers, DepthOfSixteenBitsHasTheirSteps) {
    const TempDir dir;
    write_text(dir / "a.obj", slanted());
    for (const auto& [word, bits] : {std::pair{"fixed16", 16}, {"fixed24", 24}, {"float", 0}}) {
        render(dir / "a.obj", dir / "a.png",
               {"--size", "32x24", "--look-from", "0,0,4", "--look-at", "0,0,0", "--cull", "none",
                "--buffers", "depth", "--depth", word});
        const Picture depth = load(dir / "a.depth.exr");
        int whole16 = 0, whole24 = 0, seen = 0;
        for (std::uint32_t y = 0; y < 24; ++y)
            for (std::uint32_t x = 0; x < 32; ++x) {
                const double d = double(depth.at("depth", x, y));
                if (d == 0) continue;
                ++seen;
                whole16 += d * 0x1p16 == std::floor(d * 0x1p16);
                whole24 += d * 0x1p24 == std::floor(d * 0x1p24);
            }
        ASSERT_GT(seen, 100);
        EXPECT_EQ(whole16 == seen, bits == 16) << word;
        EXPECT_TRUE(bits == 0 || whole24 == seen) << word;
    }
}

// Where a marker stands in the picture: the mean of its pixels, and its nearest distance.
struct Seen {
    double column = 0, distance = 0;
    int pixels = 0;
};
Seen marker(const TempDir& dir, const std::string& stem) {
    const Picture picture = load(dir / (stem + ".exr"));
    Seen out;
    out.distance = 1e9;
    for (std::uint32_t y = 0; y < picture.image.height; ++y)
        for (std::uint32_t x = 0; x < picture.image.width; ++x) {
            const std::uint32_t t = picture.integer("triangle", x, y);
            if (t >= 4) continue;  // the other one, or nothing
            const double z = double(picture.at("Z", x, y));
            out.column += x + 0.5;
            out.distance = std::min(out.distance, z);
            ++out.pixels;
        }
    out.column = out.pixels > 0 ? out.column / out.pixels / picture.image.width : -1;
    return out;
}

// Something at +x above, something at −x below. From +z the marker is on the right; a camera that
// goes eastwards comes to +x, where the marker is near, then to −z, where it is on the left.
TEST(RenderTurntable, GoesEastwardsWhateverTheCamera) {
    const TempDir dir;
    test::GltfText gltf;
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;
    for (const float side : {1.0f, -1.0f}) {
        const auto base = std::uint32_t(positions.size() / 3);
        constexpr float tetrahedron[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
        for (const auto& p : tetrahedron)
            positions.insert(positions.end(), {3 * side + p[0] / 2, side + p[1] / 2, p[2] / 2});
        for (const std::uint32_t i : {0u, 1u, 2u, 0u, 3u, 1u, 0u, 2u, 3u, 1u, 3u, 2u})
            indices.push_back(base + i);
    }
    gltf.add({"m", positions, {}, {}, {}, indices, "\"material\":0", ""});
    const std::string materials = R"("materials":[{"doubleSided":true}])";
    write_text(dir / "a.gltf", gltf.text(materials));
    test::GltfText with_camera;
    with_camera.add({"m", positions, {}, {}, {}, indices, "\"material\":0", R"("children":[1])"});
    std::string text = with_camera.text(
        materials +
        R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}}])");
    const std::string child = R"("children":[1]})";
    text.insert(text.find(child) + child.size(), R"(,{"camera":0,"translation":[0,0,12]})");
    write_text(dir / "camera.gltf", text);
    for (const auto& [file, options] :
         std::vector<std::pair<const char*, std::vector<std::string>>>{
             {"a.gltf", {"--camera", "0,0"}},
             {"a.gltf", {"--camera", "0,0", "--ortho", "fit"}},
             {"a.gltf", {"--look-from", "0,0,12"}},
             {"a.gltf", {"--look-from", "12,0,0"}},  // begins in the east
             {"a.gltf", {"--look-from", "0,0,12", "--look-at", "0,0,0", "--up", "0,1,0"}},
             {"camera.gltf", {}}}) {
        std::vector<std::string> words = options;
        words.insert(words.end(), {"--turntable", "4", "--size", "40x40", "--buffers", "id,depth",
                                   "--buffer-file", (dir / "t.%d.exr").string()});
        render(dir / file, dir / "t.png", words);
        SCOPED_TRACE(std::string(file) + (options.empty() ? "" : " " + options[0]));
        Seen s[4];
        for (int n = 0; n < 4; ++n) {
            const bool from_the_east = options.size() == 2 && options[1] == "12,0,0";
            Seen& seen = s[(n + (from_the_east ? 1 : 0)) % 4];
            seen = marker(dir, "t." + std::to_string(n));
            ASSERT_GT(seen.pixels, 0) << n;
        }
        EXPECT_GT(s[0].column, 0.6);
        EXPECT_NEAR(s[1].column, 0.5, 0.1);
        EXPECT_LT(s[2].column, 0.4);
        EXPECT_NEAR(s[3].column, 0.5, 0.1);
        // Three to the eye's side of the middle, then three beyond it.
        EXPECT_NEAR(s[3].distance - s[1].distance, 6, 0.3);
        EXPECT_NEAR(s[0].distance, s[2].distance, 0.3);
        EXPECT_NEAR(s[0].distance - s[1].distance, 3, 0.3);
    }
}

}  // namespace
