#include "plan/frame_pass.h"

#include <algorithm>

namespace rast::detail {

void add_pass(RenderRequest& request, FramePass pass) {
    request.passes.push_back(std::make_shared<const FramePass>(std::move(pass)));
}

bool passes_read_normals(const RenderPlan& plan) {
    return std::any_of(plan.passes.begin(), plan.passes.end(),
                       [](const auto& pass) { return pass->reads_normals; });
}

std::uint32_t halo_of(const RenderPlan& plan) {
    // Beyond the largest picture there is nothing more to see.
    std::uint32_t halo = 0;
    for (const auto& pass : plan.passes)
        if (!pass->before)
            halo = std::min(halo + std::min(pass->radius, max_picture_extent), max_picture_extent);
    return halo;
}

}  // namespace rast::detail
