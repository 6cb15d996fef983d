#include <cstring>
#include <type_traits>

#include "geometry/homogeneous_triangle.h"
#include "kernels/kernels.h"

// Helpers of the kernels stay in registers; calls would spill every vector.
#define RAST_INLINE inline __attribute__((always_inline))
#include "kernels/lanes_scalar.h"

namespace rast::detail {
namespace {

using namespace rast::detail::scalar_lanes;

// In the order in which they use each other.
// clang-format off
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

const Kernels& scalar_kernels() {
    static constexpr Kernels table{transform,      cull,   set_up, raster,
                                   collect,        expand, shade,  attributes,
                                   light_vertices, covers, pack,   specular_powers};
    return table;
}

}  // namespace rast::detail
