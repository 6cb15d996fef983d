#include "prep/calls/reason.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <optional>

namespace prep {
namespace {

using Code = ReasonCode;
using Label = ReasonLabel;

constexpr ReasonRow rows[] = {
    {Code::none, "none", Label::not_requested, ""},
    // What meshes are prepared for.
    {Code::no_faces_normals, "no_faces_normals", Label::not_requested,
     "no faces: points and lines carry no normals"},
    {Code::no_faces_uvs, "no_faces_uvs", Label::not_requested, "no faces to be textured"},
    {Code::no_faces_tangents, "no_faces_tangents", Label::not_requested,
     "no faces: points and lines carry no tangents"},
    {Code::request_off, "request_off", Label::not_requested, "switched off by the request"},
    {Code::request_on, "request_on", Label::run, "asked for by the request"},
    {Code::request_on_without_uvs, "request_on_without_uvs", Label::not_possible,
     "asked for by the request, but the mesh has no UVs"},
    {Code::residual_map, "residual_map", Label::run, "a residual normal map reads them"},
    {Code::default_material_lit, "default_material_lit", Label::run,
     "faces without a material are lit by the default one"},
    {Code::material_lit, "material_lit", Label::run, "{material} is lit"},
    {Code::all_unlit, "all_unlit", Label::not_requested, "every material used is unlit"},
    {Code::flat_shading, "flat_shading", Label::not_requested, "flat shading uses face normals"},
    {Code::no_directed_light, "no_directed_light", Label::not_requested,
     "no light has a direction or a place"},
    {Code::no_colors_kept, "no_colors_kept", Label::not_requested, "nothing reads colours"},
    {Code::normal_buffer, "normal_buffer", Label::run, "normals are kept beside the picture"},
    {Code::uv_buffer, "uv_buffer", Label::run, "UVs are kept beside the picture"},
    {Code::vertex_colors, "vertex_colors", Label::run, "the mesh has colours at its vertices"},
    {Code::map, "map", Label::run, "{material} has a {map} map"},
    {Code::map_without_uvs, "map_without_uvs", Label::not_possible,
     "{material} has a {map} map, but UV set {value} is missing"},
    {Code::no_map, "no_map", Label::not_requested,
     "no material in use samples a texture on this mesh"},
    {Code::tangent_normal_map, "tangent_normal_map", Label::run,
     "{material} has a tangent-space normal map"},
    {Code::tangent_normal_map_without_uvs, "tangent_normal_map_without_uvs", Label::not_possible,
     "{material} has a tangent-space normal map, but UV set {value} is missing"},
    {Code::tangent_map, "tangent_map", Label::run,
     "{material} has a map in the tangent frame: {map}"},
    {Code::tangent_map_without_uvs, "tangent_map_without_uvs", Label::not_possible,
     "{material} has a map in the tangent frame: {map}, but UV set {value} is missing"},
    {Code::anisotropy, "anisotropy", Label::run, "{material} has anisotropy"},
    {Code::anisotropy_without_uvs, "anisotropy_without_uvs", Label::not_possible,
     "{material} has anisotropy, but UV set {value} is missing"},
    {Code::no_tangent_map, "no_tangent_map", Label::not_requested,
     "no material in use has a tangent-space normal map"},
    {Code::tangents_need_normals, "tangents_need_normals", Label::run, "tangents need normals"},
    {Code::tangents_without_normals, "tangents_without_normals", Label::not_possible,
     "tangents need normals, which are switched off"},

    // What a picture is planned of.
    {Code::view_given, "view_given", Label::run, "the view is given"},
    {Code::camera, "camera", Label::run, "{camera}"},
    {Code::view_framed, "view_framed", Label::run, "the scene has none: the whole of it is framed"},
    {Code::lights_given, "lights_given", Label::run, "{value} given"},
    {Code::no_lights_given, "no_lights_given", Label::not_requested, "0 given"},
    {Code::lights_of_scene, "lights_of_scene", Label::run, "the scene brings {value}"},
    {Code::lights_set_up, "lights_set_up", Label::run,
     "the scene has none: key, fill, rim and ambient light are set up"},
    {Code::light, "light", Label::run, "{light} may reach what is drawn"},
    {Code::light_black, "light_black", Label::proved_zero, "{light} is black"},
    {Code::light_range, "light_range", Label::proved_zero,
     "{light} reaches {limit} far, and everything is at least {value} away"},
    {Code::light_cone, "light_cone", Label::proved_zero, "nothing is in the cone of {light}"},
    {Code::light_behind, "light_behind", Label::proved_zero,
     "every normal points away from {light}"},
    {Code::light_faint, "light_faint", Label::bounded,
     "{light} adds at most {value}: lights that add {limit} together may be left out"},
    {Code::last_light, "last_light", Label::run, "{light} reaches nothing, and is the last one"},
    {Code::normal_maps, "normal_maps", Label::run, "a material in use has one"},
    {Code::normal_maps_unread, "normal_maps_unread", Label::not_requested,
     "the shading asked for does not read them"},
    {Code::normal_maps_unlit, "normal_maps_unlit", Label::not_requested,
     "nothing reads the normals that they would bend"},
    {Code::normal_maps_not_placed, "normal_maps_not_placed", Label::not_possible,
     "the meshes have not the normals, tangents or UVs that they need"},
    {Code::normal_map_not_placed, "normal_map_not_placed", Label::not_possible,
     "{material} has a {map} map, but its meshes have not the normals or tangents that it needs"},
    {Code::normal_maps_textures_off, "normal_maps_textures_off", Label::not_requested,
     "textures are switched off: shaded as Phong"},
    {Code::no_normal_map, "no_normal_map", Label::not_requested,
     "no material in use has a normal or bump map: shaded as Phong"},
    {Code::normal_map_flat, "normal_map_flat", Label::proved_zero,
     "the normal map of {material} is (0, 0, 1) everywhere: it bends no normal"},
    {Code::bump_map_flat, "bump_map_flat", Label::proved_zero,
     "the bump map of {material} has a strength of 0: it bends no normal"},
    {Code::normal_maps_all_flat, "normal_maps_all_flat", Label::proved_zero,
     "no normal or bump map in use bends a normal"},
    {Code::light_at_vertices, "light_at_vertices", Label::run,
     "Gouraud: light is computed at vertices"},
    {Code::light_at_pixels, "light_at_pixels", Label::not_requested, "light is computed at pixels"},
    {Code::normals_interpolated, "normals_interpolated", Label::run, "interpolated"},
    {Code::normals_missing, "normals_missing", Label::not_possible,
     "the meshes carry none: they are shaded by their face normals"},
    {Code::highlights, "highlights", Label::run, "{material} has highlights"},
    {Code::highlights_at_vertices, "highlights_at_vertices", Label::run,
     "{material} has none, but light at vertices is summed with them"},
    {Code::highlights_some, "highlights_some", Label::run,
     "lights are mirrored by materials in use"},
    {Code::highlights_all_zero, "highlights_all_zero", Label::proved_zero,
     "no material in use has any"},
    {Code::highlights_none, "highlights_none", Label::not_requested,
     "nothing is lit by a light with a direction"},
    {Code::highlights_zero, "highlights_zero", Label::proved_zero,
     "{material} has none: its specular colour is 0"},
    {Code::map_times_zero, "map_times_zero", Label::proved_zero,
     "the {map} map of {material} multiplies 0"},
    {Code::textures, "textures", Label::run, "sampled by materials in use"},
    {Code::no_textures, "no_textures", Label::not_requested,
     "no material in use samples a texture"},
    {Code::textures_off, "textures_off", Label::not_requested, "switched off"},
    {Code::textures_not_placed, "textures_not_placed", Label::not_possible,
     "the meshes have not what the maps of their materials need"},
    {Code::textures_all_neutral, "textures_all_neutral", Label::proved_zero,
     "no map in use changes anything"},
    {Code::srgb, "srgb", Label::run, "colour textures are stored encoded"},
    {Code::no_srgb, "no_srgb", Label::not_requested, "no colour texture is sampled"},
    {Code::filter, "filter", Label::run, "textures are filtered"},
    {Code::levels, "levels", Label::run,
     "the filter reads them; each is made when a pixel first asks for it"},
    {Code::no_levels, "no_levels", Label::not_requested, "the filter does not read them"},
    {Code::variants, "variants", Label::run, "triangles are shaded by what their materials have"},
    {Code::no_triangles, "no_triangles", Label::not_requested, "there are no triangles"},
    {Code::samples, "samples", Label::run,
     "{value} samples a pixel asked for; shaded once per triangle and pixel"},
    {Code::samples_areas, "samples_areas", Label::not_requested, "exact areas take its place"},
    {Code::one_sample, "one_sample", Label::not_requested, "one sample a pixel asked for"},
    {Code::samples_inside, "samples_inside", Label::proved_zero,
     "inside one triangle all of a pixel's samples are alike: such tiles take one"},
    {Code::areas, "areas", Label::run, "asked for: every triangle counts by what is seen of it"},
    {Code::no_areas, "no_areas", Label::not_requested, "samples decide what is seen"},
    {Code::supersampling, "supersampling", Label::run,
     "each pixel is the mean of {value} finer ones"},
    {Code::no_supersampling, "no_supersampling", Label::not_requested, "none asked for"},
    {Code::depth_float, "depth_float", Label::run,
     "reversed float, which has its fine steps far away"},
    {Code::depth_fixed, "depth_fixed", Label::run, "fixed point of {value} bits asked for"},
    {Code::cull_off, "cull_off", Label::not_requested, "switched off"},
    {Code::cull_back, "cull_back", Label::run, "back faces are left out"},
    {Code::cull_front, "cull_front", Label::run, "front faces are left out"},
    {Code::cull_by_material, "cull_by_material", Label::run,
     "back faces are left out but for double-sided materials"},
    {Code::blend_opaque, "blend_opaque", Label::not_possible,
     "blended materials are drawn opaque by this renderer"},
    {Code::no_blend, "no_blend", Label::not_requested, "no material in use is blended"},
    {Code::mask, "mask", Label::run, "a material in use cuts by alpha"},
    {Code::no_mask, "no_mask", Label::not_requested, "no material in use cuts by alpha"},
    {Code::mask_of, "mask_of", Label::run, "{material} cuts by alpha"},
    {Code::mask_never_cuts, "mask_never_cuts", Label::proved_zero,
     "the alpha of {material} is at least {value}, never below its cutoff of {limit}"},
    {Code::all_masks_never_cut, "all_masks_never_cut", Label::proved_zero,
     "no alpha in use is ever below its cutoff"},
    {Code::kept, "kept", Label::run, "asked for"},
    {Code::not_kept, "not_kept", Label::not_requested, "nothing reads it"},
    {Code::not_kept_numbers, "not_kept_numbers", Label::not_requested, "nothing reads them"},
    {Code::crop, "crop", Label::run, "a part of the picture is asked for"},
    {Code::no_crop, "no_crop", Label::not_requested, "the whole picture"},
    {Code::bands, "bands", Label::run,
     "the whole picture's pixels would take more than {limit} MiB: {value} rows are drawn at a "
     "time"},
    {Code::no_bands, "no_bands", Label::not_requested,
     "the whole picture's pixels take at most {limit} MiB"},
};

constexpr bool are_in_order() {
    for (std::size_t k = 0; k < std::size(rows); ++k)
        if (rows[k].code != ReasonCode(k)) return false;
    return std::size(rows) == std::size_t(Code::no_bands) + 1;  // the last one
}
static_assert(are_in_order());

// The row, key and number that a pointer names: "/materials/2/normal_map".
struct Subject {
    std::string_view list, member;
    std::uint32_t index = no_index;
};

std::optional<Subject> parse(std::string_view pointer) {
    if (pointer.size() < 2 || pointer[0] != '/') return {};
    Subject out;
    pointer.remove_prefix(1);
    const std::size_t slash = pointer.find('/');
    out.list = pointer.substr(0, slash);
    if (slash == std::string_view::npos) return out;
    pointer.remove_prefix(slash + 1);
    const std::size_t end = std::min(pointer.find('/'), pointer.size());
    std::from_chars(pointer.data(), pointer.data() + end, out.index);
    if (end < pointer.size()) out.member = pointer.substr(end + 1);
    return out;
}

std::string named(const char* what, const std::string& name, std::uint32_t index) {
    return name.empty() ? std::string(what) + " " + std::to_string(index)
                        : std::string(what) + " '" + name + "'";
}

// Of a map's name as a key: "metallic_roughness_map".
std::string key_of(const MaterialMap& map) {
    std::string key = map.name;
    std::replace(key.begin(), key.end(), ' ', '_');
    std::replace(key.begin(), key.end(), '-', '_');
    return key + "_map";
}

std::string number(double x) {
    char text[40];
    const auto end = std::to_chars(text, text + sizeof text, x, std::chars_format::general, 6).ptr;
    return {text, end};
}

std::string filled(std::string_view name, const Reason& why, const Subject& subject,
                   const Scene& scene) {
    const std::uint32_t i = subject.index;
    if (name == "value") return number(why.value);
    if (name == "limit") return number(why.limit);
    if (name == "material") {
        const std::string own = i < scene.materials.size()
                                    ? named("material", scene.materials[i].name, i)
                                    : "the default material";
        return why.drawn_as.empty() ? own : own + ", drawn as '" + why.drawn_as + "',";
    }
    if (name == "mesh")
        return i < scene.meshes.size() ? named("mesh", scene.meshes[i].name, i) : "";
    if (name == "map") {
        for (const MaterialMap& map : material_maps)
            if (key_of(map) == subject.member || key_of(map) == subject.list) return map.name;
        return {};
    }
    if (name == "light" || name == "camera") {
        if (subject.list != "nodes" || i >= scene.nodes.size()) return why.subject;
        const Node& node = scene.nodes[i];
        if (name == "light" && node.name.empty() && node.light < scene.lights.size())
            return named("light", scene.lights[node.light].name, node.light);
        return std::string(name) + " '" + node.name + "'";
    }
    assert(false && "a place in the words of a reason that nothing fills");
    return {};
}

}  // namespace

std::span<const ReasonRow> reason_rows() {
    return rows;
}

std::string_view name_of(ReasonCode code) {
    return rows[std::size_t(code)].key;
}

Reason reason(ReasonCode code, std::string subject, double value, double limit) {
    return {code, rows[std::size_t(code)].label, std::move(subject), value, limit, {}};
}

std::string sentence(const Reason& why, const Scene& scene) {
    const Subject subject = parse(why.subject).value_or(Subject{});
    std::string out;
    std::string_view words = rows[std::size_t(why.code)].words;
    for (std::size_t open; (open = words.find('{')) != std::string_view::npos;) {
        const std::size_t close = words.find('}', open);
        out += words.substr(0, open);
        out += filled(words.substr(open + 1, close - open - 1), why, subject, scene);
        words.remove_prefix(close + 1);
    }
    return out.append(words);
}

std::string material_subject(std::uint32_t material) {
    return material == no_index ? "" : "/materials/" + std::to_string(material);
}
std::string map_subject(std::uint32_t material, const MaterialMap& map) {
    return material_subject(material) + "/" + key_of(map);
}
std::string mesh_subject(std::uint32_t mesh) {
    return "/meshes/" + std::to_string(mesh);
}
std::string node_subject(std::uint32_t node) {
    return "/nodes/" + std::to_string(node);
}

}  // namespace prep
