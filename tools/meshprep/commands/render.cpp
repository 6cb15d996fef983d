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
#include "meshprep/output/drawing_report.h"
#include "meshprep/output/load_options.h"
#include "meshprep/output/report_json.h"
#include "prep/files.h"
#include "prep/formats.h"
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

// Whether one of them may be of a format that a library is loaded for (prep/image.h).
bool need_image_library(const std::vector<prep::ImageRef>& images) {
    return std::any_of(images.begin(), images.end(), [](const prep::ImageRef& image) {
        if (!image.bytes.empty())
            return image.mime_type != "image/png" && image.mime_type != "image/jpeg";
        const std::vector<std::filesystem::path> files = prep::files_of(image);
        return std::any_of(files.begin(), files.end(), [](const std::filesystem::path& file) {
            const std::string ending = prep::lower_ending(file);
            return ending != ".png" && ending != ".jpg" && ending != ".jpeg";
        });
    });
}

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

// A run of the command; a step after the other.
class Rendering {
  public:
    Rendering(const RenderCommand& command, Console& console)
        : command_(command), common_(command.common), console_(console) {}

    Result<Json> run() {
        for (const auto step : {&Rendering::read, &Rendering::prepare, &Rendering::choose_sampling,
                                &Rendering::draw_views})
            if (const Result<void> done = (this->*step)(); !done) return done.error();
        report();
        return std::move(json_);
    }

  private:
    void show(const std::string& what) {
        console_.progress(common_, command_.input.string() + " … " + what);
    }

    Result<void> read() {
        show("reading");
        const Clock::time_point start = Clock::now();
        Result<InputFile> input = InputFile::open(command_.input, common_.input_format);
        if (!input) return input.error();
        input_.emplace(*std::move(input));
        scene_file_ = lower_ending(input_->path()) == "json";
        Result<prep::JsonScene> loaded =
            load_json_scene(input_->path(), load_options(common_, console_));
        if (!loaded) return input_->relabelled(loaded.error());
        if (!scene_file_)
            if (const Result<void> some = prep::require_geometry(loaded->scene); !some)
                return input_->relabelled(some.error());
        input_->settle(loaded->scene);
        loaded_.emplace(*std::move(loaded));
        read_ms_ = milliseconds_since(start);
        json_["input"] = command_.input.string();
        json_["output"] = command_.output.string();
        json_["outputs"] = Json::array();
        json_["warnings"] = loaded_->scene.warnings;
        for (const std::string& text : loaded_->scene.warnings)
            console_.warning(common_, said_of(command_.input, text));
        return {};
    }

    Result<void> prepare() {
        request_ = request_of(command_, loaded_->picture);
        if (!scene_file_ && !command_.wishes.has("background"))
            request_.background = file_background;
        const double aspect = static_cast<double>(request_.width) / request_.height;
        const ViewChoices choices{command_, command_.turntable, loaded_->orbit};

        show("preparing");
        const Clock::time_point start = Clock::now();
        prep::PrepareOptions options =
            prepare_options(command_.prepare, load_options(common_, console_), common_.threads);
        std::vector<rast::View> screens;
        if (options.tessellation.pixel_error) {
            Result<std::vector<rast::View>> known = screen_views(choices, loaded_->scene, aspect);
            if (!known) return input_->relabelled(known.error());
            screens = *std::move(known);
            options.tessellation.screens = screen_metrics(screens, request_.width, request_.height);
        }
        Result<prep::PreparedScene> prepared = prep::prepare(std::move(loaded_->scene), options);
        if (!prepared) return input_->relabelled(prepared.error());
        prepared_.emplace(*std::move(prepared));
        prepare_ms_ = milliseconds_since(start);

        Result<std::vector<std::optional<rast::View>>> views =
            screens.empty() ? views_of(choices, *prepared_, aspect)
                            : drawn_views(screens, choices, *prepared_, aspect);
        if (!views) return views.error();
        views_ = *std::move(views);
        renderer_.emplace(*prepared_);
        return {};
    }

    Result<rast::RenderPlan> plan_for(const rast::RenderRequest& request, std::size_t view) const {
        return plan_of(command_, *prepared_, request, views_[view]);
    }

    Result<void> find_exposure() {
        const bool own_lights =
            !scene_file_ && command_.lights.empty() && has_lights(prepared_->scene);
        if (request_.exposure != prep::automatic_exposure &&
            (!own_lights || command_.wishes.has("exposure"))) {
            rast::expose(request_, request_.exposure);
            return {};
        }
        const Result<rast::RenderPlan> plan = plan_for(request_, 0);
        if (!plan) return plan.error();
        const Result<rast::FoundExposure> exposure =
            rast::find_exposure(*renderer_, *prepared_, plan->request);
        if (!exposure) return exposure.error();
        exposure_ = *exposure;
        rast::expose(request_, exposure_->exposure);
        return {};
    }

