// Which texels a triangle covers: those whose centres lie in it or, to within rounding, on its
// border.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "displacement/height_data.h"

namespace prep::detail {

using MapTriangle = std::array<glm::dvec2, 3>;  // map coordinates

// Beyond it there is no texel, and none of a clamped map's.
inline std::int64_t whole(double place) {
    constexpr double far = 0x1p60;
    return std::int64_t(std::clamp(place, -far, far));
}

// Texels of row y, from the first to the last; none where that is less.
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

// Calls see(run, j, turned) for the runs of texels that the triangle covers, those within the
// ranges, by their wrap each at least once, until it returns true; returns whether it did. A run is
// the texels from run.first to run.second of row j or, turned, of column j. Not for triangles that
// cover all.
template <class See>
bool any_run(const MapTriangle& p, const TexelRange& x, const TexelRange& y, const See& see) {
    const auto within = [](const TexelRange& range, std::int64_t first, std::int64_t last) {
        if (range.wraps) return std::pair(first, last);
        return std::pair(std::max(first, range.first),
                         std::min(last, range.first + range.count - 1));
    };
    const auto by_rows = [&](const MapTriangle& t, const TexelRange& columns,
                             const TexelRange& rows, bool turned) {
        const auto see_it = [&](std::int64_t from, std::int64_t to, std::int64_t j) {
            return see(std::pair(from, to), rows.wraps ? rows.axis.texel(j) : j, turned);
        };
        const auto [top, bottom] = std::minmax({t[0].y, t[1].y, t[2].y});
        const auto [first, last] = within(rows, whole(std::floor(top)), whole(std::ceil(bottom)));
        for (std::int64_t j = first; j <= last; ++j) {
            auto [from, to] = covered_in_row(t, j);
            if (from > to) continue;
            if (columns.wraps && to - from + 1 >= 2 * columns.count) {
                from = 0;  // all of the row, mirrored or not
                to = columns.count - 1;
            }
            auto [i, end] = within(columns, from, to);
            while (i <= end) {
                if (!columns.wraps) {
                    if (see_it(i, end, j)) return true;
                    break;
                }
                // Up to where the map begins again, or turns around.
                const std::int64_t size = columns.axis.size;
                const std::int64_t in_tile = ((i % size) + size) % size;
                const std::int64_t last_in_tile = std::min(end, i - in_tile + size - 1);
                const auto [a, b] =
                    std::minmax({columns.axis.texel(i), columns.axis.texel(last_in_tile)});
                if (see_it(a, b, j)) return true;
                i = last_in_tile + 1;
            }
        }
        return false;
    };
    // Along the side that it spans less often.
    if (!spans_often(p, y, 1)) return by_rows(p, x, y, false);
    MapTriangle turned = p;
    for (glm::dvec2& corner : turned) std::swap(corner.x, corner.y);
    return by_rows(turned, y, x, true);
}

// Runs of texels that were looked at, of rows and of columns within two ranges.
class SeenTexels {
  public:
    SeenTexels(const TexelRange& x, const TexelRange& y)
        : first_column_(x.first),
          first_row_(y.first),
          columns_(std::size_t(std::max<std::int64_t>(x.count, 0))),
          rows_(std::size_t(std::max<std::int64_t>(y.count, 0))) {}

    // Calls see(i) for the texels of a run that are new, and for one of each run that it meets: so
    // triangles that lie over each other take the time of one. Short runs are looked at as they
    // are.
    template <class See>
    void look(const std::pair<std::int64_t, std::int64_t>& run, std::int64_t row, bool turned,
              const See& see) {
        constexpr std::int64_t is_short = 16;
        const auto [first, last] = run;
        std::vector<std::pair<std::int64_t, std::int64_t>>& runs =
            turned ? columns_[std::size_t(row - first_column_)]
                   : rows_[std::size_t(row - first_row_)];
        const auto begin = std::partition_point(
            runs.begin(), runs.end(), [first = first](const auto& r) { return r.second < first; });
        if (begin != runs.end() && begin->first <= first && last <= begin->second)
            return see(first);
        if (last - first < is_short) {
            for (std::int64_t i = first; i <= last; ++i) see(i);
            return;
        }
        auto end = begin;
        std::int64_t next = first;
        for (; end != runs.end() && end->first <= last; ++end) {
            for (; next < end->first; ++next) see(next);
            see(next);
            next = end->second + 1;
        }
        for (; next <= last; ++next) see(next);
        if (begin == end) {
            runs.insert(begin, run);
            return;
        }
        *begin = {std::min(first, begin->first), std::max(last, std::prev(end)->second)};
        runs.erase(std::next(begin), end);
    }

  private:
    std::int64_t first_column_, first_row_;
    std::vector<std::vector<std::pair<std::int64_t, std::int64_t>>> columns_, rows_;
};

// Calls body(i, j) for the texels whose centres the triangle covers, but for those that `seen` has:
// for one of each run of those. Returns whether there are any. Not for triangles that cover all.
template <class Body>
bool for_covered(const MapTriangle& p, const TexelRange& x, const TexelRange& y, SeenTexels& seen,
                 const Body& body) {
    bool any = false;
    any_run(p, x, y,
            [&](const std::pair<std::int64_t, std::int64_t>& run, std::int64_t row, bool turned) {
                any = true;
                seen.look(run, row, turned,
                          [&](std::int64_t i) { turned ? body(row, i) : body(i, row); });
                return false;
            });
    return any;
}
// The same, and those that are read from beyond the ends of clamped axes.
template <class Body>
bool for_read(const MapTriangle& p, const TexelRange& x, const TexelRange& y, SeenTexels& seen,
              const Body& body) {
    bool any = for_covered(p, x, y, seen, body);
    for_parts_beyond(p, x.axis, y.axis, [&](const MapTriangle& line) {
        if (for_covered(line, x, y, seen, body)) any = true;
    });
    return any;
}

}  // namespace prep::detail
