#include "displacement/unfolded_ends.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "displacement/chart_gutters.h"
#include "displacement/height_data.h"

namespace prep::detail {
namespace {

// Texels around charts: the two that a bicubic filter reads, and the lines of four texels on which
// gutters that lie beside them are extrapolated.
constexpr std::int64_t around = 6;
constexpr double gutter = 4;  // texels between charts that share none, whatever the filter
constexpr double most_turns = 2;
constexpr double largest_unfolded = 0x1p28;
constexpr double turn_roundings = 1e-2;  // texels: UVs are floats, and both ends have their own

class UnfoldedEnds {
  public:
    UnfoldedEnds(const HeightMapData& map, const ChartAtlas& atlas,
                 std::span<const FoldedChart> charts, FilteredMap& made)
        : map_(map),
          atlas_(atlas),
          charts_(charts),
          made_(made),
          axes_{HeightAxis{made.width, map.x.wrap}, HeightAxis{made.height, map.y.wrap}},
          parts_(double(made.width / map.x.size), double(made.height / map.y.size)) {}

    void run() {
        if (map_.x.wrap != Wrap::repeat && map_.y.wrap != Wrap::repeat) return;
        if (!find_place()) return;
        find_edges();
        choose_axes();
        if (!unfolds_[0] && !unfolds_[1]) return;
        const HeightMapData folded = this->folded();
        copy(folded);
        keep(folded);
        const glm::dvec2 size(double(made_.width), double(made_.height));
        made_.scale = glm::dvec2(double(axes_[0].size), double(axes_[1].size)) / size;
        made_.shift = -glm::dvec2(first_) / size;
        made_.is_unfolded = unfolds_;
    }

  private:
    struct Edge {
        glm::dvec2 a, b;
        glm::length_t normal;  // the axis that it lies across of, more than along
    };

    glm::dvec2 in_parts(const glm::dvec2& p) const { return (p + 0.5) * parts_ - 0.5; }

    // What all charts lie in, of the texels that are made. False where there is more than that.
    bool find_place() {
        std::size_t triangles = 0;
        low_ = glm::dvec2(std::numeric_limits<double>::infinity());
        high_ = -low_;
        for (const FoldedChart& chart : charts_) {
            triangles += chart.of->triangles.size();
            low_ = glm::min(low_, in_parts(chart.of->low));
            high_ = glm::max(high_, in_parts(chart.of->high));
        }
        return triangles > 0 && triangles == atlas_.triangles.size();
    }

    void find_edges() {
        for (const FoldedChart& chart : charts_)
            for (const std::uint32_t t : chart.of->triangles)
                for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
                    if (atlas_.across.empty() || !uvs_go_on(atlas_, h)) find_edge(chart, h);
    }
    void find_edge(const FoldedChart& chart, std::uint32_t h) {
        const MapTriangle p = in_map(map_, atlas_, h / 3);
        Edge edge{in_parts(p[h % 3]), in_parts(p[(h + 1) % 3]), 0};
        const glm::dvec2 along = glm::abs(edge.b - edge.a);
        const glm::length_t k = edge.normal = along.x <= along.y ? 0 : 1;
        const bool goes_on = !chart.is_filtered || goes_on_by_wrap(h);
        if (goes_on || chart.of->wraps[std::size_t(k)]) wrapped_.push_back(edge);
        if (goes_on) return;
        for (const glm::length_t axis : {0, 1})
            ends_[std::size_t(axis)] |=
                !chart.of->wraps[std::size_t(axis)] && ends_along(axis, chart, edge);
    }
    // Whether it is the end of a chart, or of all, and read with what lies a map's width from it.
    bool ends_along(glm::length_t k, const FoldedChart& chart, const Edge& edge) const {
        const double size = double(axes_[std::size_t(k)].size);
        const auto [low, high] = std::minmax(edge.a[k], edge.b[k]);
        const auto is_at_end = [&, low = low, high = high](double begin, double end) {
            return end - begin > size - gutter && (low < begin + gutter || high > end - gutter);
        };
        return is_at_end(low_[k], high_[k]) ||
               is_at_end(in_parts(chart.of->low)[k], in_parts(chart.of->high)[k]);
    }

    // Whether what is across the edge lies there too, by whole turns of the map.
    bool goes_on_by_wrap(std::uint32_t h) const {
        const std::uint32_t other = atlas_.across.empty() ? no_index : atlas_.across[h];
        if (other == no_index) return false;
        const auto ends = [&](std::uint32_t half_edge) {
            const MapTriangle p = in_map(map_, atlas_, half_edge / 3);
            return std::pair(p[half_edge % 3], p[(half_edge + 1) % 3]);
        };
        const auto [a, b] = ends(h);
        auto [c, d] = ends(other);
        if (!atlas_.same_way[h]) std::swap(c, d);
        const HeightAxis* const axes[2] = {&map_.x, &map_.y};
        for (glm::length_t k = 0; k < 2; ++k) {
            const double size = double(axes[k]->size);
            const double turns =
                axes[k]->wrap == Wrap::repeat ? std::round((c[k] - a[k]) / size) : 0.0;
            if (std::abs(c[k] - a[k] - turns * size) > turn_roundings ||
                std::abs(d[k] - b[k] - turns * size) > turn_roundings)
                return false;
        }
        return true;
    }

