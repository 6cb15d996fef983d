// Pairs of triangles whose dihedral turn is exactly a threshold, and rotations that keep it exact:
// all arithmetic is on integers that floats hold.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <random>
#include <vector>

#include "prep/mesh.h"

namespace hard_cases {

// Integer normals whose angle is exactly `degrees`; its cosine has this sign and this square.
struct ExactAngle {
    double degrees;
    glm::ivec3 n0, n1;
    int sign, squared_numerator, squared_denominator;
};
const std::vector<ExactAngle>& exact_angles();

// `count` pairs (shapes::wedge) at exactly that angle, apart from each other, their wings stretched
// and slid at random along the common edge. Corners 6i and 6i + 3 lie on the common edge of pair i.
prep::Mesh exact_dihedrals(const ExactAngle& angle, std::uint32_t count, std::mt19937_64& random);

// A random rotation (integer quaternion, parts up to `size` either way) times an integer.
glm::dmat3 exact_rotation(int size, std::mt19937_64& random);

// Every position by the matrix, then by 2^exponent. False where a coordinate was rounded: then
// nothing is exact any more.
bool transform_exactly(prep::Mesh& mesh, const glm::dmat3& matrix, int exponent);

}  // namespace hard_cases
