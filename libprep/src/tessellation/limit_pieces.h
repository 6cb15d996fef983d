// The pieces of a Catmull–Clark (or bilinear) limit surface over a box of a root's parameters
// (limit_surface/patch_tree.h), as Bézier patches cut to the box.
//
// Around an extraordinary vertex there are three patches a level, for ever. A box that has the
// vertex gets those of `tip_levels` levels, and what is left as a tip: the vertex' two rings at
// the level after, in whose hull the surface lies (each level's points are convex combinations of
// the last one's).
#pragma once

#include <vector>

#include "limit_surface/channel_surface.h"
#include "tessellation/bezier_patch.h"

namespace prep::detail {

struct LimitTip {
    std::uint32_t ring = 0, sector = 0;
    int level = 0;
    ParameterBox box;  // of the root's parameters
    std::vector<glm::dvec3> hull;
};

struct LimitPieces {
    std::vector<BezierPatch> patches;
    std::vector<LimitTip> tips;
};
inline constexpr int tip_levels = 8;

// Of tree root `root`. A box without area gets what is on one of its sides.
void collect_pieces(const ChannelSurface& surface, std::uint32_t root, const ParameterBox& box,
                    LimitPieces& pieces);

// The three patches of level k of a ring's sector, over (a, b) of the sector's face from 0 to 1,
// relative to the ring's centre. `rings` and `next` are levels k and k + 1.
std::array<BezierPatch, 3> ring_level_patches(const RingShape& shape, const double* rings,
                                              const double* next, std::uint32_t sector, int k);

}  // namespace prep::detail
