#include "displacement/chart_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/parallel.h"
#include "displacement/band_limit.h"
#include "displacement/chart_continuation.h"
#include "displacement/chart_gutters.h"
#include "displacement/height_data.h"

namespace prep::detail {
namespace {

using MapTriangle = std::array<glm::dvec2, 3>;  // map coordinates

constexpr double fine_texels = 4;       // a spacing, of maps that carry it
constexpr double kernel_spacings = 4;   // that the filter reads around a point
constexpr double coarse_from = 0x1p40;  // map coordinates beyond are coarse
constexpr double largest_map = 0x1p28;  // of what is made
constexpr double roundings = 1e-6;      // of map coordinates

double area_of(const MapTriangle& t) {
    const glm::dvec2 a = t[1] - t[0], b = t[2] - t[0];
    return 0.5 * std::abs(a.x * b.y - a.y * b.x);
}

struct Rectangle {
    std::int64_t x = 0, y = 0, width = 0, height = 0;
    std::size_t size() const { return std::size_t(width) * std::size_t(height); }
    std::size_t index(std::int64_t i, std::int64_t j) const {
        return std::size_t(j - y) * std::size_t(width) + std::size_t(i - x);
    }
    bool has(std::int64_t i, std::int64_t j) const {
        return i >= x && j >= y && i < x + width && j < y + height;
    }
};

// Texels of the rectangle whose centres the triangle covers.
template <class Body>
void for_covered(const MapTriangle& p, const Rectangle& in, const Body& body) {
    const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
    const auto first = std::max(in.y, std::int64_t(std::floor(top)));
    const auto last = std::min(in.y + in.height - 1, std::int64_t(std::ceil(bottom)));
    for (std::int64_t j = first; j <= last; ++j) {
        const auto [from, to] = covered_in_row(p, j);
        const std::int64_t i1 = std::min(to, in.x + in.width - 1);
        for (std::int64_t i = std::max(from, in.x); i <= i1; ++i) body(i, j);
    }
}

class ChartFilter {
  public:
    ChartFilter(const HeightMapData& map, const ChartAtlas& atlas, double spacing)
        : map_(map), atlas_(atlas), spacing_(spacing), threads_(map.options.threads) {}

    Result<FilteredMap> run() {
        find_charts();
        choose_parts();
        if (parts_.x * double(map_.x.size) * parts_.y * double(map_.y.size) > largest_map)
            return Error{
                ErrorCode::limit,
                fmt::format("a band limit so fine takes {} by {} texels for each of a map of {} by "
                            "{}: ask for one of 4 texels or more, or for none",
                            parts_.x, parts_.y, map_.x.size, map_.y.size),
                ""};
        made_.width = map_.x.size * std::int64_t(parts_.x);
        made_.height = map_.y.size * std::int64_t(parts_.y);
        for (const Chart& chart : charts_)
            if (const Rectangle in = read_box(chart); in.size() > std::size_t(largest_map))
                return Error{ErrorCode::limit,
                             fmt::format("the texels around a chart that a band limit reads are "
                                         "{} by {}: make the map smaller",
                                         in.width, in.height),
                             ""};
        start();
        if (whole_ && carries(texels_between(map_, whole_spacing_))) filter_whole();
        filter_charts();
        made_.change *= std::abs(map_.unit);
        return std::move(made_);
    }

  private:
    struct Chart {
        std::vector<std::uint32_t> triangles;
        glm::dvec2 low{0.0}, high{0.0};  // in map coordinates
        Rectangle box;                   // of texels
        double spacing = 0;              // 0: it stays as it is
        glm::dvec2 texels{0.0};          // between samples
        bool is_small = false;           // the spacing was larger
        // Texels to one of those that the filter reads, so that there are 8 or more a spacing.
        glm::i64vec2 step{1};
    };

    MapTriangle in_map(std::uint32_t t) const {
        MapTriangle p;
        for (std::size_t k = 0; k < 3; ++k) p[k] = map_.map_point(atlas_.triangles[t][k]);
        return p;
    }
    static bool is_plain(const MapTriangle& t) {
        return std::all_of(t.begin(), t.end(), [](const glm::dvec2& p) {
            return std::abs(p.x) < coarse_from && std::abs(p.y) < coarse_from;
        });
    }
    // Between texels there is nothing that the map carries.
    static bool carries(const glm::dvec2& texels) {
        return std::isfinite(texels.x) && std::max(texels.x, texels.y) >= 1;
    }

