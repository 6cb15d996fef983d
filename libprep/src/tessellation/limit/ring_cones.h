// How far limit normals around an extraordinary vertex are from its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "prep/simd.h"

namespace prep::detail {

struct ChannelSurface;

// |a − b| of unit vectors whose angle has this tangent; 2, which no two exceed, for infinity.
double chord_of_tangent(double tangent);

// Largest |n − limit normal| over a ring's sector from level k of its rings on, for the levels that
// tips have (limit_pieces.h).
class RingCones {
  public:
    RingCones() = default;
    RingCones(const ChannelSurface& surface, int threads, SimdLevel simd = SimdLevel::automatic);
    double from_level(std::uint32_t ring, std::uint32_t sector, int k) const;

  private:
    std::vector<std::size_t> first_;  // per ring
    std::vector<float> cones_;        // per sector a level each
};

}  // namespace prep::detail
