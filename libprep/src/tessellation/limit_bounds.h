// How far a limit surface and its normal are from their linear interpolations over a triangle of a
// root's parameters, out of its pieces (limit_pieces.h).
//
// Away from extraordinary vertices, with a × b the triangle's extent:
//   |S − I S| ≤ (a² M₁ + 2ab M₂ + b² M₃)/8, M suprema of |S_uu|, |S_uv|, |S_vv| (Filip, Magedson
//   and Markot 1986), and for n = N/|N|, N = S_u × S_v, with steps d:
//   |n'' d²| ≤ |P N'' d²|/|N| + β √(β² + 4α²)/|N|²,   β = |P N' d|, α = |N' d|
// in the same way, where P is across n (polygon_surface.h has the second term). With a unit vector
// e, |P x| ≤ |x across e| + sin(n, e) |x|, and x × y across e is at most |x||y·e| + |y||x·e|: so a
// patch that is stretched without being bent has no deviation. Suprema are hulls of differences of
// control points.
//
// At an extraordinary vertex second derivatives are not bounded. There each piece's own control
// points of S − L, L the linear function of the triangle, are the bound; and of the normal, with
// e any unit vector, |n − e| ≤ |N across e| / (N·e), as tan θ ≥ 2 sin(θ/2). What is left around
// the vertex lies in the hull of its rings; normals there are bounded by all levels to come, as
// far as evaluation goes (after that a point is the vertex: patch_evaluator.h).
#pragma once

#include <array>
#include <vector>

#include "tessellation/limit_pieces.h"
#include "tessellation/surface.h"

namespace prep::detail {

// Largest |n − limit normal| over a ring's sector from level k of its rings on.
class RingCones {
  public:
    RingCones() = default;
    RingCones(const ChannelSurface& surface, int threads);
    double from_level(std::uint32_t ring, std::uint32_t sector, int k) const;

  private:
    static constexpr int levels = 51;
    std::vector<std::size_t> first_;  // per ring
    std::vector<float> cones_;        // per sector `levels`
};

struct LimitTriangle {
    std::uint32_t root = 0;  // of the patch tree
    std::array<glm::dvec2, 3> parameters;
    std::array<glm::dvec3, 3> positions, normals;
};

// `cones` null: the direction's deviation is not asked for, and 0.
BaseDeviation limit_deviation(const ChannelSurface& surface, const RingCones* cones,
                              const LimitTriangle& triangle);

}  // namespace prep::detail
