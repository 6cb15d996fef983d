// What a plan leaves out: the picture is the same to the bit, the full one would have done it, and
// a neutral element that is off by one part in 2^23 shows. Long because all skips are held against
// one table.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "oracles.h"
#include "random_pictures.h"
#include "skip_stage.h"
#include "skip_table.h"

namespace {

using rast::Shading;
using test::changed;
using test::is_skipped;
using test::light_of;
using test::proved_zero;
using test::stage_of;
using test::stage_request;
using test::usual_lights;

// A feature that can be left out, and what the full run counts of it.
struct Skip {
    const char* code;
    std::uint64_t rast::Counters::*counter;
};
constexpr Skip skips[] = {
    {"light_black", &rast::Counters::light_points},
    {"light_range", &rast::Counters::light_points},
    {"light_cone", &rast::Counters::light_points},
    {"light_behind", &rast::Counters::light_points},
    {"highlights_zero", &rast::Counters::highlight_points},
    {"map_times_zero", &rast::Counters::texture_samples},
    {"normal_map_flat", &rast::Counters::normal_map_points},
    {"bump_map_flat", &rast::Counters::texture_samples},
    {"mask_never_cuts", &rast::Counters::masked_triangles},
    {"samples_inside", &rast::Counters::sample_points},
};

TEST(Skips, PrunedPicturesEqualFullOnesOnRandomScenes) {
    std::map<std::string, int> scenes,
        less;  // with the skip, and where the full run did more of it
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        const prep::PreparedScene scene = test::prepared_random_scene(seed);
        rast::RenderRequest request = test::random_request(seed);
        for (const bool normals : {true, false}) {
            request.keep_normals = normals;
            if (!normals) {
                request.shading = seed % 2 == 0 ? Shading::normal_mapped : Shading::phong;
                request.samples = 4;
                request.width = request.height = 160;  // tiles inside a triangle
            }
            const test::Drawing pruned = test::draw_knowing_texels(scene, request);
            const rast::Frame full = test::draw_in_full(scene, request);
            EXPECT_EQ(test::differing(pruned.frame, full), "") << "seed " << seed;
            const auto codes = proved_zero(pruned.plan);
            for (const Skip& skip : skips) {
                if (codes.count(skip.code) == 0) continue;
                ++scenes[skip.code];
                less[skip.code] +=
                    full.counters.*skip.counter > pruned.frame.counters.*skip.counter;
            }
        }
    }
    for (const Skip& skip : skips) {
        EXPECT_GE(scenes[skip.code], 3) << skip.code << " is in too few scenes";
        EXPECT_GE(less[skip.code], 1) << skip.code << " saves nothing";
        RecordProperty(skip.code, std::to_string(scenes[skip.code]) + " pictures, " +
                                      std::to_string(less[skip.code]) + " with less work");
        std::printf("%-18s %3d pictures, in %3d of them less was counted\n", skip.code,
                    scenes[skip.code], less[skip.code]);
    }
}

prep::ImageRef constant(glm::vec3 texel) {
    const float values[] = {texel.x, texel.y, texel.z};
    return test::float_picture(1, 1, 3, values);
}

// A reason on its own: the scene and request that have it, and the steps that go with it.
struct Case {
    const char* code;
    std::set<std::string> steps;  // that differ from the plan without the reason
    bool takes_away = true;       // else the reason is one of an element that is neutral
    void (*apply)(prep::PreparedScene&, rast::RenderRequest&);
    // The neutral element, off by one part in 2^23.
    void (*spoil)(prep::PreparedScene&, rast::RenderRequest&);
};

constexpr float off_one = 0x1p-23f;

// Both sides have the map, or the mask: what differs is whether it does something.
void with_flat_map(prep::PreparedScene& s, rast::RenderRequest&) {
    s.scene.images[0] = constant({0.5f, 0.5f, 1});
}

