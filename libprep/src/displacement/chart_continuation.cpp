#include "displacement/chart_continuation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"

namespace prep::detail {
namespace {

constexpr double far_from_singular = 1e-6;

double squared(const glm::dvec2& v) {
    return glm::dot(v, v);
}

double squared_distance(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
    const glm::dvec2 edge = b - a;
    const double all = squared(edge);
    const double t = all > 0 ? std::clamp(glm::dot(p - a, edge) / all, 0.0, 1.0) : 0.0;
    return squared(p - a - t * edge);
}

// A chart's texels, and what continues them.
class Continuation {
  public:
    Continuation(ChartTexels& texels, const ChartAtlas& atlas, std::span<const ChartBorder> borders,
                 const ReadAcross& read, const glm::dvec2& spacing)
        : in_(texels),
          heights_(texels.heights),
          covered_(texels.covered),
          atlas_(atlas),
          borders_(borders),
          read_(read),
          nearest_(covered_.size(), none),
          border_(covered_.size(), none) {
        reach_x_ = std::max<std::int64_t>(2, std::int64_t(std::ceil(2 * spacing.x)));
        reach_y_ = std::max<std::int64_t>(2, std::int64_t(std::ceil(2 * spacing.y)));
        mark_borders();
        find_nearest();
    }

