// What all triangles give to the tangents of their vertices, added up vertex by vertex while the
// triangles are gone through once. A vertex that has met all its triangles is done with at once, so
// that what is at work fits in a cache: most vertices need neither a list of their triangles nor
// the terms of these.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "tangents/contributions.h"
#include "tangents/fans.h"
#include "tangents/valence.h"

namespace prep::detail {

// Writes the tangents of fans to their places, what became of all vertices to counts.states, and
// the flags and counts of all triangles to `terms`, and all terms where many will be needed.
// Degenerate triangles are left out. vertices: as in count_triangles.
//
// False, with nothing of use: so many vertices have corners of several normals or UVs that lists
// are the better way; something is NaN; or a vertex has degenerate triangles alone.
//
// The first range that has a vertex adds to it at once; later ones note what they have for it, and
// that is added after all, range by range: the order is the triangles', whatever the ranges.
// O(triangles). What is noted is little where neighbours in the mesh are near in number, and 20
// bytes a corner at worst.
bool add_up_vertices(const TangentInput& input, const TangentTriangles& triangles,
                     std::span<const std::uint32_t> vertices, const TermMaker& maker,
                     const FanMaker& fans, const TangentOptions& options, VertexCounts& counts,
                     Terms& terms, std::span<glm::vec4> values);

}  // namespace prep::detail
