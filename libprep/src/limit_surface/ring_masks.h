// The numbers of a vertex' rings (extraordinary_ring.h) by their places, and the schemes' masks
// around it: how points refine, limits at regular and at smooth vertices, the modes of tangents.
// Creases and sharp vertices are not among them: they are alike in both schemes.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "limit_surface/extraordinary_ring.h"
#include "limit_surface/loop_patch.h"

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

// Catmull and Clark 1978; limits: Halstead, Kass and DeRose 1993.
struct CatmarkRing {
    static void face_point(std::uint32_t width, const double* p, const double* q, const double* r,
                           const double* s, double* out) {
        for (std::uint32_t d = 0; d < width; ++d) out[d] = 0.25 * ((p[d] + q[d]) + (r[d] + s[d]));
    }
    // The edge p – q; the four others are the far corners of its two faces.
    static void edge_point(std::uint32_t width, const double* p, const double* q, const double* a,
                           const double* b, const double* c, const double* e, double* out) {
        for (std::uint32_t d = 0; d < width; ++d)
            out[d] = 0.375 * (p[d] + q[d]) + 0.0625 * ((a[d] + b[d]) + (c[d] + e[d]));
    }
    // A regular vertex p between four edge neighbours and four diagonal ones.
    static void vertex_point(std::uint32_t width, const double* p, const double* e0,
                             const double* e1, const double* e2, const double* e3, const double* f0,
                             const double* f1, const double* f2, const double* f3, double* out) {
        for (std::uint32_t d = 0; d < width; ++d)
            out[d] = 0.5625 * p[d] + 0.09375 * ((e0[d] + e1[d]) + (e2[d] + e3[d])) +
                     0.015625 * ((f0[d] + f1[d]) + (f2[d] + f3[d]));
    }

    static void refine_sector(const RingView& old, std::uint32_t j, double* next) {
        const RingShape& shape = old.shape;
        const std::uint32_t width = old.width;
        const auto to = [&](std::uint32_t k) {
            return next + std::size_t(shape.inner(j, k)) * width;
        };
        const double *c = old.centre(), *e = old.one_step(j), *e2 = old.two_steps(j);
        const double *g = old.one_step(j + 1), *g2 = old.two_steps(j + 1);
        const double *f11 = old.inner(j, 0), *f21 = old.inner(j, 1), *f12 = old.inner(j, 2);
        face_point(width, c, e, f11, g, to(0));
        edge_point(width, e, f11, c, g, e2, f21, to(1));
        edge_point(width, g, f11, c, e, g2, f12, to(2));
        vertex_point(width, f11, e, g, f21, f12, c, e2, g2, old.inner(j, 3), to(3));
    }
    // The points 1 and 2 steps along an edge that is no crease.
    static void refine_edge(const RingView& old, std::uint32_t i, double* one, double* two) {
        const double *c = old.centre(), *e = old.one_step(i), *e2 = old.two_steps(i);
        const std::uint32_t j = i, k = old.shape.previous(i);  // the sectors after and before it
        edge_point(old.width, c, e, old.inner(j), old.one_step(j + 1), old.inner(k),
                   old.one_step(k), one);
        vertex_point(old.width, e, c, e2, old.inner(j), old.inner(k), old.one_step(j + 1),
                     old.inner(j, 1), old.one_step(k), old.inner(k, 2), two);
    }
    // The smooth vertex; next's inner points are there already.
    static void refine_centre(const RingView& old, double* next) {
        const RingView fresh{old.shape, old.width, next};
        const double n = old.shape.sectors;
        for (std::uint32_t d = 0; d < old.width; ++d) {
            double sum = 0;
            for (std::uint32_t j = 0; j < old.shape.sectors; ++j)
                sum += old.one_step(j)[d] + fresh.inner(j)[d];
            next[d] = (n - 2) / n * old.centre()[d] + sum / (n * n);
        }
    }

