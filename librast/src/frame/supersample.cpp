#include "frame/supersample.h"

#include "base/parallel.h"

namespace rast::detail {

RenderPlan finer_plan(const RenderPlan& plan) {
    RenderPlan fine = plan;
    RenderRequest& r = fine.request;
    const auto factor = std::uint32_t(r.supersample);
    r.width *= factor;
    r.height *= factor;
    r.supersample = 1;
    r.crop.reset();
    r.keep_depth = r.keep_ids = r.keep_normals = r.keep_uvs = false;
    r.keep_barycentrics = r.keep_positions = false;
    return fine;
}

void reduce(const glm::vec4* fine, std::uint32_t factor, std::uint32_t first_row,
            std::uint32_t rows, int threads, Frame& coarse) {
    const std::size_t width = std::size_t(coarse.width) * factor;
    const double count = double(factor) * factor;
    prep::detail::parallel_blocks(rows, 1, threads, [&](std::size_t y, std::size_t) {
        for (std::uint32_t x = 0; x < coarse.width; ++x) {
            glm::dvec4 sum(0.0);
            for (std::uint32_t j = 0; j < factor; ++j)
                for (std::uint32_t i = 0; i < factor; ++i)
                    sum += glm::dvec4(fine[(y * factor + j) * width + std::size_t(x) * factor + i]);
            coarse.color[(first_row + y) * coarse.width + x] = glm::vec4(sum / count);
        }
    });
}

}  // namespace rast::detail
