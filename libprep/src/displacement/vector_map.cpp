#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "displacement/height_data.h"
#include "displacement/height_field.h"
#include "displacement/triangle_deviation.h"

namespace prep::detail {
namespace {

// Which of the map's channels the tangent, bitangent and normal (x, y and z) are.
std::array<std::uint32_t, 3> order_of(VectorAxes axes) {
    if (axes == VectorAxes::tangent_normal_bitangent) return {0, 2, 1};
    return {0, 1, 2};
}

VectorSample together(const std::array<HeightSample, 3>& s) {
    return {{s[0].value, s[1].value, s[2].value},
            {s[0].gradient.x, s[1].gradient.x, s[2].gradient.x},
            {s[0].gradient.y, s[1].gradient.y, s[2].gradient.y}};
}

}  // namespace

Result<VectorMap> VectorMap::make(const Image& image, const VectorMapOptions& options) {
    if (image.channels < 3 || options.map.channel > image.channels - 3)
        return Error{ErrorCode::invalid,
                     fmt::format("a vector displacement map needs three channels from channel {} "
                                 "on; the picture has {}",
                                 options.map.channel, image.channels),
                     ""};
    const std::array<std::uint32_t, 3> order = order_of(options.axes);
    const auto channel = [&](std::size_t k) {
        HeightMapOptions of = options.map;
        of.channel += order[k];
        if (options.flip[k]) of.scale = -of.scale;
        return HeightMap::make(image, of);
    };
    auto x = channel(0), y = channel(1), z = channel(2);
    for (const auto* made : {&x, &y, &z})
        if (!*made) return made->error();
    return VectorMap(options.axes, {std::move(*x), std::move(*y), std::move(*z)});
}

VectorSample VectorMap::at(const glm::dvec2& uv) const {
    return together({channels_[0].at(uv), channels_[1].at(uv), channels_[2].at(uv)});
}

Deviation VectorMap::deviation(const std::array<glm::dvec2, 3>& uv,
                               const std::array<glm::dvec3, 3>& values, double enough,
                               std::uint32_t effort) const {
    std::array<std::array<double, 3>, 3> of;
    for (std::size_t k = 0; k < 3; ++k) of[k] = {values[k].x, values[k].y, values[k].z};
    return TriangleDeviation<3>(
               {channels_[0].data_.get(), channels_[1].data_.get(), channels_[2].data_.get()}, uv,
               of, enough, effort)
        .run();
}

std::array<Interval, 3> VectorMap::range(const glm::dvec2& low, const glm::dvec2& high) const {
    return {channels_[0].range(low, high), channels_[1].range(low, high),
            channels_[2].range(low, high)};
}

double VectorMap::longest(const glm::dvec2& low, const glm::dvec2& high) const {
    double squares = 0;
    for (const HeightMap& channel : channels_) {
        const Interval r = channel.range(low, high);
        const double most = std::max(std::abs(r.low), std::abs(r.high));
        squares += most * most;
    }
    return std::sqrt(squares) * (1 + 0x1p-50);
}

double VectorMap::steepest(const glm::dvec2& low, const glm::dvec2& high) const {
    double squares = 0;
    for (const HeightMap& channel : channels_) {
        const double most = channel.steepest(low, high);
        squares += most * most;
    }
    return std::sqrt(squares) * (1 + 0x1p-50);
}

VectorMap VectorMap::confined(ChartTriangles charts) const {
    return VectorMap(axes_, {channels_[0].confined(charts), channels_[1].confined(charts),
                             channels_[2].confined(charts)});
}

Result<VectorMap::Limited> VectorMap::limited(const ChartAtlas& atlas, double spacing) const {
    std::array<HeightMap, 3> channels = channels_;
    double squares = 0;
    for (HeightMap& channel : channels) {
        auto limited = channel.limited(atlas, spacing);
        if (!limited) return std::move(limited).error();
        channel = std::move(limited->map);
        squares += limited->change * limited->change;
    }
    return Limited{VectorMap(axes_, std::move(channels)), std::sqrt(squares)};
}

double VectorMap::quantum() const {
    // Half a step of each at once.
    double squares = 0;
    for (const HeightMap& channel : channels_) squares += channel.quantum() * channel.quantum();
    return std::sqrt(squares);
}

MapPrecision VectorMap::precision() const {
    MapPrecision q = channels_[0].precision();
    for (const HeightMap& channel : channels_)
        if (const MapPrecision other = channel.precision();
            q.bits != 0 && (other.bits == 0 || other.bits > q.bits))
            q = other;
    q.half_step = quantum();
    return q;
}

}  // namespace prep::detail
