#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <set>

#include "geometry/tile.h"
#include "plan/draw_choice.h"
#include "plan/drawn_contents.h"
#include "plan/filter_words.h"
#include "plan/frame_pass.h"
#include "plan/memory_estimate.h"
#include "plan/request_checks.h"
#include "plan/skips.h"
#include "rast/render.h"
#include "shading/texture.h"

namespace rast {
namespace {

// By the name of its node, else its own, else by number.
std::string place_of_camera(const prep::Scene& scene, std::uint32_t node) {
    const prep::Node& at = scene.nodes[node];
    const std::string& own = scene.cameras[at.camera].name;
    if (at.name.empty() && own.empty()) return "camera " + std::to_string(at.camera);
    return "camera '" + (at.name.empty() ? own : at.name) + "'";
}

using Code = prep::ReasonCode;
using Kind = PlanStepKind;
using prep::Material;
using prep::TextureRef;

class Planner {
  public:
    Planner(const prep::PreparedScene& prepared, const RenderRequest& request)
        : prepared_(prepared), contents_(detail::drawn_contents(prepared)) {
        plan_.request = request;
        plan_.passes = request.passes;
        plan_.triangles = contents_.triangles;
        plan_.vertices = contents_.vertices;
        plan_.textures_read.assign(detail::texture_uses * prepared.scene.textures.size(), false);
    }

    prep::Result<RenderPlan> run() {
        RenderRequest& r = plan_.request;
        if (std::optional<prep::Error> fault = detail::fault_of_size(contents_, r.shading))
            return std::move(*fault);
        if (!r.prune)
            r.keep_depth = r.keep_ids = r.keep_normals = r.keep_uvs = r.keep_barycentrics =
                r.keep_positions = true;
        if (std::optional<prep::Error> fault = camera()) return std::move(*fault);
        lights();
        shading();
        proved_ = detail::prove_skips(prepared_, plan_, contents_);
        plan_.skips = proved_.skips;
        plan_.texel_questions = proved_.texel_questions;
        consumer_ = consumer_of(plan_);
        maps_ = detail::maps_of_materials(prepared_, contents_, plan_);
        proved_steps();
        textures();
        variants();
        anti_aliasing();
        step(Kind::depth_test, true, depth_reason());
        step(Kind::culling, plan_.request.cull != Cull::none, cull_reason());
        step(Kind::alpha_blending, false,
             any([](const Material& m) { return m.alpha_mode == prep::AlphaMode::blend; })
                 ? Code::blend_opaque
                 : Code::no_blend);
        mask();
        const auto output = [&](Kind kind, bool kept, Code not_kept = Code::not_kept) {
            step(kind, kept, kept ? Code::kept : not_kept);
        };
        output(Kind::depth_output, plan_.request.keep_depth);
        output(Kind::triangle_numbers_output, plan_.request.keep_ids, Code::not_kept_numbers);
        output(Kind::normal_output, plan_.request.keep_normals);
        output(Kind::uv_output, plan_.request.keep_uvs);
        output(Kind::barycentric_output, plan_.request.keep_barycentrics);
        output(Kind::position_output, plan_.request.keep_positions);
        step(Kind::crop, plan_.request.crop.has_value(),
             plan_.request.crop ? Code::crop : Code::no_crop);
        memory();
        return std::move(plan_);
    }

  private:
    // `words`: instead of the reason's own, where several things are told in one sentence.
    void step(Kind kind, bool run, const prep::Reason& why, std::string words = {}) {
        if (words.empty()) words = prep::sentence(why, prepared_.scene);
        plan_.steps.push_back({kind, run, std::move(words), why.label, {why}});
    }
    void step(Kind kind, bool run, Code code) { step(kind, run, prep::reason(code)); }
    void add_reasons(const std::vector<prep::Reason>& more) {
        std::vector<prep::Reason>& all = plan_.steps.back().reasons;
        all.insert(all.end(), more.begin(), more.end());
    }

