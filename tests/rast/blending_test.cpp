// Whole pictures added up: triangles drawn alone, one after the other, white on black. Where they
// tile the plane the sum is exactly 1, and what a closed mesh shows of its front it shows of its
// back.
#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>

#include "oracles.h"
#include "shapes.h"

namespace {

using namespace test;

constexpr int every_count[] = {1, 2, 4, 8, 16};

// The sum of the pictures of every triangle alone.
std::vector<float> added(const prep::VertexMesh& mesh, rast::RenderRequest request) {
    prep::Material material = white();
    material.unlit = true;
    prep::PreparedScene scene = test::scene_of(mesh, material);
    request.threads = 1;
    std::vector<float> sum;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        scene.meshes[0].indices.assign(mesh.indices.begin() + std::ptrdiff_t(3 * t),
                                       mesh.indices.begin() + std::ptrdiff_t(3 * t + 3));
        scene.meshes[0].ranges = {{0, 1, 0, prep::no_index}};
        const rast::Frame frame = test::draw(scene, request);
        sum.resize(frame.color.size());
        // Shares of 1/16: sums are exact.
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += frame.color[i].r;
    }
    return sum;
}

// A tilted plane of uneven triangles, wider than the picture; every fifth column is a sliver.
prep::VertexMesh uneven_plane(std::mt19937_64& random) {
    constexpr int n = 8;
    std::uniform_real_distribution<double> jitter(-0.3, 0.3);
    prep::VertexMesh mesh;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const double x = i % 5 == 4 ? i - 1 + 0.45 : i + jitter(random);
            mesh.positions.push_back(glm::vec3(
                glm::dvec3(x - n / 2, j + jitter(random) - n / 2, 0.4 * (x - n / 2)) * 1.2));
        }
    const auto upright = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const glm::dvec2 p(mesh.positions[a]), q(mesh.positions[b]), r(mesh.positions[c]);
        return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x) > 0;
    };
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            // Either diagonal where the quad is convex, else the one inside.
            const bool rising = upright(a, b, d) && upright(a, d, c);
            const bool falling = upright(a, b, c) && upright(b, d, c);
            EXPECT_TRUE(rising || falling);
            if (rising && (!falling || random() % 2))
                mesh.indices.insert(mesh.indices.end(), {a, b, d, a, d, c});
            else
                mesh.indices.insert(mesh.indices.end(), {a, b, c, b, d, c});
        }
    return mesh;
}

TEST(Blending, TiledPlanesAddUpToOneEverywhere) {
    std::mt19937_64 random(1);
    for (const int samples : every_count)
        for (int n = 0; n < 3; ++n) {
            const prep::VertexMesh mesh = uneven_plane(random);
            rast::RenderRequest request;
            request.width = 97;
            request.height = 71;
            request.samples = samples;
            // Either side, and with triangles through the near plane.
            request.cull = rast::Cull::none;
            request.view = test::look_at({0.3, 0.2, n == 1 ? -4.0 : 4.0}, {0.2, 0, 0}, 0.7,
                                         n == 2 ? 3.9 : 0.01);
            std::size_t wrong = 0, outside = 0;
            for (const float v : added(mesh, request)) {
                wrong += v != 1 && n != 2;
                outside += v > 1;
            }
            EXPECT_EQ(wrong, 0u) << samples << " " << n;
            EXPECT_EQ(outside, 0u) << samples << " " << n;
        }
}

TEST(Blending, FrontsMinusBacksOfClosedMeshesAreZero) {
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    std::size_t hit = 0;
    for (const int samples : every_count)
        for (int n = 0; n < 2; ++n) {
            prep::Mesh source = n ? shapes::torus(14, 7) : shapes::icosphere(1);
            shapes::jitter(source, n ? 0.15f : 0.7f, random);
            const prep::Mesh fans = shapes::fan_triangulated(source);
            prep::VertexMesh mesh;
            mesh.positions = fans.positions;
            mesh.indices = fans.corner_vertices;
            rast::RenderRequest request;
            request.width = 80;
            request.height = 64;
            request.samples = samples;
            request.view = test::look_at(
                glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))) * 4.0,
                {0, 0, 0});
            request.cull = rast::Cull::back;
            const std::vector<float> fronts = added(mesh, request);
            request.cull = rast::Cull::front;
            const std::vector<float> backs = added(mesh, request);
            EXPECT_EQ(fronts, backs) << samples << " " << n;
            for (const float v : fronts) hit += v > 0;
        }
    EXPECT_GT(hit, 5000u);
}

}  // namespace
