// Every texture filter on a receding checkerboard and on zone plates, against 1,024 samples a
// pixel of the same texture: prints tables of docs/rasterizer.md and draws its pictures. Errors on
// a floor are the ladder texture-filter's of `meshprep cost`, whose truth is not this renderer's.
// draw_filters OUT-DIR
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "prep/image.h"
#include "prep/prepare.h"
#include "rast/render.h"

namespace {

constexpr std::uint32_t grid = 32;  // samples a side of a pixel

[[noreturn]] void fail(const prep::Error& error) {
    std::fprintf(stderr, "draw_filters: %s\n", prep::to_string(error).c_str());
    std::exit(1);
}

template <class T>
T take(prep::Result<T> result) {
    if (!result) fail(result.error());
    return std::move(*result);
}

// Grey values from 0 to 1 in linear light, as an sRGB file of 16 bits.
prep::ImageRef texture_of(std::uint32_t extent,
                          const std::function<double(std::uint32_t, std::uint32_t)>& value) {
    prep::Image image{extent, extent, 3, {}};
    for (std::uint32_t y = 0; y < extent; ++y)
        for (std::uint32_t x = 0; x < extent; ++x) {
            const double v = value(x, y);
            const double coded = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
            image.pixels.insert(image.pixels.end(), 3, float(coded));
        }
    prep::ImageRef file;
    file.name = "memory.png";
    file.bytes = take(prep::encode_png(image, prep::PixelType::u16));
    return file;
}

struct Stage {
    const char* name;
    prep::PreparedScene scene;
    rast::View view;
    std::uint32_t width = 0, height = 0;
};

// A square in the plane spanned by two half sides about a centre.
Stage stage_of(const char* name, prep::ImageRef texture, const glm::vec3& centre,
               const glm::vec3& right, const glm::vec3& up, float repeats, float turn) {
    Stage stage{name, {}, {}, 0, 0};
    prep::VertexMesh mesh;
    mesh.uvs = {{}};
    for (const glm::vec2 c : {glm::vec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
        mesh.positions.push_back(centre + right * c.x + up * c.y);
        const glm::vec2 turned(std::cos(turn) * c.x - std::sin(turn) * c.y,
                               std::sin(turn) * c.x + std::cos(turn) * c.y);
        mesh.uvs[0].push_back((turned * 0.5f + 0.5f) * repeats);
    }
    mesh.indices = {0, 1, 2, 0, 2, 3};
    mesh.ranges = {{0, 2, 0, prep::no_index}};
    stage.scene.meshes.push_back(mesh);
    stage.scene.scene.meshes.emplace_back();
    prep::Material material;
    material.diffuse = glm::vec4(1.0f);
    material.unlit = material.double_sided = true;
    material.diffuse_map.texture = 0;
    stage.scene.scene.materials.push_back(material);
    prep::Texture sampler;
    sampler.image = 0;
    stage.scene.scene.textures.push_back(sampler);
    stage.scene.scene.images.push_back(std::move(texture));
    prep::Node node;
    node.mesh = 0;
    stage.scene.scene.nodes.push_back(node);
    return stage;
}

struct Choice {
    const char* name;
    rast::TextureFilter filter;
    int most = 1;
};

rast::Frame drawn(const Stage& stage, const Choice& choice, std::uint32_t scale,
                  const std::optional<rast::Crop>& crop) {
    rast::RenderRequest request;
    request.width = stage.width * scale;
    request.height = stage.height * scale;
    request.view = stage.view;
    request.filter = choice.filter;
    request.max_anisotropy = choice.most;
    request.crop = crop;
    return take(rast::render(stage.scene, take(rast::plan(stage.scene, request))));
}

using Grey = std::vector<float>;

Grey grey(const rast::Frame& frame) {
    Grey out;
    for (const glm::vec4& c : frame.color) out.push_back(c.r);
    return out;
}

struct Reference {
    Grey box, gauss;
    std::vector<bool> covered;  // the textured surface fills the pixel and its neighbours
};

// One pixel's box, and the weights that EWA uses over one pixel's radius: exp(−2r²) − exp(−2).
Reference reference_of(const Stage& stage) {
    const std::uint32_t width = stage.width, height = stage.height;
    const Choice first_level{"", rast::TextureFilter::bilinear};
    std::vector<Grey> rows(height);
    const auto row = [&](std::int64_t y) -> const Grey* {
        if (y < 0 || y >= height) return nullptr;
        Grey& kept = rows[std::size_t(y)];
        if (kept.empty()) {
            const rast::Frame frame =
                drawn(stage, first_level, grid,
                      rast::Crop{0, std::uint32_t(y) * grid, width * grid, grid});
            for (const glm::vec4& c : frame.color) kept.push_back(c.a > 0 ? c.r : NAN);
        }
        return &kept;
    };
    std::vector<float> weights(9 * grid * grid);
    for (std::uint32_t j = 0; j < 3 * grid; ++j)
        for (std::uint32_t i = 0; i < 3 * grid; ++i) {
            const double dx = (i + 0.5) / grid - 1.5, dy = (j + 0.5) / grid - 1.5;
            const double r2 = dx * dx + dy * dy;
            weights[j * 3 * grid + i] = r2 < 1 ? float(std::exp(-2 * r2) - std::exp(-2.0)) : 0;
        }
    Reference out;
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            double box = 0, sum = 0, total = 0;
            bool covered = true;
            for (std::uint32_t j = 0; j < 3 * grid; ++j) {
                const Grey* strip = row(std::int64_t(y) - 1 + j / grid);
                if (strip == nullptr) continue;
                const float* line = strip->data() + std::size_t(j % grid) * width * grid;
                for (std::uint32_t i = 0; i < 3 * grid; ++i) {
                    const std::int64_t at = (std::int64_t(x) - 1) * grid + i;
                    if (at < 0 || at >= std::int64_t(width) * grid) continue;
                    covered = covered && !std::isnan(line[at]);
                    const double value = std::isnan(line[at]) ? 0.0 : line[at];
                    const double weight = weights[j * 3 * grid + i];
                    if (j / grid == 1 && i / grid == 1) box += value;
                    sum += value * weight;
                    total += weight;
                }
            }
            out.box.push_back(float(box / (grid * grid)));
            out.gauss.push_back(float(sum / total));
            out.covered.push_back(covered);
        }
        if (y > 0) rows[y - 1] = Grey();
    }
    return out;
}

