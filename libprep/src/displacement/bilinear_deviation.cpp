#include "displacement/bilinear_deviation.h"

#include <algorithm>
#include <cmath>

namespace prep::detail {
namespace {

constexpr int most_texels = 32;  // a side: larger ones are searched by blocks

// std::floor of what 64 bits hold, without a call.
double floor_of(double x) {
    const auto whole = double(std::int64_t(x));
    return whole > x ? whole - 1 : whole;
}

struct Point {
    double x, y, value;
};

class TexelWalk {
  public:
    // The cells that are read lie between texels (i0, j0) and (i1, j1).
    TexelWalk(const HeightMapData& map, std::int64_t i0, std::int64_t j0, std::int64_t i1,
              std::int64_t j1)
        : map_(map), inside_(i0 >= 0 && j0 >= 0 && i1 < map.x.size && j1 < map.y.size) {}

    double largest() const { return largest_; }

    // Its points, and where it crosses the lines between texels, cell by cell: what the map has
    // where one is left is what it has where the next is entered. Lines are counted, so that
    // rounding leads into no cell beyond the last. One line a step, where two cross as well: which
    // it is is chosen, not branched on, since no branch could be foreseen.
    void edge(const Point& a, const Point& b) {
        Lines along_x(a.x, b.x), along_y(a.y, b.y);
        double x = along_x.cell, y = along_y.cell;
        Cell cell = this->cell(x, y);
        double before = departure(cell, a);
        see(before);
        Point from = a;
        for (double left = along_x.left + along_y.left; left > 0; --left) {
            const bool over_x = along_x.at <= along_y.at;
            const double t = over_x ? along_x.at : along_y.at;
            const double to_x = a.x + t * along_x.way, to_y = a.y + t * along_y.way;
            const Point to{over_x ? along_x.line : to_x, over_x ? to_y : along_y.line,
                           a.value + t * (b.value - a.value)};
            const double after = departure(cell, to);
            see(after);
            see_between(cell, from, to, before, after);
            along_x.advance(a.x, over_x);
            along_y.advance(a.y, !over_x);
            x += over_x ? along_x.step : 0;
            y += over_x ? 0 : along_y.step;
            cell = this->cell(x, y);
            from = to;
            before = after;
        }
        const double after = departure(cell, b);
        see(after);
        see_between(cell, from, b, before, after);
    }

    // Of a triangle that lies in one cell: there its edges are all, as inside there is only a
    // saddle.
    void in_cell(double x, double y, const std::array<Point, 3>& p) {
        const Cell cell = this->cell(x, y);
        const double g[3] = {departure(cell, p[0]), departure(cell, p[1]), departure(cell, p[2])};
        for (std::size_t k = 0; k < 3; ++k) {
            see(g[k]);
            see_between(cell, p[k], p[(k + 1) % 3], g[k], g[(k + 1) % 3]);
        }
    }

    // Texels between the edges, row by row: from the edge between the lowest and the highest corner
    // to one of the others. Rows along an edge are what that edge sees.
    void rows(std::array<Point, 3> p) {
        if (p[1].y < p[0].y) std::swap(p[0], p[1]);
        if (p[2].y < p[1].y) std::swap(p[1], p[2]);
        if (p[1].y < p[0].y) std::swap(p[0], p[1]);
        const double last = floor_of(p[2].y);
        for (double y = -floor_of(-p[0].y); y <= last; ++y) {
            const bool upper = y < p[1].y;
            if (!(p[2].y > p[0].y) || (!upper && !(p[2].y > p[1].y))) return;
            const Point one = at_height(p[0], p[2], y);
            const Point other = upper ? at_height(p[0], p[1], y) : at_height(p[1], p[2], y);
            row(y, one.x < other.x ? one : other, one.x < other.x ? other : one);
        }
    }

  private:
    static Point at_height(const Point& a, const Point& b, double y) {
        const double t = (y - a.y) / (b.y - a.y);
        return {a.x + t * (b.x - a.x), y, a.value + t * (b.value - a.value)};
    }

    void row(double y, const Point& low, const Point& high) {
        const double first = -floor_of(-low.x), last = floor_of(high.x);
        if (!(first <= last)) return;
        const double width = high.x - low.x;
        const double slope = width > 0 ? (high.value - low.value) / width : 0;
        for (double x = first; x <= last; ++x)
            see(map_.height(texel(std::int64_t(x), std::int64_t(y))) -
                (low.value + slope * (x - low.x)));
    }

    void see(double departure) { largest_ = std::max(largest_, std::abs(departure)); }

    double texel(std::int64_t i, std::int64_t j) const {
        return inside_ ? double(map_.raw[std::size_t(j * map_.x.size + i)]) : map_.texel(i, j);
    }

