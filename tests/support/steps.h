// How many steps (libprep/src/step_count.h) a call takes: what would else be a time limit.
#pragma once

#include <cmath>
#include <cstdint>

namespace test {

std::uint64_t steps_taken();

template <class Body>
std::uint64_t steps_of(const Body& body) {
    const std::uint64_t before = steps_taken();
    body();
    return steps_taken() - before;
}

inline double n_log_n(double n) {
    return n * std::log2(n);
}

}  // namespace test
