#include "cost/measure/clock.h"

#include <time.h>
#include <unistd.h>

#include <fstream>
#include <string>

namespace cost {
namespace {

double seconds(clockid_t which) {
    timespec t{};
    if (clock_gettime(which, &t) != 0) return 0;
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// The first line: "cpu user nice system idle iowait irq softirq steal …", in ticks.
double busy_seconds() {
    std::ifstream file("/proc/stat");
    std::string name;
    double user = 0, nice = 0, system = 0, idle = 0, wait = 0, irq = 0, soft = 0, steal = 0;
    if (!(file >> name >> user >> nice >> system >> idle >> wait >> irq >> soft >> steal) ||
        name != "cpu")
        return 0;
    const double ticks = double(sysconf(_SC_CLK_TCK));
    return ticks > 0 ? (user + nice + system + irq + soft + steal) / ticks : 0;
}

}  // namespace

Instant SystemClock::now() {
    return {seconds(CLOCK_MONOTONIC), seconds(CLOCK_PROCESS_CPUTIME_ID), 0};
}

Instant SystemClock::with_machine() {
    Instant instant = now();
    instant.busy = busy_seconds();
    return instant;
}

}  // namespace cost
