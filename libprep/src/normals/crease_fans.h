// Hard edges and corner normals of manifold triangles in one walk around each point.
//
// Over an edge with one face on either side, both faces' corners at an end can be told from the
// corners at that end alone. Nothing is paired and kept: where hard_edges() and corner_normals()
// read the topology, here a point's corners are matched, its edges decided and its fans summed
// one after the other, while they are in the cache. The same decisions and the same bits; a fifth
// of the memory.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "prep/corner_normals.h"
#include "prep/face_normals.h"
#include "prep/hard_edges.h"
#include "prep/mesh.h"
#include "surface/vertex_corners.h"

namespace prep::detail {

// Whether crease_fans() may be tried.
bool may_have_crease_fans(const MeshView& mesh, const NormalOptions& options);

// corner_points: per corner its point (its vertex, or what that is welded to), and `around` the
// corners by point. `welded`: weld_exact(), or empty. Nothing where the general way is called for:
// at edges of three or more faces, where orientations disagree, at faces without an area, and for
// options that are no good; what was done is then lost, at most the whole walk, with exact
// precision no more than the matching. O(corners), at a pole O(corners · log corners).
std::optional<CreaseNormals> crease_fans(const MeshView& mesh,
                                         std::span<const std::uint32_t> corner_points,
                                         std::span<const std::uint32_t> welded,
                                         const VertexCorners& around, const FaceNormals& faces,
                                         const HardEdgeOptions& hard_options,
                                         const NormalOptions& options);

}  // namespace prep::detail
