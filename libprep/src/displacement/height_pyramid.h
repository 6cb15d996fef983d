// Blocks of cells of a height map, each with a plane and how far the map departs from it.
//
// Level 0 has 8 × 8 cells a block, each further level 2 × 2 blocks of the one before, up to one
// block. A block says that the raw height at cell coordinates (x, y) lies in
// middle + slope · ((x, y) − centre) + [below, above], for every point of it: departures from a
// plane shrink with the square of a block's size, departures from a constant only with the size.
// 36 bytes a block: 19 % of the map's floats.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace prep::detail {

struct HeightMapData;

inline constexpr int cells_in_block = 8;

struct HeightBlock {
    float middle = 0, slope_x = 0, slope_y = 0, below = 0, above = 0;
    float low = 0, high = 0;       // of the raw height
    float step_x = 0, step_y = 0;  // bounds of its derivatives by x and y
};

struct HeightPyramid {
    struct Level {
        std::int64_t width = 0, height = 0;  // blocks
        std::vector<HeightBlock> blocks;
    };
    std::vector<Level> levels;
};

// From texels and filter; the result does not depend on the number of threads.
HeightPyramid make_height_pyramid(const HeightMapData& map, int threads);

// What the filter adds to the range of the texels that it reads, as a part of it: Catmull-Rom's
// weights of one axis sum to 1, the negative ones to no less than −1/8 (at ½), those of a product
// to 2 · 9/8 · −1/8.
inline constexpr double bicubic_overshoot = 9.0 / 32;
// Catmull-Rom's derivative is a mix of three neighbouring differences with weights whose absolute
// values sum to at most 3/2 (at ½), times 5/4 for the weights across.
inline constexpr double bicubic_steepening = 15.0 / 8;

// A plane and bounds of what the map departs from it, in double: a block's, or of fewer cells.
struct PlaneBound {
    double middle = 0, slope_x = 0, slope_y = 0, x = 0, y = 0;  // at cell coordinates (x, y)
    double below = 0, above = 0;
    double at(double px, double py) const {
        return middle + (slope_x * (px - x) + slope_y * (py - y));
    }
};

// Of the cells [cx, cx + n) × [cy, cy + n), n at most 8, those beyond the map's last left out.
PlaneBound plane_of_cells(const HeightMapData& map, std::int64_t cx, std::int64_t cy, int n);

// A cell as a tensor product of Bernstein polynomials: control values, 4 × 4 or 2 × 2 by rows.
struct CellNet {
    int n = 2;
    double control[16] = {};
    void restrict_to(double x0, double x1, double y0, double y1);  // of the unit square
    double low() const;
    double high() const;
};
CellNet cell_net(const HeightMapData& map, std::int64_t cx, std::int64_t cy);
// Of a net that covers [x, x + width] × [y, y + height] in cell coordinates; either may be 0.
PlaneBound plane_of_net(const CellNet& net, double x, double y, double width, double height);

}  // namespace prep::detail