const std::vector<Case>& cases() {
    using prep::LightKind;
    using prep::Material;
    static const std::vector<Case> all = {
        {"light_black",
         {"lights"},
         true,
         [](prep::PreparedScene&, rast::RenderRequest& r) {
             r.lights->push_back(light_of(LightKind::directional, glm::vec3(0), {}, {0, 0, -1}));
         },
         [](prep::PreparedScene&, rast::RenderRequest& r) {
             r.lights->back().color = glm::vec3(off_one);
         }},
        {"light_range",
         {"lights"},
         true,
         [](prep::PreparedScene&, rast::RenderRequest& r) {
             r.lights->push_back(
                 light_of(LightKind::point, glm::vec3(1), {0, 0, 40}, {0, 0, -1}, 38.9f));
         },
         // The box of everything begins 39 away.
         [](prep::PreparedScene&, rast::RenderRequest& r) { r.lights->back().range = 39.2f; }},
        {"light_cone",
         {"lights"},
         true,
         [](prep::PreparedScene&, rast::RenderRequest& r) {
             r.lights->push_back(light_of(LightKind::spot, glm::vec3(9), {0, 0, 6},
                                          {std::sin(0.36), 0, -std::cos(0.36)}));
             r.lights->back().outer_cone = 0.05f;
         },
         // The ball's edge is 0.19 from the cone's axis.
         [](prep::PreparedScene&, rast::RenderRequest& r) { r.lights->back().outer_cone = 0.21f; }},
        {"light_behind",
         {"lights"},
         true,
         [](prep::PreparedScene&, rast::RenderRequest& r) {
             r.lights->push_back(light_of(LightKind::directional, glm::vec3(1), {}, {1, 0, 0.01}));
         },
         [](prep::PreparedScene&, rast::RenderRequest& r) {
             r.lights->back().direction = {1, 0, -off_one};
         }},
        {"map_times_zero",
         {"highlights", "shading", "textures", "sRGB decoding", "texture filter", "mip levels",
          "ripmap levels"},
         false,
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             s.scene.materials[0].specular = glm::vec3(0);
         },
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             s.scene.materials[0].specular = glm::vec3(off_one);
         }},
        {"highlights_zero",
         {"highlights", "shading"},
         false,
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             s.scene.materials[0].specular = glm::vec3(0);
         },
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             s.scene.materials[0].specular = glm::vec3(off_one);
         }},
        {"normal_map_flat",
         {"normal maps", "textures", "texture filter", "mip levels", "ripmap levels", "shading"},
         false,
         with_flat_map,
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             s.scene.images[0] = constant({0.5f + 0.5f * off_one, 0.5f, 1});
         }},
        {"bump_map_flat",
         {"normal maps", "textures", "texture filter", "mip levels", "ripmap levels", "shading"},
         false,
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             s.scene.materials[0].bump_map.strength = 0;
         },
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             s.scene.materials[0].bump_map.strength = off_one;
         }},
        {"mask_never_cuts",
         {"alpha mask", "shading"},
         false,
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             s.scene.materials[0].diffuse.a = s.scene.materials[0].alpha_cutoff;
         },
         [](prep::PreparedScene& s, rast::RenderRequest&) {
             s.scene.materials[0].diffuse.a *= 1 - off_one;
         }},
    };
    return all;
}

// Without the reason: as near to the case as can be.
prep::PreparedScene base_of(const Case& c) {
    prep::Material material;
    const std::string code = c.code;
    if (code == "normal_map_flat") {
        material.normal_map.texture = 0;
        return stage_of(material, {constant({0.7f, 0.5f, 0.8f})});
    }
    if (code == "bump_map_flat") {
        material.bump_map.texture = 0;
        material.bump_map.strength = 0.1f;
        const float heights[] = {0, 1, 0.5f, 0.25f, 0, 1, 0.5f, 0.75f, 0};
        return stage_of(material, {test::float_picture(3, 3, 1, heights)});
    }
    if (code == "map_times_zero") {
        material.specular_map.texture = 0;
        return stage_of(material, {constant(glm::vec3(0.6f))});
    }
    if (code == "light_behind") {
        prep::PreparedScene scene = stage_of(material);
        for (glm::vec3& n : scene.meshes[0].normals) n = {0, 0, 1};
        return scene;
    }
    if (code == "mask_never_cuts") {
        material.alpha_mode = prep::AlphaMode::mask;
        material.diffuse.a = 0.25f;
    }
    return stage_of(material);
}