    // Charts and their spacings; whether one is as large as the map.
    void find_charts() {
        const std::vector<std::uint32_t> names = charts_of(atlas_.triangles);
        std::vector<std::uint32_t> numbers(names.size(), no_index);
        std::vector<glm::dvec2> areas;  // of UVs and of the surface
        whole_ = names.empty();
        for (std::uint32_t t = 0; t < names.size(); ++t) {
            const MapTriangle& uv = atlas_.triangles[t];
            if (!std::all_of(uv.begin(), uv.end(), [](const glm::dvec2& p) {
                    return std::isfinite(p.x) && std::isfinite(p.y);
                }))
                continue;
            whole_ = whole_ || !is_plain(in_map(t));
            std::uint32_t& c = numbers[names[t]];
            if (c == no_index) {
                c = std::uint32_t(charts_.size());
                charts_.emplace_back();
                areas.emplace_back(0.0);
            }
            charts_[c].triangles.push_back(t);
            // Faces without a surface, holes of a cage, have no scale.
            const double area = area_of(uv);
            const double of_surface = atlas_.areas.empty() ? area : atlas_.areas[t];
            if (of_surface > 0) areas[c] += glm::dvec2(area, of_surface);
        }
        const auto by_uvs = [&](const glm::dvec2& of) {
            return of.x > 0 && of.y > 0 ? spacing_ * std::sqrt(of.x / of.y) : 0;
        };
        glm::dvec2 all(0.0);
        for (std::size_t c = 0; c < charts_.size(); ++c) {
            all += areas[c];
            charts_[c].spacing = by_uvs(areas[c]);
            whole_ = whole_ || !find_box(charts_[c]);
        }
        whole_spacing_ = names.empty() ? spacing_ : by_uvs(all);
        if (whole_) charts_.clear();
    }

    // The chart's texels, none where it has none, and a spacing that fits into it. False where it
    // has texels twice.
    bool find_box(Chart& chart) const {
        glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
        for (const std::uint32_t t : chart.triangles)
            for (const glm::dvec2& p : in_map(t)) {
                low = glm::min(low, p);
                high = glm::max(high, p);
            }
        const HeightAxis* const axes[2] = {&map_.x, &map_.y};
        for (glm::length_t k = 0; k < 2; ++k) {
            const double size = double(axes[k]->size);
            if (axes[k]->wrap == Wrap::clamp) {
                low[k] = std::max(low[k], 0.0);
                high[k] = std::min(high[k], size - 1);
            } else if (high[k] - low[k] > size + roundings ||
                       (axes[k]->wrap == Wrap::mirror &&
                        (low[k] < -0.5 - roundings || high[k] > size - 0.5 + roundings))) {
                return false;
            }
        }
        chart.low = low;
        chart.high = high;
        low = glm::ceil(low - roundings);
        high = glm::floor(high + roundings);
        chart.texels = texels_between(map_, chart.spacing);
        if (low.x > high.x || low.y > high.y || !carries(chart.texels)) {
            chart.spacing = 0;
            return true;
        }
        chart.box = {std::int64_t(low.x), std::int64_t(low.y), std::int64_t(high.x - low.x) + 1,
                     std::int64_t(high.y - low.y) + 1};
        const double larger = double(std::max(chart.box.width, chart.box.height));
        const double part = std::max(1.0, 0.5 * larger) / std::max(chart.texels.x, chart.texels.y);
        chart.is_small = part < 1;
        if (chart.is_small) {
            chart.spacing *= part;
            chart.texels *= part;
        }
        constexpr double texels_read = 8;
        chart.step = glm::i64vec2(glm::max(glm::floor(chart.texels / texels_read), 1.0));
        return true;
    }

    // Of the finest spacing that a side carries.
    void choose_parts() {
        glm::dvec2 finest(std::numeric_limits<double>::infinity());
        const auto see = [&](const glm::dvec2& texels) {
            for (glm::length_t k = 0; k < 2; ++k)
                if (texels[k] >= 1) finest[k] = std::min(finest[k], texels[k]);
        };
        for (const Chart& chart : charts_)
            if (chart.spacing > 0 && !chart.is_small) see(chart.texels);
        if (whole_) see(texels_between(map_, whole_spacing_));
        for (glm::length_t k = 0; k < 2; ++k)
            if ((k == 0 ? map_.x : map_.y).size > 1 && finest[k] < fine_texels)
                parts_[k] = std::ceil(fine_texels / finest[k]);
    }

