#include "displacement/chart_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "displacement/band_limit.h"
#include "displacement/chart_continuation.h"
#include "displacement/chart_gutters.h"
#include "displacement/chart_texels.h"
#include "displacement/height_data.h"
#include "displacement/map_charts.h"
#include "displacement/unfolded_ends.h"

namespace prep::detail {
namespace {

constexpr double fine_texels = 3.6;     // a spacing, of maps that carry it
constexpr double coarse_texels = 0.8;   // a spacing: coarser ones need no finer parts
constexpr double texels_read = 8;       // a spacing, at least, where there are more
constexpr double kernel_spacings = 4;   // that the filter reads around a point
constexpr double largest_map = 0x1p28;  // of what is made
constexpr double largest_spacing = 0x1p500;
constexpr double roundings = 1e-6;  // of map coordinates

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
            if (const TexelBox in = read_box(chart); in.size() > std::size_t(largest_map))
                return Error{ErrorCode::limit,
                             fmt::format("the texels around a chart that a band limit reads are "
                                         "{} by {}: make the map smaller",
                                         in.width, in.height),
                             ""};
        start();
        choose_owners();
        std::vector<double> changes(charts_.size(), 0);
        steps_.resize(charts_.size());
        for_charts([&](std::uint32_t c, int threads) {
            if (is_read_across(c)) steps_[c] = cropped(reduced(c, threads), charts_[c]);
        });
        for_charts([&](std::uint32_t c, int threads) { changes[c] = filter(c, threads); });
        for (const double change : changes) made_.change = std::max(made_.change, change);
        made_.change *= std::abs(map_.unit);
        unfold();
        return std::move(made_);
    }

  private:
    struct Chart {
        MapChart of;
        TexelBox own;            // its texels in the map
        TexelBox box;            // with those around that it has by the map's wrap
        double spacing = 0;      // 0: it stays as it is
        glm::dvec2 texels{0.0};  // between samples
        bool is_small = false;   // the spacing was larger
        glm::i64vec2 step{1};    // texels to one of those that the filter reads
        bool is_reduced() const { return spacing > 0 && step != glm::i64vec2(1); }
        // Of those that the filter reads, to a spacing.
        glm::dvec2 reads() const { return texels / glm::dvec2(step); }
    };
    // What the filter reads of a chart, in steps: differences from a plane, so that what is level
    // or steep comes out as it is.
    struct Reduced {
        TexelBox in;
        HeightPlane plane;
        ChartTexels texels;
    };
    // What is read of it from across a seam: its own texels, and what continues them a little.
    struct Steps {
        TexelBox in;
        HeightPlane plane;
        HeightMapData heights;
    };

    // Between texels there is nothing that the map carries.
    static bool carries(const glm::dvec2& texels) {
        return std::isfinite(texels.x) && std::max(texels.x, texels.y) >= 1;
    }
    // Many charts on all threads, few ones each.
    template <class Body>
    void for_charts(const Body& body) const {
        constexpr std::size_t many = 64;
        if (charts_.size() < many) {
            for (std::uint32_t c = 0; c < charts_.size(); ++c) body(c, threads_);
        } else {
            parallel_blocks(charts_.size(), 4, threads_, [&](std::size_t begin, std::size_t end) {
                for (std::size_t c = begin; c < end; ++c) body(std::uint32_t(c), 1);
            });
        }
    }

    void find_charts() {
        chart_of_.assign(atlas_.triangles.size(), no_index);
        for (MapChart& found : map_charts(map_, atlas_)) {
            for (const std::uint32_t t : found.triangles)
                chart_of_[t] = std::uint32_t(charts_.size());
            charts_.emplace_back();
            charts_.back().of = std::move(found);
            find_texels(charts_.back());
        }
    }

