// The kernels once per instruction set, and the choice at run time.
#include <cstring>
#include <type_traits>

#include "crossing.h"
#include "simd/kernels.h"

// Helpers of the kernels stay in registers; calls would spill every vector.
#define RAST_INLINE inline __attribute__((always_inline))

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/kernels_highway.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rast::detail::HWY_NAMESPACE {
namespace {

// In the order in which they use each other.
// clang-format off
#include "simd/lanes_highway-inl.h"
#include "simd/transform-inl.h"
#include "simd/cull-inl.h"
#include "simd/setup-inl.h"
#include "simd/math-inl.h"
#include "simd/surface-inl.h"
#include "simd/texture-inl.h"
#include "simd/probes-inl.h"
#include "simd/light-inl.h"
#include "simd/points-inl.h"
#include "simd/tile_depths-inl.h"
#include "simd/raster_points-inl.h"
#include "simd/raster_rows-inl.h"
#include "simd/raster_blocks-inl.h"
#include "simd/raster-inl.h"
#include "simd/collect-inl.h"
// clang-format on

}  // namespace

const Kernels* kernels() {
    static constexpr Kernels table{transform,      cull,   set_up, raster,
                                   collect,        expand, shade,  attributes,
                                   light_vertices, covers, pack,   specular_powers};
    return &table;
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