    void fill(int threads) {
        // Planes where something is continued from.
        std::vector<std::uint32_t> last;
        for (std::size_t t = 0; t < nearest_.size(); ++t)
            if (!covered_[t] && nearest_[t] != none) last.push_back(nearest_[t]);
        std::sort(last.begin(), last.end());
        last.erase(std::unique(last.begin(), last.end()), last.end());
        std::vector<glm::dvec2> slopes(last.size());
        parallel_blocks(last.size(), 64, threads, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) slopes[k] = slope_at(last[k]);
        });
        parallel_blocks(nearest_.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                if (covered_[t] || nearest_[t] == none) continue;
                if (const auto across = this->across(t)) {
                    heights_[t] = float(*across);
                    continue;
                }
                const auto at = std::lower_bound(last.begin(), last.end(), nearest_[t]);
                heights_[t] = continued(t, slopes[std::size_t(at - last.begin())]);
            }
        });
    }

  private:
    static constexpr std::uint32_t none = 0xffffffff;
    struct Place {
        std::int64_t i, j;
    };
    Place place(std::size_t texel) const {
        return {std::int64_t(texel) % in_.width, std::int64_t(texel) / in_.width};
    }
    std::int64_t apart(std::size_t a, std::size_t b) const {
        const Place p = place(a), q = place(b);
        return (p.i - q.i) * (p.i - q.i) + (p.j - q.j) * (p.j - q.j);
    }

    glm::dvec2 centre(std::size_t texel) const {
        const Place p = place(texel);
        return {double(p.i), double(p.j)};
    }
    double from_border(std::size_t texel, std::uint32_t border) const {
        return squared_distance(centre(texel), borders_[border].begin(), borders_[border].end());
    }
    void note_border(std::size_t texel, std::uint32_t border) {
        std::uint32_t& known = border_[texel];
        if (known == none || from_border(texel, border) < from_border(texel, known)) known = border;
    }

    // Of the texels that borders run through, and those around.
    void mark_borders() {
        for (std::uint32_t b = 0; b < borders_.size(); ++b) {
            const glm::dvec2 from = borders_[b].begin(), to = borders_[b].end();
            const auto [first, last] = part_inside(from, to);
            if (!(first <= last)) continue;
            const double length = std::max(std::abs(to.x - from.x), std::abs(to.y - from.y));
            const auto steps = std::int64_t(std::ceil(2 * length * (last - first))) + 1;
            for (std::int64_t s = 0; s <= steps; ++s) {
                const double t = glm::mix(first, last, double(s) / double(steps));
                const glm::dvec2 at = glm::mix(from, to, t) + 0.5;
                const auto i = std::int64_t(std::floor(at.x)), j = std::int64_t(std::floor(at.y));
                if (i < 0 || j < 0 || i >= in_.width || j >= in_.height) continue;
                const auto texel = std::size_t(j * in_.width + i);
                note_border(texel, b);
                for_neighbours(texel, [&](std::size_t n) { note_border(n, b); });
            }
        }
    }
    // From where to where a line runs within a texel of the rectangle (Liang and Barsky 1984): a
    // border may be longer than there is time for.
    std::pair<double, double> part_inside(const glm::dvec2& from, const glm::dvec2& to) const {
        double first = 0, last = 1;
        const glm::dvec2 size(double(in_.width), double(in_.height));
        for (glm::length_t k = 0; k < 2; ++k) {
            const double way = to[k] - from[k];
            const double low = -1.0 - from[k], high = size[k] - from[k];
            if (way == 0) {
                if (low > 0 || high < 0) return {1, 0};
                continue;
            }
            first = std::max(first, std::min(low / way, high / way));
            last = std::min(last, std::max(low / way, high / way));
        }
        return {first, last};
    }

    // The height across the nearest border, where there is one: a mean that fades out a texel away.
    std::optional<double> across(std::size_t texel) const {
        if (border_[texel] == none) return std::nullopt;
        const ChartBorder& border = borders_[border_[texel]];
        const int samples = border.samples;
        if (samples == 1) return across(border, centre(texel));
        double weights = 0, all = 0, sum = 0;
        for (int j = 0; j < samples; ++j)
            for (int i = 0; i < samples; ++i) {
                const glm::dvec2 off =
                    2.0 * (glm::dvec2(double(i), double(j)) + 0.5) / double(samples) - 1.0;
                const double weight = (1 - std::abs(off.x)) * (1 - std::abs(off.y));
                all += weight;
                const auto height = across(border, centre(texel) + off);
                if (!height) continue;
                weights += weight;
                sum += weight * *height;
            }
        if (!(weights > 0.5 * all)) return std::nullopt;
        return sum / weights;
    }
    std::optional<double> across(const ChartBorder& border, const glm::dvec2& at) const {
        const std::array<glm::dvec2, 3>& p = border.triangle;
        const glm::dvec2 a = p[1] - p[0], b = p[2] - p[0], d = at - p[0];
        const double area = a.x * b.y - a.y * b.x;
        if (!(std::abs(area) > far_from_singular * std::sqrt(squared(a) * squared(b))))
            return std::nullopt;
        const double y = (d.x * b.y - d.y * b.x) / area, z = (a.x * d.y - a.y * d.x) / area;
        const auto there = across_edge(atlas_, border.half_edge, {1 - y - z, y, z});
        if (!there) return std::nullopt;
        return read_(at, *there);
    }

    // Ring by ring, each texel from its neighbours' nearest, of texels and borders.
    void find_nearest() {
        std::vector<std::uint32_t> ring, next;
        for (std::size_t t = 0; t < nearest_.size(); ++t)
            if (covered_[t]) {
                nearest_[t] = std::uint32_t(t);
                ring.push_back(std::uint32_t(t));
            }
        std::vector<std::uint8_t> waits(nearest_.size(), 0);
        while (!ring.empty()) {
            next.clear();
            for (const std::uint32_t t : ring)
                for_neighbours(t, [&](std::size_t n) {
                    if (nearest_[n] != none || waits[n]) return;
                    waits[n] = 1;
                    next.push_back(std::uint32_t(n));
                });
            std::vector<std::uint32_t> found(next.size(), none);
            for (std::size_t k = 0; k < next.size(); ++k)
                for_neighbours(next[k], [&](std::size_t n) {
                    if (nearest_[n] == none) return;
                    if (border_[n] != none) note_border(next[k], border_[n]);
                    if (found[k] == none || apart(next[k], nearest_[n]) < apart(next[k], found[k]))
                        found[k] = nearest_[n];
                });
            for (std::size_t k = 0; k < next.size(); ++k) nearest_[next[k]] = found[k];
            std::swap(ring, next);
        }
    }
    template <class Body>
    void for_neighbours(std::size_t texel, const Body& body) const {
        const Place p = place(texel);
        for (std::int64_t dj = -1; dj <= 1; ++dj)
            for (std::int64_t di = -1; di <= 1; ++di) {
                const std::int64_t i = p.i + di, j = p.j + dj;
                if ((di != 0 || dj != 0) && i >= 0 && j >= 0 && i < in_.width && j < in_.height)
                    body(std::size_t(j * in_.width + i));
            }
    }

    // Of the plane that fits the chart's heights around a texel best, nearer ones for more.
    glm::dvec2 slope_at(std::size_t texel) const {
        constexpr std::int64_t most_steps = 8;  // to each side: further ones in steps
        const Place p = place(texel);
        const std::int64_t step_x = std::max<std::int64_t>(1, reach_x_ / most_steps);
        const std::int64_t step_y = std::max<std::int64_t>(1, reach_y_ / most_steps);
        PlaneFit fit;
        for (std::int64_t dj = -reach_y_ / step_y * step_y; dj <= reach_y_; dj += step_y)
            for (std::int64_t di = -reach_x_ / step_x * step_x; di <= reach_x_; di += step_x) {
                const std::int64_t i = p.i + di, j = p.j + dj;
                if (i < 0 || j < 0 || i >= in_.width || j >= in_.height) continue;
                const auto other = std::size_t(j * in_.width + i);
                if (!covered_[other]) continue;
                const glm::dvec2 d{double(di), double(dj)};
                const glm::dvec2 part = d / glm::dvec2(double(reach_x_), double(reach_y_));
                fit.add(d, double(heights_[other]) - double(heights_[texel]),
                        std::max(0.0, 1 - 0.5 * glm::dot(part, part)));
            }
        return fit.slope();
    }

    float continued(std::size_t texel, const glm::dvec2& slope) const {
        const Place p = place(texel), b = place(nearest_[texel]);
        const std::int64_t mi = 2 * b.i - p.i, mj = 2 * b.j - p.j;
        const glm::dvec2 d{double(p.i - b.i), double(p.j - b.j)};
        const bool inside = mi >= 0 && mj >= 0 && mi < in_.width && mj < in_.height &&
                            covered_[std::size_t(mj * in_.width + mi)];
        if (!inside) return float(double(heights_[nearest_[texel]]) + glm::dot(slope, d));
        return float(double(heights_[std::size_t(mj * in_.width + mi)]) + 2 * glm::dot(slope, d));
    }

    const ChartTexels& in_;
    std::vector<float>& heights_;
    const std::vector<std::uint8_t>& covered_;
    const ChartAtlas& atlas_;
    std::span<const ChartBorder> borders_;
    const ReadAcross& read_;
    std::vector<std::uint32_t> nearest_;  // covered texel
    std::vector<std::uint32_t> border_;   // nearest one
    std::int64_t reach_x_, reach_y_;
};

}  // namespace

