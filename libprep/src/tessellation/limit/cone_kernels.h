// Cones around the normals of patches, some patches at a time.
//
// A cone is the largest tangent of the angle between a unit vector and the Bézier points of a
// patch's normals; infinity where one is a right angle or more away. Number c (x, y, z of each
// point in turn) of patch p is at [c · patches_at_once + p].
#pragma once

#include <cstddef>

#include "prep/simd.h"

namespace prep::detail {

inline constexpr std::size_t patches_at_once = 8;

// Of bicubic patches by their 16 Bézier points, with a margin for roundings (NormalNet::error):
// widest[p] about the patch's own axis, and at [k · patches_at_once + p] about the k-th of the
// three `normals`. Only the first `count` are told.
void bezier_cones(const double* points, const double* axes, const double* normals,
                  std::size_t count, double* widest, SimdLevel simd);

// Without a margin, about one `normal`. By 16 control points of uniform cubic B-splines;
// `weights`: those of bezier_weights(0, 1).
void bicubic_cones(const double* controls, const double* weights, const double* normal,
                   double* widest, SimdLevel simd);
// By the 12 of Loop's scheme; `weights`: 15 rows, loop_bezier_weights(). Derivatives along two
// sides, whose lengths and common sign a direction does not have.
void quartic_cones(const double* controls, const double* weights, const double* normal,
                   double* widest, SimdLevel simd);

}  // namespace prep::detail
