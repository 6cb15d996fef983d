// The sign of the area of a 2D triangle, exact for float coordinates.
#pragma once

#include <glm/glm.hpp>

#include "exact/difference_of_products.h"

namespace prep::detail {

// Exact orientation by rationals (CGAL); orient2d below calls it where doubles cannot tell.
int exact_orient2d(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c);

// 1: a, b, c turn counter-clockwise; −1: clockwise; 0: on one line. Finite coordinates.
inline int orient2d(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
    const glm::dvec2 u = glm::dvec2(b) - glm::dvec2(a), v = glm::dvec2(c) - glm::dvec2(a);
    const double left = u.x * v.y, right = u.y * v.x;
    const double determinant = left - right;
    // Two rounded differences a factor, one product, one subtraction: under 4 ulps of each product.
    const double bound = 4 * 0x1p-52 * (glm::abs(left) + glm::abs(right));
    if (determinant > bound) return 1;
    if (determinant < -bound) return -1;
    return exact_orient2d(a, b, c);
}

}  // namespace prep::detail
