// Patches of Loop's scheme in Bézier form of degree 4 over a triangle of the root's parameters:
// hulls of their control points are bounds.
//
// Control points of degree n are row by row from corner 0 to corner 1: number (i, j) is of i times
// corner 1, j times corner 2 and else corner 0.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "tessellation/limit/bezier_patch.h"

namespace prep::detail {

constexpr std::size_t triangle_points(std::size_t degree) {
    return (degree + 1) * (degree + 2) / 2;
}
constexpr std::size_t triangle_point(std::size_t degree, std::size_t i, std::size_t j) {
    return j * (2 * degree + 3 - j) / 2 + i;
}
template <std::size_t degree>
using TriangleNet = std::array<glm::dvec3, triangle_points(degree)>;

using ParameterTriangle = std::array<glm::dvec2, 3>;

inline double cross_of(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

inline ParameterBox box_of(const ParameterTriangle& t) {
    return {glm::min(t[0], glm::min(t[1], t[2])), glm::max(t[0], glm::max(t[1], t[2]))};
}

// What derivatives are by, in place of the parameters.
struct ParameterAxes {
    glm::dvec2 u{1, 0}, v{0, 1};
};
// Of a triangle (a, b, c): along ab, and across it as it is where the parameters' triangle is
// equilateral; as long as the triangle is wide, so that its extent by both is 1.
ParameterAxes axes_of(const ParameterTriangle& triangle);

struct QuarticPatch {
    TriangleNet<4> p;  // less `origin`
    ParameterTriangle corners;
    ParameterBox box;  // around them
    ParameterAxes axes;
    glm::dvec3 origin{0.0};
    double error = 0;  // what roundings may have moved one of the points by, but for the origin
};

// Of the 12 control points (loop_patch.h), over the whole triangle.
TriangleNet<4> quartic_points(const std::array<glm::dvec3, 12>& controls);

// The control points over the triangle whose corners have these weights of the corners, by the
// polar form (Ramshaw 1989). It may reach beyond.
TriangleNet<4> over_triangle(const TriangleNet<4>& points,
                             const std::array<glm::dvec3, 3>& weights);
// QuarticPatch::error of both, of points no longer than `size`: sums of 12 terms, then of 3 four
// times over, whose weights add up to `reach` at most in absolute value.
inline constexpr double half_ulp = 0x1p-53;
inline double quartic_points_error(double size) {
    return 13 * half_ulp * size;
}
inline double over_triangle_error(double size, double reach) {
    return 25 * half_ulp * size * (reach * reach) * (reach * reach);
}
// The largest coordinate.
double size_of(const TriangleNet<4>& points);

// As those of bicubic patches (bezier_patch.h), by the axes.
std::array<double, 3> second_derivative_bounds(const QuarticPatch& patch);

struct QuarticNormalNet {
    TriangleNet<6> n;
    double error = 0;
    // Of a step along each of the axes: what it has of each corner, and the most that this adds up
    // to.
    glm::dvec3 by_u, by_v;
    double reach = 0;
};
QuarticNormalNet normal_net(const QuarticPatch& patch);

// First derivatives about the triangle's middle, by the axes.
std::array<glm::dvec3, 2> middle_derivatives(const QuarticPatch& patch);

// One argument of the polar form: a point, with weights of the corners that add up to 1; or a step,
// with changes of them that add up to 0, which gives a derivative over its degree.
template <std::size_t degree>
TriangleNet<degree - 1> blossom(const TriangleNet<degree>& p, const glm::dvec3& by) {
    TriangleNet<degree - 1> out;
    std::size_t k = 0;
    for (std::size_t j = 0; j < degree; ++j)
        for (std::size_t i = 0; i + j < degree; ++i, ++k)
            out[k] = by.x * p[triangle_point(degree, i, j)] +
                     (by.y * p[triangle_point(degree, i + 1, j)] +
                      by.z * p[triangle_point(degree, i, j + 1)]);
    return out;
}

}  // namespace prep::detail
