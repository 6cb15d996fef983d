// Where tessellation starts: each face of the cage as a fan of root triangles about a centre.
//
// A root has the corners (a, b, centre), where ab is an edge of the face, counter-clockwise; so
// that an edge of the cage is the refinement edge of all roots at it (bisection.h).
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "prep/mesh.h"

namespace prep::detail {

struct DomainRoot {
    std::uint32_t face = 0;
    std::uint32_t fan = 0;
    std::array<std::uint32_t, 2> corners{};  // of the mesh: a and b
};

struct Domain {
    std::vector<DomainRoot> roots;
    std::vector<std::uint32_t> fan_roots{0};  // per fan (+ 1): its first root
    // Vertices are the cage's, then a centre a fan. Three each a root: as BisectionMesh wants them.
    std::vector<std::array<std::uint32_t, 3>> vertices;
    std::vector<std::uint32_t> next_half_edges;
    std::uint32_t cage_vertices = 0;

    std::uint32_t fans() const { return std::uint32_t(fan_roots.size() - 1); }
};

// One fan a face, in order; faces whose `left_out` is set (empty: none) have no roots. With
// `straight`, a polygon that is not star-shaped about the mean of its corners is cut into triangles
// first, a fan each. Half-edges of equal vertices at an edge of no length are not linked.
Domain make_domain(const Mesh& mesh, const std::vector<std::uint8_t>& left_out, bool straight,
                   int threads);

// The corners of a fan, in order.
template <class Body>
void for_fan_corners(const Domain& domain, std::uint32_t fan, const Body& body) {
    for (std::uint32_t r = domain.fan_roots[fan]; r < domain.fan_roots[fan + 1]; ++r)
        body(domain.roots[r].corners[0]);
}

}  // namespace prep::detail
