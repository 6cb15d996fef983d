// What the C reference does differently from the definition (mode mikktspace_exact): which corner
// stands for a welded vertex, and the neighbours that its incomplete sort misses.
#pragma once

#include <cstdint>
#include <vector>

#include "tangents/contributions.h"
#include "tangents/neighbours.h"

namespace prep::detail {

// Per mesh corner the one that stands for it: 2048 cells along the longest axis of the bounding
// box, corners in order inside a cell; ranges are cut at the middle of their longest axis by
// swapping until they cannot be cut any more; there the first equal corner stands for the others.
// Faces that the method skips keep their own corners.
std::vector<std::uint32_t> reference_representatives(const TangentInput& input,
                                                     const TangentTriangles& triangles);

// The reference sorts all edges by their lower end, then runs of those by the upper end, then runs
// of those by triangle; the last run of the second and of the third sort is left as it is. Edges
// at the greatest lower end are therefore in the order that its quicksort left them in, and what
// is not adjacent there is not paired. Expected O(triangles). EdgeOverrides::vertices is left
// empty.
EdgeOverrides reference_pairs(const std::vector<std::uint32_t>& representatives,
                              const TangentTriangles& triangles, const Terms& terms);

}  // namespace prep::detail
