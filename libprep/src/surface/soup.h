// Soups: in STL, for one, every corner has a vertex of its own, which says nothing but that the
// format cannot share.
#pragma once

#include "prep/mesh.h"

namespace prep::detail {

// Whether no two corners share a vertex and no vertex lies unused, and nothing but faces refers to
// vertices by number.
bool is_soup(const Mesh& mesh);

}  // namespace prep::detail
