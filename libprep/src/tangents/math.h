// Float vector arithmetic in the exact order that MikkTSpace's definition fixes. Nothing here may
// be contracted, reassociated or replaced by reciprocal estimates: bits depend on it.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace prep::detail {
namespace mikk {

// "Zero" is up to the smallest normal float.
inline bool not_zero(float x) {
    return std::abs(x) > std::numeric_limits<float>::min();
}
inline bool not_zero(const glm::vec3& v) {
    return not_zero(v.x) || not_zero(v.y) || not_zero(v.z);
}
inline float dot(const glm::vec3& a, const glm::vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline float length_squared(const glm::vec3& v) {
    return dot(v, v);
}
inline float length(const glm::vec3& v) {
    return std::sqrt(length_squared(v));
}
inline glm::vec3 scaled(float s, const glm::vec3& v) {
    return {s * v.x, s * v.y, s * v.z};
}
inline glm::vec3 normalized(const glm::vec3& v) {
    return scaled(1.0f / length(v), v);
}
inline glm::vec3 normalized_or_zero(const glm::vec3& v) {
    return not_zero(v) ? normalized(v) : v;
}
// On the plane of n, then unit where that is possible.
inline glm::vec3 projected(const glm::vec3& n, const glm::vec3& v) {
    return normalized_or_zero(v - scaled(dot(n, v), n));
}
// The weight of a triangle at its corner p, between its edges to `a` and to `b`.
inline float corner_angle(const glm::vec3& n, const glm::vec3& p, const glm::vec3& a,
                          const glm::vec3& b) {
    const float cosine = dot(projected(n, a - p), projected(n, b - p));
    const float clamped = cosine > 1.0f ? 1.0f : cosine < -1.0f ? -1.0f : cosine;
    return float(std::acos(double(clamped)));
}

}  // namespace mikk

// Normals up to 0.1 % from unit are used as they are (text files often keep four digits); others
// are made unit first, because projecting on the plane of a normal of length 2 mirrors.
inline bool far_from_unit(const glm::vec3& n) {
    return !(std::abs(mikk::length_squared(n) - 1.0f) <= 2e-3f);
}
// Zero and non-finite ones stay what they are.
inline glm::vec3 frame_normal(const glm::vec3& n) {
    if (!far_from_unit(n)) return n;
    const glm::dvec3 d(n);
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    if (!(largest > 0) || !std::isfinite(largest)) return n;
    return glm::vec3(glm::normalize(d / largest));
}

// Is t a tangent to n, by far? (Whoever finds none looks again, exactly.)
inline bool is_frame(const glm::vec3& n, const glm::vec3& t) {
    const float length2 = mikk::dot(t, t), along = mikk::dot(n, t);
    const bool has_normal = mikk::dot(n, n) > 0.5f;
    return has_normal && std::abs(length2 - 1.0f) <= 1e-6f && std::abs(along) <= 5e-7f;
}

}  // namespace prep::detail
