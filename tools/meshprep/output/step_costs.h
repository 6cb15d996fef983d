// What each step of a plan costs: before, estimated from the plan alone; after, counted. Both are
// the same each time. Times are counts by the prices of a table that comes with the version
// (bench/step_prices makes it): the steps of a point run interleaved, so that no clock tells them
// apart.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "prep/prepared_scene.h"
#include "rast/render.h"

namespace meshprep {

struct StepCost {
    std::uint64_t count = 0;
    const char* of = "";      // what was counted
    std::uint64_t bytes = 0;  // of the buffer that the step keeps
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
// Pixels in the rectangle about the box of everything that is drawn, once each: more than are
// covered where the box is not filled. O(vertices).
std::uint64_t expected_points(const prep::PreparedScene& scene, const rast::RenderPlan& plan);

// "12,345 points, about 0.3 ms; expected 12,000"
std::string text_of(const StepCost& cost, const std::optional<StepCost>& estimate);

}  // namespace meshprep
