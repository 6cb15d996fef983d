#include "coverage/homogeneous_raster.h"

#include <algorithm>
#include <cmath>

namespace rast::detail {
namespace {

struct TileBox {  // of a tile
    std::int32_t x0, y0, x1, y1;
};

// One triangle on one tile. Blocks of pixels that it misses or that hide it are left out, and where
// it fills a block its edges are not looked at. That changes no sample: IEEE's roundings keep the
// order, so that no value within a block passes the one at the corner where both products are
// largest, or least. A NaN decides nothing.
struct CrossingTile {
    static constexpr std::int32_t size = 16;  // of a block
    float* depths;
    std::uint32_t* ids;
    const TilePlace& place;
    const CrossingTriangle& t;
    std::uint32_t number;
    const ShadeDraw* masked;
    const Kernels& kernels;

    double x_of(std::int32_t i) const { return double(place.x + i * subpixels) / subpixels; }
    double y_of(std::int32_t j) const { return double(place.y + j * subpixels) / subpixels; }

    float depth_at(double x, double y, bool& drawn) const {
        const CrossingPlane& p = t.plane;
        const double exact =
            std::clamp(p.depth + (p.depth_x * (x - p.px) + p.depth_y * (y - p.py)), p.low, p.high);
        drawn = exact >= 0 && exact <= 1;
        return place.grid(float(exact));
    }

    bool hidden(const TileBox& block) const {
        bool drawn = false;
        const float nearest = depth_at(x_of(t.plane.depth_x > 0 ? block.x1 : block.x0),
                                       y_of(t.plane.depth_y > 0 ? block.y1 : block.y0), drawn);
        // All columns, so that it becomes vector code; those beside the block can only keep it.
        for (std::int32_t j = block.y0; j <= block.y1; ++j) {
            const float* const row = depths + j * tile_size + (block.x0 & -size);
            int seen = 0;
            for (int i = 0; i < size; ++i) seen |= nearest < row[i] ? 0 : 1;
            if (seen != 0) return false;
        }
        return true;
    }

    template <bool filled>
    void draw_pixels(const TileBox& block) const {
        for (std::int32_t j = block.y0; j <= block.y1; ++j)
            for (std::int32_t i = block.x0; i <= block.x1; ++i) {
                const double x = x_of(i), y = y_of(j);
                bool inside = true, drawn = false;
                if (!filled)
                    for (const CrossingEdge& e : t.edges)
                        inside = inside && e.inside(e.value(x, y));
                if (!inside) continue;
                const float depth = depth_at(x, y, drawn);
                if (!drawn) continue;
                const std::size_t at = std::size_t(j) * tile_size + std::size_t(i);
                if (!(depth > depths[at] || (depth == depths[at] && number < ids[at]))) continue;
                if (masked != nullptr && !kernels.covers(*masked, place.x + i * subpixels,
                                                         place.y + j * subpixels, t.id))
                    continue;
                depths[at] = depth;
                ids[at] = number;
            }
    }

    void draw(const TileBox& block) const {
        bool filled = true;
        for (const CrossingEdge& e : t.edges) {
            const bool right = e.nx > 0, down = e.ny > 0;
            const double most =
                e.value(x_of(right ? block.x1 : block.x0), y_of(down ? block.y1 : block.y0));
            if (most < 0) return;
            const double least =
                e.value(x_of(right ? block.x0 : block.x1), y_of(down ? block.y0 : block.y1));
            filled = filled && e.inside(least);
        }
        if (place.skip_hidden && hidden(block)) return;
        if (filled)
            draw_pixels<true>(block);
        else
            draw_pixels<false>(block);
    }
};

}  // namespace

void raster_crossing(float* depths, std::uint32_t* ids, const TilePlace& place,
                     const CrossingTriangle& t, std::uint32_t number, const ShadeDraw* masked,
                     const Kernels& kernels) {
    const double left = double(place.x) / subpixels, top = double(place.y) / subpixels;
    // One pixel more on each side pays for the rounding of the box's corners.
    const auto pixel = [](double v, std::int32_t extent) {
        return std::int32_t(std::clamp(v, -1.0, double(extent)));
    };
    const TileBox box{
        std::max(pixel(std::floor(t.low_x - left) - 1, place.width), 0),
        std::max(pixel(std::floor(t.low_y - top) - 1, place.height), 0),
        std::min(pixel(std::ceil(t.high_x - left) + 1, place.width), place.width - 1),
        std::min(pixel(std::ceil(t.high_y - top) + 1, place.height), place.height - 1)};
    const CrossingTile tile{depths, ids, place, t, number, masked, kernels};
    constexpr std::int32_t size = CrossingTile::size;
    for (std::int32_t y = box.y0 & -size; y <= box.y1; y += size)
        for (std::int32_t x = box.x0 & -size; x <= box.x1; x += size)
            tile.draw({std::max(x, box.x0), std::max(y, box.y0), std::min(x + size - 1, box.x1),
                       std::min(y + size - 1, box.y1)});
}

}  // namespace rast::detail