    // Highlights, and what the steps before say of each light and map.
    void proved_steps() {
        const auto runs = [](const std::vector<prep::Reason>& reasons) {
            return std::any_of(reasons.begin(), reasons.end(), [](const prep::Reason& r) {
                return r.label == prep::ReasonLabel::run;
            });
        };
        const bool lit =
            is_lit() && std::any_of(plan_.lights.begin(), plan_.lights.end(), [](const auto& l) {
                return l.kind != prep::LightKind::ambient;
            });
        const std::vector<prep::Reason>& own = proved_.highlights;
        const bool some = runs(own) || contents_.default_material;
        if (!lit)
            step(Kind::highlights, false, Code::highlights_none);
        else
            step(Kind::highlights, some, some ? Code::highlights_some : Code::highlights_all_zero);
        if (lit) add_reasons(own);
        for (PlanStep& s : plan_.steps) {
            if (s.kind == Kind::lights && s.run)
                s.reasons.insert(s.reasons.end(), proved_.lights.begin(), proved_.lights.end());
            if (s.kind != Kind::normal_maps || !s.run) continue;
            normal_map_step(s);
        }
    }

    // Its maps one by one: those that bend normals, those that are proved to bend none, and those
    // that cannot.
    void normal_map_step(PlanStep& s) {
        bool some = false, flat = false;
        for (const std::uint32_t m : contents_.materials)
            for (const prep::MaterialMap& map : prep::material_maps) {
                if (map.use != prep::MapUse::normals) continue;
                const std::uint32_t bit = 1u << unsigned(map.kind);
                if ((plan_.skips.of(m).maps & bit) != 0) {
                    flat = true;
                    s.reasons.push_back(
                        prep::reason(detail::flat_map_code(map.kind), prep::map_subject(m, map)));
                } else if ((maps_[m].placed & bit) != 0) {
                    some = true;
                    s.reasons.push_back(prep::reason(Code::map, prep::map_subject(m, map)));
                } else if ((maps_[m].wanted & bit) != 0) {
                    s.reasons.push_back(not_placed(m, map));
                }
            }
        if (some || !plan_.request.prune) return;
        const prep::Reason why =
            prep::reason(flat ? Code::normal_maps_all_flat : Code::normal_maps_not_placed);
        s.run = false;
        s.label = why.label;
        s.reason = prep::sentence(why, prepared_.scene);
        s.reasons[0] = why;
    }

    // Of a map that is wanted and that no mesh has all for.
    prep::Reason not_placed(std::uint32_t m, const prep::MaterialMap& map) const {
        const bool uvs = (maps_[m].without_uvs >> unsigned(map.kind) & 1u) != 0;
        const TextureRef& ref = prepared_.scene.materials[m].*map.ref;
        return prep::reason(uvs ? Code::map_without_uvs : Code::normal_map_not_placed,
                            prep::map_subject(m, map), uvs ? double(ref.uv_set) : 0);
    }

    void mask() {
        const auto cuts = [](const prep::Reason& r) { return r.label == prep::ReasonLabel::run; };
        const std::vector<prep::Reason>& own = proved_.masks;
        const bool run = std::any_of(own.begin(), own.end(), cuts);
        step(Kind::alpha_mask, run,
             run           ? Code::mask
             : own.empty() ? Code::no_mask
                           : Code::all_masks_never_cut);
        add_reasons(own);
    }

    void anti_aliasing() {
        const RenderRequest& r = plan_.request;
        const bool areas = r.coverage == Coverage::area;
        if (r.samples > 1)
            step(Kind::multisampling, true, prep::reason(Code::samples, {}, r.samples));
        else
            step(Kind::multisampling, false, areas ? Code::samples_areas : Code::one_sample);
        if (plan_.skips.inside_samples) add_reasons({prep::reason(Code::samples_inside)});
        step(Kind::exact_areas, areas, areas ? Code::areas : Code::no_areas);
        if (r.supersample > 1)
            step(Kind::supersampling, true,
                 prep::reason(Code::supersampling, {}, r.supersample * r.supersample));
        else
            step(Kind::supersampling, false, Code::no_supersampling);
    }

    void memory() {
        const RenderRequest& r = plan_.request;
        plan_.halo = detail::halo_of(plan_);
        detail::estimate_memory(plan_);
        const bool bands = plan_.band_rows < detail::picture_part(r).height;
        step(Kind::bands, bands,
             prep::reason(bands ? Code::bands : Code::no_bands, {}, plan_.band_rows,
                          double(r.band_bytes >> 20)));
    }

    template <class Test>
    bool any(const Test& test) const {
        return std::any_of(contents_.materials.begin(), contents_.materials.end(),
                           [&](std::uint32_t m) { return test(prepared_.scene.materials[m]); });
    }

