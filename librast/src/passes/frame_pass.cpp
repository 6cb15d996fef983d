#include "passes/frame_pass.h"

#include <algorithm>

namespace rast::detail {

// What a pass makes of pixels in the halo is right only as far from its end as it looks: radii of
// passes that follow each other add up.
void add_pass(RenderPlan& plan, FramePass pass) {
    // Beyond the largest picture there is nothing more to see.
    const std::uint32_t radius = pass.before ? 0 : std::min(pass.radius, max_picture_extent);
    plan.halo = std::min(plan.halo + radius, max_picture_extent);
    plan.passes.push_back(std::make_shared<const FramePass>(std::move(pass)));
}

}  // namespace rast::detail
