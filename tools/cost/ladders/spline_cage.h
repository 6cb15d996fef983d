// The cage of the ladders of subdivision and tessellation, and distances to its limit surface.
#pragma once

#include <vector>

#include "cost/oracles/surfaces.h"
#include "prep/mesh.h"

namespace cost {

// A closed cage of 8 × 6 quads around a torus; its diagonal.
struct SplineCage {
    SplineCage();
    prep::Mesh mesh;
    SplineTorus limit;
    double diagonal = 0;
};

// Of `most` faces or a few more, spread over the mesh: distances to the limit surface of their
// middles, their edges' midpoints and their vertices, as shares of the diagonal, and angles between
// normals and the surface's where it is nearest: those of their first vertices, and, inside, the
// mean of the corners' at their middles.
struct LimitErrors {
    std::vector<double> distances, degrees, inside;
};
LimitErrors limit_errors(const SplineCage& cage, const prep::Mesh& mesh, std::size_t most = 1000);
// From the surface back: how far the farthest of 3,072 of its points, spread evenly over its
// parameters, is from the mesh, its polygons cut as fans from their first corners; as a share of
// the diagonal. Infinity for a mesh without faces.
double farthest_from(const SplineCage& cage, const prep::Mesh& mesh);
inline constexpr const char* back_samples = "distance from 3,072 points of the limit to the mesh";
// limit_errors(), for a metric's domain.
inline constexpr const char* limit_samples =
    "distance to the limit, at middles, edges and vertices of about 1,000 faces or all";

}  // namespace cost
