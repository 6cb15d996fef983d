// A triangle of the tessellation as the bounds of a displaced surface take it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

#include "base/outward.h"
#include "tessellation/displaced_surface.h"

namespace prep::detail {

// What doubles may have lost on the way to a bound, and in the values it is a bound of: some dozen
// operations on numbers of this size.
inline constexpr double relative_slack = 0x1p-40, absolute_slack = 0x1p-46;

// Of a bound that is to be as tight as may be, what a coarse share may be.
inline constexpr double small_part = 0x1p-6;
// A search by parts takes the time of dozens of bounds. Closed faces without noise and triangles
// of rough maps are searched where their bounds are no more than so many times what is enough.
inline constexpr double near_enough = 2;
inline constexpr BaseDeviation unbounded{std::numeric_limits<double>::infinity(),
                                         std::numeric_limits<double>::infinity()};

// What is no number is no bound.
inline double bound_of(double x) {
    return x == x ? x : std::numeric_limits<double>::infinity();
}

// Of heights at a triangle's corners: the largest |h − h'||n − n'|, and the largest |h|.
struct HeightSpread {
    double cross = 0, highest = 0;
};
inline HeightSpread spread_of(const std::array<double, 3>& heights,
                              const std::array<BasePoint, 3>& points) {
    HeightSpread spread;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3;
        spread.cross =
            std::max(spread.cross, std::abs(heights[k] - heights[l]) *
                                       glm::length(points[k].direction - points[l].direction));
        spread.highest = std::max(spread.highest, std::abs(heights[k]));
    }
    return spread;
}

struct DisplacedSurface::Corners {
    std::uint32_t root = 0;
    const Displacement* displacement = nullptr;
    std::array<glm::dvec3, 3> weights;
    std::array<BasePoint, 3> points;
    std::array<double, 3> raw, heights;
    std::array<glm::dvec3, 3> vectors;  // the map's own
    std::array<glm::dvec3, 3> moved;    // where the root has the displaced surface
    double gap = 0, size = 0;
    double cross = 0, highest = 0;  // of the heights
    // Of vectors in the surface's frame: the longest, 0 of others.
    std::array<TangentFrame, 3> frames;
    double longest = 0;

    TriangleBound bound(double sum) const {
        TriangleBound result;
        result.refinable =
            sum == 0 ? 0.0F : float_not_below(sum * (1 + relative_slack) + size * absolute_slack);
        result.gap = float_not_below(gap * (1 + relative_slack) + size * absolute_slack);
        return result;
    }
};

struct DisplacedSurface::Whole {
    const Corners* corners = nullptr;
    std::array<glm::dvec3, 3> linear{};  // what V is compared with, at the corners
    int depth = 0;
    double bound = 0;  // of V from its own linear interpolation
    BaseDeviation base = unbounded;
};

}  // namespace prep::detail
