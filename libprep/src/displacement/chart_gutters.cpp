#include "displacement/chart_gutters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/disjoint_sets.h"
#include "displacement/height_data.h"

namespace prep::detail {
namespace {

constexpr double far = 0x1p50;
constexpr double on_border = 1e-9;  // texels: UVs are floats, which are coarser

// Where the triangle meets the row through texels' centres, if it does.
std::pair<double, double> crossing(const MapTriangle& p, double y) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    const auto note = [&](double x) {
        low = std::min(low, x);
        high = std::max(high, x);
    };
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 a = p[k], b = p[(k + 1) % 3];
        const auto [top, bottom] = std::minmax(a.y, b.y);
        if (y < top - on_border || y > bottom + on_border) continue;
        if (bottom - top <= 2 * on_border) {
            note(a.x);
            note(b.x);
        } else {
            const double t = std::clamp((y - a.y) / (b.y - a.y), 0.0, 1.0);
            note(a.x + t * (b.x - a.x));
        }
    }
    return {low, high};
}

class Coverage {
  public:
    explicit Coverage(const HeightMapData& map)
        : map_(map), mask_(std::size_t(map.x.size * map.y.size), 0), unset_(mask_.size()) {}

    // Whether a texel's centre lies in it.
    bool add(const std::array<glm::dvec2, 3>& uv) {
        std::array<glm::dvec2, 3> p;
        if (!place(uv, p)) return false;
        if (unset_ == 0) return true;
        const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
        const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
        if (!spans_few(map_.x, left, right) || !spans_few(map_.y, top, bottom)) {
            std::fill(mask_.begin(), mask_.end(), std::uint8_t(1));
            unset_ = 0;
            return true;
        }
        bool any = add_inside(p);
        for_parts_beyond(p, map_.x, map_.y, [&](const MapTriangle& line) {
            if (add_inside(line)) any = true;
        });
        return any;
    }

    // The texels that the triangle's border runs through.
    void add_border(const std::array<glm::dvec2, 3>& uv) {
        std::array<glm::dvec2, 3> p;
        if (!place(uv, p)) return;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 a = p[k], b = p[(k + 1) % 3];
            const double length = std::max(std::abs(b.x - a.x), std::abs(b.y - a.y));
            // Once around each axis is all that there is to a line.
            const double most = 8 * double(map_.x.size + map_.y.size) + 8;
            const auto steps = std::int64_t(std::ceil(2 * std::min(length, most))) + 1;
            for (std::int64_t s = 0; s <= steps; ++s) {
                const double t = double(s) / double(steps);
                const glm::dvec2 q = a * (1 - t) + b * t + 0.5;
                if (std::abs(q.x) < far && std::abs(q.y) < far)
                    set(index(std::int64_t(std::floor(q.x)), std::int64_t(std::floor(q.y))));
            }
        }
    }

    std::vector<std::uint8_t>& mask() { return mask_; }

  private:
    // Without what lies beyond a clamped map.
    bool add_inside(const MapTriangle& p) {
        bool any = false;
        const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
        const auto [j0, j1] = texels(map_.y, top, bottom);
        for (std::int64_t j = j0; j <= j1; ++j) {
            const auto [from, to] = crossing(p, double(j));
            const auto [i0, i1] = texels(map_.x, from, to);
            for (std::int64_t i = i0; i <= i1; ++i) set(index(i, j));
            any |= i0 <= i1;
        }
        return any;
    }
    void set(std::size_t texel) {
        unset_ -= mask_[texel] == 0;
        mask_[texel] = 1;
    }
    bool place(const std::array<glm::dvec2, 3>& uv, std::array<glm::dvec2, 3>& p) const {
        for (std::size_t k = 0; k < 3; ++k) {
            if (!std::isfinite(uv[k].x) || !std::isfinite(uv[k].y)) return false;
            p[k] = map_.map_point(uv[k]);
        }
        return true;
    }
    static bool spans_few(const HeightAxis& axis, double low, double high) {
        return axis.wrap == Wrap::clamp ||
               (high - low < 4 * double(axis.size) && std::abs(low) < far && std::abs(high) < far);
    }
    // Those whose centres lie from low to high.
    static std::pair<std::int64_t, std::int64_t> texels(const HeightAxis& axis, double low,
                                                        double high) {
        double first = std::ceil(low - on_border), last = std::floor(high + on_border);
        if (axis.wrap == Wrap::clamp) {
            const double size = double(axis.size);
            first = std::clamp(first, 0.0, size);
            last = std::clamp(last, -1.0, size - 1);
        }
        return {std::int64_t(first), std::int64_t(last)};
    }
    std::size_t index(std::int64_t i, std::int64_t j) const {
        return std::size_t(map_.y.texel(j) * map_.x.size + map_.x.texel(i));
    }

    const HeightMapData& map_;
    std::vector<std::uint8_t> mask_;
    std::size_t unset_;  // of it
};

// Neighbours by index; past the edge of a map that does not repeat there are none.
class Neighbours {
  public:
    static constexpr std::size_t none = ~std::size_t(0);
    explicit Neighbours(const HeightMapData& map) : map_(map) {}
    std::size_t operator()(std::size_t texel, int dx, int dy) const {
        const std::int64_t i = std::int64_t(texel) % map_.x.size + dx;
        const std::int64_t j = std::int64_t(texel) / map_.x.size + dy;
        if (outside(map_.x, i) || outside(map_.y, j)) return none;
        return std::size_t(map_.y.texel(j) * map_.x.size + map_.x.texel(i));
    }

