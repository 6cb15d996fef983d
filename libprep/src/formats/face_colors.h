// Colours of faces, as PLY and OFF have them.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace prep {
struct Mesh;
}

namespace prep::detail {

// Makes them the mesh's first colours: all corners of a face have its own (glTF and most other
// formats know colours of vertices alone, which then have one for each). colors: linear, by face;
// faces beyond the last of them are white.
void set_face_colors(Mesh& mesh, std::vector<glm::vec4> colors);

}  // namespace prep::detail