    // The map as it is, with charts going on into the gutters, with so many parts of its texels.
    void start() {
        filled_.options = map_.options;
        filled_.x = map_.x;
        filled_.y = map_.y;
        filled_.raw = map_.raw;
        if (!whole_) fill_gutters(filled_, covered_texels(map_, atlas_.triangles));
        made_.raw.resize(std::size_t(made_.width) * std::size_t(made_.height));
        if (parts_ == glm::dvec2(1.0)) {
            made_.raw = filled_.raw;
            return;
        }
        rows(made_.height, threads_, [&](std::int64_t j) {
            for (std::int64_t i = 0; i < made_.width; ++i)
                made_.raw[std::size_t(j * made_.width + i)] =
                    float(raw_value_at(filled_, texel_point(i, j)));
        });
    }

    glm::dvec2 texel_point(std::int64_t i, std::int64_t j) const {
        return (glm::dvec2(double(i), double(j)) + 0.5) / parts_ - 0.5;
    }
    template <class Body>
    static void rows(std::int64_t count, int threads, const Body& body) {
        parallel_blocks(std::size_t(count), 4, threads, [&](std::size_t begin, std::size_t end) {
            for (std::size_t j = begin; j < end; ++j) body(std::int64_t(j));
        });
    }

    // Sets the texels of a rectangle that `is_mine` to what `value` makes of them. Returns their
    // largest change.
    template <class IsMine, class Value>
    double write(const Rectangle& in, int threads, const IsMine& is_mine, const Value& value) {
        std::vector<double> changes(std::size_t(in.height), 0);
        rows(in.height, threads, [&](std::int64_t row) {
            const std::int64_t j = in.y + row;
            for (std::int64_t i = in.x; i < in.x + in.width; ++i) {
                const std::size_t to = made_index(i, j);
                if (!is_mine(to)) continue;
                const auto made = float(value(texel_point(i, j)));
                double& change = changes[std::size_t(row)];
                change = std::max(change, std::abs(double(made) - double(made_.raw[to])));
                made_.raw[to] = made;
            }
        });
        return changes.empty() ? 0 : *std::max_element(changes.begin(), changes.end());
    }
    std::size_t made_index(std::int64_t i, std::int64_t j) const {
        const HeightAxis x{made_.width, map_.x.wrap}, y{made_.height, map_.y.wrap};
        return std::size_t(y.texel(j) * x.size + x.texel(i));
    }

    // What a filter reads: differences from a plane, so that what is level or steep comes out as
    // it is.
    HeightMapData differences(const HeightAxis& x, const HeightAxis& y,
                              const glm::dvec2& step) const {
        HeightMapData own;
        own.options = map_.options;
        own.x = x;
        own.y = y;
        const glm::dvec2 scale(double(map_.x.size) / (double(x.size) * step.x),
                               double(map_.y.size) / (double(y.size) * step.y));
        own.matrix = glm::dmat2(scale.x, 0, 0, scale.y) * map_.matrix;
        return own;
    }

    void filter_whole() {
        HeightMapData all = differences(map_.x, map_.y, glm::dvec2(1.0));
        const float about = map_.raw[0];
        all.raw = map_.raw;
        for (float& h : all.raw) h -= about;
        const BandLimits bands = make_band_limits(all, threads_);
        const Rectangle everywhere{0, 0, map_.x.size, map_.y.size};
        const auto limited = [&](const glm::dvec2& at) {
            return band_limited(all, bands, at, whole_spacing_);
        };
        const auto every = [](std::size_t) { return true; };
        const auto set_all = [&](const auto& height) {
            made_.change = write({0, 0, made_.width, made_.height}, threads_, every,
                                 [&](const glm::dvec2& at) { return double(about) + height(at); });
        };
        if (!goes_by_texels(texels_between(map_, whole_spacing_), glm::i64vec2(1)))
            return set_all(limited);
        const HeightMapData smooth = at_texels(all, everywhere, limited, threads_);
        set_all([&](const glm::dvec2& at) { return raw_value_at(smooth, at); });
    }

