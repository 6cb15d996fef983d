// One step of refinement by the published rules, and parts of meshes (for subdivision_oracle.cpp).
#pragma once

#include "subdivision_oracle.h"

namespace test::subdivision {

using Real = SubdivisionOracle::Real;
using Point = SubdivisionOracle::Point;
using Edge = SubdivisionOracle::Edge;
using Level = SubdivisionOracle::Level;

constexpr Real infinite = 10;  // sharpness that does not wear off
inline bool is_semi_sharp(Real sharpness) {
    return sharpness > 0 && sharpness < infinite;
}

// The next level. Children of a face: Catmull-Clark and bilinear one for each corner, in their
// order, starting at that corner; Loop one for each corner, starting there, and the middle one,
// from the middle of the first edge. Of a part of a mesh, what depends on faces outside is wrong.
Level refine(const Level& level, const SubdivisionRules& rules);

// These faces alone, in this order, with their vertices and edges.
Level part_of(const Level& level, std::span<const std::uint32_t> faces);

// The faces that share a vertex with one, which comes first.
std::vector<std::uint32_t> faces_around(const Level& level, std::uint32_t face);

// The vertex' limit as seen from a corner of a face; the edges at it must be smooth or infinitely
// sharp. The derivatives are those along the edges to the next (du) and to the last vertex (dv), in
// lengths of these edges.
SubdivisionOracle::Limit limit_at(const Level& level, const SubdivisionRules& rules,
                                  std::uint32_t face, std::uint32_t corner);

}  // namespace test::subdivision
