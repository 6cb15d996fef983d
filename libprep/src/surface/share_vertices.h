// Vertices for meshes that have none to speak of (soup.h).
#pragma once

#include "prep/mesh.h"

namespace prep::detail {

// Makes corners at equal positions (==) share the first vertex there; the others are removed.
// Corners, and with them all attributes, stay as they are. NaN equals nothing. O(corners).
void share_equal_vertices(Mesh& mesh, int threads);

}  // namespace prep::detail
