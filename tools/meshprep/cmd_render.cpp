#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "meshprep/commands.h"
#include "meshprep/file_list.h"
#include "meshprep/render_words.h"
#include "meshprep/report_json.h"
#include "prep/image.h"
#include "prep/io.h"
#include "prep/scene_json.h"
#include "rast/render.h"

namespace meshprep {
namespace {

using Clock = std::chrono::steady_clock;
using prep::Error;
using prep::ErrorCode;
using prep::Result;

constexpr double degrees = std::numbers::pi / 180;

double since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Result<prep::JsonScene> load(const std::filesystem::path& path, int threads) {
    if (lower_ending(path) == "json") return prep::load_scene_json(path, {threads});
    Result<prep::Scene> scene = prep::load_scene(path, {threads});
    if (!scene) return scene.error();
    return prep::JsonScene{*std::move(scene), {}};
}

// A node with a camera, by the node's or the camera's name, or the n-th of them.
Result<std::uint32_t> find_camera(const prep::Scene& scene, const std::string& text) {
    std::vector<std::uint32_t> nodes;
    std::string names;
    for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
        if (scene.nodes[n].camera == prep::no_index) continue;
        const std::string& camera = scene.cameras[scene.nodes[n].camera].name;
        if (scene.nodes[n].name == text || camera == text) return n;
        const std::string& name = scene.nodes[n].name.empty() ? camera : scene.nodes[n].name;
        names += (nodes.empty() ? "" : ", ") + std::to_string(nodes.size()) +
                 (name.empty() ? "" : " '" + name + "'");
        nodes.push_back(n);
    }
    if (!text.empty() && text.find_first_not_of("0123456789") == std::string::npos &&
        text.size() < 10) {
        const auto index = static_cast<std::size_t>(std::stoul(text));
        if (index < nodes.size()) return nodes[index];
    }
    return Error{
        ErrorCode::invalid,
        "no camera '" + text + "' in the scene; " +
            (nodes.empty() ? "it has none: give --camera AZIMUTH,ELEVATION" : "it has " + names),
        scene.source.string()};
}

rast::View orbit(const prep::PreparedScene& prepared, const OrbitChoice& choice, double aspect) {
    rast::OrbitOptions options;
    options.azimuth_degrees = choice.azimuth;
    options.elevation_degrees = choice.elevation;
    options.aspect = aspect;
    if (choice.distance != 1) {
        const std::optional<rast::Bounds> bounds = rast::world_bounds(prepared);
        const glm::dvec3 centre = bounds ? bounds->centre() : glm::dvec3(0);
        options.distance =
            choice.distance * glm::length(rast::orbit_view(prepared, options).eye() - centre);
    }
    return rast::orbit_view(prepared, options);
}

rast::LightInstance ambient_light(float intensity) {
    rast::LightInstance ambient;
    ambient.kind = prep::LightKind::ambient;
    ambient.color = glm::vec3(intensity);
    return ambient;
}

// The lights asked for, about the view; those of the plan with another ambient light where only
// that was asked for.
std::vector<rast::LightInstance> lights_of(const RenderCommand& command,
                                           const rast::RenderPlan& plan) {
    std::vector<rast::LightInstance> lights;
    if (command.lights.empty()) {
        for (const rast::LightInstance& light : plan.lights)
            if (light.kind != prep::LightKind::ambient) lights.push_back(light);
    }
    const glm::dmat3 to_world = glm::transpose(glm::dmat3(plan.view.world_to_view));
    for (const LightChoice& choice : command.lights) {
        const double a = choice.azimuth * degrees, e = choice.elevation * degrees;
        const glm::dvec3 from(std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e));
        rast::LightInstance light;
        light.kind = prep::LightKind::directional;
        light.direction = to_world * -from;
        light.color = glm::vec3(choice.intensity);
        lights.push_back(light);
    }
    lights.push_back(ambient_light(command.ambient.value_or(0.1f)));
    return lights;
}

// The command line first, then the scene file's wishes, then the renderer's defaults.
Result<rast::RenderRequest> request_of(const RenderCommand& command,
                                       const prep::PictureSettings& picture,
                                       const prep::PreparedScene& prepared) {
    rast::RenderRequest request;
    request.threads = command.common.threads;
    const std::optional<glm::uvec2> size = command.size ? command.size : picture.size;
    if (size) {
        request.width = size->x;
        request.height = size->y;
    }
    if (command.shading)
        request.shading = *command.shading;
    else if (picture.shading)
        request.shading = value_of(shading_words(), *picture.shading);
    if (command.cull)
        request.cull = *command.cull;
    else if (picture.cull)
        request.cull = value_of(cull_words(), *picture.cull);
    if (command.filter)
        request.filter = *command.filter;
    else if (picture.filter)
        request.filter = value_of(filter_words(), *picture.filter);
    request.background =
        command.background.value_or(picture.background.value_or(request.background));
    request.textures = command.textures;
    request.samples = command.samples;

    const double aspect = static_cast<double>(request.width) / request.height;
    if (const auto* choice = std::get_if<OrbitChoice>(&command.camera)) {
        request.view = orbit(prepared, *choice, aspect);
    } else if (const auto* name = std::get_if<std::string>(&command.camera)) {
        const Result<std::uint32_t> node = find_camera(prepared.scene, *name);
        if (!node) return node.error();
        request.view = rast::camera_view(prepared.scene, *node);
    } else if (picture.orbit_azimuth) {
        request.view = orbit(prepared,
                             {*picture.orbit_azimuth / degrees, *picture.orbit_elevation / degrees,
                              *picture.orbit_distance},
                             aspect);
    }
    if (!command.lights.empty() || command.ambient) {
        // The plan knows the view and the lights there would be otherwise.
        const Result<rast::RenderPlan> plan = rast::plan(prepared, request);
        if (!plan) return plan.error();
        request.lights = lights_of(command, *plan);
    }
    return request;
}

