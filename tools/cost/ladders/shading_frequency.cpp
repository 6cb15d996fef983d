// Flat, Gouraud and Phong shading of a sphere over rising tessellation, against the sphere itself.
#include <cmath>
#include <map>

#include "cost/ladders/scenes.h"
#include "cost/oracles/pictures.h"
#include "prep/enum_names.h"
#include "shapes.h"

namespace cost {
namespace {

constexpr std::uint32_t width = 192, height = 144;

std::shared_ptr<const prep::PreparedScene> ball(int level, const LitSphere& look) {
    const prep::Mesh shape = shapes::icosphere(level);
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
    request.width = width;
    request.height = height;
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
        std::vector<bool> inside, outline;
    };
    LitSphere look;
    look.towards = Vector(2, 3, 6) / Real(7);
    const auto s = std::make_shared<State>();
    s->truth = lit_sphere(look, width, height, 12);
    LitSphere shape = look;  // white where the sphere is
    shape.ambient = 1;
    shape.diffuse = 1;
    shape.light = 0;
    const Pixels area = lit_sphere(shape, width, height, 12);
    for (const double a : area.values) {
        s->inside.push_back(a > 0.999);
        s->outline.push_back(a > 0.001 && a < 0.999);
    }

    Ladder ladder;
    ladder.name = "shading-frequency";
    ladder.title = "Shading frequency";
    ladder.setting = "pictures: --shading, over the triangles of a sphere";
    ladder.subject = "a sphere of 80 to 20,480 triangles, 192 × 144 pixels, 9 samples each";
    ladder.oracle = "the sphere itself, lit at 144 samples a pixel by a plain loop in long double";
    ladder.timed = {"plan", "transform, visibility and shading", "mean of the samples"};
    ladder.metrics = {{"RMSE", "", "linear light, within the outline"},
                      {"largest", "", "linear light, within the outline"},
                      {"RMSE, outline", "", "linear light, pixels that the outline runs through"},
                      {"PSNR", "dB", "linear light, within the outline"}};
    // 9 samples instead of 144 of the same sphere.
    ladder.floor = picture_error(lit_sphere(look, width, height, 3), s->truth, s->inside).rmse;
    ladder.floor_text = "the sphere itself with as many samples as are drawn";
    std::map<int, std::shared_ptr<const prep::PreparedScene>> balls;
    for (const int level : {1, 2, 3, 4, 5}) {
        const auto scene = balls[level] = ball(level, look);
        for (const prep::Shading shading :
             {prep::Shading::flat, prep::Shading::gouraud, prep::Shading::phong}) {
            const auto drawing =
                std::make_shared<Drawing>(scene, request_of(look, shading, subject.threads));
            const std::string word(prep::name_of(shading));
            Rung rung;
            rung.name = word + ", " + std::to_string(20 << (2 * level));
            rung.command = "render --supersample 3 --shading " + word;
            rung.run = [drawing] { return drawing->draw(); };
            rung.judge = [s, drawing] {
                const Pixels picture = first_channel(drawing->frame());
                const PictureError within = picture_error(picture, s->truth, s->inside);
                return std::vector<double>{within.rmse, within.largest,
                                           picture_error(picture, s->truth, s->outline).rmse,
                                           within.psnr};
            };
            if (level == 4 && shading == prep::Shading::phong)
                ladder.reference = ladder.rungs.size();
            ladder.rungs.push_back(std::move(rung));
        }
    }
    return ladder;
}

}  // namespace cost
