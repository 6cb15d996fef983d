// What a primitive of a new glTF document says of skins and morph targets, by vertex.
#pragma once

#include <cstdint>
#include <span>

#include "formats/gltf/buffer.h"
#include "prep/prepared_scene.h"

namespace prep::detail {

struct PrimitiveVertices {
    const PreparedScene& prepared;
    std::uint32_t mesh;
    std::span<const std::uint32_t> used;  // of the split mesh; empty: all of them
    std::size_t count;
    std::uint32_t at(std::size_t i) const { return used.empty() ? std::uint32_t(i) : used[i]; }
};

// JOINTS_n and WEIGHTS_n: weights normalised, none twice for a joint, joint 0 where there is none.
void add_influences(const PrimitiveVertices& vertices, GltfBuffer& buffer, Json& attributes);

// "targets": positions, and normals and tangents of the attributes that the primitive has; only
// what differs from 0, where that is shorter.
void add_targets(const PrimitiveVertices& vertices, const Json& attributes, Json& document,
                 GltfBuffer& buffer, Json& primitive);

// The mesh's weights at rest and the names of its targets.
void add_target_members(const Mesh& mesh, Json& out);

}  // namespace prep::detail
