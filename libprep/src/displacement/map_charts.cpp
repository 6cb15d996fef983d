#include "displacement/map_charts.h"

#include <cmath>
#include <limits>

#include "base/disjoint_sets.h"
#include "base/step_count.h"
#include "displacement/chart_gutters.h"

namespace prep::detail {
namespace {

constexpr double coarse_from = 0x1p40;    // map coordinates beyond are coarse
constexpr double place_roundings = 1e-6;  // of map coordinates

double area_of(const MapTriangle& t) {
    const glm::dvec2 a = t[1] - t[0], b = t[2] - t[0];
    return 0.5 * std::abs(a.x * b.y - a.y * b.x);
}

// Charts that have a texel's centre inside of both are one. Borders that touch are not enough.
class SharedTexels {
  public:
    SharedTexels(const HeightMapData& map, const ChartAtlas& atlas,
                 const std::vector<std::uint8_t>& is_plain, DisjointSets& sets)
        : map_(map),
          atlas_(atlas),
          is_plain_(is_plain),
          sets_(sets),
          x_(all_of(map.x)),
          y_(all_of(map.y)),
          seen_(x_, y_) {}
    ~SharedTexels() { count_steps(steps_); }
    SharedTexels(const SharedTexels&) = delete;
    SharedTexels& operator=(const SharedTexels&) = delete;

    void unite() {
        const auto count = std::uint32_t(atlas_.triangles.size());
        for (std::uint32_t t = 0; t < count; ++t)
            if (is_plain_[t] && covers_all(in_map(map_, atlas_, t), x_, y_)) return unite_all(t);
        first_.assign(map_.raw.size(), no_index);
        unset_ = first_.size();
        std::uint32_t next_look = 0;
        const std::vector<std::uint32_t> alike = first_alike(map_, atlas_.triangles);
        std::vector<std::uint8_t> has_texel(count, 0);
        for (std::uint32_t t = 0; t < count; ++t) {
            if (!is_plain_[t]) continue;
            if (alike[t] != t) {
                if (has_texel[alike[t]]) sets_.unite(alike[t], t);
                continue;
            }
            has_texel[t] =
                for_covered(inside_of(t), x_, y_, seen_, [&](std::int64_t i, std::int64_t j) {
                    ++steps_;
                    std::uint32_t& of = first_[std::size_t(j * map_.x.size + i)];
                    if (of == no_index) {
                        of = t;
                        --unset_;
                    } else if (of != t) {
                        sets_.unite(of, t);
                    }
                });
            // Tiles: where one chart has all of the map, the others that have texels are of it.
            if (unset_ > 0 || t < next_look) continue;
            if (is_one()) return unite_all(first_[0]);
            next_look = 2 * t + 1;
        }
    }

  private:
    // A little smaller than it is.
    MapTriangle inside_of(std::uint32_t triangle) const {
        constexpr double inner = 1 - 1e-3;
        MapTriangle p = in_map(map_, atlas_, triangle);
        const glm::dvec2 centre = (p[0] + p[1] + p[2]) / 3.0;
        for (glm::dvec2& corner : p) corner = glm::mix(centre, corner, inner);
        return p;
    }
    // With the chart that has all texels: those that have one.
    void unite_all(std::uint32_t with) {
        for (std::uint32_t t = 0; t < is_plain_.size(); ++t) {
            if (!is_plain_[t]) continue;
            const MapTriangle p = inside_of(t);
            const auto has_one = [&](const auto&...) {
                ++steps_;
                return true;
            };
            if (covers_all(p, x_, y_) || any_run(p, x_, y_, has_one)) sets_.unite(with, t);
        }
    }
    bool is_one() {
        const std::uint32_t one = sets_.find(first_[0]);
        return std::all_of(first_.begin(), first_.end(),
                           [&](std::uint32_t t) { return sets_.find(t) == one; });
    }

