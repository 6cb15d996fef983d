// draw_torus TRIANGLES phong|normal-mapped FRAMES [THREADS [SIMD]]: a cell of compare_llvmpipe by
// itself, for bench/compare_drawing. Prints the milliseconds of each frame, planning included, one
// a line; the first frame, which makes mip levels, is drawn before and not printed.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "prep/image.h"
#include "torus_scene.h"

int main(int argc, char** argv) {
    const std::string shading = argc > 3 ? argv[2] : "";
    if (shading != "phong" && shading != "normal-mapped") {
        std::fprintf(stderr,
                     "usage: draw_torus TRIANGLES phong|normal-mapped FRAMES [THREADS [SIMD]]\n");
        return 2;
    }
    const prep::PreparedScene scene = bench::torus_scene(
        std::strtoull(argv[1], nullptr, 10), bench::diffuse_image(), bench::normal_image());
    rast::RenderRequest request = bench::torus_request(scene, shading == "normal-mapped");
    request.threads = argc > 4 ? std::atoi(argv[4]) : 1;
    if (argc > 5) {
        for (const prep::SimdLevel level : {prep::SimdLevel::scalar, prep::SimdLevel::sse4,
                                            prep::SimdLevel::avx2, prep::SimdLevel::avx512})
            if (prep::to_string(level) == argv[5]) request.simd = level;
        if (request.simd == prep::SimdLevel::automatic) {
            std::fprintf(stderr, "draw_torus: no instruction set '%s'\n", argv[5]);
            return 2;
        }
    }
    rast::SceneRenderer renderer(scene);
    rast::Frame frame;
    const int frames = std::atoi(argv[3]);
    for (int i = 0; i <= frames; ++i) {
        const auto start = std::chrono::steady_clock::now();
        const auto plan = rast::plan(scene, request);
        if (!plan || !renderer.render(*plan, frame)) {
            std::fprintf(stderr, "draw_torus: it cannot be drawn\n");
            return 1;
        }
        const std::chrono::duration<double, std::milli> taken =
            std::chrono::steady_clock::now() - start;
        if (i > 0) std::printf("%.4f\n", taken.count());
    }
    return 0;
}
