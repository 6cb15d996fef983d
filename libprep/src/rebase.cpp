#include <cmath>

#include "prep/io.h"

namespace prep {
namespace {

bool finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

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

void set_positions(Mesh& mesh, std::span<const glm::dvec3> positions) {
    glm::dvec3 low(0.0), high(0.0);
    bool any = false, float_exact = true;
    for (const glm::dvec3& p : positions) {
        if (!finite(p)) continue;
        low = any ? glm::min(low, p) : p;
        high = any ? glm::max(high, p) : p;
        any = true;
        float_exact = float_exact && glm::dvec3(glm::vec3(p)) == p;
    }
    mesh.origin = glm::dvec3(0.0);
    if (any && !float_exact) {
        // Halved before adding: coordinates near the largest double must not overflow.
        const glm::dvec3 centre = low * 0.5 + high * 0.5;
        const glm::dvec3 extent = high * 0.5 - low * 0.5;
        const double distance = std::hypot(centre.x, centre.y, centre.z);
        const double diagonal = 2 * std::hypot(extent.x, extent.y, extent.z);
        if (distance > 8 * diagonal) mesh.origin = on_grid(centre, diagonal);
    }
    mesh.positions.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
        mesh.positions[i] = glm::vec3(positions[i] - mesh.origin);
}

}  // namespace prep