    void choose_axes() {
        for (std::size_t k = 0; k < 2; ++k) {
            size_[glm::length_t(k)] = axes_[k].size;
            if (axes_[k].wrap != Wrap::repeat || !ends_[k]) continue;
            const double low = low_[glm::length_t(k)], high = high_[glm::length_t(k)];
            const double size = double(axes_[k].size), span = high - low;
            if (!(span <= most_turns * size + turn_roundings)) continue;
            unfolds_[k] = true;
            first_[glm::length_t(k)] = std::int64_t(std::floor(low)) - around;
            size_[glm::length_t(k)] =
                std::int64_t(std::ceil(high)) + around + 1 - first_[glm::length_t(k)];
        }
        if (double(size_.x) * double(size_.y) > largest_unfolded) unfolds_ = {};
    }

    HeightMapData folded() {
        HeightMapData folded;
        folded.options = map_.options;
        folded.matrix = map_.matrix;
        folded.offset = map_.offset;
        folded.x = axes_[0];
        folded.y = axes_[1];
        folded.raw = std::move(made_.raw);
        return folded;
    }
    void copy(const HeightMapData& folded) {
        made_.width = size_.x;
        made_.height = size_.y;
        made_.raw.resize(std::size_t(size_.x * size_.y));
        parallel_blocks(std::size_t(size_.y), 16, map_.options.threads,
                        [&](std::size_t begin, std::size_t end) {
                            for (auto j = std::int64_t(begin); j < std::int64_t(end); ++j)
                                for (std::int64_t i = 0; i < size_.x; ++i)
                                    made_.raw[std::size_t(j * size_.x + i)] =
                                        float(folded.texel(i + first_.x, j + first_.y));
                        });
    }

    // Charts' texels beside edges that the surface goes on across by the wrap.
    void keep(const HeightMapData& folded) {
        made_.kept.assign(made_.raw.size(), 0);
        const std::vector<std::uint8_t> covered = covered_texels(folded, atlas_.triangles);
        for (const Edge& edge : wrapped_) {
            const glm::length_t k = edge.normal, other = 1 - k;
            // A slanted one may turn along the other axis.
            const bool slanted = std::abs(edge.b[k] - edge.a[k]) > 1;
            if (!unfolds_[std::size_t(k)] && !(slanted && unfolds_[std::size_t(other)])) continue;
            const auto [low, high] = std::minmax(edge.a[other], edge.b[other]);
            // With those that are read at its ends, where charts lie; beyond them is an end.
            auto first = std::int64_t(std::floor(low)) - 1;
            auto last = std::int64_t(std::ceil(high)) + 1;
            if (unfolds_[std::size_t(other)]) {
                first = std::max(first, std::int64_t(std::ceil(low_[other] - turn_roundings)));
                last = std::min(last, std::int64_t(std::floor(high_[other] + turn_roundings)));
            } else {
                last = std::min(last, first + axes_[std::size_t(other)].size);
            }
            for (std::int64_t j = first; j <= last; ++j) {
                const double length = edge.b[other] - edge.a[other];
                const double t =
                    length == 0 ? 0.0 : std::clamp((double(j) - edge.a[other]) / length, 0.0, 1.0);
                const auto middle = std::int64_t(std::floor(glm::mix(edge.a[k], edge.b[k], t)));
                for (std::int64_t i = middle - around; i <= middle + 1 + around; ++i)
                    keep(k == 0 ? glm::i64vec2(i, j) : glm::i64vec2(j, i), covered);
            }
        }
    }
    void keep(const glm::i64vec2& texel, const std::vector<std::uint8_t>& covered) {
        const std::int64_t x = axes_[0].texel(texel.x), y = axes_[1].texel(texel.y);
        if (!covered[std::size_t(y * axes_[0].size + x)]) return;
        const glm::i64vec2 to(unfolds_[0] ? texel.x - first_.x : x,
                              unfolds_[1] ? texel.y - first_.y : y);
        if (to.x >= 0 && to.y >= 0 && to.x < size_.x && to.y < size_.y)
            made_.kept[std::size_t(to.y * size_.x + to.x)] = 1;
    }

    const HeightMapData& map_;
    const ChartAtlas& atlas_;
    std::span<const FoldedChart> charts_;
    FilteredMap& made_;
    const std::array<HeightAxis, 2> axes_;  // of what was made, folded
    const glm::dvec2 parts_;                // of its texels to one of the map's
    glm::dvec2 low_{0.0}, high_{0.0};
    std::vector<Edge> wrapped_;   // that the surface goes on across by the map's wrap
    std::array<bool, 2> ends_{};  // along an axis some chart does not
    std::array<bool, 2> unfolds_{};
    glm::i64vec2 first_{0}, size_{0};  // what is made of the texels, unfolded
};

}  // namespace

void unfold_ends(const HeightMapData& map, const ChartAtlas& atlas,
                 std::span<const FoldedChart> charts, FilteredMap& made) {
    UnfoldedEnds(map, atlas, charts, made).run();
}

}  // namespace prep::detail
