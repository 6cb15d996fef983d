// Texels between the charts of an atlas, filled from the charts, so that no tap reads what a
// painter left there.
#pragma once

#include <cstdint>
#include <vector>

#include "displacement/height_field.h"

namespace prep::detail {

struct HeightMapData;

// For each triangle one that stands for its chart: triangles with a corner in common are of one.
std::vector<std::uint32_t> charts_of(ChartTriangles triangles);

// For each triangle the first one of the same UVs, where triangles cover the map several times;
// else itself.
std::vector<std::uint32_t> first_alike(const HeightMapData& map, ChartTriangles triangles);

// 1 for each texel that the charts cover (height_field.h says which those are); triangles with a
// corner in common are of one chart. Beyond the ends of a clamped map lies what its last texels
// have. Coordinates that are not finite cover nothing; a triangle that spans the map several times
// covers all of it.
std::vector<std::uint8_t> covered_texels(const HeightMapData& map, ChartTriangles charts);

// Rings around what is covered, each made from those before: the first two, which filters read,
// linearly (the mean over the eight directions of 2a − b; exact for a plane), the others as the
// mean of their neighbours. Nothing changes where nothing is covered. Needs the map's raw texels
// and axes alone.
void fill_gutters(HeightMapData& map, std::vector<std::uint8_t> covered);

}  // namespace prep::detail
