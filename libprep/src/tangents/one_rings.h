// The triangles around each welded vertex of the worklist, and how they are paired over edges:
// steps 2 and 5 of the definition.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/scratch_buffer.h"
#include "tangents/contributions.h"

namespace prep::detail {

// Some triangle corners (as in OneRings::members), list after list, each ascending: all of a
// position or none. None of degenerate triangles.
using MemberLists = std::vector<std::vector<std::uint32_t>>;

struct Worklist {
    MemberLists lists;
    std::vector<std::uint64_t> triangles;  // a bit for each that has such corners
    bool any = false;
};

// Fans that share a triangle with a split vertex become listed: over an edge to it triangles may
// part. O(triangles).
void list_split_neighbours(std::span<const std::uint32_t> vertices, int threads,
                           std::span<std::uint8_t> states);

// states, places: Valences'; no states: all vertices are listed. corner_values: in, the
// vertices, three per triangle; out, the places of their fans' values, and no_index for listed
// corners and those of degenerate triangles. O(triangles).
Worklist make_worklist(const TangentTriangles& triangles, const ContributionStore& store,
                       std::span<const std::uint32_t> vertices,
                       std::span<const std::uint8_t> states, std::span<const std::uint32_t> places,
                       int threads, std::span<std::uint32_t> corner_values);

// A triangle's corner: four times the triangle plus 0, 1 or 2.
inline std::uint32_t next_corner(std::uint32_t member) {
    return (member & 3) == 2 ? member - 2 : member + 1;
}
inline std::uint32_t previous_corner(std::uint32_t member) {
    return (member & 3) == 0 ? member + 2 : member - 1;
}

// Triangle corners by position, of the positions that need it: the listed ones, numbered from 0 in
// ascending order. A position whose corners differ in normal or UV is several welded vertices
// ("split"), one behind the other in its range. Degenerate triangles are left out.
struct OneRings {
    std::size_t positions = 0;                // of the mesh; equal ones are one
    std::span<const std::uint32_t> vertices;  // three per triangle: its corners' positions

    std::size_t count = 0;                // listed positions
    ScratchBuffer<std::uint32_t> listed;  // which they are
    // count + 1, and one behind them. The members of listed position i are members[offsets[i]] …
    // members[offsets[i + 1] − 1], by welded vertex (in the order of their first members),
    // ascending within one.
    ScratchBuffer<std::uint32_t> offsets;
    ScratchBuffer<std::uint32_t> members;
    // Per listed position; before split_rings: may it be?
    ScratchBuffer<std::uint8_t> split;
    bool any_split = false;

    // The names of the welded vertices of the three corners of a triangle that has contributions:
    // equal for corners of one, different for others. For all but later parts of split positions it
    // is the position.
    const std::uint32_t* names_of(std::size_t triangle) const {
        return names.empty() ? vertices.data() + 3 * triangle
                             : names.data() + 3 * store->place(triangle);
    }
    std::uint32_t vertex(std::uint32_t member) const { return names_of(member >> 2)[member & 3]; }

    // Calls body(members) for every welded vertex of the listed positions [begin, end).
    template <class Body>
    void for_each(std::size_t begin, std::size_t end, const Body& body) const {
        for (std::size_t i = begin; i < end; ++i) {
            std::uint32_t first = offsets[i];
            const std::uint32_t last = offsets[i + 1];
            if (!split[i]) {
                body(std::span(members.data() + first, last - first));
                continue;
            }
            while (first < last) {
                const std::uint32_t name = vertex(members[first]);
                std::uint32_t stop = first + 1;
                while (stop < last && vertex(members[stop]) == name) ++stop;
                body(std::span(members.data() + first, stop - first));
                first = stop;
            }
        }
    }

    ScratchBuffer<std::uint32_t> own_vertices;  // what `vertices` are, where not the input's
    ScratchBuffer<std::uint32_t> names;         // empty while no position is split
    const ContributionStore* store = nullptr;
};

// Without members. Equal positions become one, numbered in the order of the lowest of each.
// `lowest`: see equal_positions (surface/weld.h).
OneRings welded_vertices(const TangentInput& input, const TangentTriangles& triangles,
                         std::span<const std::uint32_t> lowest, int threads);

void fill_rings(const TangentInput& input, const TangentTriangles& triangles,
                const MemberLists& lists, OneRings& rings);

// Parts positions into welded vertices. `contributions` is kept.
void split_rings(const CornerReader& read, const TangentTriangles& triangles,
                 const ContributionStore& store, int threads, OneRings& rings);

// Edges whose pairs are not the definition's (the reference's quirk,
// tangents/c_reference_quirks.h). A half-edge is named like the triangle corner that it leaves.
struct EdgeOverrides {
    struct Entry {
        std::uint32_t half_edge, mate;  // mate: a half-edge, or no_index
    };
    std::vector<Entry> entries;           // ascending by half_edge
    std::vector<std::uint32_t> vertices;  // the welded vertices at their ends, ascending
    bool empty() const { return entries.empty(); }
    // Finds `vertices`.
    void name_vertices(const OneRings& rings);
    const Entry* find(std::uint32_t half_edge) const;
    bool touch(const OneRings& rings, std::span<const std::uint32_t> ring) const {
        return !entries.empty() &&
               std::binary_search(vertices.begin(), vertices.end(), rings.vertex(ring[0]));
    }
};

// Step 5 at one welded vertex. Whether two triangles are neighbours over an edge there can be told
// from the triangles around that vertex alone: over one edge the n-th triangle that leaves the
// vertex meets the n-th that enters it (lower triangle numbers pair first, each side once).
class EdgePairs {
  public:
    // For each member of the ring its neighbours over the edge leaving and the edge entering the
    // vertex, as places in the ring, or no_index. Expected O(members).
    void find(const OneRings& rings, std::span<const std::uint32_t> ring,
              const EdgeOverrides& overrides);
    std::span<const std::uint32_t> leaving() const { return leaving_; }
    std::span<const std::uint32_t> entering() const { return entering_; }

  private:
    void apply(std::span<const std::uint32_t> ring, const EdgeOverrides& overrides);

    std::vector<std::uint32_t> leaving_, entering_, next_, previous_, heads_, cursors_, followers_;
};

// What the C reference does differently from the definition (mode mikktspace_exact): which corner
// a welded vertex takes its values from, and the pairs that its incomplete sort misses.

// Per mesh corner the one that stands for it: 2048 cells along the longest axis of the bounding
// box, corners in order inside a cell; ranges are cut at the middle of their longest axis by
// swapping until they cannot be cut any more; there the first equal corner stands for the others.
// Faces that the method skips keep their own corners.
std::vector<std::uint32_t> c_reference_welds(const TangentInput& input,
                                             const TangentTriangles& triangles);

// The reference sorts all edges by their lower end, then runs of those by the upper end, then runs
// of those by triangle; the last run of the second and of the third sort is left as it is. Edges
// at the greatest lower end are therefore in the order that its quicksort left them in, and what
// is not adjacent there is not paired. Expected O(triangles). EdgeOverrides::vertices is left
// empty.
EdgeOverrides c_reference_pairs(const std::vector<std::uint32_t>& welds,
                                const TangentTriangles& triangles, const ContributionStore& store);

}  // namespace prep::detail
