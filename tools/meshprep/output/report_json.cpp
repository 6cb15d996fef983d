#include "meshprep/output/report_json.h"

#include <cmath>

#include "prep/version.h"

namespace meshprep {

Json to_json(const prep::Error& error) {
    Json json;
    json["code"] = std::string(prep::to_string(error.code));
    json["text"] = error.text;
    json["place"] = error.place;
    return json;
}

Json to_json(const prep::Finding& finding, const prep::Scene& scene) {
    Json json;
    json["kind"] = finding.kind;
    json["severity"] = prep::name_of(finding.severity);
    json["mesh"] = finding.mesh;
    if (finding.mesh < scene.meshes.size() && !scene.meshes[finding.mesh].name.empty())
        json["mesh_name"] = scene.meshes[finding.mesh].name;
    json["count"] = finding.count;
    json["place_kind"] = prep::name_of(finding.place_kind);
    json["places"] = finding.places;
    json["text"] = finding.text;
    return json;
}

Json to_json(const prep::RepairStep& repair) {
    Json json;
    json["step"] = repair.step;
    json["mesh"] = repair.mesh;
    json["changed"] = repair.changed;
    json["left"] = repair.left;
    json["place_kind"] = prep::name_of(repair.place_kind);
    json["places"] = repair.places;
    json["text"] = repair.text;
    return json;
}

Json to_json(const prep::StageReport& stage, bool memory) {
    Json json;
    json["stage"] = stage.stage;
    json["run"] = stage.run;
    json["reason"] = stage.reason;
    json["milliseconds"] = stage.milliseconds;
    json["decided_exactly"] = stage.exact;
    if (stage.moved_bytes > 0) json["moved_bytes"] = stage.moved_bytes;
    if (!memory) return json;
    json["page_faults"] = stage.page_faults;
    json["peak_bytes"] = stage.peak_bytes;
    return json;
}

Json to_json(const prep::Reason& why, const prep::Scene& scene) {
    Json json = {{"code", prep::name_of(why.code)},
                 {"label", prep::name_of(why.label)},
                 {"subject", why.subject},
                 {"value", why.value},
                 {"limit", why.limit},
                 {"sentence", prep::sentence(why, scene)}};
    if (!why.drawn_as.empty()) json["drawn_as"] = why.drawn_as;
    return json;
}

Json to_json(const prep::SplitCounts& splits) {
    Json json;
    for (const prep::SplitCountName& row : prep::split_count_names)
        json[row.key] = splits.*row.count;
    return json;
}

Json to_json(const prep::TessellationCertificate& certificate) {
    const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(); };
    Json json;
    json["triangles"] = certificate.triangles;
    json["deepest"] = certificate.deepest;
    if (certificate.asked) json["asked"] = *certificate.asked;
    if (certificate.asked_pixels) json["asked_pixels"] = *certificate.asked_pixels;
    if (certificate.proved_pixels) json["proved_pixels"] = number(*certificate.proved_pixels);
    json["proved"] = number(certificate.proved);
    json["proved_refinable"] = number(certificate.proved_refinable);
    json["largest_shared_gap"] = number(certificate.largest_shared_gap);
    json["measured"] = certificate.measured;
    json["samples"] = certificate.samples;
    json["unresolved"] = certificate.unresolved;
    json["over_budget"] = certificate.over_budget;
    if (certificate.worst_face != prep::no_index) json["worst_face"] = certificate.worst_face;
    return json;
}

Json to_json(const prep::OrderChange& order) {
    const auto cost = [](const prep::OrderCost& c) {
        return Json{{"shaded", c.shaded}, {"acmr", c.acmr}, {"atvr", c.atvr}};
    };
    return {{"triangles_moved", order.triangles},
            {"vertices_moved", order.vertices},
            {"triangles_kept", order.kept_triangles},
            {"before", cost(order.before)},
            {"after", cost(order.after)}};
}

Json to_json(const prep::ResidualMap& map, const std::string& material_name) {
    return {{"material", map.material},
            {"material_name", material_name},
            {"image", map.image},
            {"size", map.size},
            {"bits", map.bits},
            {"uv_set", map.uv_set},
            {"texels", map.texels},
            {"overlapping", map.overlapping},
            {"facing_away", map.facing_away},
            {"mean_degrees", map.mean_degrees},
            {"largest_degrees", map.largest_degrees}};
}

Json json_head(const char* command) {
    Json json;
    json["command"] = command;
    json["version"] = std::string(prep::version());
    return json;
}

std::string json_text(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

std::string json_line(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace meshprep
