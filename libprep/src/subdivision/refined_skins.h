// Skin weights of a subdivided mesh: the limit (or refined) sums of the cage's, joint by joint.
//
// A cage vertex' weights are a sparse sum over joints; refined vertices have sparse sums of those.
// For each root the joints that reach it become a small dense channel, which is evaluated like any
// other; roots around a vertex of many faces have one channel together. So the cost of a pole is
// that of its points, each with the joints that reach it, not the square of its valence.
#pragma once

#include <utility>

#include "subdivision/uniform_refinement.h"

namespace prep::detail {

struct RefinedSkins {
    std::vector<SkinInfluences> sets;  // by output vertex
    float largest_dropped = 0;         // share of a vertex' sum
    std::uint64_t gathered = 0;  // control points whose weights were copied, or refined in rings
};

// Roots whose weights are gathered together: those that share a ring of many sectors, so that its
// points are not gathered and refined for each of them again; others alone. Large groups first.
struct RootGroups {
    std::vector<std::uint32_t> roots, offsets{0};
    // Groups that one thread works on: of few roots in all, or one group.
    std::vector<std::uint32_t> blocks{0};

    RootGroups(const ChannelSurface& surface, const std::vector<std::uint32_t>& kept);
    std::size_t count() const { return offsets.size() - 1; }
    std::span<const std::uint32_t> operator[](std::size_t group) const {
        return std::span(roots).subspan(offsets[group], offsets[group + 1] - offsets[group]);
    }
};

// Gives `vertex` of the sets the largest `most` of its influences (weight, joint), scaled so that
// they add up to `sum`; `influences` is left sorted and cut. The share of the sum that is dropped.
float keep_largest(std::vector<std::pair<double, std::uint32_t>>& influences, double sum,
                   std::size_t most, std::vector<SkinInfluences>& sets, std::size_t vertex);

RefinedSkins refined_skins(const UniformRefinement& refinement, const ChannelSurface& surface,
                           const GridNumbering& numbering);

}  // namespace prep::detail