// A material that does not glow reads no map of how it glows.
TEST(Skips, EmissiveMapsOfWhatDoesNotGlowAreNotRead) {
    prep::Material material;
    material.emissive_map.texture = 0;
    prep::PreparedScene scene = stage_of(material, {constant(glm::vec3(0.6f))});
    const rast::RenderRequest request = stage_request();
    const test::Drawing dark = test::draw_knowing_texels(scene, request);
    EXPECT_EQ(proved_zero(dark.plan).count("map_times_zero"), 1u);
    EXPECT_EQ(dark.frame.counters.texture_samples, 0u);
    EXPECT_FALSE(dark.plan.textures_read[0]);
    const rast::Frame full = test::draw_in_full(scene, request);
    EXPECT_GT(full.counters.texture_samples, 0u);
    EXPECT_EQ(test::differing(dark.frame, full), "");
    scene.scene.materials[0].emissive = glm::vec3(0, off_one, 0);
    const test::Drawing glowing = test::draw_knowing_texels(scene, request);
    EXPECT_EQ(proved_zero(glowing.plan).count("map_times_zero"), 0u);
    EXPECT_GT(glowing.frame.counters.texture_samples, 0u);
    EXPECT_NE(test::differing(glowing.frame, full), "");
}

TEST(Skips, NeutralElementsOffByOnePartIn2To23Show) {
    for (const Case& c : cases()) {
        prep::PreparedScene scene = base_of(c);
        rast::RenderRequest request = stage_request();
        c.apply(scene, request);
        const test::Drawing pruned = test::draw_knowing_texels(scene, request);
        ASSERT_EQ(proved_zero(pruned.plan).count(c.code), 1u) << c.code;
        EXPECT_EQ(test::differing(pruned.frame, test::draw_in_full(scene, request)), "") << c.code;
        c.spoil(scene, request);
        EXPECT_NE(test::differing(pruned.frame, test::draw_in_full(scene, request)), "") << c.code;
        EXPECT_EQ(proved_zero(test::draw_knowing_texels(scene, request).plan).count(c.code), 0u)
            << c.code << " is taken for proved though it is not";
    }
}

// The neutral maps of a run in which nothing is left out: factors of 1 and normals of (0, 0, 1).
TEST(Skips, NeutralMapsOffByOnePartIn2To23Show) {
    const prep::PreparedScene bare = stage_of({});
    const rast::RenderRequest request = stage_request();
    const rast::Frame pruned = test::draw_knowing_texels(bare, request).frame;
    EXPECT_EQ(test::differing(pruned, test::draw_in_full(bare, request)), "");
    const std::pair<prep::TextureRef prep::Material::*, glm::vec3> maps[] = {
        {&prep::Material::diffuse_map, glm::vec3(1)},
        {&prep::Material::specular_map, glm::vec3(1)},
        {&prep::Material::occlusion_map, glm::vec3(1)},
        {&prep::Material::normal_map, glm::vec3(0.5f, 0.5f, 1)}};
    for (const auto& [map, texel] : maps) {
        prep::Material material;
        (material.*map).texture = 0;
        const prep::PreparedScene neutral = stage_of(material, {constant(texel)});
        EXPECT_EQ(test::differing(pruned, test::draw_in_full(neutral, request)), "");
        const glm::vec3 off(texel.x * (1 + off_one), texel.y, texel.z);
        const prep::PreparedScene wrong = stage_of(material, {constant(off)});
        EXPECT_NE(test::differing(pruned, test::draw_in_full(wrong, request)), "")
            << "texel " << texel.x;
    }
}

