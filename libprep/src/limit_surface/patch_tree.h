// Which piece of the surface covers which part of a cage face.
//
// Every quad of the cage (triangle, in Loop's scheme), and each of an n-gon's n quads after one
// step, is a root. A node is
//   regular   a bicubic B-spline patch of 16 control points: each corner is surrounded by four
//             quads; at a border or an infinitely sharp crease the points beyond it are those that
//             give the crease's rule, P(−1) = 2 P(0) − P(1); a quartic box spline of 12 points in
//             Loop's scheme (loop_patch.h)
//   crease    the same beside one semi-sharp edge of quads, where the crease is regular and of one
//             sharpness: the bicubic patch of a cubic along it and of a crease point's scheme
//             across it (Nießner, Loop and Greiner 2012), crease_weights in bicubic.h
//   ring      one sector of the two rings of faces around one extraordinary vertex, where all other
//             vertices are regular and nothing is semi-sharp: refinement maps these rings to
//             themselves (extraordinary_ring.h)
//   linear    a bilinear quad, or a plane triangle
//   split     its four children, one level of the refined cage deeper
// Level 0 has these pieces already wherever extraordinary vertices are far enough apart. At level 1
// each face has but one vertex of an old vertex or an old face; so at level 2, where no sharpness
// is left, everything is regular or a ring.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "limit_surface/extraordinary_ring.h"
#include "limit_surface/refined_cage.h"

namespace prep::detail {

struct PatchNode : Piece {
    static constexpr std::uint32_t most = (1U << 29) - 1;
    std::uint32_t kind : 3 = none;
    std::uint32_t index : 29 = 0;  // into regular_patches, crease_patches or sectors
};

// controls[4 j + i]: all levels' vertices counted through; those beyond a sharp side are not set.
struct RegularPatch {
    std::array<std::uint32_t, 16> controls;
    std::uint8_t sharp_sides = 0;  // bit c: the edge from corner c to the next

    bool is_set(std::uint32_t k) const {
        const std::uint32_t i = k % 4, j = k / 4;
        return !((j == 0 && sharp_sides & 1) || (i == 3 && sharp_sides & 2) ||
                 (j == 3 && sharp_sides & 4) || (i == 0 && sharp_sides & 8));
    }
};

// A regular triangle of Loop's scheme: its 12 control points (loop_patch.h) as sums of vertices.
struct TrianglePatch {
    struct Term {
        std::uint32_t vertex;
        std::int8_t weight;
        std::uint8_t control;
    };
    std::vector<Term> terms;
};

struct CreasePatch {
    RegularPatch patch;
    std::uint32_t sharpness = 0;  // into PatchTree::sharpnesses
    std::uint8_t side = 0;        // the semi-sharp edge: from corner `side` to the next
};

struct RingSector {
    std::uint32_t ring = 0;
    std::uint16_t sector = 0;
    std::uint8_t corner = 0;  // of the face: where the extraordinary vertex is
};

struct Ring {
    RingShape shape;
    std::size_t first_point = 0;  // into PatchTree::ring_points, in the shape's order
};

struct PatchRoot {
    std::uint32_t cage_face = 0;
    std::uint16_t corner = 0;  // of an n-gon: which of its quads
    std::uint16_t level = 0;
    std::uint32_t face = 0;  // of that level
};

struct PatchTree {
    std::vector<PatchRoot> roots;               // in order of cage faces; those without surface too
    std::vector<std::uint32_t> face_roots;      // per cage face (+ 1): its first root
    std::vector<std::vector<PatchNode>> nodes;  // per level and face
    std::vector<RegularPatch> regular_patches;
    std::vector<TrianglePatch> triangle_patches;  // in place of regular_patches
    std::vector<CreasePatch> crease_patches;
    std::vector<float> sharpnesses;  // of crease patches, each once
    std::vector<RingSector> sectors;
    std::vector<Ring> rings;
    std::vector<std::uint32_t> ring_points;

    bool is_regular(std::uint32_t root) const {
        return nodes[roots[root].level][roots[root].face].kind == PatchNode::regular;
    }
    // The control points of a regular patch that are vertices.
    template <class Body>
    void for_regular_controls(std::uint32_t patch, const Body& body) const {
        if (!triangle_patches.empty()) {
            for (const TrianglePatch::Term& term : triangle_patches[patch].terms) body(term.vertex);
            return;
        }
        const RegularPatch& regular = regular_patches[patch];
        for (std::uint32_t k = 0; k < 16; ++k)
            if (regular.is_set(k)) body(regular.controls[k]);
    }
    // Errors: a cage face of which a part is no piece and has no children (unsupported); more
    // pieces than `most_pieces`, at most PatchNode::most (limit). tree_builder.cpp.
    static Result<PatchTree> make(const RefinedCage& cage,
                                  std::uint32_t most_pieces = PatchNode::most);
};

// A triangle within a root's parameters: its first corner at (x, y), a step along its first edge
// (ax, ay), along its last one (bx, by). Steps are those of the lattice: their determinant is 1.
template <class T>
struct LatticeFrame {
    T x, y, ax, ay, bx, by;

    // `n`: steps of a side.
    LatticeFrame at_corner(std::uint32_t c, T n) const {
        if (c == 0) return *this;
        if (c == 1) return {x + n * ax, y + n * ay, bx - ax, by - ay, -ax, -ay};
        return {x + n * bx, y + n * by, -bx, -by, ax - bx, ay - by};
    }
    LatticeFrame moved(T a, T b) const {
        return {x + a * ax + b * bx, y + a * ay + b * by, ax, ay, bx, by};
    }
    LatticeFrame inverted() const { return {x, y, -ax, -ay, -bx, -by}; }
};

// Child c of a split face, the children from `first` on in `cage.levels[level]`, by the frame of
// the face and half the steps of its side. The middle one's is that of its own first corner.
template <class T>
LatticeFrame<T> child_frame(const RefinedCage& cage, std::uint32_t level, std::uint32_t first,
                            std::uint32_t c, const LatticeFrame<T>& frame, T half) {
    if (c < 3) return frame.moved(c == 1 ? half : T(0), c == 2 ? half : T(0));
    const auto& vertices = cage.levels[level].corner_vertices;
    // Where the middle one's third corner is: the one at the middle of the face's second edge.
    const std::uint32_t opposite = vertices[3 * (first + 1) + 2];
    std::uint32_t corner = 0;
    while (corner < 2 && vertices[3 * (first + 3) + corner] != opposite) ++corner;
    return frame.moved(half, half).inverted().at_corner((3 - corner) % 3, half);
}

}  // namespace prep::detail
