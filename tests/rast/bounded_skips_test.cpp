// Lights that are left out because they are faint: no pixel differs by more than is allowed, what
// they could add is seen where a scene is made for it, and nothing goes unless it is asked for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "oracles.h"
#include "skip_stage.h"

namespace {

using prep::LightKind;
using prep::Material;
using rast::Shading;
using test::light_of;
using test::stage_request;

std::vector<prep::Reason> faint_lights(const rast::RenderPlan& plan) {
    std::vector<prep::Reason> out;
    for (const rast::PlanStep& step : plan.steps)
        for (const prep::Reason& why : step.reasons)
            if (why.code == prep::ReasonCode::light_faint) out.push_back(why);
    return out;
}

// How far two pictures are apart in any channel. What rounding of the other lights' sum moves is
// no part of what was left out: at most 2^-20 of a pixel's value.
double greatest_difference(const rast::Frame& a, const rast::Frame& b) {
    EXPECT_EQ(a.color.size(), b.color.size());
    double most = 0;
    for (std::size_t i = 0; i < a.color.size(); ++i) {
        EXPECT_EQ(a.color[i].a, b.color[i].a);
        for (int k = 0; k < 3; ++k) {
            const double x = double(a.color[i][k]), y = double(b.color[i][k]);
            if (x == y || (std::isnan(x) && std::isnan(y))) continue;
            const double apart = std::abs(x - y) - 0x1p-20 * std::max(std::abs(x), std::abs(y));
            most = std::isnan(apart) ? HUGE_VAL : std::max(most, apart);
        }
    }
    return most;
}

TEST(BoundedSkips, DifferByNoMoreThanIsAllowedOnRandomScenes) {
    int left_out = 0, several = 0, seen = 0;
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        const prep::PreparedScene scene = test::prepared_random_scene(seed);
        rast::RenderRequest request = test::random_request(seed);
        // Beside the scene's own, which mostly are among its meshes, where nothing bounds them.
        const auto plan = rast::plan(scene, request);
        ASSERT_TRUE(plan);
        test::RandomNumbers r(seed + 0x20000);
        request.lights = plan->lights;
        for (int l = 0; l < 3; ++l) {
            const glm::dvec3 at(r.between(-30, 30), r.between(-30, 30), r.between(-30, 30));
            request.lights->push_back(light_of(LightKind(1 + r.below(3)),
                                               {r.between(0, 1), r.between(0, 1), r.between(0, 1)},
                                               at, -at, r.chance(0.5) ? 0 : r.between(20, 90)));
        }
        const rast::Frame full = test::draw_in_full(scene, request);
        for (const float allowed : {0.01f, 0.3f, 4.0f}) {
            request.allow_error = allowed;
            const test::Drawing pruned = test::draw_knowing_texels(scene, request);
            const double apart = greatest_difference(pruned.frame, full);
            EXPECT_LE(apart, double(allowed)) << "seed " << seed;
            const std::vector<prep::Reason> faint = faint_lights(pruned.plan);
            double sum = 0;
            for (const prep::Reason& why : faint) {
                EXPECT_EQ(why.label, prep::ReasonLabel::bounded);
                EXPECT_EQ(why.limit, double(allowed));
                sum += why.value;
            }
            EXPECT_LE(sum, double(allowed)) << "seed " << seed;
            EXPECT_LE(apart, sum) << "seed " << seed;
            left_out += !faint.empty();
            several += faint.size() > 1;
            seen += apart > 0;
        }
    }
    std::printf("%d of 600 pictures without a light, %d without several, %d differ\n", left_out,
                several, seen);
    EXPECT_GE(left_out, 400);
    EXPECT_GE(several, 300);
    EXPECT_GE(seen, 300);
}

void with_texel(prep::PreparedScene& s, prep::TextureRef Material::*map, glm::vec3 texel) {
    const float values[] = {texel.x, texel.y, texel.z};
    (s.scene.materials[0].*map).texture = std::uint32_t(s.scene.textures.size());
    prep::Texture texture;
    texture.image = std::uint32_t(s.scene.images.size());
    s.scene.images.push_back(test::float_picture(1, 1, 3, values));
    s.scene.textures.push_back(texture);
}

