// A ball under two lights, from whose plans something is left out.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "random_pictures.h"

namespace test {

// How often each thing was left out of a plan, by the code of its reason.
inline std::map<std::string, int> proved_zero(const rast::RenderPlan& plan) {
    std::map<std::string, int> codes;
    for (const rast::PlanStep& step : plan.steps)
        for (const prep::Reason& why : step.reasons)
            if (why.label == prep::ReasonLabel::proved_zero)
                ++codes[std::string(prep::name_of(why.code))];
    return codes;
}

struct StepText {
    bool run;
    std::string text;
};
inline std::map<std::string, StepText> steps_of(const rast::RenderPlan& plan) {
    std::map<std::string, StepText> out;
    for (const rast::PlanStep& s : plan.steps) {
        std::string text = s.reason + "|" + std::string(prep::name_of(s.label));
        for (const prep::Reason& r : s.reasons)
            text += "|" + std::string(prep::name_of(r.code)) + " " + r.subject + " " +
                    std::to_string(r.value);
        out[std::string(prep::name_of(s.kind))] = {s.run, text};
    }
    return out;
}
// The steps that two plans tell differently.
inline std::set<std::string> changed(const rast::RenderPlan& a, const rast::RenderPlan& b) {
    const auto x = steps_of(a), y = steps_of(b);
    std::set<std::string> names;
    for (const auto& [name, step] : x)
        if (y.at(name).text != step.text || y.at(name).run != step.run) names.insert(name);
    return names;
}

// A ball with UVs and tangents.
inline prep::PreparedScene stage_of(const prep::Material& material,
                                    const std::vector<prep::ImageRef>& images = {}) {
    prep::VertexMesh ball = sphere(40, 30);
    for (const glm::vec3& n : ball.normals)
        ball.tangents.push_back(
            glm::vec4(glm::normalize(glm::cross(glm::vec3(0.1f, 1, 0.2f), n)), 1.0f));
    prep::PreparedScene scene = scene_of(std::move(ball), material);
    for (const prep::ImageRef& image : images) {
        prep::Texture texture;
        texture.image = std::uint32_t(scene.scene.images.size());
        scene.scene.images.push_back(image);
        scene.scene.textures.push_back(texture);
    }
    return scene;
}

inline rast::LightInstance light_of(prep::LightKind kind, glm::vec3 color, glm::dvec3 position,
                                    glm::dvec3 direction, float range = 0) {
    rast::LightInstance light;
    light.kind = kind;
    light.color = color;
    light.position = position;
    light.direction = glm::normalize(direction);
    light.range = range;
    return light;
}

inline std::vector<rast::LightInstance> usual_lights() {
    return {light_of(prep::LightKind::directional, glm::vec3(0.7f), {}, {-0.3, -0.5, -1}),
            light_of(prep::LightKind::ambient, glm::vec3(0.1f), {}, {0, 0, -1})};
}

inline rast::RenderRequest stage_request() {
    rast::RenderRequest request;
    request.width = 120;
    request.height = 90;
    request.view = look_at({0, 0.3, 3}, {0, 0, 0});
    request.lights = usual_lights();
    return request;
}

// Whether the plan leaves something out for this reason; the picture must not show it.
inline bool is_skipped(const char* code, const prep::PreparedScene& scene,
                       const rast::RenderRequest& request) {
    const Drawing drawing = draw_knowing_texels(scene, request);
    EXPECT_EQ(differing(drawing.frame, draw_in_full(scene, request)), "") << code;
    return proved_zero(drawing.plan).count(code) > 0;
}

// A way of drawing that everything left out must stand: a column of the table in
// docs/architecture.md.
struct Way {
    const char* name;
    void (*ask)(rast::RenderRequest&);
};
inline constexpr Way ways[] = {
    {"crop",
     [](rast::RenderRequest& r) {
         r.crop = rast::Crop{17, 9, 50, 52};
     }},
    {"bands", [](rast::RenderRequest& r) { r.band_bytes = 120 * 16 * 20; }},
    {"MSAA", [](rast::RenderRequest& r) { r.samples = 4; }},
    {"supersampling", [](rast::RenderRequest& r) { r.supersample = 2; }},
    {"exact areas", [](rast::RenderRequest& r) { r.coverage = rast::Coverage::area; }},
    {"bytes", [](rast::RenderRequest& r) { r.pixels = rast::PixelFormat::bytes; }},
    {"Gouraud", [](rast::RenderRequest& r) { r.shading = rast::Shading::gouraud; }},
};

// In bands, put together again.
inline rast::Frame in_bands(const prep::PreparedScene& scene, const rast::RenderPlan& plan) {
    rast::Frame all;
    const auto take = [&](const rast::Frame& band, std::uint32_t) -> prep::Result<void> {
        all.color.insert(all.color.end(), band.color.begin(), band.color.end());
        all.bytes.insert(all.bytes.end(), band.bytes.begin(), band.bytes.end());
        return {};
    };
    const auto done = rast::render_bands(scene, plan, take);
    if (!done) throw std::runtime_error(to_string(done.error()));
    return all;
}

}  // namespace test
