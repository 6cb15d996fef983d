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
// their first vertices' normals and the surface's. From the mesh to the surface only: what of the
// surface is far from the mesh is not looked for.
struct LimitErrors {
    std::vector<double> distances, degrees;
};
LimitErrors limit_errors(const SplineCage& cage, const prep::Mesh& mesh, std::size_t most = 1000);
// That, for a metric's domain.
inline constexpr const char* limit_samples =
    "distance to the limit, at middles, edges and vertices of about 1,000 faces or all";

}  // namespace cost