// How much of a light its limit lets through at the pixel that gets the most of it, at the least
// value of the limit at which the picture shows anything: between `off` and `on`.
double least_share(const char* code, float rast::LightInstance::*limit, float off, float on,
                   const rast::LightInstance& light) {
    const prep::PreparedScene scene = test::scene_of(test::square());
    rast::RenderRequest request = stage_request();
    request.width = request.height = 40;
    request.view = test::look_at({0, 0, 3}, {0, 0, 0});
    const rast::Frame without = test::draw_in_full(scene, request);
    request.lights->push_back(light);
    float& value = request.lights->back().*limit;
    const auto shows = [&](float v) {
        value = v;
        return test::differing(without, test::draw_in_full(scene, request)) != "";
    };
    EXPECT_FALSE(shows(off)) << code;
    EXPECT_TRUE(shows(on)) << code;
    while (std::nextafter(off, on) != on) {
        const float middle = std::midpoint(off, on);
        (shows(middle) ? on : off) = middle;
    }
    value = on;
    const test::Drawing least = test::draw_knowing_texels(scene, request);
    EXPECT_EQ(proved_zero(least.plan).count(code), 0u) << code;
    EXPECT_NE(test::differing(without, least.frame), "") << code;
    request.lights->back().kind = prep::LightKind::point;
    request.lights->back().range = 0;
    const rast::Frame unlimited = test::draw_in_full(scene, request);
    double share = 0;
    for (std::size_t i = 0; i < without.color.size(); ++i) {
        const double all = double(unlimited.color[i].r) - double(without.color[i].r);
        const double some = double(least.frame.color[i].r) - double(without.color[i].r);
        if (some > 0) share = std::max(share, some / all);
    }
    return share;
}

// The neutral element of what limits a light is a factor of 0. The window of a range is a fourth
// power, whose floats lie up to 2^-21 apart: a light at one of many heights hits 2^-23.
TEST(Skips, LimitsOfLightsOffByOnePartIn2To23Show) {
    double range = 1, cone = 1;
    for (int k = 0; k < 40; ++k) {
        const glm::dvec3 above(0, 0, 1.9 + 0.001 * k);  // of a wall of |x|, |y| <= 1
        range = std::min(range, least_share("light_range", &rast::LightInstance::range, 1.8f, 2.1f,
                                            light_of(prep::LightKind::point, glm::vec3(1e5f), above,
                                                     {0, 0, -1})));
        if (k % 10 == 0)
            cone = std::min(
                cone,
                least_share("light_cone", &rast::LightInstance::outer_cone, 0.9f, 1.2f,
                            light_of(prep::LightKind::spot, glm::vec3(1e5f), above, {1, 0, 0})));
    }
    for (const double share : {range, cone}) {
        EXPECT_GT(share, 0);
        EXPECT_LE(share, double(off_one));
    }
}

// Two of four samples of some pixels in a tile, off by one part in 2^23: half a pixel's width of
// another triangle, before the one that covers the tile.
TEST(Skips, SamplesOffByOnePartIn2To23Show) {
    prep::Material material;
    material.unlit = true;
    material.diffuse = glm::vec4(1.75f, 1.75f, 1.75f, 1);
    prep::VertexMesh mesh;
    mesh.positions = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    rast::RenderRequest request = stage_request();
    request.width = request.height = 128;
    request.view = test::flat_view(1);
    request.samples = 4;
    const auto scene_with = [&](float factor) {
        prep::VertexMesh both = mesh;
        const float pixel = 2.0f / 128, left = -0.5f, right = left + pixel / 2;
        both.positions.insert(
            both.positions.end(),
            {{left, -0.7f, 1}, {right, -0.7f, 1}, {right, -0.3f, 1}, {left, -0.3f, 1}});
        both.indices = {0, 1, 2, 3, 4, 5, 3, 5, 6};
        both.normals.assign(both.positions.size(), {0, 0, 1});
        both.ranges = {{0, 1, 0, prep::no_index}, {1, 2, 1, prep::no_index}};
        prep::PreparedScene scene = test::scene_of(std::move(both), material);
        scene.scene.materials.push_back(material);
        scene.scene.materials[1].diffuse *= glm::vec4(glm::vec3(factor), 1);
        return scene;
    };
    mesh.indices = {0, 1, 2};
    mesh.normals.assign(3, {0, 0, 1});
    const prep::PreparedScene plain = test::scene_of(mesh, material);
    EXPECT_TRUE(is_skipped("samples_inside", plain, request));
    const rast::Frame neutral = test::draw_knowing_texels(plain, request).frame;
    EXPECT_LT(neutral.counters.sample_points, 128u * 128 * 4);
    const rast::Frame same = test::draw_knowing_texels(scene_with(1), request).frame;
    EXPECT_EQ(test::differing(neutral, same), "");
    const prep::PreparedScene off = scene_with(1 + off_one);
    const test::Drawing pruned = test::draw_knowing_texels(off, request);
    EXPECT_GT(pruned.frame.counters.sample_points, neutral.counters.sample_points);
    EXPECT_EQ(test::differing(pruned.frame, test::draw_in_full(off, request)), "");
    EXPECT_NE(test::differing(neutral, pruned.frame), "");
    double most = 0;
    for (std::size_t i = 0; i < neutral.color.size(); ++i)
        most = std::max(most, std::abs(double(pruned.frame.color[i].r) / 1.75 - 1));
    EXPECT_LE(most, double(off_one));
}

