// Face normals and areas by Newell's sum, at any scale.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "prep/enum_names.h"
#include "prep/mesh.h"

namespace prep {

enum class Precision : std::uint8_t {
    fast,      // float, vectorised, doubles where floats would lose too much
    accurate,  // double, compensated where plain doubles would lose too much
    exact,     // exact rationals and 256-bit floats, rounded once: slow, the oracle
};
constexpr auto names_of(Precision) {
    return std::to_array<EnumName<Precision>>({{"fast", Precision::fast},
                                               {"accurate", Precision::accurate},
                                               {"exact", Precision::exact}});
}

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
    std::vector<FaceState> states;
    // Bound on |error of the area vector| / |area vector|, the same for every regular face.
    double relative_error = 0;
    std::uint64_t exact_faces = 0;  // how many doubles could not tell; all if exact
};

// Relative errors of the area vectors, which also bound the normals' angular errors in radians.
// Measured by FaceNormals.ErrorsStayBelowTheirBounds.
inline constexpr double fast_face_error = 0x1p-16;
inline constexpr double accurate_face_error = 0x1p-45;
inline constexpr double exact_face_error = 0x1p-52;

// Newell's sum about the face's first corner (Sutherland et al. 1974): exact for non-planar
// polygons and independent of the start corner up to rounding.
//
// Each face is computed in the cheapest arithmetic whose error bound, evaluated on the face itself,
// meets the precision's bound: floats (`fast` only), doubles, doubles with error-free
// transformations (Dekker 1971, Knuth 1969), exact rationals (CGAL). Needles and polygons whose
// area nearly cancels thus cost more, never accuracy. Whether a face's area is zero is decided
// exactly. O(corners); the same bits for any thread count and instruction set.
FaceNormals face_normals(const MeshView& mesh, Precision precision = Precision::accurate,
                         int threads = 0);

}  // namespace prep
