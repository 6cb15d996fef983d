// Reading an OBJ of a million triangles with UVs, beside Assimp's and OpenMesh's readers.
#include <assimp/scene.h>
#include <benchmark/benchmark.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <assimp/Importer.hpp>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "prep/load.h"

namespace {

// The file that generate_torus made, named by the environment variable MESHPREP_BENCH_OBJ.
const std::string& file() {
    static const std::string path = [] {
        const char* named = std::getenv("MESHPREP_BENCH_OBJ");
        if (!named) {
            std::fprintf(stderr,
                         "bench_obj: set MESHPREP_BENCH_OBJ to a file made by generate_torus\n");
            std::exit(2);
        }
        return std::string(named);
    }();
    return path;
}

void meshprep(benchmark::State& state) {
    prep::LoadOptions options;
    options.threads = int(state.range(0));
    for (auto _ : state) {
        auto scene = prep::load_scene(file(), options);
        if (!scene) state.SkipWithError(prep::to_string(scene.error()).c_str());
        benchmark::DoNotOptimize(scene);
    }
}

void assimp(benchmark::State& state) {
    for (auto _ : state) {
        Assimp::Importer importer;
        if (!importer.ReadFile(file(), 0)) state.SkipWithError(importer.GetErrorString());
    }
}

void openmesh(benchmark::State& state) {
    for (auto _ : state) {
        OpenMesh::TriMesh_ArrayKernelT<> mesh;
        if (!OpenMesh::IO::read_mesh(mesh, file())) state.SkipWithError("cannot read");
    }
}

BENCHMARK(meshprep)->Arg(1)->Arg(2)->ArgName("threads")->UseRealTime()->Unit(
    benchmark::kMillisecond);
BENCHMARK(assimp)->Unit(benchmark::kMillisecond);
BENCHMARK(openmesh)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
