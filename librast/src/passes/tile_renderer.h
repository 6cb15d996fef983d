// One tile of the picture at a time: visibility first, then every visible point is shaded once,
// then the tile's pixels are written. Nothing outside the tile is touched.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coverage/binning.h"
#include "coverage/samples.h"
#include "draws/draw_bindings.h"
#include "passes/part_clock.h"

namespace rast::detail {

struct TileCounts {
    std::uint64_t shaded = 0, texture_samples = 0;  // as Counters has them
    std::uint64_t light_points = 0, highlight_points = 0, normal_map_points = 0;
    std::uint64_t masked_triangles = 0, sample_points = 0;
    std::array<std::uint64_t, shade_stages> stage_points{};
    TileCounts& operator+=(const TileCounts& other);
    // Points that are shaded by these stages.
    void add_points(const StageList& stages, std::uint64_t points);
};

// What one thread keeps while it goes from tile to tile.
struct TileScratch {
    std::vector<TileSamples> samples;
    std::vector<TilePlace> places;      // of each sample
    std::vector<std::uint32_t> counts;  // per number
    std::vector<PixelRun> runs;
    struct Fragment {  // several samples: a triangle in a pixel, the samples that it covers
        std::uint32_t number = 0;
        std::uint16_t pixel = 0, samples = 0;
    };
    std::vector<Fragment> fragments;
    std::vector<std::uint8_t> shaded_at;  // per fragment: the sample, or how many there are: centre
    std::vector<std::uint32_t> place_begin, place_next, by_place;  // fragments by that
    struct Group {  // fragments of one draw, and the triangles that they belong to
        std::uint32_t draw = 0, begin = 0, end = 0, first_run = 0, run_count = 0;
    };
    std::vector<Group> groups;
    // Fragments by number, which is by draw and triangle: pixel of the tile, samples.
    std::vector<std::uint16_t> pixel, weight;
    std::vector<TriangleRun> triangles;
    std::array<std::vector<float>, 11> planes;  // results of the kernels
    std::vector<glm::vec4> colors;              // per pixel
    std::vector<std::uint32_t> bytes;           // the same; beyond the picture an older tile's
    PartClock* clock = nullptr;                 // null: nothing is measured
    TileCounts done;                            // by all tiles of this thread
};

// What the tiles of a picture share; all of it must stay while they are drawn.
struct TileInputs {
    const RenderPlan* plan = nullptr;
    const Kernels* kernels = nullptr;
    const std::vector<SampleOffset>* offsets = nullptr;
    const std::vector<RenderInstance>* instances = nullptr;
    const std::vector<Draw>* draws = nullptr;
    const std::vector<ShadeDraw>* shade_draws = nullptr;
    const std::vector<TriangleChunk>* chunks = nullptr;
    // Tile t draws work_begin[t] … work_begin[t + 1] of these.
    const TileWork* work = nullptr;
    const std::uint32_t* work_begin = nullptr;
    const ShadeFrame* shade_frame = nullptr;
    bool clear_past_caches = false;
    Window window;
    std::int32_t first_row = 0;  // of the window, in the frame
    Frame* frame = nullptr;      // its buffers have their size
};

// Whether something beside colours is asked for.
bool keeps_buffers(const RenderRequest& request);

// Tiles may be drawn by several threads at once.
TileCounts draw_tile(const TileInputs& inputs, std::uint32_t tile, TileScratch& scratch);

// Draws the entries of a slice into a tile's samples, each at its place, numbered from
// `first_number` on. Slices go by ascending numbers.
void raster_slice(const TriangleChunk& chunk, std::uint32_t begin, std::uint32_t end,
                  std::uint32_t first_number, std::span<const TilePlace> places,
                  const ShadeDraw* masked, const Kernels& kernels, std::span<TileSamples> samples);

}  // namespace rast::detail
