// Bump maps as they are shaded: the slopes of their heights.
#pragma once

#include "prep/image.h"
#include "prep/scene.h"

namespace rast::detail {

// Of the heights in the first channel: their change over a unit of u (red) and of v (green), at the
// texels' centres by central differences, as the sampler wraps; a border is taken for clamping, as
// with displacement maps. Filtered like any texture, they are the gradient of a surface without
// folds between texels. Texels that are not finite have slopes of 0, and so have those next to
// them.
prep::Image slopes_of(const prep::Image& heights, const prep::Texture& sampler);

}  // namespace rast::detail
