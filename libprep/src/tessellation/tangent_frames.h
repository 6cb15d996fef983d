// Tangent frames of the surface that is displaced, for vector maps in its own space.
//
// At a point with the direction n and the tangent τ, interpolated linearly over the root from those
// at the cage's corners (at the centre of a fan: their mean),
//   N = n,   B = w (n × τ) / |n × τ|,   T = w B × n,
// so T is τ made perpendicular to n, and the frame orthonormal. τ is MikkTSpace's of the cage's
// faces with the surface's directions at its corners for normals; w = ±1 is that of the fan's UVs,
// as docs/conventions.md has it: B points against +v.
//
// A vector m of the map is moved by F m, F = (T B N). As |F v| = |v|, of its linear interpolant it
// is off by
//   F m − I(F m) = F (m − I m) + (F − I F) I m + (I F · I m − I (F m)),
// no more than |m − I m| + ‖F − I F‖ max |m| + ⅓ max ‖F − F'‖ |m − m'| (displaced_surface.h), and
// ‖F − I F‖² ≤ |T − I T|² + |B − I B|² + |n − I n|². With b = n × τ, which |b − I b| ≤ e leaves by
//   e = |n − I n| max |τ| + ⅓ max |n − n'||τ − τ'|,
// and l ≤ |I b|, that of two directions, |B − I b / |I b|| ≤ 2 e / (|b| + |I b|) ≤ 2 e / (2 l − e);
// I b / |I b| from I B is direction_deviation's. Last,
//   |T − I T| ≤ |B − I B| + |n − I n| + ⅓ max |B − B'||n − n'|.
// All of these are of second order in the triangle's size.
//
// Corners' tangents that cancel (charts without area take theirs from what they meet), and tangents
// that the surface's direction turns into within a face, would leave a place where n × τ vanishes
// and the frame jumps, which no triangles are fine enough for. The fan of a face whose tangents do
// not lean to their mean, or n × τ to its own, has one tangent; its neighbours have others, and
// what that makes them disagree by is a gap like that of a seam.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "prep/mesh.h"
#include "prep/result.h"
#include "tessellation/domain.h"
#include "tessellation/surface.h"

namespace prep::detail {

struct TangentFrame {
    glm::dmat3 axes{1.0};       // columns T, B, N
    glm::dvec3 across{0.0};     // n × τ
    glm::dvec3 tangent{0.0};    // τ
    bool is_arbitrary = false;  // n × τ has no direction: T is any
};

class TangentFrames {
  public:
    // Every corner of a fan has a UV that is finite. Errors: those of corner_tangents.
    static Result<TangentFrames> make(const Mesh& mesh, const Domain& domain,
                                      const BaseSurface& base, std::size_t uv_set, int threads);

    TangentFrame at(const DomainRoot& root, const glm::dvec3& weights,
                    const glm::dvec3& direction) const;
    // What `axes` changes by where the weights go from corner a to corner b (0) or to the centre
    // (1) and the direction changes by `turn`.
    glm::dmat3 step(const DomainRoot& root, const TangentFrame& frame, std::size_t axis,
                    const glm::dvec3& turn) const;

  private:
    void keep_from_cancelling(const Domain& domain, const BaseSurface& base,
                              const CornerLayer<glm::vec3>& normals, int threads);
    std::array<glm::dvec3, 3> tangents(const DomainRoot& root) const;
    std::vector<glm::dvec3> corners_;  // per corner of the cage
    std::vector<glm::dvec3> centres_;  // per fan
    // Per fan: its tangent is that of the centre everywhere.
    std::vector<std::uint8_t> constant_;
    std::vector<double> signs_;  // w, per fan
};

// Above ‖F − I F‖ over a triangle whose corners have these frames and whose direction is off its
// linear interpolant by no more than `turn`.
double frame_deviation(const std::array<TangentFrame, 3>& corners, double turn);

}  // namespace prep::detail
