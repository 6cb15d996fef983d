// Whole pictures: the same bytes however they are made, samples, crops, buffers, broken input.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "oracles.h"
#include "shapes.h"
#include "simd_levels.h"

namespace {

using namespace test;

bool same_bytes(const rast::Frame& a, const rast::Frame& b) {
    return a.color.size() == b.color.size() && a.depth.size() == b.depth.size() &&
           std::memcmp(a.color.data(), b.color.data(), a.color.size() * sizeof(glm::vec4)) == 0 &&
           std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * sizeof(float)) == 0 &&
           a.triangle == b.triangle && a.instance == b.instance && a.normal == b.normal &&
           a.uv == b.uv && a.barycentric == b.barycentric && a.position == b.position;
}

TEST(Rendering, GivesTheSameBytesOnAnyThreadsAndInstructions) {
    prep::Material material;
    material.normal_map.texture = 0;
    prep::VertexMesh mesh = test::sphere(400, 200);
    for (const glm::vec3& n : mesh.normals)
        mesh.tangents.push_back(
            glm::vec4(glm::normalize(glm::cross(glm::vec3(0.1f, 1, 0.2f), n)), 1.0f));
    prep::PreparedScene scene = test::scene_of(mesh, material);
    // A second one through the first: equal depths and many chunks.
    prep::Node node = scene.scene.nodes[0];
    node.transform[3] = glm::dvec4(0.4, 0.1, 0, 1);
    scene.scene.nodes.push_back(node);
    scene.scene.nodes.push_back(scene.scene.nodes[0]);
    scene.scene.images.push_back(image_of({0.6f, 0.45f, 0.9f}, 8));
    prep::Texture texture;
    texture.image = 0;
    scene.scene.textures.push_back(texture);
    for (const Shading shading :
         {Shading::flat, Shading::gouraud, Shading::phong, Shading::normal_mapped}) {
        rast::RenderRequest request;
        request.width = 333;
        request.height = 217;
        request.shading = shading;
        request.keep_depth = request.keep_ids = request.keep_normals = request.keep_uvs = true;
        request.keep_barycentrics = request.keep_positions = true;
        for (const int samples : {1, 4}) {
            request.samples = samples;
            request.threads = 1;
            request.simd = prep::SimdLevel::scalar;
            const rast::Frame one = test::draw(scene, request);
            EXPECT_GT(one.counters.pixels_shaded, 1000u);
            for (const int threads : {2, 8}) {
                request.threads = threads;
                EXPECT_TRUE(same_bytes(one, test::draw(scene, request))) << threads;
            }
            for (const prep::SimdLevel level : test::every_level()) {
                request.simd = level;
                EXPECT_TRUE(same_bytes(one, test::draw(scene, request)))
                    << prep::to_string(level) << " " << int(shading) << " " << samples;
            }
        }
    }
}

// Standard sample positions in sixteenths of a pixel from its corner (Direct3D 11.3, Vulkan 1.3).
std::vector<glm::ivec2> standard_positions(int samples) {
    switch (samples) {
        case 2:
            return {{12, 12}, {4, 4}};
        case 4:
            return {{6, 2}, {14, 6}, {2, 10}, {10, 14}};
        case 8:
            return {{9, 5}, {7, 11}, {13, 9}, {5, 3}, {3, 13}, {1, 7}, {11, 15}, {15, 1}};
        case 16:
            return {{9, 9},  {7, 5}, {5, 10}, {12, 7}, {3, 6}, {10, 13}, {13, 11}, {11, 3},
                    {6, 14}, {8, 1}, {4, 2},  {2, 12}, {0, 8}, {15, 4},  {14, 15}, {1, 0}};
        default:
            return {{8, 8}};
    }
}

TEST(Multisampling, PixelsAreTheShareOfTheirStandardSamples) {
    std::mt19937_64 random(11);
    std::size_t partial = 0;
    for (const int samples : {1, 2, 4, 8, 16})
        for (int n = 0; n < 20; ++n) {
            // One unit is a pixel; y up. Corners on the grid of 1/256 pixels, in 1/256.
            glm::i64vec2 corner[3];
            for (glm::i64vec2& c : corner)
                c = {std::int64_t(random() % 8192) - 4096, std::int64_t(random() % 8192) - 4096};
            const auto side = [](const glm::i64vec2& a, const glm::i64vec2& b,
                                 const glm::i64vec2& p) {
                return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
            };
            if (side(corner[0], corner[1], corner[2]) <= 0) std::swap(corner[1], corner[2]);
            prep::VertexMesh mesh;
            for (const glm::i64vec2& c : corner)
                mesh.positions.push_back({float(c.x) / 256, float(c.y) / 256, 0});
            mesh.indices = {0, 1, 2};
            prep::Material material = white();
            material.unlit = true;
            rast::RenderRequest request;
            request.width = request.height = 32;
            request.samples = samples;
            request.view = test::flat_view(16);
            const rast::Frame frame = test::draw(test::scene_of(mesh, material), request);
            std::uint64_t touched = 0;
            for (std::uint32_t y = 0; y < 32; ++y)
                for (std::uint32_t x = 0; x < 32; ++x) {
                    int inside = 0, on_edge = 0;
                    for (const glm::ivec2& s : standard_positions(samples)) {
                        const glm::i64vec2 p(std::int64_t(x) * 256 + s.x * 16 - 4096,
                                             4096 - std::int64_t(y) * 256 - s.y * 16);
                        std::int64_t least = side(corner[0], corner[1], p);
                        least = std::min(least, side(corner[1], corner[2], p));
                        least = std::min(least, side(corner[2], corner[0], p));
                        inside += least > 0;
                        on_edge += least == 0;
                    }
                    touched += inside > 0;
                    if (on_edge > 0) continue;
                    // Shares of 1/16 are exact.
                    ASSERT_EQ(frame.color[y * 32 + x], glm::vec4(float(inside) / float(samples)))
                        << samples << ": " << x << " " << y;
                    partial += inside > 0 && inside < samples;
                }
            // Once per triangle and pixel, however many samples it covers.
            EXPECT_NEAR(double(frame.counters.pixels_shaded), double(touched), 4);
        }
    EXPECT_GT(partial, 1000u);
}

