// Flat, Gouraud and Phong shading of a sphere over rising tessellation, against the sphere itself.
#include <cmath>

#include "cost/ladders/scenes.h"
#include "cost/oracles/pictures.h"
#include "prep/enum_names.h"
#include "shapes.h"

namespace cost {
namespace {

constexpr std::uint32_t ball_width = 192, ball_height = 144;

// Which pixels the sphere of so many triangles covers fully, as it is seen from +z.
std::vector<bool> covered_by(const prep::Mesh& shape, const LitSphere& look) {
    const Real scale = Real(ball_height) / (2 * Real(look.half));
    std::vector<Triangle2> triangles;
    for (std::size_t c = 0; c < shape.corner_vertices.size(); c += 3) {
        Triangle2 triangle;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3& p = shape.positions[shape.corner_vertices[c + k]];
            triangle[k] = {Real(ball_width) / 2 + p.x * scale, Real(ball_height) / 2 - p.y * scale};
        }
        triangles.push_back(triangle);
    }
    std::vector<bool> covered;
    for (const double area : sampled_coverage(triangles, ball_width, ball_height).values)
        covered.push_back(area == 1);
    return covered;
}

std::shared_ptr<const prep::PreparedScene> ball(const prep::Mesh& shape, const LitSphere& look) {
    prep::VertexMesh mesh;
    mesh.positions = mesh.normals = shape.positions;
    mesh.indices = shape.corner_vertices;
    prep::Material material;
    material.diffuse = glm::vec4(glm::vec3(float(look.diffuse)), 1);
    material.specular = glm::vec3(float(look.specular));
    material.shininess = float(look.shininess);
    return std::make_shared<const prep::PreparedScene>(scene_of(std::move(mesh), material));
}

rast::RenderRequest request_of(const LitSphere& look, prep::Shading shading, int threads) {
    rast::RenderRequest request;
    request.width = ball_width;
    request.height = ball_height;
    request.shading = shading;
    request.supersample = 3;
    request.threads = threads;
    request.view = flat_view(look.half);
    rast::LightInstance ambient, sun;
    ambient.kind = prep::LightKind::ambient;
    ambient.color = glm::vec3(float(look.ambient));
    sun.direction = -glm::dvec3(look.towards);
    sun.color = glm::vec3(float(look.light));
    request.lights = {ambient, sun};
    return request;
}

}  // namespace

prep::Result<Ladder> shading_frequency_ladder(const Subject& subject) {
    struct State {
        Pixels truth;
        std::vector<bool> shared, rest;
    };
    LitSphere look;
    look.towards = Vector(2, 3, 6) / Real(7);
    const auto s = std::make_shared<State>();
    s->truth = lit_sphere(look, ball_width, ball_height, 12);
    LitSphere shape = look;  // white where the sphere is
    shape.ambient = 1;
    shape.diffuse = 1;
    shape.light = 0;
    const Pixels area = lit_sphere(shape, ball_width, ball_height, 12);
    // Shading is judged where every rung has something to shade: which pixels a coarse ball misses
    // is no matter of shading. Finer balls lie around coarser ones, whose vertices they share.
    const std::vector<bool> coarsest = covered_by(shapes::icosphere(1), look);
    std::size_t shared = 0;
    for (std::size_t i = 0; i < area.values.size(); ++i) {
        const bool within = area.values[i] > 0.999 && coarsest[i];
        s->shared.push_back(within);
        s->rest.push_back(area.values[i] > 0.001 && !within);
        shared += within;
    }

    Ladder ladder;
    ladder.name = "shading-frequency";
    ladder.title = "Shading frequency";
    ladder.setting = "pictures: --shading, over the triangles of a sphere";
    ladder.subject = "a sphere of 80 to 20,480 triangles, 192 × 144 pixels, 9 samples each";
    ladder.oracle = "the sphere itself, lit at 144 samples a pixel by a plain loop in long double";
    ladder.timed = {"plan", "transform, visibility and shading", "mean of the samples"};
    const std::string domain = "linear light, the " + std::to_string(shared) +
                               " pixels that the ball of 80 triangles covers fully";
    ladder.metrics = {
        {"RMSE", "", domain},
        {"largest", "", domain},
        {"RMSE, rest", "", "linear light, the sphere's other pixels: also what is missing"},
        {"PSNR", "dB", domain}};
    // 9 samples instead of 144 of the same sphere.
    ladder.floor =
        picture_error(lit_sphere(look, ball_width, ball_height, 3), s->truth, s->shared).rmse;
    ladder.reference_is_default = false;
    ladder.floor_text = "the sphere itself with as many samples as are drawn";
    constexpr prep::Shading shadings[] = {prep::Shading::flat, prep::Shading::gouraud,
                                          prep::Shading::phong};
    constexpr int levels = 5;
    GridSetting shading{"shading", {}}, triangles{"triangles", {}};
    for (const prep::Shading kind : shadings) shading.values.emplace_back(prep::name_of(kind));
    std::vector<std::shared_ptr<const prep::PreparedScene>> scenes;
    for (int level = 1; level <= levels; ++level) {
        triangles.values.push_back(std::to_string(20 << (2 * level)));
        scenes.push_back(ball(shapes::icosphere(level), look));
    }
    ladder.reference = 2 * levels + 3;  // phong, 5120
    make_grid(ladder, shading, triangles, [&](std::size_t i, std::size_t j) {
        const auto drawing =
            std::make_shared<Drawing>(scenes[j], request_of(look, shadings[i], subject.threads));
        Rung rung;
        rung.command = "render --supersample 3 --shading " + shading.values[i];
        rung.run = [drawing] { return drawing->draw(); };
        rung.judge = [s, drawing] {
            const Pixels picture = first_channel(drawing->frame());
            const PictureError within = picture_error(picture, s->truth, s->shared);
            return std::vector<double>{within.rmse, within.largest,
                                       picture_error(picture, s->truth, s->rest).rmse, within.psnr};
        };
        rung.look = [s, drawing] { return look_of(first_channel(drawing->frame()), s->truth); };
        if (shadings[i] != prep::Shading::phong)
            rung.because =
                "triangles cost time too: normals between vertices are worth more than as many "
                "more vertices";
        return rung;
    });
    return ladder;
}

}  // namespace cost
