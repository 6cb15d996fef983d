// Numbers for the points of a cage that is cut into grids: one for each cage vertex, for each point
// on a cage edge and for each point inside a face, whichever face it is seen from; and which of the
// faces' corners writes it. So neighbours share their points, and each is computed once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prep/mesh.h"

namespace prep::detail {

// Faces by their corners; half-edge c runs from corner c to the next one.
struct NumberedTopology {
    std::span<const std::uint32_t> face_offsets;
    std::vector<std::uint32_t> corner_vertices;
    std::vector<std::uint32_t> corner_edges;
    // Per corner: its half-edge runs the way in which the edge's points are counted.
    std::vector<std::uint8_t> forward;
    std::uint32_t vertex_count = 0, edge_count = 0;
};

class GridNumbering {
  public:
    // Faces that are kept are cut level times: edges into 2^level segments, triangles of triangular
    // schemes and quads at once, n-gons as n quads. Level 0: vertices alone.
    GridNumbering(const NumberedTopology& topology, std::span<const std::uint8_t> kept, int level,
                  bool triangles);

    std::uint64_t count() const { return count_; }
    std::uint32_t vertex(std::uint32_t cage_vertex) const { return vertices_[cage_vertex]; }
    // Of the point after k of 2^level segments of an edge, 0 < k.
    std::uint32_t edge_point(std::uint32_t edge, std::uint32_t k) const {
        return edges_[edge] + k - 1;
    }

    // Cells along a side of a root of a face of that many corners (0: level 0 of an n-gon).
    std::uint32_t cells(std::uint32_t face_size) const {
        return triangles_ || face_size == 4 ? segments_ : segments_ / 2;
    }
    // Of the points of a root, (cells + 1)², j by j (triangles: row j has cells + 1 − j). Those
    // that this root is to write are `own`. At level 0 of n-gons: corner `corner` alone.
    void root(std::uint32_t face, std::uint32_t corner, std::vector<std::uint32_t>& ids,
              std::vector<std::uint8_t>& own) const;

  private:
    void quad(std::uint32_t face, std::vector<std::uint32_t>& ids,
              std::vector<std::uint8_t>& own) const;
    void polygon(std::uint32_t face, std::uint32_t corner, std::vector<std::uint32_t>& ids,
                 std::vector<std::uint8_t>& own) const;
    void triangle(std::uint32_t face, std::vector<std::uint32_t>& ids,
                  std::vector<std::uint8_t>& own) const;
    std::uint32_t on_edge(std::uint32_t half_edge, std::uint32_t k) const {
        const std::uint32_t from = topology_.forward[half_edge] ? k : segments_ - k;
        return edges_[topology_.corner_edges[half_edge]] + from - 1;
    }
    bool owns_vertex(std::uint32_t corner) const {
        return vertex_owners_[topology_.corner_vertices[corner]] == corner;
    }
    bool owns_edge(std::uint32_t half_edge) const {
        return edge_owners_[topology_.corner_edges[half_edge]] == half_edge;
    }

    const NumberedTopology& topology_;
    std::uint32_t segments_ = 1;
    bool triangles_ = false;
    std::uint64_t count_ = 0;
    std::vector<std::uint32_t> vertices_, vertex_owners_, edges_, edge_owners_, faces_;
};

}  // namespace prep::detail
