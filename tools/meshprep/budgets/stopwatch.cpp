#include "meshprep/budgets/stopwatch.h"

#include <algorithm>
#include <thread>

namespace meshprep {

Stopwatch::Stopwatch(int threads)
    : alone_(threads == 1 || std::thread::hardware_concurrency() == 1), start_(clock_.now()) {}

double Stopwatch::milliseconds() {
    const cost::Instant now = clock_.now();
    return 1e3 * (alone_ ? now.cpu - start_.cpu : now.wall - start_.wall);
}

void LeastTimes::add(double time) {
    second = std::min(second, std::max(first, time));
    first = std::min(first, time);
}

bool LeastTimes::steady() const {
    constexpr double steady_within = 1.1;
    return second <= first * steady_within;
}

}  // namespace meshprep
