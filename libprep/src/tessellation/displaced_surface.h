// A base surface with its heights, and the proof of how far a triangle is from it.
//
// Of a triangle with corners v (S, h, n there: surface, height, unit direction), final positions
// V = S(v) + h(v) n(v) + e(v) and I f the linear interpolation of f at its corners, a point with
// weights λ is off by
//   S + h n − I V = (S − I S) + (h n − I (h n)) − I e,
//   h n − I (h n) = (h − I h) n + I h (n − I n) + (I h · I n − I (h n)),
//   I h · I n − I (h n) = −Σ over pairs of corners λ λ' (h − h')(n − n'),
// the last since the weights add up to 1. |n| = 1, |I h| ≤ max |h|, Σ λ λ' ≤ 1/3. So no point is
// further off than
//   |S − I S| + |h − I h| + max |h| · |n − I n| + ⅓ max |h − h'||n − n'| + max |e|,
// where S, n and h bring their own suprema. A vector d adds |d − I d|. Noise f at S adds, with its
// values at the corners f(S(v)), |f(S) − f(I S)| + |f(I S) − I f|: its change over |S − I S|
// (by its steepest slope) and its deviation over the plane triangle I S; in all no more than its
// values span. A vector in the surface's own frame adds what tangent_frames.h says. e has two
// causes: rounding to floats, and positions that several faces share though their heights or
// directions differ.
//
// A closed face (bisection.h) is bounded by its roots, as if these had the true point P(m) for
// their third corner: what is linear over each of them differs from what is linear over all by
// nothing at the corners, and at the centre m by P(m) less the mean of a pair's P(a) and P(c), or a
// triangle's three corners; which adds its length. Where UVs are linear over the closed face, the
// bound may also be that of a triangle, with only S − I S and n − I n from the roots in this way.
//
// By parts: over a part of a triangle I V is linear, too, so with J for linear interpolation
// between the part's corners, |V' − I V| ≤ |V' − J V'| + max over these corners of |V' − I V|, V'
// being the displaced surface. Parts are halved worst first. Of the base, |S − J S| ≤ 2 sup |S − I
// S|, as J S − I S = J (S − I S): most parts take that over. Where a map is as far from what is
// linear over a fourth of the triangle as over all of it, parts gain nothing of it: then V without
// the map, S + f n, is bounded by parts, and h n − I (h n), of the map's heights h, as a whole.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "base/large_vector.h"
#include "tessellation/root_heights.h"
#include "tessellation/surface.h"

namespace prep::detail {

// Vertices of the tessellation. Those on the edges of the cage are shared between roots.
struct VertexSample {
    BasePoint point;
    double raw = 0, height = 0;  // not of shared ones
    glm::vec3 position{0.0F};
    bool shared = false;
};
using VertexSamples = LargeVector<VertexSample>;

struct TriangleBound {
    float refinable = 0;  // what finer triangles make smaller; rounded up
    float gap = 0;        // max |e|; rounded up
    // Their slack is more than this addition loses.
    double sum() const { return double(refinable) + double(gap); }
};

// Bounds of `refinable` up to `enough` need not be tight, nor those of triangles that exceed
// `too_much` without the base's own share. With 0 the base's share is at most 1/64 of the bound
// where it is not tight.
struct Asked {
    double enough = 0;
    double too_much = std::numeric_limits<double>::infinity();
    // An error of a single point that is larger decides, wherever it is seen from.
    double hopeless = std::numeric_limits<double>::infinity();
};

class DisplacedSurface {
  public:
    DisplacedSurface(const BaseSurface& base, const RootHeights& heights);
    const BaseSurface& base() const { return base_; }
    const RootHeights& heights() const { return heights_; }

    TrianglePoints points(const BisectedTriangle& triangle) const {
        return {heights_.domain(), triangle.root, triangle.path};
    }
    // The truth at points, as their own roots have it.
    glm::dvec3 truth(const RootPoint& at) const;
    void truths(std::span<const RootPoint> at, std::span<glm::dvec3> truths) const;
    // A triangle's corners, as its own root has them.
    std::array<glm::dvec3, 3> own_corners(const BisectedTriangle& triangle) const;
    // Its unit normal, from the derivatives dP + dh n + h dn + dd; of the base those along its
    // shading's surface.
    glm::dvec3 normal(const BaseFrame& frame, const RootPoint& at) const;

    // Sets vertex `vertex` from its points: all roots' that it is in, or one where it is in but
    // one fan. `sides`: the base there.
    void make_vertex(std::span<const RootPoint> at, std::span<const BasePoint> sides,
                     std::uint32_t vertex, VertexSamples& samples) const;

    TriangleBound bound(const BisectedTriangle& triangle, const VertexSamples& samples,
                        const Asked& asked) const;
    // The same where little time decides what is asked, else nothing: without the base's tight
    // bound, parts and vectors. Infinite where a height alone is hopeless. Of triangles without
    // shared vertices; `weights`: path_weights().
    std::optional<TriangleBound> quick_bound(const BisectedTriangle& triangle,
                                             const std::array<glm::dvec3, 3>& weights,
                                             const VertexSamples& samples,
                                             const Asked& asked) const;

  private:
    struct Corners;  // of a triangle, as its root has them
    // `count` of them are vertices, the others points of the root alone, which have no gap.
    Corners corners(std::uint32_t root, const std::array<glm::dvec3, 3>& weights,
                    const std::array<const VertexSample*, 3>& samples, std::size_t count = 3) const;
    Corners corners(const BisectedTriangle& triangle, const std::array<glm::dvec3, 3>& weights,
                    const VertexSamples& samples) const;
    // What there is beside the base: noise over the plane triangle apart, as its values span no
    // more than so much, wherever they are taken.
    struct BesideBase {
        double sum = 0, noise = 0;
    };
    static double in_all(const Corners& corners, const BaseDeviation& base, const BesideBase& rest);
    BesideBase beside_base(const Corners& corners, double base, double enough) const;
    BesideBase beside_base(const Corners& corners, const std::array<glm::dvec2, 3>& uv, double base,
                           double enough) const;
    // `known`: a bound of the base that holds, and becomes the least that is learnt on the way.
    double refinable(const Corners& corners, const Asked& asked, BaseDeviation& known) const;
    struct Whole;  // a triangle that is bounded by parts
    // Of one triangle, or of a closed face's roots.
    double bound_by_parts(std::span<const Whole> wholes, const Asked& asked) const;
    // |h n − I (h n)| of the map's heights h, where the map is rough over the triangle and that is
    // most of it; of maps without vectors.
    std::optional<double> bound_of_rough_map(const Whole& whole) const;
    // Of the noise by parts, beside `of_map`.
    double bound_noise_apart(const Whole& whole, double of_map, const Asked& asked) const;
    // `roots`: a closed face's. Infinite where UVs are not linear over them, or vectors turn.
    double bound_as_one(const BisectedTriangle& closed, std::span<const Whole> roots,
                        double enough) const;
    TriangleBound closed_bound(const BisectedTriangle& closed, const VertexSamples& samples,
                               const Asked& asked) const;

    const BaseSurface& base_;
    const RootHeights& heights_;
    // The surface with the noise alone, where there are maps besides.
    std::shared_ptr<const RootHeights> noise_heights_;
    std::shared_ptr<const DisplacedSurface> noise_surface_;
};

}  // namespace prep::detail