    // The control points of the regular patch over a quadrant, in the sector's next level.
    static constexpr std::uint32_t control_count = 16;
    static RingPoint control(std::uint32_t j, std::uint32_t k, int qa, int qb) {
        return {j, qa - 1 + int(k % 4), qb - 1 + int(k / 4)};
    }
    static bool is_outer(const RingPoint& p) { return p.a == 3 || p.b == 3; }
    // A point of the next level three steps out.
    static void outer(const RingView& old, const RingPoint& p, double* to) {
        const RingShape& shape = old.shape;
        const std::uint32_t width = old.width, s = p.sector;
        const double *e = old.one_step(s), *e2 = old.two_steps(s);
        const double *g = old.one_step(s + 1), *g2 = old.two_steps(s + 1);
        const double *f11 = old.inner(s, 0), *f21 = old.inner(s, 1), *f12 = old.inner(s, 2);
        const double* f22 = old.inner(s, 3);
        if (p.a == 3 && p.b == 3) return face_point(width, f11, f21, f22, f12, to);
        if (p.a == 3 && p.b == 2) return edge_point(width, f11, f21, e, e2, f12, f22, to);
        if (p.a == 3 && p.b == 1) return face_point(width, e, e2, f21, f11, to);
        if (p.a == 2) return edge_point(width, f11, f12, g, g2, f21, f22, to);
        if (p.a == 1) return face_point(width, g, g2, f12, f11, to);
        if (p.b == 0) {  // (3, 0)
            if (shape.is_sharp(s)) return middle(width, e, e2, to);
            const std::uint32_t k = shape.previous(s);
            return edge_point(width, e, e2, f11, f21, old.inner(k, 0), old.inner(k, 2), to);
        }
        if (shape.is_sharp(s + 1)) return middle(width, g, g2, to);  // (0, 3)
        const std::uint32_t k = shape.next(s);
        edge_point(width, g, g2, f11, f12, old.inner(k, 0), old.inner(k, 1), to);
    }

    // At a regular point (x, y) of the first ring: of the bicubic B-spline.
    static void regular_limit(const RingView& ring, std::uint32_t j, int x, int y, double* value,
                              double* da, double* db) {
        RingPlace around[3][3];
        for (int k = 0; k < 9; ++k)
            around[k / 3][k % 3] = ring_place(ring.shape, j, x - 1 + k % 3, y - 1 + k / 3);
        for (std::uint32_t d = 0; d < ring.width; ++d) {
            double row[3], slope[3];
            for (int k = 0; k < 3; ++k) {
                const double before = ring.number(around[k][0], d);
                const double after = ring.number(around[k][2], d);
                row[k] = ((before + after) + 4 * ring.number(around[k][1], d)) / 6;
                slope[k] = 0.5 * (after - before);
            }
            value[d] = ((row[0] + row[2]) + 4 * row[1]) / 6;
            da[d] = ((slope[0] + slope[2]) + 4 * slope[1]) / 6;
            db[d] = 0.5 * (row[2] - row[0]);
        }
    }

    static void smooth_limit(const RingView& ring, double* value) {
        const double n = ring.shape.sectors;
        for (std::uint32_t d = 0; d < ring.width; ++d) {
            double edges = 0, faces = 0;
            for (std::uint32_t j = 0; j < ring.shape.sectors; ++j) {
                edges += ring.one_step(j)[d];
                faces += ring.inner(j)[d];
            }
            value[d] = (n * n * ring.centre()[d] + 4 * edges + faces) / (n * (n + 5));
        }
    }
    // Scaled so that valence 4 gives the B-spline's derivatives.
    static RingMode mode(const RingShape& shape) {
        const double c = std::cos(ring_angle(shape));
        const double eigenvalue = (5 + c + std::sqrt((9 + c) * (1 + c))) / 16;
        return {eigenvalue, 4,   1 / (4 * eigenvalue - 1), 1.0 / (3.0 * shape.sectors),
                1.0 / 16,   0.25};
    }
};

// Loop 1987; limits and tangents: Hoppe et al. 1994.
struct LoopRing {
    static void edge_point(std::uint32_t width, const double* p, const double* q, const double* a,
                           const double* b, double* out) {
        for (std::uint32_t d = 0; d < width; ++d)
            out[d] = 0.375 * (p[d] + q[d]) + 0.125 * (a[d] + b[d]);
    }
    // Loop's β: the weight of each neighbour.
    static double neighbour_weight(double n) {
        const double c = 0.375 + 0.25 * std::cos(2 * std::numbers::pi / n);
        return (0.625 - c * c) / n;
    }

