// Corners that no group gave a tangent: step 9 of the definition, and an orthonormal tangent
// wherever the definition's is none.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tangents/contributions.h"

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

// Step 9 of the definition: the corners of degenerate triangles copy others' results. indices: per
// mesh corner its value, no_index where there is none yet. Expected O(triangles). Gives the corners
// that changed by position alone (their normals may differ).
std::vector<std::uint32_t> copy_to_degenerate(const CornerReader& read,
                                              const TangentTriangles& triangles,
                                              const ContributionStore& store,
                                              std::span<std::uint32_t> indices);

}  // namespace prep::detail
