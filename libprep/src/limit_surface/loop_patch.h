// Regular triangles of Loop's scheme: quartic box splines of 12 control points (Loop 1987), as
// polynomials of degree 4.
//
// The polynomials are not written down: they are interpolated through the 15 points (i/4, j/4) of
// the triangle, whose limits two refinements and the limit mask of a regular vertex give exactly.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "limit_surface/refined_cage.h"

namespace prep::detail {

struct LatticePoint {
    int x, y;
};
// The triangle is (0,0), (1,0), (0,1); neighbours of a point are (±1,0), (0,±1), ±(1,−1).
inline constexpr LatticePoint loop_controls[12] = {{0, 0},  {1, 0},  {0, 1},  {1, -1},
                                                   {2, -1}, {2, 0},  {1, 1},  {0, 2},
                                                   {-1, 2}, {-1, 1}, {-1, 0}, {0, -1}};
inline constexpr LatticePoint loop_steps[6] = {{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}};
// The limit at a regular vertex: half of it, and one of so many parts of each neighbour.
inline constexpr double loop_limit_own = 0.5, loop_limit_parts = 12;
// The six neighbours of each corner by number, counter-clockwise from its edge to the next corner.
inline constexpr std::uint8_t loop_corner_rings[3][6] = {
    {1, 2, 9, 10, 11, 3}, {2, 0, 3, 4, 5, 6}, {0, 1, 6, 7, 8, 9}};

struct LoopWeights {
    double value[12], du[12], dv[12];
};
LoopWeights loop_weights(double u, double v);
struct LoopSecondWeights {
    double uu[12], uv[12], vv[12];
};
LoopSecondWeights loop_second_weights(double u, double v);

// Rows of weights of the 12 for the Bézier points of degree 4 over the triangle: row by row from
// (0,0) to (1,0).
const std::array<std::array<double, 12>, 15>& loop_bezier_weights();

// A triangle within a root's parameters: its first corner at (x, y), a step along its first edge
// (ax, ay), along its last one (bx, by). Steps are those of the lattice: their determinant is 1.
template <class T>
struct TriangleFrame {
    T x, y, ax, ay, bx, by;

    // `n`: steps of a side.
    TriangleFrame at_corner(std::uint32_t c, T n) const {
        if (c == 0) return *this;
        if (c == 1) return {x + n * ax, y + n * ay, bx - ax, by - ay, -ax, -ay};
        return {x + n * bx, y + n * by, -bx, -by, ax - bx, ay - by};
    }
    TriangleFrame moved(T a, T b) const {
        return {x + a * ax + b * bx, y + a * ay + b * by, ax, ay, bx, by};
    }
    TriangleFrame inverted() const { return {x, y, -ax, -ay, -bx, -by}; }
};

// The four children of a split face, from `first` on in `cage.levels[level]`, by the frame of the
// face and half the steps of its side. The middle one's is that of its own first corner.
template <class T>
std::array<TriangleFrame<T>, 4> child_frames(const RefinedCage& cage, std::uint32_t level,
                                             std::uint32_t first, const TriangleFrame<T>& frame,
                                             T half) {
    const auto& vertices = cage.levels[level].corner_vertices;
    // Where the middle one's third corner is: the one at the middle of the face's second edge.
    const std::uint32_t opposite = vertices[3 * (first + 1) + 2];
    std::uint32_t corner = 0;
    while (corner < 2 && vertices[3 * (first + 3) + corner] != opposite) ++corner;
    return {frame, frame.moved(half, T(0)), frame.moved(T(0), half),
            frame.moved(half, half).inverted().at_corner((3 - corner) % 3, half)};
}

// At the points (i/n, j/n), row by row (i + j ≤ n), 12 weights each; `control`: of the points of
// the cage refined log2 n times.
struct LoopTable {
    std::uint32_t n = 0;
    std::vector<LoopWeights> weights;
    std::vector<double> control;
    static LoopTable make(std::uint32_t n);
};

}  // namespace prep::detail
