// Texels of a chart: a box of a map, those that are covered, and a plane of heights over them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "displacement/map_charts.h"

namespace prep::detail {

struct TexelBox {
    std::int64_t x = 0, y = 0, width = 0, height = 0;
    std::size_t size() const { return std::size_t(width) * std::size_t(height); }
    bool has(std::int64_t i, std::int64_t j) const {
        return i >= x && j >= y && i < x + width && j < y + height;
    }
};

// Between a map's texels and those of a box of steps of them.
inline glm::dvec2 from_steps(const glm::dvec2& own, const TexelBox& in, const glm::i64vec2& step) {
    return (own + glm::dvec2(double(in.x), double(in.y)) + 0.5) * glm::dvec2(step) - 0.5;
}
inline glm::dvec2 to_steps(const glm::dvec2& at, const TexelBox& in, const glm::i64vec2& step) {
    return (at + 0.5) / glm::dvec2(step) - 0.5 - glm::dvec2(double(in.x), double(in.y));
}

struct HeightPlane {
    glm::dvec2 from{0.0}, slope{0.0};
    double height = 0;
    double at(const glm::dvec2& p) const { return height + glm::dot(slope, p - from); }
};

// The texels that a chart covers, by the map's wrap where it wraps.
struct CoveredTexels {
    TexelRange x, y;
    std::vector<std::uint8_t> mask;
    bool operator()(std::int64_t i, std::int64_t j) const {
        if (x.wraps) i = x.axis.texel(i);
        if (y.wraps) j = y.axis.texel(j);
        const std::int64_t column = i - x.first, row = j - y.first;
        return column >= 0 && row >= 0 && column < x.count && row < y.count &&
               mask[std::size_t(row * x.count + column)];
    }
};

// Through the first texel, its slope by least squares of all those covered in a box; level along
// axes that wrap.
HeightPlane fitted_plane(const HeightMapData& map, const TexelBox& in, const CoveredTexels& covered,
                         const std::array<bool, 2>& wraps);

}  // namespace prep::detail
