#include "cost/oracles/fan_normals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cost {
namespace {

Real size_of(const Vector& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

FanNormals area_fan_normals(std::span<const glm::vec3> positions,
                            std::span<const std::uint32_t> face_offsets,
                            std::span<const std::uint32_t> corner_vertices,
                            std::span<const std::uint32_t> corner_fans, std::size_t fans) {
    FanNormals out;
    out.sums.assign(fans, Vector(0));
    std::vector<Real> terms(fans, 0);  // sizes of all products that went into the sum
    for (std::size_t f = 0; f + 1 < face_offsets.size(); ++f) {
        const std::uint32_t first = face_offsets[f], last = face_offsets[f + 1];
        const Vector origin(positions[corner_vertices[first]]);
        Vector area(0);
        Real size = 0;
        for (std::uint32_t c = first + 1; c + 1 < last; ++c) {
            const Vector a = Vector(positions[corner_vertices[c]]) - origin;
            const Vector b = Vector(positions[corner_vertices[c + 1]]) - origin;
            area += Vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
            size += size_of(a) * size_of(b);
        }
        for (std::uint32_t c = first; c < last; ++c) {
            if (corner_fans[c] == 0xffffffffu) continue;
            out.sums[corner_fans[c]] += area;
            terms[corner_fans[c]] += size;
        }
    }
    // Each product, difference and sum of a component is rounded once; 32 units for the few
    // operations of a term, whose sizes are added up without signs, hold for fans of up to 16
    // faces.
    const Real unit = 32 * std::numeric_limits<Real>::epsilon();
    for (std::size_t i = 0; i < fans; ++i) {
        const Real length =
            std::sqrt(out.sums[i].x * out.sums[i].x + out.sums[i].y * out.sums[i].y +
                      out.sums[i].z * out.sums[i].z);
        const Real angle = length > 0 ? unit * terms[i] / length : Real(10);
        out.bounds.push_back(
            double(std::min(angle, Real(std::numbers::pi)) * 180 / std::numbers::pi_v<Real>));
    }
    return out;
}

}  // namespace cost
