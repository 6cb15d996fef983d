// What an error of a triangle is on a screen, at most.
//
// With p in the picture, |x·p| ≤ w·p and |y·p| ≤ w·p, and q = p + d, |d| ≤ e: both places differ by
//   ((x − s w)·d, (y − t w)·d) / w·q,   s = x·p / w·p, t = y·p / w·p.
// The length of the numerator in pixels is at most e K, K the largest spectral norm of the two rows
// over −1 ≤ s, t ≤ 1: convex in s and t, so it is that of a corner. For the denominator, one of p
// and q is in the triangle, where depths are at least D, the least of its corners, and the one that
// is in the picture is no nearer than the near distance: w·q ≥ max(D, near) − |w| e. A triangle
// from whose corners a plane of the picture is farther away than e shows nothing of either. All of
// it is rounded outwards.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "prep/displacement/tessellate.h"

namespace prep::detail {

class ScreenBound {
  public:
    explicit ScreenBound(const ScreenMetric& metric);

    // Pixels to a unit of length for errors up to `error`; 0: nothing of it is in the picture;
    // infinite: it may reach the eye.
    double pixels_per_unit(const std::array<glm::dvec3, 3>& corners, double error) const;
    // An error of at most so many pixels, however it is turned: pixels_per_unit(e) e <= pixels
    // where e is no larger. Monotone in errors that reach the eye as well, which that is not.
    double length_of(const std::array<glm::dvec3, 3>& corners, double pixels) const;

    // What it is over a box: `misses`: nothing in it is ever seen; `sees`: everything in it is.
    // With scale and |w| over depth, (s, t), pixels_per_unit(e) is s / (1 − t e): these are no less
    // than `least` in the box, and no more than `most`.
    struct Sight {
        bool misses = false, sees = false;
        glm::dvec2 least{0.0}, most{0.0};
    };
    Sight sight(const std::array<glm::dvec3, 8>& box) const;

  private:
    double depth(const std::array<glm::dvec3, 3>& corners) const;

    struct Plane {  // inside where dot(normal, p) + offset ≥ 0
        glm::dvec3 normal{0.0};
        double offset = 0, length = 0;
        double slope_size = 0, offset_size = 0;  // of what they are the sums of
    };
    std::array<Plane, 5> planes_;
    glm::dvec4 w_{0.0};
    double steepness_ = 0, scale_ = 0, near_ = 0;  // |w|, K
};

// The largest of several.
double pixels_per_unit(std::span<const ScreenBound> screens,
                       const std::array<glm::dvec3, 3>& corners, double error);

// Several, as many as there are pictures times nodes that show the mesh. Over a box around it most
// of them decide nothing: they see nothing of it, or another sees all of it from nearer.
class Screens {
  public:
    explicit Screens(const std::vector<ScreenMetric>& metrics);
    void focus(const glm::dvec3& low, const glm::dvec3& high);
    // Those that decide anything: in the box, and wherever a triangle may be.
    std::size_t count() const { return few_.size(); }
    std::span<const ScreenBound> around(const std::array<glm::dvec3, 3>& corners,
                                        double error) const;

  private:
    std::vector<ScreenBound> all_, few_;
    glm::dvec3 low_{0.0}, high_{0.0};
};

}  // namespace prep::detail
