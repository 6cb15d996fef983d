// What the process has asked the system for so far, as getrusage() tells it: of all threads.
#pragma once

#include <sys/resource.h>

#include <cstdint>

namespace prep::detail {

struct ProcessMemory {
    std::uint64_t page_faults = 0;  // pages touched first, without the disk
    std::uint64_t peak_bytes = 0;   // resident at most; Linux begins with the starter's figure
};

inline ProcessMemory process_memory() {
    rusage used{};
    if (getrusage(RUSAGE_SELF, &used) != 0) return {};
    return {std::uint64_t(used.ru_minflt), std::uint64_t(used.ru_maxrss) * 1024};
}

}  // namespace prep::detail
