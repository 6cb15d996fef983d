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
#include "torus.h"

namespace {

constexpr std::uint32_t width = 1920, height = 1080;

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

// Peak 1: bumps over UVs, and tiles of two colours, both with detail at every scale down to texels.
float hashed(std::uint32_t x, std::uint32_t y) {
    std::uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u;
    h = (h ^ h >> 15) * 0x2C1B3C6Du;
    h = (h ^ h >> 12) * 0x297A2D39u;
    return float((h ^ h >> 15) >> 8) / float(1 << 24);
}

prep::Image empty_image(bool srgb) {
    prep::Image image;
    image.width = image.height = 1024;
    image.channels = 3;
    image.srgb = srgb;
    image.pixels.resize(std::size_t(image.width) * image.height * 3);
    return image;
}

prep::Image diffuse_image() {
    prep::Image image = empty_image(true);
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const bool light = ((x / 64) + (y / 64)) % 2 == 0;
            float* p = &image.pixels[(std::size_t(y) * image.width + x) * 3];
            for (int c = 0; c < 3; ++c)
                p[c] = std::floor((light ? 170.0f - 20.0f * float(c) : 90.0f + 25.0f * float(c)) +
                                  60.0f * hashed(x / 4, y / 4)) /
                       255.0f;
        }
    return image;
}

prep::Image normal_image() {
    prep::Image image = empty_image(false);
    constexpr float turn = 6.2831853f / 64;
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const glm::vec3 n = glm::normalize(glm::vec3(0.4f * std::cos(turn * float(x)),
                                                         0.4f * std::cos(turn * float(y)), 1.0f));
            for (int c = 0; c < 3; ++c)
                image.pixels[(std::size_t(y) * image.width + x) * 3 + std::size_t(c)] =
                    std::floor((n[c] * 0.5f + 0.5f) * 255.0f + 0.5f) / 255.0f;
        }
    return image;
}

prep::Image to_linear(prep::Image image) {
    for (float& v : image.pixels)
        v = v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
    image.srgb = false;
    return image;
}

prep::PreparedScene scene_of(std::uint64_t triangles, const prep::Image& diffuse,
                             const prep::Image& normals) {
    prep::Scene scene;
    scene.meshes.push_back(bench::bumpy_torus(bench::torus_size(triangles)));
    scene.meshes[0].face_materials.assign(scene.meshes[0].face_count(), 0);
    for (const prep::Image* image : {&diffuse, &normals}) {
        prep::ImageRef ref;
        ref.name = "made here.png";
        ref.bytes = *prep::encode_png(*image);
        scene.images.push_back(std::move(ref));
        prep::Texture texture;
        texture.image = std::uint32_t(scene.textures.size());
        scene.textures.push_back(texture);
    }
    prep::Material material;
    material.diffuse = {0.8f, 0.75f, 0.7f, 1.0f};
    material.specular = glm::vec3(0.25f);
    material.shininess = 40;
    material.diffuse_map.texture = 0;
    material.normal_map.texture = 1;
    scene.materials.push_back(material);
    prep::Node node;
    node.mesh = 0;
    scene.nodes.push_back(node);
    auto prepared = prep::prepare(std::move(scene));
    if (!prepared) {
        std::fprintf(stderr, "%s\n", prep::to_string(prepared.error()).c_str());
        std::exit(1);
    }
    return std::move(*prepared);
}

struct Setting {
    rast::RenderRequest request;
    bench::Surface surface;
};

Setting setting_of(const prep::PreparedScene& scene, bool mapped) {
    Setting s;
    s.request.width = width;
    s.request.height = height;
    rast::OrbitOptions orbit;
    // Fills the picture a little beyond its top and bottom.
    orbit.elevation_degrees = 65;
    orbit.distance = 4.15;
    orbit.aspect = double(width) / height;
    rast::View view = rast::orbit_view(scene, orbit);
    s.request.view = view;
    s.request.shading = mapped ? rast::Shading::normal_mapped : rast::Shading::phong;
    s.request.textures = mapped;
    s.request.cull = rast::Cull::back;
    rast::LightInstance sun, ambient;
    sun.direction = glm::normalize(glm::dvec3(-0.4, -0.8, -0.45));
    sun.color = glm::vec3(0.7f);
    ambient.kind = prep::LightKind::ambient;
    ambient.color = glm::vec3(0.1f);
    s.request.lights = std::vector<rast::LightInstance>{sun, ambient};

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

rast::Frame draw(const prep::PreparedScene& scene, rast::RenderRequest request, int threads) {
    request.threads = threads;
    auto frame = rast::render(scene, *rast::plan(scene, request));
    return std::move(*frame);
}

std::vector<std::uint8_t> bytes_of(const rast::Frame& frame) {
    std::vector<std::uint8_t> bytes;
    for (const glm::vec4& c : frame.color)
        for (int k = 0; k < 4; ++k)
            bytes.push_back(std::uint8_t(std::clamp(c[k], 0.0f, 1.0f) * 255.0f + 0.5f));
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
    const prep::Image diffuse = diffuse_image(), normals = normal_image();
    bool alike = true;
    for (const std::uint64_t triangles : {5000, 100352, 980000}) {
        const prep::PreparedScene scene = scene_of(triangles, diffuse, normals);
        peer->upload(scene.meshes[0], to_linear(diffuse), normals);
        for (const bool mapped : {false, true}) {
            const Setting setting = setting_of(scene, mapped);
            const auto ours = [&](int threads) { return draw(scene, setting.request, threads); };
            std::vector<double> times[3];
            rast::Frame frame = ours(2);
            peer->draw(setting.surface);  // compiles
            for (int i = 0; i < frames; ++i) {
                times[0].push_back(milliseconds([&] { peer->draw(setting.surface); }));
                times[1].push_back(milliseconds([&] { frame = ours(2); }));
                times[2].push_back(milliseconds([&] { frame = ours(1); }));
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
