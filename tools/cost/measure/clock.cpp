#include "cost/measure/clock.h"

#include <time.h>

namespace cost {
namespace {

double seconds(clockid_t which) {
    timespec t{};
    if (clock_gettime(which, &t) != 0) return 0;
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

}  // namespace

Instant SystemClock::now() {
    return {seconds(CLOCK_MONOTONIC), seconds(CLOCK_PROCESS_CPUTIME_ID)};
}

}  // namespace cost
