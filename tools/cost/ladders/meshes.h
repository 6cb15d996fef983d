// Meshes that ladders are tried on, made of surfaces whose normals and tangents are known.
#pragma once

#include <vector>

#include "cost/measure/metrics.h"
#include "cost/oracles/surfaces.h"
#include "prep/mesh.h"

namespace cost {

// A mesh whose vertices lie on a known surface: what the surface has at each of them.
struct KnownMesh {
    prep::Mesh mesh;
    std::vector<SurfaceSample> at;  // by vertex
};

// Triangles over `around` × `across` places, closed in both directions; parameters are jittered by
// up to `jitter` of a step, and so are the diagonals chosen. Positions are rounded to float: the
// truth moves by as little.
KnownMesh known_torus(int around, int across, double jitter);

// Errors in degrees of values at corners against the truth at their vertices.
template <class Value, class Truth>
std::vector<double> corner_errors(const prep::Mesh& mesh, const prep::CornerLayer<Value>& layer,
                                  const Truth& truth) {
    std::vector<double> errors;
    errors.reserve(mesh.corner_count());
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        const Value& v = layer.values[layer.indices[c]];
        errors.push_back(degrees_between(Vector(v.x, v.y, v.z), truth(c)));
    }
    return errors;
}

// {largest, 99.9 %, mean}, the first three metrics of most ladders.
std::vector<double> three_of(const std::vector<double>& errors);

}  // namespace cost
