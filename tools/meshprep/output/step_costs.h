// What each step of a plan costs: before, estimated from the plan alone; after, counted, and both
// by the prices of a table that comes with the version (bench/step_prices makes it): the same each
// time. And measured, which no two pictures have alike.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "prep/prepared_scene.h"
#include "rast/render.h"

namespace meshprep {

struct StepCost {
    std::uint64_t count = 0;
    const char* of = "";      // what was counted
    std::uint64_t bytes = 0;  // of the buffer or the lists that the step keeps
    // Processor time, by the table; none: the step has no price.
    std::optional<double> milliseconds = {};
};

// None: nothing of the step is counted. What is left out counts 0.
std::optional<StepCost> cost_of(const rast::PlanStep& step, const rast::RenderPlan& plan,
                                const rast::Counters& counters);

// Of a step that runs, before anything is drawn. `points`: expected_points(). Triangles are taken
// to cover as much as each other.
std::optional<StepCost> estimate_of(const rast::PlanStep& step, const rast::RenderPlan& plan,
                                    std::uint64_t points);
// What clocks told of a step that runs (RenderRequest::timed): milliseconds of all threads.
struct MeasuredStep {
    double milliseconds = 0;
    std::vector<rast::DrawingPart> parts;  // of drawing, whose sum it is
    std::vector<std::string> with;         // other steps that run and are in those parts as well
};
// None: the step is left out, or takes no time while drawing.
std::optional<MeasuredStep> time_of(const rast::PlanStep& step, const rast::RenderPlan& plan,
                                    const rast::Frame& drawn);
// Pixels in the rectangle about the box of everything that is drawn, once each: more than are
// covered where the box is not filled. O(vertices).
std::uint64_t expected_points(const prep::PreparedScene& scene, const rast::RenderPlan& plan);

// "12,345 points, about 0.3 ms; expected 12,000; took 0.2 ms". Empty: there is nothing to tell.
std::string text_of(const std::optional<StepCost>& cost, const std::optional<StepCost>& estimate,
                    const std::optional<MeasuredStep>& measured);

}  // namespace meshprep
