// Kernels that are compiled once per instruction set (Highway), and the choice among them. To be
// included before Highway.
#pragma once

// The baseline is one lane, in plain C++: what every vector form means. (Without this Highway would
// take vectors of the baseline's own, or emulate some.)
#define HWY_DISABLED_TARGETS HWY_SSSE3
#define HWY_BROKEN_EMU128 1
#include <hwy/detect_targets.h>

#include "prep/simd.h"

#if HWY_TARGETS & HWY_AVX3
#define SIMD_AVX512(kernel) N_AVX3::kernel
#else
#define SIMD_AVX512(kernel) nullptr
#endif
#if HWY_TARGETS & HWY_AVX2
#define SIMD_AVX2(kernel) N_AVX2::kernel
#else
#define SIMD_AVX2(kernel) nullptr
#endif
#if HWY_TARGETS & HWY_SSE4
#define SIMD_SSE4(kernel) N_SSE4::kernel
#else
#define SIMD_SSE4(kernel) nullptr
#endif

// The form of a kernel that a level asks for; in HWY_ONCE parts, in the namespace around Highway's.
#define SIMD_KERNEL(level, kernel)                                                \
    ::prep::detail::chosen<decltype(&HWY_STATIC_DISPATCH(kernel))>(               \
        level, HWY_STATIC_DISPATCH(kernel), SIMD_SSE4(kernel), SIMD_AVX2(kernel), \
        SIMD_AVX512(kernel))

namespace prep::detail {

// The best level that this build has and this machine runs. Asked once: in a virtual machine each
// question costs microseconds.
SimdLevel best_simd_level();

template <class Kernel>
Kernel chosen(SimdLevel level, Kernel baseline, Kernel sse4, Kernel avx2, Kernel avx512) {
    if (level == SimdLevel::automatic) level = best_simd_level();
    if (!simd_available(level)) return baseline;
    const Kernel kernel = level == SimdLevel::avx512 ? avx512
                          : level == SimdLevel::avx2 ? avx2
                          : level == SimdLevel::sse4 ? sse4
                                                     : baseline;
    return kernel == nullptr ? baseline : kernel;  // the baseline may be beyond what is asked for
}

}  // namespace prep::detail
