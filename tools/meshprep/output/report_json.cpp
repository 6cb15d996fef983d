#include "meshprep/output/report_json.h"

#include "prep/version.h"

namespace meshprep {

Json to_json(const prep::Error& error) {
    Json json;
    json["code"] = std::string(prep::to_string(error.code));
    json["text"] = error.text;
    if (!error.place.empty()) json["place"] = error.place;
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

Json to_json(const prep::StageReport& stage) {
    Json json;
    json["stage"] = stage.stage;
    json["run"] = stage.run;
    json["reason"] = stage.reason;
    json["milliseconds"] = stage.milliseconds;
    json["decided_exactly"] = stage.exact;
    return json;
}

std::vector<std::pair<const char*, std::uint64_t>> split_list(const prep::SplitCounts& s) {
    std::vector<std::pair<const char*, std::uint64_t>> list;
    const auto add = [&list](const char* name, std::uint64_t count) {
        if (count > 0) list.emplace_back(name, count);
    };
    add("hard edge", s.hard_edge);
    add("smoothing group", s.smoothing_group);
    add("authored normal", s.authored_normal);
    add("UV seam", s.uv_seam);
    add("mirrored UV", s.mirrored_uv);
    add("tangent", s.tangent);
    add("colour", s.color);
    add("material", s.material);
    return list;
}

Json to_json(const prep::SplitCounts& s) {
    return {{"hard_edge", s.hard_edge},
            {"smoothing_group", s.smoothing_group},
            {"authored_normal", s.authored_normal},
            {"uv_seam", s.uv_seam},
            {"mirrored_uv", s.mirrored_uv},
            {"tangent", s.tangent},
            {"color", s.color},
            {"material", s.material}};
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

}  // namespace meshprep
