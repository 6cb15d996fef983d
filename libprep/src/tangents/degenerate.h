// Step 9 of the definition: the corners of degenerate triangles copy others' results.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tangents/contributions.h"

namespace prep::detail {

// indices: per mesh corner its value, no_index where there is none yet. Expected
// O(triangles). Gives the corners that changed by position alone (their normals may differ).
std::vector<std::uint32_t> copy_to_degenerate(const CornerReader& read,
                                              const TangentTriangles& triangles, const Terms& terms,
                                              std::span<std::uint32_t> indices);

}  // namespace prep::detail
