// Triangles behind the near plane or beyond the guard band, drawn by blocks, against each pixel
// looked at by itself.
#include "coverage/homogeneous_raster.h"
#include "hits.h"

namespace {

using namespace rast::detail;

CrossingTriangle random_triangle(std::mt19937& random, bool& drawn) {
    std::uniform_real_distribution<double> place(-1, 1);
    std::uniform_int_distribution<int> kind(0, 3);
    std::vector<ScreenVertex> vertices;
    for (int k = 0; k < 3; ++k) {
        // In the tile, near the guard band, far beyond it, behind the eye.
        static constexpr double reach[] = {60, 2e4, 1e9, 80};
        const int at = kind(random);
        const double w = at == 3 ? -0.3 : 1 + 0.5 * place(random);
        vertices.push_back({place(random) * reach[at] * w, place(random) * reach[at] * w,
                            (0.5 + 0.5 * place(random)) * std::abs(w), w});
    }
    std::vector<VertexRecord> records;
    for (const ScreenVertex& v : vertices) records.push_back(record_of(v));
    const hits::Given source(vertices);
    const std::uint32_t corners[3] = {0, 1, 2};
    CrossingTriangle t;
    drawn = set_up_crossing(source, records.data(), corners, t) == CrossingOutcome::drawn;
    return t;
}

// Sample by sample, without blocks; of equal depths the lower number.
void draw_each(TileSamples& samples, const TilePlace& place, const CrossingTriangle& t,
               std::uint32_t number) {
    for (std::int32_t j = 0; j < place.height; ++j)
        for (std::int32_t i = 0; i < place.width; ++i) {
            const double x = double(place.x + i * subpixels) / subpixels;
            const double y = double(place.y + j * subpixels) / subpixels;
            if (x < std::floor(t.low_x) - 1 || x > std::ceil(t.high_x) + 1 ||
                y < std::floor(t.low_y) - 1 || y > std::ceil(t.high_y) + 1)
                continue;
            bool inside = true;
            for (const CrossingEdge& e : t.edges) inside = inside && e.inside(e.value(x, y));
            const CrossingPlane& p = t.plane;
            const double exact = std::clamp(
                p.depth + (p.depth_x * (x - p.px) + p.depth_y * (y - p.py)), p.low, p.high);
            if (!inside || !(exact >= 0 && exact <= 1)) continue;
            const std::size_t at = std::size_t(j) * tile_size + std::size_t(i);
            const float depth = place.grid(float(exact));
            if (depth < samples.depth[at] ||
                (depth == samples.depth[at] && number >= samples.id[at]))
                continue;
            samples.depth[at] = depth;
            samples.id[at] = number;
        }
}

TEST(Crossing, BlocksDrawWhatEachPixelAloneDraws) {
    std::mt19937 random(5);
    const Kernels& kernels = kernels_for(prep::SimdLevel::scalar);
    std::size_t covered = 0;
    for (int round = 0; round < 400; ++round) {
        TilePlace place{-32 * subpixels + 37, -32 * subpixels - 11};
        place.width = round % 3 == 0 ? 41 : tile_size;
        place.height = round % 5 == 0 ? 23 : tile_size;
        place.grid = round % 4 == 0 ? fixed16_grid : round % 4 == 1 ? fixed24_grid : DepthGrid{};
        place.skip_hidden = round % 2 == 0;
        TileSamples blocks, each;
        blocks.clear();
        each.clear();
        CrossingTriangle last;
        for (std::uint32_t k = 0; k < 12; ++k) {
            const std::uint32_t number = round % 7 == 0 ? 12 - k : k;
            bool drawn = false;
            CrossingTriangle t = random_triangle(random, drawn);
            if (k % 4 == 3) t = last;  // equal depths
            if (!drawn) continue;
            last = t;
            raster_crossing(blocks.depth.data(), blocks.id.data(), place, t, number, nullptr,
                            kernels);
            draw_each(each, place, t, number);
        }
        ASSERT_EQ(blocks.id, each.id) << round;
        ASSERT_EQ(blocks.depth, each.depth) << round;
        covered +=
            each.id.size() - std::size_t(std::count(each.id.begin(), each.id.end(), id_none));
    }
    EXPECT_GT(covered, 400u * 1000u);
}

}  // namespace
