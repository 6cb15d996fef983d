// The shapes that a mesh's morph targets lead to.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "prep/mesh.h"

namespace prep::detail {

// A mesh with one target at weight 1, by vertex.
struct MorphShape {
    std::vector<glm::vec3> positions;
    // Empty: the target turns no normal. By corner where the mesh has corner_file_vertices.
    std::vector<glm::vec3> normal_deltas;
    bool moves = false;  // the target has positions
};

// O(vertices · log(runs)).
MorphShape morph_shape(const Mesh& mesh, const MorphTarget& target);

// The mesh's normals plus their deltas (MorphShape's), unit where they are not zero.
CornerLayer<glm::vec3> morphed_normals(const Mesh& mesh, const std::vector<glm::vec3>& deltas);

}  // namespace prep::detail
