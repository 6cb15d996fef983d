#include "limit_surface/extraordinary_ring.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "limit_surface/ring_masks.h"

namespace prep::detail {
namespace {

template <class Scheme>
void refine(const RingView& old, double* next) {
    const RingShape& shape = old.shape;
    const double* c = old.centre();
    for (std::uint32_t j = 0; j < shape.sectors; ++j) Scheme::refine_sector(old, j, next);
    for (std::uint32_t i = 0; i < shape.edges(); ++i) {
        double* const one = next + std::size_t(shape.one_step(i)) * old.width;
        double* const two = next + std::size_t(shape.two_steps(i)) * old.width;
        if (!shape.is_sharp(i)) {
            Scheme::refine_edge(old, i, one, two);
            continue;
        }
        middle(old.width, c, old.one_step(i), one);
        crease_point(old.width, old.one_step(i), c, old.two_steps(i), two);
    }
    if (shape.corner_rule)
        copy(old.width, c, next);
    else if (!shape.closed)
        crease_point(old.width, c, old.one_step(0), old.one_step(shape.sectors), next);
    else
        Scheme::refine_centre(old, next);
}

template <class Scheme>
void patch(const RingView& old, const RingView& fresh, std::uint32_t j, int qa, int qb,
           double* out) {
    const RingShape& shape = old.shape;
    const std::uint32_t width = old.width;
    std::vector<double> more(shape.is_sharp(j) || shape.is_sharp(j + 1) ? 2 * width : 0);
    const auto inside = [&](const RingPoint& p, double* to) {
        if (Scheme::is_outer(p)) return Scheme::outer(old, p, to);
        copy(width, fresh.point(p), to);
    };
    for (std::uint32_t k = 0; k < Scheme::control_count; ++k, out += width) {
        const RingPoint p = Scheme::control(j, k, qa, qb);
        const RingPlace place = ring_place(shape, j, p.a, p.b);
        inside(place.at[0], out);
        if (!place.beyond) continue;
        inside(place.at[1], more.data());
        inside(place.at[2], more.data() + width);
        for (std::uint32_t d = 0; d < width; ++d) out[d] = out[d] + more[d] - more[width + d];
    }
}

void smooth_tangents(const RingView& ring, const RingMode& mode, double* t0, double* t1) {
    const double angle = ring_angle(ring.shape);
    for (std::uint32_t d = 0; d < ring.width; ++d) t0[d] = t1[d] = 0;
    for (std::uint32_t j = 0; j < ring.shape.sectors; ++j) {
        const double here_cos = std::cos(angle * j), there_cos = std::cos(angle * (j + 1));
        const double here_sin = std::sin(angle * j), there_sin = std::sin(angle * (j + 1));
        const double ce = mode.edge * here_cos, cf = mode.face * (here_cos + there_cos);
        const double se = mode.edge * here_sin, sf = mode.face * (here_sin + there_sin);
        for (std::uint32_t d = 0; d < ring.width; ++d) {
            const double e = ring.one_step(j)[d], f = ring.inner(j)[d];
            t0[d] += mode.scale * (ce * e + cf * f);
            t1[d] += mode.scale * (se * e + sf * f);
        }
    }
}

// Along the crease, and across it: the left eigenvector ℓ of the mode sin(iθ). Its weights at the
// crease's own points, x at the ends and c at the vertex, follow from ℓ S = λ ℓ in their columns:
//   λ x = x/2 + c/8 + at_end      λ c = 3c/4 + x + at_centre
void crease_tangents(const RingView& ring, const RingMode& mode, double* t0, double* t1) {
    const std::uint32_t m = ring.shape.sectors;
    const double *c = ring.centre(), *first = ring.one_step(0), *last = ring.one_step(m);
    for (std::uint32_t d = 0; d < ring.width; ++d) t0[d] = 0.5 * (first[d] - last[d]);
    if (m == 1) {  // the curvature of the crease outweighs what the face does
        for (std::uint32_t d = 0; d < ring.width; ++d) t1[d] = (first[d] - c[d]) + (last[d] - c[d]);
        return;
    }
    const double angle = ring_angle(ring.shape), lambda = mode.eigenvalue;
    const auto edge = [&](std::uint32_t i) { return mode.edge * std::sin(angle * i); };
    const auto face = [&](std::uint32_t j) {
        return mode.face * (std::sin(angle * j) + std::sin(angle * (j + 1)));
    };
    double edge_sum = 0, face_sum = 0;
    for (std::uint32_t i = 1; i < m; ++i) edge_sum += edge(i);
    for (std::uint32_t j = 0; j < m; ++j) face_sum += face(j);
    const double at_end = edge(1) * mode.end_of_edge + face(0) * mode.end_of_face;
    const double at_centre = 0.375 * edge_sum + 0.25 * face_sum;
    const double determinant = (lambda - 1) * (lambda - 0.25);
    const double end = (at_end * (lambda - 0.75) + at_centre / 8) / determinant;
    const double centre = ((lambda - 0.5) * at_centre + at_end) / determinant;
    for (std::uint32_t d = 0; d < ring.width; ++d) {
        double sum = centre * c[d] + end * (first[d] + last[d]);
        for (std::uint32_t i = 1; i < m; ++i) sum += edge(i) * ring.one_step(i)[d];
        for (std::uint32_t j = 0; j < m; ++j) sum += face(j) * ring.inner(j)[d];
        t1[d] = mode.scale * sum;
    }
}

// A dart: no closed formula, but refinement converges like the subdominant eigenvalue's powers.
void dart_limit(const RingView& ring, double* value, std::span<double> scratch) {
    const std::size_t size = std::size_t(ring.shape.point_count()) * ring.width;
    double *from = scratch.data(), *to = scratch.data() + size;
    refine_ring(ring.shape, ring.width, ring.numbers, from);
    for (int level = 0; level < 100; ++level) {
        refine_ring(ring.shape, ring.width, from, to);
        std::swap(from, to);
    }
    copy(ring.width, from, value);
}

template <class Scheme>
RingLimit limit(const RingView& ring, double* value, double* t0, double* t1,
                std::span<double> scratch) {
    const RingShape& shape = ring.shape;
    const double* c = ring.centre();
    const std::uint32_t m = shape.sectors;
    if (shape.corner_rule) {
        for (std::uint32_t d = 0; d < ring.width; ++d) {
            value[d] = c[d];
            t0[d] = ring.one_step(0)[d] - c[d];
            t1[d] = ring.one_step(shape.closed ? 1 : m)[d] - c[d];
        }
        return {!shape.closed && m == 1};
    }
    if (!shape.closed) {
        for (std::uint32_t d = 0; d < ring.width; ++d)
            value[d] = (4 * c[d] + (ring.one_step(0)[d] + ring.one_step(m)[d])) / 6;
        crease_tangents(ring, Scheme::mode(shape), t0, t1);
        return {true};
    }
    const bool two_quads = m == 2 && !shape.triangles;
    if (two_quads) {  // the modes along the edges and across them, both of eigenvalue 1/4
        for (std::uint32_t d = 0; d < ring.width; ++d) {
            t0[d] = 0.5 * (ring.one_step(0)[d] - ring.one_step(1)[d]);
            t1[d] = 0.5 * (ring.inner(0)[d] - ring.inner(1)[d]);
        }
    } else {
        smooth_tangents(ring, Scheme::mode(shape), t0, t1);
    }
    if (shape.sharp_edge)
        dart_limit(ring, value, scratch);
    else
        Scheme::smooth_limit(ring, value);
    return {!shape.sharp_edge && (m > 2 || two_quads)};
}

// Points are of three numbers most often: with everything inlined their loops are unrolled, for
// half of the time.
template <class Scheme>
[[gnu::flatten]] void refine_points(const RingShape& shape, const double* rings, double* next) {
    refine<Scheme>({shape, 3, rings}, next);
}
template <class Scheme>
[[gnu::flatten]] void patch_of_points(const RingShape& shape, const double* rings,
                                      const double* next, std::uint32_t j, int qa, int qb,
                                      double* out) {
    patch<Scheme>({shape, 3, rings}, {shape, 3, next}, j, qa, qb, out);
}

}  // namespace

void refine_ring(const RingShape& shape, std::uint32_t width, const double* rings, double* next) {
    if (width == 3)
        return shape.triangles ? refine_points<LoopRing>(shape, rings, next)
                               : refine_points<CatmarkRing>(shape, rings, next);
    const RingView old{shape, width, rings};
    shape.triangles ? refine<LoopRing>(old, next) : refine<CatmarkRing>(old, next);
}

void ring_patch(const RingShape& shape, std::uint32_t width, const double* rings,
                const double* next, std::uint32_t j, int qa, int qb, double* out) {
    if (width == 3)
        return shape.triangles ? patch_of_points<LoopRing>(shape, rings, next, j, qa, qb, out)
                               : patch_of_points<CatmarkRing>(shape, rings, next, j, qa, qb, out);
    const RingView old{shape, width, rings}, fresh{shape, width, next};
    shape.triangles ? patch<LoopRing>(old, fresh, j, qa, qb, out)
                    : patch<CatmarkRing>(old, fresh, j, qa, qb, out);
}

void ring_corner_limit(const RingShape& shape, std::uint32_t width, const double* rings,
                       std::uint32_t j, int x, int y, double* value, double* da, double* db) {
    const RingView ring{shape, width, rings};
    shape.triangles ? LoopRing::regular_limit(ring, j, x, y, value, da, db)
                    : CatmarkRing::regular_limit(ring, j, x, y, value, da, db);
}

RingLimit ring_limit(const RingShape& shape, std::uint32_t width, const double* rings,
                     double* value, double* t0, double* t1, std::span<double> scratch) {
    const RingView ring{shape, width, rings};
    return shape.triangles ? limit<LoopRing>(ring, value, t0, t1, scratch)
                           : limit<CatmarkRing>(ring, value, t0, t1, scratch);
}

double ring_angle(const RingShape& shape) {
    return (shape.corner_rule ? 0.5 : shape.closed ? 2 : 1) * std::numbers::pi / shape.sectors;
}

}  // namespace prep::detail
