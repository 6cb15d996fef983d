// Triangles with a corner behind the near plane or beyond the guard band: drawn through homogeneous
// edge functions, without clipping.
//
// Watertight by construction: how an edge is evaluated depends on its two vertices only, so both
// triangles that share it partition the samples alike. Two snapped ends: their exact line and the
// top-left rule, as everywhere else. One: the line from the snapped end towards the other in
// homogeneous double, so that all lines at a snapped vertex pass through it exactly. None: the
// homogeneous cross product, which IEEE arithmetic negates exactly when its operands are swapped.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "geometry/tile.h"

namespace rast::detail {

// Homogeneous, in pixels from the picture's centre: (x·w, y·w, depth·w, w).
struct ScreenVertex {
    double x = 0, y = 0, z = 0, w = 0;
};

// Where the doubles behind vertex records come from, for the few triangles that need them.
class VertexSource {
  public:
    virtual ~VertexSource() = default;
    virtual ScreenVertex homogeneous(std::uint32_t vertex) const = 0;
};

// The record of a vertex, as the transform kernel makes it.
VertexRecord record_of(const ScreenVertex& vertex);

// value(x, y) > 0 inside, in pixels.
struct CrossingEdge {
    double nx = 0, ny = 0, px = 0, py = 0, constant = 0;
    bool inclusive = false;
    double value(double x, double y) const { return nx * (x - px) + ny * (y - py) + constant; }
    bool inside(double value_here) const {
        return value_here > 0 || (inclusive && value_here == 0);
    }
};

// Weights of the corners and depth at a place, from the corners where they are, not where they are
// snapped to: a snapped corner far away next to one behind the eye would move what lies close to
// the eye by many pixels.
struct CrossingPlane {
    double px = 0, py = 0;                         // what the rest is relative to, in pixels
    std::array<double, 3> nx{}, ny{}, constant{};  // homogeneous edge functions
    double depth = 0, depth_x = 0, depth_y = 0;
    double low = 0, high = 0;  // the visible corners' depths: rounding at an edge never leaves them
};

struct CrossingTriangle {
    std::array<CrossingEdge, 3> edges;  // edge i is opposite to corner i; turned to be positive
    CrossingPlane plane;
    bool turned = false;                                  // corners 1 and 2 were swapped for that
    double low_x = 0, low_y = 0, high_x = 0, high_y = 0;  // box of the visible part
    std::uint32_t id = 0;
};

enum class CrossingOutcome : std::uint8_t { drawn, outside, degenerate };

// `out.id` is not set; `out.turned` tells the winding: not turned means clockwise on the screen.
CrossingOutcome set_up_crossing(const VertexSource& source, const VertexRecord* records,
                                const std::uint32_t corners[3], CrossingTriangle& out);

// Weights of a crossing triangle's three corners, in the order in which they were given.
struct CrossingWeights {
    double px, py;                     // what the rest is relative to, in pixels
    double nx[3], ny[3], constant[3];  // homogeneous edge functions
    // At a point, not normalised, then their derivatives per pixel along x and y.
    // Perspective-correct weights are the first three over their sum.
    void at(double x, double y, double out[9]) const;
};
// Where nothing is drawn, all weight is the first corner's.
CrossingWeights crossing_weights(const VertexSource& source, const VertexRecord* records,
                                 const std::uint32_t corners[3]);

}  // namespace rast::detail