TEST(Skips, AReasonTakesItsStepsAwayAndNoOthers) {
    for (const Case& c : cases()) {
        const prep::PreparedScene before = base_of(c);
        const rast::RenderRequest request = stage_request();
        const rast::RenderPlan without = test::draw_knowing_texels(before, request).plan;
        prep::PreparedScene scene = before;
        rast::RenderRequest with = request;
        c.apply(scene, with);
        const rast::RenderPlan plan = test::draw_knowing_texels(scene, with).plan;
        EXPECT_EQ(changed(without, plan), c.steps) << c.code;
        EXPECT_EQ(changed(without, test::draw_knowing_texels(before, request).plan),
                  std::set<std::string>())
            << c.code << " put back";
    }
}

// Cells that no counter tells: light at vertices is counted by vertices, and areas look at
// masks by polygons.
bool is_not_counted(const std::string& code, const std::string& way) {
    return (way == "Gouraud" && code.starts_with("light_")) ||
           (way == "exact areas" && code == "mask_never_cuts");
}

TEST(Skips, HoldInEveryWayOfDrawing) {
    for (const Case& c : cases())
        for (const test::Way& way : test::ways) {
            prep::PreparedScene scene = base_of(c);
            rast::RenderRequest request = stage_request();
            c.apply(scene, request);
            const rast::Frame usual = test::draw_knowing_texels(scene, request).frame;
            way.ask(request);
            const test::Drawing pruned = test::draw_knowing_texels(scene, request);
            const std::string name = std::string(c.code) + ", " + way.name;
            const rast::Frame full = test::draw_in_full(scene, request);
            EXPECT_EQ(test::differing(pruned.frame, full), "") << name;
            const bool there = test::is_there(c.code, way.name);
            EXPECT_EQ(proved_zero(pruned.plan).count(c.code), there ? 1u : 0u) << name;
            for (const Skip& skip : skips) {
                if (skip.code != std::string(c.code) || !there) continue;
                if (is_not_counted(c.code, way.name)) continue;
                EXPECT_GT(full.counters.*skip.counter, pruned.frame.counters.*skip.counter) << name;
            }
            EXPECT_EQ(test::differing(pruned.frame, test::in_bands(scene, pruned.plan)), "")
                << name;
            if (!request.crop) continue;
            for (std::uint32_t y = 0; y < request.crop->height; ++y)
                for (std::uint32_t x = 0; x < request.crop->width; ++x)
                    ASSERT_EQ(
                        pruned.frame.color[y * request.crop->width + x],
                        usual.color[(y + request.crop->y) * request.width + x + request.crop->x])
                        << name;
        }
}

