// Meshes for tests: known shapes, known defects, and exact ways to change a mesh.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <random>
#include <span>
#include <vector>

#include "prep/mesh.h"

namespace shapes {

using Faces = std::vector<std::vector<std::uint32_t>>;

prep::Mesh mesh_of(std::vector<glm::vec3> positions, const Faces& faces);

// [−1, 1]³, 8 vertices, 6 quads, outward.
prep::Mesh cube();
// width × depth unit quads in z = 0, facing +z; vertex (x, y) is y·(width + 1) + x.
prep::Mesh grid(std::uint32_t width, std::uint32_t depth);
// Unit sphere about zero: two poles, `rings` − 1 rings of `segments` vertices; quads and, at the
// poles, triangles.
prep::Mesh uv_sphere(std::uint32_t segments, std::uint32_t rings);
// The icosahedron with each triangle cut into four `levels` times, on the unit sphere.
prep::Mesh icosphere(int levels);
// From z = −1 to 1 over a polygon in the plane, counter-clockwise; side quads first, then the caps.
prep::Mesh prism(const std::vector<glm::vec2>& outline);
// The prism over `segments` points on the unit circle.
prep::Mesh cylinder(std::uint32_t segments);
// Radii 1 and 0.4 about z, quads.
prep::Mesh torus(std::uint32_t around, std::uint32_t across);
// An open disc: vertex 0 in the middle, `valence` triangles around it, rim at radius 1 and z =
// −height.
prep::Mesh fan(std::uint32_t valence, double height = 0.5);
// Two triangles that share an edge and have the face normals n0 and n1 (directions, exactly: all
// arithmetic is on small integers). The turn over the edge is the angle between n0 and n1; vertices
// 0 and 1 are the shared edge. n0 and n1 must not be parallel.
prep::Mesh wedge(const glm::ivec3& n0, const glm::ivec3& n1);
// Two tetrahedra that share vertex 0 alone.
prep::Mesh bow_tie();
// `faces` triangles around the common edge 0–1, all running the same way along it or alternating.
prep::Mesh book(std::uint32_t faces, bool alternating = false);
// A strip of `segments` quads closed with a half turn.
prep::Mesh moebius(std::uint32_t segments);
// One polygon with the given corners.
prep::Mesh polygon(const std::vector<glm::vec3>& corners);

// Every corner gets a vertex of its own.
prep::Mesh soup(const prep::Mesh& mesh);
// Triangle fans from each face's corner number `first` (modulo its size).
prep::Mesh fan_triangulated(const prep::Mesh& mesh, std::uint32_t first = 0);
// Faces reordered: new face i is old face order[i]. Layers, materials and groups follow.
prep::Mesh with_face_order(const prep::Mesh& mesh, std::span<const std::uint32_t> order);
// Vertices renumbered: old vertex v becomes new_index[v].
prep::Mesh with_vertex_order(const prep::Mesh& mesh, std::span<const std::uint32_t> new_index);
// Both meshes, `b` after `a`, vertices apart.
prep::Mesh joined(const prep::Mesh& a, const prep::Mesh& b);

std::vector<std::uint32_t> random_order(std::size_t count, std::mt19937_64& random);
// Every position moved by up to `amount` a component.
void jitter(prep::Mesh& mesh, float amount, std::mt19937_64& random);
// Triangles of random vertices: non-manifold, folded, degenerate now and then.
prep::Mesh random_triangles(std::size_t vertices, std::size_t faces, std::mt19937_64& random);

}  // namespace shapes
