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

}  // namespace

prep::Image slopes_of(const prep::Image& heights, const prep::Texture& sampler) {
    prep::Image out;
    out.width = heights.width;
    out.height = heights.height;
    out.channels = 3;
    out.floating = true;
    out.pixels.assign(std::size_t(out.width) * out.height * 3, 0.0f);
    const auto wrap_of = [](prep::Wrap wrap) {
        return wrap == prep::Wrap::border ? prep::Wrap::clamp : wrap;
    };
    const prep::Wrap wrap_u = wrap_of(sampler.wrap_u), wrap_v = wrap_of(sampler.wrap_v);
    const auto height = [&](std::int64_t x, std::int64_t y) {
        const auto column = std::size_t(wrap_texel(x, out.width, wrap_u));
        const auto row = std::size_t(wrap_texel(y, out.height, wrap_v));
        return double(heights.pixels[(row * out.width + column) * heights.channels]);
    };
    for (std::int64_t y = 0; y < out.height; ++y)
        for (std::int64_t x = 0; x < out.width; ++x) {
            const double along_u = (height(x + 1, y) - height(x - 1, y)) * out.width / 2;
            const double along_v = (height(x, y + 1) - height(x, y - 1)) * out.height / 2;
            float* const texel = &out.pixels[(std::size_t(y) * out.width + std::size_t(x)) * 3];
            texel[0] = kept(along_u);
            texel[1] = kept(along_v);
        }
    return out;
}

}  // namespace rast::detail
