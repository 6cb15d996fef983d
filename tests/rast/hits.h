// How often triangles hit each sample, counted one triangle at a time below the public interface,
// and integer oracles in 128 bits for the same question.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "coverage/binning.h"
#include "coverage/samples.h"
#include "draws/instance.h"
#include "passes/tile_renderer.h"

namespace hits {

using Wide = __int128;
using prep::SimdLevel;
using rast::detail::CullSide;
using rast::detail::SampleOffset;
using rast::detail::ScreenVertex;
using Triangle = std::array<std::uint32_t, 3>;

// Vertices that are given, not transformed.
class Given final : public rast::detail::VertexSource {
  public:
    explicit Given(const std::vector<ScreenVertex>& vertices) : vertices_(vertices) {}
    ScreenVertex homogeneous(std::uint32_t vertex) const override { return vertices_[vertex]; }

  private:
    const std::vector<ScreenVertex>& vertices_;
};

struct Hits {
    std::uint32_t width = 0, height = 0;
    std::vector<int> front, back;
    std::vector<float> nearest;  // −1: nothing
    rast::Counters counters;
    int at(std::uint32_t x, std::uint32_t y, bool of_back) const {
        return (of_back ? back : front)[std::size_t(y) * width + x];
    }
};

struct HitOptions {
    SimdLevel level = SimdLevel::automatic;
    CullSide cull = CullSide::none;
    std::optional<SampleOffset> offset;  // set: one of several samples of a pixel
};

// Each triangle is set up and drawn alone, so that none hides another.
inline Hits count_hits(const std::vector<ScreenVertex>& vertices,
                       const std::vector<Triangle>& triangles, std::uint32_t width,
                       std::uint32_t height, const HitOptions& options = {}) {
    using namespace rast::detail;
    const Kernels& kernels = kernels_for(options.level);
    Hits hits{width, height, {}, {}, {}, {}};
    const std::size_t pixels = std::size_t(width) * height;
    hits.front.assign(pixels, 0);
    hits.back.assign(pixels, 0);
    hits.nearest.assign(pixels, -1.0f);
    const Given source(vertices);
    std::vector<VertexRecord> records;
    for (const ScreenVertex& v : vertices) records.push_back(record_of(v));
    Window window;
    window.width = std::int32_t(width);
    window.height = std::int32_t(height);
    window.first_x = (1 - window.width) * 128;
    window.first_y = (1 - window.height) * 128;
    window.tiles_x = (window.width + tile_size - 1) / tile_size;
    window.tiles_y = (window.height + tile_size - 1) / tile_size;
    BinScratch scratch;
    TriangleChunk chunk;
    chunk.count = 1;
    TileSamples samples;
    samples.clear();
    const DrawGeometry geometry{&source, records.data(), triangles.data()->data(), false,
                                options.cull};
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        chunk.first_triangle = std::uint32_t(t);
        set_up_chunk(geometry, window, options.offset.has_value(), kernels, scratch, chunk);
        const rast::Counters& c = chunk.counters;
        hits.counters.non_finite += c.non_finite;
        hits.counters.degenerate += c.degenerate;
        hits.counters.facing_away += c.facing_away;
        hits.counters.outside += c.outside;
        hits.counters.between_samples += c.between_samples;
        hits.counters.crossing += c.crossing;
        for (const TileSlice& slice : chunk.slices) {
            const std::int32_t x0 = std::int32_t(slice.tile) % window.tiles_x * tile_size;
            const std::int32_t y0 = std::int32_t(slice.tile) / window.tiles_x * tile_size;
            TilePlace place{window.first_x + x0 * 256, window.first_y + y0 * 256,
                            std::min(tile_size, window.width - x0),
                            std::min(tile_size, window.height - y0)};
            if (options.offset) {
                place.x += options.offset->x;
                place.y += options.offset->y;
            }
            // Only the triangle's box is looked at and emptied again.
            std::int32_t i0 = 0, j0 = 0, i1 = place.width - 1, j1 = place.height - 1;
            if (!(chunk.order[slice.begin] & entry_crossing)) {
                const auto corner = [&](std::size_t k) { return records[triangles[t][k]]; };
                const auto [low_x, high_x] = std::minmax({corner(0).x, corner(1).x, corner(2).x});
                const auto [low_y, high_y] = std::minmax({corner(0).y, corner(1).y, corner(2).y});
                i0 = std::clamp((low_x - place.x) / 256 - 2, 0, i1);
                j0 = std::clamp((low_y - place.y) / 256 - 2, 0, j1);
                i1 = std::clamp((high_x - place.x) / 256 + 2, 0, i1);
                j1 = std::clamp((high_y - place.y) / 256 + 2, 0, j1);
            }
            raster_slice(chunk, slice.begin, slice.end, 0, {&place, 1}, nullptr, kernels,
                         {&samples, 1});
            const bool of_back = (chunk.id_of(chunk.order[slice.begin]) & id_back_face) != 0;
            for (std::int32_t y = j0; y <= j1; ++y)
                for (std::int32_t x = i0; x <= i1; ++x) {
                    const std::size_t at = std::size_t(y) * tile_size + std::size_t(x);
                    if (samples.id[at] == id_none) continue;
                    const std::size_t i = std::size_t(y0 + y) * width + std::size_t(x0 + x);
                    ++(of_back ? hits.back : hits.front)[i];
                    hits.nearest[i] = std::max(hits.nearest[i], samples.depth[at]);
                    samples.id[at] = id_none;
                    samples.depth[at] = -1.0f;
                }
        }
    }
    // Nothing was drawn outside those boxes.
    EXPECT_EQ(std::count(samples.id.begin(), samples.id.end(), id_none),
              std::ptrdiff_t(samples.id.size()));
    return hits;
}

