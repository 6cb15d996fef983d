// The triangles around each welded vertex: step 2 of the definition, and what step 5 needs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/scratch_buffer.h"
#include "tangents/contributions.h"

namespace prep::detail {

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
struct TangentStars {
    std::size_t positions = 0;                // of the mesh; equal ones are one
    std::span<const std::uint32_t> vertices;  // three per triangle: its corners' positions

    std::size_t count = 0;                // listed positions
    ScratchBuffer<std::uint32_t> listed;  // which they are
    // count + 1, and one behind them. The members of listed position i are members[offsets[i]] …
    // members[offsets[i + 1] − 1], by welded vertex (in the order of their first members),
    // ascending within one.
    ScratchBuffer<std::uint32_t> offsets;
    ScratchBuffer<std::uint32_t> members;
    // Per listed position; before split_stars: may it be?
    ScratchBuffer<std::uint8_t> split;
    bool any_split = false;

    // The names of the welded vertices of the three corners of a triangle that has terms (place:
    // Terms::place): equal for corners of one, different for others. For all but later parts of
    // split positions it is the position.
    const std::uint32_t* names_at(std::size_t triangle, std::size_t place) const {
        return names.empty() ? vertices.data() + 3 * triangle : names.data() + 3 * place;
    }
    const std::uint32_t* names_of(std::size_t triangle) const {
        return names_at(triangle, names.empty() ? 0 : terms->place(triangle));
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
    const Terms* terms = nullptr;
};

// Without members. Equal positions become one, numbered in the order of the lowest of each.
// `lowest`: see equal_positions (surface/weld.h).
TangentStars named_vertices(const TangentInput& input, const TangentTriangles& triangles,
                            std::span<const std::uint32_t> lowest, int threads);

// Some triangle corners (as in TangentStars::members), list after list, each ascending: all of a
// position or none. None of degenerate triangles.
using MemberLists = std::vector<std::vector<std::uint32_t>>;

void list_members(const TangentInput& input, const TangentTriangles& triangles,
                  const MemberLists& lists, TangentStars& stars);

// Parts positions into welded vertices. `terms` is kept.
void split_stars(const CornerReader& read, const TangentTriangles& triangles, const Terms& terms,
                 int threads, TangentStars& stars);

}  // namespace prep::detail
