// A wave over the unit square that repeats in both directions, and what a map of it holds between
// its texels.
#pragma once

#include <vector>

#include "cost/measure/metrics.h"

namespace cost {

// −1 … 1; its second derivatives are (4π)² at most in any direction.
Real wave_at(Real u, Real v);
// The unit normal of (u, v, height · wave_at(u, v)), z upwards.
Vector wave_normal(Real u, Real v, Real height);

// The wave at the centres of size × size texels, row by row, v downwards; rounded to floats.
class WaveTexels {
  public:
    explicit WaveTexels(int size);
    const std::vector<float>& texels() const { return texels_; }
    // Linear along both axes between the four texels around a place; copies repeat.
    Real bilinear(Real u, Real v) const;

  private:
    Real texel(long i, long j) const;
    int size_;
    std::vector<float> texels_;
};

}  // namespace cost
