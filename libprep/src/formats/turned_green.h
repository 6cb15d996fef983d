// Normal maps whose green points down, for files that know those with green up alone.
#pragma once

#include <cstddef>
#include <vector>

#include "prep/image.h"

namespace prep::detail {

// Whether 8 bits hold every value.
bool is_eight_bit(const Image& image);

// A PNG of 1 − green; of 16 bits where 8 do not hold it.
Result<std::vector<std::byte>> turned_green_png(Image image);

}  // namespace prep::detail
