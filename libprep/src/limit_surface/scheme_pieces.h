// What the schemes differ in when a cage is cut into pieces (tree_builder.cpp), and which faces are
// pieces as they are.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "limit_surface/level_faces.h"
#include "limit_surface/patch_tree.h"

namespace prep::detail {

// Catmull–Clark's scheme: quads.
struct QuadPieces {
    static constexpr std::uint32_t corners = 4;
    // Faces around a regular vertex: inside, at a border or a crease.
    static constexpr std::uint32_t inner_valence = 4, border_valence = 2;

    static std::vector<RegularPatch>& patches(PatchTree& tree) { return tree.regular_patches; }
    static RegularPatch patch(const LevelFaces& faces, std::uint32_t face);
    // The one semi-sharp edge of a face, where its crease goes on alike over both ends and all
    // around is regular.
    static std::optional<std::uint8_t> crease_side(const LevelFaces& faces, std::uint32_t face);
    // Whether all that a ring needs beyond the face of corner h is there. Beside n-gons of one step
    // the faces' outer edges may still be sharp.
    static bool is_surrounded(const LevelFaces& faces, std::uint32_t h);
    // The ring's points of sector j, whose face has the vertex at corner h.
    static void ring_points(const LevelFaces& faces, const RingShape& shape, std::uint32_t j,
                            std::uint32_t h, std::uint32_t* points);
};

// Loop's scheme: triangles.
struct TrianglePieces {
    static constexpr std::uint32_t corners = 3;
    static constexpr std::uint32_t inner_valence = 6, border_valence = 3;

    static std::vector<TrianglePatch>& patches(PatchTree& tree) { return tree.triangle_patches; }
    // Control points beyond a border or a crease are those that give the crease's rule (P + Q − R
    // over an edge P – Q with apex R).
    static TrianglePatch patch(const LevelFaces& faces, std::uint32_t face);
    static bool is_surrounded(const LevelFaces& faces, std::uint32_t h);
    static void ring_points(const LevelFaces& faces, const RingShape& shape, std::uint32_t j,
                            std::uint32_t h, std::uint32_t* points);
};

// Which faces of a level are pieces (patch_tree.h lists them), and which have to be cut.
template <class Pieces>
class PieceKinds {
  public:
    // `faces` stays where it is.
    PieceKinds(const LevelFaces& faces, bool linear) : faces_(faces), linear_(linear) {}

    PieceKind of(std::uint32_t face) {
        if (faces_.size(face) != Pieces::corners) return {};
        if (linear_) return {Piece::linear, 0};
        const std::uint32_t begin = faces_.begin(face);
        std::uint32_t irregular = 0, corner = 0;
        for (std::uint32_t c = 0; c < Pieces::corners; ++c) {
            if (faces_.flags(begin + c) & VertexFlags::semi_sharp) return crease(face);
            if (!is_regular(begin + c)) ++irregular, corner = c;
        }
        if (irregular == 0) return {Piece::regular, 0};
        if (irregular > 1 || !is_settled(begin + corner)) return {};
        return {Piece::ring, std::uint8_t(corner)};
    }

  private:
    PieceKind crease([[maybe_unused]] std::uint32_t face) {
        if constexpr (Pieces::corners == 4) {
            if (const std::optional<std::uint8_t> side = Pieces::crease_side(faces_, face))
                return {Piece::crease, *side};
        }
        return {};
    }

    bool is_regular(std::uint32_t h) {
        const std::uint8_t flags = faces_.flags(h);
        if (flags & VertexFlags::simple) return true;
        faces_.fan(h, fan_);
        for (const std::uint32_t corner : fan_.corners)
            if (faces_.size(faces_.face(corner)) != Pieces::corners) return false;
        const bool sharp = flags & VertexFlags::corner_rule;
        if (fan_.closed)
            return !sharp && !fan_.sharp_edge && fan_.corners.size() == Pieces::inner_valence;
        return fan_.corners.size() == (sharp ? 1 : Pieces::border_valence);
    }

    // Whether the rings of faces around corner h are what refinement maps to itself; once for all
    // its faces.
    bool is_settled(std::uint32_t h) {
        if (settled_.empty()) settled_.assign(faces_.level().corner_vertices.size(), unknown);
        if (settled_[h] == unknown) {
            faces_.fan(h, ring_);
            const std::uint8_t found = rings_are_whole(h) ? yes : no;
            for (const std::uint32_t corner : ring_.corners) settled_[corner] = found;
        }
        return settled_[h] == yes;
    }
    bool rings_are_whole(std::uint32_t corner) {
        if (faces_.flags(corner) & VertexFlags::semi_sharp) return false;
        if (ring_.corners.size() < (ring_.closed ? 2U : 1U)) return false;
        for (const std::uint32_t h : ring_.corners) {
            if (faces_.size(faces_.face(h)) != Pieces::corners) return false;
            for (std::uint32_t k = faces_.next(h); k != h; k = faces_.next(k))
                if (faces_.flags(k) & VertexFlags::semi_sharp || !is_regular(k)) return false;
            if (!Pieces::is_surrounded(faces_, h)) return false;
        }
        return true;
    }

    enum : std::uint8_t { unknown, yes, no };
    const LevelFaces& faces_;
    bool linear_;
    Fan fan_, ring_;
    std::vector<std::uint8_t> settled_;  // per half-edge that leaves an irregular vertex
};

}  // namespace prep::detail
