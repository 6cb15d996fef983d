#include "frame/supersampled_renderer.h"

#include <algorithm>

#include "frame/supersample.h"

namespace rast::detail {
namespace {

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
    RenderRequest r = plan.request;
    for (const auto& pass : plan.passes) {
        r.keep_depth |= pass->reads_depth;
        r.keep_normals |= pass->reads_normals;
        r.keep_positions |= pass->reads_positions;
        r.pixels = PixelFormat::floats;
    }
    draws_fine_ = r.supersample > 1 && r.keep_color;
    draws_plain_ = !draws_fine_ || keeps_buffers(r);
    if (draws_plain_) {
        plain_plan_ = plan;
        plain_plan_.request = r;
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
    passes_.begin(plan);
    if (plan.passes.empty()) wide_frame_ = {};
}

void Painter::place(const Crop& part) {
    part_ = part;
    drawn_ = with_halo(*plan_, part);
    if (draws_plain_) plain_.place(drawn_);
    if (!draws_fine_) return;
    const auto factor = std::uint32_t(plan_->request.supersample);
    fine_.place(
        {drawn_.x * factor, drawn_.y * factor, drawn_.width * factor, drawn_.height * factor});
}

void Painter::draw_rows(std::uint32_t first, std::uint32_t rows, Frame& frame) {
    if (plan_->passes.empty())
        draw_floats(first, rows, frame);
    else
        draw_for_passes(first, rows, frame);
    if (plan_->request.pixels == PixelFormat::bytes && frame.bytes.empty())
        to_bytes(kernels_for(plan_->request.simd), frame);
    frame.counters.buffer_bytes =
        buffer_bytes(frame) + buffer_bytes(wide_frame_) + passes_.plane_bytes();
}

void Painter::draw_for_passes(std::uint32_t first, std::uint32_t rows, Frame& frame) {
    const RowRange range = rows_with_halo(*plan_, part_, drawn_, first, rows);
    draw_floats(range.first, range.count, wide_frame_);
    passes_.finish({drawn_.x, drawn_.y + range.first, drawn_.width, range.count}, wide_frame_);
    frame.width = part_.width;
    frame.height = rows;
    passes_.tell(wide_frame_.part_ms);
    cut_out(wide_frame_, part_.x - drawn_.x, part_.y - drawn_.y + first - range.first,
            plan_->request, frame);
}

void Painter::draw_floats(std::uint32_t first, std::uint32_t rows, Frame& frame) {
    if (draws_plain_)
        plain_.draw_rows(first, rows, frame);
    else
        frame = {};
    if (!draws_fine_) return;
    frame.width = drawn_.width;
    frame.height = rows;
    frame.color.resize(std::size_t(frame.width) * rows);
    const std::uint64_t plain_lists = frame.counters.list_bytes;
    frame.counters = {};
    draw_fine(first, rows, frame);
    frame.counters.list_bytes += plain_lists;  // both are there at once
}

// A row of the finer picture's tiles at a time.
void Painter::draw_fine(std::uint32_t first, std::uint32_t rows, Frame& frame) {
    const auto factor = std::uint32_t(plan_->request.supersample), tile = std::uint32_t(tile_size);
    const std::uint32_t end = (first + rows) * factor;
    const std::size_t width = std::size_t(frame.width) * factor;
    std::uint32_t done = 0;
    left_over_.clear();
    fine_frame_.color.reserve((std::size_t(tile) + factor - 1) * width);
    for (std::uint32_t row = first * factor; row < end; row += tile) {
        fine_.draw_rows(row, std::min(tile, end - row), fine_frame_);
        add_counters(frame.counters, fine_frame_.counters);
        frame.geometry_ms += fine_frame_.geometry_ms;
        frame.raster_ms += fine_frame_.raster_ms;
        add_times(frame.part_ms, fine_frame_.part_ms);
        // What the row of tiles before left belongs in front.
        std::vector<glm::vec4>& color = fine_frame_.color;
        if (!left_over_.empty()) color.insert(color.begin(), left_over_.begin(), left_over_.end());
        const auto whole = std::uint32_t(color.size() / width) / factor;
        PartClock* const clock = plan_->request.timed ? &clock_ : nullptr;
        {
            const PartTimer timer(clock, DrawingPart::reducing);
            reduce(color.data(), factor, done, whole, plan_->request.threads, frame);
        }
        done += whole;
        left_over_.assign(color.begin() + std::ptrdiff_t(whole * factor * width), color.end());
    }
    clock_.tell(0, frame.part_ms);
}

std::vector<std::string> Painter::warnings() const {
    std::vector<std::string> all = plan_->warnings;
    const std::vector<std::string>& more = (draws_fine_ ? fine_ : plain_).warnings();
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

}  // namespace rast::detail
