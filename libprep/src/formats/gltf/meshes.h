// Meshes of a glTF document: one Mesh for each, its primitives one after the other.
#pragma once

#include "formats/gltf/document.h"

namespace prep::detail {

// The largest joint that a vertex of a primitive uses (with a weight that is not zero), for the
// comparison with the skins of the nodes that draw it.
struct GltfJoints {
    std::string pointer;  // of the JOINTS_n attribute
    std::uint32_t largest = 0;
};

// Fills scene.meshes, document.primitives and `joints` (a list per mesh). Attributes become corner
// layers whose index is the vertex. Vertices of accessors that several primitives share are taken
// where they are used. Errors: invalid, limit (attributes of more than 256 MiB + 64 bytes for each
// byte of the file: its primitives use the same data again and again), those of the accessors.
Result<void> read_gltf_meshes(GltfDocument& document, Scene& scene,
                              std::vector<std::vector<GltfJoints>>& joints, int threads);

}  // namespace prep::detail
