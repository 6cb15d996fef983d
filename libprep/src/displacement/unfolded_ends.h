// A filtered map that repeats, laid out flat where its charts do not go on by its wrap.
//
// A filter continues each chart by its own surface. Where that ends at the border of a map that
// repeats, or goes on elsewhere, the texels on both sides of the border are no longer those of one
// surface, and what is read within half a texel of it (bicubic: one and a half) is a cliff between
// them. Along such an axis the map becomes all that its charts lie in, one chart after the other as
// their UVs have them, and some texels around, which are gutters (chart_gutters.h), but for those
// beside edges where the surface does go on by the wrap: these have the texels from there.
#pragma once

#include <span>

#include "displacement/chart_filter.h"
#include "displacement/map_charts.h"

namespace prep::detail {

struct FoldedChart {
    const MapChart* of = nullptr;
    bool is_filtered = false;  // else it is read as the map was
};

// An axis stays as it is where no chart's end is read together with another texel of a chart; where
// what charts lie in is more than twice the map along it; and for all where that makes more than
// 2^28 texels or a triangle is of no chart. Depends on the charts and the map's axes alone, so the
// channels of a vector map stay alike.
void unfold_ends(const HeightMapData& map, const ChartAtlas& atlas,
                 std::span<const FoldedChart> charts, FilteredMap& made);

}  // namespace prep::detail
