// What an error of a triangle is on a screen, at most.
//
// With p in the picture, |x·p| ≤ w·p and |y·p| ≤ w·p, and q = p + d, |d| ≤ e: both places differ by
//   ((x − s w)·d, (y − t w)·d) / w·q,   s = x·p / w·p, t = y·p / w·p.
// The length of the numerator in pixels is at most e K, K the largest spectral norm of the two rows
// over −1 ≤ s, t ≤ 1: convex in s and t, so it is that of a corner. For the denominator, one of p
// and q is in the triangle, where depths are at least D, the least of its corners, and the one that
// is in the picture is no nearer than the near distance: w·q ≥ max(D, near) − |w| e. A triangle
// from whose corners a plane of the picture is farther away than e shows nothing of either.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "prep/displacement/tessellate.h"

namespace prep::detail {

class ScreenBound {
  public:
    explicit ScreenBound(const ScreenMetric& metric);

    // Pixels to a unit of length for errors up to `error`; 0: nothing of it is in the picture;
    // infinite: it may reach the eye.
    double pixels_per_unit(const std::array<glm::dvec3, 3>& corners, double error) const;
    // An error of at most so many pixels, however it is turned.
    double length_of(const std::array<glm::dvec3, 3>& corners, double pixels) const;

  private:
    double depth(const std::array<glm::dvec3, 3>& corners) const;

    struct Plane {  // inside where dot(normal, p) + offset ≥ 0
        glm::dvec3 normal{0.0};
        double offset = 0, length = 0;
    };
    std::array<Plane, 5> planes_;
    glm::dvec4 w_{0.0};
    double turn_ = 0, scale_ = 0, near_ = 0;  // |w|, K
};

// The largest of several.
double pixels_per_unit(const std::vector<ScreenBound>& screens,
                       const std::array<glm::dvec3, 3>& corners, double error);

}  // namespace prep::detail