    std::optional<prep::Error> camera() {
        const prep::Scene& scene = prepared_.scene;
        const double aspect = double(plan_.request.width) / plan_.request.height;
        if (plan_.request.view) {
            plan_.view = *plan_.request.view;
            step(Kind::camera, true, Code::view_given);
        } else if (scene.active_camera != prep::no_index) {
            plan_.view = camera_view(scene, scene.active_camera, aspect);
            step(Kind::camera, true,
                 prep::reason(Code::camera, prep::node_subject(scene.active_camera)));
        } else {
            OrbitOptions orbit;
            orbit.aspect = aspect;
            plan_.view = orbit_view(prepared_, orbit);
            step(Kind::camera, true, Code::view_framed);
        }
        if (std::optional<prep::Error> fault = detail::fault_of_view(plan_.view)) {
            if (!plan_.request.view && scene.active_camera != prep::no_index)
                fault->place = place_of_camera(scene, scene.active_camera);
            return fault;
        }
        plan_.view = bounded_view(prepared_, plan_.view);
        if (plan_.view.aspect == 0) plan_.view.aspect = aspect;
        return std::nullopt;
    }

    void lights() {
        Code code = Code::lights_given;
        if (plan_.request.lights) {
            plan_.lights = *plan_.request.lights;
            if (plan_.lights.empty()) code = Code::no_lights_given;
        } else {
            plan_.lights = scene_lights(prepared_.scene);
            code = Code::lights_of_scene;
        }
        if (plan_.lights.empty() && code == Code::lights_of_scene) {
            plan_.lights = three_light_setup(plan_.view);
            code = Code::lights_set_up;
        }
        if (code == Code::no_lights_given)
            step(Kind::lights, false, code);
        else if (is_lit())
            step(Kind::lights, true,
                 prep::reason(code, {},
                              code == Code::lights_set_up ? 0 : double(plan_.lights.size())));
        else
            step(Kind::lights, false, unlit_reason());
    }

    // Whether any light is computed at all, and why not.
    bool is_lit() const { return keeps_colors() && contents_.lit; }
    bool keeps_colors() const { return plan_.request.keep_color || !plan_.request.prune; }
    Code unlit_reason() const {
        return !keeps_colors()            ? Code::no_colors_kept
               : contents_.triangles == 0 ? Code::no_triangles
                                          : Code::all_unlit;
    }
    void shading() {
        Shading& shading = plan_.request.shading;
        std::uint32_t bits = 0;
        bool mapped = false;
        for (const prep::MaterialMap& map : prep::material_maps) {
            if (map.use != prep::MapUse::normals) continue;
            bits |= 1u << unsigned(map.kind);
            mapped |= any([&](const Material& m) { return bool(m.*map.ref); });
        }
        bool wanted = false, placed = false, tangents_missing = false;
        for (const detail::MapsOfMaterial& maps :
             detail::maps_of_materials(prepared_, contents_, plan_)) {
            wanted |= (maps.wanted & bits) != 0;
            placed |= (maps.placed & bits) != 0;
            tangents_missing |= maps.tangents_missing;
        }
        if (plan_.request.prune && shading == Shading::normal_mapped &&
            (!mapped || !plan_.request.textures)) {
            step(Kind::normal_maps, false,
                 mapped ? Code::normal_maps_textures_off : Code::no_normal_map);
            shading = Shading::phong;
        } else if (plan_.request.prune && shading == Shading::normal_mapped && !placed) {
            step(Kind::normal_maps, false,
                 wanted ? Code::normal_maps_not_placed : Code::normal_maps_unlit);
        } else {
            step(Kind::normal_maps, shading == Shading::normal_mapped,
                 shading == Shading::normal_mapped ? Code::normal_maps : Code::normal_maps_unread);
        }
        if (shading != Shading::flat && contents_.normals_missing) {
            plan_.warnings.push_back(
                "some meshes carry no normals: they are shaded by their face normals");
        }
        if (shading == Shading::normal_mapped && tangents_missing)
            plan_.warnings.push_back(
                "some normal-mapped meshes carry no tangents: their maps are left out");
        vertex_steps();
    }

