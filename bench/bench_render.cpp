// The rasterizer on the bumpy torus at 1920×1080, whole pictures. bench/compare_llvmpipe sets them
// beside llvmpipe's.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include "torus_scene.h"

namespace {

const prep::PreparedScene& torus(std::int64_t triangles) {
    static prep::PreparedScene scene;
    static std::int64_t made = 0;
    if (made != triangles)
        scene = bench::torus_scene(std::uint64_t(triangles), bench::diffuse_image(),
                                   bench::normal_image());
    made = triangles;
    return scene;
}

void picture(benchmark::State& state, bool mapped) {
    const prep::PreparedScene& scene = torus(state.range(0));
    rast::RenderRequest request = bench::torus_request(scene, mapped);
    request.threads = int(state.range(1));
    if (const char* level = std::getenv("SIMD")) request.simd = prep::SimdLevel(std::atoi(level));
    rast::SceneRenderer renderer(scene);
    rast::Frame frame;
    double geometry = 0;
    for (auto _ : state) {
        if (!renderer.render(*rast::plan(scene, request), frame)) std::abort();
        geometry += frame.geometry_ms;
    }
    const double frames = double(state.iterations());
    state.counters["geometry_ms"] = geometry / frames;
    state.counters["Mpx/s"] = benchmark::Counter(double(frame.counters.pixels_shaded) * 1e-6,
                                                 benchmark::Counter::kIsIterationInvariantRate);
    state.counters["Mtri/s"] = benchmark::Counter(double(frame.counters.triangles) * 1e-6,
                                                  benchmark::Counter::kIsIterationInvariantRate);
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

}  // namespace

BENCHMARK_MAIN();
