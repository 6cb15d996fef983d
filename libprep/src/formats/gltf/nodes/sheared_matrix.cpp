#include "formats/gltf/nodes/sheared_matrix.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace prep::detail {
namespace {

// Off a right angle by no more than matrices of floats are. The format's validator compares
// numbers as they are, not beside their size.
bool is_at_right_angles(const glm::dmat3& axes) {
    for (int a = 0; a < 3; ++a) {
        const glm::dvec3 &p = axes[a], &q = axes[(a + 1) % 3];
        const double length = glm::length(p), other = glm::length(q);
        if (std::abs(glm::dot(p, q)) >
            std::min(1e-6 * length * other, 1e-4 * std::min(length, other)))
            return false;
    }
    return true;
}

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

// Unit vectors along the columns, and what is missing to a rotation; their lengths in `scale`, one
// of them negative where the matrix mirrors.
glm::dmat3 rotation_of(const glm::dmat3& columns, glm::dvec3& scale) {
    const double largest =
        std::max({glm::length(columns[0]), glm::length(columns[1]), glm::length(columns[2])});
    glm::dmat3 unit(1.0);
    std::array<bool, 3> known{};
    for (int c = 0; c < 3; ++c) {
        scale[c] = glm::length(columns[c]);
        if (!(scale[c] > 1e-15 * largest)) {
            scale[c] = 0;
            continue;
        }
        unit[c] = columns[c] / scale[c];
        known[std::size_t(c)] = true;
    }
    for (int c = 0; c < 3; ++c) {
        if (known[std::size_t(c)]) continue;
        const int a = (c + 1) % 3, b = (c + 2) % 3;
        if (!known[std::size_t(a)] || !known[std::size_t(b)]) {
            // Across one that is known, or any.
            const glm::dvec3 other = known[std::size_t(a)]   ? unit[a]
                                     : known[std::size_t(b)] ? unit[b]
                                                             : glm::dvec3(0.0);
            const glm::dvec3 small = glm::abs(other);
            glm::dvec3 axis(0.0);
            axis[small.x <= small.y && small.x <= small.z ? 0 : small.y <= small.z ? 1 : 2] = 1;
            unit[c] = glm::normalize(axis - other * glm::dot(axis, other));
        } else {
            unit[c] = glm::cross(unit[a], unit[b]);
        }
        known[std::size_t(c)] = true;
    }
    if (glm::determinant(unit) < 0) {
        unit[0] = -unit[0];
        scale[0] = -scale[0];
    }
    return unit;
}

}  // namespace

std::optional<std::pair<Trs, Trs>> as_two_nodes(const glm::dmat4& matrix) {
    const glm::dmat3 linear(matrix);
    double size = 0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) {
            if (!std::isfinite(linear[c][r])) return std::nullopt;  // an error of the scene's own
            size = std::max(size, std::abs(linear[c][r]));
        }
    if (size > 0 && glm::determinant(linear) != 0 && is_at_right_angles(linear))
        return std::nullopt;
    glm::dmat3 axes = size > 0 ? linear / size : linear, v(1.0);
    orthogonalize(axes, v);
    Trs outer, inner;
    outer.translation = glm::dvec3(matrix[3]);
    outer.rotation = glm::normalize(glm::quat_cast(rotation_of(axes, outer.scale)));
    outer.scale *= size;
    inner.rotation = glm::normalize(glm::quat_cast(glm::transpose(v)));
    return std::pair(outer, inner);
}

}  // namespace prep::detail
