// Pictures drawn in bands of rows against the same pictures drawn at once.
#include <gtest/gtest.h>

#include <cstring>

#include "builders.h"
#include "sanitized.h"

namespace {

template <class T>
bool rows_equal(const std::vector<T>& whole, const std::vector<T>& band, std::size_t first) {
    if (whole.empty() || band.empty()) return whole.empty() == band.empty();
    return std::memcmp(whole.data() + first, band.data(), band.size() * sizeof(T)) == 0;
}

rast::RenderPlan plan_of(const prep::PreparedScene& scene, const rast::RenderRequest& request) {
    auto plan = rast::plan(scene, request);
    EXPECT_TRUE(plan) << to_string(plan.error());
    return *std::move(plan);
}

TEST(Bands, JoinToTheWholePictureBitForBit) {
    prep::Material material;
    const prep::PreparedScene scene = test::scene_of(test::sphere(60, 40), material);
    rast::RenderRequest request;
    request.width = 301;
    request.height = 257;
    request.keep_depth = request.keep_ids = request.keep_normals = request.keep_uvs = true;
    request.keep_barycentrics = request.keep_positions = true;
    for (const int samples : {1, 4}) {
        request.samples = samples;
        const rast::Frame whole = test::draw(scene, request);
        const std::uint64_t row = 301 * 72;
        for (const std::uint64_t rows : {1u, 7u, 64u, 100u, 1000u}) {
            request.band_bytes = rows * row;
            const rast::RenderPlan plan = plan_of(scene, request);
            EXPECT_EQ(plan.band_rows, rows == 100 ? 64 : std::min<std::uint64_t>(rows, 257));
            std::uint32_t next = 0;
            const auto done =
                rast::render_bands(scene, plan, [&](const rast::Frame& band, std::uint32_t first) {
                    EXPECT_EQ(first, next);
                    next += band.height;
                    const std::size_t at = std::size_t(first) * 301;
                    EXPECT_EQ(band.width, 301u);
                    EXPECT_EQ(band.color.size(), std::size_t(301) * band.height);
                    EXPECT_TRUE(rows_equal(whole.color, band.color, at)) << rows << " " << first;
                    EXPECT_TRUE(rows_equal(whole.depth, band.depth, at));
                    EXPECT_TRUE(rows_equal(whole.triangle, band.triangle, at));
                    EXPECT_TRUE(rows_equal(whole.instance, band.instance, at));
                    EXPECT_TRUE(rows_equal(whole.normal, band.normal, at));
                    EXPECT_TRUE(rows_equal(whole.uv, band.uv, at));
                    EXPECT_TRUE(rows_equal(whole.barycentric, band.barycentric, at));
                    EXPECT_TRUE(rows_equal(whole.position, band.position, at));
                    return prep::Result<void>();
                });
            ASSERT_TRUE(done);
            EXPECT_EQ(next, 257u);
            EXPECT_EQ(done->counters.pixels_shaded, whole.counters.pixels_shaded);
            if (rows < 64) continue;
            // Sorted by tile once, not once for each band.
            EXPECT_EQ(done->counters.triangles, whole.counters.triangles);
            EXPECT_EQ(done->counters.facing_away, whole.counters.facing_away);
            EXPECT_EQ(done->counters.outside, whole.counters.outside);
        }
    }
}

TEST(Bands, OfACropAreItsRows) {
    const prep::PreparedScene scene = test::scene_of(test::sphere(60, 40), prep::Material{});
    rast::RenderRequest request;
    request.width = 200;
    request.height = 160;
    const rast::Frame whole = test::draw(scene, request);
    request.crop = rast::Crop{30, 41, 120, 90};
    for (const std::uint64_t rows : {1u, 7u, 64u}) {
        request.band_bytes = rows * 120 * 16;
        std::uint32_t next = 0;
        const auto done = rast::render_bands(
            scene, plan_of(scene, request), [&](const rast::Frame& band, std::uint32_t first) {
                EXPECT_EQ(first, next);
                next += band.height;
                for (std::uint32_t y = 0; y < band.height; ++y)
                    for (std::uint32_t x = 0; x < 120; ++x)
                        EXPECT_EQ(band.color[y * 120 + x],
                                  whole.color[(41 + first + y) * 200 + 30 + x]);
                return prep::Result<void>();
            });
        ASSERT_TRUE(done);
        EXPECT_EQ(next, 90u);
    }
}

TEST(Bands, OfExactAreasAndSupersamplingJoinAsWell) {
    const prep::PreparedScene scene = test::scene_of(test::sphere(30, 20), prep::Material{});
    for (const bool areas : {false, true}) {
        rast::RenderRequest request;
        request.width = 90;
        request.height = 200;
        if (areas)
            request.coverage = rast::Coverage::area;
        else
            request.supersample = 3;
        const rast::Frame whole = test::draw(scene, request);
        request.band_bytes = 64 * 90 * 16;
        const auto done = rast::render_bands(
            scene, plan_of(scene, request), [&](const rast::Frame& band, std::uint32_t first) {
                EXPECT_EQ(band.height, first == 192 ? 8u : 64u);
                EXPECT_TRUE(rows_equal(whole.color, band.color, std::size_t(first) * 90));
                return prep::Result<void>();
            });
        ASSERT_TRUE(done);
        EXPECT_EQ(done->counters.triangles, whole.counters.triangles);
    }
}

TEST(Bands, AnErrorOfTheReceiverEndsThem) {
    const prep::PreparedScene scene = test::scene_of(test::sphere(8, 8));
    rast::RenderRequest request;
    request.width = request.height = 256;
    request.band_bytes = 64 * 256 * 16;
    int calls = 0;
    const auto done =
        rast::render_bands(scene, plan_of(scene, request), [&](const rast::Frame&, std::uint32_t) {
            ++calls;
            return prep::Result<void>(prep::Error{prep::ErrorCode::io, "full", "disk"});
        });
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().text, "full");
    EXPECT_EQ(calls, 1);
}

