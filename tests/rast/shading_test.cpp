// What pixels look like, against pictures, planes and lights computed here in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "oracles.h"
#include "prep/image.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "shapes.h"
#include "shared_data.h"

namespace {

using namespace test;

// ------------------------------------------------------------------------------- Phong's sphere

class PhongSphere : public testing::TestWithParam<bool> {};

TEST_P(PhongSphere, EqualsTheAnalyticPicture) {
    prep::Material material;
    material.diffuse = {0.7f, 0.4f, 0.2f, 1};
    material.specular = glm::vec3(0.5f);
    material.shininess = 40;
    rast::RenderRequest request;
    request.width = 320;
    request.height = 240;
    request.shading = Shading::phong;
    request.view = GetParam() ? test::look_at({0.5, 1, 3}, {0, 0, 0}) : test::flat_view(1.2);
    request.lights = std::vector<LightInstance>{ambient(glm::vec3(0.1f)),
                                                directional({1, 2, 2}, {0.8f, 0.8f, 0.7f}),
                                                point_light({-2, 1, 2}, {1.5f, 1.5f, 2.0f})};
    const rast::Frame frame = test::draw(test::scene_of(test::sphere(512, 256), material), request);
    double squared = 0, worst_inside = 0;
    std::uint64_t silhouette = 0, covered = 0;
    for (std::uint32_t y = 0; y < frame.height; ++y)
        for (std::uint32_t x = 0; x < frame.width; ++x) {
            const Ray ray = ray_at(*request.view, frame.width, frame.height, x + 0.5, y + 0.5);
            const glm::dvec3 d = glm::normalize(ray.direction);
            const double b = glm::dot(ray.from, d), c = glm::dot(ray.from, ray.from) - 1;
            const bool hit = b * b - c > 0;
            glm::dvec3 expected(0.0);
            if (hit) {
                const glm::dvec3 p = ray.from + d * (-b - std::sqrt(b * b - c));
                expected = lit(material, *request.lights, p, glm::normalize(p), -d);
            }
            const glm::dvec3 e = pixel(frame, x, y) - expected;
            squared += glm::dot(e, e) / 3;
            covered += hit;
            if (hit == drawn(frame, x, y))
                worst_inside = std::max(worst_inside, distance(e, glm::dvec3(0.0)));
            else
                ++silhouette;
        }
    const double psnr = -10 * std::log10(squared / (double(frame.width) * double(frame.height)));
    std::printf("PSNR %.1f dB, worst inside %.2g, %llu silhouette pixels of %llu differ\n", psnr,
                worst_inside, static_cast<unsigned long long>(silhouette),
                static_cast<unsigned long long>(covered));
    RecordProperty("psnr_db", std::to_string(psnr));
    // Chords of 1/512 turn lie within 1.9e-5 radii of the sphere, 0.002 pixels: of some 600
    // silhouette pixels one or two may differ. Each weighs at most 0.3² in 76,800: above 52 dB.
    EXPECT_LE(silhouette, 4u);
    EXPECT_GE(psnr, 50.0);
    EXPECT_GT(covered, 10000u);
    // An interpolated normal is off by at most h²/8 = 1.9e-5 radians, and the point that is lit by
    // a chord's height; the highlight's slope is at most shininess^½ · specular, about 4. At the
    // rim, 0.004 pixels of snapping turn the normal by √(2 · 0.004/100): 1e-2.
    EXPECT_LT(worst_inside, 2e-2);
}

INSTANTIATE_TEST_SUITE_P(Projections, PhongSphere, testing::Bool());

// ------------------------------------------------------------------------------------ frequencies

TEST(FlatShading, FacetsHaveTheirOwnNormalsColourExactly) {
    const prep::Mesh source = shapes::icosphere(1);
    prep::VertexMesh mesh;
    mesh.positions = source.positions;
    mesh.indices = source.corner_vertices;
    prep::Material material = white();
    material.diffuse = {0.5f, 0.6f, 0.7f, 1};
    rast::RenderRequest request;
    request.width = request.height = 128;
    request.shading = Shading::flat;
    request.keep_ids = true;
    request.view = test::look_at({1, 2, 4}, {0, 0, 0});
    request.lights = std::vector<LightInstance>{ambient(glm::vec3(0.2f)),
                                                directional({1, 1, 1}, {1, 0.5, 0.25})};
    const rast::Frame frame = test::draw(test::scene_of(mesh, material), request);
    std::vector<glm::vec4> seen(mesh.triangle_count(), glm::vec4(-1.0f));
    std::size_t facets = 0;
    for (std::size_t i = 0; i < frame.color.size(); ++i) {
        const std::uint32_t t = frame.triangle[i];
        if (t == prep::no_index) continue;
        if (seen[t].r >= 0) {
            ASSERT_EQ(seen[t], frame.color[i]);  // the same bits all over a facet
            continue;
        }
        seen[t] = frame.color[i];
        ++facets;
        glm::dvec3 p[3];
        for (int k = 0; k < 3; ++k) p[k] = glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]);
        const glm::dvec3 n = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
        // A handful of float roundings of values below 1.
        ASSERT_LT(
            distance(glm::dvec3(glm::vec3(seen[t])), lit(material, *request.lights, p[0], n, n)),
            1e-6);
    }
    EXPECT_GT(facets, 20u);
}

