// Float vector arithmetic in the exact order that MikkTSpace's definition fixes. Nothing here may
// be contracted, reassociated or replaced by reciprocal estimates: bits depend on it.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace prep::detail::mikk {

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
// On the plane of n, then unit where that is possible.
inline glm::vec3 projected(const glm::vec3& n, const glm::vec3& v) {
    const glm::vec3 p = v - scaled(dot(n, v), n);
    return not_zero(p) ? normalized(p) : p;
}

}  // namespace prep::detail::mikk
