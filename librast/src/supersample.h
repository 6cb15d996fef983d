// Pictures as the mean of finer ones.
#pragma once

#include "rast/render.h"

namespace rast::detail {

// The plan of the picture with supersample × supersample pixels for each, of colours alone.
RenderPlan finer_plan(const RenderPlan& plan);

// Pixels of `coarse` from row `first_row` on become the means of `factor` × `factor` pixels of
// `fine`: in linear light, added up in double, row by row. A constant comes out with its own bits.
void reduce(const Frame& fine, std::uint32_t factor, std::uint32_t first_row, Frame& coarse);

}  // namespace rast::detail
