// Meshes that Assimp takes apart.
#pragma once

#include <vector>

struct aiScene;

namespace prep::detail {

// The part of a mesh that came as one of Assimp's: vertices from `first_vertex` on.
struct MeshPart {
    unsigned first_vertex = 0, material = 0;
    bool normals = false, tangents = false;
    unsigned uv_sets = 0, color_sets = 0;  // a bit each
};

// Of each of the scene's meshes; empty for one that is not joined.
using MeshParts = std::vector<std::vector<MeshPart>>;

// Assimp gives a mesh of several materials as several, each with vertices of its own: surfaces that
// end where materials meet, for repair, normals and subdivision. Those of one node that have one
// name become one again, and those without names where the reader gives a node one mesh; their
// faces one after the other, their bones by name. Not where their morph targets differ in number,
// where two have the same points (one geometry twice), and where nodes share some of the parts, but
// not all.
MeshParts join_split_meshes(aiScene& scene);

}  // namespace prep::detail
