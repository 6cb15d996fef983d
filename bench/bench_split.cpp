// Splitting corners into vertices, beside meshoptimizer's vertex remap on the same corners (which
// knows no layers and gives no reasons: it does less).
#include <benchmark/benchmark.h>
#include <meshoptimizer.h>

#include <vector>

#include "prep/prepare.h"
#include "prep/split_vertices.h"
#include "torus.h"

namespace {

// The torus with normals and tangents, as prepare() hands it to split().
const prep::Mesh& prepared_torus() {
    static const prep::Mesh mesh = [] {
        prep::Scene scene;
        scene.meshes.push_back(bench::bumpy_torus(bench::torus_size(980'000)));
        prep::PrepareOptions options;
        options.request.tangents = prep::Request::Level::always;
        return std::move(prep::prepare(std::move(scene), options).value().scene.meshes[0]);
    }();
    return mesh;
}

void report(benchmark::State& state, const prep::Mesh& mesh) {
    state.counters["faces"] = benchmark::Counter(double(mesh.face_count()),
                                                 benchmark::Counter::kIsIterationInvariantRate);
}

void split(benchmark::State& state) {
    const prep::Mesh& mesh = prepared_torus();
    prep::SplitOptions options;
    options.threads = int(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(prep::split(mesh, nullptr, options));
    report(state, mesh);
}

void meshoptimizer_remap(benchmark::State& state) {
    const prep::Mesh& mesh = prepared_torus();
    struct Vertex {
        glm::vec3 position, normal;
        glm::vec4 tangent;
        glm::vec2 uv;
    };
    const std::size_t corners = mesh.corner_count();
    for (auto _ : state) {
        std::vector<Vertex> soup(corners);
        for (std::size_t c = 0; c < corners; ++c)
            soup[c] = {mesh.positions[mesh.corner_vertices[c]],
                       mesh.normals.values[mesh.normals.indices[c]],
                       mesh.tangents.values[mesh.tangents.indices[c]],
                       mesh.uvs[0].values[mesh.uvs[0].indices[c]]};
        std::vector<unsigned> remap(corners), indices(corners);
        const std::size_t count = meshopt_generateVertexRemap(remap.data(), nullptr, corners,
                                                              soup.data(), corners, sizeof(Vertex));
        std::vector<Vertex> vertices(count);
        meshopt_remapVertexBuffer(vertices.data(), soup.data(), corners, sizeof(Vertex),
                                  remap.data());
        meshopt_remapIndexBuffer(indices.data(), nullptr, corners, remap.data());
        benchmark::DoNotOptimize(vertices.data());
        benchmark::DoNotOptimize(indices.data());
    }
    report(state, mesh);
}

BENCHMARK(split)->Arg(1)->Arg(2)->ArgName("threads")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(meshoptimizer_remap)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
