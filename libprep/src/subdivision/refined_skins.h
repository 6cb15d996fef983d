// Skin weights of a subdivided mesh: the limit (or refined) sums of the cage's, joint by joint.
//
// A cage vertex' weights are a sparse sum over joints; refined vertices have sparse sums of those.
// For each root the joints that reach it become a small dense channel, which is evaluated like any
// other.
#pragma once

#include <utility>

#include "subdivision/uniform_refinement.h"

namespace prep::detail {

struct RefinedSkins {
    std::vector<SkinInfluences> sets;  // by output vertex
    float largest_dropped = 0;         // share of a vertex' sum
};

// Gives `vertex` of the sets the largest `most` of its influences (weight, joint), scaled so that
// they add up to `sum`; `influences` is left sorted and cut. The share of the sum that is dropped.
float keep_largest(std::vector<std::pair<double, std::uint32_t>>& influences, double sum,
                   std::size_t most, std::vector<SkinInfluences>& sets, std::size_t vertex);

RefinedSkins refined_skins(const UniformRefinement& refinement, const ChannelSurface& surface,
                           const GridNumbering& numbering);

}  // namespace prep::detail