    // Where a spacing has two texels or more, what is between them is as smooth as they are.
    bool goes_by_texels(const glm::dvec2& texels, const glm::i64vec2& step) const {
        return step != glm::i64vec2(1) ||
               (parts_ != glm::dvec2(1.0) && std::min(texels.x, texels.y) >= 2);
    }
    // A map of heights at the texels within `in`, read smoothly between them.
    template <class Height>
    static HeightMapData at_texels(const HeightMapData& like, const Rectangle& in,
                                   const Height& height, int threads) {
        HeightMapData smooth;
        smooth.options = like.options;
        smooth.options.filter = HeightFilter::bicubic;
        smooth.x = like.x;
        smooth.y = like.y;
        smooth.raw.assign(like.raw.size(), 0.0F);
        rows(smooth.y.size, threads, [&](std::int64_t j) {
            for (std::int64_t i = 0; i < smooth.x.size; ++i)
                if (in.has(i, j))
                    smooth.raw[std::size_t(j * smooth.x.size + i)] =
                        float(height(glm::dvec2{double(i), double(j)}));
        });
        return smooth;
    }

    // Many charts on all threads, few ones each.
    void filter_charts() {
        constexpr std::size_t many = 64;
        choose_owners();
        std::vector<double> changes(charts_.size(), 0);
        if (charts_.size() < many) {
            for (std::uint32_t c = 0; c < charts_.size(); ++c) changes[c] = filter(c, threads_);
        } else {
            parallel_blocks(charts_.size(), 4, threads_, [&](std::size_t begin, std::size_t end) {
                for (std::size_t c = begin; c < end; ++c) changes[c] = filter(std::uint32_t(c), 1);
            });
        }
        for (const double change : changes) made_.change = std::max(made_.change, change);
    }

    // Texels that several charts cover are the first one's.
    void choose_owners() {
        if (charts_.empty()) return;
        owners_.assign(made_.raw.size(), no_index);
        for (std::uint32_t c = 0; c < charts_.size(); ++c) {
            if (!(charts_[c].spacing > 0)) continue;
            const Rectangle to = written_box(charts_[c]);
            for (const std::uint32_t t : charts_[c].triangles)
                for_covered(in_parts(t), to, [&](std::int64_t i, std::int64_t j) {
                    std::uint32_t& owner = owners_[made_index(i, j)];
                    if (owner == no_index) owner = c;
                });
        }
    }

    struct Plane {
        glm::dvec2 from{0.0}, slope{0.0};
        double height = 0;
        double at(const glm::dvec2& p) const { return height + glm::dot(slope, p - from); }
    };
    // What the filter reads of a chart, in steps. A slanted kernel reaches further along an axis
    // than samples along it are apart.
    static Rectangle read_box(const Chart& chart) {
        if (!(chart.spacing > 0)) return {};
        const double reach = kernel_spacings * std::max(chart.texels.x, chart.texels.y);
        const auto side = [&](std::int64_t first, std::int64_t count, std::int64_t step) {
            const auto around = std::int64_t(std::ceil(reach / double(step))) + 2;
            const auto low = std::int64_t(std::floor(double(first) / double(step))) - around;
            const auto high =
                std::int64_t(std::floor(double(first + count - 1) / double(step))) + around;
            return std::pair(low, high - low + 1);
        };
        const auto [x, width] = side(chart.box.x, chart.box.width, chart.step.x);
        const auto [y, height] = side(chart.box.y, chart.box.height, chart.step.y);
        return {x, y, width, height};
    }

