#include "frame/halo.h"

#include <algorithm>

#include "geometry/tile.h"
#include "passes/parallel_tiles.h"

namespace rast::detail {

Crop with_halo(const RenderPlan& plan, const Crop& part) {
    const auto widen = [&](std::uint32_t begin, std::uint32_t extent, std::uint32_t all,
                           std::uint32_t& from, std::uint32_t& count) {
        from = begin - std::min(begin, plan.halo);
        const std::uint32_t end = begin + extent;
        count = end + std::min(all - end, plan.halo) - from;
    };
    Crop drawn;
    widen(part.x, part.width, plan.request.width, drawn.x, drawn.width);
    widen(part.y, part.height, plan.request.height, drawn.y, drawn.height);
    return drawn;
}

RowRange rows_with_halo(const RenderPlan& plan, const Crop& part, const Crop& drawn,
                        std::uint32_t first, std::uint32_t rows) {
    constexpr auto tile = std::uint32_t(tile_size);
    const std::uint32_t begin = part.y - drawn.y + first, end = begin + rows;
    const std::uint32_t from = (begin - std::min(begin, plan.halo)) / tile * tile;
    const std::uint32_t to = end + std::min(drawn.height - end, plan.halo);
    return {from, std::min((to + tile - 1) / tile * tile, drawn.height) - from};
}

void cut_out(const Frame& drawn, std::uint32_t x, std::uint32_t y, const RenderRequest& asked,
             Frame& part) {
    const auto cut = [&](const auto& from, auto& to, bool kept) {
        to.clear();
        if (!kept || from.empty()) return;
        for (std::uint32_t row = y; row < y + part.height; ++row) {
            const auto begin = from.begin() + std::ptrdiff_t(std::size_t(row) * drawn.width + x);
            to.insert(to.end(), begin, begin + part.width);
        }
    };
    cut(drawn.color, part.color, asked.keep_color);
    cut(drawn.bytes, part.bytes, asked.keep_color);
    cut(drawn.depth, part.depth, asked.keep_depth);
    cut(drawn.triangle, part.triangle, asked.keep_ids);
    cut(drawn.instance, part.instance, asked.keep_ids);
    cut(drawn.normal, part.normal, asked.keep_normals);
    cut(drawn.uv, part.uv, asked.keep_uvs);
    cut(drawn.barycentric, part.barycentric, asked.keep_barycentrics);
    cut(drawn.position, part.position, asked.keep_positions);
    part.counters = drawn.counters;
    part.geometry_ms = drawn.geometry_ms;
    part.raster_ms = drawn.raster_ms;
    part.part_ms = drawn.part_ms;
}

void PassRunner::begin(const RenderPlan& plan) {
    plan_ = &plan;
    planes_.assign(plan.passes.size(), {});
    for (std::size_t p = 0; p < plan.passes.size(); ++p)
        if (plan.passes[p]->before) run(p, {}, nullptr);
}

void PassRunner::finish(const Crop& part, Frame& frame) {
    for (std::size_t p = 0; p < plan_->passes.size(); ++p)
        if (!plan_->passes[p]->before) run(p, part, &frame);
}

void PassRunner::run(std::size_t p, const Crop& part, Frame* frame) {
    const FramePass& pass = *plan_->passes[p];
    const std::size_t pixels = std::size_t(part.width) * part.height;
    planes_[p].resize(pass.planes);
    for (FramePlane& plane : planes_[p]) {
        plane.width = part.width;
        plane.height = part.height;
        plane.values.assign(pixels, 0.0f);
    }
    const FloatingPointMode mode;
    const PartTimer timer(plan_->request.timed ? &clock_ : nullptr, DrawingPart::passes);
    pass.run({scene_, *plan_, part, frame, planes_, p});
}

std::uint64_t PassRunner::plane_bytes() const {
    std::uint64_t bytes = 0;
    for (const auto& planes : planes_)
        for (const FramePlane& plane : planes) bytes += plane.values.size() * sizeof(float);
    return bytes;
}

}  // namespace rast::detail