TEST(GouraudShading, InterpolatesTheLightOfTheVertices) {
    prep::VertexMesh mesh = triangle({-1, -1, 1}, {1.2f, -0.9f, -2}, {0.1f, 1, 0});
    mesh.normals = {glm::normalize(glm::vec3(-1, 0, 1)), glm::normalize(glm::vec3(1, 0.3f, 1)),
                    glm::normalize(glm::vec3(0, 1, 1))};
    prep::Material material;
    material.specular = glm::vec3(0.6f);
    material.shininess = 8;
    material.double_sided = true;
    for (const bool from_behind : {false, true}) {
        rast::RenderRequest request;
        request.width = 200;
        request.height = 160;
        request.shading = Shading::gouraud;
        request.view =
            test::look_at(from_behind ? glm::dvec3(0.5, 0.2, -5) : glm::dvec3(0, 0, 4), {0, 0, 0});
        request.lights = std::vector<LightInstance>{
            ambient(glm::vec3(0.1f)), directional({0.2, 0.5, from_behind ? -1.0 : 1.0}, {1, 1, 1}),
            point_light({1, 0, from_behind ? -2.0 : 2.0}, {2, 1, 1})};
        const rast::Frame frame = test::draw(test::scene_of(mesh, material), request);
        glm::dvec3 p[3], light[3];
        for (int k = 0; k < 3; ++k) {
            p[k] = glm::dvec3(mesh.positions[k]);
            // A surface seen from behind is lit on that side.
            const glm::dvec3 n = glm::dvec3(mesh.normals[k]) * (from_behind ? -1.0 : 1.0);
            light[k] =
                lit(material, *request.lights, p[k], n, glm::normalize(request.view->eye() - p[k]));
        }
        std::size_t compared = 0;
        for (std::uint32_t y = 0; y < frame.height; ++y)
            for (std::uint32_t x = 0; x < frame.width; ++x) {
                if (!drawn(frame, x, y)) continue;
                const glm::dvec3 w = weights_at(
                    ray_at(*request.view, frame.width, frame.height, x + 0.5, y + 0.5), p);
                const glm::dvec3 expected = light[0] * w[0] + light[1] * w[1] + light[2] * w[2];
                // Corners are moved by up to 1/512 pixel of about 100: 4e-5 of the range, times
                // the perspective's stretch of about 2.
                ASSERT_LT(distance(pixel(frame, x, y), expected), 2e-4) << x << " " << y;
                ++compared;
            }
        EXPECT_GT(compared, 3000u);
    }
}

// ------------------------------------------------------------------------------------ attributes