    // The lines between texels that an edge crosses along one axis, one after the other.
    struct Lines {
        double way, step, line, cell, inverse;
        double left;  // of them
        double at;    // of the edge, where the next one is; 2: there is none
        Lines(double from, double to) : way(to - from) {
            const bool up = way > 0;
            step = up ? 1 : -1;
            line = up ? floor_of(from) + 1 : -floor_of(-from) - 1;
            cell = way < 0 ? line : floor_of(from);
            left = std::max(0.0, up ? -floor_of(-to) - line : line - floor_of(to));
            inverse = 1 / way;
            find(from);
        }
        void advance(double from, bool crossed) {
            line += crossed ? step : 0;
            left -= crossed ? 1 : 0;
            find(from);
        }
        // One that is left is before the end, wherever rounding has it.
        void find(double from) { at = left > 0 ? std::min((line - from) * inverse, 1.0) : 2; }
    };

    // c0 + cx x + cy y + cxy x y, from its first texel; of equal texels that itself.
    struct Cell {
        double x, y, c0, cx, cy, cxy;
    };
    Cell cell(double x, double y) const {
        const auto i = std::int64_t(x), j = std::int64_t(y);
        double t[4];
        if (inside_) {
            const float* const row = map_.raw.data() + (j * map_.x.size + i);
            const float* const next = row + map_.x.size;
            t[0] = double(row[0]), t[1] = double(row[1]);
            t[2] = double(next[0]), t[3] = double(next[1]);
        } else {
            load_texels(map_, i, j, 2, 2, t);
        }
        return {x, y, t[0], t[1] - t[0], t[2] - t[0], (t[3] - t[2]) - (t[1] - t[0])};
    }
    double departure(const Cell& c, const Point& p) const {
        const double x = p.x - c.x, y = p.y - c.y;
        return map_.height(c.c0 + (x * c.cx + y * (c.cy + x * c.cxy))) - p.value;
    }

    // A piece of an edge that lies in one cell, with its departures at the ends.
    void see_between(const Cell& cell, const Point& a, const Point& b, double g0, double g1) {
        const double bend = map_.unit * cell.cxy * (b.x - a.x) * (b.y - a.y);
        const double slope = g1 - g0 - bend;
        // g0 + slope t + bend t², level at t = −slope/(2 bend), where that lies on the piece.
        if (bend == 0 || slope * bend > 0 || std::abs(slope) > 2 * std::abs(bend)) return;
        see(g0 - slope * slope / (4 * bend));
    }

    const HeightMapData& map_;
    bool inside_;
    double largest_ = 0;
};

}  // namespace

double deviation_slack(const HeightMapData& map, double largest_coordinate, double largest_value) {
    const HeightBlock& all = map.pyramid.levels.back().blocks[0];
    const double range = std::abs(map.unit) * (double(all.high) - double(all.low));
    const double height =
        std::max(std::abs(map.height(double(all.low))), std::abs(map.height(double(all.high))));
    // Raw heights that the mid-level nearly takes away are interpolated before it does; where all
    // are the same, interpolation gives that.
    const double raw = range > 0 ? std::abs(map.unit) * std::max(std::abs(double(all.low)),
                                                                 std::abs(double(all.high)))
                                 : 0;
    return (largest_value + height + raw) * 0x1p-47 +
           range * std::max(1.0, largest_coordinate) * 0x1p-48;
}

std::optional<Deviation> bilinear_deviation(const HeightMapData& map,
                                            const std::array<glm::dvec2, 3>& uv,
                                            const std::array<double, 3>& values) {
    if (map.taps() != 2) return std::nullopt;
    std::array<Point, 3> p;
    double largest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (!std::isfinite(uv[k].x) || !std::isfinite(uv[k].y) || !std::isfinite(values[k]))
            return std::nullopt;
        const glm::dvec2 at = map.map_point(uv[k]);
        p[k] = {at.x, at.y, values[k]};
        largest = std::max(largest, std::abs(values[k]));
    }
    const auto [x0, x1] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [y0, y1] = std::minmax({p[0].y, p[1].y, p[2].y});
    const double farthest = std::max({-x0, x1, -y0, y1});
    constexpr double most_coordinate = 0x1p40;  // cells are whole numbers there
    if (x1 - x0 > most_texels || y1 - y0 > most_texels || farthest > most_coordinate)
        return std::nullopt;
    const double x = floor_of(x0), y = floor_of(y0);
    TexelWalk walk(map, std::int64_t(x), std::int64_t(y), std::int64_t(floor_of(x1)) + 1,
                   std::int64_t(floor_of(y1)) + 1);
    if (x1 <= x + 1 && y1 <= y + 1) {
        walk.in_cell(x, y, p);
    } else {
        for (std::size_t k = 0; k < 3; ++k) walk.edge(p[k], p[(k + 1) % 3]);
        walk.rows(p);
    }
    return Deviation{walk.largest() + deviation_slack(map, farthest, largest), walk.largest()};
}

}  // namespace prep::detail
