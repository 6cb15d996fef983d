// An orthonormal tangent wherever the definition's is none.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tangents/triangles.h"

namespace prep::detail {

struct FallbackInput {
    CornerReader read;                        // normals already unit
    std::span<const std::uint32_t> lowest;    // see equal_positions
    std::span<const std::uint32_t> suspects;  // corners to look at, ascending, each once
    float positive = 1;                       // w where the UV area is positive
};

// Corners without a value have no_index in out.tangents.indices, and must be suspects. Afterwards
// every suspect has a unit tangent orthogonal to its normal, and out.fallbacks names those that
// needed another than the definition's.
void apply_fallbacks(const FallbackInput& input, CornerTangents& out);

}  // namespace prep::detail
