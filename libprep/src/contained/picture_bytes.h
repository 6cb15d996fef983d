// Pictures as bytes, as scene_bytes.h has scenes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "prep/image.h"
#include "prep/result.h"

namespace prep::detail {

std::vector<std::byte> picture_bytes(const Image& image);

// The bytes may be anything: sizes are held against each other and against what load_image()
// promises. Error: invalid, without a location.
Result<Image> picture_of_bytes(std::span<const std::byte> bytes, ImageChannels channels);

}  // namespace prep::detail
