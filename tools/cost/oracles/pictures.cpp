#include "cost/oracles/pictures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cost {
namespace {

Vector unit(const Vector& v) {
    return v / std::sqrt(dot(v, v));
}

// The part of a convex polygon where `axis` is on the given side of `limit`.
std::vector<Point2> clipped(const std::vector<Point2>& polygon, int axis, Real limit, bool below) {
    std::vector<Point2> out;
    const auto inside = [&](const Point2& p) {
        return below ? p[axis] <= limit : p[axis] >= limit;
    };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point2& a = polygon[i];
        const Point2& b = polygon[(i + 1) % polygon.size()];
        if (inside(a)) out.push_back(a);
        if (inside(a) != inside(b))
            out.push_back(a + (b - a) * ((limit - a[axis]) / (b[axis] - a[axis])));
    }
    return out;
}

Real area_of(const std::vector<Point2>& p) {
    Real sum = 0;
    for (std::size_t i = 1; i + 1 < p.size(); ++i) {
        const Point2 a = p[i] - p[0], b = p[i + 1] - p[0];
        sum += a.x * b.y - a.y * b.x;
    }
    return std::abs(sum) / 2;
}

std::int64_t bounded(Real value, std::uint32_t most) {
    return std::int64_t(std::clamp(value, Real(0), Real(most)));
}

Pixels blank(std::uint32_t width, std::uint32_t height) {
    return {width, height, 1, std::vector<double>(std::size_t(width) * height, 0.0)};
}

// at(x, y) over `side` × rows_of(y) samples of each pixel, their mean.
template <class At, class Rows>
Pixels mean_of(std::uint32_t width, std::uint32_t height, int side, const Rows& rows_of,
               const At& at) {
    Pixels out = blank(width, height);
    for (std::uint32_t y = 0; y < height; ++y) {
        const int rows = rows_of(y);
        for (std::uint32_t x = 0; x < width; ++x) {
            Real sum = 0;
            for (int j = 0; j < rows; ++j)
                for (int i = 0; i < side; ++i)
                    sum += at(Real(x) + (Real(i) + Real(0.5)) / side,
                              Real(y) + (Real(j) + Real(0.5)) / rows);
            out.values[std::size_t(y) * width + x] = double(sum / (Real(side) * rows));
        }
    }
    return out;
}

}  // namespace

Pixels exact_coverage(std::span<const Triangle2> triangles, std::uint32_t width,
                      std::uint32_t height) {
    Pixels out = blank(width, height);
    for (const Triangle2& t : triangles) {
        const auto [x0, x1] = std::minmax({t[0].x, t[1].x, t[2].x});
        const auto [y0, y1] = std::minmax({t[0].y, t[1].y, t[2].y});
        for (std::int64_t y = bounded(std::floor(y0), height); y < bounded(std::ceil(y1), height);
             ++y) {
            std::vector<Point2> row(t.begin(), t.end());
            row = clipped(clipped(row, 1, Real(y), false), 1, Real(y + 1), true);
            for (std::int64_t x = bounded(std::floor(x0), width); x < bounded(std::ceil(x1), width);
                 ++x)
                out.values[std::size_t(y) * width + std::size_t(x)] +=
                    double(area_of(clipped(clipped(row, 0, Real(x), false), 0, Real(x + 1), true)));
        }
    }
    return out;
}

