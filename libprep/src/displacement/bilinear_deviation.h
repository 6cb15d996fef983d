// How far a bilinear map departs from what is linear over a small triangle: exactly, by a walk over
// its texels.
//
// In a cell of the map, bilinear minus linear is bilinear: a saddle, whose extremes lie on the
// border of the part that the triangle covers. On lines between texels it is linear from texel to
// texel. So the extremes over the triangle are among its texels and the points of its edges, where
// it is a parabola from one crossing with a line between texels to the next. Each row of texels is
// walked between its crossings with the edges, so that triangles of no area are like any other.
// Crossings are rounded; the function is continuous, so that a part of the map's range a texel, as
// the search adds it (triangle_deviation.h), is more than that moves it by.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>

#include "displacement/height_data.h"

namespace prep::detail {

// The largest |height − linear|, as it is and rounded outwards; nothing where the map is not
// bilinear, the triangle is larger than some texels, or a number is not finite. O(texels of the
// triangle).
std::optional<Deviation> bilinear_deviation(const HeightMapData& map,
                                            const std::array<glm::dvec2, 3>& uv,
                                            const std::array<double, 3>& values);

// What rounding can have moved: coordinates by some units in their last place, each of which is
// worth no more than the map's range a texel, and heights by some of theirs.
double deviation_slack(const HeightMapData& map, double largest_coordinate, double largest_value);

}  // namespace prep::detail
