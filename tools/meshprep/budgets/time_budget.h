// The most accurate anti-aliasing that fits a time: `render --budget-ms`.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "meshprep/budgets/sampling_costs.h"
#include "meshprep/budgets/time_certificate.h"

namespace meshprep {

using PlanFor =
    std::function<prep::Result<rast::RenderPlan>(const rast::RenderRequest&, std::size_t view)>;

// Milliseconds of all pictures with one sampling: whole ones, and of half and a quarter of the
// width and the height, which are these parts of the pixels.
struct SizeTimes {
    double whole = 0, half = 0, quarter = 0;
    double half_part = 1.0 / 4, quarter_part = 1.0 / 16;
};

// Of all pictures with one sample: what does not depend on their size, and what does.
struct PilotTimes {
    double fixed = 0, pixels = 0;  // milliseconds
    double first = 0;  // what the first picture takes besides: memory is touched for the first
                       // time, textures are read and made ready
    double count = 0;  // of all pictures' pixels
    bool noisy = false;
    std::uint64_t band_pixels = 0;  // held at a time, at most
    SizeTimes one = {};
};

// What all `views` take, of which `drawn` were drawn.
inline double of_all_views(double milliseconds, std::size_t views, std::size_t drawn) {
    return milliseconds * double(views) / double(drawn);
}

// What one picture or several took.
struct PilotDrawing {
    double pixels = 0, milliseconds = 0;
};

// For `pixels` in all: t = fixed + pixels · c, through both. Where the larger is not the slower
// one, the pilot is noisy, and all that it takes is its pixels': a guess that is too slow rather
// than too fast.
PilotTimes pilot_from_times(const PilotDrawing& smaller, const PilotDrawing& larger, double pixels);

// A first guess. `of_one`: the cost of one sample.
double predicted_ms(const PilotTimes& pilot, const SamplingCost& cost, const SamplingCost& of_one);

// What whole pictures take beyond the first one's `first`, from smaller ones drawn with `rung`: no
// less than the smaller ones, nor than one sample. More samples cost where edges are, whose length
// goes with the width. Of more shaded points, what is not fixed goes with the pixels, but for
// triangles smaller than pixels: of how much less one sample took than such a line says, half (in
// logarithms) is taken for theirs. On 55 meshes of 1,000 to 4 million triangles, ten samplings,
// nine tenths came within 1.16 times, the furthest to 1.39; bench/measure_budgets measures what
// becomes of it.
double whole_ms(const SamplingRung& rung, const SizeTimes& smaller, const SizeTimes& of_one);

struct SamplingTimes : TimeCertificate {
    SamplingRung rung;  // that was chosen
    PilotTimes pilot;
    bool cached = false;  // costs were known
};

// Coarsest first, by the errors of edges in docs/accuracy.md (supersampling by 3 and by 6 stands
// between those measured): fixed.
std::vector<SamplingRung> samplings_by_accuracy();

// Draws smaller pictures with a sampling: `half` and `quarter`.
using DrawSmaller = std::function<prep::Result<SizeTimes>(const SamplingRung&)>;

// The most accurate sampling whose predicted time is at most `asked`, of those that a picture of
// `extent` pixels a side can have; else the one of least time, and `met` is false. What is guessed
// to be that one is drawn smaller, and what that says holds for it, and in proportion for guesses
// of its kind (samples, shaded points), until one that was drawn is chosen. Errors: of `draw`.
prep::Result<SamplingTimes> chosen_within(double asked, const PilotTimes& pilot,
                                          const std::vector<SamplingCost>& costs,
                                          std::uint32_t extent, const DrawSmaller& draw);

// Draws up to four of the views with one sample, whole and smaller, in bands, each the first time
// without counting it, then once to twelve times. Errors: those of planning and drawing.
prep::Result<PilotTimes> pilot_of(rast::SceneRenderer& renderer, const rast::RenderRequest& request,
                                  std::size_t views, const PlanFor& plan_for);

// Of these together, with costs from the user's cache unless `keep` is false; what cannot be kept
// is a warning. Errors: those of planning and drawing.
prep::Result<SamplingTimes> sampling_within(rast::SceneRenderer& renderer,
                                            const rast::RenderRequest& request, std::size_t views,
                                            const PlanFor& plan_for, double asked, bool keep,
                                            const CommonOptions& common, Console& console);

inline constexpr TimedWork drawing_work = {
    "draw", "drawing",
    "milliseconds to draw all pictures; the most accurate by the error of edges"};

Json to_json(const SamplingTimes& times, const std::string& command);

}  // namespace meshprep