    // And the exposure. Both with all lights: what may be left out is told apart from them.
    Result<void> choose_sampling() {
        const float allowed = std::exchange(request_.allow_error, 0.0f);
        if (command_.image_error || command_.budget_ms) {
            show("measuring");
            const rast::RenderRequest plain = request_;
            request_.coverage = prep::Coverage::samples;
            request_.samples = request_.supersample = 1;
            if (const Result<void> exposed = find_exposure(); !exposed) return exposed.error();
            const auto plans = [&](const rast::RenderRequest& request, std::size_t view) {
                return plan_for(request, view);
            };
            SamplingRung rung;
            if (command_.image_error) {
                Result<ImageCertificate> chosen = meshprep::choose_sampling(
                    *renderer_, request_, views_.size(), plans, *command_.image_error);
                if (!chosen) return chosen.error();
                certificate_ = *std::move(chosen);
                rung = certificate_->chosen.rung;
            } else {
                // The first picture that needs it waits for it: that is no drawing.
                if (need_image_library(prepared_->scene.images))
                    if (const Result<void> loaded = prep::load_image_library(); !loaded)
                        return loaded.error();
                Result<SamplingTimes> chosen =
                    sampling_within(*renderer_, request_, views_.size(), plans, *command_.budget_ms,
                                    command_.cost_cache, common_, console_);
                if (!chosen) return chosen.error();
                times_ = *std::move(chosen);
                rung = times_->rung;
            }
            // From here on as if the command line had said it.
            request_ = plain;
            request_.coverage = prep::Coverage::samples;
            request_.samples = rung.samples;
            request_.supersample = rung.supersample;
        }
        if (const Result<void> exposed = find_exposure(); !exposed) return exposed.error();
        request_.allow_error = allowed;
        request_.timed = command_.explain;
        return {};
    }

    Result<void> draw_views() {
        OutputOptions outputs;
        outputs.buffers = command_.buffers;
        outputs.choices = request_;
        outputs.threads = common_.threads;
        OutputDirectories directories;
        for (const std::filesystem::path& file : {command_.output, command_.buffer_file})
            if (const Result<void> made = directories.make_for(file); !made) return made.error();
        prep::ImageFiles files({command_.overwrite, files_read(command_, *prepared_)});
        for (std::size_t view = 0; view < views_.size(); ++view)
            if (const Result<void> done = draw_view(view, outputs, files); !done)
                return done.error();
        const Clock::time_point committing = Clock::now();
        if (const Result<void> saved = files.commit(); !saved) return saved.error();
        write_ms_ += milliseconds_since(committing);
        return {};
    }

    Result<void> draw_view(std::size_t view, OutputOptions& outputs, prep::ImageFiles& files) {
        Result<rast::RenderPlan> plan = plan_for(request_, view);
        if (!plan) return plan.error();
        if (!request_.texel_facts) {
            request_.texel_facts = renderer_->texel_facts(*plan);
            if (request_.texel_facts) plan = plan_for(request_, view);
            if (!plan) return plan.error();
        }
        const auto count = static_cast<std::uint32_t>(views_.size());
        const auto n = static_cast<std::uint32_t>(view);
        show("drawing" + (count > 1 ? fmt::format(" {}/{}", n + 1, count) : ""));
        const bool sequence = command_.turntable > 0;
        outputs.picture = sequence ? sequence_name(command_.output, n, count) : command_.output;
        outputs.buffer_file = sequence && !command_.buffer_file.empty()
                                  ? sequence_name(command_.buffer_file, n, count)
                                  : command_.buffer_file;
        const Result<Drawn> drawn = draw(*renderer_, *plan, files, outputs);
        if (!drawn) return drawn.error();
        render_ms_ += drawn->draw_ms;
        write_ms_ += drawn->write_ms;
        for (const std::filesystem::path& path : drawn->paths)
            json_["outputs"].push_back(path.string());
        if (view == 0) warn_of_settings(outputs.picture);
        warn_of_picture(*drawn, *plan, view == 0 ? "" : outputs.picture.filename().string() + ": ");
        if (view > 0) return {};
        json_["plan"] = plan_json(*plan, *prepared_, command_.explain ? &*drawn : nullptr);
        json_["counters"] = counters_json(drawn->frame.counters);
        if (command_.explain) explain(*plan, *prepared_, drawn->frame, common_, console_);
        return {};
    }

    void warn(const std::string& text) {
        console_.warning(common_, text);
        json_["warnings"].push_back(text);
    }

