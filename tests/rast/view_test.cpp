#include "rast/view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace {

// A scene of the eight corners of a box, as points.
prep::PreparedScene box_scene(const glm::dvec3& centre, const glm::vec3& half) {
    prep::PreparedScene scene;
    scene.scene.meshes.resize(1);
    scene.meshes.resize(1);
    scene.meshes[0].origin = centre;
    for (int i = 0; i < 8; ++i)
        scene.meshes[0].positions.push_back(
            half * glm::vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    prep::instance_unused_meshes(scene.scene);
    return scene;
}

class OrbitView : public testing::TestWithParam<double> {};

TEST_P(OrbitView, FramesTheWholeBoxTightlyAtAnyScaleAndPlace) {
    const double scale = GetParam();
    for (const glm::dvec3 centre : {glm::dvec3(0), glm::dvec3(3, -5, 7) * scale * 1e6}) {
        const auto scene =
            box_scene(centre, glm::vec3(float(scale), float(2 * scale), float(0.5 * scale)));
        for (const double azimuth : {0.0, 37.0, 180.0})
            for (const double elevation : {-90.0, 0.0, 25.0, 90.0}) {
                rast::OrbitOptions options;
                options.azimuth_degrees = azimuth;
                options.elevation_degrees = elevation;
                options.aspect = 4.0 / 3.0;
                const rast::View view = rast::orbit_view(scene, options);
                double reach = 0;  // of the picture's half extents
                for (const glm::vec3& p : scene.meshes[0].positions) {
                    const auto at = rast::project(view, 400, 300, centre + glm::dvec3(p));
                    ASSERT_TRUE(at.visible) << azimuth << " " << elevation;
                    reach =
                        std::max({reach, std::abs(at.x - 200) / 200, std::abs(at.y - 150) / 150});
                }
                EXPECT_LE(reach, 1.0);
                EXPECT_GT(reach, 0.9);  // the margin is 8 % of the half extent
            }
    }
}

INSTANTIATE_TEST_SUITE_P(Scales, OrbitView, testing::Values(1e-30, 1e-6, 1.0, 1e6, 1e30));

TEST(View, EmptySceneGivesAFiniteView) {
    const rast::View view = rast::orbit_view({});
    EXPECT_TRUE(std::isfinite(view.eye().z));
    EXPECT_GT(view.znear, 0);
}

TEST(View, ProjectionRunsFromOneAtTheNearPlaneToZero) {
    rast::View view;
    view.znear = 0.5;
    EXPECT_DOUBLE_EQ(rast::project(view, 100, 100, {0, 0, -0.5}).depth, 1.0);
    EXPECT_DOUBLE_EQ(rast::project(view, 100, 100, {0, 0, -5}).depth, 0.1);
    view.zfar = 5;
    EXPECT_NEAR(rast::project(view, 100, 100, {0, 0, -5}).depth, 0.0, 1e-15);
    EXPECT_FALSE(rast::project(view, 100, 100, {0, 0, 1}).visible);
    const auto centre = rast::project(view, 100, 80, {0, 0, -2});
    EXPECT_DOUBLE_EQ(centre.x, 50);
    EXPECT_DOUBLE_EQ(centre.y, 40);
}

TEST(View, OrthographicWithoutAFarPlaneReachesBehindTheScene) {
    const auto scene = box_scene({0, 0, -100}, {1, 1, 20});
    rast::View view;
    view.perspective = false;
    view.znear = 0.01;
    for (const double without : {0.0, std::numeric_limits<double>::infinity()}) {
        view.zfar = without;
        const rast::View bounded = rast::bounded_view(scene, view);
        EXPECT_GT(bounded.zfar, 120);
        EXPECT_LT(bounded.zfar, 121);
        const auto projected = rast::project(bounded, 10, 10, {0, 0, -120});
        EXPECT_GT(projected.depth, 0);
        EXPECT_LT(projected.depth, 1);
    }
    view.zfar = 50;  // given: kept
    EXPECT_EQ(rast::bounded_view(scene, view).zfar, 50);
    view.zfar = 1000;
    EXPECT_EQ(rast::bounded_view(scene, view).zfar, 1000);
    // In 2^24 equal steps to there the scene would have two.
    view.zfar = 1e8;
    EXPECT_LT(rast::bounded_view(scene, view).zfar, 121);
    EXPECT_GT(rast::bounded_view(scene, view).zfar, 120);
    view.perspective = true;
    view.zfar = 0;  // infinity, which perspective can have
    EXPECT_EQ(rast::bounded_view(scene, view).zfar, 0);
    // All of it behind the eye: still a range.
    view.perspective = false;
    EXPECT_GT(rast::bounded_view(box_scene({0, 0, 100}, {1, 1, 1}), view).zfar, view.znear);
}

TEST(View, CameraLooksAlongItsNodesNegativeZ) {
    prep::Scene scene;
    scene.cameras.resize(1);
    prep::Node node;
    node.camera = 0;
    node.transform[3] = glm::dvec4(1, 2, 3, 1);
    node.transform[0] *= 5.0;  // scale means nothing to a camera
    scene.nodes.push_back(node);
    const rast::View view = rast::camera_view(scene, 0, 1.5);
    EXPECT_EQ(view.eye(), glm::dvec3(1, 2, 3));
    EXPECT_EQ(view.forward(), glm::dvec3(0, 0, -1));
}

// What the camera frames is all there, and round things stay round.
TEST(View, CamerasOfAnotherAspectAreNotStretched) {
    prep::Scene scene;
    scene.cameras.resize(1);
    prep::Node node;
    node.camera = 0;
    scene.nodes.push_back(node);
    prep::Camera& camera = scene.cameras[0];
    for (const bool perspective : {true, false}) {
        camera.perspective = perspective;
        camera.yfov = 0.8;
        camera.aspect = 2;
        camera.xmag = 6;
        camera.ymag = 3;
        camera.znear = 0.1;
        camera.zfar = 100;
        for (const glm::uvec2 size : {glm::uvec2(400, 400), {400, 200}, {800, 200}}) {
            const rast::View view = rast::camera_view(scene, 0, double(size.x) / size.y);
            const auto at = [&](double x, double y) {
                return rast::project(view, size.x, size.y, {x, y, -10.0});
            };
            // The corner of its frame at distance 10.
            const double top = perspective ? 10 * std::tan(0.4) : 3.0, right = 2 * top;
            const rast::Projected corner = at(right, top), centre = at(0, 0);
            EXPECT_LE(corner.x, size.x + 1e-9);
            EXPECT_GE(corner.y, -1e-9);
            EXPECT_TRUE(std::abs(corner.x - size.x) < 1e-9 || std::abs(corner.y) < 1e-9);
            EXPECT_NEAR(at(1, 0).x - centre.x, centre.y - at(0, 1).y, 1e-9);
        }
    }
}

// The height that a camera names is the picture's where it names no width, whatever the form.
TEST(View, OrthographicCamerasWithoutAWidthShowTheirHeight) {
    prep::Scene scene;
    scene.cameras.resize(1);
    scene.cameras[0].perspective = false;
    scene.cameras[0].xmag = 0;
    scene.cameras[0].ymag = 3;
    scene.cameras[0].zfar = 100;
    prep::Node node;
    node.camera = 0;
    scene.nodes.push_back(node);
    for (const glm::uvec2 size : {glm::uvec2(100, 400), {400, 100}, {200, 200}}) {
        const rast::View view = rast::camera_view(scene, 0, double(size.x) / size.y);
        EXPECT_EQ(view.half_height, 3);
        EXPECT_NEAR(rast::project(view, size.x, size.y, {0, 3, -10}).y, 0, 1e-9);
        EXPECT_NEAR(rast::project(view, size.x, size.y, {0, -3, -10}).y, size.y, 1e-9);
    }
}

// glTF advises against them; nothing is mirrored, and the whole frame is shown.
TEST(View, OrthographicExtentsBelowZeroAreThoseAbove) {
    prep::Scene scene;
    scene.cameras.resize(1);
    prep::Camera& camera = scene.cameras[0];
    camera.perspective = false;
    camera.zfar = 100;
    prep::Node node;
    node.camera = 0;
    scene.nodes.push_back(node);
    for (const glm::dvec2 signs : {glm::dvec2(-1, 1), {1, -1}, {-1, -1}})
        for (const glm::uvec2 size : {glm::uvec2(100, 400), {400, 100}}) {
            camera.xmag = 6 * signs.x;
            camera.ymag = 3 * signs.y;
            const rast::View view = rast::camera_view(scene, 0, double(size.x) / size.y);
            const rast::Projected corner = rast::project(view, size.x, size.y, {6, 3, -10});
            EXPECT_GT(corner.x, size.x / 2.0);
            EXPECT_LT(corner.y, size.y / 2.0);
            EXPECT_LE(corner.x, size.x + 1e-9);
            EXPECT_GE(corner.y, -1e-9);
        }
}

TEST(View, AnEyeCloseToALargeGroundSeesIt) {
    const auto ground = box_scene({0, 0, 0}, {1e6, 1e-3, 1e6});
    rast::LookAtOptions options;
    options.eye = {0, 1.5, 0};
    options.target = {0, 1, -3};
    const rast::View view = rast::look_at_view(ground, options);
    EXPECT_GT(view.znear, 0);
    EXPECT_LT(view.znear, 0.05);
}

}  // namespace
