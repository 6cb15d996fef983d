// What plan() refuses.
#pragma once

#include <optional>

#include "plan/drawn_contents.h"
#include "prep/result.h"
#include "rast/render.h"

namespace rast::detail {

// Extents, crop, sampling: invalid or limit.
std::optional<prep::Error> fault_of_request(const RenderRequest& request);

// What the kernels' numbers of 32 bits cannot count: limit.
std::optional<prep::Error> fault_of_size(const DrawnContents& drawn, Shading shading);

// A view that makes no picture: invalid.
std::optional<prep::Error> fault_of_view(const View& view);

}  // namespace rast::detail
