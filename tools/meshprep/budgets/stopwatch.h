// How long something took, as every `--budget-ms` counts it.
#pragma once

#include <limits>

#include "cost/measure/clock.h"

namespace meshprep {

// On threads as many: with one, the time that the process computed, which other work on the machine
// does not lengthen; with more, the time that went by. 0: all processors.
class Stopwatch {
  public:
    explicit Stopwatch(int threads);
    double milliseconds();

  private:
    cost::SystemClock clock_;
    bool alone_;
    cost::Instant start_;
};

// The two least of several times.
struct LeastTimes {
    double first = std::numeric_limits<double>::infinity();
    double second = std::numeric_limits<double>::infinity();

    void add(double time);
    bool steady() const;  // they are within a tenth of one another
};

}  // namespace meshprep