Pixels sampled_coverage(std::span<const Triangle2> triangles, std::uint32_t width,
                        std::uint32_t height, int side) {
    const std::size_t columns = std::size_t(width) * std::size_t(side);
    const std::size_t rows = std::size_t(height) * std::size_t(side);
    // Rows of bits, set by the word: triangles that overlap cost a row no more than its words.
    const std::size_t words = (columns + 63) / 64;
    std::vector<std::uint64_t> covered(words * rows, 0);
    const auto cover = [&](std::size_t row, std::size_t from, std::size_t to) {
        for (std::size_t w = from / 64; w <= to / 64; ++w) {
            std::uint64_t bits = ~std::uint64_t(0);
            if (w == from / 64) bits &= ~std::uint64_t(0) << (from % 64);
            if (w == to / 64) bits &= ~std::uint64_t(0) >> (63 - to % 64);
            covered[row * words + w] |= bits;
        }
    };
    for (const Triangle2& t : triangles) {
        const auto [y0, y1] = std::minmax({t[0].y, t[1].y, t[2].y});
        const Real first = std::ceil(y0 * side - Real(0.5)),
                   last = std::floor(y1 * side - Real(0.5));
        if (!(last >= 0) || !(first < Real(rows))) continue;
        const std::size_t end = std::size_t(std::min(last, Real(rows - 1)));
        for (std::size_t row = std::size_t(std::max(first, Real(0))); row <= end; ++row) {
            const Real y = (Real(row) + Real(0.5)) / side;
            Real low = Real(width) + 1, high = -1;
            for (std::size_t k = 0; k < 3; ++k) {
                const Point2 &a = t[k], &b = t[(k + 1) % 3];
                if ((a.y <= y) == (b.y <= y)) continue;
                const Real x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
                low = std::min(low, x);
                high = std::max(high, x);
            }
            const Real from = std::max(std::ceil(low * side - Real(0.5)), Real(0));
            const Real to = std::min(std::floor(high * side - Real(0.5)), Real(columns) - 1);
            if (from <= to) cover(row, std::size_t(from), std::size_t(to));
        }
    }
    Pixels out = blank(width, height);
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column)
            if (covered[row * words + column / 64] >> (column % 64) & 1)
                out.values[row / std::size_t(side) * width + column / std::size_t(side)] += 1;
    for (double& v : out.values) v /= double(side) * side;
    return out;
}

Pixels coverage_at(std::span<const Triangle2> triangles, std::uint32_t width, std::uint32_t height,
                   std::span<const Point2> places) {
    std::vector<std::vector<bool>> hit(places.size(),
                                       std::vector<bool>(std::size_t(width) * height));
    for (const Triangle2& t : triangles) {
        const Point2 low = glm::min(glm::min(t[0], t[1]), t[2]),
                     high = glm::max(glm::max(t[0], t[1]), t[2]);
        for (std::int64_t y = bounded(low.y, height); y < bounded(high.y + 1, height); ++y)
            for (std::int64_t x = bounded(low.x, width); x < bounded(high.x + 1, width); ++x)
                for (std::size_t k = 0; k < places.size(); ++k) {
                    const Point2 p = Point2(Real(x), Real(y)) + places[k];
                    int left = 0, right = 0;
                    for (std::size_t i = 0; i < 3; ++i) {
                        const Point2 a = t[(i + 1) % 3] - t[i], b = p - t[i];
                        const Real side = a.x * b.y - a.y * b.x;
                        left += side >= 0;
                        right += side <= 0;
                    }
                    if (left == 3 || right == 3)
                        hit[k][std::size_t(y) * width + std::size_t(x)] = true;
                }
    }
    Pixels out = blank(width, height);
    for (const std::vector<bool>& one : hit)
        for (std::size_t i = 0; i < out.values.size(); ++i)
            out.values[i] += one[i] ? 1 / double(places.size()) : 0;
    return out;
}

std::vector<Point2> standard_places(int samples) {
    // Sixteenths of a pixel from its top left corner, as the standard's tables have them.
    static constexpr int one[][2] = {{8, 8}}, two[][2] = {{12, 12}, {4, 4}};
    static constexpr int four[][2] = {{6, 2}, {14, 6}, {2, 10}, {10, 14}};
    static constexpr int eight[][2] = {{9, 5},  {7, 11}, {13, 9},  {5, 3},
                                       {3, 13}, {1, 7},  {11, 15}, {15, 1}};
    static constexpr int sixteen[][2] = {{9, 9},   {7, 5},  {5, 10},  {12, 7}, {3, 6}, {10, 13},
                                         {13, 11}, {11, 3}, {6, 14},  {8, 1},  {4, 2}, {2, 12},
                                         {0, 8},   {15, 4}, {14, 15}, {1, 0}};
    std::vector<Point2> out;
    const auto take = [&](const auto& table) {
        for (const auto& [x, y] : table) out.emplace_back(Real(x) / 16, Real(y) / 16);
    };
    if (samples == 1) take(one);
    if (samples == 2) take(two);
    if (samples == 4) take(four);
    if (samples == 8) take(eight);
    if (samples == 16) take(sixteen);
    return out;
}

