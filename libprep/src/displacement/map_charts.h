// The charts of a surface in a height map: which triangles are one chart to a filter, where they
// lie and how large the surface is there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "displacement/chart_gutters.h"
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

// Texels along an axis that are looked at: some, or all again and again by its wrap.
struct TexelRange {
    std::int64_t first = 0, count = 0;
    HeightAxis axis;
    bool wraps = false;
};

inline TexelRange all_of(const HeightAxis& axis) {
    return {0, axis.size, axis, axis.wrap != Wrap::clamp};
}

// Whether the triangle spans the range several times.
inline bool spans_often(const MapTriangle& p, const TexelRange& range, glm::length_t axis) {
    constexpr double often = 4;
    const auto [low, high] = std::minmax({p[0][axis], p[1][axis], p[2][axis]});
    return range.wraps && !(high - low < often * double(range.count));
}
// It is taken to cover all of a map then.
inline bool covers_all(const MapTriangle& p, const TexelRange& x, const TexelRange& y) {
    return spans_often(p, x, 0) && spans_often(p, y, 1);
}

// Calls see(i, j) for the texels whose centres the triangle covers, those within the ranges, by
// their wrap each at least once, until it returns true; returns whether it did. Not for triangles
// that cover all.
template <class See>
bool any_covered(const MapTriangle& p, const TexelRange& x, const TexelRange& y, const See& see) {
    const auto within = [](const TexelRange& range, std::int64_t first, std::int64_t last) {
        if (range.wraps) return std::pair(first, last);
        return std::pair(std::max(first, range.first),
                         std::min(last, range.first + range.count - 1));
    };
    const auto at = [](const TexelRange& range, std::int64_t i) {
        return range.wraps ? range.axis.texel(i) : i;
    };
    const auto by_rows = [&](const MapTriangle& t, const TexelRange& columns,
                             const TexelRange& rows, const auto& see_it) {
        const auto [top, bottom] = std::minmax({t[0].y, t[1].y, t[2].y});
        const auto [first, last] =
            within(rows, std::int64_t(std::floor(top)), std::int64_t(std::ceil(bottom)));
        for (std::int64_t j = first; j <= last; ++j) {
            auto [from, to] = covered_in_row(t, j);
            if (from > to) continue;
            if (columns.wraps && to - from + 1 >= 2 * columns.count) {
                from = 0;  // all of the row, mirrored or not
                to = columns.count - 1;
            }
            const auto [i0, i1] = within(columns, from, to);
            for (std::int64_t i = i0; i <= i1; ++i)
                if (see_it(at(columns, i), at(rows, j))) return true;
        }
        return false;
    };
    // Along the side that it spans less often.
    if (!spans_often(p, y, 1)) return by_rows(p, x, y, see);
    MapTriangle turned = p;
    for (glm::dvec2& corner : turned) std::swap(corner.x, corner.y);
    return by_rows(turned, y, x, [&](std::int64_t j, std::int64_t i) { return see(i, j); });
}
// The same for all of them.
template <class Body>
void for_covered(const MapTriangle& p, const TexelRange& x, const TexelRange& y, const Body& body) {
    any_covered(p, x, y, [&](std::int64_t i, std::int64_t j) {
        body(i, j);
        return false;
    });
}

}  // namespace prep::detail
