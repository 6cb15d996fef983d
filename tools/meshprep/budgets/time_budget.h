// The most accurate anti-aliasing that fits a time: `render --budget-ms`.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "meshprep/budgets/sampling_costs.h"
#include "meshprep/budgets/time_certificate.h"

namespace meshprep {

// Time of all pictures with one sample: what does not depend on their size, and what does.
struct PilotTimes {
    double fixed = 0, pixels = 0;  // milliseconds
    double first = 0;  // what the first picture takes besides: textures are read and made ready
    double count = 0;  // of all pictures' pixels
    bool noisy = false;
    std::uint64_t band_pixels = 0;  // held at a time, at most
};

// What one small picture or several took.
struct PilotDrawing {
    double pixels = 0, milliseconds = 0;
};

// For `pixels` in all: t = fixed + pixels · c, through both. Where the larger is not the slower
// one, the pilot is noisy, and all that it takes is its pixels': a guess that is too slow rather
// than too fast.
PilotTimes pilot_from_times(const PilotDrawing& smaller, const PilotDrawing& larger, double pixels);

// `one`: of one sample.
double predicted_ms(const PilotTimes& pilot, const SamplingCost& cost, const SamplingCost& one);

struct SamplingTimes : TimeCertificate {
    SamplingRung rung;  // that was chosen
    PilotTimes pilot;
    bool cached = false;  // costs were known
};

// Coarsest first, by the errors of edges in docs/accuracy.md (supersampling by 3 and by 6 stands
// between those measured): fixed.
std::vector<SamplingRung> samplings_by_accuracy();

// The most accurate sampling whose predicted time is at most `asked`, of those that a picture of
// `extent` pixels a side can have; else the one of least time, and `met` is false.
SamplingTimes chosen_within(double asked, const PilotTimes& pilot,
                            const std::vector<SamplingCost>& costs, std::uint32_t extent);

// Draws up to four of the views with one sample and a quarter and half of their size, in bands, the
// first time without counting it, then three to twelve times. Errors: those of planning and
// drawing.
prep::Result<PilotTimes> pilot_of(
    rast::SceneRenderer& renderer, const rast::RenderRequest& request, std::size_t views,
    const std::function<prep::Result<rast::RenderPlan>(const rast::RenderRequest&, std::size_t)>&
        plan_for);

// Of these together, with costs from the user's cache unless `keep` is false; what cannot be kept
// is a warning. Errors: those of planning and drawing.
prep::Result<SamplingTimes> sampling_within(
    rast::SceneRenderer& renderer, const rast::RenderRequest& request, std::size_t views,
    const std::function<prep::Result<rast::RenderPlan>(const rast::RenderRequest&, std::size_t)>&
        plan_for,
    double asked, bool keep, const CommonOptions& common, Console& console);

inline constexpr TimedWork drawing_work = {
    "draw", "drawing",
    "milliseconds to draw all pictures; the most accurate by the error of edges"};

Json to_json(const SamplingTimes& times, const std::string& command);

}  // namespace meshprep
