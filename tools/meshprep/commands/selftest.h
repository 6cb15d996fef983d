// The hard cases in short form, on the machine at hand: errors of the fast and the accurate normals
// against exact arithmetic, and what must hold without exception.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace meshprep {

struct SelftestCase {
    std::string name;
    double value = 0;
    // Largest angles to the exact normals over all fans and the weights by area and by angle, in
    // degrees, before rounding to float; `rounded` is the accurate normals' after it.
    double fast = 0, accurate = 0, rounded = 0;
    std::uint64_t fans = 0, flagged = 0;  // flagged: the input determines no normal
    bool ok = false;  // bounds hold, every normal is unit, the same fans are flagged
};

struct SelftestCheck {
    std::string name;
    std::string unit;  // what is counted
    std::uint64_t tried = 0, wrong = 0;
};

struct Selftest {
    std::vector<SelftestCase> cases;
    std::vector<SelftestCheck> checks;
    double milliseconds = 0;
    bool ok() const;
};

// Bounds in degrees that the cases are held to.
double selftest_fast_bound();
double selftest_accurate_bound();
double selftest_rounded_bound();

// Takes some seconds. `threads` 0: all cores.
Selftest selftest(int threads);

}  // namespace meshprep
