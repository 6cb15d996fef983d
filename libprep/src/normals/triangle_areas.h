// Area vectors of triangles in floats, many at once.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "prep/simd.h"

namespace prep::detail {

// area_vectors[f] for the triangles first … last−1, whose corners are corner_vertices[3f …].
// Triangles of which the float result could be off by more than 2⁻¹⁶ of its length, that leave
// float's range or are not finite are appended to left_over (ascending) instead.
//
// Error: an edge component is rounded by 2⁻²⁴ of itself, a component of the product then is off by
// at most 8·2⁻²⁴ of m, the product of the edges' largest components, and the vector by 16·2⁻²⁴·m
// (√3 < 2): below 2⁻¹⁶ of its length where its largest component is at least m/16. The same bits
// on every instruction set: additions, multiplications and comparisons only.
void triangle_areas(std::span<const glm::vec3> positions,
                    std::span<const std::uint32_t> corner_vertices, std::uint32_t first,
                    std::uint32_t last, std::span<glm::dvec3> area_vectors,
                    std::vector<std::uint32_t>& left_over, SimdLevel simd = SimdLevel::automatic);

}  // namespace prep::detail
