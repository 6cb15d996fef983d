// The tangents of vertices whose star is one fan (tangents/rings.h).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "tangents/rings.h"

namespace prep::detail {

struct FanOptions {
    float positive = 1;   // w where the definition's sign is +1
    bool review = false;  // values that may be no frames are no fans'
    SimdLevel simd = SimdLevel::automatic;
};

class FanMaker {
  public:
    FanMaker(const CornerReader& read, const FanOptions& options);

    // Writes the tangents of fans to values[place] and all the batch's vertices' states (where not
    // a fan, listed_vertex). places: empty, where each has its own number.
    void make(const VertexRing* rings, RingBatch& batch, std::span<const std::uint32_t> places,
              std::span<glm::vec4> values, std::span<std::uint8_t> states) const;

  private:
    const CornerReader& read_;
    FanOptions options_;
    RingKernel rings_;
};

}  // namespace prep::detail
