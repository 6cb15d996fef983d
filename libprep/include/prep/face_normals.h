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

// The area vector of a face (normal direction, length = area for planar faces) is
// `area[f] · 2^exponent[f] · normal[f]`: kept apart so that neither 1e-30 nor 1e30 leaves the
// range.
struct FaceNormals {
    std::vector<glm::dvec3> normals;      // per face: unit, or zero where the state is not regular
    std::vector<double> areas;            // per face: in [0, ∞), to be scaled by 2^exponent
    std::vector<std::int32_t> exponents;  // per face
    std::vector<FaceState> states;        // per face
};

// Newell's sum about the face's first corner (Sutherland et al. 1974): exact for non-planar
// polygons and independent of the start corner up to rounding. Products are differences of products
// in Kahan's compensated form. Error of `accurate`: at most 4e-16 rad for triangles whose edges are
// exact in double (all float input); `fast`: 1e-6 rad on well-shaped triangles, unbounded on
// needles. O(corners); the same bits for any thread count.
FaceNormals face_normals(const MeshView& mesh, Precision precision = Precision::accurate,
                         int threads = 0);

}  // namespace prep
