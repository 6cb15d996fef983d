// Times of several settings of one stage, fit to be compared: in rounds, each of which runs every
// setting once in an order of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cost/measure/clock.h"

namespace cost {

struct TimingOptions {
    int rounds = 0;            // as many; 0: as many as it takes, see below
    int least_rounds = 8;      // of the rule, and of the time cap: fewer decide nothing
    int most_rounds = 25;      // its cap
    double seconds = 12;       // its other cap, once these are done
    double narrow = 0.05;      // the rule: until every ratio's interval is this wide at most
    double least_time = 1e-3;  // shorter runs are repeated until they take so long together
    std::uint64_t seed = 1;    // of the orders
    // With one thread: it stays on one processor, and goes to the next one after a round of which
    // a measurement was taken again. Those of a virtual machine differ by more than settings do.
    bool one_processor = false;
    // With one thread: a measurement of whose time the process computed less than this share was
    // interrupted by other work, and is taken again, `most_retries` times at most; the least
    // interrupted one counts. 0: none is.
    double least_share = 0;
    int most_retries = 4;
    double longest_retried = 0.1;  // seconds; longer ones are interrupted every time
};

struct Times {
    std::vector<std::vector<double>> seconds;  // by setting, then by round; of one run
    std::vector<int> repeats;                  // by setting: runs in a measurement
    double wall = 0, cpu = 0;                  // of all measured runs together
    int measurements = 0;                      // that count
    int retries = 0;                           // of these, those that were taken again
    double others = 0;    // processors that other work had meanwhile, on average; 0: not known
    bool narrow = false;  // whether the rule was met before a cap
};

// Runs every setting once without counting it (caches, first touches), then in rounds. Ratios are
// to setting `reference`. The rule: at least `least_rounds`, then until the interval of each ratio
// is narrower than `narrow` of the ratio, or `most_rounds` or `seconds` are reached.
Times measure(const std::vector<std::function<void()>>& runs, std::size_t reference,
              const TimingOptions& options, Clock& clock);

}  // namespace cost
