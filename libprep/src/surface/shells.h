// Closed components of a surface: their volumes, and which of them are turned inside out.
#pragma once

#include <cstdint>
#include <vector>

#include "base/disjoint_sets.h"
#include "prep/face_normals.h"
#include "prep/topology.h"

namespace prep::detail {

struct Shells {
    std::uint64_t count = 0;  // components, closed or not
    double volume = 0;        // signed, of the closed finite ones
    // Closed components of negative volume by their first face, ascending; cavities (inside the box
    // of an outward one) are not among them.
    std::vector<std::uint32_t> inside_out;
};

// `components`: sets of faces.
Shells measure_shells(const Mesh& mesh, const Topology& topology, const FaceNormals& faces,
                      DisjointSets& components);

}  // namespace prep::detail
