// What a plan's picture takes in memory, at once and in bands.
#pragma once

#include <cstdint>

#include "rast/render.h"

namespace rast::detail {

// The crop, or all of the picture.
Crop picture_part(const RenderRequest& request);

// Sets band_rows, memory_estimate and band_memory_estimate, by the plan's request and its
// passes, halo, triangles and vertices. Bands are whole rows of tiles where that fits, so that no
// tile is drawn twice.
void estimate_memory(RenderPlan& plan);

}  // namespace rast::detail
