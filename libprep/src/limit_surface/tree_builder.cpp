#include <fmt/format.h>

#include <unordered_map>

#include "limit_surface/scheme_pieces.h"

namespace prep::detail {
namespace {

template <class Pieces>
class TreeBuilder {
  public:
    TreeBuilder(const RefinedCage& cage, std::uint32_t most_pieces)
        : cage_(cage), most_pieces_(most_pieces) {
        faces_.reserve(cage.levels.size());  // kinds refer to them
        for (const RefinedLevel& level : cage.levels) {
            faces_.emplace_back(level, Pieces::corners);
            kinds_.emplace_back(faces_.back(), cage.linear);
            tree_.nodes.emplace_back(level.first_child.size());
        }
        sectors_.resize(cage.levels.size());
        std::size_t regular = 0;
        for (const PieceKind& found : cage.base_kinds) regular += found.kind == Piece::regular;
        Pieces::patches(tree_).reserve(std::min<std::size_t>(regular, most_pieces));
    }

    Result<PatchTree> build() {
        const RefinedLevel& base = cage_.levels[0];
        const std::uint32_t faces = std::uint32_t(base.face_offsets.size() - 1);
        tree_.face_roots.push_back(0);
        for (std::uint32_t f = 0; f < faces; ++f) {
            const std::uint32_t size = base.face_offsets[f + 1] - base.face_offsets[f];
            const bool whole = size == Pieces::corners;
            const std::uint32_t first = whole ? f : base.first_child[f];
            for (std::uint32_t c = 0; c < (whole ? 1 : size); ++c) {
                PatchRoot root{f, std::uint16_t(c), std::uint16_t(whole ? 0 : 1), 0};
                if (first != no_index) root.face = first + c;
                const bool built = !cage_.has_surface[f] ||
                                   (first != no_index && build_node(root.level, root.face));
                if (!built)
                    return Error{
                        ErrorCode::unsupported,
                        fmt::format("the surface of face {} cannot be told from its neighbours: "
                                    "check the mesh (inspect)",
                                    f),
                        fmt::format("face {}", f)};
                tree_.roots.push_back(root);
            }
            tree_.face_roots.push_back(std::uint32_t(tree_.roots.size()));
        }
        if (piece_count_ > most_pieces_)
            return Error{ErrorCode::limit,
                         fmt::format("the limit surface has {} pieces; the limit is {}: subdivide "
                                     "parts of the mesh on their own, or use fewer creases",
                                     piece_count_, most_pieces_),
                         ""};
        return std::move(tree_);
    }

  private:
    // False where a face is neither a piece nor made of children.
    bool build_node(std::uint32_t level, std::uint32_t face) {
        PatchNode node = piece(level, face);
        if (node.kind == PatchNode::none) {
            const std::uint32_t first = cage_.levels[level].first_child[face];
            if (first == no_index) return false;
            node.kind = PatchNode::split;
            for (std::uint32_t c = 0; c < 4; ++c)
                if (!build_node(level + 1, first + c)) return false;
        }
        tree_.nodes[level][face] = node;
        return true;
    }

    PatchNode piece(std::uint32_t level, std::uint32_t face) {
        const LevelFaces& faces = faces_[level];
        const PieceKind found = level == 0 ? cage_.base_kinds[face] : kinds_[level].of(face);
        switch (found.kind) {
            case Piece::regular:
                return added(found.kind, Pieces::patches(tree_),
                             [&] { return Pieces::patch(faces, face); });
            case Piece::crease:
                return crease(faces, face, found.corner);
            case Piece::ring:
                return added(found.kind, tree_.sectors, [&] {
                    const RingSector at = sector(level, faces.begin(face) + found.corner);
                    return RingSector{at.ring, at.sector, found.corner};
                });
            default:
                return node_of(found.kind, 0);
        }
    }

    PatchNode crease([[maybe_unused]] const LevelFaces& faces, [[maybe_unused]] std::uint32_t face,
                     [[maybe_unused]] std::uint8_t side) {
        if constexpr (Pieces::corners == 4)
            return added(Piece::crease, tree_.crease_patches, [&] {
                const float sharpness = faces.level().sharpness[faces.begin(face) + side];
                const auto next = std::uint32_t(tree_.sharpnesses.size());
                const auto [number, is_new] = sharpness_numbers_.try_emplace(sharpness, next);
                if (is_new) tree_.sharpnesses.push_back(sharpness);
                return CreasePatch{Pieces::patch(faces, face), number->second, side};
            });
        return {};
    }

    static PatchNode node_of(PatchNode::Kind kind, std::size_t index) {
        PatchNode node;
        node.kind = kind & 7U;
        node.index = std::uint32_t(index) & PatchNode::most;
        return node;
    }

    // Beyond the limit pieces are only counted.
    template <class Piece, class Make>
    PatchNode added(PatchNode::Kind kind, std::vector<Piece>& pieces, const Make& make) {
        if (++piece_count_ > most_pieces_) return node_of(kind, 0);
        pieces.push_back(make());
        return node_of(kind, pieces.size() - 1);
    }

    // The sector of corner h of a ring that is settled (scheme_pieces.h).
    RingSector sector(std::uint32_t level, std::uint32_t h) {
        std::vector<RingSector>& known = sectors_[level];
        if (known.empty()) known.assign(faces_[level].level().corner_vertices.size(), no_sector);
        if (known[h].ring == no_index) add_ring(faces_[level], h, known);
        return known[h];
    }

    void add_ring(const LevelFaces& faces, std::uint32_t corner, std::vector<RingSector>& known) {
        faces.fan(corner, fan_);
        Ring ring;
        ring.shape = {std::uint16_t(fan_.corners.size()), fan_.closed, fan_.sharp_edge,
                      (faces.flags(corner) & VertexFlags::corner_rule) != 0, Pieces::corners == 3};
        ring.first_point = tree_.ring_points.size();
        tree_.ring_points.resize(ring.first_point + ring.shape.point_count());
        std::uint32_t* const points = tree_.ring_points.data() + ring.first_point;
        points[0] = faces.control(corner);
        for (std::uint32_t j = 0; j < ring.shape.sectors; ++j) {
            Pieces::ring_points(faces, ring.shape, j, fan_.corners[j], points);
            known[fan_.corners[j]] = {std::uint32_t(tree_.rings.size()), std::uint16_t(j), 0};
        }
        tree_.rings.push_back(ring);
    }

    const RefinedCage& cage_;
    std::uint64_t most_pieces_, piece_count_ = 0;
    PatchTree tree_;
    static constexpr RingSector no_sector{no_index, 0, 0};
    std::vector<LevelFaces> faces_;
    std::vector<PieceKinds<Pieces>> kinds_;
    std::vector<std::vector<RingSector>> sectors_;  // per level and half-edge, where there are any
    Fan fan_;
    std::unordered_map<float, std::uint32_t> sharpness_numbers_;
};

}  // namespace

Result<PatchTree> PatchTree::make(const RefinedCage& cage, std::uint32_t most_pieces) {
    if (cage.corners_per_face == 3) return TreeBuilder<TrianglePieces>(cage, most_pieces).build();
    return TreeBuilder<QuadPieces>(cage, most_pieces).build();
}

}  // namespace prep::detail
