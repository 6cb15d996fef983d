// Alpha masks: glTF draws what has an alpha greater than or equal to the cut-off and nothing else,
// to the last bit, whichever way a triangle is drawn.
#include "reference_shading.h"

namespace {

using namespace test;

// A row of texels whose alpha is n / 255, all of them white.
prep::ImageRef alpha_ramp() {
    prep::Image image{256, 1, 4, {}};
    for (int n = 0; n < 256; ++n)
        image.pixels.insert(image.pixels.end(), {1, 1, 1, float(n) / 255.0f});
    prep::ImageRef ref;
    ref.name = "memory.png";
    ref.bytes = *prep::encode_png(image, prep::PixelType::u8);
    return ref;
}

// The floor from one side to the other is texels 0 to 255, one for each column of pixels.
prep::PreparedScene ramp_scene(float cutoff) {
    prep::Material material = white();
    material.alpha_mode = prep::AlphaMode::mask;
    material.alpha_cutoff = cutoff;
    material.diffuse_map.texture = 0;
    prep::PreparedScene scene = test::scene_of(floor_of(1), material);
    scene.scene.images.push_back(alpha_ramp());
    prep::Texture texture;
    texture.image = 0;
    texture.wrap_u = texture.wrap_v = prep::Wrap::clamp;
    scene.scene.textures.push_back(texture);
    return scene;
}

rast::RenderRequest ramp_request() {
    rast::RenderRequest request;
    request.width = 256;
    request.height = 3;
    rast::View view = test::flat_view(1);
    view.aspect = 1;  // the whole floor, however flat its pixels are
    request.view = view;
    request.filter = rast::TextureFilter::nearest;
    request.lights = std::vector<LightInstance>{ambient(glm::vec3(1.0f))};
    return request;
}

// The first column that is drawn; from there on all have to be.
std::size_t first_drawn(const rast::Frame& frame, std::uint32_t y) {
    std::size_t first = 0;
    while (first < frame.width && !drawn(frame, std::uint32_t(first), y)) ++first;
    for (std::size_t x = first; x < frame.width; ++x)
        EXPECT_TRUE(drawn(frame, std::uint32_t(x), y)) << x;
    return first;
}

TEST(AlphaMask, DrawsWhatIsAtTheCutoffOrAbove) {
    // The floats beside n / 255 tell ≥ from > on either side.
    for (const int n : {1, 51, 128, 204, 255})
        for (const int step : {-1, 0, 1}) {
            const float at = float(n) / 255.0f;
            const float cutoff = step == 0 ? at : std::nextafter(at, step < 0 ? 0.0f : 2.0f);
            const prep::PreparedScene scene = ramp_scene(cutoff);
            for (const prep::SimdLevel level : every_level()) {
                rast::RenderRequest request = ramp_request();
                request.simd = level;
                const rast::Frame frame = test::draw(scene, request);
                ASSERT_EQ(first_drawn(frame, 1), std::size_t(step > 0 ? n + 1 : n))
                    << n << " " << step << " " << prep::to_string(level);
            }
        }
}

TEST(AlphaMask, IsTheProductOfFactorVertexColourAndMap) {
    // 0.5 · 0.5 · n/255 ≥ 0.25 · 0.6 from n = 153 on; powers of two change no digit.
    prep::PreparedScene scene = ramp_scene(0.25f * (153 / 255.0f));
    scene.scene.materials[0].diffuse.a = 0.5f;
    scene.meshes[0].colors = {std::vector<glm::vec4>(4, glm::vec4(1, 1, 1, 0.5f))};
    for (const prep::SimdLevel level : every_level()) {
        rast::RenderRequest request = ramp_request();
        request.simd = level;
        EXPECT_EQ(first_drawn(test::draw(scene, request), 1), 153u);
    }
}

// docs/rendering.md: with exact areas a mask is asked once for all of a triangle in a pixel. Four
// texels to a pixel; its centroid lies between the second and the third.
TEST(AlphaMask, OfExactAreasCountsForAllOfATriangleInAPixel) {
    rast::RenderRequest request = ramp_request();
    request.width = 64;
    request.coverage = rast::Coverage::area;
    for (const int pixel : {5, 12, 50, 60})  // beside the floor's diagonal
        for (const bool seen : {true, false}) {
            // From the pixel's second texel on, or from its last one alone.
            const int first = 4 * pixel + (seen ? 1 : 3);
            const rast::Frame frame = test::draw(ramp_scene(float(first) / 255.0f), request);
            const glm::vec4* row = frame.color.data() + frame.width;
            EXPECT_EQ(row[pixel - 1].a, 0.0f) << first;
            EXPECT_NEAR(row[pixel].a, seen ? 1.0f : 0.0f, 1e-6f) << first;
            EXPECT_NEAR(row[pixel + 1].a, 1.0f, 1e-6f) << first;
        }
}

TEST(AlphaMask, WithoutAMapIsDecidedByFactorAndVertexColour) {
    prep::Material material = white();
    material.alpha_mode = prep::AlphaMode::mask;
    for (const float opacity : {0.5f, 0.25f, 1.0f})
        for (const float vertex : {1.0f, 0.5f})
            for (const int step : {-1, 0, 1}) {
                const float alpha = opacity * vertex;
                material.diffuse.a = opacity;
                material.alpha_cutoff =
                    step == 0 ? alpha : std::nextafter(alpha, step < 0 ? 0.0f : 2.0f);
                prep::PreparedScene scene = test::scene_of(floor_of(1), material);
                if (vertex < 1)
                    scene.meshes[0].colors = {
                        std::vector<glm::vec4>(4, glm::vec4(1, 1, 1, vertex))};
                for (const prep::SimdLevel level : every_level())
                    for (const int how : {0, 1, 2, 3}) {
                        rast::RenderRequest request;
                        request.width = request.height = 16;
                        request.view = test::flat_view(1);
                        request.simd = level;
                        // One sample, several, exact areas, and a floor that the near plane cuts.
                        if (how == 1) request.samples = 4;
                        if (how == 2) request.coverage = rast::Coverage::area;
                        if (how == 3) {
                            request.view = test::look_at({0, -1.5, 0.5}, {0, 1, 0}, 0.8, 1.0);
                        }
                        const rast::Frame frame = test::draw(scene, request);
                        std::size_t seen = 0;
                        for (const glm::vec4& c : frame.color) seen += c.a > 0;
                        if (how == 3 && step <= 0) {
                            EXPECT_GT(frame.counters.crossing, 0u);
                        }
                        EXPECT_EQ(seen > 0, step <= 0)
                            << alpha << " " << step << " " << how << prep::to_string(level);
                    }
            }
}

// What is cut out leaves no depth: the floor behind is seen through it.
TEST(AlphaMask, ShowsWhatIsBehind) {
    prep::PreparedScene scene = ramp_scene(0.5f);
    prep::VertexMesh& mesh = scene.meshes[0];
    for (std::size_t i = 0; i < 4; ++i)
        mesh.positions.push_back(mesh.positions[i] - glm::vec3(0, 0, 1));
    mesh.normals.resize(8, {0, 0, 1});
    mesh.uvs[0].resize(8);
    for (const std::uint32_t k : {4u, 5u, 6u, 4u, 6u, 7u}) mesh.indices.push_back(k);
    prep::Material behind = white();
    behind.diffuse = {0.25f, 0.5f, 0.75f, 1};
    scene.scene.materials.push_back(behind);
    mesh.ranges = {{0, 2, 0, prep::no_index}, {2, 2, 1, prep::no_index}};
    for (const prep::SimdLevel level : every_level()) {
        rast::RenderRequest request = ramp_request();
        request.simd = level;
        const rast::Frame frame = test::draw(scene, request);
        for (std::uint32_t x = 0; x < 256; ++x)
            ASSERT_EQ(pixel(frame, x, 1), x >= 128 ? glm::dvec3(1.0) : glm::dvec3(0.25, 0.5, 0.75))
                << x << " " << prep::to_string(level);
    }
}

// Depths and numbers are those of what stands, also where nobody asks for colours.
TEST(AlphaMask, CutsBuffersWithoutColoursToo) {
    const prep::PreparedScene scene = ramp_scene(0.5f);
    rast::RenderRequest request = ramp_request();
    request.keep_depth = request.keep_ids = true;
    for (const bool colors : {true, false}) {
        request.keep_color = colors;
        const rast::Frame frame = test::draw(scene, request);
        for (std::size_t x = 0; x < 256; ++x) {
            ASSERT_EQ(frame.depth[256 + x] > 0, x >= 128) << x;
            ASSERT_EQ(frame.triangle[256 + x] != prep::no_index, x >= 128) << x;
        }
    }
}

// Without a mask, alpha decides nothing: blended materials are drawn opaque.
TEST(AlphaMask, IsReadInItsOwnModeAlone) {
    for (const auto mode : {prep::AlphaMode::opaque, prep::AlphaMode::blend}) {
        prep::PreparedScene scene = ramp_scene(0.5f);
        scene.scene.materials[0].alpha_mode = mode;
        EXPECT_EQ(first_drawn(test::draw(scene, ramp_request()), 1), 0u);
    }
}

}  // namespace
