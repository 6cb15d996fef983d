#include "meshprep/output/cost_json.h"

#include <cmath>
#include <limits>

namespace meshprep {
namespace {

using prep::Error;
using prep::ErrorCode;

// What a table may hold, so that no document takes long, and no coordinate of a plot overflows.
// Times from a picosecond to 30 years.
constexpr std::size_t most_ladders = 1000, most_rungs = 64, most_metrics = 64, most_rounds = 1000;
constexpr std::size_t most_picture = 1 << 16;
constexpr double least_time = 1e-12, most_time = 1e9, largest_error = 1e300;

// JSON knows no infinity: a number that is not finite is a string.
Json number(double value) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    return value;
}
Json numbers(const std::vector<double>& values) {
    Json list = Json::array();
    for (const double v : values) list.push_back(number(v));
    return list;
}
Json interval(const cost::Estimate& e) {
    return {{"value", number(e.value)}, {"low", number(e.low)}, {"high", number(e.high)}};
}

// Reads members of objects; the first thing that is wrong stays as the error.
// Such as it is in the document: the table's fields, checked.
class CheckedDocument {
  public:
    std::optional<Error> error;

    const Json& member(const Json& object, const std::string& pointer, const char* name) {
        static const Json none;
        if (!object.is_object() || !object.contains(name)) {
            complain(pointer, std::string("has no '") + name + "'");
            return none;
        }
        return object[name];
    }
    const Json& list(const Json& object, const std::string& pointer, const char* name) {
        static const Json empty = Json::array();
        const Json& value = member(object, pointer, name);
        if (value.is_array()) return value;
        complain(pointer + "/" + name, "is no array");
        return empty;
    }
    std::string text(const Json& object, const std::string& pointer, const char* name) {
        const Json& value = member(object, pointer, name);
        if (value.is_string()) return value.get<std::string>();
        complain(pointer + "/" + name, "is no string");
        return {};
    }
    // Of a PNG file, in base64: it stands in a page as it is.
    std::string png(const Json& value, const std::string& pointer) {
        constexpr std::string_view signature = "iVBORw0KGgo";
        constexpr const char* digits =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=";
        if (value.is_string()) {
            std::string text = value.get<std::string>();
            if (text.size() <= most_picture && text.starts_with(signature) &&
                text.find_first_not_of(digits) == std::string::npos)
                return text;
        }
        complain(pointer, "is no small PNG file in base64");
        return {};
    }
    bool truth(const Json& object, const std::string& pointer, const char* name) {
        const Json& value = member(object, pointer, name);
        if (value.is_boolean()) return value.get<bool>();
        complain(pointer + "/" + name, "is neither true nor false");
        return false;
    }
    double real(const Json& value, const std::string& pointer, double least, double most) {
        if (value.is_number()) {
            const double v = value.get<double>();
            if (v >= least && v <= most) return v;
        }
        complain(pointer, "is no number that is possible here");
        return 0;
    }
    // As number() writes them: any number, also "inf", "-inf" and "nan".
    double error_value(const Json& value, const std::string& pointer) {
        if (value == "inf") return std::numeric_limits<double>::infinity();
        if (value == "-inf") return -std::numeric_limits<double>::infinity();
        if (value == "nan") return std::numeric_limits<double>::quiet_NaN();
        return real(value, pointer, -largest_error, largest_error);
    }
    const Json& list_of(const Json& object, const std::string& pointer, const char* name,
                        std::size_t most) {
        static const Json empty = Json::array();
        const Json& values = list(object, pointer, name);
        if (values.size() <= most) return values;
        complain(pointer + "/" + name, "has more than " + std::to_string(most) + " entries");
        return empty;
    }
    std::size_t count(const Json& object, const std::string& pointer, const char* name,
                      std::size_t most) {
        const Json& value = member(object, pointer, name);
        if (value.is_number_unsigned() && value.get<std::uint64_t>() <= most)
            return std::size_t(value.get<std::uint64_t>());
        complain(pointer + "/" + name, "is no whole number up to " + std::to_string(most));
        return 0;
    }
    // By round.
    std::vector<double> times(const Json& object, const std::string& pointer, const char* name) {
        std::vector<double> out;
        const Json& values = list_of(object, pointer, name, most_rounds);
        for (std::size_t i = 0; i < values.size(); ++i) {
            const std::string at = pointer + "/" + name + "/" + std::to_string(i);
            out.push_back(real(values[i], at, least_time, most_time));
        }
        return out;
    }
    void complain(const std::string& pointer, const std::string& text) {
        if (!error)
            error = Error{ErrorCode::invalid, text + "; the file is not what cost --json writes",
                          "#" + pointer};
    }
};

cost::RungRecord rung_from(CheckedDocument& read, const Json& json, const std::string& at,
                           std::size_t metrics) {
    cost::RungRecord rung;
    rung.name = read.text(json, at, "name");
    rung.command = read.text(json, at, "command");
    rung.exact = read.truth(json, at, "exact");
    const Json& errors = read.list_of(json, at, "errors", most_metrics);
    for (std::size_t i = 0; i < errors.size(); ++i)
        rung.errors.push_back(read.error_value(errors[i], at + "/errors/" + std::to_string(i)));
    if (errors.size() != metrics)
        read.complain(at + "/errors", "has " + std::to_string(errors.size()) + " numbers for " +
                                          std::to_string(metrics) + " metrics");
    rung.seconds = read.times(json, at, "seconds");
    rung.repeats = int(read.count(json, at, "repeats", 1000000));
    if (json.is_object() && json.contains("because")) rung.because = read.text(json, at, "because");
    if (json.is_object() && json.contains("looks")) {
        const Json& looks = read.list_of(json, at, "looks", 2);
        if (looks.size() != 2) read.complain(at + "/looks", "is not two pictures");
        for (std::size_t i = 0; i < looks.size(); ++i)
            (i == 0 ? rung.picture : rung.difference) =
                read.png(looks[i], at + "/looks/" + std::to_string(i));
    }
    return rung;
}

// Two settings, as many pairs of whose values as there are rungs.
std::vector<cost::GridSetting> grid_from(CheckedDocument& read, const Json& json,
                                         const std::string& at) {
    std::vector<cost::GridSetting> grid;
    const Json& settings = read.list_of(json, at, "grid", 2);
    std::size_t pairs = settings.size() == 2 ? 1 : 0;
    for (std::size_t i = 0; i < settings.size(); ++i) {
        const std::string place = at + "/grid/" + std::to_string(i);
        cost::GridSetting setting{read.text(settings[i], place, "name"), {}};
        const Json& values = read.list_of(settings[i], place, "values", most_rungs);
        for (const Json& value : values) {
            if (!value.is_string())
                read.complain(place + "/values", "holds something other than words");
            else
                setting.values.push_back(value.get<std::string>());
        }
        pairs *= setting.values.size();
        grid.push_back(std::move(setting));
    }
    if (pairs == 0 || pairs != read.list_of(json, at, "rungs", most_rungs).size())
        read.complain(at + "/grid", "is not two settings of as many pairs as there are rungs");
    return grid;
}

cost::LadderRecord ladder_from(CheckedDocument& read, const Json& json, const std::string& at) {
    cost::LadderRecord ladder;
    ladder.name = read.text(json, at, "name");
    // It becomes the name of a file.
    if (ladder.name.empty() ||
        ladder.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") != std::string::npos)
        read.complain(at + "/name", "is no ladder's name");
    ladder.title = read.text(json, at, "title");
    ladder.setting = read.text(json, at, "setting");
    ladder.subject = read.text(json, at, "subject");
    ladder.oracle = read.text(json, at, "oracle");
    const Json& timed = read.list(json, at, "timed");
    for (const Json& part : timed) {
        if (!part.is_string())
            read.complain(at + "/timed", "holds something other than words");
        else
            ladder.timed.push_back(part.get<std::string>());
    }
    const Json& metrics = read.list_of(json, at, "metrics", most_metrics);
    for (std::size_t i = 0; i < metrics.size(); ++i) {
        const std::string place = at + "/metrics/" + std::to_string(i);
        ladder.metrics.push_back({read.text(metrics[i], place, "name"),
                                  read.text(metrics[i], place, "unit"),
                                  read.text(metrics[i], place, "domain")});
    }
    if (metrics.empty()) read.complain(at + "/metrics", "is empty");
    ladder.primary = read.count(json, at, "primary", metrics.empty() ? 0 : metrics.size() - 1);
    const Json& floor = read.member(json, at, "floor");
    if (!floor.is_null()) ladder.floor = read.real(floor, at + "/floor", 0, largest_error);
    ladder.floor_text = read.text(json, at, "floor_is");
    const Json& rungs = read.list_of(json, at, "rungs", most_rungs);
    ladder.reference = read.count(json, at, "reference", rungs.empty() ? 0 : rungs.size() - 1);
    ladder.reference_is_default = read.truth(json, at, "reference_is_default");
    ladder.control = read.times(json, at, "control_seconds");
    if (rungs.empty()) read.complain(at + "/rungs", "is empty");
    for (std::size_t i = 0; i < rungs.size(); ++i) {
        const std::string place = at + "/rungs/" + std::to_string(i);
        ladder.rungs.push_back(rung_from(read, rungs[i], place, metrics.size()));
        if (ladder.rungs.back().seconds.size() != ladder.control.size() || ladder.control.empty())
            read.complain(place + "/seconds", "has not as many rounds as control_seconds");
    }
    if (json.is_object() && json.contains("grid")) ladder.grid = grid_from(read, json, at);
    ladder.wall =
        read.real(read.member(json, at, "wall_seconds"), at + "/wall_seconds", 0, most_time);
    ladder.cpu = read.real(read.member(json, at, "cpu_seconds"), at + "/cpu_seconds", 0, most_time);
    ladder.taken =
        read.real(read.member(json, at, "taken_by_others"), at + "/taken_by_others", 0, 1);
    ladder.narrow = read.truth(json, at, "narrow");
    ladder.measurements = int(read.count(json, at, "measurements", 1000000000));
    ladder.retries = int(read.count(json, at, "taken_again", 1000000000));
    return ladder;
}

}  // namespace

Json to_json(const cost::CostTable& table) {
    Json json = json_head("cost");
    json["version"] = table.version;
    json["processor"] = table.processor;
    json["threads"] = table.threads;
    json["ladders"] = Json::array();
    for (const cost::LadderRecord& ladder : table.ladders) {
        Json l;
        l["name"] = ladder.name;
        l["title"] = ladder.title;
        l["setting"] = ladder.setting;
        l["subject"] = ladder.subject;
        l["oracle"] = ladder.oracle;
        l["timed"] = ladder.timed;
        l["metrics"] = Json::array();
        for (const cost::Metric& m : ladder.metrics)
            l["metrics"].push_back({{"name", m.name}, {"unit", m.unit}, {"domain", m.domain}});
        l["primary"] = ladder.primary;
        l["floor"] = ladder.floor ? number(*ladder.floor) : Json();
        l["floor_is"] = ladder.floor_text;
        l["reference"] = ladder.reference;
        l["reference_is_default"] = ladder.reference_is_default;
        for (const cost::GridSetting& setting : ladder.grid)
            l["grid"].push_back({{"name", setting.name}, {"values", setting.values}});
        l["rungs"] = Json::array();
        for (const cost::RungRecord& rung : ladder.rungs) {
            Json r;
            r["name"] = rung.name;
            r["command"] = rung.command;
            r["exact"] = rung.exact;
            r["errors"] = numbers(rung.errors);
            r["time"] = interval(rung.time);
            r["ratio"] = interval(rung.ratio);
            r["standing"] = rung.exact ? "exact" : cost::word_for(rung.verdict.standing);
            if (!rung.exact && rung.verdict.standing != cost::Standing::front)
                r["by"] = ladder.rungs[rung.verdict.by].name;
            if (!rung.because.empty()) r["because"] = rung.because;
            if (!rung.picture.empty()) r["looks"] = {rung.picture, rung.difference};
            r["repeats"] = rung.repeats;
            r["seconds"] = numbers(rung.seconds);
            l["rungs"].push_back(std::move(r));
        }
        l["control_ratio"] = interval(ladder.control_ratio);
        l["control_seconds"] = numbers(ladder.control);
        l["wall_seconds"] = number(ladder.wall);
        l["cpu_seconds"] = number(ladder.cpu);
        l["taken_by_others"] = number(ladder.taken);
        l["narrow"] = ladder.narrow;
        l["measurements"] = ladder.measurements;
        l["taken_again"] = ladder.retries;
        l["notes"] = ladder.notes;
        json["ladders"].push_back(std::move(l));
    }
    return json;
}

prep::Result<cost::CostTable> cost_table_from(std::string_view text) {
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded())
        return Error{ErrorCode::syntax, "is no JSON; give a file that cost --json wrote", ""};
    CheckedDocument read;
    if (read.text(json, "", "command") != "cost") read.complain("/command", "is not 'cost'");
    cost::CostTable table;
    table.version = read.text(json, "", "version");
    table.processor = read.text(json, "", "processor");
    table.threads = int(read.count(json, "", "threads", 4096));
    const Json& ladders = read.list_of(json, "", "ladders", most_ladders);
    for (std::size_t i = 0; i < ladders.size() && !read.error; ++i)
        table.ladders.push_back(ladder_from(read, ladders[i], "/ladders/" + std::to_string(i)));
    if (read.error) return *read.error;
    cost::derive(table);
    return table;
}

}  // namespace meshprep