// Colours of an unlit material are the interpolated attribute itself. The bound is what snapping
// can do: the change over 1/256 pixel, and some roundings.
void expect_perspective_correct(const prep::VertexMesh& mesh, const rast::View& view,
                                std::size_t at_least) {
    prep::Material material = white();
    material.unlit = true;
    material.double_sided = true;
    rast::RenderRequest request;
    request.width = 160;
    request.height = 120;
    request.view = view;
    request.keep_depth = true;
    const rast::Frame frame = test::draw(test::scene_of(mesh, material), request);
    glm::dvec3 p[3];
    for (int k = 0; k < 3; ++k) p[k] = glm::dvec3(mesh.positions[k]);
    std::size_t compared = 0;
    const auto value_at = [&](double x, double y) {
        const glm::dvec3 w = weights_at(ray_at(view, frame.width, frame.height, x, y), p);
        glm::dvec3 sum(0.0);
        for (int k = 0; k < 3; ++k) sum += w[k] * glm::dvec3(glm::vec3(mesh.colors[0][k]));
        return sum;
    };
    for (std::uint32_t y = 0; y < frame.height; ++y)
        for (std::uint32_t x = 0; x < frame.width; ++x) {
            if (!drawn(frame, x, y)) continue;
            const glm::dvec3 expected = value_at(x + 0.5, y + 0.5);
            const double slope = distance(value_at(x + 1.5, y + 0.5), expected) +
                                 distance(value_at(x + 0.5, y + 1.5), expected);
            ASSERT_LT(distance(pixel(frame, x, y), expected), slope / 128 + 3e-6) << x << " " << y;
            const glm::dvec3 w =
                weights_at(ray_at(view, frame.width, frame.height, x + 0.5, y + 0.5), p);
            const glm::dvec3 hit = w[0] * p[0] + w[1] * p[1] + w[2] * p[2];
            const double depth = rast::project(view, frame.width, frame.height, hit).depth;
            ASSERT_NEAR(frame.depth[std::size_t(y) * frame.width + x], depth, 2e-3 * depth + 1e-6);
            ++compared;
        }
    EXPECT_GE(compared, at_least);
}

prep::VertexMesh coloured(prep::VertexMesh mesh) {
    mesh.colors = {{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}}};
    return mesh;
}

TEST(Attributes, ArePerspectiveCorrect) {
    expect_perspective_correct(coloured(triangle({-2, -1, 1}, {2, -1, 1}, {0, -1.2f, -40})),
                               test::look_at({0, 0, 4}, {0, -0.5, 0}), 3000);
    expect_perspective_correct(coloured(triangle({-1, -1, 0}, {1, -1, -3}, {0, 1, 2})),
                               test::look_at({0, 0, 4}, {0, 0, 0}), 2000);
}

TEST(Attributes, ArePerspectiveCorrectWhereTheNearPlaneCuts) {
    // A floor that runs on behind the eye.
    expect_perspective_correct(coloured(triangle({-20, -1, 30}, {20, -1, 30}, {0, -1, -60})),
                               test::look_at({0, 0, 4}, {0, -0.5, 0}, 0.9, 0.1), 3000);
    // Far beyond the guard band.
    expect_perspective_correct(
        coloured(triangle({-5000, -3000, -5}, {5000, -3000, -5}, {0, 8000, -5})),
        test::look_at({0, 0, 4}, {0, 0, 0}, 0.1, 0.1), 19200);
}

TEST(Attributes, ConstantOnesStayBitConstant) {
    prep::VertexMesh mesh = triangle({-1, -1, 1.5f}, {3, -0.9f, -7}, {0.1f, 1, 0});
    mesh.colors = {{3, {0.1f, 0.7f, 0.3f, 1}}};
    prep::Material material = white();
    material.unlit = true;
    rast::RenderRequest request;
    request.width = request.height = 128;
    request.view = test::look_at({0, 0, 4}, {0, 0, 0});
    const rast::Frame frame = test::draw(test::scene_of(mesh, material), request);
    std::size_t compared = 0;
    for (const glm::vec4& c : frame.color) {
        if (c.a == 0) continue;
        ASSERT_EQ(c, glm::vec4(0.1f, 0.7f, 0.3f, 1));
        ++compared;
    }
    EXPECT_GT(compared, 1000u);
}

// ---------------------------------------------------------------------------------------- normals

// Renders a square through `transform` and gives the colour in the middle: the world normal.
glm::dvec3 normal_through(const glm::dmat4& transform, const glm::vec3& normal) {
    prep::VertexMesh mesh = square();
    mesh.normals.assign(4, normal);
    prep::Material material = white();
    material.double_sided = true;
    prep::PreparedScene scene = test::scene_of(mesh, material);
    scene.scene.nodes[0].transform = transform;
    const glm::dvec3 at(transform[3]);
    const glm::dvec3 facing = glm::cross(glm::dvec3(transform[0]), glm::dvec3(transform[1]));
    rast::RenderRequest request;
    request.width = request.height = 9;
    request.shading = Shading::phong;
    request.lights = normals_as_colours();
    // From the front, whichever way the transform turned that.
    const double flipped = glm::determinant(glm::dmat3(transform)) < 0 ? -1 : 1;
    request.view = test::look_at(at + glm::normalize(facing) * flipped * 3.0, at, 0.1);
    const rast::Frame frame = test::draw(scene, request);
    EXPECT_TRUE(drawn(frame, 4, 4));
    return pixel(frame, 4, 4);
}

