// Triangles' corners of a GLB file, read by nothing but what the specification of glTF 2.0 and
// KHR_mesh_quantization say: what writers made of values is judged by what other programs find.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "cost/measure/metrics.h"

namespace cost {

// One value a corner, in the order of nodes, primitives and indices; empty where a primitive lacks
// them. Nodes are applied: positions and directions are the world's.
struct GlbCorners {
    std::vector<Vector> positions, normals, tangents;
    std::vector<Real> handedness;        // of tangents: their fourth number
    std::vector<glm::vec<2, Real>> uvs;  // the first set
};

// None: the file is no GLB, or has what is not read here (buffers of other files, sparse or
// compressed accessors, triangle strips, skins).
std::optional<GlbCorners> corners_of_glb(std::span<const std::byte> file);

}  // namespace cost
