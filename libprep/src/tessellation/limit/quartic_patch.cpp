#include "tessellation/limit/quartic_patch.h"

#include <algorithm>
#include <cmath>

#include "limit_surface/loop_patch.h"
#include "tessellation/limit/normal_net.h"

namespace prep::detail {
namespace {

// The weights' change by a step along each of the axes.
struct AxisSteps {
    glm::dvec3 u, v;
    double reach = 0;  // the most that one adds up to
    explicit AxisSteps(const QuarticPatch& patch) {
        const glm::dvec2 p = patch.corners[1] - patch.corners[0];
        const glm::dvec2 q = patch.corners[2] - patch.corners[0];
        const double area = cross_of(p, q);
        const auto step = [&](const glm::dvec2& along) {
            const double second = cross_of(along, q) / area, third = cross_of(p, along) / area;
            const glm::dvec3 change(-(second + third), second, third);
            reach = std::max(reach, std::abs(change.x) + std::abs(second) + std::abs(third));
            return change;
        };
        u = step(patch.axes.u);
        v = step(patch.axes.v);
    }
};

template <std::size_t count>
double longest(const std::array<glm::dvec3, count>& vectors) {
    double most = 0;
    for (const glm::dvec3& v : vectors) most = std::max(most, glm::dot(v, v));
    return std::sqrt(most);
}

// With all arguments that are left at one corner.
template <std::size_t degree>
glm::dvec3 value_at(const TriangleNet<degree>& p, const glm::dvec3& weights) {
    if constexpr (degree == 0)
        return p[0];
    else
        return value_at<degree - 1>(blossom<degree>(p, weights), weights);
}

// Points (i …, j) of `out`: `p` is the polar form with i times the second and j times the third
// corner.
template <std::size_t degree>
void fill_row(const TriangleNet<degree>& p, const std::array<glm::dvec3, 3>& weights, std::size_t i,
              std::size_t j, TriangleNet<4>& out) {
    out[triangle_point(4, i, j)] = value_at<degree>(p, weights[0]);
    if constexpr (degree > 0)
        fill_row<degree - 1>(blossom<degree>(p, weights[1]), weights, i + 1, j, out);
}

template <std::size_t degree>
void fill_rows(const TriangleNet<degree>& p, const std::array<glm::dvec3, 3>& weights,
               TriangleNet<4>& out) {
    fill_row<degree>(p, weights, 0, 4 - degree, out);
    if constexpr (degree > 0) fill_rows<degree - 1>(blossom<degree>(p, weights[2]), weights, out);
}

}  // namespace

double size_of(const TriangleNet<4>& p) {
    double size = 0;
    for (const glm::dvec3& at : p)
        size = std::max({size, std::abs(at.x), std::abs(at.y), std::abs(at.z)});
    return size;
}

ParameterAxes axes_of(const ParameterTriangle& t) {
    const glm::dvec2 along = t[1] - t[0], to_tip = t[2] - t[0];
    const glm::dvec2 across(-(0.5 * along.x + along.y), along.x + 0.5 * along.y);
    const double area = cross_of(along, across), foot = cross_of(to_tip, across) / area;
    const double width = std::max(1.0, foot) - std::min(0.0, foot);
    return {width * along, cross_of(along, to_tip) / area * across};
}

TriangleNet<4> quartic_points(const std::array<glm::dvec3, 12>& controls) {
    const auto& rows = loop_bezier_weights();
    TriangleNet<4> points;
    for (std::size_t k = 0; k < points.size(); ++k) {
        points[k] = glm::dvec3(0.0);
        for (std::size_t c = 0; c < 12; ++c) points[k] += rows[k][c] * controls[c];
    }
    return points;
}

TriangleNet<4> over_triangle(const TriangleNet<4>& points,
                             const std::array<glm::dvec3, 3>& weights) {
    TriangleNet<4> out;
    fill_rows<4>(points, weights, out);
    return out;
}

std::array<double, 3> second_derivative_bounds(const QuarticPatch& patch) {
    const AxisSteps steps(patch);
    const TriangleNet<3> by_u = blossom<4>(patch.p, steps.u);
    const TriangleNet<3> by_v = blossom<4>(patch.p, steps.v);
    const double error =
        patch.error + 8 * half_ulp * size_of(patch.p);  // of a difference, by reach
    const double slack = 12 * steps.reach * steps.reach * error;
    return {12 * longest(blossom<3>(by_u, steps.u)) + slack,
            12 * longest(blossom<3>(by_u, steps.v)) + slack,
            12 * longest(blossom<3>(by_v, steps.v)) + slack};
}

QuarticNormalNet normal_net(const QuarticPatch& patch) {
    const AxisSteps steps(patch);
    QuarticNormalNet net;
    net.by_u = steps.u;
    net.by_v = steps.v;
    net.reach = steps.reach;
    const TriangleNet<3> by_u = blossom<4>(patch.p, steps.u);
    const TriangleNet<3> by_v = blossom<4>(patch.p, steps.v);
    quartic_normal_net(by_u.data(), by_v.data(), net.n.data());
    const double lengths = 4 * (longest(by_u) + longest(by_v));
    // Of a derivative, and of products of them.
    const double error = 4 * net.reach * (patch.error + 4 * half_ulp * size_of(patch.p));
    net.error = lengths * (error + lengths * 0x1p-48);
    return net;
}

std::array<glm::dvec3, 2> middle_derivatives(const QuarticPatch& patch) {
    const AxisSteps steps(patch);
    std::array<glm::dvec3, 2> d{glm::dvec3(0.0), glm::dvec3(0.0)};
    for (const glm::dvec3& p : blossom<4>(patch.p, steps.u)) d[0] += p;
    for (const glm::dvec3& p : blossom<4>(patch.p, steps.v)) d[1] += p;
    return d;
}

}  // namespace prep::detail
