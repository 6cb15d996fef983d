// Which way vertex normals went, for tests: the values are the same in each.
#pragma once

#include <cstddef>

#include "prep/corner_normals.h"

namespace prep::detail {

struct VertexNormalsPath {
    std::size_t open_vertices = 0;  // that the triangles in their order did not determine
    bool by_corners = false;        // all of them, in the end
};

// prep::vertex_normals().
Result<VertexNormals> vertex_normals(const MeshView& mesh, const VertexNormalOptions& options,
                                     VertexNormalsPath& path);

}  // namespace prep::detail
