// Steps of the loops that could grow with the square of a mesh, counted so that tests can hold
// their growth against a bound without a clock. Loops count for themselves and add up once, at
// their end: the sum costs nothing. It is read by tests alone and decides nothing, which is why it
// may be global.
#pragma once

#include <atomic>
#include <cstdint>

namespace prep::detail {

inline std::atomic<std::uint64_t> steps_taken{0};

inline void count_steps(std::uint64_t steps) {
    steps_taken.fetch_add(steps, std::memory_order_relaxed);
}

}  // namespace prep::detail
