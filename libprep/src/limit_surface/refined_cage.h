// A cage refined where its surface is not made of ready pieces yet: once around extraordinary
// vertices that are neighbours, twice at n-gons, along semi-sharp edges until their sharpness is
// used up.
//
// OpenSubdiv's Far::TopologyRefiner refines (sharpness, Chaikin's averages, borders, non-manifold
// vertices: all its rules); its levels are copied into plain half-edges, which everything else
// reads. Only its topology and its refinement are used, none of its patches: Debian's 3.5.0 builds
// wrong ones where an irregular patch overlaps itself (OpenSubdiv issue 1301).
//
// Half-edge h of a refined level is corner h % K of face h / K, K corners to a face, and runs to
// the next corner. Level 0 has polygons: its half-edges are the cage's corners.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "limit_surface/surface_cage.h"

namespace prep::detail {

struct VertexFlags {
    enum : std::uint8_t {
        semi_sharp = 1,   // it or an edge at it: rules still change from level to level
        simple = 2,       // inside, smooth, regular valence, regular faces all around
        corner_rule = 4,  // infinitely sharp: it stays where it is
        border = 8,
        dart_rule = 16,
        own_sharpness = 32,  // of the vertex, not of its edges
    };
};

struct RefinedLevel {
    std::vector<std::uint32_t> face_offsets;     // level 0 only
    std::vector<std::uint32_t> corner_vertices;  // of this level, from 0
    std::vector<std::uint32_t> opposite;  // per half-edge: that of its only other face, or no_index
    std::vector<std::uint8_t> sharp;      // per half-edge: infinitely sharp, borders too
    // Per half-edge, 10 where infinite; empty where no edge of the level is semi-sharp.
    std::vector<float> sharpness;
    std::vector<std::uint32_t> edges;  // level 0 only: per half-edge its edge
    std::vector<std::uint8_t> vertex_flags;
    // Per face: the first of its children, which follow each other, or no_index where not all are
    // there. Child c is at corner c; those of faces that are not n-gons keep the corners' order.
    std::vector<std::uint32_t> first_child;
    std::uint32_t first_vertex = 0;  // of all levels' vertices, counted through
    std::uint32_t vertex_count = 0;

    std::uint32_t first_corner(std::uint32_t face, std::uint32_t corners_per_face) const {
        return face_offsets.empty() ? corners_per_face * face : face_offsets[face];
    }
};

// Values of refined vertices: `width` numbers each, those of level 0 first.
class RefinedValues {
  public:
    std::uint32_t width = 0;
    std::vector<double> numbers;
    const double* of(std::uint32_t vertex) const {
        return numbers.data() + std::size_t(vertex) * width;
    }
};

// What piece of the surface a face is; patch_tree.h says what they are.
struct Piece {
    enum Kind : std::uint8_t { none, split, regular, crease, ring, linear };
};
struct PieceKind {
    Piece::Kind kind = Piece::none;  // none: it has to be cut
    std::uint8_t corner = 0;  // ring: where the extraordinary vertex is; crease: where it begins
};

// A sparse sum of named things (joints, cage vertices), by name.
struct SparseValue {
    std::vector<std::pair<std::uint32_t, double>> terms;  // ascending by name
};

class RefinedCage {
  public:
    // Adaptively, as above. Errors: the refiner does not take the topology (invalid), semi-sharp
    // creases would be cut into too many faces (limit). A channel that is refined as such is then
    // taken for a cage of its own.
    static Result<RefinedCage> make(const SurfaceCage& cage);
    RefinedCage();
    RefinedCage(RefinedCage&&) noexcept;
    RefinedCage& operator=(RefinedCage&&) noexcept;
    ~RefinedCage();

    std::vector<RefinedLevel> levels;
    std::vector<PieceKind> base_kinds;   // per face of level 0: scheme_pieces.h
    std::uint32_t corners_per_face = 4;  // of refined faces
    bool linear = false;
    bool approximate_seams = false;         // a channel taken for a cage of its own
    std::uint32_t edge_count = 0;           // of the cage
    std::vector<std::uint8_t> has_surface;  // per cage face

    std::uint32_t total_vertices() const;
    // Refines values of the cage's vertices (`width` numbers each) by the rules for vertices.
    RefinedValues refine(std::span<const double> cage_values, std::uint32_t width) const;
    std::vector<SparseValue> refine(std::vector<SparseValue> cage_values) const;
    // The sharpness that the refiner gives a vertex or an edge of the cage: infinite at
    // non-manifold ones, and where a border rule makes it so.
    float vertex_sharpness(std::uint32_t vertex) const;
    float edge_sharpness(std::uint32_t half_edge) const;
    bool is_manifold(std::uint32_t vertex) const;
    // The corners at a vertex of the cage, in the refiner's order (around it, where it is
    // manifold).
    void corners_around(std::uint32_t vertex, std::vector<std::uint32_t>& corners) const;
    // Gives back what only refine() and the sharpness need.
    void forget_rules();

  private:
    struct Rules;
    std::unique_ptr<Rules> rules_;
};

}  // namespace prep::detail
