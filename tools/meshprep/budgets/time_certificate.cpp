#include "meshprep/budgets/time_certificate.h"

#include <fmt/format.h>

#include <limits>

namespace meshprep {
namespace {

Json prediction_json(const TimePrediction& p) {
    return {{"setting", p.setting}, {"milliseconds", p.milliseconds}, {"measured", p.measured}};
}

}  // namespace

TimeCertificate chosen_in_time(double asked, std::vector<TimePrediction> tried) {
    TimeCertificate out;
    out.asked = asked;
    out.tried = std::move(tried);
    double least = std::numeric_limits<double>::infinity();
    const auto choose = [&out](const TimePrediction& p) {
        out.chosen = p;
        out.index = std::size_t(&p - out.tried.data());
    };
    for (const TimePrediction& p : out.tried) {
        if (p.milliseconds <= asked) {
            out.met = true;
            choose(p);
            out.next.reset();
            continue;
        }
        if (!out.met && p.milliseconds < least) {
            least = p.milliseconds;
            choose(p);
        }
        if (out.met && !out.next) out.next = p;
    }
    return out;
}

Json to_json(const TimeCertificate& c, const TimedWork& work, const std::string& command) {
    Json json;
    json["asked"] = c.asked;
    json["unit"] = work.unit;
    json["met"] = c.met;
    json["taken"] = c.taken;
    json["overrun"] = c.overrun();
    json["chosen"] = prediction_json(c.chosen);
    json["next"] = c.next ? prediction_json(*c.next) : Json(nullptr);
    json["tried"] = Json::array();
    for (const TimePrediction& p : c.tried) json["tried"].push_back(prediction_json(p));
    json["pilot"] = {{"milliseconds", c.pilot_ms}};
    json["command"] = command;
    return json;
}

void say_time(const CommonOptions& common, const TimeCertificate& c, const TimedWork& work,
              const std::string& command, Console& console) {
    console.result(common, fmt::format("  {:.4g} ms asked, {:.4g} predicted with {}, {:.4g} taken",
                                       c.asked, c.chosen.milliseconds, c.chosen.setting, c.taken));
    if (c.next)
        console.result(common, fmt::format("  next: {} in {:.4g} ms, predicted", c.next->setting,
                                           c.next->milliseconds));
    console.result(common, "  the same again: " + command);
    if (!c.met)
        console.error(
            fmt::format("nothing is predicted to {} within {:.4g} ms; the fastest takes "
                        "{:.4g}",
                        work.verb, c.asked, c.chosen.milliseconds));
    else if (c.overrun())
        console.warning(common, fmt::format("{} took {:.4g} ms, {:.3g} times what was asked",
                                            work.noun, c.taken, c.taken / c.asked));
}

}  // namespace meshprep
