// The charts of a surface in a height map: which triangles are one chart to a filter, where they
// lie and how large the surface is there.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "displacement/chart_gutters.h"
#include "displacement/height_data.h"
#include "displacement/height_field.h"

namespace prep::detail {

using MapTriangle = std::array<glm::dvec2, 3>;  // map coordinates

struct MapChart {
    std::vector<std::uint32_t> triangles;  // none: all of the map, by its wrap
    double of_uvs = 0, of_surface = 0;     // areas
    glm::dvec2 low{0.0}, high{0.0};        // in map coordinates
    // Along an axis it has texels twice, as tiles have: it goes on there by the map's wrap.
    std::array<bool, 2> wraps{};
    bool has_tiles() const { return wraps[0] || wraps[1]; }
};

// Triangles whose UVs go on across an edge that they share, and such groups where they share
// texels: stacked and mirrored halves, tiles and trims. Triangles whose UVs are not finite, or
// farther out than floats tell texels apart, are of no chart. Without triangles: one chart, of all
// of the map.
std::vector<MapChart> map_charts(const HeightMapData& map, const ChartAtlas& atlas);

// Whether the surface goes on across an edge, and its UVs with it.
bool uvs_go_on(const ChartAtlas& atlas, std::uint32_t half_edge);

MapTriangle in_map(const HeightMapData& map, const ChartAtlas& atlas, std::uint32_t triangle);

// Texels along an axis that are looked at: some, or all again and again by its wrap.
struct TexelRange {
    std::int64_t first = 0, count = 0;
    HeightAxis axis;
    bool wraps = false;
};

// Calls body(i, j) for the texels whose centres the triangle covers: those within the ranges, by
// their wrap each at least once. A triangle that spans a map often along both axes covers all.
template <class Body>
void for_covered(const MapTriangle& p, const TexelRange& x, const TexelRange& y, const Body& body) {
    constexpr double often = 4;
    const auto side = [](const TexelRange& range, double low, double high) {
        const double size = double(range.count);
        const bool few = !range.wraps || high - low < often * size;
        auto first = std::int64_t(few ? low : 0), last = std::int64_t(few ? high : size - 1);
        if (!range.wraps) {
            first = std::max(first, range.first);
            last = std::min(last, range.first + range.count - 1);
        }
        return std::pair(first, last);
    };
    const auto at = [](const TexelRange& range, std::int64_t i) {
        return range.wraps ? range.axis.texel(i) : i;
    };
    const auto by_rows = [&](const MapTriangle& t, const TexelRange& columns,
                             const TexelRange& rows, const auto& see) {
        const auto [top, bottom] = std::minmax({t[0].y, t[1].y, t[2].y});
        const auto [first, last] = side(rows, std::floor(top), std::ceil(bottom));
        for (std::int64_t j = first; j <= last; ++j) {
            const auto [left, right] = covered_in_row(t, j);
            if (left > right) continue;
            // A row that is covered once or more by repeating is covered whole.
            const bool whole = columns.wraps && right - left + 1 >= 2 * columns.count;
            const auto [from, to] = whole ? std::pair(std::int64_t(0), columns.count - 1)
                                          : side(columns, double(left), double(right));
            for (std::int64_t i = from; i <= to; ++i) see(at(columns, i), at(rows, j));
        }
    };
    const auto spans_often = [&](const TexelRange& range, glm::length_t k) {
        const auto [low, high] = std::minmax({p[0][k], p[1][k], p[2][k]});
        return range.wraps && !(high - low < often * double(range.count));
    };
    if (!spans_often(y, 1)) {
        by_rows(p, x, y, body);
    } else if (!spans_often(x, 0)) {
        MapTriangle turned = p;
        for (glm::dvec2& corner : turned) std::swap(corner.x, corner.y);
        by_rows(turned, y, x, [&](std::int64_t j, std::int64_t i) { body(i, j); });
    } else {
        for (std::int64_t j = 0; j < y.count; ++j)
            for (std::int64_t i = 0; i < x.count; ++i) body(i, j);
    }
}

}  // namespace prep::detail
