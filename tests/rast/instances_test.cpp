// Meshes in turned, stretched and mirrored nodes: where they are drawn and which side of them,
// whichever way triangles are drawn.
#include <glm/gtc/matrix_transform.hpp>

#include "reference_shading.h"

namespace {

using namespace test;

// A mesh about an origin is what it would be about zero, in any node.
TEST(Instances, MeshesAboutAnOriginLieWhereTheirNodePutsThem) {
    prep::PreparedScene scene = test::scene_of(square(), white());
    scene.meshes[0].origin = {1000, -2000, 500};
    glm::dmat4 node = glm::translate(glm::dmat4(1.0), {-30, 40, 50});
    node = glm::rotate(node, 0.8, glm::normalize(glm::dvec3(1, 2, 3)));
    node = glm::scale(node, {1.5, 2, 0.5});
    scene.scene.nodes[0].transform = node;
    const auto world = [&](const glm::dvec3& p) {
        return glm::dvec3(node * glm::dvec4(p + scene.meshes[0].origin, 1));
    };
    rast::RenderRequest request;
    request.width = request.height = 64;
    request.cull = rast::Cull::none;
    request.keep_positions = true;
    request.view = test::look_at(world({0, 0, 9}), world({0, 0, 0}), 0.7);
    const rast::Frame frame = test::draw(scene, request);
    std::size_t seen = 0;
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) {
            const Ray ray = ray_at(*request.view, 64, 64, x + 0.5, y + 0.5);
            // The ray in the mesh's own space, where the square is [−1, 1]² at z = 0.
            const glm::dmat4 back = glm::inverse(node);
            const glm::dvec3 from = glm::dvec3(back * glm::dvec4(ray.from, 1)) -
                                    scene.meshes[0].origin,
                             along = glm::dvec3(back * glm::dvec4(ray.direction, 0));
            const glm::dvec3 hit = from - along * (from.z / along.z);
            const double reach = std::max(std::abs(hit.x), std::abs(hit.y));
            if (std::abs(reach - 1) < 0.05) continue;
            ASSERT_EQ(drawn(frame, x, y), reach < 1) << x << " " << y;
            if (reach > 1) continue;
            ++seen;
            ASSERT_LT(
                distance(glm::dvec3(frame.position[y * 64 + x]) + request.view->eye(), world(hit)),
                0.02);  // corners are moved by 1/512 of pixels of 0.1
        }
    EXPECT_GT(seen, 100u);
}

// Ids are the node's number and the triangle's within its mesh, also of a second material.
TEST(Instances, AreNumberedByTheirNodesAndTrianglesByTheirMesh) {
    prep::PreparedScene scene = test::scene_of(square(), white());
    scene.meshes[0].ranges = {{0, 1, 0, prep::no_index}, {1, 1, prep::no_index, prep::no_index}};
    prep::Node left = scene.scene.nodes[0], right = left, empty;
    empty.mesh = prep::no_index;
    left.transform[3] = {-1.5, 0, 0, 1};
    right.transform[3] = {1.5, 0, 0, 1};
    scene.scene.nodes = {empty, left, empty, empty, right};
    rast::RenderRequest request;
    request.width = 64;
    request.height = 32;
    request.keep_ids = true;
    request.view = test::flat_view(1.5);
    const rast::Frame frame = test::draw(scene, request);
    std::size_t seen = 0;
    for (std::uint32_t y = 0; y < 32; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) {
            const std::size_t i = y * 64 + x;
            const glm::dvec3 p = ray_at(*request.view, 64, 32, x + 0.5, y + 0.5).from;
            const double in_x = p.x - (p.x < 0 ? -1.5 : 1.5);
            if (std::abs(in_x) > 0.99 || std::abs(p.y) > 0.99) continue;
            if (std::abs(in_x - p.y) < 0.05) continue;  // the diagonal
            ++seen;
            ASSERT_EQ(frame.instance[i], p.x < 0 ? 1u : 4u);
            ASSERT_EQ(frame.triangle[i], in_x > p.y ? 0u : 1u) << x << " " << y;
        }
    EXPECT_GT(seen, 700u);
}

// The front stays what the mesh's author saw as the front (docs/conventions.md).
TEST(Instances, MirroredOnesKeepTheirFrontsWhicheverWayTheyAreDrawn) {
    enum { samples, several_samples, areas, across_the_near_plane, areas_across_the_near_plane };
    for (const int how : {int(samples), int(several_samples), int(areas),
                          int(across_the_near_plane), int(areas_across_the_near_plane)})
        for (const bool mirrored : {false, true})
            for (const bool from_below : {false, true})
                for (const rast::Cull cull : {rast::Cull::back, rast::Cull::front}) {
                    prep::Material material = white();
                    material.unlit = true;
                    prep::PreparedScene scene = test::scene_of(floor_of(3), material);
                    if (mirrored) scene.scene.nodes[0].transform[0] *= -1.0;
                    const double side = from_below ? -1 : 1;
                    rast::RenderRequest request;
                    request.width = request.height = 32;
                    request.cull = cull;
                    if (how == several_samples) request.samples = 4;
                    if (how == areas || how == areas_across_the_near_plane)
                        request.coverage = rast::Coverage::area;
                    request.view = how >= across_the_near_plane
                                       ? test::look_at({0, 0, side * 0.5}, {0, 3, 0}, 1, 0.1)
                                       : test::look_at({0, 0, side * 5}, {0, 0, 0}, 1);
                    const rast::Frame frame = test::draw(scene, request);
                    std::size_t seen = 0;
                    for (const glm::vec4& c : frame.color) seen += c.a > 0;
                    const bool front = !from_below;
                    EXPECT_EQ(seen > 0, front == (cull == rast::Cull::back))
                        << how << mirrored << from_below << int(cull);
                }
}

}  // namespace
