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
    std::vector<Real> sizes(fans, 0);  // of all products that went into the sum, without signs
    std::vector<std::size_t> counts(fans, 0);
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
            sizes[corner_fans[c]] += size;
            counts[corner_fans[c]] += last - first - 2;
        }
    }
    // A component of a triangle's vector is a difference of two products, at most twice its size:
    // four roundings, of two edges, product and difference; then at most one for each triangle of
    // the fan (Higham 2002, sec. 4.2). √3 for three components, half an epsilon a rounding, and the
    // rest for what is of second order.
    for (std::size_t i = 0; i < fans; ++i) {
        const Real length =
            std::sqrt(out.sums[i].x * out.sums[i].x + out.sums[i].y * out.sums[i].y +
                      out.sums[i].z * out.sums[i].z);
        const Real unit = 2 * Real(counts[i] + 4) * std::numeric_limits<Real>::epsilon();
        const Real angle = length > 0 ? unit * sizes[i] / length : Real(10);
        out.bounds.push_back(
            double(std::min(angle, Real(std::numbers::pi)) * 180 / std::numbers::pi_v<Real>));
    }
    return out;
}

}  // namespace cost
