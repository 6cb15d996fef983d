// Quads out of the pairs of triangles that exporters made of them.
//
// Rule: two triangles that share an edge, and material, smoothing, part and every attribute along
// it, are a candidate when they turn by less than 45° over the edge and make a convex quad; its fit
// is the largest deviation of its four angles from 90°, which must stay under 60°. A pair is joined
// when each is the other's best candidate and fits better by a degree than the next; then again
// among those that are left, until there is no such pair. Order and number of faces decide nothing.
//
// Known where it must fail: nets of equilateral triangles, whose diagonals no angle tells; there
// triangles stay. O(triangles · rounds).
#pragma once

#include <cstdint>
#include <vector>

#include "prep/mesh.h"

namespace prep::detail {

struct RecoveredQuads {
    std::uint64_t quads = 0;
    // Triangles that stay: because several partners fit alike, or none fits.
    std::uint64_t ambiguous = 0, alone = 0;
    std::vector<std::uint32_t> places;  // first faces that stay, by their number in the result
};

// Quads stand where the first of their triangles stood and begin at its corner after the diagonal.
// Layers, materials and what else is by face or corner follow.
RecoveredQuads recover_quads(Mesh& mesh);

}  // namespace prep::detail
