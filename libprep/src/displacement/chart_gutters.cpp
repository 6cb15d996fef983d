#include "displacement/chart_gutters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>

#include "base/disjoint_sets.h"
#include "base/step_count.h"
#include "displacement/covered_texels.h"
#include "displacement/height_data.h"

namespace prep::detail {
namespace {

constexpr double far = 0x1p50;

class Coverage {
  public:
    explicit Coverage(const HeightMapData& map)
        : map_(map),
          x_(all_of(map.x)),
          y_(all_of(map.y)),
          mask_(std::size_t(map.x.size * map.y.size), 0),
          unset_(mask_.size()),
          seen_(x_, y_) {}
    ~Coverage() { count_steps(steps_); }
    Coverage(const Coverage&) = delete;
    Coverage& operator=(const Coverage&) = delete;

    // Whether a texel's centre lies in it.
    bool add(const MapTriangle& uv) {
        MapTriangle p;
        if (!place(uv, p)) return false;
        if (unset_ == 0) return true;
        const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
        const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
        if (!spans_few(map_.x, left, right) || !spans_few(map_.y, top, bottom)) {
            std::fill(mask_.begin(), mask_.end(), std::uint8_t(1));
            unset_ = 0;
            return true;
        }
        return for_read(p, x_, y_, seen_, [&](std::int64_t i, std::int64_t j) {
            set(std::size_t(j * map_.x.size + i));
        });
    }

    // The texels that the triangle's border runs through.
    void add_border(const MapTriangle& uv) {
        MapTriangle p;
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
    void set(std::size_t texel) {
        ++steps_;
        unset_ -= mask_[texel] == 0;
        mask_[texel] = 1;
    }
    bool place(const MapTriangle& uv, MapTriangle& p) const {
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
    std::size_t index(std::int64_t i, std::int64_t j) const {
        return std::size_t(map_.y.texel(j) * map_.x.size + map_.x.texel(i));
    }

    const HeightMapData& map_;
    const TexelRange x_, y_;
    std::vector<std::uint8_t> mask_;
    std::size_t unset_;  // of it
    SeenTexels seen_;
    std::uint64_t steps_ = 0;  // texels looked at
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

std::vector<std::uint32_t> first_alike(const HeightMapData& map, ChartTriangles triangles) {
    constexpr double several = 4;
    std::vector<std::uint32_t> first(triangles.size()), order;
    std::iota(first.begin(), first.end(), 0U);
    double texels = 0;
    for (const MapTriangle& uv : triangles) {
        const glm::dvec2 a = map.map_point(uv[1]) - map.map_point(uv[0]);
        const glm::dvec2 b = map.map_point(uv[2]) - map.map_point(uv[0]);
        texels += 0.5 * std::abs(a.x * b.y - a.y * b.x);
    }
    if (!(texels > several * double(map.x.size) * double(map.y.size))) return first;
    order = first;
    // By their bits: what is no number has an order as well.
    const auto compare = [&](std::uint32_t a, std::uint32_t b) {
        return std::memcmp(&triangles[a], &triangles[b], sizeof(MapTriangle));
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const int order_of = compare(a, b);
        return order_of != 0 ? order_of < 0 : a < b;
    });
    for (std::size_t k = 1; k < order.size(); ++k)
        if (compare(order[k - 1], order[k]) == 0) first[order[k]] = first[order[k - 1]];
    return first;
}

std::vector<std::uint8_t> covered_texels(const HeightMapData& map, ChartTriangles charts) {
    Coverage coverage(map);
    std::vector<std::uint8_t> has_centre(charts.size());
    const std::vector<std::uint32_t> first = first_alike(map, charts);
    bool all = true;
    for (std::size_t t = 0; t < charts.size(); ++t) {
        has_centre[t] = first[t] == t ? coverage.add(charts[t]) : has_centre[first[t]] != 0;
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
