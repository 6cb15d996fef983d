#include "model/origin.h"

#include <cmath>

#include "prep/mesh.h"

namespace prep {
namespace detail {
namespace {

// The centre with no more digits than it needs: differences from it, and sums with them, are exact
// as far as the coordinates' own digits reach, and a mesh written and read again gets the same one.
glm::dvec3 on_grid(const glm::dvec3& centre, double diagonal) {
    if (!(diagonal > 0)) return centre;
    const double step = std::ldexp(1.0, std::ilogb(diagonal) - 4);
    if (!(step > 0) || !std::isfinite(centre.x / step + centre.y / step + centre.z / step))
        return centre;
    return {std::nearbyint(centre.x / step) * step, std::nearbyint(centre.y / step) * step,
            std::nearbyint(centre.z / step) * step};
}

}  // namespace

glm::dvec3 PositionBounds::origin() const {
    if (!any_ || float_exact_) return glm::dvec3(0.0);
    // Halved before adding: coordinates near the largest double must not overflow.
    const glm::dvec3 centre = low_ * 0.5 + high_ * 0.5;
    const glm::dvec3 extent = high_ * 0.5 - low_ * 0.5;
    const double distance = std::hypot(centre.x, centre.y, centre.z);
    const double diagonal = 2 * std::hypot(extent.x, extent.y, extent.z);
    return distance > 8 * diagonal ? on_grid(centre, diagonal) : glm::dvec3(0.0);
}

}  // namespace detail

void set_positions(Mesh& mesh, std::span<const glm::dvec3> positions) {
    detail::PositionBounds bounds;
    for (const glm::dvec3& p : positions) bounds.add(p);
    mesh.origin = bounds.origin();
    mesh.positions.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
        mesh.positions[i] = glm::vec3(positions[i] - mesh.origin);
}

}  // namespace prep
