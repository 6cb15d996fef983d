#include "passes/frame_pass.h"

#include <algorithm>

#include "plan/memory_estimate.h"

namespace rast::detail {
namespace {

PassMemory memory_of(const RenderPlan& plan) {
    PassMemory sum;
    for (const auto& pass : plan.passes) {
        sum.any = true;
        sum.depth |= pass->reads_depth;
        sum.normals |= pass->reads_normals;
        sum.positions |= pass->reads_positions;
        if (pass->before)
            sum.bytes += pass->bytes;
        else
            sum.planes += pass->planes;
    }
    return sum;
}

}  // namespace

// What a pass makes of pixels in the halo is right only as far from its end as it looks: radii of
// passes that follow each other add up.
void add_pass(RenderPlan& plan, FramePass pass) {
    // Beyond the largest picture there is nothing more to see.
    const std::uint32_t radius = pass.before ? 0 : std::min(pass.radius, max_picture_extent);
    plan.halo = std::min(plan.halo + radius, max_picture_extent);
    plan.passes.push_back(std::make_shared<const FramePass>(std::move(pass)));
    estimate_memory(plan, memory_of(plan));
}

}  // namespace rast::detail
