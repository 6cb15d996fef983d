// The pieces of a limit surface over a part of a root's parameters (limit_surface/patch_tree.h), as
// Bézier patches: of a Catmull–Clark (or bilinear) surface over a box, cut to it; of Loop's scheme
// over a triangle (triangle_pieces.cpp).
//
// The parameters of a triangle's root are three quarters of its own, (0, 0), (3/4, 0), (0, 3/4): so
// its centre and all that bisections make are multiples of powers of two.
//
// Around an extraordinary vertex there are three patches a level, for ever. A part that has the
// vertex gets those of `tip_levels` levels, as far as evaluation goes, and what is left as a tip:
// the vertex' two rings at the level after, in whose hull the surface lies (each level's points are
// convex combinations of the last one's).
#pragma once

#include <vector>

#include "limit_surface/channel_surface.h"
#include "tessellation/limit/bezier_patch.h"
#include "tessellation/limit/quartic_patch.h"

namespace prep::detail {

struct LimitTip {
    std::uint32_t ring = 0, sector = 0;
    int level = 0;
    ParameterBox box;  // of the root's parameters
    std::vector<glm::dvec3> hull;
};
inline constexpr int tip_levels = 8;

struct LimitPieces {
    std::vector<BezierPatch> patches;
    std::vector<QuarticPatch> quartics;  // in their place in Loop's scheme
    std::vector<LimitTip> tips;

    void clear() {
        patches.clear();
        quartics.clear();
        tips.clear();
    }
    template <class Body>
    void for_each_patch(const Body& body) const {
        for (const BezierPatch& patch : patches) body(patch);
        for (const QuarticPatch& patch : quartics) body(patch);
    }
};
inline constexpr double triangle_root_side = 0.75;

// Of tree root `root`. A box without area gets what is on one of its sides.
void collect_pieces(const ChannelSurface& surface, std::uint32_t root, const ParameterBox& box,
                    LimitPieces& pieces);

// Of a triangle root; patches get these axes. A patch is over the triangle asked for where that is
// the smaller one, and as a polynomial reaches beyond its own; else whole.
void collect_pieces(const ChannelSurface& surface, std::uint32_t root,
                    const ParameterTriangle& triangle, const ParameterAxes& axes,
                    LimitPieces& pieces);

// Levels of a sector's ring in turn: those that are stored, then refined ones; as far as a part of
// the sector needs them.
class RingWalk {
  public:
    RingWalk(const ChannelSurface& surface, const RingSector& sector)
        : surface_(surface), sector_(sector), last_(ring().shape.deepest_level()) {}
    const Ring& ring() const { return surface_.tree.rings[sector_.ring]; }
    glm::dvec3 centre() const { return vector_at(surface_.rings.centre(sector_.ring)); }

    struct Level {
        const double *rings, *next;
    };
    Level level(int k) {
        const int stored = surface_.rings.stored_levels();
        const auto at = [&](int l) { return surface_.rings.level(surface_.tree, sector_.ring, l); };
        if (k < stored) return {at(k), at(k + 1)};
        if (!walks_) walked_.start(ring(), 3, at(stored));
        walks_ = true;
        const double* const rings = walked_.level(k - stored);
        return {rings, walked_.after()};
    }
    // Whether what is left at level k stays as a tip; `has_all`: the part has all of it. Asked of
    // each level.
    bool is_last(int k, bool has_all) {
        if (has_all && !has_tip_) last_ = std::min(last_, k + tip_levels);
        has_tip_ = has_tip_ || has_all;
        return k == last_;
    }
    LimitTip tip(int k, const Level& level, const ParameterBox& box) const {
        LimitTip left{sector_.ring, sector_.sector, k, box, {}};
        for (std::size_t p = 0; p < ring().shape.point_count(); ++p)
            left.hull.push_back(centre() + vector_at(level.rings + 3 * p));
        return left;
    }

  private:
    const ChannelSurface& surface_;
    RingSector sector_;
    int last_;
    RingLevels walked_;
    bool walks_ = false, has_tip_ = false;
};

}  // namespace prep::detail
