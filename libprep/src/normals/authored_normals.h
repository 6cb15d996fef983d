// What the file's own normals are worth, corner by corner, and how computed ones take their place.
#pragma once

#include <cstdint>
#include <vector>

#include "prep/corner_normals.h"
#include "prep/mesh.h"

namespace prep::detail {

enum NormalFault : std::uint8_t {  // bits
    normal_missing = 1,
    normal_non_finite = 2,
    normal_zero = 4,
    normal_non_unit = 8,  // length off by more than unit_tolerance
    normal_flipped = 16,  // against its face and against the computed normal
};

// As glTF's validator has it for both (2.0.0-dev.3.10): about what signed bytes round a unit vector
// by at most.
inline constexpr double unit_tolerance = 0.00674;

struct NormalReview {
    std::vector<std::uint8_t> faults;  // per corner: bits of NormalFault
    std::uint64_t missing = 0, non_finite = 0, zero = 0, non_unit = 0, flipped = 0;
};

// Flipped is only checked where `faces` is given; it then means more than 90° from the face normal.
NormalReview review_normals(const MeshView& mesh, const FaceNormals* faces);

// Authored normals with computed ones at the corners whose faults intersect `replace`.
CornerLayer<glm::vec3> merge_normals(const CornerLayer<glm::vec3>& authored,
                                     const NormalReview& review, unsigned replace,
                                     const CornerLayer<glm::vec3>& computed);

// What a unit vector's length is off by when its components are rounded to float (1e-7), or made by
// a few operations on floats. Such vectors keep their bits.
inline constexpr double rounded_unit = 2.5e-7;

// The direction of n, scaled in double where its length is off by more than rounded_unit. What is
// no direction (zero, not finite) comes back as it is.
glm::vec3 unit_normal(const glm::vec3& n);

}  // namespace prep::detail
