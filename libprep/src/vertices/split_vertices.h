// split() (prep/split_vertices.h) with what is known of the mesh already.
#pragma once

#include "prep/split_vertices.h"
#include "surface/vertex_corners.h"

namespace prep::detail {

// `around`: corners by the mesh's vertices, or null: found here. `computed`: the corners whose
// normals follow `hard`, where others keep the file's; null: all. `unmarked`: why normals differ
// where `hard` does not say it.
Result<VertexMesh> split_vertices(const Mesh& mesh, const HardEdges* hard,
                                  const VertexCorners* around, const SplitOptions& options,
                                  const std::vector<bool>* computed = nullptr,
                                  SplitReason unmarked = SplitReason::authored_normal);

}  // namespace prep::detail
