// Exact rational arithmetic (CGAL) behind normals and hard edges: the slow truth that the filtered
// paths fall back to.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "prep/mesh.h"

namespace prep::detail {

// Newell's sum of a face with finite positions, exact, each component rounded to double once.
glm::dvec3 exact_area_vector(const MeshView& mesh, std::uint32_t face);

// The sum of several faces' area vectors, exact. The result is scaled by a power of two so that its
// largest component is in [0.5, 1]; it is zero only if the exact sum is.
glm::dvec3 exact_area_sum(const MeshView& mesh, std::span<const std::uint32_t> faces);

// A cosine as sign · sqrt(squared), with the square exact: numerator / denominator.
struct ExactCosine {
    int sign = 0;                                           // −1, 0, 1
    double squared_numerator = 0, squared_denominator = 1;  // both exact in double
    double cosine = 0;                                      // rounded, for the filter
};

// The cosine of an angle in degrees. Squares are exact for 0, 30, 45, 60, 90, 120, 135, 150, 180;
// elsewhere the rounded cosine is taken as exact (`value` then is the cosine and its square is
// formed exactly in exact_turn_exceeds).
struct Threshold {
    bool exact_square = false;
    ExactCosine cosine;
};
Threshold threshold_of(double degrees);

// Whether the turn between two faces' normals is larger than the threshold, decided on the exact
// coordinates. Faces whose exact area vector is zero give false.
bool exact_turn_exceeds(const MeshView& mesh, std::uint32_t face0, std::uint32_t face1,
                        const Threshold& threshold);

}  // namespace prep::detail
