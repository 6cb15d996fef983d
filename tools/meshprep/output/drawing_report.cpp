#include "meshprep/output/drawing_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "meshprep/output/step_costs.h"

namespace meshprep {
namespace {

std::string with_article(const std::string& noun) {
    const bool vowel = std::string_view("aeiou").find(noun[0]) != std::string_view::npos;
    return (vowel ? "an " : "a ") + noun;
}

Json cost_json(const StepCost& cost) {
    Json json = {{"count", cost.count}, {"of", cost.of}, {"bytes", cost.bytes}};
    if (cost.milliseconds) json["milliseconds"] = *cost.milliseconds;
    return json;
}

Json measured_json(const MeasuredStep& measured) {
    Json json = {
        {"milliseconds", measured.milliseconds}, {"parts", Json::array()}, {"with", measured.with}};
    for (const rast::DrawingPart part : measured.parts)
        json["parts"].push_back(rast::name_of(part));
    return json;
}

// By the clock on the wall, and by part of drawing as threads have it.
Json milliseconds_json(const Drawn& drawn) {
    Json parts = Json::object();
    for (std::size_t p = 0; p < rast::drawing_parts; ++p)
        parts[std::string(rast::name_of(rast::DrawingPart(p)))] = drawn.frame.part_ms[p];
    return {{"geometry", drawn.frame.geometry_ms},
            {"drawing", drawn.frame.raster_ms},
            {"writing", drawn.write_ms},
            {"parts", std::move(parts)}};
}

}  // namespace

void BlackPixels::count(const rast::Frame& band, float exposure) {
    constexpr float least = 0.0003f;  // the first step of 8 bits above black
    const std::size_t step = std::max<std::size_t>(1, band.color.size() >> 18);
    for (std::size_t i = 0; i < band.color.size(); i += step) {
        const glm::vec4& c = band.color[i];
        if (!(c.a > 0)) continue;
        ++seen;
        black += std::max({c.r, c.g, c.b}) * exposure < least;
    }
}

std::optional<std::string> BlackPixels::warning(const prep::PreparedScene& prepared) const {
    constexpr std::uint64_t few = 64;
    if (seen < few || black * 10 < seen * 9) return {};
    const bool black_materials =
        !prepared.scene.materials.empty() &&
        std::all_of(prepared.scene.materials.begin(), prepared.scene.materials.end(),
                    [](const prep::Material& m) {
                        return m.diffuse.r + m.diffuse.g + m.diffuse.b < 0.01f;
                    });
    return fmt::format(
        "{} % of the pixels that show a surface are black: {}", black * 100 / seen,
        black_materials ? "the materials' colours are black"
                        : "the lights do not reach it or are far too weak; --exposure auto finds "
                          "an exposure, --light takes other lights");
}

Json plan_json(const rast::RenderPlan& plan, const prep::PreparedScene& prepared,
               const Drawn* explained) {
    const rast::Frame* const drawn = explained != nullptr ? &explained->frame : nullptr;
    const prep::Scene& scene = prepared.scene;
    const std::uint64_t points = drawn != nullptr ? expected_points(prepared, plan) : 0;
    Json json;
    if (explained != nullptr) json["milliseconds"] = milliseconds_json(*explained);
    json["width"] = plan.request.width;
    json["height"] = plan.request.height;
    json["shading"] = std::string(prep::name_of(plan.request.shading));
    json["triangles"] = plan.triangles;
    json["lights"] = plan.lights.size();
    json["memory_estimate"] = plan.memory_estimate;
    json["band_rows"] = plan.band_rows;
    json["band_memory_estimate"] = plan.band_memory_estimate;
    json["variants"] = Json::array();
    for (const rast::PlanVariant& v : plan.variants)
        json["variants"].push_back({{"shading", v.name}, {"triangles", v.triangles}});
    json["steps"] = Json::array();
    for (const rast::PlanStep& s : plan.steps) {
        Json reasons = Json::array();
        for (const prep::Reason& why : s.reasons) reasons.push_back(to_json(why, scene));
        json["steps"].push_back({{"step", prep::name_of(s.kind)},
                                 {"run", s.run},
                                 {"label", prep::name_of(s.label)},
                                 {"reason", s.reason},
                                 {"reasons", std::move(reasons)}});
        if (drawn == nullptr) continue;
        Json& step = json["steps"].back();
        if (const std::optional<StepCost> before = estimate_of(s, plan, points))
            step["estimate"] = cost_json(*before);
        if (const std::optional<StepCost> cost = cost_of(s, plan, drawn->counters))
            step["cost"] = cost_json(*cost);
        if (const std::optional<MeasuredStep> took = time_of(s, plan, *drawn))
            step["measured"] = measured_json(*took);
    }
    return json;
}

Json counters_json(const rast::Counters& c) {
    Json stages = Json::object();
    for (std::size_t k = 0; k < rast::shade_stages; ++k)
        stages[std::string(rast::shade_stage_names[k])] = c.stage_points[k];
    return {{"triangles", c.triangles},
            {"non_finite", c.non_finite},
            {"degenerate", c.degenerate},
            {"facing_away", c.facing_away},
            {"outside", c.outside},
            {"between_samples", c.between_samples},
            {"crossing", c.crossing},
            {"vertices_lit", c.vertices_lit},
            {"pixels_shaded", c.pixels_shaded},
            {"texture_samples", c.texture_samples},
            {"light_points", c.light_points},
            {"highlight_points", c.highlight_points},
            {"normal_map_points", c.normal_map_points},
            {"stage_points", std::move(stages)},
            {"masked_triangles", c.masked_triangles},
            {"sample_points", c.sample_points},
            {"textures_read", c.textures_read},
            {"texture_levels", c.texture_levels},
            {"buffer_bytes", c.buffer_bytes},
            {"list_bytes", c.list_bytes}};
}

void explain(const rast::RenderPlan& plan, const prep::PreparedScene& prepared,
             const rast::Frame& drawn, const CommonOptions& common, Console& console) {
    const std::uint64_t points = expected_points(prepared, plan);
    std::vector<std::vector<std::string>> rows;
    for (const rast::PlanStep& s : plan.steps) {
        rows.push_back({std::string(prep::name_of(s.kind)), std::string(prep::name_of(s.label)),
                        text_of(cost_of(s, plan, drawn.counters), estimate_of(s, plan, points),
                                time_of(s, plan, drawn)),
                        s.reason});
        for (std::size_t k = 1; k < s.reasons.size(); ++k)
            rows.push_back({"", std::string(prep::name_of(s.reasons[k].label)), "",
                            prep::sentence(s.reasons[k], prepared.scene)});
    }
    console.table(common, rows, {});
    rows.clear();
    for (std::size_t p = 0; p < rast::drawing_parts; ++p) {
        const std::uint64_t at = p < rast::shade_stages ? drawn.counters.stage_points[p] : 0;
        if (drawn.part_ms[p] > 0 || at > 0)
            rows.push_back({std::string(rast::name_of(rast::DrawingPart(p))),
                            at > 0 ? with_commas(at) : "", duration(drawn.part_ms[p])});
    }
    console.result(common, "  parts of drawing, points, time of all threads:");
    console.table(common, rows, {});
    console.result(common, fmt::format("  {}, about {} beside textures; geometry {}, drawing {}",
                                       count_of(plan.triangles, "triangle"),
                                       byte_size(plan.band_memory_estimate),
                                       duration(drawn.geometry_ms), duration(drawn.raster_ms)));
}

std::vector<std::string> not_drawn(const prep::PreparedScene& prepared) {
    std::set<std::uint32_t> materials;
    std::size_t lines = 0, points = 0, skinned = 0;
    for (const prep::VertexMesh& mesh : prepared.meshes) {
        for (const prep::VertexMesh::Range& range : mesh.ranges)
            if (range.triangle_count > 0 && range.material != prep::no_index)
                materials.insert(range.material);
        lines += mesh.lines.size() / 2;
        points += mesh.points.size();
    }
    for (const prep::Node& node : prepared.scene.nodes)
        skinned += node.mesh != prep::no_index && node.skin != prep::no_index;
    std::vector<std::string> out;
    if (std::none_of(prepared.scene.nodes.begin(), prepared.scene.nodes.end(),
                     [](const prep::Node& node) { return node.mesh != prep::no_index; }))
        out.push_back("nothing is drawn: no node places a mesh");
    for (const std::uint32_t m : materials) {
        const prep::Material& material = prepared.scene.materials[m];
        const std::string name =
            "material " + (material.name.empty() ? std::to_string(m) : "'" + material.name + "'");
        if (material.alpha_mode == prep::AlphaMode::blend)
            out.push_back(name + " is drawn opaque: nothing is blended");
        for (const prep::MaterialMap& map : prep::material_maps)
            if (map.use == prep::MapUse::not_drawn && material.*map.ref)
                out.push_back(name + " has " + with_article(map.name) + " map, which is not drawn");
    }
    if (skinned > 0)
        out.push_back(count_of(skinned, "skinned mesh", "skinned meshes") +
                      (skinned == 1 ? " is drawn" : " are drawn") + " as modelled, not posed");
    if (const std::size_t targets = prep::morph_target_count(prepared.scene); targets > 0)
        out.push_back("morph targets are not applied: " + std::to_string(targets) +
                      ", whatever their weights");
    if (lines + points > 0)
        out.push_back((lines > 0 ? count_of(lines, "line segment") : "") +
                      (lines > 0 && points > 0 ? " and " : "") +
                      (points > 0 ? count_of(points, "point") : "") +
                      (lines + points == 1 ? " is" : " are") + " not drawn, only triangles are");
    return out;
}

std::optional<std::string> why_empty(const rast::Counters& counters, std::uint64_t triangles,
                                     const rast::RenderRequest& request) {
    const std::string culled = request.cull == prep::Cull::front
                                   ? "seen from the front, which --cull front leaves out"
                                   : "seen from behind (--cull none draws both sides)";
    const std::pair<std::uint64_t, std::string> reasons[] = {
        {counters.facing_away, culled},
        {counters.outside, "outside of it or behind the camera"},
        {counters.degenerate, "without an area in it"},
        {request.coverage == rast::Coverage::area ? 0 : counters.between_samples,
         "too small to cover a pixel's centre"},
        {counters.non_finite, "at no point of space"}};
    // Drawn in bands, each counts them.
    const bool counts = counters.triangles == triangles;
    std::uint64_t left_out = 0;
    std::string text;
    for (const auto& [count, reason] : reasons) {
        left_out += count;
        if (count == 0) continue;
        const std::string of = count_of(count, "triangle");
        if (counts)
            text += (text.empty() ? "" : ", ") +
                    (count < triangles ? of
                     : count == 1      ? "its triangle"
                                       : "all " + of) +
                    (count == 1 ? " is " : " are ") + reason;
        else
            text += (text.empty() ? "its triangles are " : ", or ") + reason;
    }
    if (left_out == 0 || left_out < counters.triangles) return std::nullopt;
    return "the picture is empty: " + text;
}

}  // namespace meshprep
