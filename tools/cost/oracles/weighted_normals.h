// Normals of a smooth triangle mesh by the definitions of their weights, in long double.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cost/measure/metrics.h"

namespace cost {

// By vertex: the sum over its corners of the face's unit normal times what the weight of this name
// says: "area", "uniform" (1), "angle" (of the corner), "area-angle" (their product), "edge-length"
// (the sine of the corner's angle over the lengths of its two edges: Max 1999). Not of unit length.
// Three corners a face, none without area. Empty for another name.
std::vector<Vector> weighted_normals(std::span<const glm::vec3> positions,
                                     std::span<const std::uint32_t> corner_vertices,
                                     const std::string& weight);

}  // namespace cost
