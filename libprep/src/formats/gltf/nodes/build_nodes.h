// Nodes, skins and animations of a new glTF document.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/gltf/buffer.h"
#include "prep/prepared_scene.h"

namespace prep::detail {

// Where meshes and lights stand in the document; no_index: they were left out.
struct WrittenParts {
    std::span<const std::uint32_t> meshes, lights;
};

// Nodes have the scene's numbers; those that carry a mesh far from its own origin come behind them,
// and those around a node whose matrix is none that glTF's nodes can have (sheared_matrix.h).
// What would not be valid (joints or channels of nodes that are not there) is left out and noted.
void build_nodes(const PreparedScene& prepared, const WrittenParts& written, Json& document,
                 GltfBuffer& buffer, std::vector<std::string>& notes);

}  // namespace prep::detail
