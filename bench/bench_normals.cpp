// Corner normals with everything they need (adjacency, face normals, hard edges) on the bumpy
// torus, beside OpenMesh's vertex normals. OpenMesh computes one normal a vertex and knows no hard
// edges here: it does less.
#include <benchmark/benchmark.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

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
