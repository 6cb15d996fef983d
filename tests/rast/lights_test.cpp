// Lights against KHR_lights_punctual in closed form, on every instruction set: on a floor whose
// pixels all see them from another angle and distance.
#include <glm/gtc/matrix_transform.hpp>

#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "reference_shading.h"

namespace {

using namespace test;

LightInstance spot_light(const glm::dvec3& position, const glm::dvec3& direction,
                         const glm::vec3& color, float inner, float outer) {
    LightInstance light = point_light(position, color);
    light.kind = LightKind::spot;
    light.direction = glm::normalize(direction);
    light.inner_cone = inner;
    light.outer_cone = outer;
    return light;
}

prep::Material glossy() {
    prep::Material material;
    material.diffuse = {0.7f, 0.5f, 0.3f, 1};
    material.specular = {0.3f, 0.4f, 0.5f};
    material.shininess = 12;
    material.ambient = {0.5f, 0.25f, 1.0f};
    return material;
}

// From a distance at which a unit of the floor is 10 pixels: its corners lie on the grid that
// corners are moved to, and no pixel's place is off.
rast::RenderRequest floor_request(std::vector<LightInstance> lights) {
    rast::RenderRequest request;
    request.width = 53;  // no multiple of any lane count
    request.height = 40;
    request.view = test::look_at({0.4, -0.7, 4}, {0.4, -0.7, 0}, 2 * std::atan(0.5));
    request.lights = std::move(lights);
    return request;
}

// The floor under these lights. Colours are of order one, places of order four: 1e-5 has room for
// some dozens of roundings.
void expect_floor(const prep::Material& material, const std::vector<LightInstance>& lights,
                  double bound = 1e-5) {
    const rast::RenderRequest request = floor_request(lights);
    const Surface surface = from_factors(material);
    const std::size_t compared =
        expect_pixels(test::scene_of(floor_of(4), material), request, bound, [&](auto x, auto y) {
            const Floor at = floor_at(request, x, y);
            return reflected(surface, lights, at.position, {0, 0, 1}, at.to_eye);
        });
    EXPECT_GT(compared, 2000u);
}

// ------------------------------------------------------------------------------------------ spots

TEST(SpotLights, FallOffBetweenTheirConesAsKhrLightsPunctualHasIt) {
    for (const glm::vec2 cones :
         {glm::vec2(0.0f, 0.785398163f), {0.2f, 0.5f}, {0.0f, 1.57079632f}, {0.45f, 0.6f}}) {
        SCOPED_TRACE("cones " + std::to_string(cones.x) + " and " + std::to_string(cones.y));
        expect_floor(glossy(),
                     {spot_light({0.3, -0.2, 2}, {0.1, 0.15, -1}, {3, 2.5f, 2}, cones.x, cones.y)});
    }
    // Closer than 0.001 in their cosines, where KHR_lights_punctual's sample code is darker than
    // its text. Roundings of a cosine, some 3e-7, come out a thousand times as large and twice that
    // when squared.
    expect_floor(glossy(), {spot_light({0.3, -0.2, 2}, {0.1, 0.15, -1}, {3, 2, 1}, 0.4f, 0.402f)},
                 1e-3);
}

TEST(SpotLights, NarrowConesHaveAllOfTheLightOnTheirAxis) {
    for (const glm::vec2 cones : {glm::vec2(0.03f, 0.05f), {0.03f, 0.04f}, {0.03f, 0.031f}}) {
        const rast::RenderRequest request =
            floor_request({spot_light({0, 0, 2}, {0, 0, -1}, {4, 4, 4}, cones.x, cones.y)});
        const rast::RenderRequest wide =
            floor_request({spot_light({0, 0, 2}, {0, 0, -1}, {4, 4, 4}, 0.5f, 0.6f)});
        const rast::Frame frame = test::draw(test::scene_of(floor_of(4), white()), request);
        const rast::Frame all = test::draw(test::scene_of(floor_of(4), white()), wide);
        std::size_t inside = 0;
        for (std::uint32_t y = 0; y < frame.height; ++y)
            for (std::uint32_t x = 0; x < frame.width; ++x) {
                if (!drawn(frame, x, y)) continue;
                const glm::dvec3 p = floor_at(request, x, y).position;
                if (std::atan(std::hypot(p.x, p.y) / 2) > 0.9 * double(cones.x)) continue;
                const std::size_t at = std::size_t(y) * frame.width + x;
                EXPECT_EQ(frame.color[at], all.color[at]) << cones.x;
                ++inside;
            }
        EXPECT_GT(inside, 0u) << cones.x;
    }
}

TEST(SpotLights, ShineFullyWithinTheInnerConeAndNotAtAllBeyondTheOuterOne) {
    const LightInstance spot = spot_light({0, 0, 2}, {0, 0, -1}, {4, 4, 4}, 0.2f, 0.4f);
    prep::Material material = white();
    const rast::RenderRequest request = floor_request({spot});
    const rast::Frame frame = test::draw(test::scene_of(floor_of(4), material), request);
    std::size_t inside = 0, outside = 0;
    for (std::uint32_t y = 0; y < frame.height; ++y)
        for (std::uint32_t x = 0; x < frame.width; ++x) {
            if (!drawn(frame, x, y)) continue;
            const glm::dvec3 p = floor_at(request, x, y).position;
            const double angle = std::atan(std::hypot(p.x, p.y) / 2);
            const double r2 = glm::dot(p, p) + 4;
            if (angle < 0.199) {
                EXPECT_NEAR(pixel(frame, x, y).r, 4 / r2 * std::cos(angle), 1e-5);
                ++inside;
            } else if (angle > 0.401) {
                EXPECT_EQ(pixel(frame, x, y).r, 0);
                ++outside;
            }
        }
    EXPECT_GT(inside, 50u);
    EXPECT_GT(outside, 500u);
}

// ------------------------------------------------------------------------------- range and falloff

TEST(PointLights, FadeOutTowardsTheirRange) {
    for (const float range : {0.0f, 1.2f, 2.0f, 3.5f, 100.0f}) {
        LightInstance light = point_light({-0.3, 0.4, 1}, {1.5f, 1, 0.5f});
        light.range = range;
        SCOPED_TRACE("range " + std::to_string(range));
        expect_floor(glossy(), {light});
    }
}

TEST(PointLights, SendNothingBeyondTheirRange) {
    LightInstance light = point_light({0, 0, 1}, {5, 5, 5});
    light.range = 1.5f;
    LightInstance spot = spot_light({0, 0, 1}, {0, 0, -1}, {5, 5, 5}, 1.0f, 1.5f);
    spot.range = 1.5f;
    const rast::RenderRequest request = floor_request({light, spot});
    const rast::Frame frame = test::draw(test::scene_of(floor_of(4), glossy()), request);
    std::size_t beyond = 0, within = 0;
    for (std::uint32_t y = 0; y < frame.height; ++y)
        for (std::uint32_t x = 0; x < frame.width; ++x) {
            if (!drawn(frame, x, y)) continue;
            const double r = glm::distance(floor_at(request, x, y).position, glm::dvec3(0, 0, 1));
            if (r > 1.501) {
                EXPECT_EQ(pixel(frame, x, y), glm::dvec3(0.0));
                ++beyond;
            } else if (r < 1.4) {
                EXPECT_GT(pixel(frame, x, y).r, 0.05);
                ++within;
            }
        }
    EXPECT_GT(beyond, 500u);
    EXPECT_GT(within, 100u);
}

// At distance zero 1/r² has no value: such a light adds nothing, and no NaN.
TEST(PointLights, OnTheSurfaceAddNothing) {
    rast::RenderRequest request;
    request.width = request.height = 9;
    request.view = test::look_at({0, 0, 3}, {0, 0, 0});
    request.lights =
        std::vector<LightInstance>{ambient(glm::vec3(0.25f)), point_light({0, 0, 0}, {1, 1, 1})};
    for (const prep::SimdLevel level : every_level()) {
        request.simd = level;
        const rast::Frame frame = test::draw(test::scene_of(square(), white()), request);
        EXPECT_EQ(pixel(frame, 4, 4), glm::dvec3(0.25)) << prep::to_string(level);
    }
}

// --------------------------------------------------------------------------------------- all kinds

std::vector<LightInstance> one_of_each() {
    LightInstance ranged = point_light({1, 1, 1.5}, {0.2f, 0.9f, 0.4f});
    ranged.range = 4;
    LightInstance spot = spot_light({-1, -0.5, 2}, {0.3, 0, -1}, {2, 1, 3}, 0.1f, 0.7f);
    spot.range = 5;
    return {ambient({0.1f, 0.2f, 0.3f}), directional({-1, 2, 3}, {0.6f, 0.3f, 0.1f}), ranged,
            ambient({0.05f, 0.0f, 0.01f}), spot};
}

TEST(Lights, OfAllKindsAddUp) {
    expect_floor(glossy(), one_of_each());
    prep::Material material = glossy();
    material.emissive = {0.3f, 0.02f, 1.5f};  // above 1: KHR_materials_emissive_strength
    expect_floor(material, one_of_each());
}

// The renderer proves preparation: it casts no shadows (README, "Limits, honestly").
TEST(Lights, FallThroughWhatStandsBetween) {
    LightInstance sun;
    sun.kind = LightKind::directional;
    sun.direction = glm::normalize(glm::dvec3(0.1, 0.2, -1));
    sun.color = {0.5f, 0.25f, 0.125f};
    const rast::RenderRequest request =
        floor_request({point_light({0.2, 0.1, 8}, {30, 20, 10}), sun});
    prep::PreparedScene scene = test::scene_of(floor_of(4), glossy());
    const rast::Frame open = test::draw(scene, request);
    // A sheet as wide as the floor behind the eye, between it and both lights.
    prep::Node node;
    node.mesh = 0;
    node.transform = glm::translate(glm::dmat4(1), {0, 0, 5});
    scene.scene.nodes.push_back(node);
    const rast::Frame covered = test::draw(scene, request);
    EXPECT_EQ(open.color, covered.color);
}

TEST(Lights, DirectionalOnesShineAlongTheirDirection) {
    // Downwards onto a floor that faces up, in full; upwards from below, nothing.
    for (const double z : {-1.0, 1.0}) {
        LightInstance light;
        light.direction = {0, 0, z};
        light.color = {0.5f, 0.25f, 0.125f};
        const rast::Frame frame =
            test::draw(test::scene_of(floor_of(4), white()), floor_request({light}));
        EXPECT_LT(
            distance(pixel(frame, 20, 20), z < 0 ? glm::dvec3(0.5, 0.25, 0.125) : glm::dvec3(0.0)),
            1e-6);
    }
}

// Light at vertices, then interpolated: the same lights at three places.
TEST(Lights, OfAllKindsAreTakenAtVerticesByGouraud) {
    prep::VertexMesh mesh = triangle({-2, -1.5f, 0}, {2, -1, 0}, {0.5f, 1.75f, 0});
    mesh.normals.assign(3, {0, 0, 1});
    rast::RenderRequest request = floor_request(one_of_each());
    request.shading = Shading::gouraud;
    for (const bool metallic : {false, true}) {
        prep::Material material = glossy();
        material.metallic_roughness = metallic;
        material.metallic = 0.3f;
        material.roughness = 0.6f;
        const Surface surface = metallic ? from_metallic_roughness({0.7f, 0.5f, 0.3f}, 0.3f, 0.6f)
                                         : from_factors(material);
        Surface s = surface;
        if (metallic) s.ambient *= glm::dvec3(material.ambient);
        glm::dvec3 p[3], light[3];
        for (int k = 0; k < 3; ++k) {
            p[k] = glm::dvec3(mesh.positions[std::size_t(k)]);
            light[k] = reflected(s, *request.lights, p[k], {0, 0, 1},
                                 glm::normalize(request.view->eye() - p[k]));
        }
        const std::size_t compared =
            expect_pixels(test::scene_of(mesh, material), request, 1e-5, [&](auto x, auto y) {
                const glm::dvec3 w = weights_at(
                    ray_at(*request.view, request.width, request.height, x + 0.5, y + 0.5), p);
                return light[0] * w[0] + light[1] * w[1] + light[2] * w[2];
            });
        EXPECT_GT(compared, 400u);
    }
}

// ---------------------------------------------------------------------------- a scene's own lights

prep::Node node_of(const glm::dmat4& transform, std::uint32_t parent = prep::no_index) {
    prep::Node node;
    node.transform = transform;
    node.parent = parent;
    return node;
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b) {
    EXPECT_LT(distance(a, b), 1e-12) << a.x << " " << a.y << " " << a.z;
}

TEST(SceneLights, ShineAlongTheirNodesNegativeZFromItsOrigin) {
    prep::Scene scene;
    // The parent is turned by a quarter about +Y, so that its −Z is the world's −X, stretched and
    // moved; the child is turned about its own X, which tips its −Z downwards.
    const double quarter = std::acos(-1.0) / 2;
    glm::dmat4 parent = glm::translate(glm::dmat4(1.0), {10, 20, 30});
    parent = glm::rotate(parent, quarter, {0, 1, 0});
    parent = glm::scale(parent, glm::dvec3(2.0));
    glm::dmat4 child = glm::translate(glm::dmat4(1.0), {1, 0, 0});
    child = glm::rotate(child, -quarter, {1, 0, 0});
    scene.nodes = {node_of(child, 1), node_of(parent), node_of(glm::dmat4(1.0)),
                   node_of(glm::scale(glm::dmat4(1.0), glm::dvec3(0.0)))};
    prep::Light spot;
    spot.kind = LightKind::spot;
    spot.color = {0.5f, 0.25f, 1};
    spot.intensity = 6;
    spot.range = 7;
    spot.inner_cone = 0.25f;
    spot.outer_cone = 0.75f;
    prep::Light sun;
    sun.kind = LightKind::directional;
    sun.color = {1, 2, 3};
    sun.intensity = 0.5f;
    scene.lights = {sun, spot};
    scene.nodes[0].light = 1;
    scene.nodes[1].light = 0;
    scene.nodes[3].light = 0;
    const std::vector<LightInstance> lights = rast::scene_lights(scene);
    ASSERT_EQ(lights.size(), 3u);
    EXPECT_EQ(lights[0].kind, LightKind::spot);
    // The child's (1, 0, 0), doubled and turned: +X becomes −Z.
    expect_near(lights[0].position, {10, 20, 28});
    expect_near(lights[0].direction, {0, -1, 0});
    EXPECT_EQ(lights[0].color, glm::vec3(3, 1.5f, 6));
    EXPECT_EQ(lights[0].range, 7);  // no property of a light changes with its node's scale
    EXPECT_EQ(lights[0].inner_cone, 0.25f);
    EXPECT_EQ(lights[0].outer_cone, 0.75f);
    EXPECT_EQ(lights[1].kind, LightKind::directional);
    expect_near(lights[1].direction, {-1, 0, 0});
    EXPECT_EQ(lights[1].color, glm::vec3(0.5f, 1, 1.5f));
    expect_near(lights[2].direction, {0, 0, -1});  // without a direction of its own
}

// From the file to the picture: a floor and three lights below a moved and turned node.
TEST(SceneLights, OfAFileLightItsPicture) {
    const char* const text = R"({
      "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
      "extensionsUsed": ["KHR_lights_punctual"],
      "extensions": {"KHR_lights_punctual": {"lights": [
        {"type": "directional", "color": [0.5, 0.25, 1], "intensity": 0.5},
        {"type": "point", "color": [0.25, 1, 0.5], "intensity": 3, "range": 3.5},
        {"type": "spot", "color": [1, 0.5, 0.75], "intensity": 8, "range": 6,
         "spot": {"innerConeAngle": 0.3, "outerConeAngle": 0.6}}]}},
      "nodes": [
        {"mesh": 0},
        {"translation": [0.5, 0.25, 1.5], "rotation": [0, 0.6, 0, 0.8], "scale": [2, 2, 2],
         "children": [2, 3, 4]},
        {"rotation": [0, -0.6, 0, 0.8], "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"translation": [0.1, -0.2, 0.3], "extensions": {"KHR_lights_punctual": {"light": 1}}},
        {"rotation": [0, -0.28, 0, 0.96], "extensions": {"KHR_lights_punctual": {"light": 2}}}],
      "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.6, 0.3, 1],
                     "metallicFactor": 0.25, "roughnessFactor": 0.5}}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
      "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
         "min": [-4, -4, 0], "max": [4, 4, 0]},
        {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"}],
      "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48,
                       "byteLength": 6}],
      "buffers": [{"byteLength": 54, "uri": "data:application/octet-stream;base64,)"
                             "AACAwAAAgMAAAAAAAACAQAAAgMAAAAAAAACAQAAAgEAAAAAAAACAwAAAgEAAAAAA"
                             "AAECAAID"
                             R"("}]})";
    const TempDir folder;
    write_text(folder / "lights.gltf", text);
    auto scene = prep::load_scene(folder / "lights.gltf");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const auto prepared = prep::prepare(*std::move(scene));
    ASSERT_TRUE(prepared.has_value());

    // About +Y by twice the angle whose sine is 0.6: cosine 0.28, sine 0.96.
    const auto about_y = [](double sine, double cosine, const glm::dvec3& v) {
        const double s = 2 * sine * cosine, c = cosine * cosine - sine * sine;
        return glm::dvec3(c * v.x + s * v.z, v.y, c * v.z - s * v.x);
    };
    const auto through_parent = [&](const glm::dvec3& v) { return about_y(0.6, 0.8, v); };
    LightInstance sun = directional({0, 0, 1}, {0.25f, 0.125f, 0.5f});
    sun.direction = {0, 0, -1};  // the child turns back what the parent turned
    LightInstance point =
        point_light(glm::dvec3(0.5, 0.25, 1.5) + through_parent(glm::dvec3(0.1, -0.2, 0.3) * 2.0),
                    {0.75f, 3, 1.5f});
    point.range = 3.5f;
    LightInstance spot = spot_light(
        {0.5, 0.25, 1.5}, through_parent(about_y(-0.28, 0.96, {0, 0, -1})), {8, 4, 6}, 0.3f, 0.6f);
    spot.range = 6;
    const std::vector<LightInstance> lights{sun, point, spot};
    rast::RenderRequest request = floor_request({});
    request.lights.reset();
    const Surface surface = from_metallic_roughness({0.9f, 0.6f, 0.3f}, 0.25, 0.5);
    const std::size_t compared = expect_pixels(*prepared, request, 1e-5, [&](auto x, auto y) {
        const Floor at = floor_at(request, x, y);
        return reflected(surface, lights, at.position, {0, 0, 1}, at.to_eye);
    });
    EXPECT_GT(compared, 2000u);
}

