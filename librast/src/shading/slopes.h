// Bump maps as they are shaded: the slopes of their heights.
#pragma once

#include "prep/image.h"
#include "prep/scene.h"

namespace rast::detail {

// Of the heights in the first channel: their change over a unit of u (red) and of v (green), at the
// texels' centres by central differences, as the sampler wraps; a border is taken for clamping, as
// with displacement maps. Filtered like any texture, they are the gradient of a surface without
// folds between texels. Beside texels that are not finite, and beyond 2^100, slopes are 0: what
// filters make of them is finite. As a texture they take 16 bytes a texel (shading/texture.h).
prep::Image slopes_of(const prep::Image& heights, const prep::Texture& sampler);

}  // namespace rast::detail
