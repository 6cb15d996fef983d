// The subdivision tags of OpenSubdiv's regression shapes: "t <name> <ints>/<floats>/<strings> …".
#pragma once

#include <string>
#include <string_view>

#include "prep/mesh.h"

namespace prep::detail {

// Adds one tag (the line without its "t") to the mesh. Vertices and faces count from 0. Returns
// what is wrong, or nothing. Tags that have no meaning here are kept out silently (the format is
// open).
std::string read_obj_tag(std::string_view text, Mesh& mesh);

}  // namespace prep::detail
