#include "formats/gltf/nodes/sheared_matrix.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace prep::detail {
namespace {

// Turns the columns of `a` about one another until they are at right angles; `v` turns with them
// (Hestenes 1958).
void orthogonalize(glm::dmat3& a, glm::dmat3& v) {
    constexpr int most_sweeps = 60;
    bool turned = true;
    for (int sweep = 0; sweep < most_sweeps && turned; ++sweep) {
        turned = false;
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) {
                const double pp = glm::dot(a[p], a[p]), qq = glm::dot(a[q], a[q]);
                const double pq = glm::dot(a[p], a[q]);
                if (!(std::abs(pq) > 1e-16 * std::sqrt(pp) * std::sqrt(qq))) continue;
                turned = true;
                const double zeta = (qq - pp) / (2 * pq);
                const double t = std::copysign(1 / (std::abs(zeta) + std::hypot(1.0, zeta)), zeta);
                const double c = 1 / std::hypot(1.0, t), s = c * t;
                for (glm::dmat3* m : {&a, &v}) {
                    const glm::dvec3 old = (*m)[p];
                    (*m)[p] = c * old - s * (*m)[q];
                    (*m)[q] = s * old + c * (*m)[q];
                }
            }
    }
}

// A unit vector at a right angle to one.
glm::dvec3 across(const glm::dvec3& unit) {
    const glm::dvec3 size = glm::abs(unit);
    glm::dvec3 axis(0.0);
    axis[size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2] = 1;
    return glm::normalize(axis - unit * glm::dot(axis, unit));
}

// Unit vectors along the columns, and what is missing to a rotation; their lengths in `scale`, one
// of them negative where the matrix mirrors.
glm::dmat3 rotation_of(const glm::dmat3& columns, glm::dvec3& scale) {
    double largest = 0;
    for (int c = 0; c < 3; ++c) largest = std::max(largest, glm::length(columns[c]));
    glm::dmat3 unit(0.0);
    for (int c = 0; c < 3; ++c) {
        scale[c] = glm::length(columns[c]);
        if (!(scale[c] > 1e-15 * largest)) scale[c] = 0;
        if (scale[c] != 0) unit[c] = columns[c] / scale[c];
    }
    for (int c = 0; c < 3; ++c) {
        if (scale[c] != 0) continue;
        // Zero where it is not known yet either.
        const glm::dvec3 &a = unit[(c + 1) % 3], &b = unit[(c + 2) % 3];
        const glm::dvec3 both = glm::cross(a, b);
        unit[c] = both != glm::dvec3(0.0) ? glm::normalize(both) : across(a + b);
    }
    if (glm::determinant(unit) < 0) {
        unit[0] = -unit[0];
        scale[0] = -scale[0];
    }
    return unit;
}

}  // namespace

bool is_scaled_rotation(const glm::dmat4& matrix) {
    constexpr double roundings = 1e-6;
    const glm::dmat3 axes(matrix);
    for (int a = 0; a < 3; ++a) {
        const glm::dvec3 &p = axes[a], &q = axes[(a + 1) % 3];
        const double lengths = glm::length(p) * glm::length(q);
        if (!(std::abs(glm::dot(p, q)) <= roundings * lengths)) return false;
    }
    return glm::determinant(axes) != 0;
}

std::pair<Trs, Trs> as_two_nodes(const glm::dmat4& matrix) {
    double size = 0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) size = std::max(size, std::abs(matrix[c][r]));
    const glm::dmat3 linear(matrix);
    glm::dmat3 axes = size > 0 ? linear / size : linear, v(1.0);
    orthogonalize(axes, v);
    Trs outer, inner;
    outer.translation = glm::dvec3(matrix[3]);
    outer.rotation = glm::normalize(glm::quat_cast(rotation_of(axes, outer.scale)));
    outer.scale *= size;
    inner.rotation = glm::normalize(glm::quat_cast(glm::transpose(v)));
    return {outer, inner};
}

}  // namespace prep::detail
