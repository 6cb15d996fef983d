// A height map without the detail that samples of a spacing cannot carry, chart by chart: what
// tessellation reads where a band limit is asked for.
//
// Each chart (map_charts.h) is continued beyond its border (chart_continuation.h) by what lies
// across its seams, or by itself, so that no other chart and no gutter is averaged in, and both
// sides of a seam that agreed before agree as well as the surface is flat over some spacings. Then
// each texel of the chart becomes what band_limit.h makes of the spacing there, about the plane
// that fits the chart best. Tiles, which have a texel several times, go on by the map's wrap
// instead.
//
// A spacing is a length of the surface, and in UVs what the chart's area there makes of it. One of
// at least 3.6 texels is filtered texel by texel; of finer ones, down to one texel, the map gets 3
// or 5 texels for each along that axis, as no coarser map carries them; what is finer than a texel
// leaves the map as it is. Of charts that are smaller than two spacings half their size is taken:
// there are no waves of that length in them.
//
// Where a chart ends at a border of a map that repeats, or its other side is not what lies a map's
// width further on, both sides no longer agree there: the map that is made is not folded along that
// axis then (unfolded_ends.h).
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "displacement/height_field.h"

namespace prep::detail {

struct HeightMapData;

struct FilteredMap {
    std::int64_t width = 0, height = 0;
    std::vector<float> raw;
    // Along an axis it is not repeated but all that its charts lie in, and some texels around.
    std::array<bool, 2> is_unfolded{};
    glm::dvec2 scale{1.0}, shift{0.0};  // in it a placed UV is scale · uv + shift
    std::vector<std::uint8_t> kept;     // HeightMapData::kept
    double change = 0;                  // the largest of a height, in the map's units
};

// Errors: limit (more than 2^28 texels).
Result<FilteredMap> filter_charts(const HeightMapData& map, const ChartAtlas& atlas,
                                  double spacing);

}  // namespace prep::detail
