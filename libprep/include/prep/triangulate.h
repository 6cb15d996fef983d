// Polygons into triangles that refer to the polygon's corners.
#pragma once

#include <cstdint>
#include <vector>

#include "prep/mesh.h"

namespace prep {

struct Triangulation {
    std::vector<std::uint32_t> corners;         // three per triangle, in the face's direction
    std::vector<std::uint32_t> triangle_faces;  // per triangle, ascending
};

// A face of k corners gives exactly k − 2 triangles. Triangles stay as they are; quads are cut
// along the shorter diagonal unless that one lies outside (concave quads) or would fold; larger
// polygons by ear clipping (Meisters 1975) in the plane of their Newell normal, with exact
// orientation tests. Self-crossing, collinear and degenerate polygons still give k − 2 triangles.
// O(corners) for triangles and quads; a simple polygon of k corners takes about O(k log k) on
// everyday outlines, O(k²) at worst. What costs more than 2·10^8 looks (some seconds: large
// polygons that cross themselves) is cut without looking from there on.
Triangulation triangulate(const MeshView& mesh, int threads = 0);

}  // namespace prep
