// Cameras against their words in rast/view.h: where they stand, what they look along and what is
// up, in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "oracles.h"
#include "rast/view.h"

namespace {

using namespace test;

constexpr double degree = std::numbers::pi / 180;

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double bound = 1e-12) {
    EXPECT_LT(distance(a, b), bound)
        << a.x << " " << a.y << " " << a.z << " instead of " << b.x << " " << b.y << " " << b.z;
}

// Rows: right, up and back of a view, in the world.
glm::dvec3 axis(const rast::View& view, int k) {
    return glm::transpose(glm::dmat3(view.world_to_view))[k];
}

// Points at the corners of a box, as a mesh without faces.
prep::PreparedScene box_scene(const glm::dvec3& low, const glm::dvec3& high) {
    prep::PreparedScene scene;
    scene.scene.meshes.resize(1);
    scene.meshes.resize(1);
    for (int i = 0; i < 8; ++i)
        scene.meshes[0].positions.push_back(
            glm::vec3(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z));
    prep::instance_unused_meshes(scene.scene);
    return scene;
}

// ------------------------------------------------------------------------------------------ orbits

TEST(OrbitView, StandsAtItsAzimuthAndElevation) {
    const auto scene = box_scene({-1, 1, 2}, {3, 3, 6});
    const glm::dvec3 centre(1, 2, 4);
    struct Case {
        double azimuth, elevation;
        glm::dvec3 from, up;
    };
    const double half = std::sqrt(0.5);
    for (const Case& c : {Case{0, 0, {0, 0, 1}, {0, 1, 0}},      // from +Z
                          Case{90, 0, {1, 0, 0}, {0, 1, 0}},     // eastwards: from +X
                          Case{180, 0, {0, 0, -1}, {0, 1, 0}},   //
                          Case{-90, 0, {-1, 0, 0}, {0, 1, 0}},   //
                          Case{0, 90, {0, 1, 0}, {0, 0, -1}},    // from above
                          Case{90, -90, {0, -1, 0}, {1, 0, 0}},  // from below
                          Case{0, 45, {0, half, half}, {0, half, -half}}}) {
        rast::OrbitOptions options;
        options.azimuth_degrees = c.azimuth;
        options.elevation_degrees = c.elevation;
        options.distance = 10;
        const rast::View view = rast::orbit_view(scene, options);
        expect_near(view.eye(), centre + c.from * 10.0);
        expect_near(view.forward(), -c.from);
        expect_near(axis(view, 1), c.up);
        expect_near(axis(view, 0), glm::cross(c.up, c.from));
    }
}

TEST(TurnedView, CarriesTheCameraEastwards) {
    const auto scene = box_scene({-1, 1, 2}, {3, 3, 6});
    const glm::dvec3 centre(1, 2, 4);
    // From +Z a quarter turn leads to +X, as an orbit's azimuth of 90 degrees.
    rast::OrbitOptions options;
    options.azimuth_degrees = 0;
    options.elevation_degrees = 0;
    options.distance = 5;
    const rast::View front = rast::orbit_view(scene, options);
    expect_near(rast::turned_view(front, centre, std::numbers::pi / 2).eye(), {6, 2, 4});
    for (const double elevation : {-30.0, 0.0, 20.0, 90.0})
        for (const double turn : {1.0, 45.0, 190.0, -60.0}) {
            options.azimuth_degrees = 25;
            options.elevation_degrees = elevation;
            const rast::View before = rast::orbit_view(scene, options);
            options.azimuth_degrees = 25 + turn;
            const rast::View after = rast::orbit_view(scene, options);
            const rast::View turned = rast::turned_view(before, centre, turn * degree);
            expect_near(turned.eye(), after.eye());
            for (int k = 0; k < 3; ++k) expect_near(axis(turned, k), axis(after, k));
            EXPECT_EQ(turned.znear, before.znear);
            EXPECT_EQ(turned.yfov, before.yfov);
        }
    // About another axis than the one it looks at.
    expect_near(rast::turned_view(front, {0, 0, 0}, std::numbers::pi).eye(), {-1, 2, -9});
}

// ----------------------------------------------------------------------------------------- look-at

