// The parameters of a cage's faces, and where tessellation starts.
//
// Each face is a fan of root triangles about a centre. A root has the corners (a, b, centre), where
// ab is an edge of the face, counter-clockwise; so that an edge of the cage is the refinement edge
// of all roots at it (bisection.h).
//
// Tessellation starts with faces closed, as far as may be. A triangle is one. A
// quad is two pairs of its roots: the triangles on both sides of a diagonal, whose middle stands
// for the centre. Of the diagonals along which the two run the same way it is the one that is
// nearer to the surface's centre; of those that are as near the shorter one between the cage's
// vertices, of equal ones that of the corner whose position is the least by x, then y, then z, of
// equal ones that of the vertex of the lowest number: which corner comes first does not matter. A
// quad that has a vertex twice, or whose diagonal is an edge of a face or another quad's diagonal
// as well (the two would be one edge of four triangles), starts as its fan, as other faces do.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "prep/mesh.h"
#include "tessellation/bisection.h"

namespace prep::detail {

struct DomainRoot {
    std::uint32_t face = 0;
    std::uint32_t fan = 0;
    std::array<std::uint32_t, 2> corners{};  // of the mesh: a and b
};

struct Domain {
    std::vector<DomainRoot> roots;
    std::vector<std::uint32_t> fan_roots{0};  // per fan (+ 1): its first root
    std::uint32_t cage_vertices = 0;

    std::uint32_t fans() const { return std::uint32_t(fan_roots.size() - 1); }
    // The root (b, c, centre) of (a, b, centre).
    std::uint32_t next_root(std::uint32_t root) const {
        const std::uint32_t fan = roots[root].fan;
        return root + 1 == fan_roots[fan + 1] ? fan_roots[fan] : root + 1;
    }
};

// One fan a face, in order; faces whose `left_out` is set (empty: none) have no roots. With
// `straight`, a polygon that is not star-shaped about the mean of its corners is cut into triangles
// first, a fan each.
Domain make_domain(const Mesh& mesh, const std::vector<std::uint8_t>& left_out, bool straight,
                   int threads);

// Where tessellation starts. Vertices are the cage's, then the centres of those fans that are open.
struct DomainStart {
    std::vector<FirstTriangle> triangles;
    std::vector<std::uint32_t> centres;  // fans
};

// Which of a quad's diagonals, that of the first corner or of the second, is nearer to the
// surface's centre.
enum class Nearer : std::uint8_t { neither, first, second };

// `nearer`: per fan; read of quads alone. Half-edges of equal vertices at an edge of no length are
// not linked.
DomainStart make_start(const Domain& domain, const Mesh& mesh, std::span<const Nearer> nearer);

// Points of a triangle of the tessellation, by weights of its corners: in the root that it is a
// part of, or in one of a closed face's.
class TrianglePoints {
  public:
    TrianglePoints(const Domain& domain, std::uint32_t root, std::uint64_t path) : roots_{root} {
        if (path != 0) {
            corners_ = path_weights(path);
            return;
        }
        const std::uint32_t fan = domain.roots[root].fan;
        closed_ = domain.fan_roots[fan + 1] - domain.fan_roots[fan] == 3 ? whole : pair;
        roots_[1] = domain.next_root(root);
        roots_[2] = domain.next_root(roots_[1]);
    }
    RootPoint at(const glm::dvec3& w) const {
        if (closed_ == whole) {
            if (w.z <= w.x && w.z <= w.y) return {roots_[0], {w.x - w.z, w.y - w.z, 3 * w.z}};
            if (w.x <= w.y) return {roots_[1], {w.y - w.x, w.z - w.x, 3 * w.x}};
            return {roots_[2], {w.z - w.y, w.x - w.y, 3 * w.y}};
        }
        if (closed_ == pair) {
            // (c, a, b) as (a, b, m) where there is more of a than of c, else as (b, c, m).
            if (w.y >= w.x) return {roots_[0], {w.y - w.x, w.z, 2 * w.x}};
            return {roots_[1], {w.z, w.x - w.y, 2 * w.y}};
        }
        return {roots_[0], w.x * corners_[0] + w.y * corners_[1] + w.z * corners_[2]};
    }
    RootPoint corner(std::size_t k) const {
        glm::dvec3 w(0.0);
        w[glm::length_t(k)] = 1;
        return at(w);
    }
    // The root that has the edge from corner k to the next one. Not of a pair's diagonal, k = 0.
    std::uint32_t edge_root(std::size_t k) const {
        return roots_[closed_ == whole ? k : closed_ == pair ? k - 1 : 0];
    }

  private:
    enum Closed : std::uint8_t { open, pair, whole };
    Closed closed_ = open;
    std::array<std::uint32_t, 3> roots_{};
    std::array<glm::dvec3, 3> corners_{};
};

// The corners of a fan, in order.
template <class Body>
void for_fan_corners(const Domain& domain, std::uint32_t fan, const Body& body) {
    for (std::uint32_t r = domain.fan_roots[fan]; r < domain.fan_roots[fan + 1]; ++r)
        body(domain.roots[r].corners[0]);
}

}  // namespace prep::detail
