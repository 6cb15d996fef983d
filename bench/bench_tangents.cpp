// Tangent frames on the bumpy torus: indexed, as a soup, shuffled and with hard edges, one thread
// and two; growth and memory with the size; poles of high valence. bench/compare_tangents sets them
// beside Blender's and mikktspace's.
//
// Counters: per_triangle, time; bytes_per_triangle, the heap at its height beside input and output.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "heap_peak.h"
#include "prep/corner_normals.h"
#include "prep/tangents.h"
#include "torus.h"

namespace {

using Index = std::uint32_t;

void add_normals(prep::Mesh& mesh, double hard_degrees = 60) {
    const prep::MeshView view(mesh);
    const prep::Topology topology = prep::build_topology(view, {}, 0);
    const prep::FaceNormals faces = prep::face_normals(view, prep::Precision::accurate, 0);
    prep::HardEdgeOptions options;
    options.angle_degrees = hard_degrees;
    const auto hard = prep::hard_edges(view, topology, faces, options);
    mesh.normals = prep::corner_normals(view, topology, faces, *hard, {})->normals;
}

// Only the last mesh is kept: the large ones would not fit beside each other.
const prep::Mesh& torus(std::int64_t triangles) {
    static prep::Mesh mesh;
    static std::int64_t made = 0;
    if (made != triangles) {
        mesh = {};
        mesh = bench::bumpy_torus(bench::torus_size(std::uint64_t(triangles)));
        add_normals(mesh);
        made = triangles;
    }
    return mesh;
}

// Every corner has its own position, normal and UV.
prep::Mesh unshared(const prep::Mesh& mesh) {
    prep::Mesh soup;
    soup.face_offsets = mesh.face_offsets;
    prep::CornerLayer<glm::vec2>& uv = soup.uvs.emplace_back();
    for (Index c = 0; c < mesh.corner_count(); ++c) {
        soup.positions.push_back(mesh.positions[mesh.corner_vertices[c]]);
        soup.normals.values.push_back(mesh.normals.values[mesh.normals.indices[c]]);
        uv.values.push_back(mesh.uvs[0].values[mesh.uvs[0].indices[c]]);
        soup.corner_vertices.push_back(c);
    }
    soup.normals.indices = uv.indices = soup.corner_vertices;
    return soup;
}

// The same triangles in an order without neighbours.
prep::Mesh shuffled(prep::Mesh mesh) {
    const Index count = Index(mesh.face_count());
    std::mt19937 random(1);
    std::vector<Index> order(count);
    for (Index i = 0; i < count; ++i) order[i] = i;
    for (Index i = count; i-- > 1;) std::swap(order[i], order[random() % (i + 1)]);
    const prep::Mesh from = mesh;
    for (Index i = 0; i < 3 * count; ++i) {
        const Index c = 3 * order[i / 3] + i % 3;
        mesh.corner_vertices[i] = from.corner_vertices[c];
        mesh.normals.indices[i] = from.normals.indices[c];
        mesh.uvs[0].indices[i] = from.uvs[0].indices[c];
    }
    return mesh;
}

// An open disc around one vertex, bumpy, UVs seen from above (every dP/du alike) or around the pole
// (dP/du in all directions, so that no two opposite triangles share a half-space).
prep::Mesh pole(Index valence, bool around) {
    prep::Mesh mesh;
    mesh.face_offsets = {0};
    prep::CornerLayer<glm::vec2>& uv = mesh.uvs.emplace_back();
    mesh.positions = {{0, 0, 0}};
    uv.values = {{0.5f, 0.5f}};
    for (Index i = 0; i < valence; ++i) {
        const double a = 2 * std::numbers::pi * i / valence;
        const double x = std::cos(a), y = std::sin(a);
        mesh.positions.push_back({x, y, 0.05 * std::sin(8 * a)});
        uv.values.push_back(around ? glm::vec2(double(i) / valence, 1)
                                   : glm::vec2(0.5 + 0.5 * x, 0.5 - 0.5 * y));
        mesh.corner_vertices.insert(mesh.corner_vertices.end(), {0, i + 1, (i + 1) % valence + 1});
        mesh.face_offsets.push_back(3 * (i + 1));
    }
    mesh.normals.values = {{0, 0, 1}};
    mesh.normals.indices.assign(mesh.corner_count(), 0);
    uv.indices = mesh.corner_vertices;
    return mesh;
}

// Heap at its height beside the input and the result.
double extra_memory(const prep::TangentInput& input, const prep::TangentOptions& options) {
    const std::size_t before = bench::heap_bytes();
    bench::restart_heap_peak();
    const auto tangents = prep::corner_tangents(input, options);
    return double(bench::heap_peak() - before) -
           double(tangents->tangents.values.size() * sizeof(glm::vec4)) -
           double(tangents->tangents.indices.size() * sizeof(Index));
}

void run(benchmark::State& state, const prep::Mesh& mesh, int threads) {
    prep::TangentOptions options;
    options.threads = threads;
    const prep::TangentInput input{prep::MeshView(mesh)};
    const double extra = extra_memory(input, options);
    for (auto _ : state) {
        auto tangents = prep::corner_tangents(input, options);
        benchmark::DoNotOptimize(tangents);
    }
    const double triangles = double(mesh.face_count());
    state.counters["bytes_per_triangle"] = extra / triangles;
    state.counters["per_triangle"] = benchmark::Counter(
        triangles, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void indexed(benchmark::State& state) {
    run(state, torus(state.range(0)), int(state.range(1)));
}

void soup(benchmark::State& state) {
    const prep::Mesh mesh = unshared(torus(state.range(0)));
    run(state, mesh, int(state.range(1)));
}

void in_random_order(benchmark::State& state) {
    const prep::Mesh mesh = shuffled(torus(state.range(0)));
    run(state, mesh, int(state.range(1)));
}

// Most vertices are split.
void hard_edges(benchmark::State& state) {
    prep::Mesh mesh = bench::bumpy_torus(bench::torus_size(std::uint64_t(state.range(0))));
    add_normals(mesh, 8);
    run(state, mesh, int(state.range(1)));
}

// None is: what is left of a small mesh's time.
void no_hard_edges(benchmark::State& state) {
    prep::Mesh mesh = bench::bumpy_torus(bench::torus_size(std::uint64_t(state.range(0))));
    add_normals(mesh, 180);
    run(state, mesh, int(state.range(1)));
}

void pole_seen_from_above(benchmark::State& state) {
    run(state, pole(Index(state.range(0)), false), int(state.range(1)));
}

void pole_with_uvs_around(benchmark::State& state) {
    run(state, pole(Index(state.range(0)), true), int(state.range(1)));
}

void sizes(benchmark::internal::Benchmark* benchmark, std::initializer_list<std::int64_t> counts,
           std::initializer_list<std::int64_t> threads) {
    benchmark->ArgNames({"triangles", "threads"})->Unit(benchmark::kMillisecond);
    benchmark->UseRealTime()->MeasureProcessCPUTime();
    for (const std::int64_t count : counts)
        for (const std::int64_t t : threads) benchmark->Args({count, t});
}

BENCHMARK(indexed)->Apply([](auto* b) { sizes(b, {10'000, 100'000, 980'000, 4'000'000}, {1, 2}); });
BENCHMARK(soup)->Apply([](auto* b) { sizes(b, {980'000}, {1, 2}); });
BENCHMARK(in_random_order)->Apply([](auto* b) { sizes(b, {980'000}, {1, 2}); });
BENCHMARK(hard_edges)->Apply([](auto* b) { sizes(b, {46'000}, {1}); });
BENCHMARK(no_hard_edges)->Apply([](auto* b) { sizes(b, {10'000}, {1}); });
BENCHMARK(pole_seen_from_above)->Apply([](auto* b) { sizes(b, {100'000}, {1}); });
BENCHMARK(pole_with_uvs_around)->Apply([](auto* b) { sizes(b, {100'000}, {1}); });
// Last: its mesh alone takes 2 GB.
BENCHMARK(indexed)->Name("indexed_large")->Apply([](auto* b) { sizes(b, {16'000'000}, {1}); });

}  // namespace

int main(int argc, char** argv) {
    // As in a process that has been at work for a while: freed memory is used again.
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    benchmark::Initialize(&argc, argv);
    // Another size of the torus, for compare_tangents.
    if (const char* triangles = std::getenv("TORUS_TRIANGLES"))
        sizes(benchmark::RegisterBenchmark("of_any_size", indexed), {std::atoll(triangles)},
              {1, 2});
    benchmark::RunSpecifiedBenchmarks();
}
