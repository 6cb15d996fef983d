// What goes wrong in rasterizers, provoked: broken vertices, slivers, depths too close, normals
// that cancel, sharp highlights, planes seen edge-on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "exact.h"
#include "oracles.h"
#include "shapes.h"

namespace {

using namespace test;

bool finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// --------------------------------------------------------------------------------- broken vertices

// Triangles with NaN or infinite corners leave the picture as it is without them, bit for bit.
TEST(Hazards, BrokenVerticesAreCountedAndChangeNoPixel) {
    std::mt19937_64 random(1);
    const prep::VertexMesh sound = test::sphere(48, 24);
    prep::VertexMesh broken = sound;
    const std::uint32_t first = std::uint32_t(broken.positions.size());
    std::size_t added = 0;
    for (const float bad : {NAN, INFINITY, -INFINITY})
        for (int k = 0; k < 3; ++k)
            for (int n = 0; n < 50; ++n) {
                glm::vec3 p(float(n % 7) - 3, float(n % 5) - 2, 2);
                p[k] = bad;
                broken.positions.push_back(p);
                broken.normals.push_back({0, 0, 1});
                broken.uvs[0].push_back({0, 0});
                // With sound corners and with other broken ones.
                const std::uint32_t count = std::uint32_t(broken.positions.size());
                broken.indices.insert(
                    broken.indices.end(),
                    {count - 1, std::uint32_t(random() % first), std::uint32_t(random() % count)});
                ++added;
            }
    rast::RenderRequest request;
    request.width = 160;
    request.height = 120;
    request.view = test::look_at({0.3, 0.4, 3}, {0, 0, 0});
    request.lights = std::vector<LightInstance>{directional({1, 2, 3}, {1, 1, 1})};
    request.keep_depth = request.keep_ids = request.keep_normals = true;
    prep::Material material;
    material.double_sided = true;
    for (const int samples : {1, 4}) {
        request.samples = samples;
        const rast::Frame expected = test::draw(test::scene_of(sound, material), request);
        const rast::Frame frame = test::draw(test::scene_of(broken, material), request);
        EXPECT_EQ(frame.counters.non_finite, added);
        EXPECT_EQ(expected.counters.non_finite, 0u);
        EXPECT_EQ(frame.color, expected.color);
        EXPECT_EQ(frame.depth, expected.depth);
        EXPECT_EQ(frame.triangle, expected.triangle);
        EXPECT_EQ(frame.normal, expected.normal);
    }
}

// Attributes decide no coverage and no depth, and broken normals fall back.
TEST(Hazards, BrokenAttributesChangeNoCoverage) {
    const prep::VertexMesh sound = test::sphere(24, 12);
    rast::RenderRequest request;
    request.width = 96;
    request.height = 72;
    request.view = test::look_at({0.3, 0.4, 3}, {0, 0, 0});
    request.keep_depth = request.keep_ids = request.keep_normals = true;
    const rast::Frame expected = test::draw(test::scene_of(sound), request);
    for (const float bad : {NAN, INFINITY, 3e38f, -1e38f, 1e-40f}) {
        prep::VertexMesh mesh = sound;
        for (std::size_t v = 0; v < mesh.normals.size(); v += 3) mesh.normals[v].y = bad;
        for (std::size_t v = 1; v < mesh.uvs[0].size(); v += 3) mesh.uvs[0][v].x = bad;
        const rast::Frame frame = test::draw(test::scene_of(mesh), request);
        EXPECT_EQ(frame.depth, expected.depth);
        EXPECT_EQ(frame.triangle, expected.triangle);
        for (std::size_t i = 0; i < frame.color.size(); ++i) {
            ASSERT_TRUE(finite(glm::vec3(frame.color[i]))) << bad << " " << i;
            if (frame.triangle[i] == prep::no_index) continue;
            ASSERT_NEAR(glm::length(frame.normal[i]), 1, 1e-6) << bad << " " << i;
        }
    }
}

// ----------------------------------------------------------------------------------------- slivers

// Which triangles have no area on the grid of 1/256 pixels, in rationals, corners in general place.
TEST(Hazards, SliversWithoutAreaAreThoseOfExactRationals) {
    using exact::Rational;
    std::mt19937_64 random(2);
    constexpr std::uint32_t extent = 256;
    std::uniform_real_distribution<float> place(-100, 100), along(-1, 1), off(-0.006f, 0.006f);
    prep::VertexMesh mesh;
    std::uint64_t degenerate = 0;
    const auto snapped = [](float v, int sign) {  // floor(v · 256 + 1/2)
        const Rational scaled = Rational(v) * sign * 256 + Rational(1, 2);
        boost::multiprecision::cpp_int whole = numerator(scaled) / denominator(scaled);
        if (Rational(whole) > scaled) --whole;
        return whole;
    };
    constexpr std::uint32_t count = 20000;
    for (std::uint32_t t = 0; t < count; ++t) {
        glm::vec3 p[3];
        // Short and thin: about a quarter collapse on the grid.
        p[0] = {place(random), place(random), 0};
        const glm::vec2 direction(along(random), along(random));
        const float length = t % 2 ? 0.03f : 10.0f;
        for (int k = 1; k < 3; ++k)
            p[k] = p[0] + glm::vec3(direction * (length * along(random)) +
                                        glm::vec2(off(random), off(random)) * (t % 2 ? 1.f : .1f),
                                    0);
        boost::multiprecision::cpp_int x[3], y[3];
        for (int k = 0; k < 3; ++k) {
            x[k] = snapped(p[k].x, 1);
            y[k] = snapped(p[k].y, -1);
            mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
            mesh.positions.push_back(p[k]);
        }
        degenerate += (x[1] - x[0]) * (y[2] - y[0]) == (y[1] - y[0]) * (x[2] - x[0]);
    }
    prep::Material material = white();
    material.double_sided = true;
    rast::RenderRequest request;
    request.width = request.height = extent;
    request.view = test::flat_view(extent / 2);
    const rast::Frame frame = test::draw(test::scene_of(mesh, material), request);
    EXPECT_EQ(frame.counters.degenerate, degenerate);
    EXPECT_EQ(frame.counters.triangles, count);
    EXPECT_EQ(frame.counters.outside + frame.counters.crossing, 0u);
    EXPECT_GT(degenerate, count / 20);
    EXPECT_LT(degenerate, count / 2);
}

// ------------------------------------------------------------------------------------------- depth

// Two planes that face the eye: the smallest gap at which the nearer one is seen everywhere,
// whichever comes first.
double separable_gap(double distance, double znear, double zfar) {
    const auto nearer_wins = [&](double gap) {
        for (const bool swapped : {false, true}) {
            prep::PreparedScene scene;
            scene.scene.meshes.resize(2);
            for (int layer = 0; layer < 2; ++layer) {
                const bool front = (layer == 0) != swapped;
                const float side = float(3 * distance);
                prep::VertexMesh mesh = triangle({-side, -side, 0}, {side, -side, 0}, {0, side, 0});
                mesh.ranges = {{0, 1, 0, prep::no_index}};
                mesh.colors = {{3, front ? glm::vec4(0, 1, 0, 1) : glm::vec4(1, 0, 0, 1)}};
                // In the origin, in double: as floats such planes would be one.
                mesh.origin = {0, 0, -(front ? distance : distance * (1 + gap))};
                scene.meshes.push_back(mesh);
                prep::Node node;
                node.mesh = std::uint32_t(layer);
                scene.scene.nodes.push_back(node);
            }
            scene.scene.materials = {white()};
            scene.scene.materials[0].unlit = true;
            rast::RenderRequest request;
            request.width = request.height = 16;
            rast::View view;
            view.znear = znear;
            view.zfar = zfar;
            request.view = view;
            for (const glm::vec4& c : test::draw(scene, request).color)
                if (c.a > 0 && c.g == 0) return false;
        }
        return true;
    };
    double low = 1e-10, high = 1;  // relative to the distance
    EXPECT_FALSE(nearer_wins(low)) << distance;
    EXPECT_TRUE(nearer_wins(high)) << distance;
    while (high / low > 1.02) {
        const double middle = std::sqrt(low * high);
        (nearer_wins(middle) ? high : low) = middle;
    }
    return high;
}

TEST(Hazards, DepthSeparatesGapsOfOneRounding) {
    std::printf("%10s %10s %12s %12s %14s\n", "distance", "far", "gap", "theory", "24-bit fixed");
    for (const double zfar : {0.0, 1e6})
        for (const double distance : {0.02, 1.0, 37.0, 1e3, 1e5, 9e5}) {
            constexpr double znear = 0.01;
            const double gap = separable_gap(distance, znear, zfar);
            // depth = a/z + b; two of them are told apart where they round to different floats:
            // half an ulp always suffices to part them at a boundary, one ulp does everywhere.
            const double a = zfar > 0 ? znear * zfar / (zfar - znear) : znear;
            const double b = zfar > 0 ? -znear / (zfar - znear) : 0;
            const float depth = float(a / distance + b);
            const double ulp = double(depth) - double(std::nextafter(depth, 0.0f));
            // The distance at which depth has fallen by one ulp, as a part of the distance.
            const double theory = ulp * distance / (a - ulp * distance);
            // Fixed point of 24 bits with depth growing from 0 at the near plane.
            const double fixed = distance / znear / 16777216;
            std::printf("%10.3g %10.3g %12.3g %12.3g %14.3g\n", distance, zfar, gap, theory, fixed);
            EXPECT_LE(gap, theory * 1.03);
        }
}

// ----------------------------------------------------------------------------------------- normals

// Normals that point opposite ways cancel on a line across the triangle: every pixel has a unit
// normal, and those on the line the geometric one.
TEST(Hazards, OppositeNormalsAreUnitOrTheFacets) {
    for (const bool exactly : {true, false}) {
        prep::VertexMesh mesh = square();
        const float tilt = exactly ? 0.0f : 1e-3f;
        mesh.normals = {{-1, 0, tilt}, {1, 0, tilt}, {1, 0, tilt}, {-1, 0, tilt}};
        rast::RenderRequest request;
        request.width = request.height = 65;  // odd: the middle column is the line
        request.shading = Shading::phong;
        request.view = test::flat_view(1);
        request.keep_normals = true;
        request.lights = normals_as_colours();
        const rast::Frame frame = test::draw(test::scene_of(mesh, white()), request);
        std::size_t facets = 0, left = 0, right = 0;
        for (std::uint32_t y = 0; y < 65; ++y)
            for (std::uint32_t x = 0; x < 65; ++x) {
                const glm::vec3 n = frame.normal[y * 65 + x];
                ASSERT_TRUE(finite(glm::vec3(frame.color[y * 65 + x])));
                ASSERT_NEAR(glm::length(n), 1, 1e-6);
                ASSERT_GE(n.z, 0);  // on the side that is seen
                facets += n.z > 0.99f;
                left += n.x < -0.9f;
                right += n.x > 0.9f;
                if (x == 32) {
                    ASSERT_NEAR(n.z, 1, 1e-6) << y;
                }
            }
        EXPECT_GE(facets, 65u);
        EXPECT_GT(left, 1900u);
        EXPECT_GT(right, 1900u);
    }
}

// ------------------------------------------------------------------------------------- highlights

// A highlight on a flat mirror, drawn: shininess up to 1e5 against long double.
TEST(Hazards, SharpHighlightsKeepTheirDigits) {
    for (const float shininess : {1.0f, 100.0f, 1e4f, 1e5f}) {
        prep::Material material = white();
        material.diffuse = {0, 0, 0, 1};
        material.specular = glm::vec3(1.0f);
        material.shininess = shininess;
        prep::VertexMesh mesh = square();
        for (glm::vec3& p : mesh.positions) p *= 8;
        rast::RenderRequest request;
        request.width = request.height = 129;
        request.shading = Shading::phong;
        rast::View view = test::look_at({0, 0, 10}, {0, 0, 0}, shininess > 1000 ? 0.02 : 0.5);
        request.view = view;
        request.lights = std::vector<LightInstance>{directional({0, 0, 1}, {1, 1, 1})};
        const rast::Frame frame = test::draw(test::scene_of(mesh, material), request);
        long double worst = 0;
        std::size_t compared = 0;
        for (std::uint32_t y = 0; y < 129; ++y)
            for (std::uint32_t x = 0; x < 129; ++x) {
                const Ray ray = ray_at(view, 129, 129, x + 0.5, y + 0.5);
                // Half vector between +z and −direction; the angle to the normal +z is half of the
                // angle between them.
                const long double dx = ray.direction.x, dy = ray.direction.y;
                const long double half = std::atan(std::sqrt(dx * dx + dy * dy)) / 2;
                const long double expected = std::pow(std::cos(half), (long double)shininess);
                if (expected < 1e-4L) continue;
                const long double value = frame.color[std::size_t(y) * 129 + x].r;
                worst = std::max(worst, std::abs(value - expected) / expected);
                ++compared;
            }
        std::printf("shininess %g: worst relative error %.2Lg over %zu pixels\n", double(shininess),
                    worst, compared);
        EXPECT_GT(compared, 100u);
        // The half vector is a float: off by 6e-8 across, at a tangent of up to 0.014 for 1e-4.
        EXPECT_LT(worst, 1e-5L + 2e-9L * (long double)shininess);
    }
}

// ----------------------------------------------------------------------------------- edge-on
// planes

// A textured plane that turns until it is seen edge-on, and past that: finite everywhere, and a
// constant texture keeps its colour through every filter.
TEST(Hazards, EdgeOnPlanesAreFiniteAndKeepAConstantTexture) {
    prep::Material material = white();
    material.unlit = true;
    material.double_sided = true;
    material.diffuse_map.texture = 0;
    prep::VertexMesh mesh = square();
    for (glm::vec3& p : mesh.positions) p *= 20;
    for (glm::vec2& t : mesh.uvs[0]) t *= 40;
    prep::PreparedScene scene = test::scene_of(mesh, material);
    prep::Texture sampler;
    sampler.image = 0;
    scene.scene.textures.push_back(sampler);
    scene.scene.images.push_back(image_of(glm::vec3(1.0f, 0.5f, 0.2f), 32));
    std::size_t drawn_pixels = 0, edge_on = 0;
    double worst = 0;
    for (const rast::TextureFilter filter :
         {rast::TextureFilter::nearest, rast::TextureFilter::bilinear,
          rast::TextureFilter::nearest_mip, rast::TextureFilter::trilinear,
          rast::TextureFilter::bicubic, rast::TextureFilter::anisotropic,
          rast::TextureFilter::ripmap, rast::TextureFilter::ewa}) {
        rast::RenderRequest request;
        request.width = 64;
        request.height = 48;
        request.filter = filter;
        request.max_anisotropy = 16;
        std::optional<glm::vec4> colour;
        for (const double degrees :
             {0.0, 30.0, 60.0, 80.0, 89.0, 89.9, 89.99, 89.9999, 90.0, 90.0001, 91.0, 120.0}) {
            const double turn = degrees * std::numbers::pi / 180;
            // The eye a hair above the plane's middle line, so that edge-on still shows it.
            for (const double lift : {0.0, 1e-5, 1e-2}) {
                const glm::dvec3 eye(0.1, -25 * std::sin(turn), 25 * std::cos(turn) + lift);
                request.view = test::look_at(eye, {0.1, 0, lift});
                const rast::Frame frame = test::draw(scene, request);
                for (const glm::vec4& c : frame.color) {
                    ASSERT_TRUE(finite(glm::vec3(c)));
                    if (c.a == 0) continue;
                    if (!colour) colour = c;
                    for (int k = 0; k < 3; ++k)
                        worst = std::max(worst, std::abs(double(c[k]) / double((*colour)[k]) - 1));
                    ++drawn_pixels;
                    edge_on += std::abs(degrees - 90) < 0.5;
                }
            }
        }
    }
    std::printf("%zu pixels, %zu edge-on, worst relative error %.2g\n", drawn_pixels, edge_on,
                worst);
    // Sums of mip levels round by half an ulp each.
    EXPECT_LT(worst, 6 * 6e-8);
    EXPECT_GT(drawn_pixels, 100000u);
    EXPECT_GT(edge_on, 300u);
}

}  // namespace
