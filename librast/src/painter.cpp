#include "painter.h"

#include <algorithm>

#include "supersample.h"

namespace rast::detail {
namespace {

bool keeps_buffers(const RenderRequest& r) {
    return r.keep_depth || r.keep_ids || r.keep_normals || r.keep_uvs || r.keep_barycentrics ||
           r.keep_positions;
}

void to_bytes(const Kernels& kernels, Frame& frame) {
    frame.bytes.resize(frame.color.size());
    for (std::size_t i = 0; i < frame.color.size(); ++i) {
        const glm::vec4& c = frame.color[i];
        std::uint32_t rgb = 0;
        kernels.pack(&c.x, &c.y, &c.z, 1, &rgb);
        const float covered = std::clamp(c.w, 0.0f, 1.0f);
        frame.bytes[i] = (rgb & 0x00ffffffu) | std::uint32_t(covered * 255.0f + 0.5f) << 24;
    }
    frame.color.clear();
}

}  // namespace

void Painter::begin(const RenderPlan& plan) {
    plan_ = &plan;
    const RenderRequest& r = plan.request;
    draws_fine_ = r.supersample > 1 && r.keep_color;
    draws_plain_ = !draws_fine_ || keeps_buffers(r);
    if (draws_plain_) {
        plain_plan_ = plan;
        // The finer picture's colours take their place.
        if (draws_fine_) plain_plan_.request.keep_color = false;
        if (r.coverage == Coverage::area || draws_fine_)
            plain_plan_.request.pixels = PixelFormat::floats;
        plain_.begin(plain_plan_);
    }
    if (draws_fine_) {
        fine_plan_ = finer_plan(plan);
        fine_plan_.request.pixels = PixelFormat::floats;
        fine_.begin(fine_plan_);
    }
}

void Painter::draw(const Crop& part, Frame& frame) {
    draw_floats(part, frame);
    if (plan_->request.pixels == PixelFormat::bytes && frame.bytes.empty())
        to_bytes(kernels_for(plan_->request.simd), frame);
    frame.counters.buffer_bytes = buffer_bytes(frame);
}

void Painter::draw_floats(const Crop& part, Frame& frame) {
    if (draws_plain_)
        plain_.draw(part, frame);
    else
        frame = {};
    if (!draws_fine_) return;
    frame.width = part.width;
    frame.height = part.height;
    frame.color.resize(std::size_t(part.width) * part.height);
    frame.counters = {};
    const auto factor = std::uint32_t(plan_->request.supersample);
    const std::uint32_t step = (std::uint32_t(tile_size) + factor - 1) / factor;
    for (std::uint32_t row = 0; row < part.height; row += step) {
        const std::uint32_t rows = std::min(step, part.height - row);
        fine_.draw({part.x * factor, (part.y + row) * factor, part.width * factor, rows * factor},
                   fine_frame_);
        reduce(fine_frame_, factor, row, frame);
        add_counters(frame.counters, fine_frame_.counters);
        frame.geometry_ms += fine_frame_.geometry_ms;
        frame.raster_ms += fine_frame_.raster_ms;
    }
}

std::vector<std::string> Painter::warnings() const {
    std::vector<std::string> all = plan_->warnings;
    const std::vector<std::string>& more = (draws_fine_ ? fine_ : plain_).warnings();
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

}  // namespace rast::detail
