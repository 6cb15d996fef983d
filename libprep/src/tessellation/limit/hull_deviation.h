// How far a patch is from a linear function over the part of a triangle that it covers, by hulls
// of control points of the difference.
//
// Of Loop's patches the points are raised to degree 6. Of bicubic ones, where that part is a half
// of the patch's box along a diagonal, or the triangle over one side of it with its tip in the
// middle of the other, the points are those of a triangle of degree 6: with the blossom of a
// bicubic patch f(u₁,u₂,u₃; v₁,v₂,v₃), that of degree 6 at points x₁ … x₆ of the plane is the mean
// of f over all ways to take u from three of them and v from the others (Ramshaw 1989). Of a
// quadratic difference their largest is 6/5 of the true one; those of a whole box, of degree 3 × 3,
// have 4/3.
//
// Triangles of bisections meet boxes of patches in such parts, or cover them; but for strips along
// creases, which are halved across until they do, or are as short as they are wide.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "tessellation/limit/bezier_patch.h"
#include "tessellation/limit/quartic_patch.h"

namespace prep::detail {

struct LimitTriangle {
    std::uint32_t root = 0;  // of the patch tree
    ParameterTriangle parameters;
    std::array<glm::dvec3, 3> positions, normals;
};

// The linear function with the triangle's positions.
struct LinearMap {
    glm::dvec2 at;
    glm::dvec3 value, du, dv;
    explicit LinearMap(const LimitTriangle& triangle);
    glm::dvec3 operator()(const glm::dvec2& p) const {
        return value + (p.x - at.x) * du + (p.y - at.y) * dv;
    }
};

// Whether box and triangle have no area in common.
bool is_apart(const ParameterBox& box, const LimitTriangle& triangle);

// The larger of `least` and the patch's own, 0 where they are apart.
double hull_deviation(const BezierPatch& patch, const LimitTriangle& triangle,
                      const LinearMap& linear, double least);
// Over all of the patch's triangle.
double hull_deviation(const QuarticPatch& patch, const LimitTriangle& triangle,
                      const LinearMap& linear, double least);

}  // namespace prep::detail
