// The usual star: one fan of healthy triangles of one orientation, whose tangents only need to be
// summed. Told from the sums of all vertices, many at once; whatever is no such star is left to
// tangents/groups.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "tangents/contributions.h"
#include "tangents/valence.h"

namespace prep::detail {

// Of a vertex' corners.
struct alignas(32) VertexSum {
    float x = 0, y = 0, z = 0;         // the sum of their terms, in the order of the triangles
    std::uint32_t code = ~0u;          // the bits that all their terms have
    std::uint32_t normal = 0, uv = 0;  // the indices of the first corner
    std::uint32_t split = 0;           // not 0: a corner's are of other values
    std::uint32_t padding = 0;
};

// The vertices behind and before a vertex in its triangles, in the order of the triangles;
// undefined behind the last, and of larger stars.
struct alignas(64) VertexRing {
    struct {
        std::uint32_t next, previous;
    } members[most_ring_members];
};

// A vertex' sum; behind, unit where it is not zero.
struct alignas(16) StarSum {
    float x, y, z;
    std::uint32_t code;  // 0: not told to be a fan; else star_is_fan and what else is so of these
};
inline constexpr std::uint32_t star_is_fan = 1;     // and orientation_preserving, of all triangles
inline constexpr std::uint32_t star_has_frame = 2;  // the sum makes a frame with the normal, by far

// Up to this many vertices at once. A multiple of all vector lengths.
inline constexpr std::size_t ring_batch = 1024;

// Vertices that have met all their triangles, and what they found.
struct RingBatch {
    std::size_t count = 0;
    alignas(64) std::uint32_t vertices[ring_batch];
    alignas(64) StarSum stars[ring_batch];          // in: the sums, their codes not
    alignas(64) std::uint32_t codes[ring_batch];    // 0 where the vertex is split
    alignas(64) std::uint32_t members[ring_batch];  // triangles, up to most_ring_members + 1
    alignas(64) std::uint32_t slots[ring_batch];    // below VertexWord::most_slots
    alignas(64) std::uint32_t normals[ring_batch];  // the index of the first corner
};

// Writes stars for all of the batch, and anything behind the last. A star is a fan when it has up
// to most_ring_members members, each reached from the first over edges that two triangles share
// and no more, when their S and their T share a half-space (see TermCode), and when all corners
// have one normal and one UV. rings: slot by slot. normals: for star_has_frame; empty: it is not
// looked for.
using RingKernel = void (*)(const VertexRing* rings, std::span<const glm::vec3> normals,
                            RingBatch& batch);

void rings_scalar(const VertexRing* rings, std::span<const glm::vec3> normals, RingBatch& batch);
RingKernel ring_kernel(SimdLevel level, std::size_t normals);  // in simd/

// What of a star can be told without its edges.
inline bool may_be_fan(std::uint32_t code, std::size_t count) {
    if (count == 0 || count > most_ring_members) return false;
    if (!(code & own_frame)) return false;
    if (!(code & (orientation_preserving | orientation_mirrored))) return false;
    return count == 1 || ((code & s_directions) && (code & t_directions));
}

// Is the star one fan? Exact, for 2 … most_ring_members members.
inline bool is_one_fan(const VertexRing& ring, std::size_t count) {
    // Per member the one whose edge enters from the vertex to which its own edge leaves.
    std::uint32_t successors[most_ring_members] = {};
    std::uint32_t reached = 0, last = most_ring_members;
    for (std::uint32_t i = 0; i < count; ++i) {
        std::uint32_t found = most_ring_members;
        for (std::uint32_t j = 0; j < count; ++j)
            if (ring.members[j].previous == ring.members[i].next)
                found = found == most_ring_members ? j : 100;
        if (found == 100) return false;
        if (found == most_ring_members) {
            if (last != most_ring_members) return false;  // a second open end
            last = i;
        } else {
            if (reached >> found & 1) return false;  // two leave to one vertex
            reached |= 1u << found;
        }
        successors[i] = found;
    }
    const std::uint32_t all = (1u << count) - 1;
    // Closed: any is the first. Open: the one that none leads to.
    std::uint32_t at = 0, seen = 0;
    if (last != most_ring_members)
        while (reached >> at & 1) ++at;
    while (at != most_ring_members && !(seen >> at & 1)) {
        seen |= 1u << at;
        at = successors[at];
    }
    return seen == all;
}

}  // namespace prep::detail
