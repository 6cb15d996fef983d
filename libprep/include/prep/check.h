// check(): what is in a mesh and what is odd in it, with counts and the first places. It reads and
// changes nothing; prepare() and repair() change.
//
// Kinds of findings (stable identifiers), what a place is, and when they are reported:
//
//   geometry
//   non-finite-vertex    vertex  a coordinate is NaN or infinite
//   denormal-vertex      vertex  a coordinate is not zero but below 2⁻¹²⁶: tools that flush to zero
//                                see another shape
//   repeated-vertex-face face    two corners of a face are at the same point
//   zero-area-face       face    the area vector is exactly zero though all corners differ
//   duplicate-face       face    the same points in the same direction as an earlier face
//   opposite-face        face    the same points as an earlier face in the other direction
//   folded-edge          edge    two faces turn by more than 179.9° over their common edge
//   non-planar-face      face    a corner is off the face's mean plane by more than 1 % of its size
//   non-manifold-edge    edge    three or more faces
//   mixed-orientation    edge    two faces that run the same way
//   non-manifold-vertex  vertex  faces meet in the vertex alone (bow ties)
//   open-edge            edge    one face
//   hole                 edge    loops of open edges, by their first one
//   inside-out-shell     face    closed components of negative volume, by their first face
//   unreferenced-vertex  vertex  used by no face, line or point
//   isolated-point       vertex  drawn as a point
//   repeated-position    vertex  at the same point as an earlier vertex
//   far-from-origin      vertex  the distance to zero is so large against the extent that float
//                                coordinates lose more than 2⁻¹⁶ of it (place: the farthest)
//   attributes
//   missing-normal, zero-normal, non-finite-normal, non-unit-normal, flipped-normal     corner
//   missing-tangent, zero-tangent, non-finite-tangent, non-unit-tangent,
//   non-orthogonal-tangent, tangent-sign (not ±1)                                       corner
//   missing-uv           corner  a material samples a texture there (check of a scene), or the
//                                layer has a value at other corners
//   non-finite-uv        corner
//   degenerate-uv        face    its UV area is zero though its area is not
//   huge-uv              corner  beyond ±2048, where one step of a float is a texel of a 4096² map
//   mirrored-uv          face    its UVs run against the face
//   unknown-material     face    a material that the scene does not have
//   mesh
//   empty-mesh           –       no faces, lines or points
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "prep/findings.h"
#include "prep/mesh.h"
#include "prep/scene.h"

namespace prep {

// The numbers of one mesh. Edges and components are those of the welded mesh (exactly equal
// positions are one point; surfaces that only touch stay apart, see topology.h).
struct MeshSummary {
    std::uint64_t vertices = 0, points = 0;  // points: distinct finite positions that faces use
    std::uint64_t faces = 0, triangles = 0, quads = 0, polygons = 0;  // polygons: 5 or more corners
    std::uint64_t corners = 0, edges = 0;
    std::uint64_t open_edges = 0, holes = 0, non_manifold_edges = 0, mixed_orientation_edges = 0;
    std::uint64_t non_manifold_vertices = 0;
    std::uint64_t components = 0;  // of faces connected over edges
    std::uint64_t line_segments = 0, point_primitives = 0;
    std::uint64_t mirrored_uv_faces = 0;
    std::uint32_t largest_face = 0;     // its number of corners
    std::uint32_t largest_valence = 0;  // the most corners that meet in a point
    bool closed = false;                // there are faces, and no edge is open
    bool manifold = false;              // no non-manifold edge or vertex
    bool oriented = false;              // no edge of mixed orientation
    // Vertices − edges + faces; where surfaces only touch in a point, each counts its own vertex.
    std::int64_t euler = 0;
    // Sum over components, where closed, manifold and oriented; −1 elsewhere.
    std::int64_t genus = -1;
    // Of the finite vertices that anything uses, origin added; both zero where there is none.
    glm::dvec3 low{0.0}, high{0.0};
    double area = 0;    // sum over regular faces
    double volume = 0;  // signed, where closed, manifold and oriented; 0 elsewhere
};

struct MeshCheck {
    MeshSummary summary;
    std::vector<Finding> findings;  // those of vertices first, then as in the list above
};

struct CheckOptions {
    int threads = 0;
};

// Findings are exact where they are yes-or-no (zero area, repeated, folded, non-manifold). Findings
// carry `mesh_index`. O(corners · log(corners)); the same for any thread count.
MeshCheck check(const Mesh& mesh, std::uint32_t mesh_index = 0, const CheckOptions& options = {});

struct SceneCheck {
    std::vector<MeshSummary> meshes;  // one per Scene::meshes
    std::vector<Finding> findings;    // by mesh
};

// check() of every mesh, and what only the scene can tell: UVs that a material calls for, materials
// that are not there.
SceneCheck check(const Scene& scene, const CheckOptions& options = {});

}  // namespace prep
