// How far a limit surface and its normal are from their linear interpolations over a triangle of a
// root's parameters, out of its pieces (limit_pieces.h).
//
// Away from extraordinary vertices, with a × b the triangle's extent by the parameters u and v, or
// by any two axes of the parameters' plane (of Loop's triangles those of axes_of(), where a = b =
// 1):
//   |S − I S| ≤ (a² M₁ + 2ab M₂ + b² M₃)/8, M suprema of |S_uu|, |S_uv|, |S_vv| (Filip, Magedson
//   and Markot 1986): by Taylor's formula at p it is at most ½ Σ λ |S'' d²| over the ways d from p
//   to the corners, and as those have the mean 0 and a range of a by b, Σ λ d_u² ≤ a²/4
//   (Popoviciu 1935), Σ λ d_v² ≤ b²/4, and Σ λ |d_u d_v| ≤ ab/4 by Cauchy and Schwarz.
// and no more than the control points of S − I S are long (hull_deviation.h), which is less mostly,
// and much less where the surface bends in a part of the triangle: M is large beside a crease, in
// a strip that is narrow.
// For n = N/|N|, N = S_u × S_v, with N' d = α n + β t, t across n,
//   |n'' d²| ≤ |P N'' d²|/|N| + β √(β² + 4α²)/|N|²,
// where P is across n (polygon_surface.h has the second term). With A_u, A_v and B_u, B_v suprema
// of α and β for steps of a by u and b by v, α ≤ A_u |d_u|/a + A_v |d_v|/b and likewise β; so
// Σ λ β² ≤ (B_u + B_v)²/4 as above, Σ λ α² likewise, and with Cauchy and Schwarz once more
//   ½ Σ λ β √(β² + 4α²) ≤ B √(B² + 4A²)/8,   A = A_u + A_v, B = B_u + B_v.
// N is a polynomial of degree 5 × 5, of Loop's patches of degree 6, whose own Bézier points are at
// hand: suprema are hulls of
// their differences, where those of a product of suprema, term by term, would be ten times as
// large. With a unit vector e near n, θ between them: |P x| ≤ |x across e| + sin θ |x·e|, |n·x| ≤
// |x·e| + sin θ |x across e|, |N| ≥ N·e: so a patch that is stretched without being bent has no
// deviation.
//
// At an extraordinary vertex second derivatives are not bounded. There the control points of S − I
// S alone are the bound; and of the normal, with e any unit vector, |n − e| is bounded by the
// angles of N's Bézier points to e. What is left around the vertex lies in the hull of its rings;
// normals there are bounded by all levels to come, as far as evaluation goes (after that a point is
// the vertex: RingShape::deepest_level()).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tessellation/limit/hull_deviation.h"
#include "tessellation/limit/limit_pieces.h"
#include "tessellation/limit/ring_cones.h"
#include "tessellation/surface.h"

namespace prep::detail {

// `cones` null: the direction's deviation is not asked for, and 0.
BaseDeviation limit_deviation(const ChannelSurface& surface, const RingCones* cones,
                              const LimitTriangle& triangle);

// Away from extraordinary vertices bounds by suprema over cells of the root's parameters, a few
// times as wide as the triangle: looser than limit_deviation's, and known already where a neighbour
// has asked. What it gives does not depend on what is known.
//
// Each thread keeps the cells it asked for last, of all surfaces (1024 of them, some 150 KB until
// the thread ends), so that threads share nothing: a cell belongs to one CellBounds by a number
// that no other has.
class CellBounds {
  public:
    // `surface` must outlive it. Without normals the direction's deviation is 0.
    CellBounds(const ChannelSurface& surface, bool with_normals);
    CellBounds(const CellBounds&) = delete;
    CellBounds& operator=(const CellBounds&) = delete;
    // Of triangles of bisections; nothing where there is no such bound.
    std::optional<BaseDeviation> deviation(std::uint32_t root,
                                           const std::array<glm::dvec2, 3>& parameters) const;

  private:
    struct Key;
    struct Cell;
    const ChannelSurface& surface_;
    bool with_normals_;
    std::uint64_t owner_;
};

}  // namespace prep::detail
