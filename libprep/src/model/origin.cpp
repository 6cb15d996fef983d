#include "model/origin.h"

#include <cmath>

#include "prep/mesh.h"

namespace prep {
namespace detail {
namespace {

constexpr double far = 8;  // from zero, in diagonals

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

// Halved before adding: coordinates near the largest double must not overflow.
glm::dvec3 PositionBounds::centre() const {
    return low_ * 0.5 + high_ * 0.5;
}

double PositionBounds::diagonal() const {
    const glm::dvec3 extent = high_ * 0.5 - low_ * 0.5;
    return 2 * std::hypot(extent.x, extent.y, extent.z);
}

glm::dvec3 PositionBounds::origin() const {
    return float_exact_ ? glm::dvec3(0.0) : far_origin();
}

glm::dvec3 PositionBounds::far_origin() const {
    if (!any_) return glm::dvec3(0.0);
    const glm::dvec3 middle = centre();
    const double across = diagonal();
    return std::hypot(middle.x, middle.y, middle.z) > far * across ? on_grid(middle, across)
                                                                   : glm::dvec3(0.0);
}

// A part's centre is within half of the whole's diagonal of the whole's.
bool PositionBounds::may_be_far() const {
    if (!any_) return false;
    const glm::dvec3 middle = centre();
    return std::hypot(middle.x, middle.y, middle.z) > (far - 0.5) * diagonal();
}

bool may_be_far(std::span<const glm::vec3> positions) {
    PositionBounds bounds;
    for (const glm::vec3& p : positions) bounds.add(glm::dvec3(p));
    return bounds.may_be_far();
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
