#include "shading/slopes.h"

#include <cmath>

#include "shading/texture.h"

namespace rast::detail {
namespace {

// Steep enough for any surface, and far from where a filter's sums leave float's range.
constexpr double steepest = 0x1p100;

float kept(double slope) {
    return std::abs(slope) <= steepest ? float(slope) : 0.0f;  // NaN fails
}

// One axis of the picture of slopes.
struct Axis {
    std::uint32_t units, size;
    prep::Wrap heights, slopes;
};

Axis axis_of(std::uint32_t size, prep::Wrap wrap) {
    if (wrap == prep::Wrap::mirror) return {2, 2 * size, wrap, prep::Wrap::repeat};
    return {1, size, wrap == prep::Wrap::border ? prep::Wrap::clamp : wrap, wrap};
}

}  // namespace

Slopes slopes_of(const prep::Image& heights, const prep::Texture& sampler) {
    const Axis u = axis_of(heights.width, sampler.wrap_u);
    const Axis v = axis_of(heights.height, sampler.wrap_v);
    Slopes out{{}, sampler, glm::vec2(float(u.units), float(v.units))};
    out.sampler.wrap_u = u.slopes;
    out.sampler.wrap_v = v.slopes;
    out.image.width = u.size;
    out.image.height = v.size;
    out.image.channels = 3;
    out.image.floating = true;
    out.image.pixels.assign(std::size_t(u.size) * v.size * 3, 0.0f);
    const auto height = [&](std::int64_t x, std::int64_t y) {
        const auto column = std::size_t(wrap_texel(x, heights.width, u.heights));
        const auto row = std::size_t(wrap_texel(y, heights.height, v.heights));
        return double(heights.pixels[(row * heights.width + column) * heights.channels]);
    };
    float* texel = out.image.pixels.data();
    for (std::int64_t y = 0; y < v.size; ++y)
        for (std::int64_t x = 0; x < u.size; ++x, texel += 3) {
            texel[0] = kept((height(x + 1, y) - height(x - 1, y)) * u.size / 2);
            texel[1] = kept((height(x, y + 1) - height(x, y - 1)) * v.size / 2);
        }
    return out;
}

}  // namespace rast::detail