// A vertex at (x, y) 1/256 pixels from the top left corner, seen at homogeneous w.
inline ScreenVertex vertex_at(std::int64_t x, std::int64_t y, std::uint32_t width,
                              std::uint32_t height, double w = 1, double depth = 0.5) {
    return {(double(x) / 256 - width * 0.5) * w, (double(y) / 256 - height * 0.5) * w, depth * w,
            w};
}

struct Point {
    std::int64_t x = 0, y = 0;
    bool operator==(const Point&) const = default;
};

inline int orientation(const Point& a, const Point& b, const Point& c) {
    const Wide d = Wide(b.x - a.x) * (c.y - a.y) - Wide(b.y - a.y) * (c.x - a.x);
    return d > 0 ? 1 : d < 0 ? -1 : 0;
}

inline bool on_segment(const Point& p, const Point& a, const Point& b) {
    return orientation(a, b, p) == 0 && p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) &&
           p.y >= std::min(a.y, b.y) && p.y <= std::max(a.y, b.y);
}

inline Point centre_of(std::uint32_t x, std::uint32_t y) {
    return {std::int64_t(x) * 256 + 128, std::int64_t(y) * 256 + 128};
}

inline Point sample_of(std::uint32_t x, std::uint32_t y,
                       const std::optional<SampleOffset>& offset) {
    const Point c = centre_of(x, y);
    return offset ? Point{c.x + offset->x, c.y + offset->y} : c;
}

// The one sample at the centre, then every standard position of 2, 4, 8 and 16 samples.
inline std::vector<std::optional<SampleOffset>> every_sample() {
    std::vector<std::optional<SampleOffset>> all{std::nullopt};
    for (const int count : {2, 4, 8, 16})
        for (const SampleOffset& offset : rast::detail::sample_offsets(count))
            all.push_back(offset);
    return all;
}

// Whether a sample on the boundary belongs to a triangle, as Direct3D and Vulkan say it: a left
// edge has the inside to its right, a top edge is level with the inside below.
inline bool oracle_covers(Point a, Point b, Point c, const Point& p) {
    const int turn = orientation(a, b, c);
    if (turn == 0) return false;
    if (turn < 0) std::swap(b, c);
    const Point corners[3] = {a, b, c};
    for (int i = 0; i < 3; ++i) {
        const Point &from = corners[i], &to = corners[(i + 1) % 3], &third = corners[(i + 2) % 3];
        const int side = orientation(from, to, p);
        if (side < 0) return false;
        if (side > 0) continue;
        const bool level = from.y == to.y;
        const bool top = level && third.y > from.y;
        // The inside is on the right: a point just right of the edge is on the third corner's side.
        const Point right{from.x + to.x + 2, from.y + to.y};
        const bool left =
            !level && orientation({2 * from.x, 2 * from.y}, {2 * to.x, 2 * to.y}, right) > 0;
        if (!top && !left) return false;
    }
    return true;
}

// Anywhere from 0 to `extent` pixels, on multiples of `step`: 16 holds every standard position.
inline std::int64_t random_coordinate(std::mt19937_64& random, std::uint32_t extent,
                                      std::int64_t step) {
    return std::int64_t(random() % (extent * 256 / std::uint64_t(step) + 1)) * step;
}
inline std::int64_t random_step(std::mt19937_64& random) {
    constexpr std::int64_t steps[] = {128, 16, 16, 1};
    return steps[random() % 4];
}

}  // namespace hits