TEST(Normals, FollowTheInverseTranspose) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> value(-1, 1);
    std::size_t mirrored = 0, compared = 0;
    while (compared < 200) {
        glm::dmat4 m(1.0);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) m[i][j] = value(random);
        m[3] = glm::dvec4(value(random), value(random), value(random), 1);
        const double determinant = glm::determinant(glm::dmat3(m));
        if (std::abs(determinant) < 0.05) continue;
        const glm::dvec3 n = glm::normalize(glm::dvec3(value(random), value(random), 1.5));
        const glm::dvec3 expected = glm::normalize(glm::inverse(glm::transpose(glm::dmat3(m))) * n);
        // Where all components can be read as colours.
        if (std::min({expected.x, expected.y, expected.z}) <= 0.01) continue;
        ASSERT_LT(distance(normal_through(m, glm::vec3(n)), expected), 1e-5);
        mirrored += determinant < 0;
        ++compared;
    }
    EXPECT_GT(mirrored, 30u);
}

TEST(Normals, AreRightForExtremeScales) {
    for (const double scale : {1e-18, 1e-6, 1e6, 1e15}) {
        glm::dmat4 m = glm::scale(glm::dmat4(1.0), glm::dvec3(1, 1, scale));
        const glm::dvec3 n = glm::normalize(glm::dvec3(0.6, 0.3, 0.7));
        const glm::dvec3 expected = glm::normalize(glm::dvec3(n.x, n.y, n.z / scale));
        EXPECT_LT(distance(normal_through(m, glm::vec3(n)), expected), 1e-5) << scale;
    }
}

TEST(Normals, OfAFlattenedMeshStandOnItsPlane) {
    // z is scaled to nothing: an inverse does not exist, the normal still does.
    const glm::dmat4 m = glm::scale(glm::dmat4(1.0), glm::dvec3(2, 3, 0));
    EXPECT_LT(distance(normal_through(m, glm::normalize(glm::vec3(0.6f, 0.2f, 0.7f))),
                       glm::dvec3(0, 0, 1)),
              1e-6);
}

TEST(Normals, OppositeOnesFallBackToTheFacet) {
    prep::VertexMesh mesh = triangle({-2, -2, 0}, {2, -2, 0}, {0, 2, 0});
    mesh.normals = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    rast::RenderRequest request;
    request.width = request.height = 16;
    request.shading = Shading::phong;
    request.lights = normals_as_colours();
    request.view = test::look_at({0, 0, 5}, {0, 0, 0});
    const rast::Frame frame = test::draw(test::scene_of(mesh, white()), request);
    EXPECT_LT(distance(pixel(frame, 8, 8), glm::dvec3(0, 0, 1)), 1e-6);
}

glm::dvec3 mapped_normal_through(const glm::dmat4& transform, const glm::dvec3& map,
                                 prep::NormalMapSpace space, float handedness) {
    prep::VertexMesh mesh = square();
    mesh.tangents.assign(4, {1, 0, 0, handedness});
    prep::Material material = white();
    material.double_sided = true;
    material.normal_map_space = space;
    material.normal_map.texture = 0;
    prep::PreparedScene scene = test::scene_of(mesh, material);
    scene.scene.nodes[0].transform = transform;
    scene.scene.images.push_back(image_of(glm::vec3(map * 0.5 + 0.5)));
    prep::Texture texture;
    texture.image = 0;
    scene.scene.textures.push_back(texture);
    rast::RenderRequest request;
    request.width = request.height = 9;
    request.lights = normals_as_colours();
    const glm::dvec3 facing = glm::cross(glm::dvec3(transform[0]), glm::dvec3(transform[1]));
    const double flipped = glm::determinant(glm::dmat3(transform)) < 0 ? -1 : 1;
    request.view = test::look_at(glm::normalize(facing) * flipped * 3.0, {0, 0, 0}, 0.1);
    const rast::Frame frame = test::draw(scene, request);
    EXPECT_TRUE(drawn(frame, 4, 4));
    EXPECT_TRUE(frame.warnings.empty());
    return pixel(frame, 4, 4);
}

