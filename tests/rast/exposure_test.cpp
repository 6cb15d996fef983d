// The exposure that a picture asks for, where a closed form says what it is.
#include "rast/exposure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reference_shading.h"
#include "shapes.h"

namespace {

using namespace test;

// A floor of albedo 0.5 that a directional light meets head on: every pixel reflects half of it.
prep::PreparedScene lit_floor(float albedo = 0.5f) {
    prep::Material material;
    material.diffuse = {albedo, albedo, albedo, 1};
    material.specular = glm::vec3(0.0f);
    return test::scene_of(floor_of(4), material);
}

rast::RenderRequest request_under(float intensity) {
    rast::RenderRequest request;
    request.width = 640;
    request.height = 480;
    request.view = test::look_at({0, 0, 4}, {0, 0, 0}, 2 * std::atan(0.5));
    LightInstance light;
    light.kind = LightKind::directional;
    light.direction = {0, 0, -1};
    light.color = glm::vec3(intensity);
    request.lights = std::vector<LightInstance>{light};
    return request;
}

rast::FoundExposure found(const prep::PreparedScene& scene, const rast::RenderRequest& request) {
    rast::SceneRenderer renderer(scene);
    const auto exposure = rast::find_exposure(renderer, scene, request);
    EXPECT_TRUE(exposure);
    return exposure ? *exposure : rast::FoundExposure();
}

TEST(Exposure, PutsTheBrightestSurfacesAtFourFifths) {
    const prep::PreparedScene scene = lit_floor();
    for (const float intensity : {1e5f, 683.0f, 40.0f, 0.01f, 3e-4f}) {
        const rast::FoundExposure at = found(scene, request_under(intensity));
        EXPECT_NEAR(at.bright / (0.5f * intensity), 1, 1e-5) << intensity;
        EXPECT_NEAR(at.exposure * 0.5f * intensity, 0.8, 0.8 * 0.006) << intensity;
        EXPECT_GT(at.pixels, 1000u);
        // Three digits, as they are told.
        const double shown = std::pow(10.0, std::floor(std::log10(at.exposure)) - 2);
        EXPECT_NEAR(at.exposure / shown, std::round(at.exposure / shown), 1e-4);
    }
}

TEST(Exposure, LeavesPicturesAloneThatNeedNone) {
    const prep::PreparedScene scene = lit_floor();
    for (const float intensity : {0.51f, 1.0f, 1.99f})
        EXPECT_EQ(found(scene, request_under(intensity)).exposure, 1) << intensity;
    for (const float intensity : {0.49f, 2.01f})
        EXPECT_NE(found(scene, request_under(intensity)).exposure, 1) << intensity;
    // Nothing is lit, or nothing seen.
    EXPECT_EQ(found(lit_floor(0), request_under(1e6f)).exposure, 1);
    rast::RenderRequest away = request_under(1e6f);
    away.view = test::look_at({0, 0, 4}, {0, 0, 8}, 1);
    EXPECT_EQ(found(scene, away).pixels, 0u);
    EXPECT_EQ(found(scene, away).exposure, 1);
}

// A third of the pixels is no number: it has no rank among the others, wherever it lies.
TEST(Exposure, LeavesOutWhatIsNoNumber) {
    std::vector<std::uint32_t> order{0, 1, 2};
    do {
        prep::Scene scene;
        scene.meshes.push_back(shapes::grid(3, 1));
        scene.meshes[0].face_materials = order;
        for (const float albedo : {0.05f, std::numeric_limits<float>::quiet_NaN(), 0.5f}) {
            prep::Material& material = scene.materials.emplace_back();
            material.diffuse = {albedo, albedo, albedo, 1};
            material.specular = glm::vec3(0.0f);
        }
        prep::instance_unused_meshes(scene);
        const auto prepared = prep::prepare(std::move(scene));
        ASSERT_TRUE(prepared);
        rast::RenderRequest request = request_under(100);
        request.view = test::look_at({1.5, 0.5, 4}, {1.5, 0.5, 0}, 0.9);
        for (const std::uint32_t height : {200u, 480u}) {
            request.height = height;
            const rast::FoundExposure at = found(*prepared, request);
            EXPECT_NEAR(at.bright, 50, 1e-3) << order[0] << order[1] << ' ' << height;
            EXPECT_NEAR(at.exposure * 50, 0.8, 0.8 * 0.006);
            EXPECT_GT(at.pixels, 1000u);
        }
    } while (std::next_permutation(order.begin(), order.end()));
}

TEST(Exposure, IsThatOfTheCoverageWithoutItsColours) {
    const prep::PreparedScene scene = lit_floor();
    rast::RenderRequest request = request_under(40);
    const rast::FoundExposure plain = found(scene, request);
    request.coverage = rast::Coverage::area;
    request.alpha_alone = true;
    EXPECT_EQ(found(scene, request).exposure, plain.exposure);
}

TEST(Exposure, OfNoPictureIsAnError) {
    const prep::PreparedScene scene = lit_floor();
    rast::SceneRenderer renderer(scene);
    for (const bool wide : {false, true}) {
        rast::RenderRequest request = request_under(1);
        (wide ? request.height : request.width) = 0;
        EXPECT_FALSE(rast::find_exposure(renderer, scene, request));
    }
}

TEST(Exposure, IsOneOfThePictureWhateverPartOrBufferIsAskedFor) {
    const prep::PreparedScene scene = lit_floor();
    const rast::RenderRequest whole = request_under(300);
    rast::RenderRequest part = whole;
    part.crop = rast::Crop{5, 7, 20, 10};
    part.samples = 4;
    part.keep_depth = part.keep_ids = true;
    part.keep_color = false;
    part.pixels = rast::PixelFormat::bytes;
    part.exposure = 7;
    EXPECT_EQ(found(scene, part).exposure, found(scene, whole).exposure);
    part = whole;
    part.threads = 1;
    EXPECT_EQ(found(scene, part).exposure, found(scene, whole).exposure);
}

}  // namespace
