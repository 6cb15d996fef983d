// A coarser mesh whose vertices are some of a dense one's: what a scan leaves when it is reduced,
// while the scan still says what the surface is.
#pragma once

#include <cstdint>
#include <vector>

#include "prep/mesh.h"

namespace cost {

struct CoarseMesh {
    // Triangles of the dense mesh, each position once, none without area; corners of faces that
    // have more are cut as a fan.
    prep::Mesh dense;
    // Its triangles with `share` of its vertices.
    prep::Mesh mesh;
    std::vector<std::uint32_t> dense_vertices;  // of `mesh`, by vertex
};

// Vertices that lie inside the surface are removed by half-edge collapses (Hoppe 1996) in rounds of
// some that do not touch, in an order of their own, each onto the neighbour that leaves the best
// triangles; none is where faces would turn round or become needles. Fewer go where such are all
// that is left. O(n log n). The same mesh gives the same one.
CoarseMesh coarse_mesh(const prep::Mesh& mesh, double share);

}  // namespace cost
