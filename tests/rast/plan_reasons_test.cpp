// Every reason that a plan can give: what brings it, which reasons go for it, and the steps that
// are told differently by it, no others.
#include <gtest/gtest.h>

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
         {"highlights_none", "no_lights_given"},
         {"highlights", "highlights_some", "light", "lights_given"},
         {"highlights", "lights"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.lights->front().color = {}; },
         {"last_light"},
         {"light"},
         {"lights"}},
        {in_gouraud,
         [](PreparedScene&, RenderRequest& r) { r.lights->clear(); },
         {"no_lights_given"},
         {"light", "lights_given"},
         {"lights"}},
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
         {"highlights_none"},
         {"highlights", "highlights_some"},
         {"highlights", "shading"}},
        {none,
         [](PreparedScene&, RenderRequest& r) { r.keep_color = false; },
         {"highlights_none", "no_colors_kept"},
         {"highlights", "highlights_some", "light", "variants"},
         {"highlights", "lights", "shading"}},
        {none,
         [](PreparedScene& s, RenderRequest&) { s.scene.nodes.clear(); },
         {"highlights_none", "no_triangles"},
         {"highlights", "highlights_some", "variants"},
         {"highlights", "shading"}},
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
         {"highlights_none", "no_textures", "normal_maps_unlit"},
         {"filter", "highlights", "highlights_some", "levels", "map", "no_levels", "normal_maps",
          "textures"},
         {"highlights", "mip levels", "normal maps", "ripmap levels", "shading", "texture filter",
          "textures"}},
        {with_normal_map,
         [](PreparedScene& s, RenderRequest&) { s.meshes[0].tangents.clear(); },
         {"normal_maps_not_placed"},
         {"map", "normal_maps"},
         {"normal maps", "shading"}},
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

// Each code that a plan can have is in a row here or is one of the skips', each of which has a case
// of its own (Skips.*, BoundedSkips.*).
TEST(PlanReasons, AreAllInARow) {
    Names found = {"light_black",     "light_range",     "light_cone",
                   "light_behind",    "light_faint",     "map_times_zero",
                   "highlights_zero", "normal_map_flat", "mask_never_cuts"};
    for (const Row& row : rows()) {
        found.insert(row.come.begin(), row.come.end());
        found.insert(row.go.begin(), row.go.end());
    }
    Names planned;
    for (const prep::ReasonRow& row : prep::reason_rows())
        if (row.code >= prep::ReasonCode::view_given) planned.insert(std::string(row.key));
    EXPECT_EQ(less(planned, found), Names());
    EXPECT_GE(planned.size(), 69u);
}

}  // namespace