// The last row of the table: four samples a pixel, where the way of drawing takes them.
TEST(Skips, SamplesInsideATriangleHoldInEveryWayOfDrawing) {
    prep::VertexMesh mesh;
    mesh.positions = {
        {-9, -9, 0}, {9, -9, -0.5f}, {0.3f, 3, 0.5f}};  // its edges are in the picture
    mesh.normals.assign(3, {0, 0, 1});
    mesh.indices = {0, 1, 2};
    const prep::PreparedScene scene = test::scene_of(std::move(mesh));
    rast::RenderRequest usual = stage_request();
    usual.width = usual.height = 256;
    usual.view = test::flat_view(4);
    usual.samples = 4;
    const rast::Frame whole = test::draw_knowing_texels(scene, usual).frame;
    for (const test::Way& way : test::ways) {
        rast::RenderRequest request = usual;
        way.ask(request);
        if (request.crop) request.crop = rast::Crop{60, 80, 120, 120};  // an edge and the inside
        const bool areas = request.coverage == rast::Coverage::area;
        if (areas) request.samples = 1;  // they take the samples' place
        const test::Drawing pruned = test::draw_knowing_texels(scene, request);
        const rast::Frame full = test::draw_in_full(scene, request);
        EXPECT_EQ(test::differing(pruned.frame, full), "") << way.name;
        EXPECT_EQ(test::differing(pruned.frame, test::in_bands(scene, pruned.plan)), "")
            << way.name;
        EXPECT_EQ(proved_zero(pruned.plan).count("samples_inside"),
                  test::is_there("samples_inside", way.name) ? 1u : 0u)
            << way.name;
        EXPECT_GT(pruned.frame.counters.pixels_shaded, 0u) << way.name;
        if (!areas) {
            EXPECT_GT(full.counters.sample_points, pruned.frame.counters.sample_points) << way.name;
        }
        if (!request.crop) continue;
        for (std::uint32_t y = 0; y < request.crop->height; ++y)
            for (std::uint32_t x = 0; x < request.crop->width; ++x)
                ASSERT_EQ(pruned.frame.color[y * request.crop->width + x],
                          whole.color[(y + request.crop->y) * request.width + x + request.crop->x]);
    }
}

TEST(Skips, TheLastLightStaysAndSaysSo) {
    const prep::PreparedScene scene = stage_of({});
    rast::RenderRequest request = stage_request();
    request.lights = {light_of(prep::LightKind::point, glm::vec3(1), {0, 0, 40}, {0, 0, -1}, 5),
                      light_of(prep::LightKind::point, glm::vec3(1), {0, 40, 0}, {0, 0, -1}, 5)};
    const test::Drawing drawing = test::draw_knowing_texels(scene, request);
    EXPECT_EQ(drawing.plan.skips.lights, (std::vector<bool>{true, false}));
    EXPECT_EQ(test::differing(drawing.frame, test::draw_in_full(scene, request)), "");
}

const rast::PlanStep& step_of(const rast::RenderPlan& plan, const std::string& name) {
    for (const rast::PlanStep& s : plan.steps)
        if (prep::name_of(s.kind) == name) return s;
    throw std::runtime_error("no step " + name);
}

// Light at vertices is summed together with its highlights: nothing is saved, nothing is claimed.
TEST(Skips, LightAtVerticesKeepsHighlightsOfColourZero) {
    prep::Material material;
    material.specular = glm::vec3(0);
    const prep::PreparedScene scene = stage_of(material);
    rast::RenderRequest request = stage_request();
    EXPECT_TRUE(is_skipped("highlights_zero", scene, request));
    request.shading = Shading::gouraud;
    EXPECT_FALSE(is_skipped("highlights_zero", scene, request));
    const auto plan = rast::plan(scene, request);
    const rast::PlanStep& step = step_of(*plan, "highlights");
    EXPECT_TRUE(step.run);
    EXPECT_EQ(step.reasons.at(1).code, prep::ReasonCode::highlights_at_vertices);
}

TEST(Skips, NormalMapsRunWhereADrawReadsOne) {
    prep::Material material;
    material.normal_map.texture = 0;
    prep::PreparedScene scene = stage_of(material, {constant({0.7f, 0.5f, 0.8f})});
    rast::RenderRequest request = stage_request();
    request.shading = Shading::normal_mapped;
    const auto told = [&](const char* code, std::size_t warnings) {
        const test::Drawing drawing = test::draw_knowing_texels(scene, request);
        const rast::PlanStep& step = step_of(drawing.plan, "normal maps");
        EXPECT_EQ(prep::name_of(step.reasons.at(0).code), code);
        EXPECT_EQ(step.run, drawing.frame.counters.normal_map_points > 0) << code;
        EXPECT_EQ(drawing.plan.warnings.size(), warnings) << code;
        EXPECT_EQ(test::differing(drawing.frame, test::draw_in_full(scene, request)), "") << code;
    };
    told("normal_maps", 0);
    const std::vector<rast::LightInstance> lights = *request.lights;
    request.lights = {lights[1]};  // ambient
    told("normal_maps_unlit", 0);
    scene.meshes[0].tangents.clear();
    told("normal_maps_unlit", 0);
    request.lights = lights;
    told("normal_maps_not_placed", 1);
}

