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

// In the order in which they use each other.
// clang-format off
#include "kernels/lanes_highway-inl.h"
#include "kernels/transform-inl.h"
#include "kernels/cull-inl.h"
#include "kernels/setup-inl.h"
#include "kernels/math-inl.h"
#include "kernels/surface-inl.h"
#include "kernels/texture-inl.h"
#include "kernels/probes-inl.h"
#include "kernels/light-inl.h"
#include "kernels/points-inl.h"
#include "kernels/tile_depths-inl.h"
#include "kernels/raster_points-inl.h"
#include "kernels/raster_rows-inl.h"
#include "kernels/raster_blocks-inl.h"
#include "kernels/raster-inl.h"
#include "kernels/collect-inl.h"
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
