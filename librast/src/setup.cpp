#include "setup.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

namespace rast::detail {
namespace {

struct PixelBox {
    std::int32_t x0, y0, x1, y1;
};

TileBox tiles_of(const PixelBox& box) {
    const auto tile = [](std::int32_t pixel) { return std::uint16_t(pixel / tile_size); };
    return {tile(box.x0), tile(box.x1), tile(box.y0), tile(box.y1)};
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
    const auto each_tile = [&](const TileBox& box, const auto& visit) {
        for (std::uint32_t y = box.y0; y <= box.y1; ++y)
            for (std::uint32_t x = box.x0; x <= box.x1; ++x)
                visit(y * std::uint32_t(window.tiles_x) + x);
    };
    for (const TileBox& box : scratch.boxes)
        each_tile(box, [&](std::uint32_t tile) {
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
    for (std::size_t e = 0; e < scratch.boxes.size(); ++e)
        each_tile(scratch.boxes[e], [&](std::uint32_t tile) {
            chunk.order[scratch.counts[tile]++] = scratch.entries[e];
        });
    for (const std::uint32_t tile : scratch.touched) scratch.counts[tile] = 0;
}

class ChunkSetup {
  public:
    ChunkSetup(const DrawGeometry& geometry, const Window& window, bool several_samples,
               const Kernels& kernels, BinScratch& scratch, TriangleChunk& chunk)
        : geometry_(geometry),
          window_(window),
          several_samples_(several_samples),
          kernels_(kernels),
          scratch_(scratch),
          chunk_(chunk),
          indices_(geometry.indices + std::size_t(chunk.first_triangle) * 3) {}

    void run() {
        chunk_.crossing.clear();
        chunk_.counters = {};
        chunk_.counters.triangles = chunk_.count;
        const std::uint32_t kept = cull();
        if (crossing_ == 0)
            set_up_snapped(scratch_.survivors.data(), kept);
        else
            set_up_mixed(kept);
        bin(window_, scratch_, chunk_);
    }

  private:
    std::uint32_t cull() {
        CullTask task;
        task.records = geometry_.records;
        task.indices = indices_;
        task.count = chunk_.count;
        task.mirrored = geometry_.mirrored;
        task.drop_back = geometry_.cull == CullSide::back;
        task.drop_front = geometry_.cull == CullSide::front;
        task.every_touched_pixel = several_samples_;
        task.window = window_;
        CullCounts counts;
        const std::uint32_t kept = kernels_.cull(task, scratch_.survivors.data(), counts);
        chunk_.counters.non_finite = counts.non_finite;
        chunk_.counters.degenerate = counts.degenerate;
        chunk_.counters.facing_away = counts.facing_away;
        chunk_.counters.outside = counts.outside;
        chunk_.counters.between_samples = counts.between_samples;
        crossing_ = counts.crossing;
        return kept;
    }

    void set_up_snapped(const std::uint16_t* numbers, std::uint32_t count) {
        SetupTask task;
        task.records = geometry_.records;
        task.indices = indices_;
        task.numbers = numbers;
        task.count = count;
        task.first_id = chunk_.first_id;
        task.mirrored = geometry_.mirrored;
        task.every_touched_pixel = several_samples_;
        task.window = window_;
        chunk_.triangles.resize(count);
        scratch_.boxes.resize(count);
        kernels_.set_up(task, chunk_.triangles.data(), scratch_.boxes.data());
        scratch_.entries.resize(count);
        std::iota(scratch_.entries.begin(), scratch_.entries.end(), 0u);
    }

    void set_up_mixed(std::uint32_t kept) {
        scratch_.snapped.clear();
        const auto crosses = [&](std::uint16_t number) {
            const std::uint32_t* corners = indices_ + std::size_t(number) * 3;
            return std::any_of(corners, corners + 3, [&](std::uint32_t v) {
                return geometry_.records[v].x == mark_unsnapped;
            });
        };
        const auto begin = scratch_.survivors.begin(), end = begin + kept;
        std::remove_copy_if(begin, end, std::back_inserter(scratch_.snapped), crosses);
        set_up_snapped(scratch_.snapped.data(), std::uint32_t(scratch_.snapped.size()));
        // Together again, in submission order.
        const std::vector<TileBox> snapped_boxes = std::move(scratch_.boxes);
        scratch_.boxes.clear();
        scratch_.entries.clear();
        std::uint32_t next = 0;
        for (auto number = begin; number != end; ++number) {
            TileBox box;
            if (!crosses(*number)) {
                scratch_.boxes.push_back(snapped_boxes[next]);
                scratch_.entries.push_back(next++);
            } else if (add_crossing(*number, box)) {
                scratch_.boxes.push_back(box);
                scratch_.entries.push_back(std::uint32_t(chunk_.crossing.size() - 1) |
                                           order_crossing);
            }
        }
    }

    // False: nothing of it is drawn.
    bool add_crossing(std::uint16_t number, TileBox& tiles) {
        CrossingTriangle t;
        switch (set_up_crossing(*geometry_.source, geometry_.records,
                                indices_ + std::size_t(number) * 3, t)) {
            case CrossingOutcome::degenerate:
                ++chunk_.counters.degenerate;
                return false;
            case CrossingOutcome::outside:
                ++chunk_.counters.outside;
                return false;
            case CrossingOutcome::drawn:
                break;
        }
        // y points down on the screen: counter-clockwise in the world had to be turned.
        const bool back = t.turned == geometry_.mirrored;
        if (geometry_.cull == (back ? CullSide::back : CullSide::front)) {
            ++chunk_.counters.facing_away;
            return false;
        }
        PixelBox box{};
        if (!box_of(t, window_, box)) {
            ++chunk_.counters.outside;
            return false;
        }
        tiles = tiles_of(box);
        t.id = (chunk_.first_id + number) | (back ? id_back_face : 0u);
        ++chunk_.counters.crossing;
        chunk_.crossing.push_back(t);
        return true;
    }

    const DrawGeometry& geometry_;
    const Window& window_;
    bool several_samples_;
    const Kernels& kernels_;
    BinScratch& scratch_;
    TriangleChunk& chunk_;
    const std::uint32_t* indices_;
    std::uint32_t crossing_ = 0;
};

}  // namespace

void set_up_chunk(const DrawGeometry& geometry, const Window& window, bool several_samples,
                  const Kernels& kernels, BinScratch& scratch, TriangleChunk& chunk) {
    ChunkSetup(geometry, window, several_samples, kernels, scratch, chunk).run();
}

}  // namespace rast::detail
