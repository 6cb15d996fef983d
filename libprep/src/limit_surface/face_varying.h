// The cage of a face-varying channel (a UV set, colours): its vertices are the pairs of a vertex
// and a value there, its borders the seams. OpenSubdiv's six rules for face-varying data say which
// of these vertices are infinitely sharp; the rest follows from the rules for vertices: a seam is a
// border, a border a crease, the cage's own creases stay.
//
// Values are one where they are equal: a seam is where values differ, not where a file repeats
// them. Rules: OpenSubdiv's documentation, "Face-varying interpolation rules"; compared with its
// refiner by the tests.
#pragma once

#include <vector>

#include "limit_surface/refined_cage.h"

namespace prep::detail {

struct FaceVaryingCage {
    SurfaceCage cage;
    // Per vertex of this cage: a corner that has its value.
    std::vector<std::uint32_t> first_corner;
};

// Per corner of the faces a number of its value; equal numbers, equal values.
FaceVaryingCage face_varying_cage(const SurfaceCage& positions, const RefinedCage& refined,
                                  const std::vector<std::uint32_t>& corner_values,
                                  FaceVaryingRule rule);

}  // namespace prep::detail
