// The streaming path: what all triangles contribute to the tangents of their vertices, accumulated
// while the triangles are gone through once. A vertex that has met all its triangles is classified
// at once, so that what is at work fits in a cache: most vertices are one fan of healthy triangles
// of one orientation, and their tangent is the sum, made unit. The rest goes on the worklist
// (tangents/one_rings.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/scratch_buffer.h"
#include "tangents/contributions.h"

namespace prep::detail {

// Fans of more triangles are left to the worklist.
inline constexpr std::size_t most_ring_members = 8;

// What became of a vertex.
enum VertexState : std::uint8_t {
    unused_vertex = 0,    // has no triangles
    fan_vertex = 1,       // has its tangent
    split_vertex = 2,     // as the following; corners of several normals or UVs
    worklist_vertex = 3,  // needs a list of its triangles
    pending_vertex = 4,   // nothing yet
};
inline bool on_worklist(std::uint8_t state) {
    return state == split_vertex || state == worklist_vertex;
}

// A vertex while its triangles are counted down: how many are to come, times 16 how many were met,
// and times 256 the slot that it has from its first to its last: all that is looked up by vertex,
// in one place.
struct VertexWord {
    static constexpr std::uint32_t to_come = 0x0f, met_one = 0x10, slot_one = 0x100;
    // Not counted down: shared by several ranges, then with the number of those met in the last
    // four bits; or of more than most_ring_members, then all bits are set.
    static constexpr std::uint32_t apart = std::uint32_t(1) << 31, listed = ~std::uint32_t(0);
    static constexpr std::uint32_t most_slots = apart / slot_one;

    static std::uint32_t met(std::uint32_t word) {
        return (word & apart ? word : word / met_one) & 0x0f;
    }
    static std::uint32_t slot(std::uint32_t word) { return (word & ~apart) / slot_one; }
};

// How many triangles vertices have, and which ranges of triangles threads take.
struct Valences {
    struct Range {
        std::size_t begin = 0, end = 0;  // triangles; parts no quad
    };
    ScratchBuffer<std::uint8_t> states;  // VertexState
    ScratchBuffer<std::uint32_t> words;  // VertexWord
    std::size_t used = 0;                // vertices that have triangles
    std::size_t listed_corners = 0;      // corners at vertices whose word is `listed`
    // Per vertex the number of used ones before it; empty where all are used.
    ScratchBuffer<std::uint32_t> places;
    std::vector<Range> ranges;
    std::vector<std::uint64_t> shared;  // a bit per vertex; empty where there is one range
};

// Are successive triangles far apart in vertices' numbers? Ranges of such would share most
// vertices, and what is at work would be in no cache. Tells speed alone, from a sample of the
// vertices, so for all threads alike. Not where most of `count` vertices are unused.
bool are_scattered(std::span<const std::uint32_t> vertices, std::size_t count);

// vertices: three per triangle, below `count`. copy: one thread only, gets them while they are at
// hand; or nullptr. O(triangles); up to 64 ranges.
Valences count_valences(const TangentTriangles& triangles, std::span<const std::uint32_t> vertices,
                        std::size_t count, int threads, std::vector<std::uint32_t>* copy);
// For accumulate_scattered(): ranges, all vertices unused, nothing counted.
Valences uncounted_valences(const TangentTriangles& triangles, std::size_t count, int threads);

// Of a vertex' corners.
struct alignas(32) VertexSum {
    float x = 0, y = 0, z = 0;  // the sum of their contributions, in the order of the triangles
    std::uint32_t code = ~0u;   // the bits that all their contributions have
    std::uint32_t normal = 0, uv = 0;  // the indices of the first corner
    std::uint32_t split = 0;           // not 0: a corner's are of other values
    std::uint32_t padding = 0;
};

// The vertices behind and before a vertex in its triangles, in the order of the triangles;
// undefined behind the last, and where there are more.
struct alignas(64) VertexRing {
    struct {
        std::uint32_t next, previous;
    } members[most_ring_members];
};

struct AccumulateInput {
    const std::uint32_t* vertices;  // three per triangle
    const std::uint32_t* corners;   // the mesh's, three per triangle; nullptr: their own numbers
    const std::uint32_t *normals, *uvs;  // indices by corner of the mesh
};

// Vertices that are at work have slots.
struct AccumulateState {
    std::uint32_t* words;  // VertexWord, by vertex
    VertexSum* sums;       // by slot
    VertexRing* rings;
    std::uint32_t* free;  // slots, times VertexWord::slot_one, the next one last
    std::size_t free_count;
    // Those that have met all their triangles, and their words; room for a vector more.
    std::uint32_t *done_vertices, *done_words;
    std::size_t done_count;
};

// Corners by their place in a block: four times the triangle plus 0, 1 or 2.
struct AccumulateLists {
    std::uint32_t left[3 * TriangleBlock::size];  // at vertices that are not counted: not added
    std::uint32_t different[3 * TriangleBlock::size];  // other normals or UVs than the first one's
    std::size_t left_count = 0, different_count = 0;
};

// The contributions of triangles [first, first + count), in `planes` from the beginning; degenerate
// triangles, if there are any, are left out. There must be free slots for all their vertices.
using AccumulateKernel = void (*)(const AccumulateInput& input, std::size_t first,
                                  std::size_t count, bool any_degenerate,
                                  const Contribution* const planes[3], AccumulateState& state,
                                  AccumulateLists& lists);
AccumulateKernel accumulate_kernel(SimdLevel level);  // accumulate_kernels.cpp

// One contribution, at corner k, to the vertex of a slot that has met that many triangles. True
// where the corner has another normal or UV than the vertex' first.
bool add_contribution(const AccumulateInput& input, std::size_t triangle, std::size_t k,
                      const Contribution& contribution, std::uint32_t met, VertexSum& sum,
                      VertexRing& ring);

// What accumulating a corner takes, of scattered triangles.
struct alignas(32) CornerRecord {
    // Bits of the contribution's code, and before them the vertex by its number in its block.
    static constexpr int code_bits = 15;
    static constexpr std::uint32_t code_mask = (std::uint32_t(1) << code_bits) - 1;
    static_assert((s_directions | t_directions | orientation_preserving | orientation_mirrored |
                   own_frame) == code_mask);