// -------------------------------------------------------------------------------- where there are
// none

// rast/view.h says which.
TEST(DefaultLights, AreAKeyAFillARimAndALittleAmbientLightThatStandWithTheView) {
    for (const glm::dvec3 eye : {glm::dvec3(0, 0, 5), {3, 2, -1}}) {
        rast::RenderRequest request;
        request.view = test::look_at(eye, {0, 0, 0});
        const auto plan = rast::plan(test::scene_of(square()), request);
        ASSERT_TRUE(plan.has_value());
        ASSERT_EQ(plan->lights.size(), 4u);
        const glm::dmat3 to_view(request.view->world_to_view);
        const auto from = [&](std::size_t l) { return to_view * -plan->lights[l].direction; };
        const glm::dvec3 expected[] = {{-0.55, 0.65, 0.75}, {0.9, 0.15, 0.6}, {0.3, 0.7, -0.9}};
        const glm::vec3 colors[] = {
            {0.85f, 0.833f, 0.799f}, {0.252f, 0.266f, 0.28f}, {0.45f, 0.45f, 0.45f}};
        for (std::size_t l = 0; l < 3; ++l) {
            EXPECT_EQ(plan->lights[l].kind, LightKind::directional);
            expect_near(from(l), glm::normalize(expected[l]));
            EXPECT_LT(distance(glm::dvec3(plan->lights[l].color), glm::dvec3(colors[l])), 1e-6);
        }
        EXPECT_EQ(plan->lights[3].kind, LightKind::ambient);
        EXPECT_EQ(plan->lights[3].color, glm::vec3(0.08f));
    }
}