    void vertex_steps() {
        const Shading shading = plan_.request.shading;
        const prep::Consumer consumer = consumer_of(plan_);
        const detail::NormalsRead normals = detail::normals_read(prepared_, contents_, consumer);
        const Code lighting = shading != Shading::gouraud ? Code::light_at_pixels
                              : !is_lit()                 ? unlit_reason()
                              : !normals.there            ? Code::normals_missing
                                                          : Code::light_at_vertices;
        step(Kind::vertex_lighting, lighting == Code::light_at_vertices, lighting);
        const Code why = shading == Shading::flat ? Code::flat_shading
                         : normals.there          ? Code::normals_interpolated
                         : normals.read           ? Code::normals_missing
                         : !is_lit()              ? unlit_reason()
                                                  : Code::no_directed_light;
        step(Kind::vertex_normals, why == Code::normals_interpolated, why);
    }

    void textures() {
        bool colour_used = false, data_used = false, uvs_missing = false;
        std::vector<prep::Reason> unplaced;
        const auto use = [&](const TextureRef& ref, const prep::MaterialMap& map) {
            const std::size_t slot =
                detail::texture_slot(prepared_.scene.textures.size(), map.kind, ref);
            if (slot >= plan_.textures_read.size()) return;
            plan_.textures_read[slot] = true;
            (map.color ? colour_used : data_used) = true;
        };
        if (plan_.request.textures) {
            for (const std::uint32_t m : contents_.materials) {
                const Material& material = prepared_.scene.materials[m];
                const detail::MapsOfMaterial& maps = maps_[m];
                uvs_missing |= maps.uvs_missing;
                for (const prep::MaterialMap& map : prep::material_maps) {
                    const std::uint32_t bit = 1u << unsigned(map.kind);
                    if ((maps.placed & bit) != 0) use(material.*map.ref, map);
                    if ((maps.wanted & ~maps.placed & bit) != 0)
                        unplaced.push_back(not_placed(m, map));
                }
            }
        }
        // Where no mesh has them, the file is not read: nobody would be told that it is broken.
        if (uvs_missing)
            plan_.warnings.push_back(
                "some meshes lack the UV set that a map of their material needs: the map is left "
                "out there");
        const bool some = colour_used || data_used;
        const Code none = !plan_.request.textures ? Code::textures_off
                          : !unplaced.empty()     ? Code::textures_not_placed
                          : !proved_.maps.empty() ? Code::textures_all_neutral
                                                  : Code::no_textures;
        step(Kind::textures, some, some ? Code::textures : none);
        add_reasons(proved_.maps);
        add_reasons(unplaced);
        step(Kind::srgb_decoding, colour_used, colour_used ? Code::srgb : Code::no_srgb);
        step(Kind::texture_filter, some, prep::reason(some ? Code::filter : none),
             some ? filter_reason() : "");
        const auto level_step = [&](Kind step_kind, TextureLevels kind) {
            bool read = false;
            for (std::size_t t = 0; t < prepared_.scene.textures.size(); ++t)
                read |=
                    is_read(t) && levels_for(filter_of(t), prepared_.scene.textures[t].mip) == kind;
            step(step_kind, read, !some ? none : read ? Code::levels : Code::no_levels);
        };
        level_step(Kind::mip_levels, TextureLevels::mipmap);
        level_step(Kind::ripmap_levels, TextureLevels::ripmap);
        // What is not drawn need not be looked at.
        for (std::size_t slot = 0; slot < plan_.texel_questions.size(); ++slot)
            if (!plan_.textures_read[slot]) plan_.texel_questions[slot] = {};
    }

    // In any way.
    bool is_read(std::size_t texture) const {
        const std::size_t textures = prepared_.scene.textures.size();
        for (std::size_t slot = texture; slot < plan_.textures_read.size(); slot += textures)
            if (plan_.textures_read[slot]) return true;
        return false;
    }

    TextureFilter filter_of(std::size_t texture) const {
        return filter_for(plan_.request.filter, prepared_.scene.textures[texture]);
    }

    std::string filter_reason() const {
        std::vector<TextureFilter> used;
        for (std::size_t t = 0; t < prepared_.scene.textures.size(); ++t)
            if (is_read(t)) used.push_back(filter_of(t));
        return detail::filter_words(plan_.request, used);
    }

