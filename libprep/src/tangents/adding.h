// Adds triangles' terms to the sums of their vertices, many at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "tangents/contributions.h"
#include "tangents/rings.h"
#include "tangents/valence.h"

namespace prep::detail {

struct AddInput {
    const std::uint32_t* vertices;  // three per triangle
    const std::uint32_t* corners;   // the mesh's, three per triangle; nullptr: their own numbers
    const std::uint32_t *normals, *uvs;  // indices by corner of the mesh
};

// Vertices that are at work have slots.
struct AddState {
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
struct AddLists {
    std::uint32_t left[3 * TermBlock::size];       // at vertices that are not counted: not added
    std::uint32_t different[3 * TermBlock::size];  // other normals or UVs than the first one's
    std::size_t left_count = 0, different_count = 0;
};

// The terms of triangles [first, first + count), in `planes` from the beginning; degenerate
// triangles, if there are any, are left out. There must be room for all their corners' vertices.
using AddKernel = void (*)(const AddInput& input, std::size_t first, std::size_t count,
                           bool any_degenerate, const CornerTerm* const planes[3], AddState& state,
                           AddLists& lists);

AddKernel add_kernel(SimdLevel level);  // in simd/

// One term, at corner k, to the vertex of a slot that has met that many triangles. True where the
// corner has another normal or UV than the vertex' first.
bool add_term(const AddInput& input, std::size_t triangle, std::size_t k, const CornerTerm& term,
              std::uint32_t met, VertexSum& sum, VertexRing& ring);

}  // namespace prep::detail
