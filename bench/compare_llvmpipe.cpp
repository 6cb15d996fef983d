// compare_llvmpipe [FRAMES]: the bumpy torus at 1920×1080, drawn by librast and by llvmpipe in
// turns, in one process: {5,000, 100,352, 980,000} triangles × {Phong, normal map and diffuse map,
// trilinear}. Prints the median time of a frame on both sides, their ratio, how ours scales from
// one thread to two, and how alike the pictures are.
//
// Timed on both sides: everything between a new view and the last pixel written: clearing, vertex
// transform, culling, rasterization, shading, 8-bit colours in memory. Not timed on either:
// loading, uploading, mip levels, compiling, reading back. llvmpipe uses as many threads as
// LP_NUM_THREADS says, all cores by default.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "llvmpipe.h"
#include "prep/image.h"
#include "prep/prepare.h"
#include "rast/render.h"
#include "torus_scene.h"

namespace {

using bench::height;
using bench::width;

double milliseconds(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

double median(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v.size() % 2 == 1 ? v[v.size() / 2] : (v[v.size() / 2 - 1] + v[v.size() / 2]) / 2;
}

prep::Image to_linear(prep::Image image) {
    for (float& v : image.pixels)
        v = v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
    image.srgb = false;
    return image;
}

struct Setting {
    rast::RenderRequest request;
    bench::Surface surface;
};

Setting setting_of(const prep::PreparedScene& scene, bool mapped) {
    Setting s;
    s.request = bench::torus_request(scene, mapped);
    const rast::View& view = *s.request.view;
    const rast::LightInstance &sun = (*s.request.lights)[0], &ambient = (*s.request.lights)[1];
    const prep::Material& material = scene.scene.materials[0];
    bench::Surface& b = s.surface;
    b.mapped = mapped;
    b.ambient = ambient.color * material.ambient;
    b.diffuse = material.diffuse;
    b.specular = material.specular;
    b.shininess = material.shininess;
    b.to_light = glm::vec3(-sun.direction);
    b.light = sun.color;
    b.eye = glm::vec3(view.eye());
    // OpenGL's own depth, finite: reversed depth would need a clip control that 3.3 lacks.
    const double scale = 1 / std::tan(view.yfov / 2), n = view.znear, f = 100;
    glm::dmat4 p(0.0);
    p[0][0] = scale * height / width;
    p[1][1] = scale;
    p[2][2] = -(f + n) / (f - n);
    p[2][3] = -1;
    p[3][2] = -2 * f * n / (f - n);
    b.to_clip = glm::mat4(p * view.world_to_view);
    return s;
}

std::vector<std::uint8_t> bytes_of(const rast::Frame& frame) {
    std::vector<std::uint8_t> bytes;
    for (const std::uint32_t pixel : frame.bytes)
        for (int k = 0; k < 4; ++k) bytes.push_back(std::uint8_t(pixel >> 8 * k));
    return bytes;
}

double psnr(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    double sum = 0;
    std::size_t n = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (i % 4 == 3) continue;
        const double d = double(a[i]) - b[i];
        sum += d * d;
        ++n;
    }
    return sum == 0 ? INFINITY : 10 * std::log10(255.0 * 255.0 * double(n) / sum);
}

}  // namespace

int main(int argc, char** argv) {
    const int frames = argc > 1 ? std::max(1, std::atoi(argv[1])) : 15;
    std::string message;
    const auto peer = bench::Llvmpipe::make(width, height, message);
    if (!peer) {
        std::fprintf(stderr, "compare_llvmpipe: %s\n", message.c_str());
        return 1;
    }
    const char* peer_threads = std::getenv("LP_NUM_THREADS");
    std::printf("%s, LP_NUM_THREADS %s; %ux%u, medians of %d frames\n", peer->version().c_str(),
                peer_threads ? peer_threads : "unset (all cores)", width, height, frames);
    std::printf("%9s  %-13s %9s %9s %9s %7s %8s %6s %8s\n", "triangles", "shading", "llvmpipe",
                "ours, 2", "ours, 1", "faster", "scaling", "PSNR", "covered");
    const prep::Image diffuse = bench::diffuse_image(), normals = bench::normal_image();
    bool alike = true;
    for (const std::uint64_t triangles : {5000, 100352, 980000}) {
        const prep::PreparedScene scene = bench::torus_scene(triangles, diffuse, normals);
        rast::SceneRenderer renderer(scene);
        peer->upload(scene.meshes[0], to_linear(diffuse), normals);
        for (const bool mapped : {false, true}) {
            const Setting setting = setting_of(scene, mapped);
            rast::Frame frame;
            const auto ours = [&](int threads) {
                rast::RenderRequest request = setting.request;
                request.threads = threads;
                if (!renderer.render(*rast::plan(scene, request), frame)) std::exit(1);
            };
            std::vector<double> times[3];
            ours(2);
            peer->draw(setting.surface);  // compiles
            for (int i = 0; i < frames; ++i) {
                // Each timed frame follows one of its own kind, as in a sequence of pictures.
                const auto timed = [&](std::vector<double>& to, const std::function<void()>& draw) {
                    draw();
                    to.push_back(milliseconds(draw));
                };
                timed(times[0], [&] { peer->draw(setting.surface); });
                timed(times[1], [&] { ours(2); });
                timed(times[2], [&] { ours(1); });
            }
            const double likeness = psnr(bytes_of(frame), peer->pixels());
            alike = alike && likeness >= 40;
            const double a = median(times[0]), two = median(times[1]), one = median(times[2]);
            std::printf("%9zu  %-13s %6.1f ms %6.1f ms %6.1f ms %6.2fx %7.2fx %6.1f %7.1f%%\n",
                        scene.meshes[0].triangle_count(), mapped ? "normal-mapped" : "Phong", a,
                        two, one, a / two, one / two, likeness,
                        100.0 * double(frame.counters.pixels_shaded) / (double(width) * height));
            std::fflush(stdout);
        }
    }
    if (!alike) std::fprintf(stderr, "compare_llvmpipe: pictures differ (PSNR below 40 dB)\n");
    return alike ? 0 : 1;
}
