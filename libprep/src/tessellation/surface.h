// The surface that is displaced, as tessellation sees it: points of root triangles (domain.h),
// and bounds over triangles within them.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "tessellation/bisection.h"

namespace prep::detail {

struct BasePoint {
    glm::dvec3 position{0.0};
    glm::dvec3 direction{0.0, 0.0, 1.0};  // unit: where a height moves it
};

// Derivatives are by steps of the weights from corner a to corner b, and from a to the centre.
struct BaseFrame {
    BasePoint point;
    glm::dvec3 normal{0.0, 0.0, 1.0};  // unit: of shading, of this side of a hard edge
    std::array<glm::dvec3, 2> position_steps{}, direction_steps{};
};

// Suprema over a triangle of the distance between a value and the linear interpolation of its
// values at the triangle's corners; infinite where there is no bound.
struct BaseDeviation {
    double position = 0, direction = 0;
};

class BaseSurface {
  public:
    virtual ~BaseSurface() = default;
    // Sizes are equal. Serial; may be called on several threads. The same bits however points are
    // batched.
    virtual void evaluate(std::span<const RootPoint> at, std::span<BasePoint> points) const = 0;
    virtual void frames(std::span<const RootPoint> at, std::span<BaseFrame> frames) const = 0;
    // `corners`: the surface there, as the root has it.
    virtual BaseDeviation deviation(std::uint32_t root, const std::array<glm::dvec3, 3>& weights,
                                    const std::array<BasePoint, 3>& corners) const = 0;
    // A bound as well, mostly larger, where it takes much less time.
    virtual std::optional<BaseDeviation> coarse_deviation(
        std::uint32_t /*root*/, const std::array<glm::dvec3, 3>& /*weights*/) const {
        return std::nullopt;
    }
};

}  // namespace prep::detail
