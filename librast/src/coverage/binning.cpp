#include "coverage/binning.h"

#include <algorithm>
#include <cmath>

namespace rast::detail {
namespace {

struct PixelBox {
    std::int32_t x0, y0, x1, y1;
};

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

// The first and last tile of a pair as CullResult has them.
std::int32_t tile_range(std::int32_t first_pixel, std::int32_t last_pixel) {
    return first_pixel / tile_size | last_pixel / tile_size << 16;
}

// Calls visit(entry, tile) for every tile that an entry reaches, runs of the same tile at once:
// visit_run(first, end, tile) for entries that reach it alone.
template <class VisitRun, class Visit>
void each_tile(const CullResult& list, std::uint32_t kept, std::int32_t tiles_x,
               const VisitRun& visit_run, const Visit& visit) {
    for (std::uint32_t e = 0, end = 0; e < kept; e = end) {
        const std::int32_t tile = list.tile[e];
        end = e + 1;
        if (tile != CullResult::several_tiles) {
            while (end < kept && list.tile[end] == tile) ++end;
            visit_run(e, end, std::uint32_t(tile));
            continue;
        }
        const std::uint32_t columns = std::uint32_t(list.columns[e]);
        const std::uint32_t rows = std::uint32_t(list.rows[e]);
        for (std::uint32_t y = rows & 0xffffu; y <= rows >> 16; ++y)
            for (std::uint32_t x = columns & 0xffffu; x <= columns >> 16; ++x)
                visit(e, y * std::uint32_t(tiles_x) + x);
    }
}

// How often entries are listed.
std::uint64_t entries_by_tile(const CullResult& list, std::uint32_t kept) {
    std::uint64_t entries = kept;
    for (std::uint32_t e = 0; e < kept; ++e) {
        if (list.tile[e] != CullResult::several_tiles) continue;
        const std::uint32_t columns = std::uint32_t(list.columns[e]);
        const std::uint32_t rows = std::uint32_t(list.rows[e]);
        entries += std::uint64_t((columns >> 16) - (columns & 0xffffu) + 1) *
                       ((rows >> 16) - (rows & 0xffffu) + 1) -
                   1;
    }
    return entries;
}

// Counts entries by tile, in scratch.counts, and lists the tiles that have any. False, and nothing
// counted: the entries alone would take more than max_bytes.
bool count_by_tile(const Window& window, std::uint32_t kept, std::uint64_t max_bytes,
                   BinScratch& scratch) {
    scratch.counts.resize(window.tile_count(), 0);
    scratch.touched.clear();
    const CullResult& list = scratch.kept;
    // Seldom looked at: even entries that reach all tiles would fit.
    if (std::uint64_t(kept) * window.tile_count() > max_bytes / sizeof(std::uint16_t) &&
        entries_by_tile(list, kept) > max_bytes / sizeof(std::uint16_t))
        return false;
    std::uint32_t* const counts = scratch.counts.data();
    const auto add = [&](std::uint32_t tile, std::uint32_t entries) {
        if (counts[tile] == 0) scratch.touched.push_back(tile);
        counts[tile] += entries;
    };
    each_tile(
        list, kept, window.tiles_x,
        [&](std::uint32_t first, std::uint32_t end, std::uint32_t tile) { add(tile, end - first); },
        [&](std::uint32_t, std::uint32_t tile) { add(tile, 1); });
    return true;
}

// Leaves out what is not in these rows of tiles.
std::uint32_t keep_rows(const TileRows& within, std::uint32_t kept, CullResult& list) {
    std::uint32_t left = 0;
    for (std::uint32_t e = 0; e < kept; ++e) {
        const std::uint32_t rows = std::uint32_t(list.rows[e]);
        const std::uint32_t first = std::max(rows & 0xffffu, within.begin);
        const std::uint32_t end = std::min((rows >> 16) + 1, within.end);
        if (first >= end) continue;
        list.entries[left] = list.entries[e];
        list.tile[left] = list.tile[e];
        list.columns[left] = list.columns[e];
        list.rows[left++] = std::int32_t(first | (end - 1) << 16);
    }
    return left;
}

// Sets up an entry that crosses; false: nothing of it is drawn.
bool add_crossing(const DrawGeometry& geometry, const Window& window, std::uint32_t number,
                  TriangleChunk& chunk, PixelBox& box) {
    CrossingTriangle t;
    switch (set_up_crossing(*geometry.source, geometry.records,
                            chunk.indices + std::size_t(number) * 3, t)) {
        case CrossingOutcome::degenerate:
            ++chunk.counters.degenerate;
            return false;
        case CrossingOutcome::outside:
            ++chunk.counters.outside;
            return false;
        case CrossingOutcome::drawn:
            break;
    }
    // y points down on the screen: counter-clockwise in the world had to be turned.
    const bool back = t.turned == geometry.mirrored;
    if (geometry.cull == (back ? CullSide::back : CullSide::front)) {
        ++chunk.counters.facing_away;
        return false;
    }
    if (!box_of(t, window, box)) {
        ++chunk.counters.outside;
        return false;
    }
    t.id = (chunk.first_id + number) | (back ? id_back_face : 0u);
    ++chunk.counters.crossing;
    chunk.crossing.push_back(t);
    return true;
}

// Gives crossing entries their tiles and leaves out those of which nothing is drawn.
std::uint32_t settle_crossing(const DrawGeometry& geometry, const Window& window,
                              std::uint32_t kept, CullResult& list, TriangleChunk& chunk) {
    std::uint32_t settled = 0;
    for (std::uint32_t e = 0; e < kept; ++e) {
        std::int32_t entry = list.entries[e], tile = list.tile[e];
        std::int32_t columns = list.columns[e], rows = list.rows[e];
        if (entry & entry_crossing) {
            PixelBox box{};
            if (!add_crossing(geometry, window, std::uint32_t(entry) & entry_number, chunk, box))
                continue;
            entry = std::int32_t(chunk.crossing.size() - 1) | entry_crossing;
            tile = CullResult::several_tiles;
            columns = tile_range(box.x0, box.x1);
            rows = tile_range(box.y0, box.y1);
        }
        list.entries[settled] = entry;
        list.tile[settled] = tile;
        list.columns[settled] = columns;
        list.rows[settled++] = rows;
    }
    return settled;
}

}  // namespace

std::uint32_t cull_chunk(const DrawGeometry& geometry, const Window& window, bool several_samples,
                         const Kernels& kernels, BinScratch& scratch, TriangleChunk& chunk) {
    chunk.crossing.clear();
    chunk.counters = {};
    chunk.counters.triangles = chunk.count;
    chunk.records = geometry.records;
    chunk.indices = geometry.indices + std::size_t(chunk.first_triangle) * 3;
    CullTask task;
    task.records = chunk.records;
    task.indices = chunk.indices;
    task.count = chunk.count;
    task.mirrored = geometry.mirrored;
    task.drop_back = geometry.cull == CullSide::back;
    task.drop_front = geometry.cull == CullSide::front;
    task.every_touched_pixel = several_samples;
    task.window = window;
    CullCounts counts;
    const std::uint32_t kept = kernels.cull(task, scratch.kept, counts);
    chunk.counters.non_finite = counts.non_finite;
    chunk.counters.degenerate = counts.degenerate;
    chunk.counters.facing_away = counts.facing_away;
    chunk.counters.outside = counts.outside;
    chunk.counters.between_samples = counts.between_samples;
    return counts.crossing > 0 ? settle_crossing(geometry, window, kept, scratch.kept, chunk)
                               : kept;
}

bool list_chunk(const Window& window, const TileRows& rows, std::uint32_t kept, ListMemory& memory,
                BinScratch& scratch, TriangleChunk& chunk) {
    chunk.slices.clear();
    chunk.order.clear();
    CullResult& list = scratch.kept;
    if (rows.begin > 0 || rows.end < std::uint32_t(window.tiles_y))
        kept = keep_rows(rows, kept, list);
    if (!count_by_tile(window, kept, memory.most, scratch)) return false;
    std::uint32_t* const counts = scratch.counts.data();
    std::uint64_t entries = 0;
    for (const std::uint32_t tile : scratch.touched) entries += counts[tile];
    if (!memory.take(list_bytes(entries, scratch.touched.size()))) {
        for (const std::uint32_t tile : scratch.touched) counts[tile] = 0;
        return false;
    }
    std::uint32_t total = 0;
    for (const std::uint32_t tile : scratch.touched) {
        const std::uint32_t count = counts[tile];
        chunk.slices.push_back({tile, total, total + count});
        counts[tile] = total;
        total += count;
    }
    chunk.order.resize(total);
    std::uint16_t* const order = chunk.order.data();
    each_tile(
        list, kept, window.tiles_x,
        [&](std::uint32_t first, std::uint32_t end, std::uint32_t tile) {
            std::uint16_t* const to = order + counts[tile];
            for (std::uint32_t e = first; e < end; ++e)
                to[e - first] = std::uint16_t(list.entries[e]);
            counts[tile] += end - first;
        },
        [&](std::uint32_t e, std::uint32_t tile) {
            order[counts[tile]++] = std::uint16_t(list.entries[e]);
        });
    for (const std::uint32_t tile : scratch.touched) counts[tile] = 0;
    return true;
}

void set_up_chunk(const DrawGeometry& geometry, const Window& window, bool several_samples,
                  const Kernels& kernels, BinScratch& scratch, TriangleChunk& chunk) {
    const std::uint32_t kept =
        cull_chunk(geometry, window, several_samples, kernels, scratch, chunk);
    ListMemory memory;
    list_chunk(window, {0, std::uint32_t(window.tiles_y)}, kept, memory, scratch, chunk);
}

void add_list_bytes(const Window& window, std::uint32_t kept, BinScratch& scratch) {
    scratch.row_bytes.resize(std::size_t(window.tiles_y), 0);
    count_by_tile(window, kept, UINT64_MAX, scratch);
    for (const std::uint32_t tile : scratch.touched) {
        scratch.row_bytes[tile / std::uint32_t(window.tiles_x)] +=
            list_bytes(scratch.counts[tile], 1);
        scratch.counts[tile] = 0;
    }
}

}  // namespace rast::detail
