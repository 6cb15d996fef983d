// split() (prep/split_vertices.h) with what is known of the mesh already.
#pragma once

#include "prep/split_vertices.h"
#include "surface/vertex_corners.h"

namespace prep::detail {

// `around`: corners by the mesh's vertices, or null: found here.
Result<VertexMesh> split_vertices(const Mesh& mesh, const HardEdges* hard,
                                  const VertexCorners* around, const SplitOptions& options);

}  // namespace prep::detail
