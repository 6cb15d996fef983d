// Weighted sums of face normals in fans, as good as exact.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>

#include "prep/corner_normals.h"
#include "prep/mesh.h"

namespace prep::detail {

// Of one thread. What faces with many corners add is made once. The mesh must outlive it.
class ExactCornerSums {
  public:
    ExactCornerSums(const MeshView& mesh, NormalWeight weight);
    ~ExactCornerSums();

    // `corners` of one fan and their faces, all with finite positions.
    // Area weights: exact rationals, the result is zero only if the sum is. Other weights: 256-bit
    // floats, zero where the sum is below 2⁻¹⁵⁰ of its terms. Scaled by some power of two.
    glm::dvec3 operator()(std::span<const std::uint32_t> corners,
                          std::span<const std::uint32_t> faces);

  private:
    class Sums;
    std::unique_ptr<Sums> sums_;
};

}  // namespace prep::detail