    double filter(std::uint32_t number, int threads) {
        const Chart& chart = charts_[number];
        if (!(chart.spacing > 0)) return 0;
        const Rectangle in = read_box(chart);
        const glm::dvec2 step(chart.step), corner{double(in.x), double(in.y)};
        // Between the map's texels and those that are read.
        const auto in_map = [&](const glm::dvec2& own) {
            return (own + corner + 0.5) * step - 0.5;
        };
        const auto in_own = [&](const glm::dvec2& at) { return (at + 0.5) / step - 0.5 - corner; };
        const std::vector<std::uint8_t> covered = cover(number, chart.box);
        if (std::find(covered.begin(), covered.end(), std::uint8_t(1)) == covered.end()) return 0;
        const Plane plane = fitted(chart.box, covered);
        ChartTexels own = reduced(chart, covered, plane, in, threads);
        const auto across = [&](const glm::dvec2& texel, const AtlasPoint& there) {
            const auto& uv = atlas_.triangles[there.triangle];
            const glm::dvec3& w = there.weights;
            return raw_value_at(filled_, map_.map_point(w.x * uv[0] + w.y * uv[1] + w.z * uv[2])) -
                   plane.at(in_map(texel));
        };
        std::vector<ChartBorder> borders = this->borders(number);
        for (ChartBorder& border : borders)
            for (glm::dvec2& p : border.triangle) p = in_own(p);
        const bool is_reduced = chart.step != glm::i64vec2(1);
        continue_chart(own, atlas_, borders, across, chart.texels / step, is_reduced ? 4 : 1,
                       threads);
        HeightMapData read = differences({in.width, Wrap::clamp}, {in.height, Wrap::clamp}, step);
        read.raw = std::move(own.heights);
        const BandLimits bands = make_band_limits(read, threads);
        const auto limited = [&](const glm::dvec2& own_place) {
            return band_limited(read, bands, own_place, chart.spacing);
        };
        const auto is_mine = [&](std::size_t to) { return owners_[to] == number; };
        const Rectangle to = written_box(chart);
        if (!goes_by_texels(chart.texels, chart.step))
            return write(to, threads, is_mine,
                         [&](const glm::dvec2& at) { return plane.at(at) + limited(in_own(at)); });
        const glm::dvec2 first{double(chart.box.x), double(chart.box.y)};
        const glm::dvec2 size{double(chart.box.width), double(chart.box.height)};
        const auto low = glm::i64vec2(glm::floor(in_own(first)));
        const auto high = glm::i64vec2(glm::ceil(in_own(first + size)));
        constexpr std::int64_t around = 3;  // what is read between texels, and more
        const Rectangle near{low.x - around, low.y - around, high.x - low.x + 2 * around + 1,
                             high.y - low.y + 2 * around + 1};
        const HeightMapData smooth = at_texels(read, near, limited, threads);
        return write(to, threads, is_mine, [&](const glm::dvec2& at) {
            return plane.at(at) + raw_value_at(smooth, in_own(at));
        });
    }

    // The chart's heights over the plane, in steps: means that fade out a step away, so that what
    // is finer does not become what is coarse.
    ChartTexels reduced(const Chart& chart, const std::vector<std::uint8_t>& covered,
                        const Plane& plane, const Rectangle& in, int threads) const {
        ChartTexels own{in.width, in.height, std::vector<float>(in.size(), 0.0F),
                        std::vector<std::uint8_t>(in.size(), 0)};
        std::vector<float> parts(in.size(), 0.0F);  // of a step that the chart covers
        const glm::dvec2 step(chart.step);
        rows(in.height, threads, [&](std::int64_t row) {
            for (std::int64_t column = 0; column < in.width; ++column) {
                const glm::dvec2 centre{(double(in.x + column) + 0.5) * step.x - 0.5,
                                        (double(in.y + row) + 0.5) * step.y - 0.5};
                const glm::i64vec2 low(chart.box.x, chart.box.y);
                const glm::i64vec2 size(chart.box.width, chart.box.height);
                const auto first =
                    glm::max(low, glm::i64vec2(glm::floor(centre - step)) + std::int64_t(1));
                const auto last =
                    glm::min(low + size - std::int64_t(1),
                             glm::i64vec2(glm::ceil(centre + step)) - std::int64_t(1));
                double weights = 0, sum = 0;
                for (std::int64_t j = first.y; j <= last.y; ++j)
                    for (std::int64_t i = first.x; i <= last.x; ++i) {
                        if (!covered[chart.box.index(i, j)]) continue;
                        const glm::dvec2 at{double(i), double(j)};
                        const glm::dvec2 part = 1.0 - glm::abs(at - centre) / step;
                        weights += part.x * part.y;
                        sum += part.x * part.y * (raw_at(i, j) - plane.at(at));
                    }
                if (!(weights > 0)) continue;
                const auto t = std::size_t(row * in.width + column);
                own.heights[t] = float(sum / weights);
                parts[t] = float(weights / (step.x * step.y));
            }
        });
        // Those that the chart fills by half; where there are none, what there is.
        const float most = *std::max_element(parts.begin(), parts.end());
        for (std::size_t t = 0; t < parts.size(); ++t)
            own.covered[t] = parts[t] > 0 && parts[t] >= std::min(0.5F, most);
        return own;
    }
    double raw_at(std::int64_t i, std::int64_t j) const {
        return double(map_.raw[std::size_t(map_.y.texel(j) * map_.x.size + map_.x.texel(i))]);
    }

