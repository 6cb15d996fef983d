// How many triangles vertices have, and which ranges of triangles threads take: what has to be
// known before tangents are added up (tangents/accumulate.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/scratch_buffer.h"
#include "tangents/triangles.h"

namespace prep::detail {

inline constexpr std::size_t most_ring_members = 8;

// What became of a vertex.
enum VertexState : std::uint8_t {
    unused_vertex = 0,   // has no triangles
    fan_vertex = 1,      // has its tangent
    split_vertex = 2,    // as the following; corners of several normals or UVs
    listed_vertex = 3,   // needs a list of its triangles (tangents/groups.h)
    pending_vertex = 4,  // nothing yet
};
inline bool needs_list(std::uint8_t state) {
    return state == split_vertex || state == listed_vertex;
}

// A vertex while its triangles are counted down: how many are to come, times 16 how many there
// were, and times 256 the slot that it has from its first to its last (tangents/adding.h): all that
// adding looks up by vertex, in one place.
struct VertexWord {
    static constexpr std::uint32_t to_come = 0x0f, met_one = 0x10, slot_one = 0x100;
    // Not counted down: shared by several ranges, then with the number that there were in the last
    // four bits; or of more than most_ring_members, then all bits are set.
    static constexpr std::uint32_t apart = std::uint32_t(1) << 31, listed = ~std::uint32_t(0);
    static constexpr std::uint32_t most_slots = apart / slot_one;

    static std::uint32_t met(std::uint32_t word) {
        return (word & apart ? word : word / met_one) & 0x0f;
    }
    static std::uint32_t slot(std::uint32_t word) { return (word & ~apart) / slot_one; }
};

struct VertexCounts {
    struct Range {
        std::size_t begin = 0, end = 0;  // triangles; parts no quad
    };
    static constexpr std::size_t behind = 3;
    ScratchBuffer<std::uint8_t> states;  // and some `behind` the last, to be read
    ScratchBuffer<std::uint32_t> words;  // VertexWord
    std::size_t used = 0;                // vertices that have triangles
    std::size_t listed_corners = 0;      // corners at vertices whose word is `listed`
    // Per vertex the number of used ones before it; empty where all are used.
    ScratchBuffer<std::uint32_t> places;
    std::vector<Range> ranges;
    std::vector<std::uint64_t> shared;  // a bit per vertex; empty where there is one range
};

// vertices: three per triangle, below `count`. copy: one thread only, gets them while they are at
// hand; or nullptr. O(triangles); up to 64 ranges.
VertexCounts count_triangles(const TangentTriangles& triangles,
                             std::span<const std::uint32_t> vertices, std::size_t count,
                             int threads, std::vector<std::uint32_t>* copy);

}  // namespace prep::detail
