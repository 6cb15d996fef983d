#include <cstring>
#include <type_traits>

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

const Kernels& scalar_kernels() {
    static constexpr Kernels table{transform,      cull,   set_up, raster,
                                   collect,        expand, shade,  attributes,
                                   light_vertices, covers, pack,   specular_powers};
    return table;
}

}  // namespace rast::detail