Pixels box_means(const Pixels& fine, std::uint32_t factor) {
    Pixels out{fine.width / factor, fine.height / factor, fine.channels, {}};
    for (std::uint32_t y = 0; y < out.height; ++y)
        for (std::uint32_t x = 0; x < out.width; ++x)
            for (std::uint32_t k = 0; k < fine.channels; ++k) {
                Real sum = 0;
                for (std::size_t j = std::size_t(y) * factor; j < (y + std::size_t(1)) * factor;
                     ++j)
                    for (std::size_t i = std::size_t(x) * factor; i < (x + std::size_t(1)) * factor;
                         ++i)
                        sum += Real(fine.values[(j * fine.width + i) * fine.channels + k]);
                out.values.push_back(double(sum / (Real(factor) * Real(factor))));
            }
    return out;
}

Pixels lit_sphere(const LitSphere& s, std::uint32_t width, std::uint32_t height, int side) {
    const Vector half_way = unit(s.towards + Vector(0, 0, 1));
    const Real scale = 2 * Real(s.half) / height;
    const auto as_many = [&](std::uint32_t) { return side; };
    return mean_of(width, height, side, as_many, [&](Real px, Real py) -> Real {
        const Real x = (px - Real(width) / 2) * scale, y = (Real(height) / 2 - py) * scale;
        const Real rest = 1 - x * x - y * y;
        if (!(rest > 0)) return 0;
        const Vector n(x, y, std::sqrt(rest));
        const Real facing = dot(n, s.towards);
        Real light = Real(s.ambient) * s.diffuse;
        if (facing > 0)
            light += s.light * (s.diffuse * facing +
                                s.specular * std::pow(std::max(dot(n, half_way), Real(0)),
                                                      Real(s.shininess)));
        return light;
    });
}

Pixels textured_plane(const TexturedPlane& s, std::uint32_t width, std::uint32_t height, int side) {
    const Real pitch = Real(s.pitch) * std::numbers::pi_v<Real> / 180;
    const Vector forward(0, -std::sin(pitch), -std::cos(pitch)), right(1, 0, 0),
        up(0, std::cos(pitch), -std::sin(pitch));
    const Real focal = 2 * std::tan(Real(s.yfov) / 2) / height;
    const Real n = Real(s.size);
    const auto texel = [&](Real x, Real y) {
        const auto wrapped = [&](Real v) { return std::size_t(v - std::floor(v / n) * n); };
        return Real(s.texels[wrapped(y) * s.size + wrapped(x)]);
    };
    // Along the middle column: how many texels a pixel is high.
    const auto depth = [&](Real py) {
        const Vector ray = forward + up * ((Real(height) / 2 - py) * focal);
        return Real(s.height) / -ray.y * ray.z * n;
    };
    const auto rows_of = [&](std::uint32_t y) {
        const Real texels = std::abs(depth(Real(y)) - depth(Real(y) + 1));
        return side * int(std::clamp(std::ceil(2 * texels / side), Real(1), Real(16)));
    };
    return mean_of(width, height, side, rows_of, [&](Real px, Real py) {
        const Vector ray = forward + right * ((px - Real(width) / 2) * focal) +
                           up * ((Real(height) / 2 - py) * focal);
        const Real t = Real(s.height) / -ray.y;
        const Real u = t * ray.x * n - Real(0.5), v = t * ray.z * n - Real(0.5);
        const Real x = std::floor(u), y = std::floor(v), a = u - x, b = v - y;
        return (texel(x, y) * (1 - a) + texel(x + 1, y) * a) * (1 - b) +
               (texel(x, y + 1) * (1 - a) + texel(x + 1, y + 1) * a) * b;
    });
}

}  // namespace cost