TEST(Bands, ThePlanBoundsTheirMemory) {
    const prep::PreparedScene scene = test::scene_of(test::sphere(8, 8));
    rast::RenderRequest request;
    request.width = request.height = 16384;
    const rast::RenderPlan plan = plan_of(scene, request);
    // 16 bytes a pixel: 4 GiB at once; in bands no more than was allowed, and little geometry.
    EXPECT_GE(plan.memory_estimate, std::uint64_t(1) << 32);
    EXPECT_EQ(plan.band_rows, 256u);
    EXPECT_LE(plan.band_memory_estimate, request.band_bytes + (std::uint64_t(1) << 20));
}

// Every triangle reaches every tile: what the lists take grows with the picture, not the mesh.
prep::PreparedScene layers(std::uint32_t count) {
    prep::VertexMesh mesh;
    for (std::uint32_t l = 0; l < count; ++l) {
        const float z = float(l) * 1e-3f;
        for (const auto& [x, y] :
             {std::pair{-3.0f, -3.0f}, {3.0f, -3.0f}, {3.0f, 3.0f}, {-3.0f, 3.0f}}) {
            mesh.positions.emplace_back(x, y + 0.01f * float(l % 7), z);
            mesh.normals.emplace_back(0.0f, 0.0f, 1.0f);
        }
        for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u})
            mesh.indices.push_back(4 * l + corner);
    }
    prep::Material material;
    material.double_sided = true;
    return test::scene_of(std::move(mesh), material);
}

TEST(Bands, ListsOfTrianglesStayWithinTheirMemory) {
    constexpr std::uint32_t count = 500;
    const prep::PreparedScene scene = layers(count);
    rast::RenderRequest request;
    request.width = request.height = 1024;
    request.view = test::flat_view(2);
    request.pixels = rast::PixelFormat::bytes;
    request.keep_ids = true;
    const rast::Frame whole = test::draw(scene, request);
    EXPECT_EQ(whole.counters.outside + whole.counters.facing_away, 0u);
    // 256 tiles, 1,000 entries of 2 bytes each.
    EXPECT_GE(whole.counters.list_bytes, 512000u);
    for (const std::uint64_t allowed : {1u << 16, 1u << 18, 1u << 19}) {
        request.band_bytes = allowed;
        const rast::Frame parts = test::draw(scene, request);
        EXPECT_TRUE(rows_equal(whole.bytes, parts.bytes, 0)) << allowed;
        EXPECT_TRUE(rows_equal(whole.triangle, parts.triangle, 0)) << allowed;
        EXPECT_EQ(parts.counters.triangles, 2 * count);
        EXPECT_EQ(parts.counters.pixels_shaded, whole.counters.pixels_shaded);
        EXPECT_LE(parts.counters.list_bytes, allowed + 28 * 2 * count);
        std::uint64_t most = 0;
        const auto done = rast::render_bands(
            scene, plan_of(scene, request), [&](const rast::Frame& band, std::uint32_t first) {
                EXPECT_TRUE(rows_equal(whole.bytes, band.bytes, std::size_t(first) * 1024));
                EXPECT_TRUE(rows_equal(whole.triangle, band.triangle, std::size_t(first) * 1024));
                most = std::max(most, band.counters.list_bytes);
                return prep::Result<void>();
            });
        ASSERT_TRUE(done);
        EXPECT_GT(most, 0u);
        EXPECT_LE(most, allowed + 28 * 2 * count) << allowed;
    }
}

// Several chunks, triangles beyond the guard band, bands of several rows of tiles that begin and
// end within groups: what is listed for one band serves the next.
TEST(Bands, ShareTheListsOfGroupsOfRows) {
    prep::PreparedScene scene = layers(3000);
    prep::VertexMesh& mesh = scene.meshes[0];
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        if (v / 4 % 3 == 0) mesh.positions[v] *= glm::vec3(1e5f, 1e5f, 1.0f);
    rast::RenderRequest request;
    request.width = 256;
    request.height = 640;
    request.view = test::flat_view(2);
    request.pixels = rast::PixelFormat::bytes;
    for (const int samples : {1, 2}) {
        if (test::sanitized && samples > 1) break;
        request.samples = samples;
        request.band_bytes = std::uint64_t(1) << 30;
        const rast::Frame whole = test::draw(scene, request);
        EXPECT_GT(whole.counters.crossing, 1000u);
        // 128 rows of pixels; lists of 40 tiles and 6,000 entries.
        request.band_bytes = 128 * 256 * 4;
        const rast::RenderPlan plan = plan_of(scene, request);
        EXPECT_EQ(plan.band_rows, 128u);
        EXPECT_GT(whole.counters.list_bytes, request.band_bytes + 28 * 6000);
        std::uint64_t most = 0;
        const auto done =
            rast::render_bands(scene, plan, [&](const rast::Frame& band, std::uint32_t first) {
                EXPECT_TRUE(rows_equal(whole.bytes, band.bytes, std::size_t(first) * 256));
                most = std::max(most, band.counters.list_bytes);
                return prep::Result<void>();
            });
        ASSERT_TRUE(done);
        EXPECT_EQ(done->counters.triangles, whole.counters.triangles);
        EXPECT_EQ(done->counters.crossing, whole.counters.crossing);
        EXPECT_EQ(done->counters.pixels_shaded, whole.counters.pixels_shaded);
        EXPECT_GT(most, 0u);
        EXPECT_LE(most, request.band_bytes + 28 * 6000);
    }
}

}  // namespace