  private:
    static bool outside(const HeightAxis& axis, std::int64_t i) {
        return axis.wrap != Wrap::repeat && (i < 0 || i >= axis.size);
    }
    const HeightMapData& map_;
};

constexpr int directions[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0},
                                  {1, 0},   {-1, 1}, {0, 1},  {1, 1}};

}  // namespace

std::vector<std::uint32_t> charts_of(ChartTriangles triangles) {
    std::vector<std::uint32_t> corners(triangles.size() * 3);
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = std::uint32_t(i);
    const auto key = [&](std::uint32_t corner) {
        const glm::dvec2& p = triangles[corner / 3][corner % 3];
        // One order for everything that is no number.
        return std::isfinite(p.x) && std::isfinite(p.y) ? std::pair(p.x, p.y)
                                                        : std::pair(HUGE_VAL, HUGE_VAL);
    };
    std::sort(corners.begin(), corners.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::pair(key(a), a) < std::pair(key(b), b);
    });
    DisjointSets sets(triangles.size());
    for (std::size_t i = 1; i < corners.size(); ++i)
        if (key(corners[i]) == key(corners[i - 1])) sets.unite(corners[i] / 3, corners[i - 1] / 3);
    std::vector<std::uint32_t> charts(triangles.size());
    for (std::size_t t = 0; t < charts.size(); ++t) charts[t] = sets.find(std::uint32_t(t));
    return charts;
}

bool beyond_end(const MapTriangle& p, glm::length_t k, double end, double side, MapTriangle& line) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    bool any = false;
    const auto note = [&](double at) {
        low = std::min(low, at);
        high = std::max(high, at);
    };
    for (std::size_t c = 0; c < 3; ++c) {
        const glm::dvec2 a = p[c], b = p[(c + 1) % 3];
        const double from = side * (a[k] - end), to = side * (b[k] - end);
        if (from >= 0) note(a[1 - k]);
        any |= from > 0;
        if (std::min(from, to) < 0 && std::max(from, to) > 0)
            note(glm::mix(a[1 - k], b[1 - k], from / (from - to)));
    }
    if (!any) return false;
    line[0][k] = line[1][k] = line[2][k] = end;
    line[0][1 - k] = low;
    line[1][1 - k] = line[2][1 - k] = high;
    return true;
}

std::pair<std::int64_t, std::int64_t> covered_in_row(const MapTriangle& p, std::int64_t y) {
    const auto [low, high] = std::minmax({p[0].y, p[1].y, p[2].y});
    if (double(y) < low - on_border || double(y) > high + on_border) return {0, -1};
    const auto [from, to] = crossing(p, double(y));
    return {std::int64_t(std::ceil(from - on_border)), std::int64_t(std::floor(to + on_border))};
}

std::vector<std::uint8_t> covered_texels(const HeightMapData& map, ChartTriangles charts) {
    Coverage coverage(map);
    std::vector<std::uint8_t> has_centre(charts.size());
    bool all = true;
    for (std::size_t t = 0; t < charts.size(); ++t) {
        has_centre[t] = coverage.add(charts[t]);
        all &= has_centre[t] != 0;
    }
    if (all) return std::move(coverage.mask());
    const std::vector<std::uint32_t> chart = charts_of(charts);
    std::vector<std::uint8_t> reads(charts.size(), 0);
    for (std::size_t t = 0; t < charts.size(); ++t) reads[chart[t]] |= has_centre[t];
    for (std::size_t t = 0; t < charts.size(); ++t)
        if (!reads[chart[t]]) coverage.add_border(charts[t]);
    return std::move(coverage.mask());
}

void fill_gutters(HeightMapData& map, std::vector<std::uint8_t> covered) {
    constexpr int linear_rings = 2;
    const Neighbours neighbour(map);
    constexpr std::uint8_t empty = 0, filled = 1, waiting = 2;
    const auto is_filled = [&](std::size_t t) {
        return t != Neighbours::none && covered[t] == filled;
    };
    std::vector<std::size_t> ring;
    for (std::size_t t = 0; t < covered.size(); ++t) {
        if (covered[t] != empty) continue;
        for (const auto& d : directions)
            if (is_filled(neighbour(t, d[0], d[1]))) {
                ring.push_back(t);
                break;
            }
    }
    std::vector<float> values;
    for (int number = 1; !ring.empty(); ++number) {
        values.clear();
        for (const std::size_t t : ring) {
            double near = 0, straight = 0;
            int nears = 0, straights = 0;
            for (const auto& d : directions) {
                const std::size_t a = neighbour(t, d[0], d[1]);
                if (!is_filled(a)) continue;
                near += double(map.raw[a]);
                ++nears;
                const std::size_t b = neighbour(t, 2 * d[0], 2 * d[1]);
                if (!is_filled(b)) continue;
                straight += 2 * double(map.raw[a]) - double(map.raw[b]);
                ++straights;
            }
            const bool linear = number <= linear_rings && straights > 0;
            values.push_back(float(linear ? straight / straights : near / nears));
        }
        for (std::size_t k = 0; k < ring.size(); ++k) {
            map.raw[ring[k]] = values[k];
            covered[ring[k]] = filled;
        }
        std::vector<std::size_t> next;
        for (const std::size_t t : ring)
            for (const auto& d : directions) {
                const std::size_t n = neighbour(t, d[0], d[1]);
                if (n == Neighbours::none || covered[n] != empty) continue;
                covered[n] = waiting;
                next.push_back(n);
            }
        ring = std::move(next);
    }
}

}  // namespace prep::detail
