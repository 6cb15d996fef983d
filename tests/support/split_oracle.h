// Whether a split is what its header says, from the source mesh's bits alone.
#pragma once

#include "prep/mesh.h"

namespace split_oracle {

// The result against the definition: one vertex for each distinct set of attributes, the way back
// right, triangles those of triangulate() in ranges by part and material.
void expect_right(const prep::Mesh& mesh, const prep::VertexMesh& out);

}  // namespace split_oracle
