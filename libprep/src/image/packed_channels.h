// Pictures that are put together from channels of others (packed_refs.h), and taken apart again.
#pragma once

#include "prep/image.h"
#include "prep/scene.h"

namespace prep::detail {

// The picture of ImageRef::channels, as large as the largest of its sources; smaller ones are
// repeated texel by texel (nearest). A source that cannot be read counts as its channel's `value`.
// Errors: invalid (more than 4 channels), and that of the first source where none can be read.
Result<Image> pack_channels(const ImageRef& image);

// One channel of a picture, as a grey one.
Image single_channel(const Image& image, std::uint32_t channel);

}  // namespace prep::detail
