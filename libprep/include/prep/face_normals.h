// Face normals and areas by Newell's sum, at any scale.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "prep/mesh.h"

namespace prep {

enum class Precision : std::uint8_t {
    fast,      // float arithmetic
    accurate,  // double, scaled by powers of two, compensated
    exact,     // exact rationals (CGAL), rounded once: slow, the oracle
};

enum class FaceState : std::uint8_t {
    regular,
    zero_area,   // the area vector is exactly zero
    non_finite,  // a corner's position is NaN or infinite
};

// Positions are float, so that in double neither areas of 1e-90 (scale 1e-45) nor of 1e77 leave the
// range: no scaling is needed, the values are absolute.
struct FaceNormals {
    // Per face: normal direction with the length of twice the area (for planar faces); zero where
    // the state is not regular.
    std::vector<glm::dvec3> area_vectors;
    std::vector<double> errors;  // per face: bound on the length of area_vectors' error
    std::vector<FaceState> states;
};

// Newell's sum about the face's first corner (Sutherland et al. 1974): exact for non-planar
// polygons and independent of the start corner up to rounding. `accurate` evaluates each difference
// of products with one rounding: where the edge differences fit a float the products are exact,
// elsewhere they are split (Dekker 1971), so that the error of a triangle is at most 2⁻⁵² of its
// length, needles included. `fast` uses float: 1e-6 rad on well-shaped triangles, unbounded on
// needles. O(corners); the same bits for any thread count.
FaceNormals face_normals(const MeshView& mesh, Precision precision = Precision::accurate,
                         int threads = 0);

}  // namespace prep