    // The chart's texels, and a spacing that fits into them.
    void find_texels(Chart& chart) const {
        const MapChart& of = chart.of;
        if (!(of.of_uvs > 0 && of.of_surface > 0)) return;
        const double spacing =
            std::min(spacing_ * std::sqrt(of.of_uvs / of.of_surface), largest_spacing);
        chart.texels = texels_between(map_, spacing);
        const glm::dvec2 last(double(map_.x.size) - 1, double(map_.y.size) - 1);
        const bool clamps[2] = {map_.x.wrap == Wrap::clamp, map_.y.wrap == Wrap::clamp};
        const glm::dvec2 begin = glm::ceil(of.low - roundings);
        const glm::dvec2 end = glm::floor(of.high + roundings);
        glm::dvec2 low = begin, high = end;
        for (glm::length_t k = 0; k < 2; ++k) {
            const bool wraps = of.wraps[std::size_t(k)];
            if (!wraps && !clamps[k]) continue;
            low[k] = wraps ? 0 : std::max(low[k], 0.0);
            high[k] = wraps ? last[k] : std::min(high[k], last[k]);
        }
        if (low.x > high.x || low.y > high.y || !carries(chart.texels)) return;
        const auto between = [](const glm::dvec2& from, const glm::dvec2& to) {
            return TexelBox{std::int64_t(from.x), std::int64_t(from.y),
                            std::int64_t(to.x - from.x) + 1, std::int64_t(to.y - from.y) + 1};
        };
        chart.own = between(low, high);
        chart.spacing = spacing;
        const double larger = double(std::max(chart.own.width, chart.own.height));
        const double part = std::max(1.0, 0.5 * larger) / std::max(chart.texels.x, chart.texels.y);
        chart.is_small = part < 1;
        if (chart.is_small) {
            chart.spacing *= part;
            chart.texels *= part;
        }
        chart.step = glm::i64vec2(glm::max(glm::floor(chart.texels / texels_read), 1.0));
        const double reach = std::ceil(kernel_spacings * std::max(chart.texels.x, chart.texels.y));
        const glm::dvec2 around = reach + 2.0 * glm::dvec2(chart.step);
        for (glm::length_t k = 0; k < 2; ++k) {
            if (of.wraps[std::size_t(k)]) {
                low[k] -= around[k];
                high[k] += around[k];
            } else if (clamps[k]) {
                low[k] = std::max(begin[k], low[k] - around[k]);
                high[k] = std::min(end[k], high[k] + around[k]);
            }
        }
        chart.box = between(low, high);
    }

    // Of the finest spacing that a chart carries; odd ones, so that texels stay where they are.
    void choose_parts() {
        glm::dvec2 finest(std::numeric_limits<double>::infinity());
        for (const Chart& chart : charts_)
            if (chart.spacing > 0 && !chart.is_small) finest = glm::min(finest, chart.texels);
        for (glm::length_t k = 0; k < 2; ++k) {
            if ((k == 0 ? map_.x : map_.y).size == 1 || finest[k] >= fine_texels) continue;
            const double parts = std::ceil(fine_texels / std::max(finest[k], coarse_texels));
            parts_[k] = 2 * std::floor(0.5 * parts) + 1;
        }
    }