    static void refine_sector(const RingView& old, std::uint32_t j, double* next) {
        edge_point(old.width, old.one_step(j), old.one_step(j + 1), old.centre(), old.inner(j),
                   next + std::size_t(old.shape.inner(j, 0)) * old.width);
    }
    static void refine_edge(const RingView& old, std::uint32_t i, double* one, double* two) {
        const std::uint32_t k = old.shape.previous(i);
        const double *c = old.centre(), *e = old.one_step(i), *e2 = old.two_steps(i);
        const double *left = old.one_step(i + 1), *right = old.one_step(k);
        const double *f = old.inner(i), *g = old.inner(k);
        edge_point(old.width, c, e, left, right, one);
        for (std::uint32_t d = 0; d < old.width; ++d)
            two[d] =
                0.625 * e[d] + 0.0625 * ((c[d] + e2[d]) + (left[d] + right[d]) + (f[d] + g[d]));
    }
    // (1 − n · weight) of the vertex, and the weight of each neighbour.
    static void weigh(const RingView& ring, double weight, double* out) {
        const std::uint32_t n = ring.shape.sectors;
        for (std::uint32_t d = 0; d < ring.width; ++d) {
            double sum = 0;
            for (std::uint32_t i = 0; i < n; ++i) sum += ring.one_step(i)[d];
            out[d] = (1 - n * weight) * ring.centre()[d] + weight * sum;
        }
    }
    static void refine_centre(const RingView& old, double* next) {
        weigh(old, neighbour_weight(old.shape.sectors), next);
    }

    // Of the triangle at the sector's first edge (1, 0), at its last one (0, 1), or of the inverted
    // one between (1, 1), whose corners are (1,1), (0,1), (1,0) of the next level.
    static constexpr std::uint32_t control_count = 12;
    static RingPoint control(std::uint32_t j, std::uint32_t k, int qa, int qb) {
        const int sign = qa == 1 && qb == 1 ? -1 : 1;
        return {j, qa + sign * loop_controls[k].x, qb + sign * loop_controls[k].y};
    }
    static bool is_outer(const RingPoint& p) { return p.a + p.b > 2; }
    static void outer(const RingView& old, const RingPoint& p, double* to) {
        const std::uint32_t s = p.sector;
        if (p.a == 1 || p.a == 2) {
            const std::uint32_t near = p.a == 2 ? s : s + 1, far = p.a == 2 ? s + 1 : s;
            return edge_point(old.width, old.one_step(near), old.inner(s), old.one_step(far),
                              old.two_steps(near), to);
        }
        const std::uint32_t i = p.a == 3 ? s : s + 1;
        const double *e = old.one_step(i), *e2 = old.two_steps(i);
        if (old.shape.is_sharp(i)) return middle(old.width, e, e2, to);
        const std::uint32_t after = old.shape.edge(i), before = old.shape.previous(after);
        edge_point(old.width, e, e2, old.inner(after), old.inner(before), to);
    }

    static void regular_limit(const RingView& ring, std::uint32_t j, int x, int y, double* value,
                              double* da, double* db) {
        static constexpr double cosines[6] = {1, 0.5, -0.5, -1, -0.5, 0.5};
        const double* own = ring.point({j, x, y});
        for (std::uint32_t d = 0; d < ring.width; ++d)
            value[d] = loop_limit_own * own[d], da[d] = db[d] = 0;
        for (int k = 0; k < 6; ++k) {
            const RingPlace place =
                ring_place(ring.shape, j, x + loop_steps[k].x, y + loop_steps[k].y);
            for (std::uint32_t d = 0; d < ring.width; ++d) {
                const double number = ring.number(place, d);
                value[d] += number / loop_limit_parts;
                da[d] += cosines[k] * number / 3;
                db[d] += cosines[(k + 5) % 6] * number / 3;
            }
        }
    }

    static void smooth_limit(const RingView& ring, double* value) {
        const double n = ring.shape.sectors;
        weigh(ring, 1 / (0.375 / neighbour_weight(n) + n), value);
    }
    static RingMode mode(const RingShape& shape) {
        return {0.375 + 0.25 * std::cos(ring_angle(shape)), 2.0 / shape.sectors, 0, 1, 0.125, 0};
    }
};

}  // namespace prep::detail
