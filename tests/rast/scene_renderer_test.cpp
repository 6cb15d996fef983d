// Pictures drawn one after another, as bytes, and with what is hidden left out early: all the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "builders.h"
#include "prep/image.h"
#include "simd_levels.h"

namespace {

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}
bool same_pictures(const rast::Frame& a, const rast::Frame& b) {
    return same(a.color, b.color) && same(a.bytes, b.bytes) && same(a.depth, b.depth) &&
           same(a.triangle, b.triangle) && same(a.instance, b.instance) && same(a.normal, b.normal);
}

// Spheres behind each other: most of every tile's triangles are hidden, submitted from front to
// back or the other way round.
prep::PreparedScene row_of_spheres(bool front_first) {
    prep::PreparedScene scene = test::scene_of(test::sphere(60, 40));
    prep::Node node = scene.scene.nodes[0];
    scene.scene.nodes.clear();
    for (int i = 0; i < 6; ++i) {
        node.transform = glm::dmat4(1.0);
        node.transform[3] = glm::dvec4(0.03 * i, 0.02 * i, (front_first ? -1 : 1) * 0.15 * i, 1);
        scene.scene.nodes.push_back(node);
    }
    scene.scene.nodes.push_back(scene.scene.nodes[0]);  // equal depths
    return scene;
}

TEST(HierarchicalDepth, ChangesNoByte) {
    for (const bool front_first : {false, true}) {
        const prep::PreparedScene scene = row_of_spheres(front_first);
        rast::RenderRequest request;
        request.width = 150;
        request.height = 130;
        request.keep_depth = request.keep_ids = true;
        for (const rast::DepthFormat format :
             {rast::DepthFormat::float32, rast::DepthFormat::fixed24, rast::DepthFormat::fixed16})
            for (const int samples : {1, 4})
                for (const prep::SimdLevel level :
                     {prep::SimdLevel::scalar, prep::SimdLevel::automatic}) {
                    request.depth_format = format;
                    request.samples = samples;
                    request.simd = level;
                    request.hierarchical_z = true;
                    const rast::Frame with = test::draw(scene, request);
                    EXPECT_GT(with.counters.pixels_shaded, 1000u);
                    request.hierarchical_z = false;
                    EXPECT_TRUE(same_pictures(with, test::draw(scene, request)))
                        << front_first << " " << int(format) << " " << samples;
                }
    }
}

TEST(SceneRenderer, DrawsTheSameIntoAUsedFrame) {
    const prep::PreparedScene scene = row_of_spheres(true);
    rast::RenderRequest first;
    first.width = 200;
    first.height = 150;
    first.keep_depth = first.keep_ids = first.keep_normals = true;
    first.background = {0.1f, 0.2f, 0.3f};
    rast::RenderRequest second = first;
    second.width = 90;
    second.height = 170;
    second.samples = 4;
    second.keep_ids = false;
    rast::OrbitOptions orbit;
    orbit.azimuth_degrees = 100;
    second.view = rast::orbit_view(scene, orbit);
    rast::SceneRenderer renderer(scene);
    rast::Frame frame;
    for (const rast::RenderRequest& request : {first, second, first, second}) {
        ASSERT_TRUE(renderer.render(*rast::plan(scene, request), frame));
        EXPECT_TRUE(same_pictures(frame, test::draw(scene, request)));
    }
}

TEST(SceneRenderer, WritesTheNearestBytes) {
    // Coarse and small: exact areas take their time.
    const prep::PreparedScene scene = test::scene_of(test::sphere(10, 6));
    for (const int kind : {0, 1, 2, 3}) {
        rast::RenderRequest request;
        request.width = 48;
        request.height = 40;
        request.background = {0.5f, 0.25f, 2.0f};
        if (kind == 1) request.samples = 4;
        if (kind == 2) request.supersample = 2;
        if (kind == 3) request.coverage = rast::Coverage::area;
        const rast::Frame floats = test::draw(scene, request);
        request.pixels = rast::PixelFormat::bytes;
        const rast::Frame bytes = test::draw(scene, request);
        EXPECT_TRUE(bytes.color.empty());
        ASSERT_EQ(bytes.bytes.size(), floats.color.size());
        for (std::size_t i = 0; i < bytes.bytes.size(); ++i)
            for (int c = 0; c < 4; ++c) {
                const float value = std::clamp(floats.color[i][c], 0.0f, 1.0f) * 255.0f;
                // Half a step, and a rounding where a value lies between two.
                ASSERT_LE(std::abs(float(bytes.bytes[i] >> 8 * c & 255u) - value), 0.5001f)
                    << kind << " " << i << " " << c;
            }
    }
}

// Bytes go to the picture by tiles, empty ones past the caches where texels are read: what an older
// picture had must be gone everywhere, with vectors of any width.
TEST(SceneRenderer, WritesAllBytesOfAUsedFrameOnEveryInstructionSet) {
    prep::Material textured;
    textured.diffuse_map.texture = 0;
    prep::Image image{2, 2, 3, {0.1f, 0.9f, 0.4f, 0.8f, 0.2f, 0.6f, 0.3f, 0.7f, 1, 0, 0.5f, 0.9f}};
    prep::PreparedScene scenes[] = {test::scene_of(test::sphere(30, 20)),
                                    test::scene_of(test::sphere(30, 20), textured)};
    prep::ImageRef picture;
    picture.name = "made here.png";
    picture.bytes = prep::encode_png(image).value();
    scenes[1].scene.images.push_back(picture);
    scenes[1].scene.textures.push_back({});
    scenes[1].scene.textures[0].image = 0;
    std::size_t drawn = 0, empty = 0;
    for (const prep::PreparedScene& scene : scenes) {
        rast::RenderRequest large;
        large.threads = 2;  // where texels are read, those clear past the caches
        large.width = 517;  // no multiple of any vector's width or of a tile's
        large.height = 131;
        large.background = {0.5f, 0.25f, 0.125f};
        large.view = test::flat_view(0.4);
        rast::RenderRequest small = large;
        small.view = test::flat_view(2);
        small.background = {0.75f, 0, 1};
        small.shading = large.shading = rast::Shading::phong;
        rast::Frame floats[2];
        for (const int k : {0, 1}) {
            rast::RenderRequest plain = k == 0 ? large : small;
            plain.simd = prep::SimdLevel::scalar;
            floats[k] = test::draw(scene, plain);
        }
        for (const prep::SimdLevel level : test::every_level()) {
            rast::SceneRenderer renderer(scene);
            rast::Frame frame;
            for (const int k : {0, 1, 0, 1}) {
                rast::RenderRequest request = k == 0 ? large : small;
                request.pixels = rast::PixelFormat::bytes;
                request.simd = level;
                ASSERT_TRUE(renderer.render(*rast::plan(scene, request), frame));
                ASSERT_EQ(frame.bytes.size(), floats[k].color.size());
                for (std::size_t i = 0; i < frame.bytes.size(); ++i)
                    for (int c = 0; c < 4; ++c) {
                        const float value = std::clamp(floats[k].color[i][c], 0.0f, 1.0f) * 255.0f;
                        ASSERT_LE(std::abs(float(frame.bytes[i] >> 8 * c & 255u) - value), 0.5001f)
                            << prep::to_string(level) << " " << k << " " << i << " " << c;
                    }
                for (const glm::vec4& color : floats[k].color) ++(color.w > 0 ? drawn : empty);
            }
        }
    }
    EXPECT_GT(drawn, 100000u);
    EXPECT_GT(empty, 100000u);
}

}  // namespace
