// MikkTSpace's groups and their tangents: steps 5 to 7, vertex by vertex.
//
// A group lies at one welded vertex, and whether two triangles are neighbours over an edge at that
// vertex can be told from the triangles around it alone. So every vertex is independent of the
// others, but for triangles that group with anything: those take the orientation of the group that
// reaches them first, in triangle order over the whole mesh. Vertices that such triangles touch are
// grouped in that order beforehand; all others in parallel.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "prep/tangents.h"
#include "tangent_mesh.h"

namespace prep::detail {

struct GroupFrame {  // what two results are compared by when the halves of a quad are averaged
    glm::vec3 s, t;
    float s_length, t_length;
};

struct GroupTangents {
    std::vector<glm::vec4> values;   // tangent and the definition's sign
    std::vector<GroupFrame> frames;  // parallel to values where the mesh has quads, else empty
    std::vector<std::uint32_t> corner_values;  // per good triangle corner: into values, or no_index
};

GroupTangents group_tangents(const TangentInput& input, const TangentMesh& mesh,
                             const TangentOptions& options);

}  // namespace prep::detail
