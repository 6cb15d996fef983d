// What each part of drawing takes, where that is asked for: a clock for each thread, read between
// one part and the next.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include "kernels/kernels.h"
#include "rast/render.h"

namespace rast::detail {

using PartTimes = std::array<double, drawing_parts>;  // milliseconds

class PartClock : public StageWatch {
  public:
    PartClock() { after = after_stage; }

    // What was before belongs to no part.
    void start() { last_ = Clock::now(); }
    // All since then, or since the last lap.
    void lap(DrawingPart part) {
        const Clock::time_point now = Clock::now();
        Sum& sum = sums_[std::size_t(part)];
        sum.ns += std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_).count();
        ++sum.laps;
        last_ = now;
    }
    // Adds the sums to `times`, without what reading the clock takes, and begins anew.
    void tell(double ns_a_reading, PartTimes& times);

    // Nanoseconds between two readings with nothing between them, the least of many.
    static double reading();

  private:
    using Clock = std::chrono::steady_clock;
    struct Sum {
        std::int64_t ns = 0, laps = 0;
    };
    static void after_stage(StageWatch& self, const StageList& list, std::size_t stage, float*,
                            std::size_t);

    Clock::time_point last_;
    std::array<Sum, drawing_parts> sums_{};
};

// All of a block is one part's. Null: nothing is measured.
class PartTimer {
  public:
    PartTimer(PartClock* clock, DrawingPart part) : clock_(clock), part_(part) {
        if (clock_ != nullptr) clock_->start();
    }
    ~PartTimer() {
        if (clock_ != nullptr) clock_->lap(part_);
    }
    PartTimer(const PartTimer&) = delete;
    PartTimer& operator=(const PartTimer&) = delete;

  private:
    PartClock* clock_;
    DrawingPart part_;
};

// Those of bands, or of a finer picture. Textures are shared by them.
void add_times(PartTimes& to, const PartTimes& from);

}  // namespace rast::detail
