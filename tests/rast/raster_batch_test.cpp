// Triangles of all sizes, alone and many at a time: however they are dealt with (pixel by pixel,
// row by row, by blocks), the samples covered are those of exact integers, and what is seen is the
// nearest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "hits.h"
#include "simd_levels.h"

namespace {

using namespace hits;

// Corners about a place of the picture, `reach` pixels from it; flat ones as well.
void random_triangle(std::mt19937_64& random, std::uint32_t width, std::uint32_t height,
                     double reach, Point p[3]) {
    const std::int64_t step = random_step(random);
    const Point middle{random_coordinate(random, width, step),
                       random_coordinate(random, height, step)};
    const std::int64_t cells = std::max<std::int64_t>(1, std::int64_t(reach * 256 / double(step)));
    const bool flat = random() % 4 == 0;
    for (int k = 0; k < 3; ++k) {
        const auto off = [&](std::int64_t most) {
            return (std::int64_t(random() % std::uint64_t(2 * most + 1)) - most) * step;
        };
        p[k] = {middle.x + off(cells), middle.y + off(flat ? (cells + 15) / 16 : cells)};
        if (flat && random() % 2) std::swap(p[k].x, p[k].y);
    }
}

double random_reach(std::mt19937_64& random) {
    constexpr double reaches[] = {0.6, 1.5, 3, 5, 9, 20, 40, 130, 600, 6000};
    return reaches[random() % 10];
}

// Tiles at the picture's edges are from one pixel to whole.
TEST(RasterBatch, TrianglesOfEverySizeCoverWhatExactIntegersSay) {
    std::mt19937_64 random(11);
    const std::vector<SimdLevel> tried = test::every_level();
    const auto positions = every_sample();
    std::uint64_t wrong = 0, covered = 0;
    for (int n = 0; n < 6000; ++n) {
        const std::uint32_t width = 64 + std::uint32_t(random() % 70);
        const std::uint32_t height = 1 + std::uint32_t(random() % 70);
        Point p[3];
        random_triangle(random, width, height, random_reach(random), p);
        if (orientation(p[0], p[1], p[2]) == 0) continue;
        std::vector<ScreenVertex> vertices;
        for (const Point& q : p) vertices.push_back(vertex_at(q.x, q.y, width, height));
        HitOptions options;
        options.level = tried[std::size_t(n) % tried.size()];
        options.offset = positions[random() % positions.size()];
        const Hits hits = count_hits(vertices, {{0, 1, 2}}, width, height, options);
        const bool back = orientation(p[0], p[1], p[2]) > 0;
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const int expected =
                    oracle_covers(p[0], p[1], p[2], sample_of(x, y, options.offset)) ? 1 : 0;
                wrong += hits.at(x, y, back) != expected || hits.at(x, y, !back) != 0;
                covered += std::uint64_t(expected);
            }
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(covered, 1000000u);
}

struct Seen {
    std::vector<float> depth;
    std::vector<std::uint32_t> number;
    bool operator==(const Seen& other) const {
        return number == other.number && depth.size() == other.depth.size() &&
               std::memcmp(depth.data(), other.depth.data(), depth.size() * sizeof(float)) == 0;
    }
};

// All of them at once into the one tile of a picture.
Seen seen_together(const std::vector<ScreenVertex>& vertices, std::uint32_t width,
                   std::uint32_t height, SimdLevel level, bool skip_hidden) {
    using namespace rast::detail;
    const Kernels& kernels = kernels_for(level);
    std::vector<VertexRecord> records;
    std::vector<std::uint32_t> indices;
    for (const ScreenVertex& v : vertices) {
        indices.push_back(std::uint32_t(indices.size()));
        records.push_back(record_of(v));
    }
    Window window;
    window.width = std::int32_t(width);
    window.height = std::int32_t(height);
    window.first_x = (1 - window.width) * 128;
    window.first_y = (1 - window.height) * 128;
    window.tiles_x = window.tiles_y = 1;
    const Given source(vertices);
    const DrawGeometry geometry{&source, records.data(), indices.data(), false, CullSide::none};
    BinScratch scratch;
    TriangleChunk chunk;
    chunk.count = std::uint32_t(vertices.size() / 3);
    set_up_chunk(geometry, window, false, kernels, scratch, chunk);
    TileSamples samples;
    samples.clear();
    TilePlace place{window.first_x, window.first_y, window.width, window.height, {}, skip_hidden};
    if (!chunk.slices.empty())
        raster_slice(chunk, 0, std::uint32_t(chunk.order.size()), 0, {&place, 1}, nullptr, kernels,
                     {&samples, 1});
    // Entry of the tile → triangle.
    Seen seen{samples.depth, {}};
    for (const std::uint32_t number : samples.id)
        seen.number.push_back(number == id_none ? id_none
                                                : chunk.id_of(chunk.order[number]) & ~id_back_face);
    return seen;
}

TEST(RasterBatch, ManyAtOnceShowTheNearestOfEachAlone) {
    std::mt19937_64 random(12);
    for (int n = 0; n < 60; ++n) {
        const std::uint32_t width = n % 2 ? 64 : 1 + std::uint32_t(random() % 64);
        const std::uint32_t height = n % 2 ? 64 : 1 + std::uint32_t(random() % 64);
        const std::uint32_t count = 1 + std::uint32_t(random() % 300);
        std::vector<ScreenVertex> vertices;
        std::vector<Triangle> triangles;
        while (triangles.size() < count) {
            Point p[3];
            random_triangle(random, width, height, random_reach(random), p);
            // Many at the same depths, so that numbers decide; some beyond the far plane.
            const bool level = random() % 2;
            const double depth = double(random() % 8) / 8 - 0.1;
            for (int k = 0; k < 3; ++k)
                vertices.push_back(
                    vertex_at(p[k].x, p[k].y, width, height, 1, depth + (level ? 0 : 0.05 * k)));
            const std::uint32_t first = std::uint32_t(3 * triangles.size());
            triangles.push_back({first, first + 1, first + 2});
        }
        Seen expected;
        expected.depth.assign(rast::detail::tile_pixels + rast::detail::tile_padding, -1.0f);
        expected.number.assign(expected.depth.size(), rast::detail::id_none);
        for (std::uint32_t t = 0; t < count; ++t) {
            HitOptions options;
            options.level = SimdLevel::scalar;
            const Hits alone = count_hits(vertices, {triangles[t]}, width, height, options);
            for (std::uint32_t y = 0; y < height; ++y)
                for (std::uint32_t x = 0; x < width; ++x) {
                    const std::size_t from = std::size_t(y) * width + x, to = y * 64 + x;
                    if (alone.front[from] + alone.back[from] == 0) continue;
                    if (!(alone.nearest[from] > expected.depth[to])) continue;
                    expected.depth[to] = alone.nearest[from];
                    expected.number[to] = t;
                }
        }
        for (const SimdLevel level : test::every_level())
            for (const bool skip_hidden : {false, true})
                ASSERT_TRUE(seen_together(vertices, width, height, level, skip_hidden) == expected)
                    << n << " level " << int(level) << " skip " << skip_hidden;
    }
}

}  // namespace