// A pointer of theirs would name another light of the scene, or none.
TEST(Skips, LightsThatTheSceneDoesNotBringHaveNoPointer) {
    const prep::PreparedScene scene = stage_of({});
    rast::RenderRequest request = stage_request();
    for (const bool set_up : {false, true}) {
        if (set_up) request.lights.reset();
        const auto plan = rast::plan(scene, request);
        const std::vector<prep::Reason>& reasons = step_of(*plan, "lights").reasons;
        ASSERT_GT(reasons.size(), 1u);
        EXPECT_EQ(reasons[1].subject, "light 0");
        EXPECT_EQ(prep::sentence(reasons[1], scene.scene), "light 0 may reach what is drawn");
    }
    EXPECT_EQ(prep::material_subject(prep::no_index), "");
    EXPECT_EQ(prep::sentence(prep::reason(prep::ReasonCode::material_lit,
                                          prep::material_subject(prep::no_index)),
                             scene.scene),
              "the default material is lit");
}

// Exact areas cut masked triangles to the pixel first, where slivers may vanish.
TEST(Skips, SliversOfMasksThatNeverCutHaveTheSameAreas) {
    prep::Material material;
    material.alpha_mode = prep::AlphaMode::mask;
    for (std::uint32_t seed = 0; seed < 6; ++seed) {
        test::RandomNumbers r(seed);
        prep::VertexMesh mesh;
        for (std::uint32_t t = 0; t < 200; ++t) {
            const glm::vec3 a(r.between(-1, 1), r.between(-1, 1), r.between(-1, 1));
            const glm::vec3 along(r.between(-1, 1), r.between(-1, 1), r.between(-1, 1));
            const float thin = std::exp2(-r.between(0, 24));
            const glm::vec3 corners[] = {a, a + along,
                                         a + along * 0.4f + thin * glm::vec3(-along.y, along.x, 0)};
            for (const glm::vec3& corner : corners) {
                mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
                mesh.positions.push_back(corner);
                mesh.normals.push_back({0, 0, 1});
            }
        }
        const prep::PreparedScene scene = test::scene_of(std::move(mesh), material);
        rast::RenderRequest request = stage_request();
        request.width = request.height = 24;
        request.cull = rast::Cull::none;
        request.coverage = rast::Coverage::area;
        EXPECT_TRUE(is_skipped("mask_never_cuts", scene, request)) << seed;
    }
}

// Of 64 pixels a side: all of them inside the one triangle, or an edge through them.
TEST(Skips, TilesInsideATriangleTakeOneSample) {
    for (const double shift : {0.0, 0.9}) {
        prep::VertexMesh mesh;
        mesh.positions = {{-9, -9, 0}, {9, -9, -0.5f}, {0, 9, 0.5f}};
        for (glm::vec3& p : mesh.positions) p.x += float(shift) * 5;
        mesh.normals.assign(3, {0, 0, 1});
        mesh.indices = {0, 1, 2};
        const prep::PreparedScene scene = test::scene_of(std::move(mesh));
        rast::RenderRequest request = stage_request();
        request.width = request.height = 128;
        request.view = test::flat_view(1);
        request.keep_depth = request.keep_ids = true;
        for (const int samples : {2, 4, 8, 16})
            for (const rast::PixelFormat format :
                 {rast::PixelFormat::floats, rast::PixelFormat::bytes}) {
                request.samples = samples;
                request.pixels = format;
                const rast::Frame pruned = test::draw(scene, request);
                const rast::Frame full = test::draw_in_full(scene, request);
                EXPECT_EQ(test::differing(pruned, full), "") << samples << " " << shift;
                EXPECT_EQ(full.counters.sample_points % (64 * 64 * std::uint64_t(samples)), 0u);
                if (shift == 0)
                    EXPECT_EQ(pruned.counters.sample_points, 128u * 128);
                else
                    EXPECT_GT(pruned.counters.sample_points, 128u * 128);
            }
    }
}

}  // namespace
