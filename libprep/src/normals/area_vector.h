// A face's area vector in doubles, with a bound on its error.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "prep/mesh.h"

namespace prep::detail {

struct AreaVector {
    glm::dvec3 value{0.0};
    double error = 0;  // bound on the length of the error
};

inline double largest_component(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// Newell's sum about the first corner, in plain doubles. Finite positions.
//
// With edges e rounded by 2⁻⁵³ a component, each component of a term is off by at most 8·2⁻⁵³ of
// the product of the edges' largest components, and each addition by 2·2⁻⁵³ of their sum so far.
AreaVector plain_area_vector(const MeshView& mesh, std::uint32_t face);

// Of a triangle: the same bits.
inline AreaVector plain_triangle_area(const glm::vec3& p, const glm::vec3& q, const glm::vec3& r) {
    const glm::dvec3 first(p), a = glm::dvec3(q) - first, b = glm::dvec3(r) - first;
    AreaVector area;
    area.value += glm::dvec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    area.error = 16 * 0x1p-53 * (largest_component(a) * largest_component(b));
    return area;
}

// The same with error-free transformations: the edges are exact unless their coordinates differ by
// more than 2²⁹ in size, each term's component keeps its rounding error, and so does the sum.
AreaVector compensated_area_vector(const MeshView& mesh, std::uint32_t face);

// The first of both whose error is below accurate_face_error of its length, else exact (CGAL).
// `exact` counts the latter.
glm::dvec3 accurate_area_vector(const MeshView& mesh, std::uint32_t face,
                                std::uint64_t* exact = nullptr);

// The cross product of the edges from `at` to `next` and to `previous`, with the accuracy of
// compensated_area_vector.
glm::dvec3 corner_cross(const glm::vec3& at, const glm::vec3& next, const glm::vec3& previous);

}  // namespace prep::detail
