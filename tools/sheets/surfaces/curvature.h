// Mean curvature of a prepared mesh, from its normals.
#pragma once

#include <vector>

#include "prep/prepared_scene.h"

namespace report {

// Per vertex, in units of one over length: positive where the surface bulges towards its normals (a
// sphere of radius r has 1/r), 0 where there are no normals. In each triangle the second
// fundamental form that fits the differences of its normals best (Rusinkiewicz 2004), of which the
// trace is used; averaged over the triangles of a place and normal by their areas, so that hard
// edges keep their sides apart and UV seams do not show. O(vertices log vertices).
std::vector<double> mean_curvature(const prep::VertexMesh& mesh);

// Vertex colours by it: red where the surface bulges, blue where it is hollow, white between; the
// only colours of the meshes. Returns the curvature of full colour, which 95 % of all vertices do
// not reach; 0 where there is none.
double color_by_curvature(prep::PreparedScene& scene);

}  // namespace report
