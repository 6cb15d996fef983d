#include "meshprep/budgets/time_budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshprep {
namespace {

using prep::Result;

constexpr std::size_t most_pilot_views = 4;
// Of short pictures the least of many runs is taken, of which it takes some tens of milliseconds to
// come by; of long ones a second run says no more than the first.
constexpr int least_pilot_runs = 2, most_pilot_runs = 12;
constexpr double enough_pilot_ms = 20, long_pilot_ms = 500;

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

// Pictures of the views, or of four of them, drawn for their times.
class PilotPictures {
  public:
    PilotPictures(rast::SceneRenderer& renderer, const rast::RenderRequest& request,
                  std::size_t views, const PlanFor& plan_for)
        : renderer_(renderer),
          request_(request),
          views_(views),
          drawn_(std::min(views, most_pilot_views)),
          plan_for_(plan_for) {
        request_.coverage = prep::Coverage::samples;
    }

    struct Runs {
        double first = 0, least = std::numeric_limits<double>::infinity();  // of those drawn
    };

    // A `k`-th as wide and high. The first run touches memory, and does not count.
    Result<Runs> runs(const SamplingRung& rung, std::uint32_t k) {
        rast::RenderRequest request = smaller(request_, k);
        request.samples = rung.samples;
        request.supersample = rung.supersample;
        Runs out;
        double spent = 0;
        for (int run = 0; run <= most_pilot_runs; ++run) {
            if (run > 1 && spent > long_pilot_ms) break;
            if (run > least_pilot_runs && spent > enough_pilot_ms) break;
            const Result<double> taken = one_run(request);
            if (!taken) return taken.error();
            spent += *taken;
            if (run == 0)
                out.first = *taken;
            else
                out.least = std::min(out.least, *taken);
        }
        return out;
    }

    std::size_t views() const { return views_; }
    // Of all views, at a half and a quarter of the size.
    Result<SizeTimes> smaller_ones(const SamplingRung& rung) {
        const Result<Runs> half = runs(rung, 2);
        if (!half) return half.error();
        const Result<Runs> quarter = runs(rung, 4);
        if (!quarter) return quarter.error();
        return SizeTimes{0, of_all(half->least), of_all(quarter->least), pixels(2) / pixels(1),
                         pixels(4) / pixels(1)};
    }

    double of_all(double of_drawn) const { return of_all_views(of_drawn, views_, drawn_); }
    double pixels(std::uint32_t k) const { return pixels_of(smaller(request_, k)); }
    std::uint64_t band_pixels() const { return band_pixels_; }

  private:
    Result<double> one_run(const rast::RenderRequest& request) {
        const rast::BandSink nowhere = [&](const rast::Frame& band, std::uint32_t) -> Result<void> {
            band_pixels_ = std::max<std::uint64_t>(band_pixels_, band.color.size());
            return {};
        };
        double taken = 0;  // by drawing: planning is not part of what is told of the pictures
        for (std::size_t v = 0; v < drawn_; ++v) {
            const Result<rast::RenderPlan> plan = plan_for_(request, v * views_ / drawn_);
            if (!plan) return plan.error();
            Stopwatch watch(request.threads);
            if (const auto done = renderer_.render_bands(*plan, nowhere); !done)
                return done.error();
            taken += watch.milliseconds();
        }
        return taken;
    }

