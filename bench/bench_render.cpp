// The rasterizer, stage by stage and as whole pictures of the bumpy torus at 1920×1080.
// bench/compare_llvmpipe sets whole pictures beside llvmpipe's.
//
// Counters, per second: Mtri (triangles submitted), Mpx (pixels shaded, or covered by triangles
// that are only rasterized). One thread unless it says otherwise.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "frame/renderer.h"
#include "torus_scene.h"

namespace {

using namespace rast::detail;

const prep::PreparedScene& torus(std::int64_t triangles) {
    static prep::PreparedScene scene;
    static std::int64_t made = 0;
    if (made != triangles)
        scene = bench::torus_scene(std::uint64_t(triangles), bench::diffuse_image(),
                                   bench::normal_image());
    made = triangles;
    return scene;
}

benchmark::Counter rate(double per_iteration) {
    return {per_iteration, benchmark::Counter::kIsIterationInvariantRate};
}

void draw_pictures(benchmark::State& state, const prep::PreparedScene& scene,
                   const rast::RenderRequest& request) {
    rast::SceneRenderer renderer(scene);
    rast::Frame frame;
    const rast::RenderPlan plan = *rast::plan(scene, request);
    double geometry = 0;
    if (!renderer.render(plan, frame)) std::abort();  // loads textures
    for (auto _ : state) {
        if (!renderer.render(plan, frame)) std::abort();
        geometry += frame.geometry_ms;
    }
    state.counters["geometry_ms"] = geometry / double(state.iterations());
    state.counters["pixels"] = rate(double(frame.counters.pixels_shaded));
    state.counters["triangles"] = rate(double(frame.counters.triangles));
}

void picture(benchmark::State& state, bool mapped) {
    const prep::PreparedScene& scene = torus(state.range(0));
    rast::RenderRequest request = bench::torus_request(scene, mapped);
    request.threads = int(state.range(1));
    draw_pictures(state, scene, request);
}
void phong(benchmark::State& state) {
    picture(state, false);
}
void normal_mapped(benchmark::State& state) {
    picture(state, true);
}
void sizes(benchmark::internal::Benchmark* b) {
    b->ArgNames({"triangles", "threads"})->Unit(benchmark::kMillisecond)->UseRealTime();
    for (const std::int64_t triangles : {5000, 100352, 980000})
        for (const std::int64_t threads : {1, 2}) b->Args({triangles, threads});
}
BENCHMARK(phong)->Apply(sizes);
BENCHMARK(normal_mapped)->Apply(sizes);

// Phong with a diffuse map through each filter, few triangles.
void filtered(benchmark::State& state, rast::TextureFilter filter) {
    const prep::PreparedScene& scene = torus(5000);
    rast::RenderRequest request = bench::torus_request(scene, true);
    request.shading = rast::Shading::phong;
    request.filter = filter;
    request.threads = 1;
    draw_pictures(state, scene, request);
}
using rast::TextureFilter;
BENCHMARK_CAPTURE(filtered, nearest, TextureFilter::nearest)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(filtered, bilinear, TextureFilter::bilinear)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(filtered, trilinear, TextureFilter::trilinear)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(filtered, bicubic, TextureFilter::bicubic)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(filtered, anisotropic8, TextureFilter::anisotropic)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(filtered, ripmap, TextureFilter::ripmap)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(filtered, ewa, TextureFilter::ewa)->Unit(benchmark::kMillisecond);

Window window_of(std::int32_t width, std::int32_t height) {
    Window w;
    w.width = width;
    w.height = height;
    w.first_x = (1 - width) * (subpixels / 2);
    w.first_y = (1 - height) * (subpixels / 2);
    w.tiles_x = (width + tile_size - 1) / tile_size;
    w.tiles_y = (height + tile_size - 1) / tile_size;
    return w;
}

// Transformed vertices to survivors: a mesh so fine that nearly all triangles fall between samples.
void cull_micro_triangles(benchmark::State& state) {
    const prep::PreparedScene& scene = torus(980000);
    const Window window = window_of(240, 135);
    const rast::View view = *bench::torus_request(scene, false).view;
    const Kernels& kernels = kernels_for(prep::SimdLevel::automatic);
    RenderInstance instance(scene.meshes[0], 0, glm::dmat4(1.0), view, 240, 135);
    instance.transform(kernels, 0, scene.meshes[0].vertex_count());
    CullResult survivors;
    std::uint64_t kept = 0;
    const std::uint32_t triangles = std::uint32_t(scene.meshes[0].triangle_count());
    for (auto _ : state) {
        kept = 0;
        CullCounts counts;
        for (std::uint32_t first = 0; first < triangles; first += chunk_triangles) {
            CullTask task;
            task.records = instance.records.data();
            task.indices = scene.meshes[0].indices.data() + std::size_t(first) * 3;
            task.count = std::min(chunk_triangles, triangles - first);
            task.window = window;
            kept += kernels.cull(task, survivors, counts);
        }
    }
    state.counters["triangles"] = rate(triangles);
    state.counters["kept_%"] = 100.0 * double(kept) / triangles;
}
BENCHMARK(cull_micro_triangles)->Unit(benchmark::kMillisecond);

class NoSource final : public VertexSource {
  public:
    ScreenVertex homogeneous(std::uint32_t) const override { return {}; }
};

// Set up, binned and rasterized with depth, unshaded: triangles of `area` pixels all over the
// picture.
void visibility(benchmark::State& state) {
    const double area = double(state.range(0));
    const Window window = window_of(bench::width, bench::height);
    const std::uint32_t count = area < 1000 ? chunk_triangles * 4 : 1024;
    std::mt19937 random(1);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * double(random()) / 4294967296.0;
    };
    std::vector<VertexRecord> records;
    std::vector<std::uint32_t> indices;
    const double side = std::sqrt(area * 4 / std::sqrt(3.0)), reach = side / std::sqrt(3.0);
    for (std::uint32_t t = 0; t < count; ++t) {
        const double turn = uniform(0, 6.28), z = uniform(0.1, 0.9);
        const double x = uniform(-960 + reach, 960 - reach), y = uniform(-540 + reach, 540 - reach);
        for (int k = 0; k < 3; ++k) {
            const double angle = turn + 2.0943951 * k;
            indices.push_back(std::uint32_t(records.size()));
            records.push_back(record_of({x + reach * std::cos(angle), y + reach * std::sin(angle),
                                         z + 0.05 * std::cos(angle), 1}));
        }
    }
    const NoSource source;
    const DrawGeometry geometry{&source, records.data(), indices.data(), false, CullSide::none};
    const Kernels& kernels = kernels_for(prep::SimdLevel::automatic);
    BinScratch scratch;
    std::vector<TriangleChunk> chunks;
    for (std::uint32_t first = 0; first < count; first += chunk_triangles) {
        chunks.emplace_back();
        chunks.back().first_triangle = first;
        chunks.back().count = std::min(chunk_triangles, count - first);
    }
    std::vector<std::vector<TileWork>> work(window.tile_count());
    TileSamples samples;
    for (auto _ : state) {
        for (auto& w : work) w.clear();
        for (std::uint32_t c = 0; c < chunks.size(); ++c) {
            set_up_chunk(geometry, window, false, kernels, scratch, chunks[c]);
            for (const TileSlice& s : chunks[c].slices) work[s.tile].push_back({c, s.begin, s.end});
        }
        for (std::uint32_t tile = 0; tile < work.size(); ++tile) {
            const std::int32_t x = std::int32_t(tile) % window.tiles_x * tile_size;
            const std::int32_t y = std::int32_t(tile) / window.tiles_x * tile_size;
            const TilePlace place{window.first_x + x * subpixels,
                                  window.first_y + y * subpixels,
                                  std::min(tile_size, window.width - x),
                                  std::min(tile_size, window.height - y),
                                  {},
                                  true};
            samples.clear();
            std::uint32_t number = 0;
            for (const TileWork& w : work[tile]) {
                raster_slice(chunks[w.chunk], w.begin, w.end, number, {&place, 1}, nullptr, kernels,
                             {&samples, 1});
                number += w.end - w.begin;
            }
        }
    }
    state.counters["triangles"] = rate(count);
    state.counters["pixels"] = rate(count * area);
}
BENCHMARK(visibility)
    ->ArgName("pixels")
    ->Arg(10)
    ->Arg(50)
    ->Arg(5000)
    ->Arg(50000)
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
