// The numbers of a vertex' rings (extraordinary_ring.h) by their places, and what the rules of both
// schemes share.
#pragma once

#include <cstddef>
#include <cstdint>

#include "limit_surface/extraordinary_ring.h"

namespace prep::detail {

struct RingPoint {
    std::uint32_t sector;
    int a, b;
};

// Point (a, b) of sector j where a or b may be −1: that of the sector beside or, beyond a crease,
// at[0] + at[1] − at[2], which gives the crease's rule: in quads twice the crease's point less the
// one opposite, in triangles P + Q − R over the edge P – Q of the one with apex R.
struct RingPlace {
    RingPoint at[3];
    bool beyond = false;
};
inline RingPlace ring_place(const RingShape& shape, std::uint32_t j, int a, int b) {
    if (a >= 0 && b >= 0) return {{{j, a, b}}};
    const bool first = b < 0;  // beyond the sector's first edge
    const int k = first ? a : b, skewed = shape.triangles ? k - 1 : k;
    if (shape.is_sharp(first ? j : j + 1))
        return first ? RingPlace{{{j, skewed, 0}, {j, k, 0}, {j, skewed, 1}}, true}
                     : RingPlace{{{j, 0, skewed}, {j, 0, k}, {j, 1, skewed}}, true};
    return first ? RingPlace{{{shape.previous(j), 1, skewed}}}
                 : RingPlace{{{shape.next(j), skewed, 1}}};
}

struct RingView {
    const RingShape& shape;
    std::uint32_t width;
    const double* numbers;

    const double* at(std::uint32_t point) const { return numbers + std::size_t(point) * width; }
    const double* centre() const { return numbers; }
    const double* one_step(std::uint32_t i) const { return at(shape.one_step(i)); }
    const double* two_steps(std::uint32_t i) const { return at(shape.two_steps(i)); }
    const double* inner(std::uint32_t j, std::uint32_t k = 0) const {
        return at(shape.inner(j, k));
    }
    // Within the two rings, 0 ≤ a, b.
    const double* point(const RingPoint& p) const {
        if (p.b == 0)
            return p.a == 0 ? centre() : p.a == 1 ? one_step(p.sector) : two_steps(p.sector);
        if (p.a == 0) return p.b == 1 ? one_step(p.sector + 1) : two_steps(p.sector + 1);
        return inner(p.sector, std::uint32_t(p.a - 1 + 2 * (p.b - 1)));
    }
    double number(const RingPlace& place, std::uint32_t d) const {
        const double own = point(place.at[0])[d];
        return place.beyond ? own + point(place.at[1])[d] - point(place.at[2])[d] : own;
    }
};

// The tangents at a vertex as sums over its ring, each the first Fourier mode of refinement there:
//   scale Σ edge · wave(iθ) · one step i + face · (wave(jθ) + wave((j + 1)θ)) · inner point j
// and what the end of a crease gets of the new points beside it: of its neighbour on the next edge,
// of an inner point.
struct RingMode {
    double eigenvalue, edge, face, scale;
    double end_of_edge, end_of_face;
};

inline void copy(std::uint32_t width, const double* p, double* out) {
    for (std::uint32_t d = 0; d < width; ++d) out[d] = p[d];
}

inline void middle(std::uint32_t width, const double* p, const double* q, double* out) {
    for (std::uint32_t d = 0; d < width; ++d) out[d] = 0.5 * (p[d] + q[d]);
}

inline void crease_point(std::uint32_t width, const double* p, const double* q, const double* r,
                         double* out) {
    for (std::uint32_t d = 0; d < width; ++d) out[d] = 0.75 * p[d] + 0.125 * (q[d] + r[d]);
}

}  // namespace prep::detail
