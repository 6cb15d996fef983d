#include "plan/memory_estimate.h"

#include <algorithm>

#include "geometry/tile.h"
#include "plan/frame_pass.h"

namespace rast::detail {
namespace {

// What all passes of a plan ask for beside its picture.
struct PassMemory {
    bool any = false;
    bool depth = false, normals = false, positions = false;  // read, whether they are kept or not
    std::uint64_t planes = 0;  // floats a pixel, of passes after the main one
    std::uint64_t bytes = 0;   // of planes of passes before it
};

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

// Bytes a pixel of a frame's buffers.
std::uint64_t pixel_bytes(const RenderRequest& r, bool bytes) {
    return (r.keep_color ? (bytes ? 4 : 16) : 0) + (r.keep_depth ? 4 : 0) + (r.keep_ids ? 8 : 0) +
           (r.keep_normals ? 12 : 0) + (r.keep_uvs ? 8 : 0) + (r.keep_barycentrics ? 12 : 0) +
           (r.keep_positions ? 12 : 0);
}

// Beside the frame: what is drawn with the halo about it, and the planes of passes after the main
// one. Bands are drawn in whole rows of tiles.
std::uint64_t bytes_for_passes(const RenderPlan& plan, const PassMemory& passes, const Crop& part,
                               std::uint64_t rows) {
    if (!passes.any) return 0;
    RenderRequest r = plan.request;
    r.keep_depth |= passes.depth;
    r.keep_normals |= passes.normals;
    r.keep_positions |= passes.positions;
    const std::uint64_t halo = plan.halo;
    const auto widened = [&](std::uint64_t begin, std::uint64_t extent, std::uint64_t all) {
        return std::min(begin + extent + halo, all) - (begin - std::min(begin, halo));
    };
    const std::uint64_t width = widened(part.x, part.width, r.width);
    const std::uint64_t all_rows = widened(part.y, part.height, r.height);
    const std::uint64_t drawn =
        rows < part.height ? std::min(rows + 2 * halo + 2 * (tile_size - 1), all_rows) : all_rows;
    return width * drawn * (pixel_bytes(r, false) + passes.planes * sizeof(float)) + passes.bytes;
}

}  // namespace

Crop picture_part(const RenderRequest& request) {
    return request.crop.value_or(Crop{0, 0, request.width, request.height});
}

void estimate_memory(RenderPlan& plan) {
    const RenderRequest& r = plan.request;
    const PassMemory passes = memory_of(plan);
    const Crop part = picture_part(r);
    const bool bytes = r.pixels == PixelFormat::bytes && r.coverage != Coverage::area &&
                       r.supersample == 1 && !passes.any;  // those are made of floats first
    const std::uint64_t row = part.width * pixel_bytes(r, bytes);
    constexpr std::uint64_t tile = tile_size;
    std::uint64_t rows = std::max<std::uint64_t>(r.band_bytes / std::max<std::uint64_t>(row, 1), 1);
    if (rows > tile) rows = rows / tile * tile;
    rows = std::min<std::uint64_t>(rows, part.height);
    plan.band_rows = std::uint32_t(rows);
    const std::uint64_t geometry =
        plan.vertices * sizeof(VertexRecord) + plan.triangles * sizeof(std::uint16_t);
    // Supersampled, a row of tiles of the finer picture at a time.
    const std::uint64_t factor = std::uint64_t(r.supersample);
    const std::uint64_t width =
        std::min<std::uint64_t>(std::uint64_t(part.width) + 2 * std::uint64_t(plan.halo), r.width);
    const std::uint64_t fine =
        factor > 1 ? 16 * width * factor * (tile + 2 * (factor - 1)) : 0;  // and what is left
    plan.memory_estimate =
        part.height * row + bytes_for_passes(plan, passes, part, part.height) + fine + geometry;
    plan.band_memory_estimate =
        rows * row + bytes_for_passes(plan, passes, part, rows) + fine + geometry;
}

}  // namespace rast::detail
