#include "plan/frame_pass.h"

#include <algorithm>

namespace rast::detail {

void add_pass(RenderRequest& request, FramePass pass) {
    request.passes.push_back(std::make_shared<const FramePass>(std::move(pass)));
}

bool makes_normals(const RenderRequest& request) {
    return request.keep_normals ||
           std::any_of(request.passes.begin(), request.passes.end(),
                       [](const auto& pass) { return pass->reads_normals; });
}

std::uint32_t halo_of(const RenderRequest& request) {
    // Beyond the largest picture there is nothing more to see.
    std::uint32_t halo = 0;
    for (const auto& pass : request.passes)
        if (!pass->before)
            halo = std::min(halo + std::min(pass->radius, max_picture_extent), max_picture_extent);
    return halo;
}

}  // namespace rast::detail
