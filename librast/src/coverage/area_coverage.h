// How much of one pixel each surface is seen in: exact areas instead of samples.
//
// The pixel is kept as a partition into convex pieces, each owned by the surface in front there or
// by none. A new surface (a convex polygon with a plane of depth) cuts the pieces that it overlaps
// along its edges, and where it passes through the piece's owner along their line of equal depth:
// Catmull's hidden-surface algorithm at the pixel (1978) with Weiler and Atherton's clipping
// (1977), on convex pieces. Pieces never overlap and never leave a gap, so areas sum to 1.
//
// All in double; points within 1e-12 pixels of a line lie on it. Surfaces whose depths differ by
// less than 2^-22 of themselves all over a piece are at the same place: the lower owner is seen,
// as the rasterizer has it. Any order of the surfaces gives the same picture; from front to back
// makes the fewest pieces; n surfaces that all cut each other make O(n²) of them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace rast::detail {

// Depth over the pixel: at + dx · x + dy · y; larger is nearer, below 0 is beyond the far plane.
struct DepthPlane {
    double at = 0, dx = 0, dy = 0;
    double operator()(const glm::dvec2& p) const { return at + (dx * p.x + dy * p.y); }
};

// Twice the signed area of the triangle (0, a, b).
inline double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

class PixelCoverage {
  public:
    using Polygon = std::vector<glm::dvec2>;  // convex, either winding

    // Nothing is seen anywhere.
    void clear();
    // Corners in pixels from the pixel's top left corner. Polygons without area add nothing.
    void add(const Polygon& polygon, const DepthPlane& depth, std::uint32_t owner);
    // The same where only empty_area() is asked for, and nothing was added by add(): what is
    // covered is forgotten, and so cut no more. False: nothing is left to be covered.
    bool add_to_union(const Polygon& polygon, const DepthPlane& depth);

    struct Share {
        std::uint32_t owner = 0;
        double area = 0;  // of the pixel's 1
        glm::dvec2 centroid{0.0};
    };
    // What is seen of each surface, by ascending owner; the rest of the pixel is empty.
    std::vector<Share> shares() const;
    double empty_area() const;
    std::size_t piece_count() const { return pieces_.size(); }

    // The part of a convex polygon inside the pixel, and its centroid; no area: false.
    static bool clip_to_pixel(const Polygon& polygon, Polygon& inside, glm::dvec2& centroid);

  private:
    static constexpr std::uint32_t none = 0xFFFFFFFFu;
    struct Surface {
        DepthPlane depth;
        std::uint32_t owner = 0;
    };
    struct Piece {
        Polygon polygon;
        std::uint32_t surface = none;
    };
    // `common`: what of the piece the surface's polygon covers; `rest`: the other parts of it.
    void cover(const Piece& piece, Polygon common, std::vector<Polygon> rest,
               std::uint32_t surface);

    std::vector<Surface> surfaces_;
    std::vector<Piece> pieces_, next_;
};

}  // namespace rast::detail
