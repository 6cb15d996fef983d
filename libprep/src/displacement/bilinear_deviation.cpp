#include "displacement/bilinear_deviation.h"

#include <algorithm>
#include <cmath>

namespace prep::detail {
namespace {

constexpr int most_texels = 32;  // a side: larger ones are searched by blocks

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

    // Its points, and where it crosses rows of texels.
    void edge(const Point& a, const Point& b) {
        const double dx = b.x - a.x, dy = b.y - a.y;
        const double step_x = dx > 0 ? 1 : -1, step_y = dy > 0 ? 1 : -1;
        // The next lines between texels, strictly further on.
        double line_x = dx > 0 ? std::floor(a.x) + 1 : std::ceil(a.x) - 1;
        double line_y = dy > 0 ? std::floor(a.y) + 1 : std::ceil(a.y) - 1;
        const auto reached = [](double line, double from, double by) {
            return by == 0 ? 2.0 : (line - from) / by;
        };
        double at_x = reached(line_x, a.x, dx), at_y = reached(line_y, a.y, dy);
        if (a.y == std::floor(a.y)) meet(a);
        if (b.y == std::floor(b.y)) meet(b);
        double s = 0;
        Point from = a;
        while (s < 1) {
            const double next = std::min({at_x, at_y, 1.0});
            Point to = b;
            if (next < 1)
                to = {a.x + next * dx, a.y + next * dy, a.value + next * (b.value - a.value)};
            if (next < 1 && at_y <= next) {
                to.y = line_y;
                meet(to);
            }
            if (at_x <= next) at_x = reached(line_x += step_x, a.x, dx);
            if (at_y <= next) at_y = reached(line_y += step_y, a.y, dy);
            within_cell(from, to);
            from = to;
            s = next;
        }
    }

    // What lies between the edges.
    void rows() {
        for (int r = 0; r < rows_; ++r) {
            const Ends& e = ends_[std::size_t(r)];
            const double first = std::ceil(e.low.x), last = std::floor(e.high.x);
            if (!e.any || !(first <= last)) continue;
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

    // A piece of an edge that lies in one cell.
    void within_cell(const Point& a, const Point& b) {
        const double cx = std::floor(0.5 * (a.x + b.x)), cy = std::floor(0.5 * (a.y + b.y));
        const auto i = std::int64_t(cx), j = std::int64_t(cy);
        const double t[4] = {texel(i, j), texel(i + 1, j), texel(i, j + 1), texel(i + 1, j + 1)};
        const double g0 = map_.height(bilinear(t, a.x - cx, a.y - cy)) - a.value;
        const double g1 = map_.height(bilinear(t, b.x - cx, b.y - cy)) - b.value;
        see(g0);
        see(g1);
        const double bend = map_.unit * ((t[0] - t[1]) - (t[2] - t[3])) * (b.x - a.x) * (b.y - a.y);
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
    TexelWalk walk(map, std::int64_t(std::floor(x0)), std::int64_t(std::floor(y0)),
                   std::int64_t(std::floor(x1)) + 1, std::int64_t(std::floor(y1)) + 1);
    for (std::size_t k = 0; k < 3; ++k) walk.edge(p[k], p[(k + 1) % 3]);
    walk.rows();
    return Deviation{walk.largest() + deviation_slack(map, farthest, largest), walk.largest()};
}

}  // namespace prep::detail
