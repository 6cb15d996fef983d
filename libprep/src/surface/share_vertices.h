// Vertices for meshes that have none to speak of: in STL and in soups every corner has a vertex of
// its own, which says nothing but that the format cannot share.
#pragma once

#include "prep/mesh.h"

namespace prep::detail {

// Whether no two corners share a vertex and no vertex lies unused, and nothing but faces refers to
// vertices by number.
bool is_soup(const Mesh& mesh);

// Makes corners at equal positions (==) share the first vertex there; the others are removed.
// Corners, and with them all attributes, stay as they are. NaN equals nothing. O(corners).
void share_equal_vertices(Mesh& mesh, int threads);

}  // namespace prep::detail