    float x, y, z;  // the contribution
    std::uint32_t code;
    std::uint32_t next, previous;  // as in VertexRing
    std::uint32_t normal, uv;      // indices

    std::uint32_t vertex() const { return code >> code_bits; }
};

// Of a block's vertices by number: how many triangles they have met, up to most_ring_members + 1,
// sums and rings. `different`: the places of records with other normals or UVs than their vertex'
// first. Up to as many records as that has room for.
using AddRecordsKernel = void (*)(const CornerRecord* records, std::size_t count, std::uint8_t* met,
                                  VertexSum* sums, VertexRing* rings, AccumulateLists& lists);
AddRecordsKernel add_records_kernel(SimdLevel level);  // accumulate_kernels.cpp

// A vertex' sum; behind, unit where it is not zero.
struct alignas(16) FanSum {
    float x, y, z;
    std::uint32_t code;  // 0: no fan, as far as is known; else sum_is_fan and what follows
};
inline constexpr std::uint32_t sum_is_fan = 1;     // and orientation_preserving, of all triangles
inline constexpr std::uint32_t sum_has_frame = 2;  // the sum makes a frame with the normal, by far

// Up to this many vertices at once. A multiple of all vector lengths.
inline constexpr std::size_t ring_batch = 1024;

// Vertices that have met all their triangles, and what they found.
struct RingBatch {
    std::size_t count = 0;
    alignas(64) std::uint32_t vertices[ring_batch];
    alignas(64) FanSum sums[ring_batch];            // in: the sums, their codes not
    alignas(64) std::uint32_t codes[ring_batch];    // 0 where the vertex is split
    alignas(64) std::uint32_t members[ring_batch];  // triangles, up to most_ring_members + 1
    alignas(64) std::uint32_t slots[ring_batch];    // below VertexWord::most_slots
    alignas(64) std::uint32_t normals[ring_batch];  // the index of the first corner
};

// Classifies all of the batch, and writes anything behind the last. A vertex is a fan when it has
// up to most_ring_members triangles, each reached from the first over edges that two triangles
// share and no more, when their S and their T share a half-space (see ContributionCode), and when
// all corners have one normal and one UV. rings: slot by slot. normals: for sum_has_frame; empty:
// it is not looked for.
using FanKernel = void (*)(const VertexRing* rings, std::span<const glm::vec3> normals,
                           RingBatch& batch);
FanKernel fan_kernel(SimdLevel level);  // fan_kernels.cpp

struct FanOptions {
    float positive = 1;   // w where the definition's sign is +1
    bool review = false;  // values that may be no frames are no fans'
};

// Writes the tangents of fans to their places, what became of all vertices to valences.states, and
// the flags and counts of all triangles to `store`, and all contributions where many will be
// needed. Degenerate triangles are left out. vertices: as in count_valences.
//
// False, with nothing of use: so many vertices have corners of several normals or UVs that lists
// are the better way; something is NaN; or a vertex has degenerate triangles alone.
//
// The first range that has a vertex adds to it at once; later ones note what they have for it, and
// that is added after all, range by range: the order is the triangles', whatever the ranges.
// O(triangles). What is noted is little where neighbours in the mesh are near in number, and 20
// bytes a corner at worst.
bool accumulate(const CornerReader& read, const TangentTriangles& triangles,
                std::span<const std::uint32_t> vertices, const BlockContributions& contributions,
                const FanOptions& fans, const TangentOptions& options, Valences& valences,
                ContributionStore& store, std::span<glm::vec4> values);

// The same for triangles in random order (are_scattered), with uncounted_valences(), which it
// completes: contributions are sorted by vertex first (tangents/corner_buckets.h). False only where
// something is NaN or a vertex has degenerate triangles alone. 96 bytes a triangle, and 400 kB a
// thread at most.
bool accumulate_scattered(const CornerReader& read, const TangentTriangles& triangles,
                          std::span<const std::uint32_t> vertices,
                          const BlockContributions& contributions, const FanOptions& fans,
                          const TangentOptions& options, Valences& valences,
                          ContributionStore& store, std::span<glm::vec4> values);

}  // namespace prep::detail
