// The shapes that the morph targets of a glTF mesh lead to.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "formats/gltf/document.h"
#include "prep/mesh.h"
#include "prep/result.h"

namespace prep::detail {

// A mesh with one target at weight 1, by the vertices of `Mesh`.
struct MorphShape {
    std::vector<glm::vec3> positions;
    // Empty: the target turns no normal. By corner where the mesh has corner_file_vertices.
    std::vector<glm::vec3> normal_deltas;
    bool moves = false;  // the target has positions
};

// The most targets that a primitive of the mesh has.
std::size_t morph_target_count(const GltfDocument& document, std::size_t mesh_index);

// O(vertices · log(primitives)). Primitives without the target, or without one of its attributes,
// stay as they are in it. Errors: those of GltfDocument::raw_accessor.
Result<MorphShape> morph_shape(const GltfDocument& document, std::size_t mesh_index,
                               const Mesh& mesh, std::size_t target);

// The mesh's normals plus their deltas (MorphShape's), unit where they are not zero.
CornerLayer<glm::vec3> morphed_normals(const Mesh& mesh, const std::vector<glm::vec3>& deltas);

}  // namespace prep::detail
