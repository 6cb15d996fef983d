// One relief shown as a bump map, as a normal map and as displaced triangles.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "cost/ladders/meshes.h"
#include "cost/ladders/scenes.h"
#include "cost/oracles/height_wave.h"
#include "prep/displacement/tessellate.h"
#include "prep/split_vertices.h"

namespace cost {
namespace {

constexpr std::uint32_t side = 192;  // pixels, which the unit square fills
constexpr double relief_height = 0.05;

enum class Shown { bump, normal_map, displaced };

// −1 … 1 as 0 … 1, which 16 bits hold to a 65,535th.
prep::Image heights_of(int size) {
    prep::Image image;
    image.width = image.height = std::uint32_t(size);
    image.channels = 1;
    image.integer_bits = 16;
    const WaveTexels wave(size);
    for (const float h : wave.texels())
        image.pixels.push_back(std::round((h + 1) / 2 * 65535) / 65535);
    return image;
}

prep::HeightMapOptions height_options() {
    prep::HeightMapOptions options;
    options.scale = 2 * relief_height;
    options.midlevel = 0.5;
    options.filter = prep::HeightFilter::bicubic;
    return options;
}

// The unit square in z = 0, whose UVs are its x and y.
prep::Mesh one_quad() {
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.corner_vertices = {0, 1, 2, 3};
    mesh.face_offsets = {0, 4};
    mesh.uvs.emplace_back();
    for (const glm::vec3& p : mesh.positions) mesh.uvs[0].values.emplace_back(p);
    mesh.uvs[0].indices = mesh.corner_vertices;
    return mesh;
}

prep::Result<prep::VertexMesh> flat_square() {
    auto mesh = prep::split(one_quad());
    if (!mesh) return mesh;
    mesh->normals.assign(mesh->vertex_count(), {0, 0, 1});
    // v runs down in pictures: the bitangent is against it.
    mesh->tangents.assign(mesh->vertex_count(), {1, 0, 0, -1});
    return mesh;
}

prep::Result<prep::VertexMesh> displaced_square(const prep::Image& heights, double chord_error,
                                                int threads) {
    prep::HeightMapOptions map = height_options();
    map.threads = threads;
    const auto function = prep::height_function(heights, map);
    if (!function) return function.error();
    prep::TessellateOptions options;
    options.chord_error = chord_error;
    options.displacements = {{*function}};
    options.samples = 0;
    options.threads = threads;
    const auto made = prep::tessellate(one_quad(), options);
    if (!made) return made.error();
    return prep::split(made->mesh);
}

// chord_error: of displaced triangles.
prep::Result<std::shared_ptr<const prep::PreparedScene>> scene_shown(const prep::Image& heights,
                                                                     Shown shown,
                                                                     double chord_error,
                                                                     int threads) {
    prep::Material material;
    material.diffuse = glm::vec4(1);
    material.specular = glm::vec3(0);
    material.double_sided = true;
    auto mesh =
        shown == Shown::displaced ? displaced_square(heights, chord_error, threads) : flat_square();
    if (!mesh) return mesh.error();
    prep::Image map = heights;
    if (shown == Shown::normal_map) {
        prep::HeightToNormalOptions options;
        options.map = height_options();
        auto normals = prep::height_to_normal(heights, options);
        if (!normals) return normals.error();
        map = *std::move(normals);
        material.normal_map.texture = 0;
    } else if (shown == Shown::bump) {
        material.bump_map.texture = 0;
        material.bump_map.strength = 2 * float(relief_height);
    }
    prep::PreparedScene scene = scene_of(*std::move(mesh), material);
    if (shown != Shown::displaced)
        if (auto done = add_texture(scene, map, prep::PixelType::u16); !done) return done.error();
    return std::make_shared<const prep::PreparedScene>(std::move(scene));
}

rast::RenderRequest request_of(const glm::dvec3& towards, int threads) {
    rast::RenderRequest request;
    request.width = request.height = side;
    request.shading = prep::Shading::normal_mapped;
    request.threads = threads;
    request.view = flat_view(0.5);
    request.view->world_to_view[3] = glm::dvec4(-0.5, -0.5, -50, 1);
    rast::LightInstance sun;
    sun.direction = -towards;
    request.lights = {sun};
    request.keep_normals = true;
    return request;
}

// At the centres of pixels, from the top left one on.
std::vector<Vector> true_normals() {
    std::vector<Vector> normals;
    for (std::uint32_t j = 0; j < side; ++j)
        for (std::uint32_t i = 0; i < side; ++i)
            normals.push_back(wave_normal((Real(i) + Real(0.5)) / side,
                                          1 - (Real(j) + Real(0.5)) / side, relief_height));
    return normals;
}

Pixels lit(const std::vector<Vector>& normals, const Vector& towards) {
    Pixels out{side, side, 1, {}};
    for (const Vector& n : normals)
        out.values.push_back(double(std::max(Real(0), glm::dot(n, towards))));
    return out;
}

struct Row {
    Shown shown;
    const char *name, *command, *because;
    std::vector<int> sizes;
    std::vector<const char*> chord_errors;
};

std::vector<Row> rows() {
    return {{Shown::bump,
             "bump map",
             "render --shading normal-mapped",
             "slopes are taken to the surface by gradients of UVs, at each pixel",
             {32, 64, 128, 256},
             {""}},
            {Shown::normal_map,
             "normal map",
             "render --shading normal-mapped --filter trilinear",
             "larger maps take longer to read",
             {32, 64, 128, 256},
             {""}},
            {Shown::displaced,
             "displaced",
             "prepare --displace materials --height-filter bicubic --chord-error ",
             "chord errors bound positions: normals between vertices are off by more, and heights "
             "that are seen from above move nothing in the picture",
             {256},
             {"0.003", "0.001", "0.0003", "0.0001"}}};
}

// Without its rungs.
Ladder described() {
    Ladder ladder;
    ladder.name = "relief";
    ladder.title = "Bump maps, normal maps and displaced triangles";
    ladder.setting = "pictures: what heights are made into, from how many texels, to what error";
    ladder.subject = fmt::format(
        "a unit square seen from above, {0} × {0} pixels, with a wave of up to two turns and a "
        "height of 0.05 in maps of 16 bits; displaced by 256²",
        side);
    ladder.oracle = "normals of the wave in closed form, and what one light makes of them";
    ladder.timed = {"plan", "transform, visibility and shading (one map or none, one light)",
                    "not: making normal maps and triangles, reading maps, making their levels"};
    constexpr const char* domain = "of normals as they are lit, at the centres of pixels";
    ladder.metrics = {{"largest", "°", domain},
                      {"99.9 %", "°", domain},
                      {"mean", "°", domain},
                      {"RMSE", "", "linear light"},
                      {"triangles", "", ""}};
    ladder.reference_is_default = false;
    return ladder;
}

struct Truth {
    std::vector<Vector> normals;
    Pixels picture;
};

prep::Result<Rung> rung_of(const Row& row, int size, const std::string& chord_error,
                           const glm::dvec3& towards, const std::shared_ptr<Truth>& truth,
                           int threads) {
    const auto scene = scene_shown(heights_of(size), row.shown,
                                   std::strtod(chord_error.c_str(), nullptr), threads);
    if (!scene) return scene.error();
    Rung rung;
    rung.name = row.shown == Shown::displaced ? fmt::format("{}, {}", row.name, chord_error)
                                              : fmt::format("{}, {}²", row.name, size);
    rung.command = row.command + chord_error;
    rung.because = row.because;
    const auto drawing = std::make_shared<Drawing>(*scene, request_of(towards, threads));
    rung.run = [drawing] { return drawing->draw(); };
    rung.judge = [truth, drawing, triangles = double((*scene)->meshes[0].triangle_count())] {
        std::vector<double> errors;
        for (std::size_t p = 0; p < truth->normals.size(); ++p)
            errors.push_back(
                degrees_between(Vector(drawing->frame().normal[p]), truth->normals[p]));
        std::vector<double> numbers = three_of(errors);
        numbers.push_back(picture_error(first_channel(drawing->frame()), truth->picture).rmse);
        numbers.push_back(triangles);
        return numbers;
    };
    rung.look = [truth, drawing] {
        return look_of(first_channel(drawing->frame()), truth->picture);
    };
    return rung;
}

}  // namespace

prep::Result<Ladder> relief_ladder(const Subject& subject) {
    const Vector towards = Vector(2, 3, 6) / Real(7);
    const auto truth = std::make_shared<Truth>();
    truth->normals = true_normals();
    truth->picture = lit(truth->normals, towards);

    Ladder ladder = described();
    for (const Row& row : rows())
        for (const int size : row.sizes)
            for (const char* const chord_error : row.chord_errors) {
                prep::Result<Rung> rung =
                    rung_of(row, size, chord_error, glm::dvec3(towards), truth, subject.threads);
                if (!rung) return rung.error();
                if (row.shown == Shown::normal_map && size == 64)
                    ladder.reference = ladder.rungs.size();
                ladder.rungs.push_back(*std::move(rung));
            }
    return ladder;
}

}  // namespace cost