// Something that a bound depends on, at its worst: a light that hits the wall's middle flat on,
// seen along the same line.
struct WorstCase {
    const char* name;
    void (*apply)(prep::PreparedScene&, rast::RenderRequest&);
};
constexpr WorstCase worst_cases[] = {
    {"a point light", [](prep::PreparedScene&, rast::RenderRequest&) {}},
    {"a nearer one",
     [](prep::PreparedScene&, rast::RenderRequest& r) { r.lights->back().position.z = 0.25; }},
    {"of a range",
     [](prep::PreparedScene&, rast::RenderRequest& r) { r.lights->back().range = 2.2f; }},
    {"a spot",
     [](prep::PreparedScene&, rast::RenderRequest& r) { r.lights->back().kind = LightKind::spot; }},
    {"the sun", [](prep::PreparedScene&,
                   rast::RenderRequest& r) { r.lights->back().kind = LightKind::directional; }},
    {"a coloured one",
     [](prep::PreparedScene&, rast::RenderRequest& r) {
         r.lights->back().color = {0.1f, 0.02f, 0.3f};
     }},
    {"no highlights", [](prep::PreparedScene& s,
                         rast::RenderRequest&) { s.scene.materials[0].specular = glm::vec3(0); }},
    {"highlights above all",
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.scene.materials[0].specular = glm::vec3(20);
         s.scene.materials[0].shininess = 900;
     }},
    {"metallic",
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         Material& m = s.scene.materials[0];
         m.metallic_roughness = true;
         m.metallic = 1;
         m.roughness = 0.2f;
     }},
    {"half metallic, mapped",
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         Material& m = s.scene.materials[0];
         m.metallic_roughness = true;
         m.metallic = 0.5f;
         m.roughness = 1;
         with_texel(s, &Material::metallic_roughness_map, {0, 0.3f, 1});
     }},
    {"dielectric",
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         Material& m = s.scene.materials[0];
         m.metallic_roughness = true;
         m.metallic = 0;
         m.roughness = 0.9f;
     }},
    {"texels above 1",
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         with_texel(s, &Material::diffuse_map, {7, 3, 0.5f});
     }},
    {"specular texels above 1",
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         with_texel(s, &Material::specular_map, {1, 30, 1});
     }},
    {"vertex colours above 1",
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.meshes[0].colors = {{4, glm::vec4(1, 9, 1, 1)}};
     }},
    {"light at vertices",
     [](prep::PreparedScene& s, rast::RenderRequest& r) {
         // A corner in the middle, where the light is.
         s.meshes[0].positions[0] = {0, 0, 0};
         r.shading = Shading::gouraud;
     }},
    {"the default material",
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.meshes[0].ranges[0].material = prep::no_index;
         s.scene.materials[0].specular = glm::vec3(0);
         s.scene.materials[0].diffuse = glm::vec4(0, 0, 0, 1);
     }},
};

prep::PreparedScene worst_scene(const WorstCase& c, rast::RenderRequest& request) {
    prep::PreparedScene scene = test::scene_of(test::square(), {});
    request = stage_request();
    request.width = request.height = 81;  // a pixel in the middle
    request.view = test::look_at({0, 0, 3}, {0, 0, 0});
    request.lights->push_back(light_of(LightKind::point, glm::vec3(0.1f), {0, 0, 2}, {0, 0, -1}));
    request.lights->front().color = glm::vec3(50);  // stays, being the brightest
    c.apply(scene, request);
    return scene;
}

TEST(BoundedSkips, AreReachedWithinTenTimesOnWorstCases) {
    for (const WorstCase& c : worst_cases) {
        rast::RenderRequest request;
        const prep::PreparedScene scene = worst_scene(c, request);
        const rast::Frame full = test::draw_in_full(scene, request);
        request.allow_error = 1000;
        const std::vector<prep::Reason> told =
            faint_lights(test::draw_knowing_texels(scene, request).plan);
        ASSERT_EQ(told.size(), 1u) << c.name;
        const double most = told[0].value;
        request.allow_error = float(most * 1.00001);
        const test::Drawing pruned = test::draw_knowing_texels(scene, request);
        EXPECT_EQ(faint_lights(pruned.plan).size(), 1u) << c.name;
        const double apart = greatest_difference(pruned.frame, full);
        EXPECT_LE(apart, most) << c.name;
        EXPECT_GE(apart, most / 10) << c.name;
        std::printf("%-24s bound %10.6g, reached %10.6g (1 / %.3g)\n", c.name, most, apart,
                    most / apart);
        request.allow_error = float(most * 0.99999);
        EXPECT_TRUE(faint_lights(test::draw_knowing_texels(scene, request).plan).empty()) << c.name;
    }
}