    rast::SceneRenderer& renderer_;
    rast::RenderRequest request_;
    std::size_t views_, drawn_;
    const PlanFor& plan_for_;
    std::uint64_t band_pixels_ = 0;
};

constexpr SamplingRung one_sample{1, 1};
bool is_one_sample(const SamplingRung& rung) {
    return rung.samples == 1 && rung.supersample == 1;
}

Result<PilotTimes> pilot_with(PilotPictures& pictures) {
    const Result<PilotPictures::Runs> whole = pictures.runs(one_sample, 1);
    if (!whole) return whole.error();
    Result<SizeTimes> one = pictures.smaller_ones(one_sample);
    if (!one) return one.error();
    one->whole = pictures.of_all(whole->least);
    const double pixels = pictures.pixels(1) * double(pictures.views());
    PilotTimes out =
        pilot_from_times({pixels * one->half_part, one->half}, {pixels, one->whole}, pixels);
    out.one = *one;
    out.first = std::max(whole->first - whole->least, 0.0);
    out.band_pixels = pictures.band_pixels();
    return out;
}

// As if what is not fixed went with the pixels.
double whole_on_a_line(const SizeTimes& t) {
    const PilotTimes line = pilot_from_times({t.quarter_part, t.quarter}, {t.half_part, t.half}, 1);
    return line.fixed + line.pixels;
}

bool same_kind(const SamplingRung& a, const SamplingRung& b) {
    return (a.samples > 1) == (b.samples > 1);
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

double predicted_ms(const PilotTimes& pilot, const SamplingCost& cost, const SamplingCost& of_one) {
    const auto empty = [&](const SamplingCost& c) { return pilot.count * c.empty * 1e-6; };
    const double drawn = std::max(pilot.pixels - empty(of_one), 0.0);
    return pilot.first + pilot.fixed * cost.triangles + drawn * cost.pixels + empty(cost);
}

double whole_ms(const SamplingRung& rung, const SizeTimes& smaller, const SizeTimes& of_one) {
    const double least = std::max({smaller.half, smaller.quarter, of_one.whole});
    if (rung.samples == 1) {
        double bent = 1;  // one sample's time over what a line says: where that is not noise
        if (of_one.half > of_one.quarter)
            bent = std::min(of_one.whole / whole_on_a_line(of_one), 1.0);
        return std::max(whole_on_a_line(smaller) * std::sqrt(bent), least);
    }
    const double half = std::max(smaller.half - of_one.half, 0.0);
    const double quarter = std::max(smaller.quarter - of_one.quarter, 0.0);
    const double to_half = std::sqrt(smaller.half_part),
                 to_quarter = std::sqrt(smaller.quarter_part);
    const double growth = to_half > to_quarter ? (1 - to_half) / (to_half - to_quarter) : 0;
    return std::max(of_one.whole + half + std::max(growth * (half - quarter), 0.0), least);
}

std::vector<SamplingRung> samplings_by_accuracy() {
    return {{1, 1}, {2, 1}, {4, 1}, {1, 2}, {8, 1}, {1, 3}, {16, 1}, {1, 4}, {1, 6}, {1, 8}};
}

Result<SamplingTimes> chosen_within(double asked, const PilotTimes& pilot,
                                    const std::vector<SamplingCost>& costs, std::uint32_t extent,
                                    const DrawSmaller& draw) {
    std::vector<SamplingRung> rungs;
    std::vector<TimePrediction> tried;
    SamplingCost of_one;
    for (const SamplingCost& cost : costs)
        if (is_one_sample(cost.rung)) of_one = cost;
    for (const SamplingRung& rung : samplings_by_accuracy())
        for (const SamplingCost& cost : costs)
            if (cost.rung.samples == rung.samples && cost.rung.supersample == rung.supersample &&
                std::uint64_t(rung.supersample) * extent <= rast::max_picture_extent) {
                rungs.push_back(rung);
                tried.push_back({rung.words(),
                                 is_one_sample(rung) ? pilot.first + pilot.fixed + pilot.pixels
                                                     : predicted_ms(pilot, cost, of_one),
                                 is_one_sample(rung)});
            }
    SamplingTimes out;
    while (true) {
        static_cast<TimeCertificate&>(out) = chosen_in_time(asked, tried);
        if (out.chosen.measured) break;
        const SamplingRung chosen = rungs[out.index];
        const Result<SizeTimes> smaller = draw(chosen);
        if (!smaller) return smaller.error();
        const double before = tried[out.index].milliseconds - pilot.first;
        const double now = whole_ms(chosen, *smaller, pilot.one);
        tried[out.index].measured = true;
        for (std::size_t k = 0; k < rungs.size(); ++k) {
            double& guess = tried[k].milliseconds;
            if (k == out.index)
                guess = pilot.first + now;
            else if (!tried[k].measured && same_kind(rungs[k], chosen) && before > 0)
                guess = pilot.first + (guess - pilot.first) * (now / before);
        }
    }
    out.rung = rungs[out.index];
    out.pilot = pilot;
    return out;
}

Result<PilotTimes> pilot_of(rast::SceneRenderer& renderer, const rast::RenderRequest& request,
                            std::size_t views, const PlanFor& plan_for) {
    PilotPictures pictures(renderer, request, views, plan_for);
    return pilot_with(pictures);
}

Result<SamplingTimes> sampling_within(rast::SceneRenderer& renderer,
                                      const rast::RenderRequest& request, std::size_t views,
                                      const PlanFor& plan_for, double asked, bool keep,
                                      const CommonOptions& common, Console& console) {
    // Before costs are measured, which warms up what the printed command finds cold.
    const Clock::time_point start = Clock::now();
    PilotPictures pictures(renderer, request, views, plan_for);
    const Result<PilotTimes> pilot = pilot_with(pictures);
    if (!pilot) return pilot.error();
    const double spent = milliseconds_since(start);
    const Result<FoundCosts> found = sampling_costs(request.threads, keep);
    if (!found) return found.error();
    if (!found->not_kept.empty())
        console.warning(common, "measured costs are not kept: " + found->not_kept);
    const Clock::time_point again = Clock::now();
    const DrawSmaller draw = [&](const SamplingRung& rung) { return pictures.smaller_ones(rung); };
    Result<SamplingTimes> out =
        chosen_within(asked, *pilot, found->costs, std::max(request.width, request.height), draw);
    if (!out) return out.error();
    out->pilot_ms = spent + milliseconds_since(again);
    out->cached = found->cached;
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
