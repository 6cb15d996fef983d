#include "displacement/chart_texels.h"

#include "displacement/chart_continuation.h"

namespace prep::detail {

HeightPlane fitted_plane(const HeightMapData& map, const TexelBox& in, const CoveredTexels& covered,
                         const std::array<bool, 2>& wraps) {
    HeightPlane plane;
    PlaneFit fit;
    bool any = false;
    for (std::int64_t j = in.y; j < in.y + in.height; ++j)
        for (std::int64_t i = in.x; i < in.x + in.width; ++i) {
            if (!covered(i, j)) continue;
            const glm::dvec2 at{double(i), double(j)};
            if (!any) plane = {at, glm::dvec2(0.0), map.texel(i, j)};
            any = true;
            fit.add(at - plane.from, map.texel(i, j) - plane.height, 1);
        }
    plane.slope = fit.slope();
    for (glm::length_t k = 0; k < 2; ++k)
        if (wraps[std::size_t(k)]) plane.slope[k] = 0;
    return plane;
}

}  // namespace prep::detail
