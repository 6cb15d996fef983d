#include <cmath>

#include "prep/io.h"

namespace prep {
namespace {

bool finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
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
        if (distance > 8 * diagonal) mesh.origin = centre;
    }
    mesh.positions.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
        mesh.positions[i] = glm::vec3(positions[i] - mesh.origin);
}

}  // namespace prep
