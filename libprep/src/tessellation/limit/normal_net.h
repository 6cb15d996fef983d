// normal_net-inl.h of one patch, out of glm's vectors.
#pragma once

#include <glm/glm.hpp>

namespace prep::detail {
#include "tessellation/limit/normal_net-inl.h"
}  // namespace prep::detail
