#include "meshprep/budgets/time_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
namespace meshprep {
namespace {

using prep::Result;

constexpr std::size_t most_pilot_views = 4;
constexpr int pilot_runs = 2;

Json prediction_json(const SamplingPrediction& p) {
    return {{"setting", p.rung.words()}, {"milliseconds", p.milliseconds}};
}

// A `k`-th of its size, and of the part of it that is asked for.
rast::RenderRequest smaller(rast::RenderRequest request, std::uint32_t k) {
    const auto part = [k](std::uint32_t n) { return std::max<std::uint32_t>(n / k, 1); };
    request.width = part(request.width);
    request.height = part(request.height);
    if (request.crop) {
        rast::Crop& c = *request.crop;
        c = {std::min(c.x / k, request.width - 1), std::min(c.y / k, request.height - 1),
             part(c.width), part(c.height)};
        c.width = std::min(c.width, request.width - c.x);
        c.height = std::min(c.height, request.height - c.y);
    }
    return request;
}

}  // namespace

PilotTimes pilot_from_times(double quarter, double half) {
    // 1/16 and 1/4 of the pixels.
    const double pixels = std::max(half - quarter, 0.0) * 16 / 3;
    return {std::max(quarter - pixels / 16, 0.0), pixels};
}

double predicted_ms(const PilotTimes& pilot, const SamplingCost& cost) {
    return pilot.fixed * cost.triangles + pilot.pixels * cost.pixels;
}

std::vector<SamplingRung> samplings_by_accuracy() {
    return {{1, 1}, {2, 1}, {4, 1}, {1, 2}, {8, 1}, {1, 3}, {16, 1}, {1, 4}, {1, 6}, {1, 8}};
}

TimeCertificate chosen_within(double asked, const PilotTimes& pilot,
                              const std::vector<SamplingCost>& costs, std::uint32_t extent) {
    TimeCertificate out;
    out.asked = asked;
    out.pilot = pilot;
    for (const SamplingRung& rung : samplings_by_accuracy())
        for (const SamplingCost& cost : costs)
            if (cost.rung.samples == rung.samples && cost.rung.supersample == rung.supersample &&
                std::uint64_t(rung.supersample) * extent <= rast::max_picture_extent)
                out.tried.push_back({rung, predicted_ms(pilot, cost)});
    double least = std::numeric_limits<double>::infinity();
    for (const SamplingPrediction& p : out.tried) {
        if (p.milliseconds <= asked) {
            out.met = true;
            out.chosen = p;
            out.next.reset();
            continue;
        }
        if (!out.met && p.milliseconds < least) {
            least = p.milliseconds;
            out.chosen = p;
        }
        if (out.met && !out.next) out.next = p;
    }
    return out;
}

Result<PilotTimes> pilot_of(rast::SceneRenderer& renderer, const rast::RenderRequest& request,
                            std::size_t views,
                            const std::function<Result<rast::RenderPlan>(const rast::RenderRequest&,
                                                                         std::size_t)>& plan_for) {
    rast::RenderRequest one = request;
    one.coverage = prep::Coverage::samples;
    one.samples = one.supersample = 1;
    const std::size_t drawn = std::min(views, most_pilot_views);
    double least[2] = {std::numeric_limits<double>::infinity(),
                       std::numeric_limits<double>::infinity()};
    for (int run = 0; run <= pilot_runs; ++run)
        for (const std::uint32_t k : {4u, 2u}) {
            Stopwatch watch(request.threads);
            for (std::size_t v = 0; v < drawn; ++v) {
                const Result<rast::RenderPlan> plan = plan_for(smaller(one, k), v * views / drawn);
                if (!plan) return plan.error();
                rast::Frame frame;
                if (const Result<void> done = renderer.render(*plan, frame); !done)
                    return done.error();
            }
            double& to = least[k == 4 ? 0 : 1];
            // The first run reads textures and makes their levels.
            if (run > 0) to = std::min(to, watch.milliseconds());
        }
    const double all = double(views) / double(drawn);
    return pilot_from_times(least[0] * all, least[1] * all);
}

Result<TimeCertificate> sampling_within(
    rast::SceneRenderer& renderer, const rast::RenderRequest& request, std::size_t views,
    const std::function<Result<rast::RenderPlan>(const rast::RenderRequest&, std::size_t)>&
        plan_for,
    double asked, bool keep, const CommonOptions& common, Console& console) {
    const Result<FoundCosts> found = sampling_costs(request.threads, keep);
    if (!found) return found.error();
    if (found->not_kept)
        console.warning(common, "measured costs are not kept: " + to_string(*found->not_kept));
    const Clock::time_point start = Clock::now();
    const Result<PilotTimes> pilot = pilot_of(renderer, request, views, plan_for);
    if (!pilot) return pilot.error();
    TimeCertificate out =
        chosen_within(asked, *pilot, found->costs, std::max(request.width, request.height));
    out.pilot_ms = milliseconds_since(start);
    out.cached = found->cached;
    return out;
}

Json to_json(const TimeCertificate& c, const std::string& command) {
    Json json;
    json["asked"] = c.asked;
    json["unit"] = "milliseconds to draw all pictures";
    json["met"] = c.met;
    json["taken"] = c.taken;
    json["overrun"] = c.overrun();
    json["chosen"] = prediction_json(c.chosen);
    json["next"] = c.next ? prediction_json(*c.next) : Json(nullptr);
    json["tried"] = Json::array();
    for (const SamplingPrediction& p : c.tried) json["tried"].push_back(prediction_json(p));
    json["pilot"] = {
        {"fixed", c.pilot.fixed}, {"pixels", c.pilot.pixels}, {"milliseconds", c.pilot_ms}};
    json["costs"] = c.cached ? "cached" : "measured";
    json["command"] = command;
    return json;
}

void say_time(const CommonOptions& common, const TimeCertificate& c, const std::string& command,
              Console& console) {
    console.result(common,
                   fmt::format("  {:.4g} ms asked, {:.4g} predicted with {}, {:.4g} taken", c.asked,
                               c.chosen.milliseconds, c.chosen.rung.words(), c.taken));
    if (c.next)
        console.result(common, fmt::format("  next: {} in {:.4g} ms, predicted",
                                           c.next->rung.words(), c.next->milliseconds));
    console.result(common, "  the same again: " + command);
    if (!c.met)
        console.error(
            fmt::format("nothing is predicted to draw within {:.4g} ms; the fastest takes "
                        "{:.4g}",
                        c.asked, c.chosen.milliseconds));
    else if (c.overrun())
        console.warning(common, fmt::format("drawing took {:.4g} ms, {:.2g} times what was asked",
                                            c.taken, c.taken / c.asked));
}

}  // namespace meshprep
