#include "cost/oracles/weighted_normals.h"

#include <cmath>

namespace cost {

std::vector<Vector> weighted_normals(std::span<const glm::vec3> positions,
                                     std::span<const std::uint32_t> corner_vertices,
                                     const std::string& weight) {
    const auto cross = [](const Vector& a, const Vector& b) {
        return Vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    };
    const auto length = [](const Vector& v) {
        return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    };
    std::vector<Vector> sums(positions.size(), Vector(0));
    for (std::size_t first = 0; first < corner_vertices.size(); first += 3)
        for (std::size_t i = 0; i < 3; ++i) {
            const auto at = [&](std::size_t k) {
                return Vector(positions[corner_vertices[first + (i + k) % 3]]);
            };
            const Vector a = at(1) - at(0), b = at(2) - at(0), area = cross(a, b);
            const Real twice = length(area);
            const Real angle = std::atan2(twice, a.x * b.x + a.y * b.y + a.z * b.z);
            const Real sine = twice / (length(a) * length(b));
            Real w = 0;
            if (weight == "area")
                w = twice / 2;
            else if (weight == "uniform")
                w = 1;
            else if (weight == "angle")
                w = angle;
            else if (weight == "area-angle")
                w = twice / 2 * angle;
            else if (weight == "edge-length")
                w = sine / (length(a) * length(b));
            else
                return {};
            sums[corner_vertices[first + i]] += area / twice * w;
        }
    return sums;
}

}  // namespace cost
