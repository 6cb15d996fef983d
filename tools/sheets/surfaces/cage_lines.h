// The edges of a cage, straight and as curves of its limit surface; its extraordinary vertices.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "prep/result.h"
#include "prep/subdivide.h"
#include "prep/topology.h"

namespace report {

struct CageLine {
    std::vector<glm::dvec3> points;  // in the mesh's space, its origin added
    float sharpness = 0;             // of the cage's tags
};

// Every edge once, in the order of the faces' corners. O(edges log edges).
std::vector<CageLine> cage_edges(const prep::Mesh& cage);

// The same edges on the limit surface, of 16 segments; those without one (beside holes alone) are
// left out. Errors: those of LimitSurface::make.
prep::Result<std::vector<CageLine>> limit_edges(const prep::Mesh& cage,
                                                const prep::SubdivideOptions& options);

// Vertices where the surface is no regular spline: inside, not of four faces (Loop's triangles:
// six); at borders, not of two (three), but for corners of one. `topology` is the mesh's.
std::vector<std::uint32_t> extraordinary_vertices(const prep::Mesh& mesh,
                                                  const prep::Topology& topology, bool loop);

}  // namespace report
