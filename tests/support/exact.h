// Exact arithmetic for tests, apart from the product's: rationals from Boost.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>
#include <glm/glm.hpp>

#include "prep/mesh.h"

namespace exact {

using Rational = boost::multiprecision::cpp_rational;
struct Vector {
    Rational x, y, z;
    friend bool operator==(const Vector& a, const Vector& b) {
        return a.x == b.x && a.y == b.y && a.z == b.z;
    }
};

inline Vector vector(const glm::dvec3& v) {
    return {Rational(v.x), Rational(v.y), Rational(v.z)};
}
inline Vector operator-(const Vector& a, const Vector& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vector operator+(const Vector& a, const Vector& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Rational dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Newell's sum of a face, on absolute coordinates.
inline Vector area_vector(const prep::Mesh& mesh, std::uint32_t face) {
    const std::uint32_t begin = mesh.face_offsets[face], end = mesh.face_offsets[face + 1];
    Vector sum{0, 0, 0};
    for (std::uint32_t c = begin; c < end; ++c) {
        const std::uint32_t d = c + 1 == end ? begin : c + 1;
        sum = sum + cross(vector(glm::dvec3(mesh.positions[mesh.corner_vertices[c]])),
                          vector(glm::dvec3(mesh.positions[mesh.corner_vertices[d]])));
    }
    return sum;
}

// Whether the angle between a and b exceeds the one whose cosine has this sign and square.
inline bool turn_exceeds(const Vector& a, const Vector& b, int sign, const Rational& squared) {
    const Rational s = dot(a, b), left = s * s, right = squared * dot(a, a) * dot(b, b);
    if (sign >= 0) return s < 0 || left < right;
    return s < 0 && left > right;
}

// The angle in radians between an exact direction and a double one, to about 1e-16 relative.
double angle_between(const Vector& truth, const glm::dvec3& value);

}  // namespace exact
