// The rules around one extraordinary vertex, on the rings of faces around it, for Catmull–Clark's
// scheme and for Loop's; the schemes' own masks are in ring_masks.h.
//
// The two rings of a vertex with m faces (sectors) are closed under refinement: the same rings of
// the next level depend on them alone (Stam 1998, section 3, without its eigenbasis). A point (a,
// b) of a sector's face, a along the sector's first edge, lies in a regular patch of level
// floor(−log2 max(a, b)) + 1 (of triangles: a + b), whose 16 (12) control points are in these rings
// and the next ones; at the vertex itself are limit masks. So every point is exact up to rounding,
// at O(m) a level for all sectors together, and nothing is tabulated by valence.
//
// Sectors run counter-clockwise. They are closed, or open between two infinitely sharp edges,
// beyond which nothing matters. A closed ring may have one sharp edge (a dart, or a sharp vertex
// with one crease): edge 0. Creases: Hoppe et al. 1994.
//
// Points of a ring, in this order: the vertex; per edge i (edges: m, or m + 1 where open) the
// points 1 and 2 steps along it; per sector j the points (1,1), (2,1), (1,2), (2,2), of triangles
// only (1,1).
#pragma once

#include <cstdint>
#include <span>

namespace prep::detail {

struct RingShape {
    std::uint16_t sectors = 0;
    bool closed = true;
    bool sharp_edge = false;   // closed: edge 0 is a crease
    bool corner_rule = false;  // the vertex is infinitely sharp; open without: a crease
    bool triangles = false;    // Loop's rules

    std::uint32_t edges() const { return closed ? sectors : sectors + 1U; }
    std::uint32_t point_count() const { return 1 + 2 * edges() + (triangles ? 1U : 4U) * sectors; }
    std::uint32_t edge(std::uint32_t i) const { return closed && i == sectors ? 0 : i; }
    bool is_sharp(std::uint32_t i) const {
        return closed ? sharp_edge && edge(i) == 0 : i == 0 || i == sectors;
    }
    // A point nearer to the vertex than 2 to the minus this is taken for it. Where three triangles
    // meet, or a crease has one sector on a side, what the normal comes from shrinks to a quarter
    // with each level (in others to a half or so), and would be rounding errors at level 50.
    int deepest_level() const {
        const bool thin = !corner_rule && (closed ? triangles && sectors == 3 : sectors == 1);
        return thin ? 36 : 50;
    }
    std::uint32_t next(std::uint32_t j) const { return j + 1 == sectors ? 0 : j + 1; }
    std::uint32_t previous(std::uint32_t j) const { return j == 0 ? sectors - 1U : j - 1; }

    std::uint32_t one_step(std::uint32_t i) const { return 1 + 2 * edge(i); }
    std::uint32_t two_steps(std::uint32_t i) const { return 2 + 2 * edge(i); }
    // (1,1), (2,1), (1,2), (2,2) for k = 0 … 3.
    std::uint32_t inner(std::uint32_t j, std::uint32_t k) const {
        return 1 + 2 * edges() + (triangles ? j : 4 * j + k);
    }
};

// The rings of the next level out of `rings`; `width` numbers a point.
void refine_ring(const RingShape& shape, std::uint32_t width, const double* rings, double* next);

// The control points of the regular patch over the quadrant (qa, qb) of sector j's face, one level
// below `rings`, where qa or qb is 1: out[(4 y + x) · width …], x along the sector's first edge.
// Triangles: the 12 (loop_patch.h) of that at the sector's first edge (1, 0), at its last one (0,
// 1), or of the inverted one between (1, 1), whose corners are (1,1), (0,1), (1,0) of the next
// level. `next` is refine_ring(rings).
void ring_patch(const RingShape& shape, std::uint32_t width, const double* rings,
                const double* next, std::uint32_t j, int qa, int qb, double* out);

// Limit value and derivatives by (a, b), of this ring's scale, at the point (x, y) of sector j's
// face: (1,0), (0,1) or, not of triangles, (1,1).
void ring_corner_limit(const RingShape& shape, std::uint32_t width, const double* rings,
                       std::uint32_t j, int x, int y, double* value, double* da, double* db);

// What the limit at the vertex is made of. Values are `width` numbers each.
struct RingLimit {
    // t0 × t1 is the normal; where it is not (darts, sharp vertices with more than one sector)
    // callers look nearby.
    bool has_tangents = false;
};
// value; t0 and t1 such that the tangent towards edge i is cos(iθ) t0 + sin(iθ) t1, θ as of
// ring_angle. Creases: the exact left eigenvectors of these rules (Biermann et al. 2000 give those
// of modified rules). `scratch` holds 2 · point_count() · width numbers where the ring is a dart's
// (closed, with a sharp edge), and is not read otherwise.
RingLimit ring_limit(const RingShape& shape, std::uint32_t width, const double* rings,
                     double* value, double* t0, double* t1, std::span<double> scratch);
double ring_angle(const RingShape& shape);

}  // namespace prep::detail
