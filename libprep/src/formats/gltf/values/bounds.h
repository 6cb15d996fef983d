// The least and the greatest values of an accessor.
#pragma once

#include "formats/gltf/document.h"

namespace prep::detail {

// Sets "min" and "max": of the stored numbers, not of what normalisation makes of them. At least
// one element. O(values).
void set_bounds(const RawAccessor& raw, Json& accessor);

}  // namespace prep::detail
