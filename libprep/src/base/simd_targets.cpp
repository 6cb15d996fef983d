#include "base/simd_targets.h"

#include <hwy/targets.h>

namespace prep {

SimdLevel detail::best_simd_level() {
    static const SimdLevel best = [] {
        const std::int64_t usable = HWY_TARGETS & hwy::SupportedTargets();
        return usable & HWY_AVX3   ? SimdLevel::avx512
               : usable & HWY_AVX2 ? SimdLevel::avx2
               : usable & HWY_SSE4 ? SimdLevel::sse4
                                   : SimdLevel::scalar;
    }();
    return best;
}

// A machine that runs one level runs those below it.
bool simd_available(SimdLevel level) {
    return level == SimdLevel::automatic || level <= detail::best_simd_level();
}

std::string_view to_string(SimdLevel level) {
    switch (level) {
        case SimdLevel::automatic:
            return "automatic";
        case SimdLevel::scalar:
            return "scalar";
        case SimdLevel::sse4:
            return "sse4";
        case SimdLevel::avx2:
            return "avx2";
        case SimdLevel::avx512:
            return "avx512";
    }
    return "?";
}

}  // namespace prep
