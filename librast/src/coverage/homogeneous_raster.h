// Drawing triangles with a corner behind the near plane or beyond the guard band
// (geometry/homogeneous_triangle.h).
#pragma once

#include "geometry/homogeneous_triangle.h"
#include "kernels/kernels.h"

namespace rast::detail {

// As Kernels::raster, for one triangle. Depth outside 0…1 is not drawn.
void raster_crossing(float* depth, std::uint32_t* id, const TilePlace& place,
                     const CrossingTriangle& triangle, std::uint32_t number,
                     const ShadeDraw* masked, const Kernels& kernels);

}  // namespace rast::detail