bool keeps_float(const std::filesystem::path& path) {
    const std::string ending = lower_ending(path);
    return ending == "exr" || ending == "hdr" || ending == "pfm";
}

// Linear, for formats that hold it.
prep::Image linear_image(const rast::Frame& frame, float exposure) {
    prep::Image image;
    image.width = frame.width;
    image.height = frame.height;
    image.channels = 4;
    image.pixels.reserve(frame.color.size() * 4);
    for (const glm::vec4& c : frame.color)
        for (const float v : {c.r * exposure, c.g * exposure, c.b * exposure, c.a})
            image.pixels.push_back(v);
    return image;
}

Json plan_json(const rast::RenderPlan& plan) {
    Json json;
    json["width"] = plan.request.width;
    json["height"] = plan.request.height;
    json["shading"] = word_of(shading_words(), plan.request.shading);
    json["triangles"] = plan.triangles;
    json["lights"] = plan.lights.size();
    json["memory_estimate"] = plan.memory_estimate;
    json["steps"] = Json::array();
    for (const rast::PlanStep& s : plan.steps)
        json["steps"].push_back({{"step", s.name}, {"run", s.run}, {"reason", s.reason}});
    return json;
}

Json counters_json(const rast::Counters& c) {
    return {{"triangles", c.triangles},   {"non_finite", c.non_finite},
            {"degenerate", c.degenerate}, {"facing_away", c.facing_away},
            {"outside", c.outside},       {"between_samples", c.between_samples},
            {"crossing", c.crossing},     {"pixels_shaded", c.pixels_shaded}};
}

Result<Json> render_file(const RenderCommand& command, Console& console) {
    const CommonOptions& common = command.common;
    if (const Result<void> there = require_file(command.input); !there) return there.error();
    if (const Result<void> parent = require_parent(command.output); !parent) return parent.error();
    std::error_code ec;
    if (std::filesystem::equivalent(command.input, command.output, ec))
        return Error{ErrorCode::invalid, "the picture would be written over the input",
                     command.output.string()};

    console.progress(common, command.input.string() + " … reading");
    Clock::time_point start = Clock::now();
    Result<prep::JsonScene> loaded = load(command.input, common.threads);
    if (!loaded) return loaded.error();
    const double read_ms = since(start);
    for (const std::string& text : loaded->scene.warnings)
        console.warning(common, command.input.string() + ": " + text);

    console.progress(common, command.input.string() + " … preparing");
    start = Clock::now();
    prep::PrepareOptions options = command.prepare;
    options.threads = common.threads;
    const Result<prep::PreparedScene> prepared = prep::prepare(std::move(loaded->scene), options);
    if (!prepared) return prepared.error();
    const double prepare_ms = since(start);

    const Result<rast::RenderRequest> request = request_of(command, loaded->picture, *prepared);
    if (!request) return request.error();
    const Result<rast::RenderPlan> plan = rast::plan(*prepared, *request);
    if (!plan) return plan.error();
    for (const std::string& text : plan->warnings) console.warning(common, text);

    console.progress(common, command.input.string() + " … drawing");
    start = Clock::now();
    const Result<rast::Frame> frame = rast::render(*prepared, *plan);
    if (!frame) return frame.error();
    const double render_ms = since(start);
    for (const std::string& text : frame->warnings) console.warning(common, text);

    rast::ToneOptions tone;
    tone.exposure = command.exposure;
    tone.tone_map =
        command.tone_map.value_or(loaded->picture.tone_map.value_or("off") == "reinhard");
    const bool linear = keeps_float(command.output);
    start = Clock::now();
    const Result<void> saved = prep::save_image(
        command.output,
        linear ? linear_image(*frame, command.exposure) : rast::to_srgb(*frame, tone),
        linear ? prep::PixelType::f32 : prep::PixelType::u8);
    if (!saved) return saved.error();
    const double write_ms = since(start);

    if (command.explain) {
        std::vector<std::vector<std::string>> rows;
        for (const rast::PlanStep& s : plan->steps)
            rows.push_back({s.name, s.run ? "run" : "skipped", s.reason});
        for (const std::string& line : align_table(rows, {})) console.result(common, line);
        console.result(common, fmt::format("  {}, about {} beside textures",
                                           count_of(plan->triangles, "triangle"),
                                           byte_size(plan->memory_estimate)));
    }
    console.result(common,
                   fmt::format("{} → {}  {}×{}, {}, {}; read {}, prepare {}, draw {}, write {}",
                               command.input.string(), command.output.string(), frame->width,
                               frame->height, word_of(shading_words(), plan->request.shading),
                               count_of(plan->triangles, "triangle"), duration(read_ms),
                               duration(prepare_ms), duration(render_ms), duration(write_ms)));
    Json json;
    json["input"] = command.input.string();
    json["output"] = command.output.string();
    json["plan"] = plan_json(*plan);
    json["counters"] = counters_json(frame->counters);
    json["warnings"] = plan->warnings;
    for (const std::string& text : frame->warnings) json["warnings"].push_back(text);
    json["milliseconds"] = {
        {"read", read_ms}, {"prepare", prepare_ms}, {"render", render_ms}, {"write", write_ms}};
    return json;
}

}  // namespace

int run_render(const RenderCommand& command, Console& console) {
    Json document = json_head("render");
    const Result<Json> done = render_file(command, console);
    if (done)
        document.update(*done);
    else
        document["error"] = to_json(done.error());
    if (!done) console.error(done.error());
    console.progress(command.common, "");
    if (command.common.json) console.json(json_text(document));
    return done ? exit_done : exit_failed;
}

}  // namespace meshprep
