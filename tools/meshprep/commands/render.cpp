#include "rast/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "meshprep/budgets/explicit_command.h"
#include "meshprep/budgets/render_budget.h"
#include "meshprep/budgets/time_budget.h"
#include "meshprep/commands/render_command.h"
#include "meshprep/commands/render_views.h"
#include "meshprep/commands/subcommand.h"
#include "meshprep/files/file_list.h"
#include "meshprep/files/input_file.h"
#include "meshprep/files/output_directories.h"
#include "meshprep/output/drawing_report.h"
#include "meshprep/output/load_options.h"
#include "meshprep/output/report_json.h"
#include "prep/files.h"
#include "prep/image.h"
#include "prep/load.h"
#include "prep/scene_json.h"
#include "rast/exposure.h"

namespace meshprep {
namespace {

using prep::Error;
using prep::ErrorCode;
using prep::Result;

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
        const double a = choice.azimuth * radians_per_degree,
                     e = choice.elevation * radians_per_degree;
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

// What must not be written over.
std::vector<std::filesystem::path> files_read(const RenderCommand& command,
                                              const prep::PreparedScene& prepared) {
    std::vector<std::filesystem::path> files = prepared.scene.libraries;
    files.push_back(command.input);
    if (command.prepare.displacement.map) files.push_back(command.prepare.displacement.map->path);
    for (const prep::ImageRef& image : prepared.scene.images)
        for (std::filesystem::path& file : files_of(image)) files.push_back(std::move(file));
    return files;
}

// The command line first, then the scene file's wishes, then the renderer's defaults.
rast::RenderRequest request_of(const RenderCommand& command, prep::RenderWishes picture) {
    // Several samples exclude exact areas: what the command line says of one overrules the file's
    // other.
    const prep::RenderChoices& own = command.wishes.choices;
    if (own.coverage == prep::Coverage::area) picture.given.erase("samples");
    if (own.samples > 1) picture.given.erase("coverage");
    rast::RenderRequest request;
    prep::RenderChoices& choices = request;
    choices = with_wishes(with_wishes(choices, picture), command.wishes);
    request.threads = command.common.threads;
    request.textures = command.textures;
    request.crop = command.crop;
    request.band_bytes = std::uint64_t(command.band_mib) << 20;
    keep(request, command.buffers);
    return request;
}

// Between dark and light models, and of a tint that neither has.
constexpr glm::vec3 file_background{0.10f, 0.13f, 0.16f};

bool has_lights(const prep::Scene& scene) {
    return std::any_of(scene.nodes.begin(), scene.nodes.end(),
                       [](const prep::Node& node) { return node.light != prep::no_index; });
}

// The request for one of the pictures.
Result<rast::RenderPlan> plan_of(const RenderCommand& command, const prep::PreparedScene& prepared,
                                 rast::RenderRequest request,
                                 const std::optional<rast::View>& view) {
    request.view = view;
    if (!command.lights.empty() || command.ambient) {
        // The plan knows the view and the lights there would be otherwise.
        const Result<rast::RenderPlan> plan = rast::plan(prepared, request);
        if (!plan) return plan.error();
        request.lights = lights_of(command, *plan);
    }
    return rast::plan(prepared, request);
}

Result<Drawn> draw(rast::SceneRenderer& renderer, const rast::RenderPlan& plan,
                   prep::ImageFiles& files, const OutputOptions& options) {
    const Clock::time_point start = Clock::now();
    Drawn drawn;
    RenderOutputs outputs(files, options);
    if (const Result<void> opened = outputs.open(plan); !opened) return opened.error();
    drawn.write_ms = milliseconds_since(start);
    Result<rast::Frame> frame =
        renderer.render_bands(plan, [&](const rast::Frame& band, std::uint32_t) -> Result<void> {
            drawn.black.count(band, options.choices.exposure);
            const Clock::time_point before = Clock::now();
            Result<void> written = outputs.write(band);
            drawn.write_ms += milliseconds_since(before);
            return written;
        });
    if (!frame) return frame.error();
    drawn.frame = *std::move(frame);
    drawn.paths = outputs.paths();
    drawn.draw_ms = milliseconds_since(start) - drawn.write_ms;
    return drawn;
}

// Errors, io apart, are mistakes in the command line.
Result<void> check_files(const RenderCommand& command) {
    if (!is_standard_stream(command.input))
        if (const Result<void> there = require_file(command.input); !there) return there.error();
    std::error_code ec;
    if (std::filesystem::equivalent(command.input, command.output, ec))
        return Error{ErrorCode::invalid, "the picture would be written over the input",
                     command.output.string()};
    return prep::check_writable_image(is_standard_stream(command.output)
                                          ? std::filesystem::path("stdout." + command.format)
                                          : command.output);
}

void say_certificate(const CommonOptions& common, const ImageCertificate& c,
                     const std::string& again, Console& console) {
    console.result(common, fmt::format("  {:.4g} levels asked, {:.4g} with {}, {}", c.asked,
                                       c.chosen.levels, c.chosen.rung.words(), c.scope()));
    if (c.next)
        console.result(common, fmt::format("  next: {:.4g} levels with {} in {:.2g} times the time",
                                           c.next->levels, c.next->rung.words(),
                                           c.next->milliseconds / c.chosen.milliseconds));
    console.result(common, "  the same again: " + again);
    if (!c.met)
        console.error(fmt::format("no sampling keeps {:.4g} levels; the best found has {:.4g}",
                                  c.asked, c.chosen.levels));
}

Result<Json> render_file(const RenderCommand& command, Console& console) {
    const CommonOptions& common = command.common;
    console.progress(common, command.input.string() + " … reading");
    Clock::time_point start = Clock::now();
    const Result<InputFile> input = InputFile::open(command.input, common.input_format);
    if (!input) return input.error();
    const bool scene_file = lower_ending(input->path()) == "json";
    Result<prep::JsonScene> loaded = load_json_scene(input->path(), load_options(common, console));
    if (!loaded) return input->relabelled(loaded.error());
    if (!scene_file)
        if (const Result<void> some = prep::require_geometry(loaded->scene); !some)
            return input->relabelled(some.error());
    input->settle(loaded->scene);
    const double read_ms = milliseconds_since(start);
    const std::vector<std::string> read_warnings = loaded->scene.warnings;
    for (const std::string& text : read_warnings)
        console.warning(common, said_of(command.input, text));

    rast::RenderRequest request = request_of(command, loaded->picture);
    if (!scene_file && !command.wishes.has("background")) request.background = file_background;
    const double aspect = static_cast<double>(request.width) / request.height;
    const ViewChoices choices{command, command.turntable, loaded->orbit};

    console.progress(common, command.input.string() + " … preparing");
    start = Clock::now();
    prep::PrepareOptions options =
        prepare_options(command.prepare, load_options(common, console), common.threads);
    std::vector<rast::View> screens;
    if (options.tessellation.pixel_error) {
        Result<std::vector<rast::View>> known = screen_views(choices, loaded->scene, aspect);
        if (!known) return input->relabelled(known.error());
        screens = *std::move(known);
        options.tessellation.screens = screen_metrics(screens, request.width, request.height);
    }
    const Result<prep::PreparedScene> prepared = prep::prepare(std::move(loaded->scene), options);
    if (!prepared) return input->relabelled(prepared.error());
    const double prepare_ms = milliseconds_since(start);

    const Result<std::vector<std::optional<rast::View>>> views =
        screens.empty() ? views_of(choices, *prepared, aspect)
                        : drawn_views(screens, choices, *prepared, aspect);
    if (!views) return views.error();

    rast::SceneRenderer renderer(*prepared);  // keeps textures between pictures
    const bool own_lights = !scene_file && command.lights.empty() && has_lights(prepared->scene);
    const bool find = request.exposure == prep::automatic_exposure ||
                      (own_lights && !command.wishes.has("exposure"));
    std::optional<rast::FoundExposure> found;
    const auto find_exposure = [&]() -> Result<void> {
        if (!find) {
            rast::expose(request, request.exposure);
            return {};
        }
        const Result<rast::RenderPlan> plan = plan_of(command, *prepared, request, views->front());
        if (!plan) return plan.error();
        const Result<rast::FoundExposure> exposure =
            rast::find_exposure(renderer, *prepared, plan->request);
        if (!exposure) return exposure.error();
        found = *exposure;
        rast::expose(request, found->exposure);
        return {};
    };
    // Exposure and sampling are found with all lights: what may be left out is told apart from
    // them.
    const float allowed = std::exchange(request.allow_error, 0.0f);
    std::optional<ImageCertificate> certificate;
    std::optional<SamplingTimes> times;
    if (command.image_error || command.budget_ms) {
        console.progress(common, command.input.string() + " … measuring");
        const rast::RenderRequest plain = request;
        request.coverage = prep::Coverage::samples;
        request.samples = request.supersample = 1;
        if (const Result<void> exposed = find_exposure(); !exposed) return exposed.error();
        const auto plan_for = [&](const rast::RenderRequest& r, std::size_t view) {
            return plan_of(command, *prepared, r, (*views)[view]);
        };
        SamplingRung rung;
        if (command.image_error) {
            Result<ImageCertificate> chosen =
                choose_sampling(renderer, request, views->size(), plan_for, *command.image_error);
            if (!chosen) return chosen.error();
            certificate = *std::move(chosen);
            rung = certificate->chosen.rung;
        } else {
            Result<SamplingTimes> chosen =
                sampling_within(renderer, request, views->size(), plan_for, *command.budget_ms,
                                command.cost_cache, common, console);
            if (!chosen) return chosen.error();
            times = *std::move(chosen);
            rung = times->rung;
        }
        // From here on as if the command line had said it.
        request = plain;
        request.coverage = prep::Coverage::samples;
        request.samples = rung.samples;
        request.supersample = rung.supersample;
    }
    if (const Result<void> exposed = find_exposure(); !exposed) return exposed.error();
    request.allow_error = allowed;
    request.timed = command.explain;

    OutputOptions outputs;
    outputs.buffers = command.buffers;
    outputs.choices = request;
    outputs.threads = common.threads;
    OutputDirectories directories;
    for (const std::filesystem::path& file : {command.output, command.buffer_file})
        if (const Result<void> made = directories.make_for(file); !made) return made.error();
    prep::ImageFiles files({command.overwrite, files_read(command, *prepared)});
    Json json;
    json["input"] = command.input.string();
    json["output"] = command.output.string();
    json["outputs"] = Json::array();
    json["warnings"] = read_warnings;
    double render_ms = 0, write_ms = 0;
    const auto count = std::uint32_t(views->size());
    for (std::uint32_t n = 0; n < count; ++n) {
        Result<rast::RenderPlan> plan = plan_of(command, *prepared, request, (*views)[n]);
        if (!plan) return plan.error();
        if (!request.texel_facts) {
            request.texel_facts = renderer.texel_facts(*plan);
            if (request.texel_facts) plan = plan_of(command, *prepared, request, (*views)[n]);
            if (!plan) return plan.error();
        }
        console.progress(common, command.input.string() + " … drawing" +
                                     (count > 1 ? fmt::format(" {}/{}", n + 1, count) : ""));
        const bool sequence = command.turntable > 0;
        outputs.picture = sequence ? sequence_name(command.output, n, count) : command.output;
        outputs.buffer_file = sequence && !command.buffer_file.empty()
                                  ? sequence_name(command.buffer_file, n, count)
                                  : command.buffer_file;
        const Result<Drawn> drawn = draw(renderer, *plan, files, outputs);
        if (!drawn) return drawn.error();
        render_ms += drawn->draw_ms;
        write_ms += drawn->write_ms;
        for (const std::filesystem::path& path : drawn->paths)
            json["outputs"].push_back(path.string());
        if (n > 0) continue;
        std::vector<std::string> warnings = not_drawn(*prepared);
        if (const std::uint64_t broken = drawn->frame.counters.non_finite; broken > 0)
            warnings.push_back(count_of(broken, "triangle") +
                               " with positions that are not finite or beyond all range left out");
        if (const auto why = why_empty(drawn->frame.counters, plan->triangles, request.cull))
            warnings.push_back(*why);
        if (command.wishes.has("max_anisotropy") &&
            request.filter != prep::TextureFilter::anisotropic &&
            request.filter != prep::TextureFilter::ewa)
            warnings.push_back("--max-anisotropy is of --filter anisotropic and ewa alone");
        if (request.tone_map == prep::ToneMap::reinhard && keeps_float(outputs.picture))
            warnings.push_back(
                "the scene's tone_map is for pictures of 8 bits: linear light is "
                "kept in '" +
                outputs.picture.filename().string() + "'");
        warnings.insert(warnings.end(), drawn->frame.warnings.begin(), drawn->frame.warnings.end());
        if (const auto black = drawn->black.warning(*prepared)) warnings.push_back(*black);
        for (const std::string& text : warnings) {
            console.warning(common, text);
            json["warnings"].push_back(text);
        }
        const rast::Counters& counters = drawn->frame.counters;
        const rast::Frame& frame = drawn->frame;
        json["plan"] = plan_json(*plan, *prepared, command.explain ? &*drawn : nullptr);
        json["counters"] = counters_json(counters);
        if (command.explain) explain(*plan, *prepared, frame, common, console);
    }
    const Clock::time_point committing = Clock::now();
    if (const Result<void> saved = files.commit(); !saved) return saved.error();
    write_ms += milliseconds_since(committing);
    const Json& plan = json["plan"];
    const std::size_t written = json["outputs"].size();
    console.result(
        common,
        fmt::format(
            "{} → {}  {}×{}, {}, {}; read {}, prepare {}, draw {}, write {}",
            command.input.string(),
            !command.format.empty() ? "-"
            : written == 1
                ? json["outputs"][0].get<std::string>()
                : fmt::format("{} and {} more", json["outputs"][0].get<std::string>(), written - 1),
            request.crop ? request.crop->width : request.width,
            request.crop ? request.crop->height : request.height,
            plan["shading"].get<std::string>(),
            count_of(plan["triangles"].get<std::uint64_t>(), "triangle"), duration(read_ms),
            duration(prepare_ms), duration(render_ms), duration(write_ms)));
    if (found) {
        if (found->exposure != 1)
            console.result(common,
                           fmt::format("  exposure {} was found: the brightest surfaces had {:.3g} "
                                       "times white (--exposure sets another)",
                                       found->exposure, found->bright));
        json["exposure"] = {{"value", found->exposure}, {"bright", found->bright}};
    }
    // What goes to standard output was written to a file that is gone then.
    const std::filesystem::path given = command.format.empty() ? command.output : "-";
    if (certificate) {
        const std::string again = explicit_command("render", command.input, given, command.settings,
                                                   certificate->chosen.rung.words());
        json["certificate"] = to_json(*certificate, again);
        say_certificate(common, *certificate, again, console);
    }
    if (times) {
        times->taken = render_ms + times->pilot.first;
        const std::string again = explicit_command("render", command.input, given, command.settings,
                                                   times->chosen.setting);
        json["budget"] = to_json(*times, again);
        say_time(common, *times, drawing_work, again, console);
    }
    json["milliseconds"] = {
        {"read", read_ms}, {"prepare", prepare_ms}, {"render", render_ms}, {"write", write_ms}};
    return json;
}

// By way of a file: what writes pictures wants a name.
Result<Json> render_to_output(const RenderCommand& command, Console& console) {
    console.keep_output_for_bytes();
    const Result<PrivateDirectory> directory = PrivateDirectory::make();
    if (!directory) return directory.error();
    RenderCommand to_file = command;
    to_file.output = directory->path() / ("stdout." + command.format);
    Result<Json> done = render_file(to_file, console);
    if (!done) return done;
    const Result<std::vector<std::byte>> bytes = prep::read_file(to_file.output);
    if (!bytes) return bytes.error();
    console.bytes({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    return done;
}

int run(const RenderCommand& command, Console& console) {
    Json document = json_head("render");
    const Result<void> sound = check_files(command);
    const Result<Json> done = !sound ? Result<Json>(sound.error())
                              : is_standard_stream(command.output)
                                  ? render_to_output(command, console)
                                  : render_file(command, console);
    if (done)
        document.update(*done);
    else
        document["error"] = to_json(done.error());
    if (!done) console.error(done.error());
    console.progress(command.common, "");
    if (command.common.json) console.json(json_text(document));
    if (!sound && sound.error().code != ErrorCode::io) return exit_usage;
    const auto short_of = [&](const char* asked) {
        return done->contains(asked) && !(*done)[asked]["met"].get<bool>();
    };
    return done && !short_of("certificate") && !short_of("budget") ? exit_done : exit_failed;
}

}  // namespace

Subcommand render_subcommand() {
    return subcommand<RenderCommand>("render", "Draw a scene or a mesh", define_render, run,
                                     check_render);
}

}  // namespace meshprep
