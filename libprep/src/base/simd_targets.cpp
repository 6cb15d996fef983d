#include "base/simd_targets.h"

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace prep {
namespace {

// What Highway compiles its forms for (HWY_TARGET_STR), as far as processor and system have it.
// Its own answer, hwy::SupportedTargets(), is in a library that calibrates a timer for 3 ms when it
// is loaded, which is a third of what a command takes to start.
std::int64_t usable_targets() {
    std::int64_t usable = 0;
#if defined(__x86_64__)
    if (__builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("pclmul") &&
        __builtin_cpu_supports("aes"))
        usable |= HWY_SSE4;
    unsigned a = 0, b = 0, c = 0, d = 0;
    const bool has_f16c = __get_cpuid(1, &a, &b, &c, &d) && (c & bit_F16C);  // clang knows no name
    if (usable && has_f16c && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
        __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma"))
        usable |= HWY_AVX2;
    if ((usable & HWY_AVX2) && __builtin_cpu_supports("avx512f") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw"))
        usable |= HWY_AVX3;
#endif
    return HWY_TARGETS & usable;
}

}  // namespace

SimdLevel detail::best_simd_level() {
    static const SimdLevel best = [] {
        const std::int64_t usable = usable_targets();
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
