// Texels between the charts of an atlas, filled from the charts, so that no tap reads what a
// painter left there.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "displacement/height_data.h"
#include "displacement/height_field.h"

namespace prep::detail {

using MapTriangle = std::array<glm::dvec2, 3>;  // map coordinates

// For each triangle one that stands for its chart: triangles with a corner in common are of one.
std::vector<std::uint32_t> charts_of(ChartTriangles triangles);

// Texels of row y whose centres a triangle of map coordinates covers, to within rounding: from the
// first to the last, none where that is less.
std::pair<std::int64_t, std::int64_t> covered_in_row(const MapTriangle& p, std::int64_t y);

// What of the triangle lies beyond an end of axis k, its low one (side −1) or its high one (1),
// laid on that end: a triangle that is a line. False where nothing does.
bool beyond_end(const MapTriangle& p, glm::length_t k, double end, double side, MapTriangle& line);

// Calls body(line) for what lies beyond the ends of clamped axes, whose last texels are read there.
template <class Body>
void for_parts_beyond(const MapTriangle& p, const HeightAxis& x, const HeightAxis& y,
                      const Body& body) {
    const HeightAxis* const axes[2] = {&x, &y};
    for (glm::length_t k = 0; k < 2; ++k) {
        if (axes[k]->wrap != Wrap::clamp) continue;
        const HeightAxis& other = *axes[1 - k];
        for (const double side : {-1.0, 1.0}) {
            MapTriangle line;
            if (!beyond_end(p, k, side < 0 ? 0.0 : double(axes[k]->size - 1), side, line)) continue;
            if (other.wrap == Wrap::clamp)
                for (glm::dvec2& c : line)
                    c[1 - k] = std::clamp(c[1 - k], 0.0, double(other.size - 1));
            body(line);
        }
    }
}

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
