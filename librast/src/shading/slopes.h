// Bump maps as they are shaded: the slopes of their heights.
#pragma once

#include "prep/image.h"
#include "prep/scene.h"

namespace rast::detail {

// The change of heights over the picture's own width (red) and height (green), at its texels'
// centres.
struct Slopes {
    prep::Image image;
    prep::Texture sampler;
    // Along an axis that mirrors it holds two, the second with slopes that turn, and repeats.
    glm::vec2 units{1.0f};
};

// Of the heights in the first channel, by central differences, as the sampler wraps; a border is
// taken for clamping, as with displacement maps. Filtered like any texture, they are the gradient
// of a surface without folds between texels. Beside texels that are not finite, and beyond 2^100,
// slopes are 0: what filters make of them is finite. As a texture they take 16 bytes a texel
// (shading/texture.h).
Slopes slopes_of(const prep::Image& heights, const prep::Texture& sampler);

}  // namespace rast::detail
