// Which faces meet along which edges, and which corners meet at which vertex. Exact: no tolerance.
//
// A half-edge is named by the corner that it leaves: half-edge c runs from corner c to the next
// corner of its face.
//
// Two levels of identity. `welded` says which vertices are one point (weld_exact, or a tolerance
// weld: that is policy and not decided here). Half-edges are paired over the file's own vertex
// indices first and over welded ones after that: a two-sided leaf whose sides have vertices of
// their own stays two surfaces though their points coincide, while UV and normal seams still close.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "prep/mesh.h"

namespace prep {

enum class EdgeKind : std::uint8_t {
    interior,      // exactly two faces, opposite directions: has an opposite half-edge
    border,        // one face
    inconsistent,  // two faces that run the same way: orientations disagree
    non_manifold,  // three or more faces
    degenerate,    // both ends are one point
};

struct Topology {
    std::vector<std::uint32_t> welded;        // per vertex: the lowest vertex of the same point
    std::vector<std::uint32_t> corner_faces;  // per corner: its face
    std::vector<std::uint32_t> opposite;      // per corner: opposite half-edge, or no_index
    std::vector<EdgeKind> kinds;              // per corner

    // Corners around each point (index: welded vertex), ascending: those of point v are
    // point_corners[point_offsets[v]] … [point_offsets[v+1]-1]. Empty for vertices welded away.
    std::vector<std::uint32_t> point_offsets;  // vertices + 1
    std::vector<std::uint32_t> point_corners;  // corners
};

// The next and previous corner of the same face.
inline std::uint32_t next_corner(std::span<const std::uint32_t> face_offsets, std::uint32_t face,
                                 std::uint32_t corner) {
    return corner + 1 == face_offsets[face + 1] ? face_offsets[face] : corner + 1;
}
inline std::uint32_t previous_corner(std::span<const std::uint32_t> face_offsets,
                                     std::uint32_t face, std::uint32_t corner) {
    return corner == face_offsets[face] ? face_offsets[face + 1] - 1 : corner - 1;
}

// Per vertex: the lowest vertex whose position compares equal (−0 equals 0, NaN equals nothing).
// O(vertices), the same result for any thread count.
std::vector<std::uint32_t> weld_exact(std::span<const glm::vec3> positions, int threads = 0);

// `welded` as from weld_exact; empty: every vertex is its own point. O(corners).
// Edges with three or more half-edges after the first pairing level are non_manifold; they and
// inconsistent ones have no opposite.
Topology build_topology(const MeshView& mesh, std::span<const std::uint32_t> welded = {},
                        int threads = 0);

}  // namespace prep
