// Every reason that a plan can give: what brings it, which reasons go for it, and the steps that
// are told differently by it, no others.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "skip_stage.h"

namespace {

using prep::Material;
using prep::PreparedScene;
using rast::RenderRequest;
using Names = std::set<std::string>;

using Change = void (*)(PreparedScene&, RenderRequest&);
void none(PreparedScene&, RenderRequest&) {}

Material& first(PreparedScene& s) {
    return s.scene.materials[0];
}
prep::ImageRef picture_of(float alpha) {
    prep::Image image;
    image.width = image.height = 2;
    image.channels = 4;
    for (int t = 0; t < 4; ++t)
        image.pixels.insert(image.pixels.end(), {0.2f * float(t), 0.5f, 0.75f, alpha});
    prep::ImageRef out;
    out.name = "picture.png";
    out.bytes = *prep::encode_png(image);
    return out;
}
void add_texture(PreparedScene& s, float alpha = 1) {
    prep::Texture texture;
    texture.image = std::uint32_t(s.scene.images.size());
    s.scene.images.push_back(picture_of(alpha));
    s.scene.textures.push_back(texture);
}
void with_normal_map(PreparedScene& s, RenderRequest&) {
    add_texture(s);
    first(s).normal_map.texture = 0;
}
prep::ImageRef flat_picture() {
    const float texel[] = {0.5f, 0.5f, 1};
    return test::float_picture(1, 1, 3, texel);
}
// Two balls: the first one's map is flat, the second one's is not.
void with_flat_and_bumpy_ball(PreparedScene& s, RenderRequest& r) {
    with_normal_map(s, r);
    with_normal_map(s, r);
    s.scene.images[0] = flat_picture();
    s.scene.materials.push_back(first(s));
    s.scene.materials[1].normal_map.texture = 1;
    s.meshes.push_back(s.meshes[0]);
    for (prep::VertexMesh::Range& range : s.meshes[1].ranges) range.material = 1;
    s.scene.nodes.push_back(s.scene.nodes[0]);
    s.scene.nodes.back().mesh = 1;
}
void with_diffuse_map(PreparedScene& s, RenderRequest&) {
    add_texture(s);
    first(s).diffuse_map.texture = 0;
}
void with_mask(PreparedScene& s, RenderRequest&) {
    first(s).alpha_mode = prep::AlphaMode::mask;
    first(s).diffuse.a = 0.25f;
}
void without_wishes(PreparedScene&, RenderRequest& r) {
    r.view.reset();
    r.lights.reset();
}
void in_gouraud(PreparedScene&, RenderRequest& r) {
    r.shading = rast::Shading::gouraud;
}

struct Row {
    Change base, change;
    Names come, go, steps;
};
const std::vector<Row>& rows() {
    using rast::Cull;
    static const std::vector<Row> all = {
        {none,
         [](PreparedScene&, RenderRequest& r) { r.view.reset(); },
         {"view_framed"},
         {"view_given"},
         {"camera"}},
        {without_wishes,
         [](PreparedScene& s, RenderRequest&) {
             s.scene.cameras.emplace_back();
             s.scene.nodes.emplace_back();
             s.scene.nodes.back().camera = 0;
             s.scene.nodes.back().transform[3] = glm::dvec4(0, 0, 3, 1);
             s.scene.active_camera = std::uint32_t(s.scene.nodes.size() - 1);
         },
         {"camera"},
         {"view_framed"},
         {"camera"}},
        {without_wishes,
         [](PreparedScene& s, RenderRequest&) {
             s.scene.lights.emplace_back();
             s.scene.nodes.emplace_back();
             s.scene.nodes.back().light = 0;
         },
         {"lights_of_scene"},
         {"lights_set_up"},
         {"lights"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.lights.reset(); },
         {"lights_set_up"},
         {"lights_given"},
         {"lights"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.lights->clear(); },
         {"highlights_none", "no_directed_light", "no_lights_given"},
         {"highlights", "highlights_some", "light", "lights_given", "normals_interpolated"},
         {"highlights", "lights", "vertex normals"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.lights->front().color = {}; },
         {"last_light"},
         {"light"},
         {"lights"}},
        {in_gouraud,
         [](PreparedScene&, RenderRequest& r) { r.lights->clear(); },
         {"highlights_none", "no_lights_given"},
         {"highlights", "highlights_some", "light", "lights_given"},
         {"highlights", "lights"}},
        {in_gouraud,
         [](PreparedScene& s, RenderRequest&) { first(s).unlit = true; },
         {"all_unlit", "highlights_none"},
         {"highlights", "highlights_some", "light", "light_at_vertices", "lights_given",
          "normals_interpolated"},
         {"highlights", "lights", "shading", "vertex lighting", "vertex normals"}},
        {in_gouraud,
         [](PreparedScene& s, RenderRequest&) { s.meshes[0].normals.clear(); },
         {"normals_missing"},
         {"light_at_vertices", "normals_interpolated"},
         {"shading", "vertex lighting", "vertex normals"}},
        {none,
         [](PreparedScene& s, RenderRequest&) { s.meshes[0].normals.clear(); },
         {"normals_missing"},
         {"normals_interpolated"},
         {"shading", "vertex normals"}},
        {none,
         in_gouraud,
         {"light_at_vertices", "normal_maps_unread"},
         {"light_at_pixels", "no_normal_map"},
         {"normal maps", "shading", "vertex lighting"}},
        {in_gouraud,
         [](PreparedScene& s, RenderRequest&) { first(s).specular = {}; },
         {"highlights_at_vertices"},
         {"highlights"},
         {"highlights"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.shading = rast::Shading::flat; },
         {"flat_shading", "normal_maps_unread"},
         {"no_normal_map", "normals_interpolated"},
         {"normal maps", "shading", "vertex normals"}},
        {none,
         [](PreparedScene& s, RenderRequest&) { first(s).unlit = true; },
         {"all_unlit", "highlights_none"},
         {"highlights", "highlights_some", "light", "lights_given", "normals_interpolated"},
         {"highlights", "lights", "shading", "vertex normals"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.keep_color = false; },
         {"highlights_none", "no_colors_kept"},
         {"highlights", "highlights_some", "light", "lights_given", "normals_interpolated",
          "variants"},
         {"highlights", "lights", "shading", "vertex normals"}},
        {none,
         [](PreparedScene& s, RenderRequest&) { s.scene.nodes.clear(); },
         {"highlights_none", "no_triangles"},
         {"highlights", "highlights_some", "light", "lights_given", "normals_interpolated",
          "variants"},
         {"highlights", "lights", "shading", "vertex normals"}},
        {none,
         with_normal_map,
         {"filter", "levels", "map", "no_levels", "normal_maps", "textures"},
         {"no_normal_map", "no_textures"},
         {"mip levels", "normal maps", "ripmap levels", "shading", "texture filter", "textures"}},
        {with_normal_map,
         [](PreparedScene&, RenderRequest& r) { r.textures = false; },
         {"normal_maps_textures_off", "textures_off"},
         {"filter", "levels", "map", "no_levels", "normal_maps", "textures"},
         {"mip levels", "normal maps", "ripmap levels", "shading", "texture filter", "textures"}},
        {with_normal_map,
         [](PreparedScene& s, RenderRequest&) { first(s).unlit = true; },
         {"all_unlit", "highlights_none", "no_textures", "normal_maps_unlit"},
         {"filter", "highlights", "highlights_some", "levels", "light", "lights_given", "map",
          "no_levels", "normal_maps", "normals_interpolated", "textures"},
         {"highlights", "lights", "mip levels", "normal maps", "ripmap levels", "shading",
          "texture filter", "textures", "vertex normals"}},
        {with_normal_map,
         [](PreparedScene& s, RenderRequest&) { s.meshes[0].tangents.clear(); },
         {"normal_map_not_placed", "normal_maps_not_placed", "textures_not_placed"},
         {"filter", "levels", "map", "no_levels", "normal_maps", "textures"},
         {"mip levels", "normal maps", "ripmap levels", "shading", "texture filter", "textures"}},
        {with_normal_map,
         [](PreparedScene& s, RenderRequest&) { s.scene.images[0] = flat_picture(); },
         {"normal_map_flat", "normal_maps_all_flat", "textures_all_neutral"},
         {"filter", "levels", "map", "no_levels", "normal_maps", "textures"},
         {"mip levels", "normal maps", "ripmap levels", "shading", "texture filter", "textures"}},
        // One of two maps bends; then the other one, which is flat, has no tangents either.
        {with_flat_and_bumpy_ball,
         [](PreparedScene& s, RenderRequest&) { s.meshes[1].tangents.clear(); },
         {"normal_map_not_placed", "normal_maps_all_flat", "textures_not_placed"},
         {"filter", "levels", "map", "no_levels", "normal_maps", "textures"},
         {"mip levels", "normal maps", "ripmap levels", "shading", "texture filter", "textures"}},
        {with_diffuse_map,
         [](PreparedScene& s, RenderRequest&) { s.meshes[0].uvs.clear(); },
         {"map_without_uvs", "no_srgb", "textures_not_placed"},
         {"filter", "levels", "no_levels", "srgb", "textures"},
         {"mip levels", "ripmap levels", "sRGB decoding", "shading", "texture filter", "textures"}},
        {with_normal_map,
         [](PreparedScene&, RenderRequest& r) { r.shading = rast::Shading::phong; },
         {"no_textures", "normal_maps_unread"},
         {"filter", "levels", "map", "no_levels", "normal_maps", "textures"},
         {"mip levels", "normal maps", "ripmap levels", "shading", "texture filter", "textures"}},
        {none,
         with_diffuse_map,
         {"filter", "levels", "no_levels", "srgb", "textures"},
         {"no_srgb", "no_textures"},
         {"mip levels", "ripmap levels", "sRGB decoding", "shading", "texture filter", "textures"}},
        {with_diffuse_map,
         [](PreparedScene&, RenderRequest& r) { r.textures = false; },
         {"no_srgb", "textures_off"},
         {"filter", "levels", "no_levels", "srgb", "textures"},
         {"mip levels", "ripmap levels", "sRGB decoding", "shading", "texture filter", "textures"}},
        {with_diffuse_map,
         [](PreparedScene&, RenderRequest& r) { r.filter = rast::TextureFilter::bilinear; },
         {},
         {"levels"},
         {"mip levels", "texture filter"}},
        {with_diffuse_map,
         [](PreparedScene&, RenderRequest& r) { r.filter = rast::TextureFilter::ripmap; },
         {},
         {},
         {"mip levels", "ripmap levels", "texture filter"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.samples = 4; },
         {"samples", "samples_inside"},
         {"one_sample"},
         {"multisampling"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.coverage = rast::Coverage::area; },
         {"areas", "samples_areas"},
         {"no_areas", "one_sample"},
         {"exact areas", "multisampling"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.supersample = 2; },
         {"supersampling"},
         {"no_supersampling"},
         {"supersampling"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.depth_format = rast::DepthFormat::fixed16; },
         {"depth_fixed"},
         {"depth_float"},
         {"depth test"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.cull = Cull::none; },
         {"cull_off"},
         {"cull_by_material"},
         {"culling"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.cull = Cull::back; },
         {"cull_back"},
         {"cull_by_material"},
         {"culling"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.cull = Cull::front; },
         {"cull_front"},
         {"cull_by_material"},
         {"culling"}},
        {none,
         [](PreparedScene& s, RenderRequest&) { first(s).alpha_mode = prep::AlphaMode::blend; },
         {"blend_opaque"},
         {"no_blend"},
         {"alpha blending"}},
        {none, with_mask, {"mask", "mask_of"}, {"no_mask"}, {"alpha mask", "shading"}},
        {with_mask,
         [](PreparedScene& s, RenderRequest&) { first(s).diffuse.a = 0.75f; },
         {"all_masks_never_cut", "mask_never_cuts"},
         {"mask", "mask_of"},
         {"alpha mask", "shading"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.keep_depth = true; },
         {"kept"},
         {},
         {"depth output"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.keep_ids = true; },
         {"kept"},
         {"not_kept_numbers"},
         {"triangle numbers output"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.keep_normals = true; },
         {"kept"},
         {},
         {"normal output"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.keep_uvs = true; },
         {"kept"},
         {},
         {"UV output"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.keep_barycentrics = true; },
         {"kept"},
         {},
         {"barycentric output"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.keep_positions = true; },
         {"kept"},
         {},
         {"position output"}},
        {none,
         [](PreparedScene&, RenderRequest& r) {
             r.crop = rast::Crop{1, 2, 50, 60};
         },
         {"crop"},
         {"no_crop"},
         {"bands", "crop"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.band_bytes = 120 * 16 * 20; },
         {"bands"},
         {"no_bands"},
         {"bands"}},
        {none,
         [](PreparedScene& s, RenderRequest&) { first(s).specular = {}; },
         {"highlights_all_zero", "highlights_zero"},
         {"highlights", "highlights_some"},
         {"highlights", "shading"}},
        {none,
         [](PreparedScene&, RenderRequest& r) {
             r.keep_depth = r.keep_normals = r.keep_uvs = r.keep_barycentrics = r.keep_positions =
                 true;
         },
         {"kept"},
         {"not_kept"},
         {"depth output", "normal output", "UV output", "barycentric output", "position output"}},
    };
    return all;
}

rast::RenderPlan plan_of(const PreparedScene& scene, RenderRequest request) {
    rast::SceneRenderer renderer(scene);
    rast::RenderPlan plan = *rast::plan(scene, request);
    request.texel_facts = renderer.texel_facts(plan);
    return *rast::plan(scene, request);
}

Names codes_of(const rast::RenderPlan& plan) {
    Names codes;
    for (const rast::PlanStep& step : plan.steps)
        for (const prep::Reason& why : step.reasons)
            codes.insert(std::string(prep::name_of(why.code)));
    return codes;
}
// Those of `a` that `b` has not.
Names less(const Names& a, const Names& b) {
    Names out;
    for (const std::string& name : a)
        if (b.count(name) == 0) out.insert(name);
    return out;
}

struct Planned {
    PreparedScene scene = test::stage_of({});
    RenderRequest request = test::stage_request();
};

TEST(PlanReasons, ComeAndGoWithTheirStepsAndNoOthers) {
    std::size_t number = 0;
    for (const Row& row : rows()) {
        Planned p;
        row.base(p.scene, p.request);
        const Planned before = p;
        const rast::RenderPlan without = plan_of(p.scene, p.request);
        row.change(p.scene, p.request);
        const rast::RenderPlan with = plan_of(p.scene, p.request);
        const Names old = codes_of(without), now = codes_of(with);
        EXPECT_EQ(less(now, old), row.come) << "row " << number;
        EXPECT_EQ(less(old, now), row.go) << "row " << number;
        EXPECT_EQ(test::changed(without, with), row.steps) << "row " << number;
        const rast::RenderPlan back = plan_of(before.scene, before.request);
        EXPECT_EQ(test::changed(without, back), Names()) << "row " << number << " put back";
        ++number;
    }
}

// What is asked for and left out for want of something is told apart from what nobody asked for.
TEST(PlanReasons, SayWhatIsAskedForAndCannotBeDone) {
    struct Case {
        Change change;
        const char *step, *label;
    };
    const Case cases[] = {
        {[](PreparedScene& s, RenderRequest&) { first(s).alpha_mode = prep::AlphaMode::blend; },
         "alpha blending", "not possible"},
        {none, "alpha blending", "not requested"},
        {[](PreparedScene& s, RenderRequest& r) {
             with_normal_map(s, r);
             s.meshes[0].tangents.clear();
         },
         "normal maps", "not possible"},
        {none, "normal maps", "not requested"},
        {[](PreparedScene& s, RenderRequest& r) {
             with_diffuse_map(s, r);
             first(s).diffuse_map.uv_set = 1;
         },
         "textures", "not possible"},
        {none, "textures", "not requested"},
        {[](PreparedScene& s, RenderRequest&) { s.meshes[0].normals.clear(); }, "vertex normals",
         "not possible"},
        {[](PreparedScene& s, RenderRequest& r) {
             with_normal_map(s, r);
             s.scene.images[0] = flat_picture();
         },
         "normal maps", "proved zero"},
    };
    for (const Case& c : cases) {
        Planned p;
        c.change(p.scene, p.request);
        const rast::RenderPlan plan = plan_of(p.scene, p.request);
        for (const rast::PlanStep& step : plan.steps) {
            if (prep::name_of(step.kind) != c.step) continue;
            EXPECT_FALSE(step.run) << c.step;
            EXPECT_EQ(prep::name_of(step.label), c.label) << c.step;
            EXPECT_EQ(step.reasons.at(0).label, step.label) << c.step;
            EXPECT_EQ(prep::sentence(step.reasons.at(0), p.scene.scene), step.reason) << c.step;
        }
    }
}

// `value` is what was found, `limit` what it is held against: the ball is 39 away from the lamp,
// its alpha is 0.75.
TEST(PlanReasons, FiguresAreWhatWasFoundAndWhatItIsHeldAgainst) {
    Planned p;
    with_mask(p.scene, p.request);
    first(p.scene).diffuse.a = 0.75f;
    p.request.lights->push_back(
        test::light_of(prep::LightKind::point, glm::vec3(1), {0, 0, 40}, {0, 0, -1}, 5));
    p.request.lights->push_back(
        test::light_of(prep::LightKind::point, glm::vec3(1), {0, 0, 40}, {0, 0, -1}));
    p.request.allow_error = 0.25f;
    std::map<std::string, prep::Reason> found;
    for (const rast::PlanStep& step : plan_of(p.scene, p.request).steps)
        for (const prep::Reason& why : step.reasons)
            found[std::string(prep::name_of(why.code))] = why;
    EXPECT_NEAR(found.at("light_range").value, 39, 0.01);
    EXPECT_EQ(found.at("light_range").limit, 5);
    EXPECT_EQ(prep::sentence(found.at("light_range"), p.scene.scene).find("light 2 reaches 5 far"),
              0u);
    EXPECT_EQ(found.at("mask_never_cuts").value, 0.75);
    EXPECT_EQ(found.at("mask_never_cuts").limit, 0.5);
    EXPECT_GT(found.at("light_faint").value, 0);
    EXPECT_LT(found.at("light_faint").value, 0.01);
    EXPECT_EQ(found.at("light_faint").limit, 0.25);
}

// Each code that a plan can have is in a row here or is one of the skips', each of which has a case
// of its own (Skips.*, BoundedSkips.*).
TEST(PlanReasons, AreAllInARow) {
    Names found = {"light_black",   "light_range",    "light_cone",      "light_behind",
                   "light_faint",   "map_times_zero", "highlights_zero", "normal_map_flat",
                   "bump_map_flat", "mask_never_cuts"};
    for (const Row& row : rows()) {
        found.insert(row.come.begin(), row.come.end());
        found.insert(row.go.begin(), row.go.end());
    }
    Names planned;
    for (const prep::ReasonRow& row : prep::reason_rows())
        if (row.code >= prep::ReasonCode::view_given) planned.insert(std::string(row.key));
    EXPECT_EQ(less(planned, found), Names());
    EXPECT_GE(planned.size(), 74u);
}

}  // namespace