TEST(NormalMaps, TurnWithTheirMeshAndMirrorWithIt) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> value(-1, 1);
    std::size_t compared = 0, mirrored = 0;
    while (compared < 100) {
        // A rotation, half of them with a mirror: orthogonal, so normals move as points do.
        const glm::dvec3 a =
            glm::normalize(glm::dvec3(value(random), value(random), value(random)));
        const glm::dvec3 b =
            glm::normalize(glm::cross(a, glm::dvec3(value(random), value(random), value(random))));
        const bool mirror = compared % 2;
        const glm::dmat3 m(a, b, glm::cross(a, b) * (mirror ? -1.0 : 1.0));
        const float handedness = compared % 4 < 2 ? 1.0f : -1.0f;
        const glm::dvec3 n = glm::normalize(glm::dvec3(value(random), value(random), 1.5));
        const glm::dvec3 tangent_expected = m * glm::dvec3(n.x, handedness * n.y, n.z);
        const glm::dvec3 object_expected = m * n;
        if (std::min({tangent_expected.x, tangent_expected.y, tangent_expected.z, object_expected.x,
                      object_expected.y, object_expected.z}) <= 0.01)
            continue;
        // 16-bit texels: 1.5e-5 a component of [−1, 1].
        EXPECT_LT(distance(mapped_normal_through(glm::dmat4(m), n, prep::NormalMapSpace::tangent,
                                                 handedness),
                           tangent_expected),
                  5e-5);
        EXPECT_LT(distance(mapped_normal_through(glm::dmat4(m), n, prep::NormalMapSpace::object,
                                                 handedness),
                           object_expected),
                  5e-5);
        mirrored += mirror;
        ++compared;
    }
    EXPECT_GT(mirrored, 30u);
}

TEST(NormalMaps, OfObjectSpaceFollowTheInverseTranspose) {
    const glm::dmat4 m = glm::scale(glm::dmat4(1.0), glm::dvec3(1, 0.25, 4));
    const glm::dvec3 n = glm::normalize(glm::dvec3(0.5, 0.3, 0.8));
    EXPECT_LT(distance(mapped_normal_through(m, n, prep::NormalMapSpace::object, 1),
                       glm::normalize(glm::dvec3(n.x, n.y / 0.25, n.z / 4))),
              1e-4);
}

// ------------------------------------------------------------------------------ depth and culling

TEST(Depth, RunsFromOneAtTheNearPlaneToZeroAtTheFarOne) {
    for (const bool perspective : {true, false}) {
        prep::VertexMesh floor = square();
        // Slanted from in front of the near plane to beyond the far one.
        floor.positions = {{-8, -1, 4.5f}, {8, -1, 4.5f}, {8, 1, -9}, {-8, 1, -9}};
        rast::RenderRequest request;
        request.width = 64;
        request.height = 200;
        request.keep_depth = true;
        rast::View view = test::look_at({0, 0, 5}, {0, 0, 0}, 1.2, 2);
        view.perspective = perspective;
        view.half_height = 1.5;
        view.zfar = 12;
        request.view = view;
        const rast::Frame frame = test::draw(test::scene_of(floor, white()), request);
        std::size_t compared = 0, cut = 0;
        for (std::uint32_t y = 0; y < frame.height; ++y) {
            const std::uint32_t x = 20;
            const Ray ray = ray_at(view, frame.width, frame.height, x + 0.5, y + 0.5);
            const glm::dvec3 n = glm::cross(glm::dvec3(floor.positions[1] - floor.positions[0]),
                                            glm::dvec3(floor.positions[3] - floor.positions[0]));
            const double t =
                glm::dot(glm::dvec3(floor.positions[0]) - ray.from, n) / glm::dot(ray.direction, n);
            const glm::dvec3 hit = ray.from + ray.direction * t;
            const double z = glm::dot(hit - view.eye(), view.forward());
            if (t <= 0 || std::abs(hit.y) > 1 || std::abs(hit.x) > 8) continue;
            // Perspective: n (f − z) / (z (f − n)); orthographic: (f − z) / (f − n).
            const double depth = perspective ? 2 * (12 - z) / (z * 10) : (12 - z) / 10;
            if (std::abs(z - 2) < 0.05 || std::abs(z - 12) < 0.3) continue;  // at the planes
            const bool visible = z > 2 && z < 12;
            ASSERT_EQ(drawn(frame, x, y), visible) << y << " " << z;
            cut += !visible;
            if (!visible) continue;
            ASSERT_NEAR(frame.depth[std::size_t(y) * frame.width + x], depth, 1e-3);
            ++compared;
        }
        EXPECT_GT(compared, 50u);
        EXPECT_GT(cut, 2u);
    }
}

