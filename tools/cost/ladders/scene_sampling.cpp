// Samples and supersampling of a whole scene: with its camera, lights, materials and textures.
#include <cmath>

#include "cost/ladders/meshes.h"
#include "cost/ladders/scenes.h"
#include "cost/oracles/pictures.h"

namespace cost {
namespace {

constexpr std::uint32_t truth_factor = 16;

// A torus under the renderer's own lights, on which the highlights are small.
ScenePicture shiny_torus(int threads) {
    const KnownMesh known = known_torus(96, 48, 0);
    prep::VertexMesh mesh;
    mesh.positions = known.mesh.positions;
    mesh.indices = known.mesh.corner_vertices;
    for (const SurfaceSample& at : known.at) mesh.normals.emplace_back(at.normal);
    prep::Material material;
    material.diffuse = glm::vec4(0.6f, 0.35f, 0.2f, 1);
    material.specular = glm::vec3(0.5f);
    material.shininess = 80;
    ScenePicture out;
    out.scene = std::make_shared<const prep::PreparedScene>(scene_of(std::move(mesh), material));
    out.request.threads = threads;
    return out;
}

rast::RenderRequest sampled(const rast::RenderRequest& request, int samples, int supersample,
                            bool area) {
    rast::RenderRequest out = request;
    out.width = scene_width;
    out.height = scene_height;
    out.samples = samples;
    out.supersample = supersample;
    out.coverage = area ? prep::Coverage::area : prep::Coverage::samples;
    return out;
}

Pixels three_channels(const rast::Frame& frame) {
    Pixels out{frame.width, frame.height, 3, {}};
    out.values.reserve(3 * frame.color.size());
    for (const glm::vec4& c : frame.color)
        for (int k = 0; k < 3; ++k) out.values.push_back(double(c[k]));
    return out;
}

Pixels first_of(const Pixels& picture) {
    Pixels out{picture.width, picture.height, 1, {}};
    for (std::size_t at = 0; at < picture.values.size(); at += picture.channels)
        out.values.push_back(picture.values[at]);
    return out;
}

}  // namespace

prep::Result<Ladder> scene_sampling_ladder(const Subject& subject) {
    const ScenePicture picture = subject.picture ? *subject.picture : shiny_torus(subject.threads);
    rast::RenderRequest fine = sampled(picture.request, 1, 1, false);
    fine.width *= truth_factor;
    fine.height *= truth_factor;
    Drawing large(picture.scene, fine);
    if (const prep::Result<void> done = large.draw(); !done) return done.error();
    const auto truth =
        std::make_shared<const Pixels>(box_means(three_channels(large.frame()), truth_factor));

    Ladder ladder;
    ladder.name = "scene-sampling";
    ladder.title = "Samples and supersampling of a scene";
    ladder.setting = "pictures: --samples, --supersample and --coverage";
    ladder.subject = (subject.picture ? subject.name + ", its camera, lights and materials"
                                      : std::string("a shining torus")) +
                     ", 160 × 120 pixels";
    ladder.oracle =
        "the means of 16 × 16 pixels of a picture of 16 times the width and height, which knows "
        "neither samples nor supersampling; its shading is the renderer's own";
    ladder.timed = {"plan", "transform, visibility and shading", "resolve"};
    ladder.metrics = {{"RMSE", "", "linear light"},
                      {"largest", "", "linear light"},
                      {"PSNR", "dB", "linear light"}};
    struct Setting {
        int samples = 1, supersample = 1;
        bool area = false;
    };
    std::vector<Setting> settings;
    for (const int n : {1, 2, 4, 8, 16}) settings.push_back({n});
    for (const int n : {2, 4, 8}) settings.push_back({1, n});
    settings.push_back({1, 1, true});
    for (const Setting& s : settings) {
        Rung rung;
        if (s.area) {
            rung.name = "exact areas";
            rung.command = "render --coverage area";
        } else if (s.supersample > 1) {
            rung.name = "supersample " + std::to_string(s.supersample);
            rung.command = "render --supersample " + std::to_string(s.supersample);
        } else {
            rung.name = std::to_string(s.samples) + (s.samples == 1 ? " sample" : " samples");
            rung.command = "render --samples " + std::to_string(s.samples);
        }
        if (s.supersample > 1)
            rung.because =
                "a grid has fewer different places across an edge than as many samples at standard "
                "ones";
        else if (s.samples > 1)
            rung.because =
                "samples are of outlines: each triangle is shaded once a pixel, and what "
                "lies between texels or in a highlight stays as it was";
        const auto drawing = std::make_shared<Drawing>(
            picture.scene, sampled(picture.request, s.samples, s.supersample, s.area));
        rung.run = [drawing] { return drawing->draw(); };
        rung.judge = [drawing, truth] {
            const PictureError e = picture_error(three_channels(drawing->frame()), *truth);
            return std::vector<double>{e.rmse, e.largest, e.psnr};
        };
        rung.look = [drawing, truth] {
            return look_of(first_channel(drawing->frame()), first_of(*truth));
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
