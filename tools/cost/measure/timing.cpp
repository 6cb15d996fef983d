#include "cost/measure/timing.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "cost/measure/statistics.h"

namespace cost {
namespace {

constexpr int most_repeats = 1000;

// Fisher and Yates' shuffle: the standard library's differs between libraries.
void shuffle(std::vector<std::size_t>& order, std::mt19937_64& random) {
    for (std::size_t i = order.size(); i > 1; --i)
        std::swap(order[i - 1], order[std::size_t(random() % i)]);
}

bool narrow_enough(const Times& times, std::size_t reference, double narrow) {
    for (std::size_t i = 0; i < times.seconds.size(); ++i) {
        if (i == reference) continue;
        const Estimate ratio = ratio_estimate(times.seconds[i], times.seconds[reference]);
        if (!(ratio.high - ratio.low <= narrow * ratio.value)) return false;
    }
    return true;
}

// Seconds of one run.
double one_measurement(const std::function<void()>& run, int repeats, const TimingOptions& options,
                       Clock& clock, Times& times) {
    double best = 0, best_share = -1;
    ++times.measurements;
    for (int attempt = 0; attempt <= options.most_retries; ++attempt) {
        const Instant start = clock.now();
        for (int k = 0; k < repeats; ++k) run();
        const Instant end = clock.now();
        const double wall = end.wall - start.wall, cpu = end.cpu - start.cpu;
        times.wall += wall;
        times.cpu += cpu;
        times.retries += attempt == 1;
        const double share = wall > 0 ? cpu / wall : 1;
        if (share > best_share) {
            best = wall / repeats;
            best_share = share;
        }
        if (share >= options.least_share || wall > options.longest_retried) break;
    }
    return best;
}

}  // namespace

Times measure(const std::vector<std::function<void()>>& runs, std::size_t reference,
              const TimingOptions& options, Clock& clock) {
    Times times;
    times.seconds.resize(runs.size());
    times.repeats.resize(runs.size(), 1);
    if (options.one_processor) clock.run_on_next();
    const Instant begin = clock.with_machine();
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const double start = clock.now().wall;
        runs[i]();
        const double took = clock.now().wall - start;
        if (took < options.least_time)
            times.repeats[i] = int(std::min(double(most_repeats),
                                            std::ceil(options.least_time / std::max(took, 1e-9))));
    }
    std::mt19937_64 random(options.seed);
    std::vector<std::size_t> order(runs.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    const int most = options.rounds > 0 ? options.rounds : options.most_rounds;
    for (int round = 0; round < most; ++round) {
        const int retries = times.retries;
        shuffle(order, random);
        for (const std::size_t i : order) {
            times.seconds[i].push_back(
                one_measurement(runs[i], times.repeats[i], options, clock, times));
        }
        if (options.one_processor && times.retries > retries) clock.run_on_next();
        if (options.rounds > 0) continue;
        const int done = round + 1;
        if (done >= options.least_rounds && narrow_enough(times, reference, options.narrow)) {
            times.narrow = true;
            break;
        }
        if (done >= options.least_rounds && clock.now().wall - begin.wall > options.seconds) break;
    }
    if (options.one_processor) clock.run_anywhere();
    if (options.rounds > 0) times.narrow = narrow_enough(times, reference, options.narrow);
    const Instant end = clock.with_machine();
    const double wall = end.wall - begin.wall;
    if (begin.busy > 0 && wall > 0)
        times.others = std::max(0.0, end.busy - begin.busy - (end.cpu - begin.cpu)) / wall;
    return times;
}

}  // namespace cost