TEST(LookAtView, StandsAtTheEyeLooksAtTheTargetAndKeepsUpUp) {
    const auto scene = box_scene({-1, -1, -1}, {1, 1, 1});
    rast::LookAtOptions options;
    options.eye = {3, 4, 12};
    options.target = {1, 1, 6};
    options.yfov = 0.7;
    const rast::View view = rast::look_at_view(scene, options);
    expect_near(view.eye(), options.eye);
    expect_near(view.forward(), glm::dvec3(-2, -3, -6) / 7.0);
    EXPECT_EQ(view.yfov, 0.7);
    const rast::Projected target = rast::project(view, 200, 100, options.target);
    EXPECT_NEAR(target.x, 100, 1e-9);
    EXPECT_NEAR(target.y, 50, 1e-9);
    // Higher in the world is higher in the picture, straight above.
    const rast::Projected above =
        rast::project(view, 200, 100, options.target + glm::dvec3(0, 0.5, 0));
    EXPECT_NEAR(above.x, 100, 1e-9);
    EXPECT_LT(above.y, 45);
    options.up = {0, 0, -1};
    const rast::Projected turned = rast::project(rast::look_at_view(scene, options), 200, 100,
                                                 options.target + glm::dvec3(0, 0, -0.5));
    EXPECT_NEAR(turned.x, 100, 1e-9);
    EXPECT_LT(turned.y, 49);
}

TEST(LookAtView, AlongUpAnotherAxisIsTaken) {
    const auto scene = box_scene({-1, -1, -1}, {1, 1, 1});
    for (const double side : {1.0, -1.0}) {
        rast::LookAtOptions options;
        options.eye = {0, 5 * side, 0};
        const rast::View view = rast::look_at_view(scene, options);
        expect_near(view.forward(), {0, -side, 0});
        expect_near(axis(view, 1), {0, 0, -side});  // as an orbit that rises to there from +Z
        expect_near(glm::cross(axis(view, 0), axis(view, 1)), axis(view, 2));
    }
    rast::LookAtOptions options;  // the eye upon the target
    options.eye = options.target = {2, 3, 4};
    const rast::View view = rast::look_at_view(scene, options);
    expect_near(view.eye(), {2, 3, 4});
    expect_near(view.forward(), {0, 0, -1});
    EXPECT_GT(view.znear, 0);
}

TEST(LookAtView, PutsTheNearPlaneJustBeforeTheSceneButNeverBeyondAHundredthOfTheWay) {
    rast::LookAtOptions options;
    options.eye = {0, 0, 11};
    options.target = {0, 0, 0};
    // Its nearest side is 10 away: 0.99 of that (docs/rendering.md).
    EXPECT_NEAR(rast::look_at_view(box_scene({-1, -1, -1}, {1, 1, 1}), options).znear, 9.9, 1e-12);
    // Inside the scene, whose far end is 100 away: 1e-4 of that.
    EXPECT_NEAR(rast::look_at_view(box_scene({-1, -1, -89}, {1, 1, 50}), options).znear, 0.01,
                1e-12);
    // A hundredth of the way to the target is less than that here.
    options.target = {0, 0, 10.5};
    EXPECT_NEAR(rast::look_at_view(box_scene({-1, -1, -89}, {1, 1, 50}), options).znear, 0.005,
                1e-12);
}

// ------------------------------------------------------------------------------------ orthographic

TEST(OrthographicView, ShowsSoManyUnitsFromBottomToTop) {
    const auto scene = box_scene({-1, -2, -3}, {1, 2, 3});
    const rast::View front = test::look_at({0, 0, 10}, {0, 0, 0});
    const rast::View view = rast::orthographic_view(scene, front, 8, 2);
    EXPECT_FALSE(view.perspective);
    expect_near(view.eye(), front.eye());
    const auto at = [&](double x, double y, double z) {
        return rast::project(view, 200, 100, {x, y, z});
    };
    EXPECT_NEAR(at(0, 4, 0).y, 0, 1e-9);
    EXPECT_NEAR(at(0, -4, 2).y, 100, 1e-9);
    EXPECT_NEAR(at(8, 0, -2).x, 200, 1e-9);
    // All of the scene between its planes, a hundredth of its depth within them.
    EXPECT_NEAR(view.znear, 7 - 0.075, 0.02);
    EXPECT_NEAR(view.zfar, 13 + 0.075, 0.02);
    EXPECT_TRUE(at(0, 0, 3).visible);
    EXPECT_TRUE(at(0, 0, -3).visible);
}

