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

// Of up to `most` faces spread over the mesh: distances to the limit surface of their middles, as
// shares of the diagonal, and angles between their vertices' normals and the surface's.
struct LimitErrors {
    std::vector<double> distances, degrees;
};
LimitErrors limit_errors(const SplineCage& cage, const prep::Mesh& mesh, std::size_t most = 1500);

}  // namespace cost
