// Displacement: the error asked for against the error there is, and what a map loses of the wave
// that it was made of, by its size and filter.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "cost/oracles/height_wave.h"
#include "prep/displacement/tessellate.h"

namespace cost {
namespace {

constexpr double wave_height = 0.05;

// The unit square in z = 0, 4 × 4 quads whose UVs are their x and y.
prep::Mesh square_cage() {
    constexpr int side = 4;
    prep::Mesh mesh;
    mesh.uvs.emplace_back();
    for (int j = 0; j <= side; ++j)
        for (int i = 0; i <= side; ++i) {
            const glm::vec2 p(float(i) / side, float(j) / side);
            mesh.positions.emplace_back(p, 0.0f);
            mesh.uvs[0].values.push_back(p);
        }
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
            const auto first = std::uint32_t(j * (side + 1) + i);
            for (const std::uint32_t v : {first, first + 1, first + side + 2, first + side + 1})
                mesh.corner_vertices.push_back(v);
            mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        }
    mesh.uvs[0].indices = mesh.corner_vertices;
    return mesh;
}

prep::Image map_of(const WaveTexels& wave, int size) {
    prep::Image image;
    image.width = image.height = std::uint32_t(size);
    image.channels = 1;
    image.pixels = wave.texels();
    image.floating = true;
    return image;
}

prep::Result<prep::TessellatedMesh> displaced(const prep::Mesh& cage, const prep::Image& map,
                                              prep::HeightMapOptions heights,
                                              prep::TessellateOptions options, int threads) {
    heights.scale = wave_height;
    heights.midlevel = 0;
    heights.threads = threads;
    const auto function = prep::height_function(map, heights);
    if (!function) return function.error();
    options.displacements = {{*function}};
    options.samples = 0;
    options.threads = threads;
    return prep::tessellate(cage, options);
}

prep::Result<prep::TessellatedMesh> displaced(const prep::Mesh& cage, const prep::Image& map,
                                              prep::HeightFilter filter, double chord_error,
                                              int threads) {
    prep::HeightMapOptions heights;
    heights.filter = filter;
    prep::TessellateOptions options;
    options.chord_error = chord_error;
    return displaced(cage, map, heights, options, threads);
}

// Along z, which the square is displaced along: of vertices, edges' midpoints and middles.
template <class Height>
std::vector<double> height_errors(const prep::Mesh& mesh, const Height& height) {
    std::vector<double> errors;
    const auto measure = [&](const Vector& p) {
        errors.push_back(double(std::abs(p.z - Real(wave_height) * height(p.x, p.y))));
    };
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        Vector corners[3];
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] = Vector(mesh.positions[mesh.corner_vertices[mesh.face_offsets[f] + k]]);
        for (std::size_t k = 0; k < 3; ++k) {
            measure(corners[k]);
            measure((corners[k] + corners[(k + 1) % 3]) / Real(2));
        }
        measure((corners[0] + corners[1] + corners[2]) / Real(3));
    }
    return errors;
}

constexpr const char* height_domain =
    "distance along the displacement, at vertices, edges' midpoints and middles of all triangles";
constexpr const char* square = "a unit square, displaced by up to 0.05 along its normal";

}  // namespace

