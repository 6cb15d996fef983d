// Whether all components of a vector are numbers, neither NaN nor infinite.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace prep::detail {

template <glm::length_t n, class T>
bool is_finite(const glm::vec<n, T>& v) {
    for (glm::length_t k = 0; k < n; ++k)
        if (!std::isfinite(v[k])) return false;
    return true;
}

}  // namespace prep::detail
