// render_large N WIDTH HEIGHT: a bumpy torus of 2 · N² triangles, made in memory, drawn in bands on
// two threads. Prints times, what the plan estimates and the most memory that the process held.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "rast/render.h"

namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

double most_memory() {  // GB
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("VmHWM:", 0) == 0) return std::atof(line.c_str() + 6) * 1024e-9;
    return 0;
}

prep::VertexMesh torus(std::uint32_t n) {
    prep::VertexMesh mesh;
    const float step = 6.2831853f / float(n);
    const std::size_t vertices = std::size_t(n) * n;
    mesh.positions.reserve(vertices);
    mesh.normals.reserve(vertices);
    mesh.indices.reserve(6 * vertices);
    for (std::uint32_t i = 0; i < n; ++i) {
        const float u = step * float(i), c = std::cos(u), s = std::sin(u);
        for (std::uint32_t j = 0; j < n; ++j) {
            const float v = step * float(j), across = std::cos(v), up = std::sin(v);
            const float r = 0.4f * (1 + 0.06f * std::sin(24 * u) * std::sin(16 * v));
            mesh.positions.emplace_back((1 + r * across) * c, r * up, -(1 + r * across) * s);
            mesh.normals.emplace_back(across * c, up, -across * s);
            const std::uint32_t next_i = (i + 1) % n * n, next_j = (j + 1) % n;
            for (const std::uint32_t k : {i * n + j, next_i + j, next_i + next_j, i * n + j,
                                          next_i + next_j, i * n + next_j})
                mesh.indices.push_back(k);
        }
    }
    mesh.ranges = {{0, std::uint32_t(2 * vertices), prep::no_index, prep::no_index}};
    return mesh;
}

}  // namespace

int main(int argc, char** argv) {
    const int n = argc > 1 ? std::atoi(argv[1]) : 5000;
    if (n < 3 || n > 20000) {
        std::fprintf(stderr, "render_large: N is from 3 to 20000\n");
        return 2;
    }
    prep::PreparedScene scene;
    scene.scene.meshes.resize(1);
    scene.meshes.push_back(torus(std::uint32_t(n)));
    prep::Node node;
    node.mesh = 0;
    scene.scene.nodes.push_back(node);
    rast::RenderRequest request;
    request.width = argc > 2 ? std::uint32_t(std::atoi(argv[2])) : 1920;
    request.height = argc > 3 ? std::uint32_t(std::atoi(argv[3])) : 1080;
    request.shading = rast::Shading::phong;
    request.threads = 2;
    rast::OrbitOptions orbit;
    orbit.elevation_degrees = 65;
    orbit.distance = 4.15;
    orbit.aspect = double(request.width) / double(request.height);
    request.view = rast::orbit_view(scene, orbit);
    const double before = most_memory();
    const prep::Result<rast::RenderPlan> plan = rast::plan(scene, request);
    if (!plan) {
        std::fprintf(stderr, "render_large: %s\n", prep::to_string(plan.error()).c_str());
        return 1;
    }
    const Clock::time_point start = Clock::now();
    const prep::Result<rast::Frame> frame = rast::render_bands(
        scene, *plan, [](const rast::Frame&, std::uint32_t) { return prep::Result<void>(); });
    if (!frame) return 1;
    std::printf("%llu triangles, %.0f Mpx shaded: %.2f s (geometry %.2f s)\n",
                static_cast<unsigned long long>(frame->counters.triangles),
                double(frame->counters.pixels_shaded) * 1e-6, since(start),
                frame->geometry_ms * 1e-3);
    std::printf("at most %.2f GB, the mesh alone %.2f GB; estimated for drawing %.2f GB\n",
                most_memory(), before, double(plan->band_memory_estimate) * 1e-9);
    return 0;
}
