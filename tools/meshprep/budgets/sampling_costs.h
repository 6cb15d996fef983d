// What samplings cost beside one sample a pixel, on this machine: measured once, kept, and used to
// predict how long a picture takes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "meshprep/budgets/cost_cache.h"
#include "meshprep/budgets/render_budget.h"
#include "meshprep/budgets/stopwatch.h"

namespace meshprep {

// Times those of one sample: of what is done for each triangle whatever the picture's size, and of
// what is done for each pixel beyond what an empty one takes.
struct SamplingCost {
    SamplingRung rung;
    double triangles = 1, pixels = 1;
    double empty = 0;  // nanoseconds of a pixel that nothing is drawn in
};

struct MeasuredCosts {
    std::vector<SamplingCost> costs;
    bool steady = false;  // each one's two least times are within a tenth of one another
};

// Draws a lit torus of few and of many triangles and an empty picture with each sampling, in three
// rounds, or up to eight until times are steady, and takes each one's least. A second or two.
// Errors: those of drawing.
prep::Result<MeasuredCosts> measured_sampling_costs(int threads);

// Milliseconds of pictures of `calibration_pixels`.
struct CalibrationTimes {
    double few = 0, many = 0;  // triangles
    double empty = 0;
};
inline constexpr double calibration_pixels = 192 * 192;

// A sampling's cost from its times, in units of those of one sample: what many triangles add to few
// is theirs, what few take beyond an empty picture is the pixels'. Neither is below 1 or above
// 1000: clocks that say so were interrupted.
SamplingCost cost_from_times(const SamplingRung& rung, const CalibrationTimes& times,
                             const CalibrationTimes& of_one);

Json to_json(const std::vector<SamplingCost>& costs);
// None where it is not what to_json() writes: every sampling of sampling_rungs(), in their order,
// numbers that cost_from_times() can come to.
std::optional<std::vector<SamplingCost>> sampling_costs_from(const Json& json);

struct FoundCosts {
    std::vector<SamplingCost> costs;
    bool cached = false;
    std::string not_kept;  // why, where they were measured and should have been kept
};

// Of this build on this machine; 0 threads: all processors.
CostKey sampling_key(int threads);

// From the user's cache; else measured and, unless `keep` is false, kept there if they are steady.
// Errors: those of drawing.
prep::Result<FoundCosts> sampling_costs(int threads, bool keep);

}  // namespace meshprep
