// Step 5 of the definition at one welded vertex: which triangles are neighbours over an edge there.
//
// Whether two triangles are neighbours over an edge at a vertex can be told from the triangles
// around that vertex alone: over one edge the n-th triangle that leaves the vertex meets the n-th
// that enters it (lower triangle numbers pair first, each side once).
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "tangents/stars.h"

namespace prep::detail {

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
    void name_vertices(const TangentStars& stars);
    const Entry* find(std::uint32_t half_edge) const;
    bool touch(const TangentStars& stars, std::span<const std::uint32_t> star) const {
        return !entries.empty() &&
               std::binary_search(vertices.begin(), vertices.end(), stars.vertex(star[0]));
    }
};

class Neighbours {
  public:
    // For each member of the star its neighbours over the edge leaving and the edge entering the
    // vertex, as positions in the star, or no_index. O(k log k).
    void find(const TangentStars& stars, std::span<const std::uint32_t> star,
              const EdgeOverrides& overrides);
    std::uint32_t leaving(std::size_t i) const { return leaving_[i]; }
    std::uint32_t entering(std::size_t i) const { return entering_[i]; }

  private:
    void link(std::size_t leaves, std::size_t enters);
    void search();
    bool look_up();
    void sort();
    // Pairs of key and index, ascending.
    void order_by(const std::vector<std::uint32_t>& keys, std::vector<std::uint64_t>& order);
    void apply(std::span<const std::uint32_t> star, const EdgeOverrides& overrides);

    std::vector<std::uint32_t> leaving_, entering_, next_, previous_, firsts_, followers_;
    std::vector<std::uint64_t> by_next_, by_previous_;
};

}  // namespace prep::detail
