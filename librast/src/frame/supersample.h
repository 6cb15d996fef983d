// Pictures as the mean of finer ones.
#pragma once

#include "rast/render.h"

namespace rast::detail {

// The plan of the picture with supersample × supersample pixels for each, of colours alone.
RenderPlan finer_plan(const RenderPlan& plan);

// `rows` rows of `coarse`, from `first_row` on, become the means of `factor` × `factor` pixels of
// `fine`, which has `factor` times its width: in linear light, added up in double, row by row. A
// constant comes out with its own bits.
void reduce(const glm::vec4* fine, std::uint32_t factor, std::uint32_t first_row,
            std::uint32_t rows, int threads, Frame& coarse);

}  // namespace rast::detail
