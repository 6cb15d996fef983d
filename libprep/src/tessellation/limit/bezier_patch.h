// Bicubic patches in Bézier form, cut to a box: hulls of their control points are bounds.
#pragma once

#include <algorithm>
#include <array>
#include <glm/glm.hpp>

namespace prep::detail {

struct ParameterBox {
    glm::dvec2 low{0.0}, high{1.0};
    glm::dvec2 size() const { return high - low; }
    bool has(const ParameterBox& other) const {
        return other.low.x >= low.x && other.low.y >= low.y && other.high.x <= high.x &&
               other.high.y <= high.y;
    }
};

// p[4 j + i], less `origin`, so that what is small is as exact far from the mesh's own origin;
// covers `box` of its root's parameters.
struct BezierPatch {
    std::array<glm::dvec3, 16> p;
    ParameterBox box;
    glm::dvec3 origin{0.0};
};

// Rows of weights of four control points in a row, of a uniform cubic B-spline over 0 … 1, for the
// four Bézier points over a … b: its polar form at (a,a,a), (a,a,b), (a,b,b), (b,b,b) (Ramshaw
// 1989).
using CubicWeights = std::array<std::array<double, 4>, 4>;
CubicWeights bezier_weights(double a, double b);

// out[4 j + i] = Σ along_v[j][l] along_u[i][k] in[4 l + k].
std::array<glm::dvec3, 16> transformed(const std::array<glm::dvec3, 16>& in,
                                       const CubicWeights& along_u, const CubicWeights& along_v);

// Suprema of the lengths of the second derivatives by u and u, u and v, v and v, by the box's own
// size. Rounded up.
std::array<double, 3> second_derivative_bounds(const BezierPatch& patch);

// The Bézier points of S_u × S_v by the box's own size, of degree 5 × 5: n[6 j + i]. `error`: what
// roundings may have moved one of them by.
struct NormalNet {
    std::array<glm::dvec3, 36> n;
    double error = 0;
};
NormalNet normal_net(const BezierPatch& patch);
// Differences of points err by roundings of their size, products of derivatives by some of theirs.
inline constexpr double net_error_by_size = 0x1p-46, net_error_by_length = 0x1p-48;

// First derivatives in the box's middle, by the box's size.
std::array<glm::dvec3, 2> middle_derivatives(const BezierPatch& patch);

}  // namespace prep::detail
