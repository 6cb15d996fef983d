// The weighted sum of face normals in a fan, as good as exact.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "prep/corner_normals.h"
#include "prep/mesh.h"

namespace prep::detail {

// `corners` of one fan and their faces, all with finite positions.
// Area weights: exact rationals, the result is zero only if the sum is. Other weights: 256-bit
// floats, zero where the sum is below 2⁻¹⁵⁰ of its terms. Scaled by some power of two.
glm::dvec3 exact_corner_sum(const MeshView& mesh, std::span<const std::uint32_t> corners,
                            std::span<const std::uint32_t> faces, NormalWeight weight);

}  // namespace prep::detail
