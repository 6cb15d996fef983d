// Normals of the surface that a dense triangle mesh was sampled from: of a cubic that is fitted to
// the vertices around, without any weighting of faces (Cazals and Pouget, "Estimating differential
// quantities using polynomial fitting of osculating jets", 2005).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cost/measure/metrics.h"

namespace cost {

struct FittedNormal {
    Vector normal{0};  // unit length, on the side that the faces show
    // Root mean square of what the cubic misses of the vertices, by the distance of the farthest of
    // them: 0 on what is smooth, 0.1 and more over an edge.
    double misfit = 0;
    bool known = false;  // false: at a boundary, where triangles cross or are missing, or too few
};

// Of each of `vertices`: least squares over all vertices within `rings` edges of it, heights above
// a plane as a cubic of both coordinates along it; a second time about the first fit's normal.
// Three corners a face; each position once. Corner by corner in long double: O(vertices · 4^rings).
std::vector<FittedNormal> fitted_normals(std::span<const glm::vec3> positions,
                                         std::span<const std::uint32_t> corner_vertices,
                                         std::span<const std::uint32_t> vertices, int rings = 3);

}  // namespace cost
