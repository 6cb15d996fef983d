// Bumps of a normal map are lit from where the light is, however their UVs lie.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>

#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/topology.h"
#include "rast/render.h"
#include "shared_data.h"

namespace {

struct Patch {
    glm::dvec3 low{1e300}, high{-1e300};
    std::size_t triangles = 0;
};

// The model's separate surfaces. Equal positions are one.
std::vector<Patch> patches(const prep::Mesh& mesh) {
    const auto welded = prep::weld_exact(mesh.positions);
    std::vector<std::uint32_t> root(mesh.positions.size());
    std::iota(root.begin(), root.end(), 0u);
    const auto find = [&](std::uint32_t v) {
        while (root[v] != v) v = root[v] = root[root[v]];
        return v;
    };
    const auto vertex = [&](std::size_t c) { return welded[mesh.corner_vertices[c]]; };
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f] + 1; c < mesh.face_offsets[f + 1]; ++c)
            root[find(vertex(c))] = find(vertex(c - 1));
    std::map<std::uint32_t, Patch> found;
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        Patch& patch = found[find(vertex(c))];
        const glm::dvec3 p(mesh.positions[mesh.corner_vertices[c]]);
        patch.low = glm::min(patch.low, p);
        patch.high = glm::max(patch.high, p);
        patch.triangles += c % 3 == 0;
    }
    std::vector<Patch> result;
    for (const auto& [vertex_root, patch] : found) result.push_back(patch);
    return result;
}

// NormalTangentTest: pairs of a modelled bump and a flat square with the same bump in its normal
// map, whose UVs are turned and mirrored from square to square.
TEST(TangentLighting, AllBumpsAreLitFromTheSameSide) {
    MESHPREP_REQUIRE_SHARED(shared);
    auto scene = prep::load_scene(shared / "corpus/NormalTangentTest.glb");
    ASSERT_TRUE(scene.has_value());
    const auto surfaces = patches(scene->meshes[0]);
    const auto transforms = prep::world_transforms(*scene);
    glm::dmat4 to_world(1.0);
    for (std::size_t n = 0; n < scene->nodes.size(); ++n)
        if (scene->nodes[n].mesh == 0) to_world = transforms[n];
    const auto prepared = prep::prepare(*std::move(scene));
    ASSERT_TRUE(prepared.has_value());

    rast::RenderRequest request;
    request.width = request.height = 500;
    rast::OrbitOptions orbit;
    orbit.azimuth_degrees = orbit.elevation_degrees = 0;
    orbit.aspect = 1;
    request.view = rast::orbit_view(*prepared, orbit);
    rast::LightInstance light;  // from the upper left, in front
    light.direction = glm::normalize(glm::dvec3(1, -1, -1));
    light.color = glm::vec3(2.0f);
    request.lights = {light};
    const auto plan = rast::plan(*prepared, request);
    ASSERT_TRUE(plan.has_value());
    const auto frame = rast::render(*prepared, *plan);
    ASSERT_TRUE(frame.has_value());

    std::size_t flat = 0, round = 0;
    for (const Patch& patch : surfaces) {
        const glm::dvec3 size = patch.high - patch.low;
        if (std::abs(size.x - size.y) > 0.05 * size.x) continue;  // the board with the writing
        const auto project = [&](const glm::dvec3& p) {
            return rast::project(*request.view, request.width, request.height,
                                 glm::dvec3(to_world * glm::dvec4(p, 1)));
        };
        const glm::dvec3 middle = (patch.low + patch.high) * 0.5;
        const auto centre = project(middle);
        // The bump fills two thirds of the square.
        const double radius =
            0.33 * std::abs(project(middle + glm::dvec3(size.x, 0, 0)).x - centre.x);
        double weight_x = 0, weight_y = 0, total = 0;
        for (int y = int(centre.y - radius); y <= int(centre.y + radius); ++y) {
            for (int x = int(centre.x - radius); x <= int(centre.x + radius); ++x) {
                const double dx = x + 0.5 - centre.x, dy = y + 0.5 - centre.y;
                if (dx * dx + dy * dy > radius * radius) continue;
                const glm::vec4 c = frame->color[std::size_t(y) * request.width + std::size_t(x)];
                const double luminance = double(c.r) + double(c.g) + double(c.b);
                weight_x += luminance * dx / radius;
                weight_y += luminance * dy / radius;
                total += luminance;
            }
        }
        const double strength = std::hypot(weight_x, weight_y) / total;
        if (strength < 0.05) continue;  // metal without a highlight
        ++(size.z < 0.01 * size.x ? flat : round);
        // Up and to the left, at 45°.
        const double off = std::abs(std::remainder(
            std::atan2(weight_y, weight_x) + 0.75 * 3.14159265358979, 6.28318530718));
        // Highlights on metal follow the view: 21° at the border of the picture, 10° elsewhere. A
        // frame that is wrong by its sign or its direction turns the light by 90° and more.
        EXPECT_LT(off * 57.3, 25) << "the bump at pixel " << centre.x << ", " << centre.y;
    }
    // Three columns of five pairs, the metal ones as far as they shine.
    EXPECT_GE(flat, 10u);
    EXPECT_GE(round, 10u);
}

}  // namespace
