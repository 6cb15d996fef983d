#include "crossing.h"
#include "simd/kernels.h"

// Helpers of the kernels stay in registers; calls would spill every vector.
#define RAST_INLINE inline __attribute__((always_inline))
#include "simd/lanes_scalar.h"

namespace rast::detail {
namespace {

using namespace rast::detail::scalar_lanes;

// In the order in which they use each other.
// clang-format off
#include "simd/transform-inl.h"
#include "simd/math-inl.h"
#include "simd/surface-inl.h"
#include "simd/texture-inl.h"
#include "simd/shade-inl.h"
#include "simd/raster-inl.h"
// clang-format on

}  // namespace

const Kernels& scalar_kernels() {
    static constexpr Kernels table{transform,  cull,           raster, collect, shade,
                                   attributes, light_vertices, covers, pack,    specular_powers};
    return table;
}

}  // namespace rast::detail
