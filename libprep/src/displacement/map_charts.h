// The charts of a surface in a height map: which triangles are one chart to a filter, where they
// lie and how large the surface is there.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "displacement/covered_texels.h"
#include "displacement/height_data.h"
#include "displacement/height_field.h"

namespace prep::detail {

struct MapChart {
    std::vector<std::uint32_t> triangles;  // none: all of the map, by its wrap
    double of_uvs = 0, of_surface = 0;     // areas
    glm::dvec2 low{0.0}, high{0.0};        // in map coordinates
    // Along an axis it goes on by the map's wrap, as tiles do: it is larger than the map, or, where
    // the map is mirrored, beyond it.
    std::array<bool, 2> wraps{};
    bool has_tiles() const { return wraps[0] || wraps[1]; }
};

// Triangles whose UVs go on across an edge that they share, and such groups where both cover the
// centre of a texel: stacked and mirrored halves, tiles and trims. Triangles whose UVs are not
// finite, or farther out than floats tell texels apart, are of no chart. Without triangles: one
// chart, of all of the map.
std::vector<MapChart> map_charts(const HeightMapData& map, const ChartAtlas& atlas);

// Whether the surface goes on across an edge, and its UVs with it.
bool uvs_go_on(const ChartAtlas& atlas, std::uint32_t half_edge);

MapTriangle in_map(const HeightMapData& map, const ChartAtlas& atlas, std::uint32_t triangle);

}  // namespace prep::detail
