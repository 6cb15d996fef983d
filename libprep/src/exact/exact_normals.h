// Exact rational arithmetic (CGAL) behind normals and hard edges: the slow truth that the filtered
// paths fall back to.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>

#include "prep/mesh.h"

namespace prep::detail {

// From how many corners on a face's area vector is kept where it may be asked for again.
constexpr std::uint32_t many_corners = 16;
inline bool has_many_corners(const MeshView& mesh, std::uint32_t face) {
    return mesh.face_offsets[face + 1] - mesh.face_offsets[face] >= many_corners;
}

// Newell's sum of a face with finite positions, exact, each component rounded to double once.
glm::dvec3 exact_area_vector(const MeshView& mesh, std::uint32_t face);

// A cosine as sign · sqrt(squared), with the square exact: numerator / denominator.
struct ExactCosine {
    int sign = 0;                                           // −1, 0, 1
    double squared_numerator = 0, squared_denominator = 1;  // both exact in double
    double cosine = 0;                                      // rounded, for the filter
};

// The cosine of an angle in degrees. Squares are exact for 0, 30, 45, 60, 90, 120, 135, 150, 180;
// elsewhere the rounded cosine is taken as exact (its square is formed exactly in
// ExactFaces::turn_exceeds).
struct Threshold {
    bool exact_square = false;
    ExactCosine cosine;
};
Threshold threshold_of(double degrees);

// Area vectors of a mesh's faces, exact, and what they decide. Those of faces with many corners are
// kept once they are made: each corner and edge of such a face asks for them. Several threads may
// ask. The mesh must outlive it.
class ExactFaces {
  public:
    explicit ExactFaces(const MeshView& mesh);
    ~ExactFaces();

    // The sum of several faces' area vectors. It is scaled by a power of two so that its largest
    // component is in [0.5, 1]; it is zero only if the exact sum is.
    glm::dvec3 area_sum(std::span<const std::uint32_t> faces) const;

    // Whether the turn between two faces' normals is larger than the threshold, decided on the
    // exact coordinates. Faces whose exact area vector is zero give false.
    bool turn_exceeds(std::uint32_t face0, std::uint32_t face1, const Threshold& threshold) const;

    // How many of those were made.
    std::size_t kept_made() const;

  private:
    class Kept;
    std::unique_ptr<Kept> kept_;
};

}  // namespace prep::detail
