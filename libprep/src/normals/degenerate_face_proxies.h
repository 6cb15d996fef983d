// The normals that are used for faces without one.
#pragma once

#include <cstdint>
#include <vector>

#include "prep/face_normals.h"
#include "prep/mesh.h"
#include "prep/topology.h"

namespace prep::detail {

// Per face: the face whose normal it uses: itself where it is regular, a neighbour where its
// area is zero, no_index where there is none. Empty where every face is regular (the common case).
//
// A face of no area is a slit between its neighbours: the one across its longest edge, then across
// the next longest. Where that one has no area either, the way goes on over its longest other edge.
// Independent of the order of faces and vertices.
std::vector<std::uint32_t> stand_in_faces(const MeshView& mesh, const Topology& topology,
                                          const FaceNormals& faces);

}  // namespace prep::detail
