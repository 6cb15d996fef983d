#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "displacement/bilinear_deviation.h"
#include "displacement/chart_filter.h"
#include "displacement/chart_gutters.h"
#include "displacement/height_data.h"
#include "displacement/height_field.h"
#include "displacement/map_regions.h"
#include "displacement/triangle_deviation.h"

namespace prep::detail {
namespace {

// Heights beyond this are damage, and their squares are no floats any more.
constexpr float largest_texel = 1e30f;

Error invalid(std::string text) {
    return {ErrorCode::invalid, std::move(text), ""};
}

Result<void> check_options(const Image& image, const HeightMapOptions& options) {
    if (image.width == 0 || image.height == 0 || image.channels == 0 ||
        image.pixels.size() != std::size_t(image.width) * image.height * image.channels)
        return invalid("the height map has no pixels");
    if (options.channel >= image.channels)
        return invalid(
            fmt::format("channel {} of the height map is asked for; it has {}, counted "
                        "from 0",
                        options.channel, image.channels));
    if (!std::isfinite(options.scale) || !std::isfinite(options.midlevel))
        return invalid("scale and mid-level of a displacement must be finite numbers");
    const TextureRef& p = options.placement;
    if (!std::isfinite(p.offset.x) || !std::isfinite(p.offset.y) || !std::isfinite(p.scale.x) ||
        !std::isfinite(p.scale.y) || !std::isfinite(p.rotation))
        return invalid("the placement of a displacement map must be finite numbers");
    return {};
}

Result<std::vector<float>> channel_of(const Image& image, std::uint32_t channel) {
    const std::size_t count = std::size_t(image.width) * image.height;
    std::vector<float> out(count);
    for (std::size_t i = 0; i < count; ++i) {
        const float value = image.pixels[i * image.channels + channel];
        // NaN included.
        if (!(std::abs(value) <= largest_texel))
            return invalid(fmt::format(
                "texel ({}, {}) of the height map is {}; heights are finite numbers of at most "
                "1e30: repair the map, or choose another channel than {}",
                i % image.width, i / image.width, value, channel));
        out[i] = value;
    }
    return out;
}

// Whether all values are k / steps to float's rounding.
bool are_codes(const std::vector<float>& values, double steps) {
    const double tolerance = 2 * steps * 0x1p-24;
    return std::all_of(values.begin(), values.end(), [&](float value) {
        const double code = double(value) * steps;
        return code >= -tolerance && code <= steps + tolerance &&
               std::abs(code - std::round(code)) <= tolerance;
    });
}

// Integers of a file become its codes, which are exact; the mid-level becomes one of them.
void set_units(const Image& image, HeightMapData& map) {
    constexpr double byte_steps = 255, word_steps = 65535;
    map.unit = map.options.scale;
    map.mid = map.options.midlevel;
    const bool integers = image.integer_bits == 8 || image.integer_bits == 16;
    const double steps = image.integer_bits == 8 ? byte_steps : word_steps;
    if (integers && are_codes(map.raw, steps)) {
        for (float& value : map.raw) value = float(std::round(double(value) * steps));
        map.unit = map.options.scale / steps;
        map.mid = std::floor(map.options.midlevel * steps + 0.5);
        map.bits = map.file_bits = image.integer_bits;
        if (map.bits == 16 && std::all_of(map.raw.begin(), map.raw.end(),
                                          [](float code) { return std::int32_t(code) % 257 == 0; }))
            map.bits = 8;
        return;
    }
    // A mask of zeros and ones is no staircase, nor is what is far below the first step.
    const auto between = [](float value) {
        const double code = std::round(double(value) * byte_steps);
        return code > 0 && code < byte_steps;
    };
    if (std::any_of(map.raw.begin(), map.raw.end(), between) && are_codes(map.raw, byte_steps))
        map.bits = 8;
}

void place(HeightMapData& map) {
    const TextureRef& ref = map.options.placement;
    const double c = std::cos(double(ref.rotation)), s = std::sin(double(ref.rotation));
    const double sx = double(ref.scale.x), sy = double(ref.scale.y);
    map.matrix = glm::dmat2(c * sx, -s * sx, s * sy, c * sy);  // columns
    map.offset = glm::dvec2(ref.offset);
}

void finish(HeightMapData& map) {
    map.pyramid = make_height_pyramid(map, map.options.threads);
}

// All but its texels and what they were in the file.
std::shared_ptr<HeightMapData> like(const HeightMapData& other) {
    auto map = std::make_shared<HeightMapData>();
    map->options = other.options;
    map->unit = other.unit;
    map->mid = other.mid;
    map->matrix = other.matrix;
    map->offset = other.offset;
    return map;
}

// The gradient where it is asked for.
inline double raw_at_point(const HeightMapData& map, const glm::dvec2& p, glm::dvec2* gradient) {
    // Between the map's own texels: as below in its first region, with the same bits.
    if (p.x >= 0 && p.y >= 0 && p.x < double(map.x.size - 1) && p.y < double(map.y.size - 1)) {
        const glm::dvec2 along(p.x - double(map.x.first()), p.y - double(map.y.first()));
        const auto x = std::int64_t(along.x), y = std::int64_t(along.y);
        return raw_at(map, x + map.x.first(), y + map.y.first(), along.x - double(x),
                      along.y - double(y), gradient);
    }
    const AxisRegion rx = region(map.x, region_of(map.x, p.x));
    const AxisRegion ry = region(map.y, region_of(map.y, p.y));
    const CellPoint x = cell_point(map.x, rx.cell(p.x)), y = cell_point(map.y, ry.cell(p.y));
    const double value =
        raw_at(map, x.cell + map.x.first(), y.cell + map.y.first(), x.part, y.part, gradient);
    if (gradient) *gradient *= glm::dvec2(rx.turn, ry.turn);
    return value;
}

}  // namespace

RawSample raw_sample(const HeightMapData& map, const glm::dvec2& uv) {
    RawSample sample;
    sample.value = raw_at_point(map, map.map_point(uv), &sample.gradient);
    return sample;
}

double raw_value(const HeightMapData& map, const glm::dvec2& uv) {
    return raw_value_at(map, map.map_point(uv));
}

double raw_value_at(const HeightMapData& map, const glm::dvec2& point) {
    return raw_at_point(map, point, nullptr);
}

Result<HeightMap> HeightMap::make(const Image& image, const HeightMapOptions& options) {
    if (auto checked = check_options(image, options); !checked) return checked.error();
    auto raw = channel_of(image, options.channel);
    if (!raw) return raw.error();
    auto map = std::make_shared<HeightMapData>();
    map->options = options;
    const auto wrap = [](Wrap w) { return w == Wrap::border ? Wrap::clamp : w; };
    map->x = {std::int64_t(image.width), wrap(options.wrap_u)};
    map->y = {std::int64_t(image.height), wrap(options.wrap_v)};
    map->raw = std::move(*raw);
    set_units(image, *map);
    place(*map);
    finish(*map);
    return HeightMap(std::move(map));
}

HeightMap HeightMap::confined(ChartTriangles charts) const {
    auto map = like(*data_);
    map->x = data_->x;
    map->y = data_->y;
    map->bits = data_->bits;
    map->file_bits = data_->file_bits;
    map->raw = data_->raw;
    std::vector<std::uint8_t> covered = covered_texels(*map, charts);
    for (std::size_t t = 0; t < data_->kept.size(); ++t) covered[t] |= data_->kept[t];
    fill_gutters(*map, std::move(covered));
    finish(*map);
    return HeightMap(std::move(map));
}

Result<HeightMap::Limited> HeightMap::limited(const ChartAtlas& atlas, double spacing) const {
    auto filtered = filter_charts(*data_, atlas, spacing);
    if (!filtered) return std::move(filtered).error();
    auto map = like(*data_);
    const auto& is_unfolded = filtered->is_unfolded;
    map->x = {filtered->width, is_unfolded[0] ? Wrap::clamp : data_->x.wrap};
    map->y = {filtered->height, is_unfolded[1] ? Wrap::clamp : data_->y.wrap};
    map->raw = std::move(filtered->raw);
    map->kept = std::move(filtered->kept);
    if (is_unfolded[0] || is_unfolded[1]) {
        const glm::dvec2& scale = filtered->scale;
        map->matrix = glm::dmat2(scale.x, 0, 0, scale.y) * map->matrix;
        map->offset = scale * map->offset + filtered->shift;
    }
    finish(*map);
    return Limited{HeightMap(std::move(map)), filtered->change};
}

HeightSample HeightMap::at(const glm::dvec2& uv) const {
    const RawSample sample = raw_sample(*data_, uv);
    return {data_->height(sample.value), data_->unit * data_->mesh_gradient(sample.gradient)};
}

double HeightMap::value(const glm::dvec2& uv) const {
    return data_->height(raw_value(*data_, uv));
}

Deviation HeightMap::deviation(const std::array<glm::dvec2, 3>& uv,
                               const std::array<double, 3>& values, double enough,
                               std::uint32_t effort) const {
    if (const auto exact = bilinear_deviation(*data_, uv, values)) return *exact;
    return TriangleDeviation<1>({data_.get()}, uv, {{{{values[0]}}, {{values[1]}}, {{values[2]}}}},
                                enough, effort)
        .run();
}

double HeightMap::quantum() const {
    return precision().half_step;
}

MapPrecision HeightMap::precision() const {
    MapPrecision q{data_->bits, data_->file_bits, 0};
    if (q.bits > 0)
        q.half_step = 0.5 * std::abs(data_->options.scale) / (std::ldexp(1.0, q.bits) - 1);
    return q;
}

std::uint32_t HeightMap::width() const {
    return std::uint32_t(data_->x.size);
}
std::uint32_t HeightMap::height() const {
    return std::uint32_t(data_->y.size);
}

glm::dvec2 HeightMap::texel_size() const {
    const glm::dmat2 inverse = glm::inverse(data_->matrix);
    return {glm::length(inverse[0]) / double(data_->x.size),
            glm::length(inverse[1]) / double(data_->y.size)};
}

std::size_t HeightMap::memory() const {
    std::size_t bytes = data_->raw.size() * sizeof(float);
    for (const auto& level : data_->pyramid.levels)
        bytes += level.blocks.size() * sizeof(HeightBlock);
    return bytes;
}

}  // namespace prep::detail
