// The plane of map coordinates in pieces that are each a copy of the map's cells: repeated, turned
// over, or, outside of a clamped map, projected onto its border.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "displacement/height_data.h"

namespace prep::detail {

// Map coordinates between low and high are cell coordinates turn · x + shift.
struct AxisRegion {
    double low = 0, high = 0, turn = 1, shift = 0;
    double cell(double x) const { return turn * x + shift; }
};

// Regions are numbered along the axis; those of clamp are −1, 0 and 1.
inline double region_of(const HeightAxis& axis, double x) {
    const double size = double(axis.size);
    switch (axis.wrap) {
        case Wrap::repeat:
            return std::floor(x / size);
        case Wrap::mirror:
            return std::floor((x + 0.5) / size);
        default:
            return x < -1 ? -1.0 : x > size ? 1.0 : 0.0;
    }
}

inline AxisRegion region(const HeightAxis& axis, double number) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double size = double(axis.size);
    switch (axis.wrap) {
        case Wrap::repeat:
            return {number * size, (number + 1) * size, 1, -number * size};
        case Wrap::mirror: {
            // Even ones stand as the map does, odd ones the other way round; cell 0 lies before the
            // first texel.
            const double low = number * size - 0.5, high = low + size;
            if (std::fmod(number, 2) == 0) return {low, high, 1, 1 - number * size};
            return {low, high, -1, (number + 1) * size};
        }
        default:
            if (number < 0) return {-infinity, -1, 0, 0};
            if (number > 0) return {size, infinity, 0, size + 1};
            return {-1, size, 1, 1};
    }
}

// Cell coordinates of a point; the cell is kept inside the map where rounding would leave it.
struct CellPoint {
    std::int64_t cell = 0;
    double part = 0;
};
inline CellPoint cell_point(const HeightAxis& axis, double along) {
    const double last = double(axis.cells() - 1);
    const double cell = std::clamp(std::floor(along), 0.0, last);
    return {std::int64_t(cell), std::clamp(along - cell, 0.0, 1.0)};
}

}  // namespace prep::detail