// A light goes where its bound is allowed for, and stays where one part in 2^23 less is.
TEST(BoundedSkips, BoundsAboveWhatIsAllowedByOnePartIn2To23Show) {
    for (const WorstCase& c : worst_cases) {
        rast::RenderRequest request;
        const prep::PreparedScene scene = worst_scene(c, request);
        request.allow_error = 1000;
        const std::vector<prep::Reason> told =
            faint_lights(test::draw_knowing_texels(scene, request).plan);
        ASSERT_EQ(told.size(), 1u) << c.name;
        float enough = float(told[0].value);
        if (double(enough) < told[0].value) enough = std::nextafter(enough, 1e9f);
        request.allow_error = enough;
        const test::Drawing without = test::draw_knowing_texels(scene, request);
        EXPECT_EQ(faint_lights(without.plan).size(), 1u) << c.name;
        request.allow_error = std::nextafter(enough, 0.0f);
        const test::Drawing with = test::draw_knowing_texels(scene, request);
        EXPECT_TRUE(faint_lights(with.plan).empty()) << c.name;
        EXPECT_NE(test::differing(without.frame, with.frame), "") << c.name;
    }
}

TEST(BoundedSkips, NothingIsLeftOutUnlessItIsAllowed) {
    rast::RenderRequest request;
    const prep::PreparedScene scene = worst_scene(worst_cases[0], request);
    request.lights->back().color = glm::vec3(1e-30f);
    EXPECT_EQ(request.allow_error, 0);
    const test::Drawing drawing = test::draw_knowing_texels(scene, request);
    EXPECT_TRUE(faint_lights(drawing.plan).empty());
    EXPECT_EQ(test::differing(drawing.frame, test::draw_in_full(scene, request)), "");
    request.allow_error = 1;
    request.prune = false;
    EXPECT_TRUE(faint_lights(*rast::plan(scene, request)).empty());
}

// What cannot be bounded stays, whatever is allowed.
TEST(BoundedSkips, LightsWithoutABoundStay) {
    struct Case {
        const char* name;
        void (*apply)(prep::PreparedScene&, rast::RenderRequest&);
    };
    constexpr Case cases[] = {
        {"in the box of everything",
         [](prep::PreparedScene&, rast::RenderRequest& r) { r.lights->back().position.z = 0; }},
        {"a material that is not finite",
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             s.scene.materials[0].diffuse.g = HUGE_VALF;
         }},
        {"texels that are not finite",
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             with_texel(s, &Material::diffuse_map, {1, HUGE_VALF, 1});
         }},
        {"texels below 0, of which the mask alone asks",
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             with_texel(s, &Material::diffuse_map, {-5, -5, -5});
             s.scene.materials[0].alpha_mode = prep::AlphaMode::mask;
             s.scene.materials[0].specular = glm::vec3(0);
         }},
        {"a filter that overshoots",
         [](prep::PreparedScene& s, rast::RenderRequest& r) {
             with_texel(s, &Material::diffuse_map, {1, 1, 1});
             r.filter = rast::TextureFilter::bicubic;
         }},
        {"coordinates that rounding may take to the light",
         [](prep::PreparedScene&, rast::RenderRequest& r) {
             r.view = test::look_at({0, 0, 3e6}, {0, 0, 0});
         }},
        {"a light that takes away",
         [](prep::PreparedScene&, rast::RenderRequest& r) { r.lights->back().color.x = -0.1f; }},
    };
    for (const Case& c : cases) {
        rast::RenderRequest request;
        prep::PreparedScene scene = worst_scene(worst_cases[0], request);
        request.allow_error = 1e6f;
        const auto is_left_out = [&] {  // the faint one, which comes last
            const rast::RenderPlan plan = test::draw_knowing_texels(scene, request).plan;
            return plan.skips.light(plan.lights.size() - 1);
        };
        ASSERT_TRUE(is_left_out());
        c.apply(scene, request);
        EXPECT_FALSE(is_left_out()) << c.name;
    }
}

