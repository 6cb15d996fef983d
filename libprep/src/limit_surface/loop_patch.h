// Regular triangles of Loop's scheme: quartic box splines of 12 control points (Loop 1987), as
// polynomials of degree 4.
//
// The polynomials are not written down: they are interpolated through the 15 points (i/4, j/4) of
// the triangle, whose limits two refinements and the limit mask of a regular vertex give exactly.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

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

// At the points (i/n, j/n), row by row (i + j ≤ n), 12 weights each; `control`: of the points of
// the cage refined log2 n times.
struct LoopTable {
    std::uint32_t n = 0;
    std::vector<LoopWeights> weights;
    std::vector<double> control;
    static LoopTable make(std::uint32_t n);
};

}  // namespace prep::detail
