// Matrices that glTF's nodes cannot have: it asks that they be a translation, a rotation and a
// scale (glTF 2.0, 5.25.4 node.matrix).
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <utility>

#include "prep/scene.h"

namespace prep::detail {

// A matrix whose axes are not at right angles, or that is flat, as a node's transform and that of a
// node in it, which only turns: U S Vᵀ, the singular value decomposition of its linear part. Empty:
// a node can have the matrix.
std::optional<std::pair<Trs, Trs>> as_two_nodes(const glm::dmat4& matrix);

}  // namespace prep::detail
