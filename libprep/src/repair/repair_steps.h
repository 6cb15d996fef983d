// The steps of repair() and the edits that they share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "check/check_parts.h"
#include "prep/repair.h"
#include "prep/topology.h"
#include "surface/edge_key.h"

namespace prep::detail {

// Calls visit(layer) for every corner layer of the mesh.
template <class Visit>
void for_each_layer(Mesh& mesh, const Visit& visit) {
    visit(mesh.normals);
    visit(mesh.tangents);
    for (auto& layer : mesh.uvs) visit(layer);
    for (auto& layer : mesh.colors) visit(layer);
}

// Removes the faces with keep[f] == 0, and the marks that name them.
void keep_faces(Mesh& mesh, const std::vector<std::uint8_t>& keep);

// Turns the faces with turn[f] != 0: their first corner stays first, the others run backwards.
// Authored normals that agreed with the old direction turn too.
void turn_faces(Mesh& mesh, const std::vector<std::uint8_t>& turn, const FaceNormals& faces);

// Keeps the corners `kept` (ascending, by their number before), all of whose faces stand in the
// new `face_offsets`.
void keep_corners(Mesh& mesh, const std::vector<std::uint32_t>& kept,
                  std::vector<std::uint32_t> face_offsets);

// Names the file's vertices where nothing was renumbered so far: of vertices, and of corners.
void number_file_vertices(Mesh& mesh);
void number_corner_file_vertices(Mesh& mesh);

// Appends a copy of a vertex, and keeps track of where it came from.
std::uint32_t copy_vertex(Mesh& mesh, std::uint32_t vertex);

// Edges that faces have in place of others: hard marks and creases of `from`, an edge by its
// points, become those of each `to`, by its vertices, and stay where a face that stays (`keep`, by
// face, or all) has an edge between these points still. `points`: by vertex, as Topology::welded.
struct ReplacedEdge {
    std::uint64_t from, to;
};
void move_marks(Mesh& mesh, std::vector<ReplacedEdge> replaced,
                const std::vector<std::uint32_t>& points,
                const std::vector<std::uint8_t>& keep = {});
// After copy_vertex(): marks, creases and sharp vertices are those of the copies as well. `origin`:
// by vertex what it is a copy of, else itself; `points` as before.
void mark_copies(Mesh& mesh, const std::vector<std::uint32_t>& origin,
                 std::vector<std::uint32_t> points);

// Which topology the steps see: exactly equal positions are one point.
Topology repair_topology(const Mesh& mesh, int threads);

// The part of the file that a vertex belongs to: parts of glTF that is written back are primitives,
// which share none. Others are names, which cut no vertex.
std::vector<std::uint32_t> parts_of_vertices(const Mesh& mesh);

// Whatever uses a vertex uses target[vertex] from now on.
void put_in_place(Mesh& mesh, const std::vector<std::uint32_t>& target);

RepairStep weld_vertices(Mesh& mesh, double tolerance, int threads);

// Whether joints move this vertex of the file.
inline bool has_weights(const Mesh& mesh, std::uint32_t file_vertex) {
    return std::any_of(
        mesh.skin_influences.begin(), mesh.skin_influences.end(),
        [&](const SkinInfluences& set) { return set.weights[file_vertex] != glm::vec4(0.0f); });
}

// By vertex the one that stands for its point: the first at its position, and of those that joints
// or morph targets move apart (lips, eyelids) the first that moves as it does; one without weights
// goes with the first that has some, which may come later. Beyond 16 ways to move at one position
// each vertex is a point of its own. `apart`: how many points that faces have are at the position
// of another.
struct MovingPoints {
    std::vector<std::uint32_t> first;
    std::uint64_t apart = 0;
};
MovingPoints moving_points(const Mesh& mesh, int threads);

// Vertices of one point and one part become one.
void weld_points(Mesh& mesh, const std::vector<std::uint32_t>& points);
// After it: vertices that several parts have at one point become one, for the surface of a cage
// goes on from part to part; each gets vertices of its own again when it is split. Where parts lie
// on each other (linings, decals), so that an edge would have more than two faces or a face would
// be there twice, their points stay apart: says how many. Positions and deltas of morph targets are
// those of the first part, skin weights those of the first that has any.
std::uint64_t join_parts(Mesh& mesh, const std::vector<std::uint32_t>& points);
RepairStep remove_degenerate_faces(Mesh& mesh, int threads);
RepairStep remove_duplicate_faces(Mesh& mesh, int threads);
RepairStep split_non_manifold_edges(Mesh& mesh, int threads);
RepairStep split_non_manifold_vertices(Mesh& mesh, int threads);
RepairStep unify_orientation(Mesh& mesh, int threads);
RepairStep turn_outward(Mesh& mesh, int threads);
RepairStep fill_holes(Mesh& mesh, std::uint32_t most_edges, int threads);
RepairStep remove_isolated_vertices(Mesh& mesh);

}  // namespace prep::detail
