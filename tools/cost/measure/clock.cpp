#include "cost/measure/clock.h"

#include <sched.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
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

#if defined(__linux__)
void SystemClock::run_on_next() {
    cpu_set_t set;
    if (processors_.empty()) {
        if (sched_getaffinity(0, sizeof set, &set) != 0) return;
        for (int p = 0; p < CPU_SETSIZE; ++p)
            if (CPU_ISSET(p, &set)) processors_.push_back(p);
        const auto here = std::find(processors_.begin(), processors_.end(), sched_getcpu());
        next_ = here != processors_.end() ? std::size_t(here - processors_.begin()) : 0;
    }
    CPU_ZERO(&set);
    CPU_SET(processors_[next_++ % processors_.size()], &set);
    sched_setaffinity(0, sizeof set, &set);
}

void SystemClock::run_anywhere() {
    if (processors_.empty()) return;
    cpu_set_t set;
    CPU_ZERO(&set);
    for (const int p : processors_) CPU_SET(p, &set);
    sched_setaffinity(0, sizeof set, &set);
    processors_.clear();
}
#else
void SystemClock::run_on_next() {}
void SystemClock::run_anywhere() {}
#endif

}  // namespace cost