TEST(OrthographicView, WithoutAHeightShowsAllOfTheScene) {
    const rast::View front = test::look_at({0, 0, 10}, {0, 0, 0});
    // As high as the box and 8 % (the header's margin), or as wide.
    EXPECT_NEAR(
        rast::orthographic_view(box_scene({-1, -2, -3}, {1, 2, 3}), front, 0, 2).half_height,
        2 * 1.08, 1e-12);
    EXPECT_NEAR(
        rast::orthographic_view(box_scene({-9, -2, -3}, {9, 2, 3}), front, 0, 2).half_height,
        9 * 1.08 / 2, 1e-12);
    // Beside the axis: as far as its farther side.
    EXPECT_NEAR(
        rast::orthographic_view(box_scene({-1, -5, -3}, {1, 2, 3}), front, 0, 2).half_height,
        5 * 1.08, 1e-12);
}

// ------------------------------------------------------------------------------------ projections

TEST(Projection, PutsThePerspectivesEdgesAtTheFieldOfView) {
    rast::View view;
    view.yfov = 2 * std::atan(0.5);
    view.aspect = 2;
    const auto at = [&](double x, double y, double z) {
        return rast::project(view, 400, 200, {x, y, z});
    };
    EXPECT_NEAR(at(0, 5, -10).y, 0, 1e-9);
    EXPECT_NEAR(at(0, -5, -10).y, 200, 1e-9);
    EXPECT_NEAR(at(10, 0, -10).x, 400, 1e-9);
    EXPECT_NEAR(at(-1, 1, -2).x, 100, 1e-9);
    EXPECT_NEAR(at(-1, 0.5, -2).y, 50, 1e-9);
    view.aspect = 0;  // the picture's
    EXPECT_NEAR(rast::project(view, 600, 200, {15, 0, -10}).x, 600, 1e-9);
}

// n (f − z) / (z (f − n)), and (f − z) / (f − n) without perspective.
TEST(Projection, DepthsAreReversedBetweenBothPlanes) {
    rast::View view;
    view.znear = 2;
    view.zfar = 10;
    for (const double z : {2.0, 3.0, 5.0, 10.0})
        EXPECT_NEAR(rast::project(view, 10, 10, {0, 0, -z}).depth, 2 * (10 - z) / (z * 8), 1e-12);
    EXPECT_FALSE(rast::project(view, 10, 10, {0, 0, -1.9}).visible);
    EXPECT_FALSE(rast::project(view, 10, 10, {0, 0, -10.1}).visible);
    EXPECT_TRUE(rast::project(view, 10, 10, {0, 0, -9.9}).visible);
    view.zfar = std::numeric_limits<double>::infinity();
    EXPECT_NEAR(rast::project(view, 10, 10, {0, 0, -8}).depth, 0.25, 1e-12);
    view.perspective = false;
    view.zfar = 10;
    for (const double z : {2.0, 3.0, 5.0, 10.0})
        EXPECT_NEAR(rast::project(view, 10, 10, {0, 0, -z}).depth, (10 - z) / 8, 1e-12);
}

// --------------------------------------------------------------------------------------- cameras