    // Through the first texel, its slope by least squares of all.
    Plane fitted(const Rectangle& in, const std::vector<std::uint8_t>& covered) const {
        Plane plane;
        PlaneFit fit;
        bool any = false;
        for (std::int64_t j = in.y; j < in.y + in.height; ++j)
            for (std::int64_t i = in.x; i < in.x + in.width; ++i) {
                if (!covered[in.index(i, j)]) continue;
                const glm::dvec2 at{double(i), double(j)};
                if (!any) plane = {at, glm::dvec2(0.0), raw_at(i, j)};
                any = true;
                fit.add(at - plane.from, raw_at(i, j) - plane.height, 1);
            }
        plane.slope = fit.slope();
        return plane;
    }

    // 1 for each texel of the rectangle that the chart covers.
    std::vector<std::uint8_t> cover(std::uint32_t chart, const Rectangle& in) const {
        std::vector<std::uint8_t> covered(in.size(), 0);
        for (const std::uint32_t t : charts_[chart].triangles)
            for_covered(in_map(t), in,
                        [&](std::int64_t i, std::int64_t j) { covered[in.index(i, j)] = 1; });
        return covered;
    }
    // By the texels that are made.
    MapTriangle in_parts(std::uint32_t t) const {
        MapTriangle p = in_map(t);
        for (glm::dvec2& corner : p) corner = (corner + 0.5) * parts_ - 0.5;
        return p;
    }

    // Edges of its triangles beyond which its UVs do not go on.
    std::vector<ChartBorder> borders(std::uint32_t chart) const {
        std::vector<ChartBorder> borders;
        if (atlas_.across.empty()) return borders;
        for (const std::uint32_t t : charts_[chart].triangles)
            for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
                if (goes_on(h) || !(atlas_.flat[t].length > 0)) continue;
                borders.push_back({h, in_map(t)});
            }
        return borders;
    }
    bool goes_on(std::uint32_t h) const {
        const std::uint32_t other = atlas_.across[h];
        if (other == no_index) return false;
        const auto ends = [&](std::uint32_t half_edge) {
            const MapTriangle& uv = atlas_.triangles[half_edge / 3];
            return std::pair(uv[half_edge % 3], uv[(half_edge + 1) % 3]);
        };
        const auto [a, b] = ends(h);
        const auto [c, d] = ends(other);
        return atlas_.same_way[h] ? a == c && b == d : a == d && b == c;
    }

    // What may be made of a chart: no texel twice.
    Rectangle written_box(const Chart& chart) const {
        const auto side = [](double low, double high, double parts, const HeightAxis& axis) {
            auto first = std::int64_t(std::ceil((low + 0.5) * parts - 0.5 - roundings));
            auto last = std::int64_t(std::floor((high + 0.5) * parts - 0.5 + roundings));
            const std::int64_t size = axis.size * std::int64_t(parts);
            if (axis.wrap != Wrap::repeat) {
                first = std::max<std::int64_t>(first, 0);
                last = std::min(last, size - 1);
            }
            last = std::min(last, first + size - 1);
            return std::pair(first, std::max<std::int64_t>(last - first + 1, 0));
        };
        const auto [x, width] = side(chart.low.x, chart.high.x, parts_.x, map_.x);
        const auto [y, height] = side(chart.low.y, chart.high.y, parts_.y, map_.y);
        return {x, y, width, height};
    }

    const HeightMapData& map_;
    const ChartAtlas& atlas_;
    double spacing_, whole_spacing_ = 0;
    int threads_;
    bool whole_ = false;  // there are no charts, or one is as large as the map
    std::vector<Chart> charts_;
    HeightMapData filled_;
    glm::dvec2 parts_{1.0};
    FilteredMap made_;
    std::vector<std::uint32_t> owners_;  // per texel that is made: the chart that makes it
};

}  // namespace

Result<FilteredMap> filter_charts(const HeightMapData& map, const ChartAtlas& atlas,
                                  double spacing) {
    return ChartFilter(map, atlas, spacing).run();
}

}  // namespace prep::detail
