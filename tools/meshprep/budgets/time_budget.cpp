#include "meshprep/budgets/time_budget.h"

#include <algorithm>
#include <limits>

namespace meshprep {
namespace {

using prep::Result;

constexpr std::size_t most_pilot_views = 4;
constexpr int least_pilot_runs = 3, most_pilot_runs = 12;
constexpr double enough_pilot_ms = 60;

double pixels_of(const rast::RenderRequest& r) {
    return r.crop ? double(r.crop->width) * r.crop->height : double(r.width) * r.height;
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

PilotTimes pilot_from_times(const PilotDrawing& smaller, const PilotDrawing& larger,
                            double pixels) {
    PilotTimes out;
    out.count = pixels;
    const double all = larger.milliseconds * pixels / larger.pixels;  // were nothing fixed
    const double more = larger.pixels - smaller.pixels;
    out.noisy = larger.milliseconds <= smaller.milliseconds;
    if (out.noisy || !(more > 0)) {
        out.pixels = all;
        return out;
    }
    out.pixels = std::min((larger.milliseconds - smaller.milliseconds) / more * pixels, all);
    out.fixed = larger.milliseconds - out.pixels * (larger.pixels / pixels);
    out.fixed = std::max(out.fixed, 0.0);
    return out;
}

double predicted_ms(const PilotTimes& pilot, const SamplingCost& cost, const SamplingCost& one) {
    const auto empty = [&](const SamplingCost& c) { return pilot.count * c.empty * 1e-6; };
    const double drawn = std::max(pilot.pixels - empty(one), 0.0);
    return pilot.first + pilot.fixed * cost.triangles + drawn * cost.pixels + empty(cost);
}

std::vector<SamplingRung> samplings_by_accuracy() {
    return {{1, 1}, {2, 1}, {4, 1}, {1, 2}, {8, 1}, {1, 3}, {16, 1}, {1, 4}, {1, 6}, {1, 8}};
}

SamplingTimes chosen_within(double asked, const PilotTimes& pilot,
                            const std::vector<SamplingCost>& costs, std::uint32_t extent) {
    std::vector<SamplingRung> rungs;
    std::vector<TimePrediction> tried;
    SamplingCost one;
    for (const SamplingCost& cost : costs)
        if (cost.rung.samples == 1 && cost.rung.supersample == 1) one = cost;
    for (const SamplingRung& rung : samplings_by_accuracy())
        for (const SamplingCost& cost : costs)
            if (cost.rung.samples == rung.samples && cost.rung.supersample == rung.supersample &&
                std::uint64_t(rung.supersample) * extent <= rast::max_picture_extent) {
                rungs.push_back(rung);
                tried.push_back({rung.words(), predicted_ms(pilot, cost, one)});
            }
    SamplingTimes out;
    static_cast<TimeCertificate&>(out) = chosen_in_time(asked, std::move(tried));
    out.rung = rungs[out.index];
    out.pilot = pilot;
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
    std::uint64_t band_pixels = 0;
    const rast::BandSink nowhere = [&](const rast::Frame& band, std::uint32_t) -> Result<void> {
        band_pixels = std::max<std::uint64_t>(band_pixels, band.color.size());
        return {};
    };
    const rast::RenderRequest requests[2] = {smaller(one, 4), smaller(one, 2)};
    double least[2] = {std::numeric_limits<double>::infinity(),
                       std::numeric_limits<double>::infinity()};
    double first = 0, spent = 0;
    for (int run = 0; run <= most_pilot_runs; ++run) {
        if (run > least_pilot_runs && spent > enough_pilot_ms) break;
        for (int k = 0; k < 2; ++k) {
            Stopwatch watch(request.threads);
            for (std::size_t v = 0; v < drawn; ++v) {
                const Result<rast::RenderPlan> plan = plan_for(requests[k], v * views / drawn);
                if (!plan) return plan.error();
                if (const auto done = renderer.render_bands(*plan, nowhere); !done)
                    return done.error();
            }
            const double taken = watch.milliseconds();
            spent += taken;
            // The first run reads textures and makes their levels.
            if (run > 0) least[k] = std::min(least[k], taken);
            if (run == 0 && k == 0) first = taken;
        }
    }
    const double each[2] = {pixels_of(requests[0]), pixels_of(requests[1])};
    PilotTimes out =
        pilot_from_times({each[0] * double(drawn), least[0]}, {each[1] * double(drawn), least[1]},
                         pixels_of(one) * double(views));
    out.fixed *= double(views) / double(drawn);
    out.first = std::max(first - least[0], 0.0);
    out.band_pixels = band_pixels;
    return out;
}

Result<SamplingTimes> sampling_within(
    rast::SceneRenderer& renderer, const rast::RenderRequest& request, std::size_t views,
    const std::function<Result<rast::RenderPlan>(const rast::RenderRequest&, std::size_t)>&
        plan_for,
    double asked, bool keep, const CommonOptions& common, Console& console) {
    const Result<FoundCosts> found = sampling_costs(request.threads, keep);
    if (!found) return found.error();
    if (!found->not_kept.empty())
        console.warning(common, "measured costs are not kept: " + found->not_kept);
    const Clock::time_point start = Clock::now();
    const Result<PilotTimes> pilot = pilot_of(renderer, request, views, plan_for);
    if (!pilot) return pilot.error();
    SamplingTimes out =
        chosen_within(asked, *pilot, found->costs, std::max(request.width, request.height));
    out.pilot_ms = milliseconds_since(start);
    out.cached = found->cached;
    return out;
}

Json to_json(const SamplingTimes& times, const std::string& command) {
    Json json = to_json(times, drawing_work, command);
    json["pilot"] = {{"fixed", times.pilot.fixed},
                     {"pixels", times.pilot.pixels},
                     {"first", times.pilot.first},
                     {"noisy", times.pilot.noisy},
                     {"milliseconds", times.pilot_ms}};
    json["costs"] = times.cached ? "cached" : "measured";
    return json;
}

}  // namespace meshprep