    const HeightMapData& map_;
    const ChartAtlas& atlas_;
    const std::vector<std::uint8_t>& is_plain_;
    DisjointSets& sets_;
    const TexelRange x_, y_;
    SeenTexels seen_;                   // whose runs are of one set each
    std::vector<std::uint32_t> first_;  // by texel: a triangle that covers it
    std::size_t unset_ = 0;             // of them
    std::uint64_t steps_ = 0;           // texels looked at
};

// Where the chart lies, and along which axes it goes on by the map's wrap.
void find_place(const HeightMapData& map, const ChartAtlas& atlas, MapChart& chart) {
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const std::uint32_t t : chart.triangles)
        for (const glm::dvec2& p : in_map(map, atlas, t)) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    chart.low = low;
    chart.high = high;
    const HeightAxis* const axes[2] = {&map.x, &map.y};
    for (glm::length_t k = 0; k < 2; ++k) {
        const double size = double(axes[k]->size);
        const bool is_larger = high[k] - low[k] > size + place_roundings;
        const bool is_outside =
            low[k] < -0.5 - place_roundings || high[k] > size - 0.5 + place_roundings;
        chart.wraps[std::size_t(k)] =
            axes[k]->wrap == Wrap::mirror ? is_outside : axes[k]->wrap == Wrap::repeat && is_larger;
    }
}

}  // namespace

MapTriangle in_map(const HeightMapData& map, const ChartAtlas& atlas, std::uint32_t triangle) {
    MapTriangle p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = map.map_point(atlas.triangles[triangle][k]);
    return p;
}

bool uvs_go_on(const ChartAtlas& atlas, std::uint32_t half_edge) {
    const std::uint32_t other = atlas.across[half_edge];
    if (other == no_index) return false;
    const auto ends = [&](std::uint32_t h) {
        const auto& uv = atlas.triangles[h / 3];
        return std::pair(uv[h % 3], uv[(h + 1) % 3]);
    };
    const auto [a, b] = ends(half_edge);
    const auto [c, d] = ends(other);
    return atlas.same_way[half_edge] ? a == c && b == d : a == d && b == c;
}

std::vector<MapChart> map_charts(const HeightMapData& map, const ChartAtlas& atlas) {
    if (atlas.triangles.empty()) {
        const glm::dvec2 size(double(map.x.size), double(map.y.size));
        return {{.triangles = {},
                 .of_uvs = 1,
                 .of_surface = 1,
                 .low = glm::dvec2(-0.5),
                 .high = size - 0.5,
                 .wraps = {map.x.wrap != Wrap::clamp, map.y.wrap != Wrap::clamp}}};
    }
    const auto count = std::uint32_t(atlas.triangles.size());
    std::vector<std::uint8_t> is_plain(count, 0);
    for (std::uint32_t t = 0; t < count; ++t) {
        const auto& uv = atlas.triangles[t];
        const MapTriangle p = in_map(map, atlas, t);
        is_plain[t] = true;
        for (std::size_t k = 0; k < 3; ++k)
            is_plain[t] &= std::isfinite(uv[k].x) && std::isfinite(uv[k].y) &&
                           std::abs(p[k].x) < coarse_from && std::abs(p[k].y) < coarse_from;
    }
    DisjointSets sets(count);
    if (atlas.across.empty()) {
        const std::vector<std::uint32_t> names = charts_of(atlas.triangles);
        for (std::uint32_t t = 0; t < count; ++t) sets.unite(t, names[t]);
    }
    for (std::uint32_t h = 0; h < atlas.across.size(); ++h)
        if (uvs_go_on(atlas, h)) sets.unite(h / 3, atlas.across[h] / 3);
    SharedTexels(map, atlas, is_plain, sets).unite();

    std::vector<MapChart> charts;
    std::vector<std::uint32_t> numbers(count, no_index);
    for (std::uint32_t t = 0; t < count; ++t) {
        if (!is_plain[t]) continue;
        std::uint32_t& c = numbers[sets.find(t)];
        if (c == no_index) {
            c = std::uint32_t(charts.size());
            charts.emplace_back();
        }
        charts[c].triangles.push_back(t);
        // Faces without a surface, holes of a cage, have no scale.
        const double area = area_of(atlas.triangles[t]);
        const double of_surface = atlas.areas.empty() ? area : atlas.areas[t];
        if (!(of_surface > 0)) continue;
        charts[c].of_uvs += area;
        charts[c].of_surface += of_surface;
    }
    for (MapChart& chart : charts) find_place(map, atlas, chart);
    return charts;
}

}  // namespace prep::detail
