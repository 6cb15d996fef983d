#include "meshprep/output/gate_json.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "text/suggestions.h"

namespace meshprep {
namespace {

using prep::Error;
using prep::ErrorCode;

constexpr double most_views = 64, least_size = 16, most_size = 4096;

// Reads a gate's members; the first thing that is wrong stays as the error.
class GateReader {
  public:
    std::optional<Error> error;

    // A key as a JSON pointer has it (RFC 6901).
    static std::string escaped(const std::string& key) {
        std::string out;
        for (const char c : key) out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
        return out;
    }
    void complain(const std::string& pointer, const std::string& text) {
        if (!error) error = Error{ErrorCode::invalid, text, "#" + pointer};
    }
    // An object with these members alone.
    bool object(const Json& json, const std::string& pointer,
                const std::vector<std::string>& known) {
        if (!json.is_object()) {
            complain(pointer, "is no object");
            return false;
        }
        for (const auto& item : json.items())
            if (std::find(known.begin(), known.end(), item.key()) == known.end())
                complain(pointer + "/" + escaped(item.key()),
                         "is not known here" + prep::detail::suggestion(item.key(), known));
        return !error;
    }
    void limit(const Json& json, const std::string& pointer, std::optional<double>& to) {
        if (json.is_null()) {
            to.reset();
            return;
        }
        if (!json.is_number() || !(json.get<double>() >= 0) || !std::isfinite(json.get<double>()))
            return complain(pointer, "is neither null nor a number from 0 on");
        to = json.get<double>();
    }
    void count(const Json& json, const std::string& pointer, double least, double most,
               std::uint32_t& to) {
        if (!json.is_number_integer() || json.get<double>() < least || json.get<double>() > most)
            return complain(pointer, "is no whole number from " + std::to_string(int(least)) +
                                         " to " + std::to_string(int(most)));
        to = std::uint32_t(json.get<double>());
    }
};

Json number_or_null(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json index_or_null(std::uint32_t index) {
    return index == prep::no_index ? Json(nullptr) : Json(index);
}

}  // namespace

prep::Result<Gate> gate_from(std::string_view text) {
    // Of two members of one name a parser keeps one, and which is not what the writer meant.
    std::vector<std::set<std::string>> open;
    std::string twice;
    bool repeated = false;
    const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
        if (event == Json::parse_event_t::object_start) open.emplace_back();
        if (event == Json::parse_event_t::object_end) open.pop_back();
        if (event == Json::parse_event_t::key && !repeated) {
            twice = parsed.get<std::string>();
            repeated = !open.back().insert(twice).second;
        }
        return true;
    };
    const Json json = Json::parse(text, watch, false);
    if (json.is_discarded())
        return Error{ErrorCode::syntax, "is no JSON; docs/comparing.md says what a gate is", ""};
    if (repeated)
        return Error{ErrorCode::invalid, "has the member '" + twice + "' twice in one object", ""};
    Gate gate;
    GateReader read;
    if (!read.object(json, "", {"gate", "scope", "limits", "views", "size", "replay"}))
        return *read.error;
    if (!json.contains("gate") || json["gate"] != 1)
        read.complain("/gate", "is not 1, the number of this form of gates");
    if (json.contains("scope") && read.object(json["scope"], "/scope", {"meshes"}) &&
        json["scope"].contains("meshes")) {
        const Json& meshes = json["scope"]["meshes"];
        if (!meshes.is_array() || meshes.empty())
            read.complain("/scope/meshes", "is no list of names");
        for (std::size_t i = 0; i < meshes.size() && meshes.is_array(); ++i) {
            if (meshes[i].is_string())
                gate.meshes.push_back(meshes[i].get<std::string>());
            else
                read.complain("/scope/meshes/" + std::to_string(i), "is no name");
        }
    }
    if (json.contains("limits")) {
        std::vector<std::string> known = {"rmse"};
        for (const judge::LimitRow& row : judge::limit_rows) known.emplace_back(row.name);
        const Json& limits = json["limits"];
        if (read.object(limits, "/limits", known)) {
            for (const judge::LimitRow& row : judge::limit_rows)
                if (limits.contains(row.name))
                    read.limit(limits[row.name], std::string("/limits/") + row.name,
                               gate.limits.*row.limit);
            for (const char* drawn : {"silhouettes", "flip"})
                if (limits.contains(drawn) && limits[drawn].is_number()) gate.drawn_limit = drawn;
            if (limits.contains("rmse")) read.limit(limits["rmse"], "/limits/rmse", gate.rmse);
        }
    }
    if (json.contains("views")) read.count(json["views"], "/views", 0, most_views, gate.views);
    if (json.contains("size")) read.count(json["size"], "/size", least_size, most_size, gate.size);
    if (json.contains("replay")) {
        if (json["replay"].is_string())
            gate.replay = json["replay"].get<std::string>();
        else
            read.complain("/replay", "is no command");
    }
    if (read.error) return *read.error;
    return gate;
}

Json to_json(const judge::Judgement& judgement, const prep::Scene& first) {
    Json json;
    json["kind"] = "judgement";
    json["diagonal"] = number_or_null(judgement.diagonal);
    json["within"] = judgement.within();
    json["measures"] = Json::array();
    for (const judge::Measured& m : judgement.measured) {
        Json j;
        j["name"] = m.row->name;
        j["stage"] = m.row->stage;
        j["unit"] = m.row->unit;
        j["value"] = number_or_null(m.value);
        if (m.high) j["high"] = number_or_null(*m.high);
        j["proved"] = m.proved;
        j["limit"] = m.limit ? Json(*m.limit) : Json(nullptr);
        j["within"] = m.within;
        j["compared"] = m.compared;
        j["beyond"] = m.beyond;
        j["follows"] = m.follows.empty() ? Json(nullptr) : Json(m.follows);
        j["findings"] = Json::array();
        for (const judge::Finding& f : m.findings) {
            Json found;
            found["value"] = number_or_null(f.value);
            found["mesh"] = index_or_null(f.mesh);
            if (f.mesh < first.meshes.size()) found["mesh_name"] = first.meshes[f.mesh].name;
            found["node"] = index_or_null(f.node);
            if (f.node < first.nodes.size()) found["node_name"] = first.nodes[f.node].name;
            found["face"] = index_or_null(f.face);
            found["corner"] = index_or_null(f.corner);
            if (!f.text.empty()) found["text"] = f.text;
            j["findings"].push_back(std::move(found));
        }
        json["measures"].push_back(std::move(j));
    }
    json["views"] = Json::array();
    for (const judge::ViewJudged& view : judgement.views)
        json["views"].push_back(
            {{"direction", {view.direction.x, view.direction.y, view.direction.z}},
             {"outline", view.outline},
             {"worst", {view.x, view.y}},
             {"flip", view.compared_flip ? Json(view.flip) : Json(nullptr)}});
    json["notes"] = judgement.notes;
    return json;
}

}  // namespace meshprep
