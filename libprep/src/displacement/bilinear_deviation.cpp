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
    TexelWalk(const HeightMapData& map, std::int64_t i0, std::int64_t j0, std::int64_t i1,
              std::int64_t j1)
        : map_(map),
          row0_(j0),
          rows_(int(j1 - j0 + 1)),
          inside_(i0 >= 0 && j0 >= 0 && i1 < map.x.size && j1 < map.y.size) {
        for (int r = 0; r < rows_; ++r) ends_[std::size_t(r)].any = false;
    }

    double largest() const { return largest_; }

    // Its points, and where it crosses rows of texels, cell by cell: what the map has where one
    // is left is what it has where the next is entered. Lines are counted, so that rounding leads
    // into no cell beyond the last.
    void edge(const Point& a, const Point& b) {
        Lines along_x(a.x, b.x), along_y(a.y, b.y);
        if (a.y == floor_of(a.y)) meet(a);
        if (b.y == floor_of(b.y)) meet(b);
        double x = along_x.cell, y = along_y.cell;
        Cell cell = this->cell(x, y);
        double before = departure(cell, a);
        see(before);
        Point from = a;
        for (;;) {
            const double next = std::min(along_x.at, along_y.at);
            const bool last = next > 1;
            const bool over_x = along_x.at <= next, over_y = along_y.at <= next;
            Point to = b;
            if (next < 1)
                to = {a.x + next * along_x.way, a.y + next * along_y.way,
                      a.value + next * (b.value - a.value)};
            if (!last && over_y) {
                to.y = along_y.line;
                meet(to);
            }
            const double after = departure(cell, to);
            see(after);
            see_between(cell, from, to, before, after);
            if (last) return;
            if (over_x) x += along_x.step, along_x.advance(a.x);
            if (over_y) y += along_y.step, along_y.advance(a.y);
            cell = this->cell(x, y);
            from = to;
            before = after;
        }
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

    // What lies between the edges.
    void rows() {
        for (int r = 0; r < rows_; ++r) {
            const Ends& e = ends_[std::size_t(r)];
            if (!e.any) continue;
            const double first = -floor_of(-e.low.x), last = floor_of(e.high.x);
            if (!(first <= last)) continue;
            const double width = e.high.x - e.low.x;
            const double slope = width > 0 ? (e.high.value - e.low.value) / width : 0;
            const std::int64_t j = row0_ + r;
            for (double x = first; x <= last; ++x) {
                const double linear = e.low.value + slope * (x - e.low.x);
                see(map_.height(texel(std::int64_t(x), j)) - linear);
            }
        }
    }

  private:
    struct Ends {
        bool any;
        Point low, high;
    };

    void see(double departure) { largest_ = std::max(largest_, std::abs(departure)); }

    void meet(const Point& p) {
        const int r = int(std::int64_t(p.y) - row0_);
        if (r < 0 || r >= rows_) return;
        Ends& e = ends_[std::size_t(r)];
        if (!e.any || p.x < e.low.x) e.low = p;
        if (!e.any || p.x > e.high.x) e.high = p;
        e.any = true;
    }

    double texel(std::int64_t i, std::int64_t j) const {
        return inside_ ? double(map_.raw[std::size_t(j * map_.x.size + i)]) : map_.texel(i, j);
    }

    // The lines between texels that an edge crosses along one axis, one after the other.
    struct Lines {
        double way, step, line, cell, inverse;
        double at;    // of the edge, where the next one is; 2: there is none
        double left;  // of them
        Lines(double from, double to) : way(to - from) {
            const bool up = way > 0;
            step = up ? 1 : -1;
            line = up ? floor_of(from) + 1 : -floor_of(-from) - 1;
            cell = way < 0 ? line : floor_of(from);
            left = up ? -floor_of(-to) - line : line - floor_of(to);
            inverse = 1 / way;
            find(from);
        }
        void advance(double from) {
            line += step;
            left -= 1;
            find(from);
        }
        // One that is left is before the end, wherever rounding has it: rows need both of their
        // meeting points.
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
    std::int64_t row0_;
    int rows_;
    bool inside_;
    double largest_ = 0;
    std::array<Ends, most_texels + 3> ends_;  // the first rows_ of them
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
        walk.rows();
    }
    return Deviation{walk.largest() + deviation_slack(map, farthest, largest), walk.largest()};
}

}  // namespace prep::detail