TEST(BoundedSkips, WhatIsAllowedIsANumber) {
    rast::RenderRequest request;
    const prep::PreparedScene scene = worst_scene(worst_cases[0], request);
    for (const float wrong : {-1.0f, HUGE_VALF, std::nanf("")}) {
        request.allow_error = wrong;
        const auto plan = rast::plan(scene, request);
        ASSERT_FALSE(plan.has_value()) << wrong;
        EXPECT_EQ(plan.error().code, prep::ErrorCode::invalid);
    }
}

// The faintest go first, as many as are allowed together; one always stays.
TEST(BoundedSkips, ShareWhatIsAllowed) {
    rast::RenderRequest request;
    const prep::PreparedScene scene = worst_scene(worst_cases[0], request);
    const rast::LightInstance one = request.lights->back();
    // 0.025 each, but for the last one: material and distance.
    request.lights = {one, one, one};
    request.lights->at(0).color *= 3;
    const auto left_out = [&](float allowed) {
        request.allow_error = allowed;
        return rast::plan(scene, request)->skips.lights;
    };
    EXPECT_EQ(left_out(0.02f), (std::vector<bool>{false, false, false}));
    EXPECT_EQ(left_out(0.03f), (std::vector<bool>{false, true, false}));
    EXPECT_EQ(left_out(0.06f), (std::vector<bool>{false, true, true}));
    EXPECT_EQ(left_out(1), (std::vector<bool>{false, true, true}));
}

// What allowing for something changes in a plan, and back.
TEST(BoundedSkips, AReasonTakesItsStepsAwayAndNoOthers) {
    for (const WorstCase& c : worst_cases) {
        rast::RenderRequest request;
        const prep::PreparedScene scene = worst_scene(c, request);
        const rast::RenderPlan without = test::draw_knowing_texels(scene, request).plan;
        request.allow_error = 1000;
        const rast::RenderPlan with = test::draw_knowing_texels(scene, request).plan;
        EXPECT_EQ(test::changed(without, with), std::set<std::string>{"lights"}) << c.name;
        request.allow_error = 0;
        EXPECT_EQ(test::changed(without, test::draw_knowing_texels(scene, request).plan),
                  std::set<std::string>())
            << c.name;
    }
}

// A row of the table in docs/architecture.md.
TEST(BoundedSkips, HoldInEveryWayOfDrawing) {
    constexpr float allowed = 0.05f;
    for (const test::Way& way : test::ways) {
        rast::RenderRequest request;
        const prep::PreparedScene scene = worst_scene(worst_cases[0], request);
        request.lights->front().color = glm::vec3(0.3f);  // no byte is clipped
        way.ask(request);
        const rast::Frame full = test::draw_in_full(scene, request);
        request.allow_error = allowed;
        const test::Drawing pruned = test::draw_knowing_texels(scene, request);
        EXPECT_EQ(faint_lights(pruned.plan).size(), 1u) << way.name;
        EXPECT_LE(greatest_difference(pruned.frame, full), double(allowed)) << way.name;
        if (request.pixels != rast::PixelFormat::bytes) {
            EXPECT_GT(greatest_difference(pruned.frame, full), 0) << way.name;
        }
        ASSERT_EQ(pruned.frame.bytes.size(), full.bytes.size()) << way.name;
        int most = 0;
        for (std::size_t i = 0; i < full.bytes.size(); ++i)
            for (int shift = 0; shift < 32; shift += 8)
                most = std::max(most, std::abs(int(full.bytes[i] >> shift & 255) -
                                               int(pruned.frame.bytes[i] >> shift & 255)));
        EXPECT_LE(most, int(std::ceil(255 * double(allowed)))) << way.name;
        EXPECT_EQ(most > 0, request.pixels == rast::PixelFormat::bytes) << way.name;
        request.band_bytes = 81 * 16 * 20;
        const auto plan = rast::plan(scene, request);
        ASSERT_TRUE(plan) << way.name;
        EXPECT_EQ(test::differing(pruned.frame, test::in_bands(scene, *plan)), "") << way.name;
    }
}

}  // namespace
