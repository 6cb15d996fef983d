// MikkTSpace's groups and their tangents: steps 5 to 8, vertex by vertex.
//
// Every welded vertex is independent of the others, but for triangles that group with anything:
// those take the orientation of the group that reaches them first, in triangle order over the whole
// mesh. Vertices that such triangles touch are grouped in that order beforehand; all others in
// parallel.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "tangent_neighbours.h"
#include "tangent_stars.h"

namespace prep::detail {

struct GroupTangents {
    // Tangent and w: the first of each position that has one, by position, then all others.
    std::vector<glm::vec4> values;
    // Triangle corners (as in TangentStars::members) whose value may be no frame, and those that no
    // group reached; ascending by vertex. Only where `review` is set.
    std::vector<std::uint32_t> suspects;
};

struct GroupOptions {
    double angular_threshold = 0;
    float positive = 1;           // w where the definition's sign is +1
    bool review = false;          // look for values that are no frames
    bool bounded_effort = false;  // large stars in O(k log k), not with the definition's bits
    int threads = 0;
    SimdLevel simd = SimdLevel::automatic;
};

// room: becomes GroupTangents::values. corner_values: three per triangle, into values; no_index
// where no group reached the corner (also for degenerate triangles).
GroupTangents group_tangents(const CornerReader& read, const TangentTriangles& triangles,
                             const Terms& terms, const TangentStars& stars,
                             const EdgeOverrides& overrides, const GroupOptions& options,
                             std::vector<glm::vec4> room, std::span<std::uint32_t> corner_values);

}  // namespace prep::detail
