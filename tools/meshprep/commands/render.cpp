#include "rast/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
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
#include "meshprep/output/load_options.h"
#include "meshprep/output/report_json.h"
#include "meshprep/output/step_costs.h"
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

Result<prep::JsonScene> load(const std::filesystem::path& path, const prep::LoadOptions& options) {
    if (lower_ending(path) == "json") return prep::load_scene_json(path, options);
    Result<prep::Scene> scene = prep::load_scene(path, options);
    if (!scene) return scene.error();
    if (const Result<void> some = prep::require_geometry(*scene); !some) return some.error();
    return prep::JsonScene{*std::move(scene), {}, {}};
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

// How much of what is seen came out black, by some of the pixels.
struct BlackPixels {
    std::uint64_t black = 0, seen = 0;

    void count(const rast::Frame& band, float exposure) {
        constexpr float least = 0.0003f;  // the first step of 8 bits above black
        const std::size_t step = std::max<std::size_t>(1, band.color.size() >> 18);
        for (std::size_t i = 0; i < band.color.size(); i += step) {
            const glm::vec4& c = band.color[i];
            if (!(c.a > 0)) continue;
            ++seen;
            black += std::max({c.r, c.g, c.b}) * exposure < least;
        }
    }
    std::optional<std::string> warning(const prep::PreparedScene& prepared) const {
        constexpr std::uint64_t few = 64;
        if (seen < few || black * 10 < seen * 9) return {};
        const bool black_materials =
            !prepared.scene.materials.empty() &&
            std::all_of(prepared.scene.materials.begin(), prepared.scene.materials.end(),
                        [](const prep::Material& m) {
                            return m.diffuse.r + m.diffuse.g + m.diffuse.b < 0.01f;
                        });
        return fmt::format(
            "{} % of the pixels that show a surface are black: {}", black * 100 / seen,
            black_materials
                ? "the materials' colours are black"
                : "the lights do not reach it or are far too weak; --exposure auto finds "
                  "an exposure, --light takes other lights");
    }
};

Json cost_json(const StepCost& cost) {
    Json json = {{"count", cost.count}, {"of", cost.of}, {"bytes", cost.bytes}};
    if (cost.milliseconds) json["milliseconds"] = *cost.milliseconds;
    return json;
}

Json measured_json(const MeasuredStep& measured) {
    Json json = {
        {"milliseconds", measured.milliseconds}, {"parts", Json::array()}, {"with", measured.with}};
    for (const rast::DrawingPart part : measured.parts)
        json["parts"].push_back(rast::name_of(part));
    return json;
}

// What drawing one picture came to.
struct Drawn {
    rast::Frame frame;  // without pixels
    BlackPixels black;
    std::vector<std::filesystem::path> paths;
    double draw_ms = 0, write_ms = 0;
};

// By the clock on the wall, and by part of drawing as threads have it.
Json milliseconds_json(const Drawn& drawn) {
    Json parts = Json::object();
    for (std::size_t p = 0; p < rast::drawing_parts; ++p)
        parts[std::string(rast::name_of(rast::DrawingPart(p)))] = drawn.frame.part_ms[p];
    return {{"geometry", drawn.frame.geometry_ms},
            {"drawing", drawn.frame.raster_ms},
            {"writing", drawn.write_ms},
            {"parts", std::move(parts)}};
}

// `explained`: the picture, where each step's cost is asked for; else null.
Json plan_json(const rast::RenderPlan& plan, const prep::PreparedScene& prepared,
               const Drawn* explained) {
    const rast::Frame* const drawn = explained != nullptr ? &explained->frame : nullptr;
    const prep::Scene& scene = prepared.scene;
    const std::uint64_t points = drawn != nullptr ? expected_points(prepared, plan) : 0;
    Json json;
    if (explained != nullptr) json["milliseconds"] = milliseconds_json(*explained);
    json["width"] = plan.request.width;
    json["height"] = plan.request.height;
    json["shading"] = std::string(prep::name_of(plan.request.shading));
    json["triangles"] = plan.triangles;
    json["lights"] = plan.lights.size();
    json["memory_estimate"] = plan.memory_estimate;
    json["band_rows"] = plan.band_rows;
    json["band_memory_estimate"] = plan.band_memory_estimate;
    json["variants"] = Json::array();
    for (const rast::PlanVariant& v : plan.variants)
        json["variants"].push_back({{"shading", v.name}, {"triangles", v.triangles}});
    json["steps"] = Json::array();
    for (const rast::PlanStep& s : plan.steps) {
        Json reasons = Json::array();
        for (const prep::Reason& why : s.reasons) reasons.push_back(to_json(why, scene));
        json["steps"].push_back({{"step", s.name},
                                 {"run", s.run},
                                 {"label", prep::name_of(s.label)},
                                 {"reason", s.reason},
                                 {"reasons", std::move(reasons)}});
        if (drawn == nullptr) continue;
        Json& step = json["steps"].back();
        if (const std::optional<StepCost> before = estimate_of(s, plan, points))
            step["estimate"] = cost_json(*before);
        if (const std::optional<StepCost> cost = cost_of(s, plan, drawn->counters))
            step["cost"] = cost_json(*cost);
        if (const std::optional<MeasuredStep> took = time_of(s, plan, *drawn))
            step["measured"] = measured_json(*took);
    }
    return json;
}

Json counters_json(const rast::Counters& c) {
    Json stages = Json::object();
    for (std::size_t k = 0; k < rast::shade_stages; ++k)
        stages[std::string(rast::shade_stage_names[k])] = c.stage_points[k];
    return {{"triangles", c.triangles},
            {"non_finite", c.non_finite},
            {"degenerate", c.degenerate},
            {"facing_away", c.facing_away},
            {"outside", c.outside},
            {"between_samples", c.between_samples},
            {"crossing", c.crossing},
            {"vertices_lit", c.vertices_lit},
            {"pixels_shaded", c.pixels_shaded},
            {"texture_samples", c.texture_samples},
            {"light_points", c.light_points},
            {"highlight_points", c.highlight_points},
            {"normal_map_points", c.normal_map_points},
            {"stage_points", std::move(stages)},
            {"masked_triangles", c.masked_triangles},
            {"sample_points", c.sample_points},
            {"textures_read", c.textures_read},
            {"texture_levels", c.texture_levels},
            {"buffer_bytes", c.buffer_bytes},
            {"list_bytes", c.list_bytes}};
}

// A row for each step with what it came to, and below it one for each light, material and map that
// has a say in it.
void explain(const rast::RenderPlan& plan, const prep::PreparedScene& prepared,
             const rast::Frame& drawn, const CommonOptions& common, Console& console) {
    const std::uint64_t points = expected_points(prepared, plan);
    std::vector<std::vector<std::string>> rows;
    for (const rast::PlanStep& s : plan.steps) {
        rows.push_back({s.name, std::string(prep::name_of(s.label)),
                        text_of(cost_of(s, plan, drawn.counters), estimate_of(s, plan, points),
                                time_of(s, plan, drawn)),
                        s.reason});
        for (std::size_t k = 1; k < s.reasons.size(); ++k)
            rows.push_back({"", std::string(prep::name_of(s.reasons[k].label)), "",
                            prep::sentence(s.reasons[k], prepared.scene)});
    }
    console.table(common, rows, {});
    rows.clear();
    for (std::size_t p = 0; p < rast::drawing_parts; ++p) {
        const std::uint64_t at = p < rast::shade_stages ? drawn.counters.stage_points[p] : 0;
        if (drawn.part_ms[p] > 0 || at > 0)
            rows.push_back({std::string(rast::name_of(rast::DrawingPart(p))),
                            at > 0 ? with_commas(at) : "", duration(drawn.part_ms[p])});
    }
    console.result(common, "  parts of drawing, points, time of all threads:");
    console.table(common, rows, {});
    console.result(common, fmt::format("  {}, about {} beside textures; geometry {}, drawing {}",
                                       count_of(plan.triangles, "triangle"),
                                       byte_size(plan.band_memory_estimate),
                                       duration(drawn.geometry_ms), duration(drawn.raster_ms)));
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

// What the scene has and no picture shows.
std::vector<std::string> not_drawn(const prep::PreparedScene& prepared) {
    std::set<std::uint32_t> materials;
    std::size_t lines = 0, points = 0, skinned = 0;
    for (const prep::VertexMesh& mesh : prepared.meshes) {
        for (const prep::VertexMesh::Range& range : mesh.ranges)
            if (range.triangle_count > 0 && range.material != prep::no_index)
                materials.insert(range.material);
        lines += mesh.lines.size() / 2;
        points += mesh.points.size();
    }
    for (const prep::Node& node : prepared.scene.nodes)
        skinned += node.mesh != prep::no_index && node.skin != prep::no_index;
    std::vector<std::string> out;
    for (const std::uint32_t m : materials) {
        const prep::Material& material = prepared.scene.materials[m];
        const std::string name =
            "material " + (material.name.empty() ? std::to_string(m) : "'" + material.name + "'");
        if (material.alpha_mode == prep::AlphaMode::blend)
            out.push_back(name + " is drawn opaque: nothing is blended");
        for (const prep::MaterialMap& map : prep::material_maps)
            if (map.use == prep::MapUse::not_drawn && material.*map.ref)
                out.push_back(name + " has a " + map.name + " map, which is not drawn");
    }
    if (skinned > 0)
        out.push_back(count_of(skinned, "skinned mesh") +
                      (skinned == 1 ? " is drawn" : " are drawn") + " as modelled, not posed");
    if (const std::size_t targets = prep::morph_target_count(prepared.scene); targets > 0)
        out.push_back("morph targets are not applied: " + std::to_string(targets) +
                      ", whatever their weights");
    if (lines + points > 0)
        out.push_back(count_of(lines, "line segment") + " and " + count_of(points, "point") +
                      " are not drawn, only triangles are");
    return out;
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
    Result<prep::JsonScene> loaded = load(input->path(), load_options(common, console));
    if (!loaded) return input->relabelled(loaded.error());
    input->settle(loaded->scene);
    const double read_ms = milliseconds_since(start);
    for (const std::string& text : loaded->scene.warnings)
        console.warning(common, said_of(command.input, text));

    const bool scene_file = lower_ending(input->path()) == "json";
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
        if (!find) return {};
        const Result<rast::RenderPlan> plan = plan_of(command, *prepared, request, views->front());
        if (!plan) return plan.error();
        const Result<rast::FoundExposure> exposure =
            rast::find_exposure(renderer, *prepared, plan->request);
        if (!exposure) return exposure.error();
        found = *exposure;
        request.exposure = found->exposure;
        request.background /= found->exposure;  // what is behind the scene is not lit by it
        return {};
    };
    // Exposure and sampling are found with all lights: what may be left out is told apart from
    // them.
    const float allowed = std::exchange(request.allow_error, 0.0f);
    std::optional<ImageCertificate> certificate;
    std::optional<TimeCertificate> times;
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
            Result<TimeCertificate> chosen =
                sampling_within(renderer, request, views->size(), plan_for, *command.budget_ms,
                                command.cost_cache, common, console);
            if (!chosen) return chosen.error();
            times = *std::move(chosen);
            rung = times->chosen.rung;
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
    json["warnings"] = Json::array();
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
    if (certificate) {
        const std::string again =
            explicit_command("render", command.input, command.output, command.settings,
                             certificate->chosen.rung.words());
        json["certificate"] = to_json(*certificate, again);
        say_certificate(common, *certificate, again, console);
    }
    if (times) {
        times->taken = render_ms;
        const std::string again = explicit_command("render", command.input, command.output,
                                                   command.settings, times->chosen.rung.words());
        json["budget"] = to_json(*times, again);
        say_time(common, *times, again, console);
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
