// What a plan's picture takes in memory, at once and in bands.
#pragma once

#include <cstdint>

#include "rast/render.h"

namespace rast::detail {

// What all passes of a plan ask for beside its picture.
struct PassMemory {
    bool any = false;
    bool depth = false, normals = false, positions = false;  // read, whether they are kept or not
    std::uint64_t planes = 0;  // floats a pixel, of passes after the main one
    std::uint64_t bytes = 0;   // of planes of passes before it
};

// The crop, or all of the picture.
Crop picture_part(const RenderRequest& request);

// Sets band_rows, memory_estimate and band_memory_estimate, by the plan's request, halo, triangles
// and vertices. Bands are whole rows of tiles where that fits, so that no tile is drawn twice.
void estimate_memory(RenderPlan& plan, const PassMemory& passes);

}  // namespace rast::detail