TEST(CameraView, FollowsItsNodeAndItsParents) {
    prep::Scene scene;
    scene.cameras.resize(1);
    scene.cameras[0].yfov = 0.5;
    scene.cameras[0].znear = 0.25;
    scene.cameras[0].zfar = 50;
    scene.nodes.resize(2);
    // The parent turns a quarter about +Y: its −Z is the world's −X. The child rolls a quarter
    // about its own Z: its +Y is the parent's −X, the world's +Z.
    scene.nodes[0].transform = glm::dmat4(glm::dvec4(0, 0, -1, 0), glm::dvec4(0, 1, 0, 0),
                                          glm::dvec4(1, 0, 0, 0), glm::dvec4(5, 6, 7, 1));
    scene.nodes[1].parent = 0;
    scene.nodes[1].camera = 0;
    scene.nodes[1].transform = glm::dmat4(glm::dvec4(0, 1, 0, 0), glm::dvec4(-1, 0, 0, 0),
                                          glm::dvec4(0, 0, 1, 0), glm::dvec4(1, 2, 3, 1));
    const rast::View view = rast::camera_view(scene, 1, 1.5);
    expect_near(view.eye(), {5 + 3, 6 + 2, 7 - 1});
    expect_near(view.forward(), {-1, 0, 0});
    expect_near(axis(view, 1), {0, 0, 1});
    EXPECT_EQ(view.yfov, 0.5);
    EXPECT_EQ(view.znear, 0.25);
    EXPECT_EQ(view.zfar, 50);
    EXPECT_EQ(view.aspect, 1.5);
}

TEST(CameraView, IsThePlansWhereTheSceneHasOneAndTheRequestDoesNotSay) {
    prep::PreparedScene scene = box_scene({-1, -1, -1}, {1, 1, 1});
    scene.scene.cameras.resize(1);
    prep::Node node;
    node.camera = 0;
    node.transform[3] = {7, 8, 9, 1};
    scene.scene.nodes.push_back(node);
    rast::RenderRequest request;
    // A camera that nobody chose is only there.
    expect_near(glm::normalize(rast::plan(scene, request)->view.eye()),
                {std::sin(30 * degree) * std::cos(20 * degree), std::sin(20 * degree),
                 std::cos(30 * degree) * std::cos(20 * degree)});
    scene.scene.active_camera = 1;
    expect_near(rast::plan(scene, request)->view.eye(), {7, 8, 9});
    request.view = test::look_at({1, 2, 3}, {0, 0, 0});
    expect_near(rast::plan(scene, request)->view.eye(), {1, 2, 3});
}

// Lines and points are not drawn, wherever they are.
TEST(WorldBounds, AreOfWhatIsDrawn) {
    prep::Scene scene;
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1000, 0, 0}, {0, 1000, 0}, {0, 0, 1000}};
    mesh.face_offsets = {0, 3};
    mesh.corner_vertices = {0, 1, 2};
    mesh.points = {3};
    mesh.line_vertices = {4, 5};
    mesh.line_offsets = {0, 2};
    scene.meshes.push_back(mesh);
    scene.nodes.resize(1);
    scene.nodes[0].mesh = 0;
    const auto prepared = prep::prepare(scene);
    ASSERT_TRUE(prepared);
    const auto bounds = rast::world_bounds(*prepared);
    ASSERT_TRUE(bounds.has_value());
    EXPECT_EQ(bounds->low, glm::dvec3(0, 0, 0));
    EXPECT_EQ(bounds->high, glm::dvec3(1, 1, 0));
    scene.meshes[0].face_offsets = {0};
    scene.meshes[0].corner_vertices.clear();
    const auto loose = prep::prepare(scene);
    ASSERT_TRUE(loose);
    EXPECT_FALSE(rast::world_bounds(*loose).has_value());
}

TEST(WorldBounds, AreOfEveryInstanceAboutItsOrigin) {
    prep::PreparedScene scene = box_scene({-1, -2, -3}, {1, 2, 3});
    scene.meshes[0].origin = {100, 0, 0};
    prep::Node node = scene.scene.nodes[0];
    node.transform[1] = {0, 2, 0, 0};
    node.transform[3] = {0, 0, 50, 1};
    scene.scene.nodes.push_back(node);
    const float nan = std::nanf("");
    scene.meshes[0].positions.push_back({nan, 900, 900});  // takes no part
    const auto bounds = rast::world_bounds(scene);
    ASSERT_TRUE(bounds.has_value());
    expect_near(bounds->low, {99, -4, -3});
    expect_near(bounds->high, {101, 4, 53});
    expect_near(bounds->centre(), {100, 0, 25});
    EXPECT_NEAR(bounds->radius(), std::hypot(1, 4, 28), 1e-12);
    EXPECT_FALSE(rast::world_bounds({}).has_value());
}

}  // namespace
