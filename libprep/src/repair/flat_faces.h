// Faces without area, whose vertices lie on one line. What is on both sides of them meets when they
// are gone: edges along the line take the vertices that they run past.
#pragma once

#include <cstdint>
#include <vector>

#include "prep/face_normals.h"
#include "prep/mesh.h"
#include "prep/topology.h"

namespace prep::detail {

// A vertex put into an edge of a face.
struct Insertion {
    std::uint32_t before = 0;  // corner of the face that the new one precedes
    std::uint32_t vertex = 0;
    float t = 0;  // where on the edge that ends there
};

struct FlatFaces {
    std::vector<std::uint8_t> keep;     // by face: 0 for those without area that can go
    std::vector<Insertion> insertions;  // by `before`, those into one edge along it
    std::uint64_t left = 0;             // stay: a crack would open
};

// Flat faces that share edges go together, or none of them: they stay where an edge beside them
// would need a vertex of another part (`parts`, by vertex, as parts_of_vertices), and where edges
// beside them run to and fro, past 16 times as many vertices as there are. `topology`: with
// equal positions as one point. O(corners · log(flat corners)).
FlatFaces take_out_flat_faces(const Mesh& mesh, const FaceNormals& faces, const Topology& topology,
                              const std::vector<std::uint32_t>& parts);

}  // namespace prep::detail