TEST(Multisampling, OtherCountsAreAnError) {
    const prep::PreparedScene nothing;
    for (const int samples : {-1, 0, 3, 5, 32}) {
        rast::RenderRequest request;
        request.samples = samples;
        EXPECT_FALSE(rast::plan(nothing, request)) << samples;
    }
}

// A scene with many draws, a floor through the near plane, and textures.
prep::PreparedScene busy_scene() {
    prep::Material material;
    material.normal_map.texture = 0;
    material.double_sided = true;
    prep::VertexMesh mesh = test::sphere(60, 30);
    for (const glm::vec3& n : mesh.normals)
        mesh.tangents.push_back(
            glm::vec4(glm::normalize(glm::cross(glm::vec3(0.1f, 1, 0.2f), n)), 1.0f));
    prep::PreparedScene scene = test::scene_of(mesh, material);
    scene.scene.images.push_back(image_of({0.6f, 0.45f, 0.9f}, 8));
    prep::Texture texture;
    texture.image = 0;
    scene.scene.textures.push_back(texture);
    for (int i = 0; i < 4; ++i) {
        prep::Node node = scene.scene.nodes[0];
        node.transform[3] = glm::dvec4(0.7 * i - 1, 0.3 * i, -0.5 * i, 1);
        scene.scene.nodes.push_back(node);
    }
    prep::VertexMesh floor = square();
    floor.positions = {{-90, -1, 40}, {90, -1, 40}, {90, -1, -90}, {-90, -1, -90}};
    floor.normals.assign(4, {0, 1, 0});
    floor.ranges.push_back({0, 2, 0, prep::no_index});
    scene.meshes.push_back(floor);
    scene.scene.meshes.emplace_back();
    prep::Node node;
    node.mesh = 1;
    scene.scene.nodes.push_back(node);
    return scene;
}

TEST(Crops, JoinToTheWholePictureBitForBit) {
    const prep::PreparedScene scene = busy_scene();
    for (const int samples : {1, 8}) {
        rast::RenderRequest request;
        request.width = 301;
        request.height = 187;
        request.samples = samples;
        request.view = test::look_at({0.5, 0.8, 4}, {0, 0, 0});
        request.keep_depth = request.keep_ids = request.keep_normals = true;
        const rast::Frame whole = test::draw(scene, request);
        std::size_t compared = 0;
        const std::uint32_t cuts_x[] = {0, 1, 77, 200, 301}, cuts_y[] = {0, 63, 64, 150, 187};
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i) {
                const rast::Crop crop{cuts_x[i], cuts_y[j], cuts_x[i + 1] - cuts_x[i],
                                      cuts_y[j + 1] - cuts_y[j]};
                request.crop = crop;
                const rast::Frame part = test::draw(scene, request);
                ASSERT_EQ(part.width, crop.width);
                for (std::uint32_t y = 0; y < crop.height; ++y)
                    for (std::uint32_t x = 0; x < crop.width; ++x) {
                        const std::size_t a = std::size_t(y) * crop.width + x;
                        const std::size_t b = std::size_t(y + crop.y) * 301 + x + crop.x;
                        ASSERT_EQ(part.color[a], whole.color[b]) << samples;
                        ASSERT_EQ(part.depth[a], whole.depth[b]);
                        ASSERT_EQ(part.triangle[a], whole.triangle[b]);
                        ASSERT_EQ(part.normal[a], whole.normal[b]);
                        ++compared;
                    }
            }
        EXPECT_EQ(compared, std::size_t(301 * 187));
        EXPECT_GT(whole.counters.crossing, 0u);
    }
}

