#pragma once

#include <vector>

#include "prep/simd.h"
#include "sanitized.h"

namespace test {

// The instruction sets whose results are held against each other: those that this machine has, the
// scalar code first. Races are the same in all of them: the thread sanitizer looks at the widest
// alone.
inline std::vector<prep::SimdLevel> every_level() {
    if (thread_sanitized) return {prep::SimdLevel::automatic};
    std::vector<prep::SimdLevel> levels;
    for (const auto level : {prep::SimdLevel::scalar, prep::SimdLevel::sse4, prep::SimdLevel::avx2,
                             prep::SimdLevel::avx512})
        if (prep::simd_available(level)) levels.push_back(level);
    return levels;
}

}  // namespace test