TEST(Depth, NearerSurfacesHideFartherOnesInAnyOrder) {
    // Two planes 1e-6 of their distance apart, far away: reversed float depth still separates them.
    for (const double far : {10.0, 1e4, 1e7})
        for (const bool swapped : {false, true}) {
            prep::VertexMesh mesh = square();
            mesh.indices.clear();
            mesh.positions.clear();
            mesh.uvs.clear();
            mesh.tangents.clear();
            mesh.normals.clear();
            mesh.colors = {{}};
            for (int layer = 0; layer < 2; ++layer) {
                const bool front = (layer == 0) != swapped;
                const double z = front ? -far : -far * (1 + 1e-6);
                const std::uint32_t first = std::uint32_t(mesh.positions.size());
                for (const glm::dvec2 c : {glm::dvec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
                    mesh.positions.push_back(glm::vec3(glm::dvec3(c * far, z)));
                    mesh.colors[0].push_back(front ? glm::vec4(0, 1, 0, 1) : glm::vec4(1, 0, 0, 1));
                }
                for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u})
                    mesh.indices.push_back(first + k);
            }
            prep::Material material = white();
            material.unlit = true;
            rast::RenderRequest request;
            request.width = request.height = 64;
            request.view = rast::View{};
            const rast::Frame frame = test::draw(test::scene_of(mesh, material), request);
            for (const glm::vec4& c : frame.color) ASSERT_EQ(c, glm::vec4(0, 1, 0, 1));
        }
}

TEST(Culling, LeavesOutWhatIsAskedFor) {
    for (const bool mirrored : {false, true}) {
        const auto pixels = [&](rast::Cull cull, bool double_sided, bool from_behind) {
            prep::Material material = white();
            material.double_sided = double_sided;
            prep::PreparedScene scene = test::scene_of(square(), material);
            if (mirrored) scene.scene.nodes[0].transform[0] *= -1.0;
            rast::RenderRequest request;
            request.width = request.height = 32;
            request.cull = cull;
            request.view = test::look_at({0, 0, from_behind ? -3.0 : 3.0}, {0, 0, 0});
            return test::draw(scene, request).counters.pixels_shaded;
        };
        using rast::Cull;
        for (const bool sided : {false, true}) {
            EXPECT_GT(pixels(Cull::back, sided, false), 0u);
            EXPECT_EQ(pixels(Cull::back, sided, true), 0u);
            EXPECT_EQ(pixels(Cull::front, sided, false), 0u);
            EXPECT_GT(pixels(Cull::front, sided, true), 0u);
            EXPECT_GT(pixels(Cull::none, sided, true), 0u);
            EXPECT_GT(pixels(Cull::by_material, sided, false), 0u);
            EXPECT_EQ(pixels(Cull::by_material, sided, true) > 0, sided);
        }
    }
}