    // How the triangles of one range are shaded, in words: the choice that the draws obey.
    PlanVariant variant_of(const prep::VertexMesh& mesh, std::uint32_t index) const {
        static const Material plain;
        const Material& m =
            index < prepared_.scene.materials.size() ? prepared_.scene.materials[index] : plain;
        const RenderRequest& r = plan_.request;
        const detail::DrawChoice choice = detail::choose(plan_, consumer_, mesh, m, index);
        PlanVariant out;
        std::string& name = out.name;
        const auto part = [&name](const std::string& text) {
            name += (name.empty() ? "" : ", ") + text;
        };
        if (m.unlit)
            part("unlit");
        else if (choice.source == detail::NormalSource::face)
            part("face normals");
        else if (r.shading == Shading::gouraud)
            part("light at vertices");
        else if (choice.source == detail::NormalSource::object_map)
            part("object-space normal map");
        else if (choice.source == detail::NormalSource::tangent_map)
            part("tangent-space normal map");
        else
            part("vertex normals");
        if (choice.has(prep::MapKind::bump)) part("bump map");
        if (!mesh.colors.empty()) part("vertex colours");
        const auto maps = [&](prep::MapUse use) {
            for (const prep::MaterialMap& map : prep::material_maps)
                if (map.use == use && choice.has(map.kind)) part(std::string(map.name) + " map");
        };
        maps(prep::MapUse::always);
        if (!m.unlit && m.metallic_roughness) part("metallic-roughness");
        for (const prep::MapUse use : {prep::MapUse::metallic_roughness, prep::MapUse::lit})
            maps(use);
        if (!choice.highlights) part("no highlights");
        if (choice.masked) part("alpha mask");
        out.maps = std::uint32_t(std::popcount(choice.maps));
        out.lit = !m.unlit && consumer_.lights;
        out.highlights = out.lit && choice.highlights;
        out.bends_normals = out.lit && (choice.source == detail::NormalSource::tangent_map ||
                                        choice.source == detail::NormalSource::object_map ||
                                        choice.has(prep::MapKind::bump));
        out.masked = choice.masked;
        return out;
    }

    void variants() {
        std::map<std::string, PlanVariant> found;
        for (const prep::Node& node : prepared_.scene.nodes) {
            if (node.mesh == prep::no_index) continue;
            const prep::VertexMesh& mesh = prepared_.meshes[node.mesh];
            for (const prep::VertexMesh::Range& range : mesh.ranges)
                if (range.triangle_count > 0) {
                    PlanVariant variant = variant_of(mesh, range.material);
                    PlanVariant& all = found.try_emplace(variant.name, variant).first->second;
                    all.triangles += range.triangle_count;
                }
        }
        for (const auto& [name, variant] : found) plan_.variants.push_back(variant);
        std::stable_sort(
            plan_.variants.begin(), plan_.variants.end(),
            [](const PlanVariant& a, const PlanVariant& b) { return a.triangles > b.triangles; });
        std::string list;
        for (const PlanVariant& v : plan_.variants)
            list += (list.empty() ? "" : "; ") + v.name + " (" + std::to_string(v.triangles) +
                    (v.triangles == 1 ? " triangle)" : " triangles)");
        const bool some = plan_.request.keep_color && !plan_.variants.empty();
        step(Kind::shading, some,
             prep::reason(some                        ? Code::variants
                          : !plan_.request.keep_color ? Code::no_colors_kept
                                                      : Code::no_triangles),
             some ? list : "");
    }

    prep::Reason depth_reason() const {
        switch (plan_.request.depth_format) {
            case DepthFormat::fixed16:
                return prep::reason(Code::depth_fixed, {}, 16);
            case DepthFormat::fixed24:
                return prep::reason(Code::depth_fixed, {}, 24);
            case DepthFormat::float32:
                break;
        }
        return prep::reason(Code::depth_float);
    }

    prep::Reason cull_reason() const {
        switch (plan_.request.cull) {
            case Cull::none:
                return prep::reason(Code::cull_off);
            case Cull::back:
                return prep::reason(Code::cull_back);
            case Cull::front:
                return prep::reason(Code::cull_front);
            case Cull::by_material:
                break;
        }
        return prep::reason(Code::cull_by_material);
    }

    const prep::PreparedScene& prepared_;
    detail::DrawnContents contents_;
    std::vector<detail::MapsOfMaterial> maps_;  // by Scene::materials, after the proofs
    RenderPlan plan_;
    detail::ProvedSkips proved_;
    prep::Consumer consumer_;
};

}  // namespace

prep::Result<RenderPlan> plan(const prep::PreparedScene& scene, const RenderRequest& request) {
    if (std::optional<prep::Error> fault = detail::fault_of_request(request))
        return std::move(*fault);
    return Planner(scene, request).run();
}

}  // namespace rast