double rmse(const Grey& a, const Grey& b, const std::vector<bool>& counted) {
    double squared = 0, count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!counted[i]) continue;
        squared += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
        ++count;
    }
    return std::sqrt(squared / count);
}

double energy(const Grey& a, const Grey& b, const std::vector<bool>& counted) {
    double sum = 0, reference = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!counted[i]) continue;
        sum += a[i];
        reference += b[i];
    }
    return sum / reference;
}

// Rows of pictures with a few white pixels between.
void save_sheet(const std::filesystem::path& path, const std::vector<Grey>& pictures,
                std::uint32_t width, std::uint32_t height, std::uint32_t columns) {
    constexpr std::uint32_t gap = 4;
    const std::uint32_t rows = (std::uint32_t(pictures.size()) + columns - 1) / columns;
    prep::Image sheet;
    sheet.channels = 3;
    sheet.srgb = true;
    sheet.width = columns * (width + gap) - gap;
    sheet.height = rows * (height + gap) - gap;
    sheet.pixels.assign(std::size_t(sheet.width) * sheet.height * 3, 1.0f);
    for (std::size_t n = 0; n < pictures.size(); ++n) {
        rast::Frame frame;
        frame.width = width;
        frame.height = height;
        for (const float v : pictures[n]) frame.color.push_back(glm::vec4(v, v, v, 1));
        const prep::Image picture = rast::to_srgb(frame);
        for (std::uint32_t y = 0; y < height; ++y)
            std::copy_n(picture.at(0, y), width * 3,
                        sheet.pixels.begin() +
                            std::ptrdiff_t(((n / columns) * (height + gap) + y) * sheet.width +
                                           (n % columns) * (width + gap)) *
                                3);
    }
    const auto saved = prep::save_image(path, sheet);
    if (!saved) fail(saved.error());
    std::printf("%s: %u x %u\n", path.c_str(), sheet.width, sheet.height);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2 || argv[1][0] == '-') {
        std::fprintf(stderr, "usage: draw_filters OUT-DIR\n");
        return 2;
    }
    const std::filesystem::path out = argv[1];
    std::filesystem::create_directories(out);
    using rast::TextureFilter;
    const Choice choices[] = {{"nearest", TextureFilter::nearest},
                              {"bilinear", TextureFilter::bilinear},
                              {"nearest mip", TextureFilter::nearest_mip},
                              {"bicubic", TextureFilter::bicubic},
                              {"trilinear", TextureFilter::trilinear},
                              {"ripmap", TextureFilter::ripmap},
                              {"anisotropic 2", TextureFilter::anisotropic, 2},
                              {"anisotropic 4", TextureFilter::anisotropic, 4},
                              {"anisotropic 8", TextureFilter::anisotropic, 8},
                              {"anisotropic 16", TextureFilter::anisotropic, 16},
                              {"EWA 16", TextureFilter::ewa, 16}};
    const auto checker = texture_of(
        256, [](std::uint32_t x, std::uint32_t y) { return double((x / 8 + y / 8) % 2); });
    // The frequency grows to half a period per texel at the middle of the sides.
    const auto rings = texture_of(512, [](std::uint32_t x, std::uint32_t y) {
        const double dx = x - 255.5, dy = y - 255.5;
        return 0.5 + 0.5 * std::cos((dx * dx + dy * dy) * std::numbers::pi / 512);
    });
    std::vector<Stage> stages;
    // A floor one unit below the eye, seen to the horizon, turned against the texture's axes.
    stages.push_back(stage_of("receding checkerboard", checker, {0, -1, 0}, {200, 0, 0},
                              {0, 0, -200}, 60, 0.5f));
    stages.back().width = 240;
    stages.back().height = 135;
    stages.back().view.yfov = 0.9;
    const glm::dmat4 down(1, 0, 0, 0, 0, std::cos(0.35), std::sin(0.35), 0, 0, -std::sin(0.35),
                          std::cos(0.35), 0, 0, 0, 0, 1);
    stages.back().view.world_to_view = down;
    stages.push_back(
        stage_of("zone plate, from the front", rings, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}, 1, 0));
    stages.back().width = stages.back().height = 180;
    stages.back().view.yfov = 2 * std::atan(1.0);
    stages.push_back(stage_of("zone plate, tilted by 75 degrees", rings, {0, 0, -4}, {1, 0, 0},
                              {0, std::cos(1.309f), -std::sin(1.309f)}, 1, 0.5f));
    stages.back().width = 240;
    stages.back().height = 80;
    stages.back().view.yfov = 2 * std::atan(0.12);

    for (const Stage& stage : stages) {
        const Reference reference = reference_of(stage);
        const bool floor = &stage == &stages[0];
        std::printf(
            "\n%s, %u x %u\n| filter |%s energy | RMSE to EWA's own weights |\n|---|%s---|---|\n",
            stage.name, stage.width, stage.height, floor ? "" : " RMSE |", floor ? "" : "---|");
        std::vector<Grey> shown;
        for (const Choice& choice : choices) {
            const Grey picture = grey(drawn(stage, choice, 1, std::nullopt));
            std::printf("| %s |", choice.name);
            if (!floor) std::printf(" %.4f |", rmse(picture, reference.box, reference.covered));
            std::printf(" %.4f | %.4f |\n", energy(picture, reference.box, reference.covered),
                        rmse(picture, reference.gauss, reference.covered));
            const bool like_another = choice.filter == TextureFilter::bicubic ||
                                      choice.filter == TextureFilter::nearest_mip ||
                                      choice.most == 4 || choice.most == 8;
            if (!like_another) shown.push_back(picture);
        }
        shown.push_back(reference.box);
        if (floor || &stage == &stages[1])
            save_sheet(out / (floor ? "filters_floor.png" : "filters_rings.png"), shown,
                       stage.width, stage.height, 4);
    }
}