// Triangles that share no texel with another one. Where limbs share their texture by turns and
// mirrors, an object-space map can be right for one of them alone.
std::vector<bool> triangles_with_own_texels(const prep::VertexMesh& mesh) {
    constexpr int extent = 1024;
    std::vector<std::uint32_t> owner(std::size_t(extent) * extent, prep::no_index);
    std::vector<bool> own(mesh.triangle_count(), true);
    for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        glm::dvec2 p[3];
        for (int k = 0; k < 3; ++k)
            p[k] = glm::dvec2(mesh.uvs[0][mesh.indices[3 * t + k]]) * double(extent);
        const auto side = [&](int a, int b, const glm::dvec2& q) {
            return (p[b].x - p[a].x) * (q.y - p[a].y) - (p[b].y - p[a].y) * (q.x - p[a].x);
        };
        const double turn = side(0, 1, p[2]) < 0 ? -1 : 1;
        const glm::dvec2 low = glm::max(glm::floor(glm::min(p[0], glm::min(p[1], p[2]))), 0.0);
        const glm::dvec2 high = glm::min(glm::max(p[0], glm::max(p[1], p[2])), extent - 1.0);
        for (int y = int(low.y); y <= int(high.y); ++y)
            for (int x = int(low.x); x <= int(high.x); ++x) {
                const glm::dvec2 q(x + 0.5, y + 0.5);
                if (side(0, 1, q) * turn <= 0 || side(1, 2, q) * turn <= 0 ||
                    side(2, 0, q) * turn <= 0)
                    continue;
                std::uint32_t& first = owner[std::size_t(y) * extent + std::size_t(x)];
                if (first == prep::no_index)
                    first = t;
                else
                    own[first] = own[t] = false;
            }
    }
    return own;
}

// The same relief as a tangent-space and as an object-space map. Its tangent-space map was baked in
// another tangent basis than MikkTSpace's, so that the two pictures are close and not the same.
TEST(NormalMaps, OfTangentAndObjectSpaceShowTheSameRelief) {
    MESHPREP_REQUIRE_SHARED(shared);
    const std::filesystem::path folder = shared / "corpus" / "diablo3_pose";
    std::vector<bool> own_texels;
    const auto picture = [&](const char* map, prep::NormalMapSpace space, Shading shading) {
        auto scene = prep::load_scene(folder / "diablo3_pose.obj");
        if (!scene) throw std::runtime_error(prep::to_string(scene.error()));
        prep::Material material;
        material.specular = glm::vec3(0.15f);
        material.normal_map.texture = 0;
        material.normal_map_space = space;
        scene->materials = {material};
        for (prep::Mesh& mesh : scene->meshes) mesh.face_materials.assign(mesh.face_count(), 0);
        prep::ImageRef image;
        image.name = map;
        image.path = folder / map;
        scene->images = {image};
        prep::Texture texture;
        texture.image = 0;
        scene->textures = {texture};
        auto prepared = prep::prepare(*std::move(scene));
        if (!prepared) throw std::runtime_error(prep::to_string(prepared.error()));
        rast::RenderRequest request;
        request.width = request.height = 1024;
        request.shading = shading;
        request.keep_ids = true;
        rast::OrbitOptions orbit;
        orbit.aspect = 1;
        request.view = rast::orbit_view(*prepared, orbit);
        rast::Frame frame = test::draw(*prepared, request);
        EXPECT_TRUE(frame.warnings.empty());
        own_texels = triangles_with_own_texels(prepared->meshes.at(0));
        return frame;
    };
    const auto rmse = [&](const rast::Frame& a, const rast::Frame& b) {
        double squared = 0;
        std::size_t covered = 0;
        for (std::size_t i = 0; i < a.color.size(); ++i) {
            if (a.color[i].a == 0 || !own_texels[a.triangle[i]]) continue;
            const glm::vec3 d = glm::vec3(a.color[i]) - glm::vec3(b.color[i]);
            squared += double(glm::dot(d, d)) / 3;
            ++covered;
        }
        EXPECT_GT(covered, 10000u);
        return std::sqrt(squared / double(covered));
    };
    const rast::Frame object =
        picture("diablo3_pose_nm.tga", prep::NormalMapSpace::object, Shading::normal_mapped);
    const rast::Frame tangent = picture("diablo3_pose_nm_tangent.tga",
                                        prep::NormalMapSpace::tangent, Shading::normal_mapped);
    const rast::Frame smooth =
        picture("diablo3_pose_nm.tga", prep::NormalMapSpace::object, Shading::phong);
    const double same = rmse(object, tangent), without = rmse(object, smooth);
    std::printf("RMSE %.4f; without the map %.4f\n", same, without);
    RecordProperty("rmse", std::to_string(same));
    // Two 8-bit maps (a normal off by up to 0.4 degrees in each), two bakes. A wrong sign anywhere
    // gives more than the relief itself, 0.12.
    EXPECT_LT(same, 0.03);
    EXPECT_GT(without, 0.1);
}

}  // namespace
