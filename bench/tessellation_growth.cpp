// tessellation_growth [TRIANGLES…]: cages moved by a height map of 2048² floats, cut by the chord
// error that takes about so many triangles (found on a tenth of them; errors go with their number).
// Prints a row each: triangles, seconds, processor seconds, most memory. A size a process, as
// memory is the process' highest; the error asked for is in the row, which so can be measured
// again.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "../samples/generator/repeatable.h"
#include "prep/displacement/tessellate.h"

namespace {

using Clock = std::chrono::steady_clock;

// A cube of side 2, its faces side by side in one row of charts.
prep::Mesh cube() {
    prep::Mesh mesh;
    for (int k = 0; k < 8; ++k)
        mesh.positions.emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    constexpr std::uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                           {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    prep::CornerLayer<glm::vec2>& uv = mesh.uvs.emplace_back();
    mesh.face_offsets.assign(1, 0);
    for (std::uint32_t f = 0; f < 6; ++f) {
        const glm::vec2 low(float(f % 3) / 3 + 0.005f, float(f / 3) / 2 + 0.005f);
        for (std::uint32_t c = 0; c < 4; ++c) {
            mesh.corner_vertices.push_back(faces[f][c]);
            uv.indices.push_back(std::uint32_t(uv.values.size()));
            uv.values.push_back(low + glm::vec2(c == 1 || c == 2 ? 0.32f : 0, c >= 2 ? 0.48f : 0));
        }
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    return mesh;
}

// Waves of 4 to 256 cycles, fainter as they are finer.
prep::Image waves(std::uint32_t size) {
    prep::Image image{.width = size, .height = size, .channels = 1, .pixels = {}};
    image.pixels.reserve(std::size_t(size) * size);
    for (std::uint32_t j = 0; j < size; ++j)
        for (std::uint32_t i = 0; i < size; ++i) {
            const double x = 2 * samples::pi * (i + 0.5) / size;
            const double y = 2 * samples::pi * (j + 0.5) / size;
            double height = 0.5, part = 0.2;
            for (int cycles = 4; cycles <= 256; cycles *= 2, part *= 0.5)
                height += part * samples::sine(cycles * x + 0.3 * cycles) *
                          samples::cosine(cycles * y - 0.1 * cycles);
            image.pixels.push_back(float(height));
        }
    return image;
}

double processor_seconds() {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    return double(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
           1e-6 * double(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

int failed(const prep::Error& error) {
    std::fprintf(stderr, "tessellation_growth: %s\n", prep::to_string(error).c_str());
    return 1;
}

struct Case {
    const char* name;
    bool limit_surface;
};

int run(const Case& of, std::uint64_t wanted) {
    const prep::Mesh mesh = cube();
    prep::HeightMapOptions as;
    as.scale = 0.1;
    prep::TessellateOptions options;
    if (of.limit_surface) options.scheme = prep::SubdivisionScheme::catmark;
    const auto map = prep::height_function(waves(2048), as, &mesh, 0, options.scheme);
    if (!map) return failed(map.error());
    options.displacements = {{*map}};
    // Errors are a power of the number of triangles.
    std::array<double, 2> triangles{}, errors{};
    for (std::size_t k = 0; k < 2; ++k) {
        options.max_triangles = std::max<std::uint64_t>(1000, wanted / (k == 0 ? 40 : 10));
        const auto few = prep::tessellate(mesh, options);
        if (!few) return failed(few.error());
        triangles[k] = double(few->certificate.triangles);
        errors[k] = few->certificate.proved_refinable;
    }
    const double power = std::log(errors[1] / errors[0]) / std::log(triangles[1] / triangles[0]);
    options.chord_error = errors[1] * std::pow(double(wanted) / triangles[1], power);
    options.max_triangles.reset();
    const Clock::time_point start = Clock::now();
    const double used = processor_seconds();
    const auto made = prep::tessellate(mesh, options);
    if (!made) return failed(made.error());
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const double processor = processor_seconds() - used;
    rusage all{};
    getrusage(RUSAGE_SELF, &all);
    const double count = double(made->certificate.triangles);
    std::printf("| %s | %.3g | %llu | %.2f | %.2f | %.2f | %.2f | %.0f |\n", of.name,
                *options.chord_error, static_cast<unsigned long long>(made->certificate.triangles),
                seconds, processor, 1e6 * processor / count, double(all.ru_maxrss) * 1024e-9,
                double(all.ru_maxrss) * 1024 / count);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::uint64_t> sizes;
    for (int k = 1; k < argc; ++k) sizes.push_back(std::strtoull(argv[k], nullptr, 10));
    if (sizes.empty()) sizes = {100'000, 1'000'000, 10'000'000, 50'000'000};
    std::printf(
        "| surface | chord error | triangles | seconds | processor seconds | µs a triangle | most "
        "GB "
        "| bytes a triangle |\n|---|---:|---:|---:|---:|---:|---:|---:|\n");
    for (const Case& of : {Case{"polygons", false}, Case{"limit surface", true}})
        for (const std::uint64_t size : sizes) {
            std::fflush(stdout);
            const pid_t child = fork();
            if (child == 0) {
                const int status = run(of, size);
                std::fflush(stdout);
                _exit(status);
            }
            int status = 0;
            if (child < 0 || waitpid(child, &status, 0) < 0 || status != 0) return 1;
        }
}
