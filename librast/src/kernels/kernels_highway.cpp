// The kernels once per instruction set, and the choice at run time.
#include <cstring>
#include <type_traits>

#include "geometry/homogeneous_triangle.h"
#include "kernels/kernels.h"

// Helpers of the kernels stay in registers; calls would spill every vector.
#define RAST_INLINE inline __attribute__((always_inline))

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/kernels_highway.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rast::detail::HWY_NAMESPACE {
namespace {

// clang-format off
#include "kernels/lanes_highway-inl.h"
#include "kernels/kernels-inl.h"
// clang-format on

}  // namespace

const Kernels* kernels() {
    return &kernel_table;
}

}  // namespace rast::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rast::detail {

const Kernels& kernels_for(prep::SimdLevel level) {
    using prep::SimdLevel;
    const auto allowed = [&](SimdLevel candidate) {
        return (level == SimdLevel::automatic || level >= candidate) &&
               prep::simd_available(candidate);
    };
#if HWY_TARGETS & HWY_AVX3
    if (allowed(SimdLevel::avx512)) return *N_AVX3::kernels();
#endif
#if HWY_TARGETS & HWY_AVX2
    if (allowed(SimdLevel::avx2)) return *N_AVX2::kernels();
#endif
#if HWY_TARGETS & HWY_SSE4
    if (allowed(SimdLevel::sse4)) return *N_SSE4::kernels();
#endif
    return scalar_kernels();
}

}  // namespace rast::detail
#endif
