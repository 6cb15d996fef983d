// Tangent frames on the bumpy torus: indexed, by vertex and as a soup; one thread and more; growth
// with the size; a pole of high valence.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <numbers>

#include "prep/corner_normals.h"
#include "prep/tangents.h"
#include "torus.h"

namespace {

using Index = std::uint32_t;

void add_normals(prep::Mesh& mesh) {
    const prep::MeshView view(mesh);
    const prep::Topology topology = prep::build_topology(view, {}, 0);
    const prep::FaceNormals faces = prep::face_normals(view, prep::Precision::accurate, 0);
    const auto hard = prep::hard_edges(view, topology, faces, {});
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

void report(benchmark::State& state, std::size_t triangles) {
    state.counters["Mtri/s"] =
        benchmark::Counter(double(triangles) / 1e6, benchmark::Counter::kIsIterationInvariantRate);
}

void run(benchmark::State& state, const prep::Mesh& mesh, const prep::TangentOptions& options) {
    const prep::TangentInput input{prep::MeshView(mesh)};
    for (auto _ : state) {
        auto tangents = prep::corner_tangents(input, options);
        benchmark::DoNotOptimize(tangents);
    }
    report(state, mesh.face_count());
}

void indexed(benchmark::State& state) {
    prep::TangentOptions options;
    options.threads = int(state.range(1));
    run(state, torus(state.range(0)), options);
}

void soup(benchmark::State& state) {
    prep::TangentOptions options;
    options.threads = int(state.range(1));
    const prep::Mesh mesh = unshared(torus(state.range(0)));
    run(state, mesh, options);
}

BENCHMARK(indexed)
    ->Args({980'000, 1})
    ->Args({980'000, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(soup)
    ->Args({980'000, 1})
    ->Args({980'000, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