TEST(Crops, MustBePartsOfThePicture) {
    const prep::PreparedScene nothing;
    rast::RenderRequest request;
    request.width = request.height = 10;
    for (const rast::Crop crop :
         {rast::Crop{0, 0, 0, 5}, {6, 0, 5, 5}, {0, 0xffffffffu, 1, 1}, {11, 0, 0xffffffffu, 1}}) {
        request.crop = crop;
        EXPECT_FALSE(rast::plan(nothing, request));
    }
    request.crop = rast::Crop{9, 9, 1, 1};
    EXPECT_TRUE(rast::plan(nothing, request));
}

TEST(Buffers, HoldWhatRaysMeet) {
    const prep::VertexMesh mesh = test::sphere(24, 12);
    prep::PreparedScene scene = test::scene_of(mesh, white());
    scene.scene.nodes[0].transform[3] = glm::dvec4(10, 20, 30, 1);
    rast::RenderRequest request;
    request.width = 120;
    request.height = 90;
    request.shading = Shading::phong;
    request.view = test::look_at({10.5, 21, 33}, {10, 20, 30});
    request.keep_ids = request.keep_normals = request.keep_uvs = true;
    request.keep_barycentrics = request.keep_positions = true;
    const rast::Frame frame = test::draw(scene, request);
    std::size_t compared = 0;
    for (std::uint32_t y = 0; y < frame.height; ++y)
        for (std::uint32_t x = 0; x < frame.width; ++x) {
            const std::size_t at = std::size_t(y) * frame.width + x;
            const std::uint32_t t = frame.triangle[at];
            if (t == prep::no_index) {
                ASSERT_EQ(frame.normal[at], glm::vec3(0));
                continue;
            }
            glm::dvec3 p[3], n(0.0);
            glm::dvec2 uv(0.0);
            for (int k = 0; k < 3; ++k)
                p[k] = glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]) + glm::dvec3(10, 20, 30);
            const Ray ray = ray_at(*request.view, frame.width, frame.height, x + 0.5, y + 0.5);
            const glm::dvec3 w = weights_at(ray, p);
            for (int k = 0; k < 3; ++k) {
                n += w[k] * glm::dvec3(mesh.normals[mesh.indices[3 * t + k]]);
                uv += w[k] * glm::dvec2(mesh.uvs[0][mesh.indices[3 * t + k]]);
            }
            const glm::dvec3 hit = w[0] * p[0] + w[1] * p[1] + w[2] * p[2];
            // Grazing triangles are narrow: snapping by 1/512 pixel moves far on them.
            const glm::dvec3 face = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
            if (-glm::dot(face, glm::normalize(ray.direction)) < 0.3) continue;
            ASSERT_LT(distance(glm::dvec3(frame.barycentric[at]), w), 5e-3);
            ASSERT_LT(distance(glm::dvec3(frame.position[at]) + ray.from, hit), 1e-3);
            ASSERT_LT(distance(glm::dvec3(frame.normal[at]), glm::normalize(n)), 2e-3);
            ASSERT_LT(distance(glm::dvec3(glm::vec3(frame.uv[at], 0)), glm::dvec3(uv, 0)), 1e-3);
            ++compared;
        }
    EXPECT_GT(compared, 2000u);
}

TEST(Buffers, AreAbsentWhenNotAskedFor) {
    rast::RenderRequest request;
    request.width = request.height = 16;
    const rast::Frame frame = test::draw(test::scene_of(square(), white()), request);
    EXPECT_TRUE(frame.depth.empty() && frame.triangle.empty() && frame.instance.empty());
    EXPECT_TRUE(frame.normal.empty() && frame.uv.empty());
    EXPECT_TRUE(frame.barycentric.empty() && frame.position.empty());
}

TEST(Rendering, EmptyAndBrokenScenesGiveTheBackground) {
    rast::RenderRequest request;
    request.width = 8;
    request.height = 4;
    request.background = {0.25f, 0.5f, 1};
    prep::PreparedScene nothing;
    for (const glm::vec4& c : test::draw(nothing, request).color)
        EXPECT_EQ(c, glm::vec4(0.25f, 0.5f, 1, 0));
    const prep::PreparedScene broken =
        test::scene_of(triangle({NAN, 0, 0}, {1, INFINITY, 0}, {0, 1, 0}));
    const rast::Frame frame = test::draw(broken, request);
    EXPECT_EQ(frame.counters.non_finite, 1u);
    for (const glm::vec4& c : frame.color) EXPECT_EQ(c, glm::vec4(0.25f, 0.5f, 1, 0));
    // A point, thrice.
    EXPECT_EQ(test::draw(test::scene_of(triangle({1, 1, 1}, {1, 1, 1}, {1, 1, 1})), request)
                  .counters.pixels_shaded,
              0u);
}

TEST(Rendering, PictureWithoutExtentOrTooLargeIsAnError) {
    const prep::PreparedScene nothing;
    rast::RenderRequest request;
    request.width = 0;
    EXPECT_FALSE(rast::plan(nothing, request));
    request.width = rast::max_picture_extent + 1;
    EXPECT_FALSE(rast::plan(nothing, request));
}

}  // namespace