    // The map as it is, with charts going on into the gutters, with so many parts of its texels.
    void start() {
        filled_.options = map_.options;
        filled_.x = map_.x;
        filled_.y = map_.y;
        filled_.raw = map_.raw;
        if (!atlas_.triangles.empty())
            fill_gutters(filled_, covered_texels(map_, atlas_.triangles));
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
    double write(const TexelBox& in, int threads, const IsMine& is_mine, const Value& value) {
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

    // Texels in steps of the map's, without heights yet.
    HeightMapData in_steps(const TexelBox& in) const {
        HeightMapData own;
        own.options = map_.options;
        own.x = {in.width, Wrap::clamp};
        own.y = {in.height, Wrap::clamp};
        own.matrix = map_.matrix;
        return own;
    }
    // Their UVs over the map's.
    glm::dvec2 scale_of(const TexelBox& in, const glm::i64vec2& step) const {
        return {double(map_.x.size) / double(in.width * step.x),
                double(map_.y.size) / double(in.height * step.y)};
    }

    // Where a spacing has two texels or more, what is between them is as smooth as they are.
    bool goes_by_texels(const Chart& chart) const {
        return chart.is_reduced() ||
               (parts_ != glm::dvec2(1.0) && std::min(chart.texels.x, chart.texels.y) >= 2);
    }
    // A map of heights at the texels within `in`, read smoothly between them.
    template <class Height>
    static HeightMapData at_texels(const HeightMapData& like, const TexelBox& in,
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

    // Texels that several charts cover are the first one's.
    void choose_owners() {
        owners_.assign(made_.raw.size(), no_index);
        std::size_t unowned = owners_.size();
        for (std::uint32_t c = 0; c < charts_.size(); ++c) {
            const Chart& chart = charts_[c];
            if (!(chart.spacing > 0)) continue;
            const auto own = [&](std::int64_t i, std::int64_t j) {
                std::uint32_t& owner = owners_[made_index(i, j)];
                if (owner != no_index) return;
                owner = c;
                --unowned;
            };
            const TexelBox to = written_box(chart);
            const TexelRange x{to.x, to.width, {made_.width, map_.x.wrap}, chart.of.wraps[0]};
            const TexelRange y{to.y, to.height, {made_.height, map_.y.wrap}, chart.of.wraps[1]};
            SeenTexels seen(x, y);
            const bool all = covers_map(chart);
            for (std::int64_t j = 0; all && j < made_.height; ++j)
                for (std::int64_t i = 0; i < made_.width; ++i) own(i, j);
            for (const std::uint32_t t : chart.of.triangles) {
                if (unowned == 0 || all) break;
                for_read(in_parts(t), x, y, seen, own);
            }
        }
    }
    // Without triangles, or by one that spans the map often.
    bool covers_map(const Chart& chart) const {
        const auto& triangles = chart.of.triangles;
        const auto covers = [&](std::uint32_t t) {
            return covers_all(in_map(map_, atlas_, t), all_of(map_.x), all_of(map_.y));
        };
        return triangles.empty() || std::any_of(triangles.begin(), triangles.end(), covers);
    }

    // What the filter reads of a chart, in steps. A slanted kernel reaches further along an axis
    // than samples along it are apart.
    static TexelBox read_box(const Chart& chart) {
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
        Reduced own = reduced(number, threads);
        if (own.texels.covered.empty()) return 0;
        const HeightPlane& plane = own.plane;
        const auto in_own = [&](const glm::dvec2& at) { return to_steps(at, own.in, chart.step); };
        const auto across = [&](const glm::dvec2& texel, const AtlasPoint& there) {
            return height_there(there) - plane.at(from_steps(texel, own.in, chart.step));
        };
        std::vector<ChartBorder> borders = this->borders(number);
        for (ChartBorder& border : borders)
            for (glm::dvec2& p : border.triangle) p = in_own(p);
        continue_chart(own.texels, atlas_, borders, across, chart.reads(), threads);
        HeightMapData read = in_steps(own.in);
        read.raw = std::move(own.texels.heights);
        const BandLimits bands = make_band_limits(read, threads);
        const glm::dvec2 scale = scale_of(own.in, chart.step);
        const auto limited = [&](const glm::dvec2& own_place) {
            return band_limited(read, bands, own_place, chart.spacing, scale);
        };
        const auto is_mine = [&](std::size_t to) { return owners_[to] == number; };
        const TexelBox to = written_box(chart);
        if (!goes_by_texels(chart))
            return write(to, threads, is_mine,
                         [&](const glm::dvec2& at) { return plane.at(at) + limited(in_own(at)); });
        const glm::dvec2 first{double(chart.own.x), double(chart.own.y)};
        const glm::dvec2 size{double(chart.own.width), double(chart.own.height)};
        const auto low = glm::i64vec2(glm::floor(in_own(first)));
        const auto high = glm::i64vec2(glm::ceil(in_own(first + size)));
        constexpr std::int64_t around = 3;  // what is read between texels, and more
        const TexelBox near{low.x - around, low.y - around, high.x - low.x + 2 * around + 1,
                            high.y - low.y + 2 * around + 1};
        const HeightMapData smooth = at_texels(read, near, limited, threads);
        return write(to, threads, is_mine, [&](const glm::dvec2& at) {
            return plane.at(at) + raw_value_at(smooth, in_own(at));
        });
    }

    // The surface's height at a place across a seam: in the steps of the chart there, if it has
    // such, so that what is finer does not become what is coarse.
    double height_there(const AtlasPoint& there) const {
        const auto& uv = atlas_.triangles[there.triangle];
        const glm::dvec3& w = there.weights;
        glm::dvec2 at = map_.map_point(w.x * uv[0] + w.y * uv[1] + w.z * uv[2]);
        const std::uint32_t c = chart_of_[there.triangle];
        if (c == no_index || steps_[c].heights.raw.empty()) return raw_value_at(filled_, at);
        const Chart& chart = charts_[c];
        const HeightAxis* const axes[2] = {&map_.x, &map_.y};
        for (glm::length_t k = 0; k < 2; ++k) {
            const double size = double(axes[k]->size);
            // Beyond its edge a clamped map goes on level, not as a plane does.
            if (axes[k]->wrap == Wrap::clamp) at[k] = std::clamp(at[k], 0.0, size - 1);
            if (!chart.of.wraps[std::size_t(k)]) continue;
            const double turns = std::floor((at[k] + 0.5) / size);
            at[k] -= turns * size;
            if (axes[k]->wrap == Wrap::mirror && std::fmod(turns, 2) != 0) at[k] = size - 1 - at[k];
        }
        const Steps& other = steps_[c];
        return other.plane.at(at) + raw_value_at(other.heights, to_steps(at, other.in, chart.step));
    }

    Reduced reduced(std::uint32_t number, int threads) const {
        const Chart& chart = charts_[number];
        Reduced made{.in = read_box(chart), .plane = {}, .texels = {}};
        const CoveredTexels covered = cover(chart);
        if (std::find(covered.mask.begin(), covered.mask.end(), std::uint8_t(1)) ==
            covered.mask.end())
            return made;
        made.plane = fitted_plane(map_, chart.own, covered, chart.of.wraps);
        made.texels = means(chart, covered, made.plane, made.in, threads);
        return made;
    }

    // Whether another chart, or another part of it, reads its steps across a seam.
    bool is_read_across(std::uint32_t number) const {
        const Chart& chart = charts_[number];
        if (!chart.is_reduced() || atlas_.across.empty()) return false;
        for (const std::uint32_t t : chart.of.triangles)
            for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
                if (atlas_.across[h] != no_index && !uvs_go_on(atlas_, h)) return true;
        return false;
    }
    Steps cropped(const Reduced& of, const Chart& chart) const {
        if (of.texels.covered.empty()) return {};
        constexpr std::int64_t around = 5;  // a bicubic filter's, its gutters', and roundings
        const auto side = [&](std::int64_t first, std::int64_t count, std::int64_t step,
                              std::int64_t from, std::int64_t all) {
            const auto low = std::int64_t(std::floor(double(first) / double(step))) - around;
            const auto high =
                std::int64_t(std::floor(double(first + count - 1) / double(step))) + around;
            const std::int64_t begin = std::max(low, from), end = std::min(high + 1, from + all);
            return std::pair(begin, end - begin);
        };
        const auto [x, width] =
            side(chart.own.x, chart.own.width, chart.step.x, of.in.x, of.in.width);
        const auto [y, height] =
            side(chart.own.y, chart.own.height, chart.step.y, of.in.y, of.in.height);
        Steps made{{x, y, width, height}, of.plane, in_steps({x, y, width, height})};
        made.heights.options.filter = HeightFilter::bicubic;  // as sharp as the steps are
        std::vector<std::uint8_t> covered;
        for (std::int64_t j = y; j < y + height; ++j) {
            const auto row = std::ptrdiff_t((j - of.in.y) * of.in.width + x - of.in.x);
            const auto end = row + std::ptrdiff_t(width);
            const auto add = [row, end](const auto& from, auto& to) {
                to.insert(to.end(), from.begin() + row, from.begin() + end);
            };
            add(of.texels.heights, made.heights.raw);
            add(of.texels.covered, covered);
        }
        fill_gutters(made.heights, std::move(covered));
        return made;
    }

    // The chart's heights over the plane, in steps: means that fade out a step away, so that what
    // is finer does not become what is coarse.
    ChartTexels means(const Chart& chart, const CoveredTexels& covered, const HeightPlane& plane,
                      const TexelBox& in, int threads) const {
        ChartTexels own{in.width, in.height, std::vector<float>(in.size(), 0.0F),
                        std::vector<std::uint8_t>(in.size(), 0)};
        std::vector<float> parts(in.size(), 0.0F);  // of a step that the chart covers
        const glm::dvec2 step(chart.step);
        const glm::i64vec2 low(chart.box.x, chart.box.y);
        const glm::i64vec2 size(chart.box.width, chart.box.height);
        rows(in.height, threads, [&](std::int64_t row) {
            for (std::int64_t column = 0; column < in.width; ++column) {
                const glm::dvec2 centre{(double(in.x + column) + 0.5) * step.x - 0.5,
                                        (double(in.y + row) + 0.5) * step.y - 0.5};
                const auto first =
                    glm::max(low, glm::i64vec2(glm::floor(centre - step)) + std::int64_t(1));
                const auto last =
                    glm::min(low + size - std::int64_t(1),
                             glm::i64vec2(glm::ceil(centre + step)) - std::int64_t(1));
                double weights = 0, sum = 0;
                for (std::int64_t j = first.y; j <= last.y; ++j)
                    for (std::int64_t i = first.x; i <= last.x; ++i) {
                        if (!covered(i, j)) continue;
                        const glm::dvec2 at{double(i), double(j)};
                        const glm::dvec2 part = 1.0 - glm::abs(at - centre) / step;
                        weights += part.x * part.y;
                        sum += part.x * part.y * (map_.texel(i, j) - plane.at(at));
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

    CoveredTexels cover(const Chart& chart) const {
        const auto& wraps = chart.of.wraps;
        const TexelBox &own = chart.own, &box = chart.box;
        CoveredTexels made{
            .x = {wraps[0] ? own.x : box.x, wraps[0] ? own.width : box.width, map_.x, wraps[0]},
            .y = {wraps[1] ? own.y : box.y, wraps[1] ? own.height : box.height, map_.y, wraps[1]},
            .mask = {}};
        made.mask.assign(std::size_t(made.x.count * made.y.count), covers_map(chart));
        std::size_t unset = covers_map(chart) ? 0 : made.mask.size();
        SeenTexels seen(made.x, made.y);
        for (const std::uint32_t t : chart.of.triangles) {
            if (unset == 0) break;
            for_covered(
                in_map(map_, atlas_, t), made.x, made.y, seen, [&](std::int64_t i, std::int64_t j) {
                    std::uint8_t& is = made.mask[std::size_t((j - made.y.first) * made.x.count + i -
                                                             made.x.first)];
                    unset -= is == 0;
                    is = 1;
                });
        }
        return made;
    }
    // By the texels that are made.
    MapTriangle in_parts(std::uint32_t t) const {
        MapTriangle p = in_map(map_, atlas_, t);
        for (glm::dvec2& corner : p) corner = (corner + 0.5) * parts_ - 0.5;
        return p;
    }

    // Edges of its triangles beyond which its UVs do not go on. Of tiles there are none: one texel
    // is at many places of the surface, beside as many others.
    std::vector<ChartBorder> borders(std::uint32_t number) const {
        std::vector<ChartBorder> borders;
        const Chart& chart = charts_[number];
        if (atlas_.across.empty() || chart.of.has_tiles()) return borders;
        for (const std::uint32_t t : chart.of.triangles)
            for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
                if (uvs_go_on(atlas_, h) || !(atlas_.flat[t].length > 0)) continue;
                borders.push_back({h, in_map(map_, atlas_, t), samples_across(chart, h)});
            }
        return borders;
    }
    // Where what is across has more texels to a spacing than the chart, a texel is a mean of some.
    int samples_across(const Chart& chart, std::uint32_t half_edge) const {
        constexpr int some = 4;
        constexpr double more = 1.5;
        const std::uint32_t other = atlas_.across[half_edge];
        const std::uint32_t c = other == no_index ? no_index : chart_of_[other / 3];
        if (c == no_index || !(charts_[c].spacing > 0)) return chart.is_reduced() ? some : 1;
        const glm::dvec2 here = chart.reads(), there = charts_[c].reads();
        return std::max(there.x, there.y) > more * std::min(here.x, here.y) ? some : 1;
    }

    void unfold() {
        std::vector<FoldedChart> charts;
        for (const Chart& chart : charts_) charts.push_back({&chart.of, chart.spacing > 0});
        unfold_ends(map_, atlas_, charts, made_);
    }

    // What may be made of a chart: no texel twice.
    TexelBox written_box(const Chart& chart) const {
        const auto side = [&](glm::length_t k, const HeightAxis& axis) {
            const double parts = parts_[k];
            const std::int64_t size = axis.size * std::int64_t(parts);
            if (chart.of.wraps[std::size_t(k)]) return std::pair(std::int64_t(0), size);
            double low = chart.of.low[k], high = chart.of.high[k];
            if (axis.wrap != Wrap::repeat) {
                low = std::max(low, -0.5);
                high = std::min(high, double(axis.size) - 0.5);
            }
            auto first = std::int64_t(std::ceil((low + 0.5) * parts - 0.5 - roundings));
            auto last = std::int64_t(std::floor((high + 0.5) * parts - 0.5 + roundings));
            if (axis.wrap != Wrap::repeat) {
                first = std::max<std::int64_t>(first, 0);
                last = std::min(last, size - 1);
            }
            last = std::min(last, first + size - 1);
            return std::pair(first, std::max<std::int64_t>(last - first + 1, 0));
        };
        const auto [x, width] = side(0, map_.x);
        const auto [y, height] = side(1, map_.y);
        return {x, y, width, height};
    }

    const HeightMapData& map_;
    const ChartAtlas& atlas_;
    double spacing_;
    int threads_;
    std::vector<Chart> charts_;
    std::vector<std::uint32_t> chart_of_;  // by triangle
    std::vector<Steps> steps_;             // by chart, of those that are read across seams
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