    void warn_of_settings(const std::filesystem::path& picture) {
        for (const std::string& text : not_drawn(*prepared_)) warn(text);
        if (command_.wishes.has("max_anisotropy") &&
            request_.filter != prep::TextureFilter::anisotropic &&
            request_.filter != prep::TextureFilter::ewa)
            warn("--max-anisotropy is of --filter anisotropic and ewa alone");
        if (request_.tone_map == prep::ToneMap::reinhard && keeps_float(picture))
            warn("the scene's tone_map is for pictures of 8 bits: linear light is kept in '" +
                 picture.filename().string() + "'");
    }

    // Of several pictures the first that a warning is of has it; figures in it are that one's.
    void warn_of_picture(const Drawn& drawn, const rast::RenderPlan& plan,
                         const std::string& picture) {
        const auto once = [&](const std::string& kind, const std::string& text) {
            if (warned_of_.insert(kind).second) warn(picture + text);
        };
        if (const std::uint64_t broken = drawn.frame.counters.non_finite; broken > 0)
            once("broken", count_of(broken, "triangle") +
                               " with positions that are not finite or beyond all range left out");
        if (const auto why = why_empty(drawn.frame.counters, plan.triangles, request_))
            once("empty", *why);
        for (const std::string& text : drawn.frame.warnings) once(text, text);
        if (const auto black = drawn.black.warning(*prepared_)) once("black", *black);
    }

    void report() {
        const Json& plan = json_["plan"];
        const Json& outputs = json_["outputs"];
        const auto first = outputs[0].get<std::string>();
        console_.result(
            common_, fmt::format("{} → {}  {}×{}, {}, {}; read {}, prepare {}, draw {}, write {}",
                                 command_.input.string(),
                                 !command_.format.empty() ? "-"
                                 : outputs.size() == 1
                                     ? first
                                     : fmt::format("{} and {} more", first, outputs.size() - 1),
                                 request_.crop ? request_.crop->width : request_.width,
                                 request_.crop ? request_.crop->height : request_.height,
                                 plan["shading"].get<std::string>(),
                                 count_of(plan["triangles"].get<std::uint64_t>(), "triangle"),
                                 duration(read_ms_), duration(prepare_ms_), duration(render_ms_),
                                 duration(write_ms_)));
        if (exposure_) {
            if (exposure_->exposure != 1)
                console_.result(common_,
                                fmt::format("  exposure {} was found: the brightest surfaces had "
                                            "{:.3g} times white (--exposure sets another)",
                                            exposure_->exposure, exposure_->bright));
            json_["exposure"] = {{"value", exposure_->exposure}, {"bright", exposure_->bright}};
        }
        // What goes to standard output was written to a file that is gone then.
        const std::filesystem::path given = command_.format.empty() ? command_.output : "-";
        if (certificate_) {
            const std::string again =
                explicit_command("render", command_.input, given, command_.settings,
                                 certificate_->chosen.rung.words());
            json_["certificate"] = to_json(*certificate_, again);
            say_certificate(common_, *certificate_, again, console_);
        }
        if (times_) {
            times_->taken = render_ms_ + times_->pilot.first;
            const std::string again = explicit_command("render", command_.input, given,
                                                       command_.settings, times_->chosen.setting);
            json_["budget"] = to_json(*times_, again);
            say_time(common_, *times_, drawing_work, again, console_);
        }
        json_["milliseconds"] = {{"read", read_ms_},
                                 {"prepare", prepare_ms_},
                                 {"render", render_ms_},
                                 {"write", write_ms_}};
    }

    const RenderCommand& command_;
    const CommonOptions& common_;
    Console& console_;
    std::optional<InputFile> input_;
    bool scene_file_ = false;
    std::optional<prep::JsonScene> loaded_;
    rast::RenderRequest request_;
    std::optional<prep::PreparedScene> prepared_;
    std::vector<std::optional<rast::View>> views_;
    std::optional<rast::SceneRenderer> renderer_;  // keeps textures between pictures
    std::optional<rast::FoundExposure> exposure_;
    std::optional<ImageCertificate> certificate_;
    std::optional<SamplingTimes> times_;
    std::set<std::string> warned_of_;
    double read_ms_ = 0, prepare_ms_ = 0, render_ms_ = 0, write_ms_ = 0;
    Json json_;
};

// By way of a file: what writes pictures wants a name.
Result<Json> render_to_output(const RenderCommand& command, Console& console) {
    console.keep_output_for_bytes();
    const Result<PrivateDirectory> directory = PrivateDirectory::make();
    if (!directory) return directory.error();
    RenderCommand to_file = command;
    to_file.output = directory->path() / ("stdout." + command.format);
    Result<Json> done = Rendering(to_file, console).run();
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
                                  : Rendering(command, console).run();
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
