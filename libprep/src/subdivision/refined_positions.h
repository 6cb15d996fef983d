// Positions, morph targets and limit normals of a subdivided mesh.
#pragma once

#include "subdivision/uniform_refinement.h"

namespace prep::detail {

struct RefinedPositions {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> corner_vertices;
    CornerLayer<glm::vec3> normals;
    std::uint64_t fallback_normals = 0;
};

// Per target that has deltas of positions: its index, and a delta for each cage vertex.
struct TargetDeltas {
    std::vector<std::size_t> targets;
    std::vector<std::vector<glm::vec3>> deltas;
};
TargetDeltas target_deltas(const Mesh& mesh);

RefinedPositions refined_positions(const UniformRefinement& refinement,
                                   const ChannelSurface& surface, const GridNumbering& numbering);

// By target and output vertex: the rules are linear, so targets are refined as positions are. A few
// targets at a time: of a level 10, a block's memory for one is 25 MB.
std::vector<std::vector<glm::vec3>> refined_targets(const UniformRefinement& refinement,
                                                    const ChannelSurface& surface,
                                                    const GridNumbering& numbering,
                                                    const TargetDeltas& targets);

}  // namespace prep::detail
