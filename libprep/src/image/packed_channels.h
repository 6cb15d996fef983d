// Pictures that are put together from channels of others, and taken apart again: MTL and FBX name a
// picture for each quantity, glTF one whose green is the roughness and whose blue is the metalness.
#pragma once

#include <memory>

#include "prep/image.h"
#include "prep/scene.h"

namespace prep::detail {

// The picture of ImageRef::channels, as large as the largest of its sources; smaller ones are
// repeated texel by texel (nearest). A source that cannot be read counts as its channel's `value`.
// Errors: invalid (more than 4 channels), and that of the first source where none can be read.
Result<Image> pack_channels(const ImageRef& image);

// Metalness and roughness of two pictures (either may be null: 1 everywhere), as glTF packs them.
ImageRef packed_metallic_roughness(std::shared_ptr<const ImageRef> metallic,
                                   std::shared_ptr<const ImageRef> roughness, bool glossiness);

// The colours of one picture with the other for its alpha: that one's alpha where it has one, else
// its first channel. `color` null: white.
ImageRef packed_with_opacity(std::shared_ptr<const ImageRef> color,
                             std::shared_ptr<const ImageRef> opacity);

// One channel of a picture, as a grey one.
Image single_channel(const Image& image, std::uint32_t channel);

}  // namespace prep::detail
