// Corner normals with everything they need (adjacency, face normals, hard edges) on the bumpy
// torus, beside OpenMesh's vertex normals. OpenMesh computes one normal a vertex and knows no hard
// edges here: it does less.
#include <benchmark/benchmark.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <optional>

#include "prep/corner_normals.h"
#include "torus.h"

namespace {

const prep::Mesh& torus(std::int64_t triangles) {
    static prep::Mesh mesh;
    static std::int64_t made = 0;
    if (made != triangles) mesh = bench::bumpy_torus(bench::torus_size(std::uint64_t(triangles)));
    made = triangles;
    return mesh;
}

void report(benchmark::State& state) {
    state.counters["triangles"] =
        benchmark::Counter(double(state.range(0)), benchmark::Counter::kIsIterationInvariantRate);
}

void crease_normals(benchmark::State& state, prep::Precision precision) {
    const prep::Mesh& mesh = torus(state.range(0));
    const prep::MeshView view(mesh);
    const int threads = int(state.range(1));
    for (auto _ : state) {
        const prep::Topology topology = prep::build_topology(view, {}, threads);
        const prep::FaceNormals faces = prep::face_normals(view, precision, threads);
        prep::HardEdgeOptions edges;
        edges.threads = threads;
        const auto hard = prep::hard_edges(view, topology, faces, edges);
        prep::NormalOptions options;
        options.precision = precision;
        options.threads = threads;
        auto normals = prep::corner_normals(view, topology, faces, *hard, options);
        benchmark::DoNotOptimize(normals);
    }
    report(state);
}

// The same bits from raw indexed triangles in one call, the weld included or not.
void crease_normals_at_once(benchmark::State& state, prep::Precision precision, bool weld,
                            std::optional<double> angle = 60.0) {
    const prep::Mesh& mesh = torus(state.range(0));
    const prep::MeshView view(mesh);
    prep::NormalOptions options;
    options.precision = precision;
    options.threads = int(state.range(1));
    prep::HardEdgeOptions edges;
    edges.angle_degrees = angle;
    for (auto _ : state) {
        std::vector<std::uint32_t> welded;
        if (weld) welded = prep::weld_exact(view.positions, options.threads);
        auto normals = prep::crease_normals(view, welded, edges, options);
        benchmark::DoNotOptimize(normals);
    }
    report(state);
}

// One normal a vertex, no edge looked at.
void vertex_normals(benchmark::State& state, prep::Precision precision) {
    const prep::Mesh& mesh = torus(state.range(0));
    const prep::MeshView view(mesh);
    prep::VertexNormalOptions options;
    options.precision = precision;
    options.threads = int(state.range(1));
    for (auto _ : state) {
        auto normals = prep::vertex_normals(view, options);
        benchmark::DoNotOptimize(normals);
    }
    report(state);
}

void openmesh_vertex_normals(benchmark::State& state, bool with_building) {
    using Halfedges = OpenMesh::TriMesh_ArrayKernelT<>;
    const prep::Mesh& mesh = torus(state.range(0));
    const auto build = [&] {
        Halfedges result;
        result.request_face_normals();
        result.request_vertex_normals();
        std::vector<Halfedges::VertexHandle> vertices;
        for (const glm::vec3& p : mesh.positions)
            vertices.push_back(result.add_vertex({p.x, p.y, p.z}));
        for (std::size_t c = 0; c < mesh.corner_count(); c += 3)
            result.add_face(vertices[mesh.corner_vertices[c]],
                            vertices[mesh.corner_vertices[c + 1]],
                            vertices[mesh.corner_vertices[c + 2]]);
        return result;
    };
    Halfedges halfedges = build();
    for (auto _ : state) {
        if (with_building) halfedges = build();
        halfedges.update_normals();
        benchmark::ClobberMemory();
    }
    report(state);
}

BENCHMARK_CAPTURE(crease_normals, accurate, prep::Precision::accurate)
    ->ArgsProduct({{98'000, 980'000}, {1, 2}})
    ->ArgNames({"triangles", "threads"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(crease_normals, fast, prep::Precision::fast)
    ->ArgsProduct({{980'000}, {1, 2}})
    ->ArgNames({"triangles", "threads"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(crease_normals_at_once, accurate, prep::Precision::accurate, false)
    ->ArgsProduct({{980'000, 4'000'000}, {1, 2}})
    ->ArgNames({"triangles", "threads"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(crease_normals_at_once, accurate_smooth, prep::Precision::accurate, false,
                  std::nullopt)
    ->ArgsProduct({{980'000}, {1, 2}})
    ->ArgNames({"triangles", "threads"})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(crease_normals_at_once, fast, prep::Precision::fast, false)
    ->ArgsProduct({{980'000}, {1, 2}})
    ->ArgNames({"triangles", "threads"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(crease_normals_at_once, accurate_welded, prep::Precision::accurate, true)
    ->ArgsProduct({{980'000}, {1, 2}})
    ->ArgNames({"triangles", "threads"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(vertex_normals, accurate, prep::Precision::accurate)
    ->ArgsProduct({{980'000, 4'000'000}, {1, 2}})
    ->ArgNames({"triangles", "threads"})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(vertex_normals, fast, prep::Precision::fast)
    ->ArgsProduct({{980'000, 4'000'000}, {1, 2}})
    ->ArgNames({"triangles", "threads"})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(openmesh_vertex_normals, on_its_mesh, false)
    ->Args({980'000})
    ->ArgNames({"triangles"})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(openmesh_vertex_normals, with_its_mesh, true)
    ->Args({980'000})
    ->ArgNames({"triangles"})
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
