#pragma once

#include <algorithm>
#include <cstdint>

namespace prep::detail {

// An edge by its two points, in either order.
inline std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
}

}  // namespace prep::detail
