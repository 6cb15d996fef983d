// Matrices that glTF's nodes cannot have: it asks that they be a translation, a rotation and a
// scale (glTF 2.0, 5.25.4 node.matrix).
#pragma once

#include <glm/glm.hpp>
#include <utility>

#include "prep/scene.h"

namespace prep::detail {

// The linear part's axes stand at right angles, up to the roundings of matrices of floats, and none
// of them has no length.
bool is_scaled_rotation(const glm::dmat4& matrix);

// Of any finite matrix: a node's transform and that of a node in it, which only turns. U S Vᵀ, the
// singular value decomposition of the linear part.
std::pair<Trs, Trs> as_two_nodes(const glm::dmat4& matrix);

}  // namespace prep::detail
