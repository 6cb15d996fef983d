// repair(): changes what check() finds, with consent and a log. Off by default; prepare() calls it
// first where PrepareOptions::repair asks for it.
//
// The steps run in the order of RepairOptions, each on what the one before left; a step that finds
// nothing to do changes no bit. Attributes follow their corners. Faces keep their order, new ones
// stand at the end; vertices keep their numbers, new ones stand at the end (unless isolated ones
// are removed).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "prep/findings.h"
#include "prep/mesh.h"
#include "prep/result.h"

namespace prep {

struct RepairOptions {
    // Vertices no farther than this from an earlier one that is kept become that one (greedy, by
    // vertex number); in the unit of the positions, 0: equal positions only.
    std::optional<double> weld_tolerance;
    // Corners that repeat their neighbour's point go; faces left with fewer than three points or
    // with an area of exactly zero go. A zero-area triangle whose middle vertex lies on the edge of
    // a neighbour gives the neighbour that vertex, so that no crack opens.
    bool degenerate_faces = false;
    // Later faces with the same points in the same direction as an earlier one go.
    bool duplicate_faces = false;
    // Faces at an edge of three or more are paired so that each solid wedge between them keeps its
    // two walls; each sheet gets vertices of its own.
    bool non_manifold_edges = false;
    // Surfaces that meet in a vertex alone get a vertex each.
    bool non_manifold_vertices = false;
    // Faces are turned to agree with their neighbours; in each component the fewer ones turn, at a
    // tie those that disagree with the first. Authored normals and tangents that agreed with a
    // turned face turn with it. One-sided surfaces (Möbius strips) keep a seam: `left`.
    bool orientation = false;
    // Holes of at most this many edges are filled with triangles of small dihedral angles, then of
    // small area, by Liepa's dynamic program (2003): each stretch of the loop keeps its best
    // triangulation alone, so that another of the whole may be better by some degrees. The fill has
    // the attributes of the rim; its normals are computed. 0: none.
    std::uint32_t hole_edges = 0;
    // Closed components of negative volume turn inside out, but for cavities (inside the box of an
    // outward one).
    bool outward = false;
    // Vertices that no face, line or point uses go.
    bool isolated_vertices = false;

    bool any() const {
        return weld_tolerance || degenerate_faces || duplicate_faces || non_manifold_edges ||
               non_manifold_vertices || orientation || outward || hole_edges > 0 ||
               isolated_vertices;
    }
};

// What a step did. `changed` counts vertices, faces, edges or holes as `text` says; places name the
// first ones by their number before the step.
struct RepairStep {
    std::string step;  // "weld", "degenerate", "duplicates", "edges", "vertices", "orientation",
                       // "holes", "outward", "isolated"
    std::uint32_t mesh = 0;     // into Scene::meshes
    std::uint64_t changed = 0;  // 0: looked for and not found, or left alone
    std::uint64_t left = 0;     // what could not be repaired
    PlaceKind place_kind = PlaceKind::face;
    std::vector<std::uint32_t> places;
    std::string text;  // one sentence; says also why something was left
};

// One entry for each step asked for. The mesh is left as it was on error. Errors: invalid
// (tolerance negative or not finite), limit (more than 2^32 − 2 vertices or corners).
// O(corners · log(corners)), holes of k edges O(k³).
Result<std::vector<RepairStep>> repair(Mesh& mesh, const RepairOptions& options,
                                       std::uint32_t mesh_index = 0, int threads = 0);

}  // namespace prep
