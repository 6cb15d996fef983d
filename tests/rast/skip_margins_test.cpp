// What is left out stays in where rounding could decide: the kernels' floats from far away, large
// coordinates, flat nodes, alphas of many sizes.
#include <gtest/gtest.h>

#include <cmath>

#include "skip_stage.h"

namespace {

using test::is_skipped;
using test::light_of;
using test::stage_of;
using test::stage_request;

// A spot above the ball, its cone just beside the box of everything.
rast::RenderRequest beside_a_cone() {
    rast::RenderRequest request = stage_request();
    rast::LightInstance spot = light_of(prep::LightKind::spot, glm::vec3(9), {0, 0, 6},
                                        {std::sin(0.36), 0, -std::cos(0.36)});
    spot.inner_cone = 0;
    spot.outer_cone = 0.001f;
    request.lights->push_back(spot);
    return request;
}

// The kernels take places from the eye, in float: from 10,000 km away, to a metre.
TEST(Skips, ConesAreNotDecidedByMoreThanTheKernelsSee) {
    const prep::PreparedScene scene = stage_of({});
    rast::RenderRequest request = beside_a_cone();
    EXPECT_TRUE(is_skipped("light_cone", scene, request));
    for (const double distance : {1e3, 1e7}) {
        request.view = test::flat_view(1.5);
        request.view->zfar = 2 * distance;
        request.view->world_to_view[3] = glm::dvec4(0, 0, -distance, 1);
        EXPECT_EQ(is_skipped("light_cone", scene, request), distance < 1e6);
    }
}

// A node that brings coordinates of a million back to the middle.
TEST(Skips, LightsAreNotDecidedByMoreThanLargeCoordinatesTell) {
    const glm::dmat3 turn = glm::dmat3({0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1});
    for (const double away : {0.0, 1e2, 1e6}) {
        const glm::dvec3 centre(away, away / 2, 0);
        prep::PreparedScene scene = test::scene_of(test::sphere(40, 30, 1, centre));
        scene.scene.nodes[0].transform = glm::dmat4(turn);
        scene.scene.nodes[0].transform[3] = glm::dvec4(-(turn * centre), 1);
        rast::RenderRequest request = stage_request();
        request.lights->push_back(
            light_of(prep::LightKind::point, glm::vec3(9), {0, 0, 6}, {0, 0, -1}, 4.8f));
        EXPECT_EQ(is_skipped("light_range", scene, request), away < 1e6) << away;
        EXPECT_EQ(is_skipped("light_cone", scene, beside_a_cone()), away < 1e6) << away;
    }
}

// Normals are turned by the inverse transpose: where a node flattens, its largest element rounds
// the others' share away.
TEST(Skips, BacksAreNotDecidedByMoreThanAFlatNodeLeavesOfNormals) {
    for (const double flat : {1.0, 1e-2, 1e-9}) {
        prep::PreparedScene scene = stage_of({});
        for (glm::vec3& n : scene.meshes[0].normals) n = {1, 0, 0.001f};
        const glm::dmat3 turn = glm::dmat3({0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1});
        glm::dmat3 linear = turn;
        linear[2] *= flat;
        scene.scene.nodes[0].transform = glm::dmat4(linear);
        rast::RenderRequest request = stage_request();
        request.lights->push_back(
            light_of(prep::LightKind::directional, glm::vec3(1), {}, turn[0]));
        EXPECT_EQ(is_skipped("light_behind", scene, request), flat > 1e-6) << flat;
    }
}

// An alpha of 100,000 beside one that is hardly above the cutoff: their mean in float is off by
// a hundredth.
TEST(Skips, MasksAreNotDecidedByMoreThanMixedAlphaTells) {
    for (const float high : {1.0f, 1e5f}) {
        const float texels[] = {1, 1, 1, 0.502f, 1, 1, 1, high};
        prep::Material material;
        material.alpha_mode = prep::AlphaMode::mask;
        material.alpha_cutoff = 0.5f;
        material.diffuse_map.texture = 0;
        const prep::PreparedScene mapped =
            stage_of(material, {test::float_picture(2, 1, 4, texels)});
        EXPECT_EQ(is_skipped("mask_never_cuts", mapped, stage_request()), high == 1) << high;

        material.diffuse_map = {};
        prep::PreparedScene colored = stage_of(material);
        std::vector<glm::vec4>& colors = colored.meshes[0].colors.emplace_back();
        for (std::size_t v = 0; v < colored.meshes[0].positions.size(); ++v)
            colors.push_back({1, 1, 1, v % 2 == 0 ? 0.502f : high});
        EXPECT_EQ(is_skipped("mask_never_cuts", colored, stage_request()), high == 1) << high;
    }
}

}  // namespace
