#include "setup.h"

#include <algorithm>
#include <cmath>

namespace rast::detail {
namespace {

// Snapped corners; returns whether they had to be turned to run clockwise on the screen.
SetupTriangle snapped_triangle(const VertexRecord* records, const std::uint32_t corners[3],
                               bool& turned) {
    const VertexRecord* v[3] = {&records[corners[0]], &records[corners[1]], &records[corners[2]]};
    std::int64_t area = std::int64_t(v[1]->x - v[0]->x) * (v[2]->y - v[0]->y) -
                        std::int64_t(v[1]->y - v[0]->y) * (v[2]->x - v[0]->x);
    turned = area < 0;
    if (turned) {
        std::swap(v[1], v[2]);
        area = -area;
    }
    SetupTriangle t{};
    for (int k = 0; k < 3; ++k) {
        t.x[k] = v[k]->x;
        t.y[k] = v[k]->y;
    }
    // In 1/256 pixels: area is twice the triangle's, exact.
    const double x1 = t.x[1] - t.x[0], y1 = t.y[1] - t.y[0];
    const double x2 = t.x[2] - t.x[0], y2 = t.y[2] - t.y[0];
    const float d0 = v[0]->depth, d1 = v[1]->depth, d2 = v[2]->depth;
    const double rise1 = double(d1) - d0, rise2 = double(d2) - d0;
    const double scale = subpixels / double(area);
    t.z0 = d0;
    t.dzdx = float((rise1 * y2 - rise2 * y1) * scale);
    t.dzdy = float((rise2 * x1 - rise1 * x2) * scale);
    t.z_low = std::min({d0, d1, d2});
    t.z_high = std::max({d0, d1, d2});
    return t;
}

struct PixelBox {
    std::int32_t x0, y0, x1, y1;
};

BinScratch::Entry entry_of(std::uint32_t what, const PixelBox& box) {
    return {what, box.x0 / tile_size, box.y0 / tile_size, box.x1 / tile_size, box.y1 / tile_size};
}

// Pixels whose centres, or any part, the box reaches; within the window.
PixelBox box_of(const SetupTriangle& t, const Window& window, bool several_samples) {
    const std::int32_t low_bias = several_samples ? subpixels / 2 : subpixels - 1;
    const std::int32_t high_bias = several_samples ? subpixels / 2 : 0;
    const auto range = [&](const std::int32_t* v, std::int32_t start, std::int32_t extent) {
        const std::int32_t low = std::min({v[0], v[1], v[2]}), high = std::max({v[0], v[1], v[2]});
        return std::pair{std::max((low + low_bias - start) >> subpixel_bits, 0),
                         std::min((high + high_bias - start) >> subpixel_bits, extent - 1)};
    };
    const auto [x0, x1] = range(t.x, window.first_x, window.width);
    const auto [y0, y1] = range(t.y, window.first_y, window.height);
    return {x0, y0, x1, y1};
}

bool box_of(const CrossingTriangle& t, const Window& window, PixelBox& box) {
    const double left = double(window.first_x) / subpixels,
                 top = double(window.first_y) / subpixels;
    // Two pixels more pay for sample positions and for the rounding of the box's corners.
    const auto pixel = [](double v, std::int32_t extent) {
        return std::int32_t(std::clamp(v, -1.0, double(extent)));
    };
    box.x0 = std::max(pixel(std::floor(t.low_x - left) - 2, window.width), 0);
    box.y0 = std::max(pixel(std::floor(t.low_y - top) - 2, window.height), 0);
    box.x1 = std::min(pixel(std::ceil(t.high_x - left) + 2, window.width), window.width - 1);
    box.y1 = std::min(pixel(std::ceil(t.high_y - top) + 2, window.height), window.height - 1);
    return box.x0 <= box.x1 && box.y0 <= box.y1;
}

void bin(const Window& window, BinScratch& scratch, TriangleChunk& chunk) {
    scratch.counts.resize(window.tile_count(), 0);
    scratch.touched.clear();
    const auto each_tile = [&](const BinScratch::Entry& e, const auto& visit) {
        for (std::int32_t y = e.tile_y0; y <= e.tile_y1; ++y)
            for (std::int32_t x = e.tile_x0; x <= e.tile_x1; ++x)
                visit(std::uint32_t(y * window.tiles_x + x));
    };
    for (const BinScratch::Entry& e : scratch.entries)
        each_tile(e, [&](std::uint32_t tile) {
            if (scratch.counts[tile]++ == 0) scratch.touched.push_back(tile);
        });
    chunk.slices.clear();
    std::uint32_t total = 0;
    for (const std::uint32_t tile : scratch.touched) {
        const std::uint32_t count = scratch.counts[tile];
        chunk.slices.push_back({tile, total, total + count});
        scratch.counts[tile] = total;
        total += count;
    }
    chunk.order.resize(total);
    for (const BinScratch::Entry& e : scratch.entries)
        each_tile(e, [&](std::uint32_t tile) { chunk.order[scratch.counts[tile]++] = e.what; });
    for (const std::uint32_t tile : scratch.touched) scratch.counts[tile] = 0;
}

}  // namespace

void set_up_chunk(const DrawGeometry& geometry, const Window& window, bool several_samples,
                  const Kernels& kernels, BinScratch& scratch, TriangleChunk& chunk) {
    chunk.triangles.clear();
    chunk.crossing.clear();
    chunk.counters = {};
    chunk.counters.triangles = chunk.count;
    scratch.entries.clear();
    CullTask task;
    task.records = geometry.records;
    task.indices = geometry.indices + std::size_t(chunk.first_triangle) * 3;
    task.count = chunk.count;
    task.mirrored = geometry.mirrored;
    task.drop_back = geometry.cull == CullSide::back;
    task.drop_front = geometry.cull == CullSide::front;
    task.every_touched_pixel = several_samples;
    task.window = window;
    CullCounts counts;
    const std::uint32_t kept = kernels.cull(task, scratch.survivors.data(), counts);
    chunk.counters.non_finite = counts.non_finite;
    chunk.counters.degenerate = counts.degenerate;
    chunk.counters.facing_away = counts.facing_away;
    chunk.counters.outside = counts.outside;
    chunk.counters.between_samples = counts.between_samples;
    for (std::uint32_t s = 0; s < kept; ++s) {
        const std::uint32_t number = scratch.survivors[s];
        const std::uint32_t* corners = task.indices + std::size_t(number) * 3;
        const std::uint32_t id = chunk.first_id + number;
        bool crosses = false;
        for (int k = 0; k < 3; ++k)
            crosses = crosses || geometry.records[corners[k]].x == mark_unsnapped;
        // y points down on the screen: counter-clockwise in the world has to be turned here.
        const auto side_bit = [&](bool turned) {
            return turned == geometry.mirrored ? id_back_face : 0u;
        };
        if (!crosses) {
            bool turned = false;
            SetupTriangle t = snapped_triangle(geometry.records, corners, turned);
            t.id = id | side_bit(turned);
            scratch.entries.push_back(entry_of(std::uint32_t(chunk.triangles.size()),
                                               box_of(t, window, several_samples)));
            chunk.triangles.push_back(t);
            continue;
        }
        CrossingTriangle t;
        const CrossingOutcome outcome =
            set_up_crossing(*geometry.source, geometry.records, corners, t);
        PixelBox box{};
        if (outcome == CrossingOutcome::degenerate) {
            ++chunk.counters.degenerate;
            continue;
        }
        const bool back = side_bit(t.turned) != 0;
        if (outcome == CrossingOutcome::drawn &&
            ((back && task.drop_back) || (!back && task.drop_front))) {
            ++chunk.counters.facing_away;
            continue;
        }
        if (outcome == CrossingOutcome::outside || !box_of(t, window, box)) {
            ++chunk.counters.outside;
            continue;
        }
        t.id = id | side_bit(t.turned);
        ++chunk.counters.crossing;
        scratch.entries.push_back(
            entry_of(std::uint32_t(chunk.crossing.size()) | order_crossing, box));
        chunk.crossing.push_back(t);
    }
    bin(window, scratch, chunk);
}

}  // namespace rast::detail
