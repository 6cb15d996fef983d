// What plan() refuses, and how much its proofs look at.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "builders.h"
#include "plan/request_checks.h"

namespace {

using prep::ErrorCode;

constexpr double infinite = std::numeric_limits<double>::infinity();
const double nan = std::nan("");

prep::PreparedScene ball() {
    return test::scene_of(test::sphere(8, 6));
}

TEST(PlanViews, ThatMakeNoPictureAreRefused) {
    const prep::PreparedScene scene = ball();
    struct Change {
        bool perspective;
        std::function<void(rast::View&)> make;
        const char* says;  // empty: a picture comes of it
    };
    const Change changes[] = {
        {true, [](rast::View&) {}, ""},
        {false, [](rast::View&) {}, ""},
        {true, [](rast::View& v) { v.znear = 10, v.zfar = 1; }, "far"},
        {true, [](rast::View& v) { v.znear = 1, v.zfar = 1; }, "far"},
        {true, [](rast::View& v) { v.zfar = -1; }, "far"},
        {true, [](rast::View& v) { v.zfar = nan; }, "far"},
        {true, [](rast::View& v) { v.zfar = 0; }, ""},
        {true, [](rast::View& v) { v.zfar = infinite; }, ""},
        {true, [](rast::View& v) { v.znear = 0; }, "near"},
        {true, [](rast::View& v) { v.znear = -1; }, "near"},
        {true, [](rast::View& v) { v.znear = infinite; }, "near"},
        {true, [](rast::View& v) { v.znear = nan; }, "near"},
        {true, [](rast::View& v) { v.yfov = 0; }, "field of view"},
        {true, [](rast::View& v) { v.yfov = -0.5; }, "field of view"},
        {true, [](rast::View& v) { v.yfov = 3.2; }, "field of view"},
        {true, [](rast::View& v) { v.yfov = nan; }, "field of view"},
        {true, [](rast::View& v) { v.aspect = -1; }, "aspect"},
        {true, [](rast::View& v) { v.aspect = nan; }, "aspect"},
        {true, [](rast::View& v) { v.aspect = infinite; }, "aspect"},
        {true, [](rast::View& v) { v.world_to_view[0] *= 2.0; }, "stretches"},
        {true, [](rast::View& v) { v.world_to_view[0] *= -1.0; }, "mirrors"},
        {true, [](rast::View& v) { v.world_to_view[1] = glm::dvec4(0); }, "stretches"},
        {true, [](rast::View& v) { v.world_to_view[2][2] = nan; }, "stretches"},
        {true, [](rast::View& v) { v.world_to_view[3][1] = infinite; }, "moves"},
        {true, [](rast::View& v) { v.world_to_view[3][3] = 2; }, "moves"},
        // As floats have a rotation.
        {true, [](rast::View& v) { v.world_to_view = glm::dmat4(glm::mat4(v.world_to_view)); }, ""},
        // As glm::inverse() leaves the last row of such a one.
        {true, [](rast::View& v) { v.world_to_view[3][3] = 1 - 0x1p-53; }, ""},
        // What the other projection reads is nothing to this one.
        {true, [](rast::View& v) { v.half_height = -1; }, ""},
        {false, [](rast::View& v) { v.yfov = nan; }, ""},
        {false, [](rast::View& v) { v.half_height = 0; }, "height"},
        {false, [](rast::View& v) { v.half_height = -1; }, "height"},
        {false, [](rast::View& v) { v.half_height = infinite; }, "height"},
        {false, [](rast::View& v) { v.znear = 10, v.zfar = 1; }, "far"},
        {false, [](rast::View& v) { v.zfar = nan; }, "far"},
        {false, [](rast::View& v) { v.zfar = 0; }, ""},
        {false, [](rast::View& v) { v.zfar = infinite; }, ""},
        {false, [](rast::View& v) { v.znear = 0; }, ""},
        {false, [](rast::View& v) { v.znear = -5, v.zfar = -1; }, ""},
    };
    for (std::size_t i = 0; i < std::size(changes); ++i) {
        SCOPED_TRACE("change " + std::to_string(i));
        rast::RenderRequest request;
        request.view = test::look_at({1, 2, 4}, {0, 0, 0});
        request.view->perspective = changes[i].perspective;
        request.view->zfar = 100;
        changes[i].make(*request.view);
        const auto plan = rast::plan(scene, request);
        ASSERT_EQ(plan.has_value(), changes[i].says[0] == 0);
        if (plan && request.view->zfar != 0 && std::isfinite(request.view->zfar)) {
            EXPECT_EQ(plan->view.zfar, request.view->zfar);
        }
        if (plan) continue;
        EXPECT_EQ(plan.error().code, ErrorCode::invalid);
        EXPECT_NE(plan.error().text.find(changes[i].says), std::string::npos) << plan.error().text;
    }
}

// Readers may let through what their files say: it is told of the camera.
TEST(PlanViews, CamerasThatMakeNoPictureAreNamed) {
    prep::PreparedScene scene = ball();
    prep::Camera& camera = scene.scene.cameras.emplace_back();
    camera.znear = 10;
    camera.zfar = 1;
    prep::Node node;
    node.name = "front";
    node.camera = 0;
    node.transform[3] = glm::dvec4(0, 0, 5, 1);
    scene.scene.nodes.push_back(node);
    scene.scene.active_camera = 1;
    const auto plan = rast::plan(scene, {});
    ASSERT_FALSE(plan.has_value());
    EXPECT_EQ(plan.error().code, ErrorCode::invalid);
    EXPECT_EQ(plan.error().place, "camera 'front'");
    EXPECT_NE(plan.error().text.find("found 1 and 10"), std::string::npos) << plan.error().text;
    scene.scene.nodes.back().name.clear();
    EXPECT_EQ(rast::plan(scene, {}).error().place, "camera 0");
    scene.scene.cameras[0].name = "own";
    EXPECT_EQ(rast::plan(scene, {}).error().place, "camera 'own'");
    scene.scene.cameras[0].zfar = 11;
    EXPECT_TRUE(rast::plan(scene, {}).has_value());
}

// Triangles of all instances have numbers of 31 bits, the last of them none's.
TEST(PlanCounts, TrianglesOfAllInstancesAreBelowTwoToTheThirtyFirst) {
    prep::VertexMesh large, small;
    for (prep::VertexMesh* const mesh : {&large, &small}) {
        mesh->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        mesh->indices.assign(3 * (mesh == &large ? 65536u : 65535u), 0);
    }
    prep::PreparedScene scene = test::scene_of(large);
    const prep::PreparedScene other = test::scene_of(small);
    scene.meshes.push_back(other.meshes[0]);
    scene.scene.meshes.emplace_back();
    scene.scene.nodes.resize(32767, scene.scene.nodes[0]);
    scene.scene.nodes.push_back(other.scene.nodes[0]);
    scene.scene.nodes.back().mesh = 1;
    rast::RenderRequest request;
    request.view = test::look_at({0, 0, 5}, {0, 0, 0});
    const auto most = rast::plan(scene, request);
    ASSERT_TRUE(most.has_value()) << to_string(most.error());
    EXPECT_EQ(most->triangles, 0x7fffffffu);
    scene.scene.nodes.back().mesh = 0;  // one more
    const auto more = rast::plan(scene, request);
    ASSERT_FALSE(more.has_value());
    EXPECT_EQ(more.error().code, ErrorCode::limit);
    EXPECT_NE(more.error().text.find("2147483648"), std::string::npos) << more.error().text;
}

// What the last vertex and the last triangle have is within 2^31 floats or indices.
TEST(PlanCounts, MeshesAreWithinSignedIndices) {
    using rast::Shading;
    const auto fits = [](std::uint64_t triangles, std::uint64_t vertices, Shading shading) {
        rast::detail::DrawnContents drawn;
        drawn.most_triangles = triangles;
        drawn.most_vertices = vertices;
        const auto fault = rast::detail::fault_of_size(drawn, shading);
        EXPECT_TRUE(!fault || fault->code == ErrorCode::limit);
        return !fault;
    };
    constexpr std::uint64_t all = std::uint64_t(1) << 31;
    EXPECT_TRUE(fits(1, all / 4, Shading::phong));
    EXPECT_FALSE(fits(1, all / 4 + 1, Shading::phong));
    EXPECT_TRUE(fits(1, all / 12, Shading::gouraud));
    EXPECT_FALSE(fits(1, all / 12 + 1, Shading::gouraud));
    EXPECT_TRUE(fits(all / 3, 3, Shading::flat));
    EXPECT_FALSE(fits(all / 3 + 1, 3, Shading::flat));
    // And that is what the scene is asked for.
    const rast::detail::DrawnContents drawn = rast::detail::drawn_contents(ball());
    EXPECT_EQ(drawn.most_triangles, 8u * (6 * 2 - 2));
    EXPECT_EQ(drawn.most_vertices, 9u * 7);
}

// Lights are held against so many normals in all: 2^24 and 8 times the vertices (plan/skips.h).
TEST(PlanProofs, ManyLightsBehindManyNormalsTakeNoLongerThanAFew) {
    constexpr std::size_t vertices = 1u << 20, lights = 60;
    prep::VertexMesh mesh;
    mesh.positions.assign(vertices, {0, 0, 0});
    mesh.positions[1].x = mesh.positions[2].y = 1;
    mesh.normals.assign(vertices, {0, 0, 1});
    mesh.indices = {0, 1, 2};
    const prep::PreparedScene scene = test::scene_of(mesh);
    rast::RenderRequest request;
    request.view = test::look_at({0, 0, 5}, {0, 0, 0});
    request.shading = rast::Shading::phong;
    rast::LightInstance behind;
    behind.direction = {0, 0, 1};
    request.lights.emplace(lights, behind);
    const auto plan = rast::plan(scene, request);
    ASSERT_TRUE(plan.has_value());
    const auto left_out =
        std::size_t(std::count(plan->skips.lights.begin(), plan->skips.lights.end(), true));
    EXPECT_EQ(left_out, ((std::size_t(1) << 24) + 8 * vertices - 1) / (vertices + 1));
    EXPECT_TRUE(plan->skips.lights[0]);
}

// A material's meshes are found once for all materials, and what their vertices are like once a
// mesh: looking through all for each would take half an hour.
TEST(PlanProofs, ManyMaterialsOfOneMeshAreLookedThroughOnce) {
    constexpr std::uint32_t materials = 300'000;
    prep::VertexMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.colors = {std::vector<glm::vec4>(materials, glm::vec4(1))};
    mesh.positions.resize(materials);
    for (std::uint32_t m = 0; m < materials; ++m) {
        mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
        mesh.ranges.push_back({m, 1, m, prep::no_index});
    }
    prep::Material masked;
    masked.alpha_mode = prep::AlphaMode::mask;
    prep::PreparedScene scene = test::scene_of(mesh, masked);
    scene.scene.materials.resize(materials, masked);
    rast::RenderRequest request;
    request.view = test::look_at({0, 0, 5}, {0, 0, 0});
    const auto plan = rast::plan(scene, request);
    ASSERT_TRUE(plan.has_value());
    EXPECT_TRUE(plan->skips.materials[materials - 1].mask);
}

}  // namespace
