// What normals of a mesh's fans are, by the definition, in long double.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cost/measure/metrics.h"

namespace cost {

struct FanNormals {
    std::vector<Vector> sums;  // by fan; not of unit length
    // Bound on each sum's angular error in degrees: roundings of long double, larger the more faces
    // a fan has and the more of their sum cancels. 180 where the sum is nothing but rounding.
    std::vector<double> bounds;
};

// Of each fan the sum of its faces' area vectors (Newell's sum about the face's first corner), once
// for each of its corners. Faces and corners as prep::Mesh has them; `corner_fans` by corner, the
// fan that it belongs to, or 0xffffffff.
FanNormals area_fan_normals(std::span<const glm::vec3> positions,
                            std::span<const std::uint32_t> face_offsets,
                            std::span<const std::uint32_t> corner_vertices,
                            std::span<const std::uint32_t> corner_fans, std::size_t fans);

}  // namespace cost
