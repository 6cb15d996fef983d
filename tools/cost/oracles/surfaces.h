// Surfaces whose points, normals and tangents are closed forms.
#pragma once

#include <vector>

#include "cost/measure/metrics.h"

namespace cost {

struct SurfaceSample {
    Vector position{0}, normal{0}, du{0};  // du: the derivative by u
};

// About z, of radii `major` and `minor`; u runs around, v across, 0 … 1 each.
SurfaceSample torus_at(Real u, Real v, Real major = 1, Real minor = Real(2) / 5);

// The normal where that torus is nearest to a point that is neither on its axis nor on its circle
// of middles; not of unit length.
Vector torus_normal_near(const Vector& point, Real major = 1);

// A turned part about z: a side of radius 1 from z = −1 up, a chamfer of 45° and a flat top; the
// bottom's rim is sharp. The normals of its surface by the face that a corner belongs to.
enum class TurnedFace { bottom, side, chamfer, top };
Vector turned_normal(TurnedFace face, Real turn);  // turn 0 … 1 around
// Profile points (radius, z) from the bottom's rim to the top's.
struct ProfilePoint {
    Real radius, z;
};
std::vector<ProfilePoint> turned_profile();

// A closed uniform bicubic B-spline over `around` × `across` control points, periodic in both: the
// limit of Catmull and Clark's rules (1978) on a cage of quads of which four meet everywhere.
class SplineTorus {
  public:
    SplineTorus(std::vector<Vector> control, int around, int across);
    struct Point {
        Vector position{0}, du{0}, dv{0};
    };
    Point at(Real u, Real v) const;  // in control points: u 0 … around, v 0 … across
    // The nearest point: the best of a grid of 6 × 6 points a face, then Gauss and Newton's steps
    // while they come nearer.
    struct Nearest {
        Real distance = 0;
        Vector normal{0};
    };
    Nearest nearest(const Vector& p) const;

  private:
    const Vector& control(int i, int j) const;
    std::vector<Vector> control_;
    int around_, across_;
    struct Seed {
        Real u, v;
        Vector position;
    };
    std::vector<Seed> seeds_;
};

}  // namespace cost