prep::Result<Ladder> displacement_error_ladder(const Subject& subject) {
    constexpr int size = 48;
    const auto cage = std::make_shared<const prep::Mesh>(square_cage());
    const auto wave = std::make_shared<const WaveTexels>(size);
    const auto map = std::make_shared<const prep::Image>(map_of(*wave, size));
    Ladder ladder;
    ladder.name = "displacement-error";
    ladder.title = "Chord error of displaced triangles";
    ladder.setting = "displacement: --chord-error";
    ladder.subject = fmt::format("{}, by a map of 48² texels, bilinear", square);
    ladder.oracle = "the map between its texels, bilinear in long double";
    ladder.timed = {"bounds of the map, the tessellation and its proof",
                    "without the samples that measure it; freeing the last result"};
    ladder.metrics = {{"largest", "units", height_domain},    {"99.9 %", "units", height_domain},
                      {"mean", "units", height_domain},       {"asked", "units", "--chord-error"},
                      {"proved", "units", "the certificate"}, {"triangles", "", ""}};
    ladder.reference = 2;
    ladder.reference_is_default = false;
    ladder.floor = 0x1p-29;
    ladder.floor_text = "heights rounded to float: half a unit in the last place of 0.05";
    for (const char* asked : {"0.01", "0.003", "0.001", "0.0003", "0.0001"}) {
        Rung rung;
        rung.name = asked;
        rung.command = fmt::format("prepare --displace materials --chord-error {}", asked);
        const double error = std::strtod(asked, nullptr);
        const auto made = std::make_shared<prep::TessellatedMesh>();
        rung.run = [cage, map, made, error, threads = subject.threads]() -> prep::Result<void> {
            auto result = displaced(*cage, *map, prep::HeightFilter::bilinear, error, threads);
            if (!result) return result.error();
            *made = *std::move(result);
            return {};
        };
        rung.judge = [wave, made, error] {
            std::vector<double> numbers = three_of(
                height_errors(made->mesh, [&](Real u, Real v) { return wave->bilinear(u, v); }));
            numbers.push_back(error);
            numbers.push_back(made->certificate.proved);
            numbers.push_back(double(made->mesh.face_count()));
            return numbers;
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

namespace {

// A wave by maps of a size, read through a filter, to within an error.
Rung wave_rung(std::shared_ptr<const prep::Mesh> cage, std::shared_ptr<const prep::Image> map,
               prep::HeightFilter filter, const std::string& asked, int threads) {
    Rung rung;
    rung.command = fmt::format("prepare --displace materials --height-filter {} --chord-error {}",
                               prep::name_of(filter), asked);
    const double error = std::strtod(asked.c_str(), nullptr);
    const auto made = std::make_shared<prep::TessellatedMesh>();
    rung.run = [cage, map, made, filter, error, threads]() -> prep::Result<void> {
        auto result = displaced(*cage, *map, filter, error, threads);
        if (!result) return result.error();
        *made = *std::move(result);
        return {};
    };
    rung.judge = [made] {
        std::vector<double> numbers = three_of(height_errors(made->mesh, wave_at));
        numbers.push_back(double(made->mesh.face_count()));
        return numbers;
    };
    return rung;
}

constexpr prep::HeightFilter height_filters[] = {prep::HeightFilter::bilinear,
                                                 prep::HeightFilter::bicubic};

GridSetting filters_of_heights() {
    GridSetting setting{"filter", {}};
    for (const prep::HeightFilter f : height_filters) setting.values.emplace_back(prep::name_of(f));
    return setting;
}

Ladder wave_ladder() {
    Ladder ladder;
    ladder.oracle = "the wave in closed form";
    ladder.metrics = {{"largest", "units", height_domain},
                      {"99.9 %", "units", height_domain},
                      {"mean", "units", height_domain},
                      {"triangles", "", ""}};
    ladder.reference_is_default = false;
    return ladder;
}

constexpr const char* creases_cost_triangles =
    "bilinear texels have creases between them, which triangles follow: what the map loses of the "
    "surface stays, however many there are";

}  // namespace

prep::Result<Ladder> height_filter_ladder(const Subject& subject) {
    constexpr const char* asked = "0.0001";
    const auto cage = std::make_shared<const prep::Mesh>(square_cage());
    Ladder ladder = wave_ladder();
    ladder.name = "height-filter";
    ladder.title = "Filters of height maps";
    ladder.setting = "displacement: --height-filter, and how large a map is";
    ladder.subject = fmt::format("{}, by maps of a wave of up to two turns", square);
    ladder.timed = {"bounds of the map, and a tessellation with a chord error of 0.0001",
                    "without the samples that measure it; freeing the last result"};
    ladder.floor = std::strtod(asked, nullptr);
    ladder.floor_text = "what was asked of the triangles, which come near to it";
    ladder.reference = 1;  // bilinear, 32²
    GridSetting sizes{"texels", {}};
    std::vector<std::shared_ptr<const prep::Image>> maps;
    for (const int size : {16, 32, 64, 128}) {
        sizes.values.push_back(fmt::format("{}²", size));
        maps.push_back(std::make_shared<const prep::Image>(map_of(WaveTexels(size), size)));
    }
    make_grid(ladder, filters_of_heights(), sizes, [&](std::size_t i, std::size_t j) {
        Rung rung = wave_rung(cage, maps[j], height_filters[i], asked, subject.threads);
        rung.because = creases_cost_triangles;
        return rung;
    });
    return ladder;
}

prep::Result<Ladder> chord_error_by_height_filter_grid(const Subject& subject) {
    constexpr int size = 32;
    const auto cage = std::make_shared<const prep::Mesh>(square_cage());
    const auto map = std::make_shared<const prep::Image>(map_of(WaveTexels(size), size));
    Ladder ladder = wave_ladder();
    ladder.name = "chord-error-by-height-filter";
    ladder.title = "Chord error by filter of the height map";
    ladder.setting = "displacement: --chord-error and --height-filter together";
    ladder.subject = fmt::format("{}, by a map of 32² texels of a wave of up to two turns", square);
    ladder.timed = {"bounds of the map, the tessellation and its proof",
                    "without the samples that measure it; freeing the last result"};
    ladder.reference = 2;  // bilinear, 0.001
    const GridSetting asked{"chord error", {"0.01", "0.003", "0.001", "0.0003", "0.0001"}};
    make_grid(ladder, filters_of_heights(), asked, [&](std::size_t i, std::size_t j) {
        Rung rung = wave_rung(cage, map, height_filters[i], asked.values[j], subject.threads);
        rung.because = creases_cost_triangles;
        return rung;
    });
    return ladder;
}

namespace {

// The wave, and a fine one of 24 by 18 cycles, which edges of a thirty-second cannot carry.
prep::Image rippled_map(int size) {
    constexpr double ripple = 0.02, along_u = 24, along_v = 18;
    prep::Image image = map_of(WaveTexels(size), size);
    std::size_t at = 0;
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i)
            image.pixels[at++] += float(
                ripple * std::cos(2 * std::numbers::pi *
                                  (along_u * (i + 0.5) + along_v * (j + 0.5)) / double(size)));
    return image;
}

}  // namespace

prep::Result<Ladder> band_limit_ladder(const Subject& subject) {
    constexpr int size = 256;
    static constexpr double edge = 0.03125;
    const auto cage = std::make_shared<const prep::Mesh>(square_cage());
    const auto map = std::make_shared<const prep::Image>(rippled_map(size));
    Ladder ladder;
    ladder.name = "band-limit";
    ladder.title = "Band limits of heights";
    ladder.setting = "displacement: --band-limit, with --edge-length 0.03125";
    ladder.subject = fmt::format(
        "{}, by a map of 256² texels of a wave of up to two turns and ripples of 30", square);
    ladder.oracle = "the wave in closed form, without the ripples: what such edges can carry";
    ladder.timed = {"the filter, bounds of the map, and the tessellation",
                    "without the samples that measure it; freeing the last result"};
    constexpr const char* vertices = "distance along the displacement, at vertices";
    ladder.metrics = {{"largest", "units", vertices},
                      {"99.9 %", "units", vertices},
                      {"mean", "units", vertices},
                      {"triangles", "", ""}};
    ladder.reference = 0;
    ladder.floor = 0x1p-29;
    ladder.floor_text = "heights rounded to float: half a unit in the last place of 0.05";
    for (const char* limit : {"none", "0.01", "0.02", "0.04", "0.08", "0.16"}) {
        Rung rung;
        rung.name = limit;
        const double spacing = std::strtod(limit, nullptr);  // none: 0
        rung.command = fmt::format("prepare --displace materials --edge-length {}{}", edge,
                                   spacing > 0 ? fmt::format(" --band-limit {}", limit) : "");
        rung.because =
            "limits far below the edges' length leave what edges cannot carry, those far above it "
            "take from what they can";
        const auto made = std::make_shared<prep::TessellatedMesh>();
        rung.run = [cage, map, made, spacing, threads = subject.threads]() -> prep::Result<void> {
            prep::HeightMapOptions heights;
            heights.sample_spacing = spacing;
            prep::TessellateOptions options;
            options.edge_length = edge;
            auto result = displaced(*cage, *map, heights, options, threads);
            if (!result) return result.error();
            *made = *std::move(result);
            return {};
        };
        rung.judge = [made] {
            std::vector<double> errors;
            for (const glm::vec3& point : made->mesh.positions) {
                const Vector p(point);
                errors.push_back(double(std::abs(p.z - Real(wave_height) * wave_at(p.x, p.y))));
            }
            std::vector<double> numbers = three_of(std::move(errors));
            numbers.push_back(double(made->mesh.face_count()));
            return numbers;
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
