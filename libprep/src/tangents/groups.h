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

#include "tangents/neighbours.h"
#include "tangents/stars.h"

namespace prep::detail {

struct GroupTangents {
    // Tangent and w: the first of each position that has corners, by position, then all others.
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
};

// Where positions' first values are.
struct FirstValues {
    std::size_t count = 0;
    bool all_listed = false;                // listed position i's is i; else position v's is
    std::span<const std::uint32_t> places;  // places[v], or v where there are none
};

// Groups of the positions that `stars` lists. Its lists and the terms, but not the triangles'
// flags, are given back before the values are put together. values: becomes GroupTangents::values;
// the first values of positions that are not listed are there. corner_values: three per triangle,
// into values; those of listed positions, and of degenerate triangles, are no_index, and stay that
// where no group reached the corner.
GroupTangents group_tangents(const CornerReader& read, const TangentTriangles& triangles,
                             Terms& terms, TangentStars& stars, const EdgeOverrides& overrides,
                             const GroupOptions& options, const FirstValues& firsts,
                             std::vector<glm::vec4> values, std::span<std::uint32_t> corner_values);

}  // namespace prep::detail