// What none of the three reaches, as the inside of a box's bottom seen from above, is 8 % of the
// material's colour.
TEST(DefaultLights, LeaveShadowsAtTheAmbientLight) {
    prep::VertexMesh mesh = square();
    mesh.normals.assign(4, {0, -1, 0});  // downwards, where no light comes from
    rast::RenderRequest request;
    request.width = request.height = 9;
    request.view = test::look_at({0, 0, 4}, {0, 0, 0});
    prep::Material material;
    material.diffuse = {0.5f, 1.0f, 0.25f, 1};
    const rast::Frame frame = test::draw(test::scene_of(mesh, material), request);
    EXPECT_LT(distance(pixel(frame, 4, 4), {0.04, 0.08, 0.02}), 1e-6);
}

TEST(DefaultLights, AreLeftOutWhereTheSceneHasLightsOrTheRequestNamesNone) {
    prep::PreparedScene scene = test::scene_of(square());
    rast::RenderRequest request;
    request.lights = std::vector<LightInstance>{};
    EXPECT_TRUE(rast::plan(scene, request)->lights.empty());
    request.lights.reset();
    scene.scene.lights.emplace_back();
    scene.scene.nodes[0].light = 0;
    EXPECT_EQ(rast::plan(scene, request)->lights.size(), 1u);
}

}  // namespace
