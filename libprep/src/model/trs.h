// Translation, rotation and scale of matrices and of products.
#pragma once

#include <glm/glm.hpp>

#include "prep/scene.h"

namespace prep::detail {

// Of a matrix without shear; where there is shear, the nearest along its own axes. A diagonal
// keeps its signs, any other mirror becomes a negative x.
Trs trs_of(const glm::dmat4& matrix);

// The largest difference of the matrix from that of `trs`, relative to the matrix' own linear part.
double shear_of(const glm::dmat4& matrix, const Trs& trs);

// A matrix of floats that only turns or moves has columns that are nearly of length 1: scales that
// differ from 1, or from one another, by less than 1e-5 are equal.
Trs without_roundings(Trs trs);

// parent · child, exact where it is of that form: no scale but a uniform one before a rotation.
// False: it is not.
bool multiply(const Trs& parent, const Trs& child, Trs& product);

}  // namespace prep::detail