std::optional<AtlasPoint> across_edge(const ChartAtlas& atlas, std::uint32_t half_edge,
                                      const glm::dvec3& weights) {
    constexpr int most_steps = 256;
    constexpr double inside = -1e-9;
    const auto corner = [&](std::uint32_t h) -> glm::dvec2 {
        const FlatTriangle& t = atlas.flat[h / 3];
        return h % 3 == 0   ? glm::dvec2(0.0)
               : h % 3 == 1 ? glm::dvec2(t.length, 0)
                            : glm::dvec2(t.along, t.height);
    };
    const auto next = [](std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; };
    glm::dvec3 w = weights;
    for (int step = 0; step < most_steps; ++step) {
        // Beyond the edge, its opposite corner's weight is negative.
        if (!(w[glm::length_t(next(next(half_edge)) % 3)] <= 0)) return std::nullopt;
        const std::uint32_t other = atlas.across[half_edge], first = half_edge / 3 * 3;
        if (other == no_index) return std::nullopt;
        const glm::dvec2 at =
            w.x * corner(first) + w.y * corner(first + 1) + w.z * corner(first + 2);
        // Along the edge and away from it, which then is into the other triangle.
        const glm::dvec2 from = corner(half_edge), edge = corner(next(half_edge)) - from;
        const double length = glm::length(edge);
        if (!(length > 0)) return std::nullopt;
        const double along = glm::dot(at - from, edge) / length;
        const double away = std::abs(edge.x * (at.y - from.y) - edge.y * (at.x - from.x)) / length;
        const bool same = atlas.same_way[half_edge] != 0;
        const glm::dvec2 begin = corner(same ? other : next(other));
        const glm::dvec2 way = corner(same ? next(other) : other) - begin;
        const glm::dvec2 direction = way / glm::length(way);
        // Counter-clockwise triangles lie to the left of their half-edges.
        const glm::dvec2 left = glm::dvec2(-direction.y, direction.x) * (same ? 1.0 : -1.0);
        const glm::dvec2 there = begin + along * direction + away * left;
        const FlatTriangle& flat = atlas.flat[other / 3];
        if (!(flat.height > 0) || !(flat.length > 0)) return std::nullopt;
        const double z = there.y / flat.height, y = (there.x - z * flat.along) / flat.length;
        w = {1 - y - z, y, z};
        if (!std::isfinite(w.x) || !std::isfinite(w.y)) return std::nullopt;
        glm::length_t least = 0;
        for (glm::length_t k = 1; k < 3; ++k)
            if (w[k] < w[least]) least = k;
        if (w[least] >= inside) return AtlasPoint{other / 3, w};
        half_edge = other / 3 * 3 + std::uint32_t(least + 1) % 3;
        if (half_edge == other) return std::nullopt;
    }
    return std::nullopt;
}

void PlaneFit::add(const glm::dvec2& at, double height, double weight) {
    weights_ += weight;
    places_ += weight * at;
    heights_ += weight * height;
    squares_ += weight * glm::outerProduct(at, at);
    with_heights_ += weight * height * at;
}

glm::dvec2 PlaneFit::slope() const {
    if (!(weights_ > 0)) return glm::dvec2(0.0);
    const glm::dmat2 squares = squares_ - glm::outerProduct(places_, places_) / weights_;
    const glm::dvec2 with_heights = with_heights_ - places_ * (heights_ / weights_);
    const double trace = squares[0][0] + squares[1][1];
    const double determinant = squares[0][0] * squares[1][1] - squares[0][1] * squares[1][0];
    if (!(trace > 0)) return glm::dvec2(0.0);
    if (determinant > far_from_singular * trace * trace)
        return glm::inverse(squares) * with_heights;
    // A line's direction is any column of its squares that is not nothing.
    const glm::dvec2 column = squares[0][0] > squares[1][1] ? squares[0] : squares[1];
    const glm::dvec2 along = column / glm::length(column);
    return along * (glm::dot(along, with_heights) / trace);
}

void continue_chart(ChartTexels& texels, const ChartAtlas& atlas,
                    std::span<const ChartBorder> borders, const ReadAcross& read,
                    const glm::dvec2& spacing, int threads) {
    Continuation(texels, atlas, borders, read, spacing).fill(threads);
}

}  // namespace prep::detail
