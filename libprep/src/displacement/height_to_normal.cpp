#include <cmath>

#include "base/parallel.h"
#include "displacement/height_field.h"
#include "prep/displacement/sources.h"

namespace prep {

// The surface is u · size_u along the tangent, −v · size_v along the bitangent (v runs down) and
// the height along the normal; its normal is (−∂h/∂T, −∂h/∂B, 1). At texels' centres Catmull-Rom's
// slopes are central differences.
Result<Image> height_to_normal(const Image& heights, const HeightToNormalOptions& options,
                               int* bits) {
    const auto is_size = [](double size) { return std::isfinite(size) && size > 0; };
    if (!is_size(options.uv_size.x) || !is_size(options.uv_size.y) ||
        !std::isfinite(options.strength))
        return Error{ErrorCode::invalid,
                     "the lengths of a unit of u and v must be above 0, and the strength a number",
                     ""};
    HeightMapOptions as = options.map;
    as.filter = HeightFilter::bicubic;
    as.placement = {};  // the normal map is laid as the height map is
    const auto map = detail::HeightMap::make(heights, as);
    if (!map) return map.error();
    if (bits != nullptr) *bits = map->precision().bits;
    Image out;
    out.width = heights.width;
    out.height = heights.height;
    out.channels = 3;
    out.pixels.resize(std::size_t(out.width) * out.height * 3);
    detail::parallel_blocks(
        out.height, 16, options.map.threads, [&](std::size_t begin, std::size_t end) {
            for (std::size_t y = begin; y < end; ++y)
                for (std::size_t x = 0; x < out.width; ++x) {
                    const glm::dvec2 uv((double(x) + 0.5) / out.width,
                                        (double(y) + 0.5) / out.height);
                    // Steeper than any float's quotient, and squares are finite.
                    constexpr double steepest = 1e100;
                    const glm::dvec2 slope =
                        glm::clamp(map->at(uv).gradient / options.uv_size * options.strength,
                                   -steepest, steepest);
                    const double green = options.flip_green ? -slope.y : slope.y;
                    const double length = std::sqrt(slope.x * slope.x + slope.y * slope.y + 1);
                    float* const texel = &out.pixels[(y * out.width + x) * 3];
                    texel[0] = float(0.5 - 0.5 * slope.x / length);
                    texel[1] = float(0.5 + 0.5 * green / length);
                    texel[2] = float(0.5 + 0.5 / length);
                }
        });
    return out;
}

}  // namespace prep
