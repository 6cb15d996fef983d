// Conforming triangle meshes by newest-vertex bisection (Mitchell 1989; Bänsch 1991).
//
// A triangle has the vertices (a, b, c), counter-clockwise; ab is its refinement edge and c its
// newest vertex. Halving it at the middle m of ab gives (c, a, m) and (b, c, m). All triangles at
// an edge are halved together: one that has another refinement edge is halved first.
//
// The start is roots and closed faces: a pair (c, a, b), whose halves are the roots (b, c, m) and
// (a, b, m), or a whole triangle (a, b, c), which is opened into the roots (a, b, m), (b, c, m) and
// (c, a, m). Let roots have the generation 0, closed ones −1, and a half one more than its
// triangle; an edge has the generation of the triangles that it is the refinement edge of, so that
// a triangle's other two edges have one more than its own. The start is compatible: an edge that is
// some root's ab, or one of a closed face, is a root's ab on all its sides once these are open. So
// what has to be halved or opened for a triangle of generation g has a lower one, which ends; and
// no vertex ever lies inside another triangle's edge.
//
// Triangles at an edge are linked in a ring, so that borders (rings of one) and edges of three or
// more faces, and faces that run the other way, need no cases of their own.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/large_vector.h"

namespace prep::detail {

// A point of a root triangle: weights of its corners, multiples of powers of two that add up to 1.
struct RootPoint {
    std::uint32_t root = 0;
    glm::dvec3 weights{0.0};
};

struct BisectedTriangle {
    // Of a closed face 0. Else 1, then a bit a halving of the root: the first child or the second.
    std::uint64_t path = 1;
    std::array<std::uint32_t, 3> vertices{};
    // Half-edge 3 t + e of triangle t runs from vertices[e] to the next; here the next half-edge
    // of the ring at that edge.
    std::array<std::uint32_t, 3> next{};
    std::uint32_t root = 0;      // of a closed face that of (a, b, m)
    std::uint8_t on_border = 1;  // a bit an edge: it is a part of a root's ab

    bool is_closed() const { return path == 0; }
    bool is_whole() const { return path == 0 && (on_border & 1) != 0; }  // a triangle, not a pair
    int depth() const { return int(std::bit_width(path)) - 1; }          // the generation
};
inline constexpr int deepest_bisection = 60;

// What bisection starts with.
struct FirstTriangle {
    std::array<std::uint32_t, 3> vertices{};
    std::array<std::uint32_t, 3> next{};  // as BisectedTriangle::next
    std::uint32_t root = 0;
    std::uint32_t other = 0;  // of closed faces the root (b, c, m); else the same root
    bool is_whole = false;    // its third root is the one after `other`
};

// The corners of the triangle that `path` leads to within a root.
std::array<glm::dvec3, 3> path_weights(std::uint64_t path);

class BisectionMesh {
  public:
    BisectionMesh(std::uint32_t vertices, std::span<const FirstTriangle> first);

    std::span<const BisectedTriangle> triangles() const { return triangles_; }
    std::uint32_t vertex_count() const { return vertices_; }

    // How many triangles bisect(t) adds; exact where no edge has three or more triangles, else an
    // upper bound.
    std::uint64_t cost(std::uint32_t t);
    // Halves or opens t, and first what must be for it. Triangles keep their index as their first
    // child's.
    void bisect(std::uint32_t t);

    // The middle of the refinement edge of the triangle that `path` led to; of a closed face its
    // centre.
    struct HalvedEdge {
        std::uint64_t path = 1;
        std::uint32_t root = 0;
        RootPoint middle() const;
    };
    // What bisect() did since forget(): vertices made, in order, and the edges that they halve:
    // several where a root's ab was halved (one of each triangle there), else one.
    struct NewVertices {
        std::uint32_t first = 0;             // vertex first + k …
        LargeVector<std::uint32_t> offsets;  // … has the edges offsets[k] … offsets[k + 1] − 1
        LargeVector<HalvedEdge> edges;
    };
    const NewVertices& news() const { return news_; }
    // Of a vertex that all its triangles have in one root: the edge that it halves, or nothing for
    // others. The first vertices are among those.
    const HalvedEdge* only_edge(std::uint32_t vertex) const {
        if (vertex < first_vertices_) return nullptr;
        const HalvedEdge& edge = only_edges_[vertex - first_vertices_];
        return edge.root == several_roots ? nullptr : &edge;
    }
    // Triangles that changed or are new, in the order of halving: the two halves of a triangle
    // follow each other, so neighbours in order are mostly neighbours in space (numbers are
    // bit-reversed). Some were halved again: those are no longer there.
    struct Touched {
        std::uint32_t triangle = 0;
        std::int32_t depth = 0;  // what it had: its number becomes its first child's
    };
    Touched as_it_is(std::uint32_t t) const { return {t, triangles_[t].depth()}; }
    bool is_there(const Touched& touched) const {
        return triangles_[touched.triangle].depth() == touched.depth;
    }
    // Forgets all of that, and puts what was touched in the place of `touched`.
    void take_touched(LargeVector<Touched>& touched);

  private:
    void halve_ring(std::uint32_t half_edge);
    void open(std::uint32_t t);
    // Has to be halved or opened before the edge is a refinement edge on this side.
    bool is_before(std::uint32_t half_edge) const {
        return half_edge % 3 != 0 || triangles_[half_edge / 3].is_whole();
    }
    std::uint32_t& next(std::uint32_t h) { return triangles_[h / 3].next[h % 3]; }
    void replace(std::uint32_t old, std::uint32_t by);
    void link(std::span<const std::uint32_t> ring);

    static constexpr std::uint32_t several_roots = 0xffffffff;

    LargeVector<BisectedTriangle> triangles_;
    LargeVector<HalvedEdge> only_edges_;  // by vertex, from first_vertices_ on
    std::vector<std::uint32_t> others_;   // roots, per first triangle; empty without closed ones
    std::uint32_t first_vertices_, vertices_;
    NewVertices news_;
    LargeVector<Touched> touched_;
    std::vector<std::uint32_t> worklist_, members_, near_, far_;
};

}  // namespace prep::detail
