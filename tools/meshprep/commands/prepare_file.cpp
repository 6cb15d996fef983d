#include "meshprep/commands/prepare_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <string_view>

#include "base/process_memory.h"
#include "meshprep/budgets/prepare_budget.h"
#include "meshprep/commands/prepare_report.h"
#include "meshprep/commands/render_views.h"
#include "meshprep/files/file_sizes.h"
#include "meshprep/files/read_watch.h"
#include "meshprep/options/option_table.h"
#include "meshprep/output/load_options.h"
#include "prep/files.h"
#include "prep/load.h"
#include "prep/save.h"
#include "prep/scene_json.h"

namespace meshprep {
namespace {

// Of PLY and STL, which have two forms. Binary ones name theirs in the header or have a byte of
// zero near the beginning: the highest of their number of triangles, if nothing else.
bool is_text(const std::filesystem::path& file) {
    std::string beginning(4096, ' ');
    std::ifstream stream(file, std::ios::binary);
    stream.read(beginning.data(), std::streamsize(beginning.size()));
    beginning.resize(std::size_t(stream.gcount()));
    return beginning.find('\0') == std::string::npos &&
           beginning.find("format binary_") == std::string::npos;
}

std::size_t count_displacement_maps(const prep::Scene& scene) {
    return std::size_t(
        std::count_if(scene.materials.begin(), scene.materials.end(),
                      [](const prep::Material& m) { return bool(m.displacement_map); }));
}

// OBJ that is written in place goes on using the libraries that it was read with; `before`:
// displacement maps that its materials had.
std::optional<prep::Error> at_odds_with_libraries(const prep::PreparedScene& prepared,
                                                  std::size_t before,
                                                  const std::filesystem::path& file) {
    if (prepared.scene.libraries.empty()) return std::nullopt;
    const bool displaced =
        count_displacement_maps(prepared.scene) < before ||
        std::any_of(prepared.findings.begin(), prepared.findings.end(),
                    [](const prep::Finding& f) { return f.kind == "displacement-map-kept"; });
    const bool scaled =
        prepared.scene.placement.scale != 1 && count_displacement_maps(prepared.scene) > 0;
    const char* const odd = !prepared.residual_maps.empty()
                                ? "would not hold the residual normal map"
                            : displaced ? "would go on asking for the displacement that was made"
                            : scaled    ? "would not hold the heights at the new scale"
                                        : nullptr;
    if (!odd) return std::nullopt;
    return prep::Error{prep::ErrorCode::unsupported,
                       std::string("in place OBJ keeps its material libraries, which ") + odd +
                           ": write it to another file, with -o",
                       file.string()};
}

// Files that were read for the scene, with their hashes; one that was named and not found makes the
// result one that may change, and so does a pipe, which nobody can look at again, and a file that
// was changed since reading began, unless it is one of those written.
void note_sources(const InputFile& input, const prep::Scene& scene, const PrepareCommand& command,
                  const ReadWatch& watch, Outcome& out) {
    const prep::DisplaceOptions& displacement = command.prepare.displacement;
    std::set<std::filesystem::path> written;
    for (const std::filesystem::path& file : out.written) written.insert(identity_of(file));
    const auto add = [&](const std::filesystem::path& file) {
        out.sources.push_back(hashed(file));
        out.complete &= out.sources.back().sha256.has_value() &&
                        (watch.unchanged(file) || written.count(identity_of(file)) != 0);
    };
    std::vector<std::filesystem::path> files;
    for (const std::filesystem::path& library : scene.libraries)
        if (!input.passing(library)) files.push_back(library);
    for (const prep::ImageRef& image : scene.images) {
        for (const std::filesystem::path& file : prep::files_of(image))
            if (!input.passing(file)) files.push_back(file);
        out.complete &= !image.path.empty() || !image.bytes.empty() || !image.channels.empty();
    }
    for (const std::filesystem::path& file : scene.passed_over)
        out.absent.insert(input.relabelled(file.string()));
    out.complete &= !scene.library_missing;
    if (displacement.map) files.push_back(displacement.map->path);
    if (const auto source = input.source())
        add(*source);
    else
        out.complete = false;
    // Beside an unpacked file are links to what lies beside the packed one.
    for (const std::filesystem::path& file : files) add(input.relabelled(file.string()));
}

// Lengths are floats where they are written, and wherever they are read. `scale`: what the command
// line made of them.
std::optional<prep::Error> beyond_float(const prep::Scene& scene, double scale,
                                        const std::filesystem::path& input) {
    struct Bounds {
        glm::dvec3 low{std::numeric_limits<double>::infinity()};
        glm::dvec3 high{-std::numeric_limits<double>::infinity()};
    };
    const std::vector<glm::dmat4> world = prep::world_transforms(scene);
    const glm::dmat4 stays(1.0);
    if (std::all_of(world.begin(), world.end(), [&](const auto& to) { return to == stays; }))
        return std::nullopt;
    std::vector<Bounds> bounds(scene.meshes.size());
    for (std::size_t m = 0; m < scene.meshes.size(); ++m)
        for (const glm::dvec3 p : scene.meshes[m].positions)
            if (std::isfinite(p.x + p.y + p.z)) {
                bounds[m].low = glm::min(bounds[m].low, p);
                bounds[m].high = glm::max(bounds[m].high, p);
            }
    double largest = 0;
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
        if (scene.nodes[n].mesh >= bounds.size()) continue;
        const Bounds& box = bounds[scene.nodes[n].mesh];
        if (!(box.low.x <= box.high.x)) continue;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec4 p((corner & 1) != 0 ? box.high.x : box.low.x,
                               (corner & 2) != 0 ? box.high.y : box.low.y,
                               (corner & 4) != 0 ? box.high.z : box.low.z, 1);
            const glm::dvec3 at(world[n] * p);
            for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(at[k]));
        }
    }
    using Limits = std::numeric_limits<float>;
    if (largest > double(Limits::max()))
        return prep::Error{prep::ErrorCode::invalid,
                           std::string("coordinates are beyond the range of float (3.4e38) ") +
                               (scale != 1 ? "with this --scale" : "where nodes put them"),
                           input.string()};
    if (scale != 1 && largest > 0 && largest < double(Limits::min()))
        return prep::Error{
            prep::ErrorCode::invalid,
            "no coordinate is left in the range of float (1.2e-38) with this --scale",
            input.string()};
    return std::nullopt;
}

// Saves to standard output by way of a file: only formats of one file can go there.
prep::Result<std::vector<std::string>> save_for_output(const prep::PreparedScene& prepared,
                                                       const prep::SaveOptions& options,
                                                       Outcome& out) {
    const prep::Result<PrivateDirectory> directory = PrivateDirectory::make();
    if (!directory) return directory.error();
    const std::filesystem::path file = directory->path() / ("stdout." + out.job.format);
    auto notes = prep::save_scene(prepared, file, options);
    if (!notes) return notes;
    if (out.written.size() != 1)
        return prep::Error{
            prep::ErrorCode::unsupported,
            "this result is " + std::to_string(out.written.size()) +
                " files, and standard output takes one; give --format glb, or -o FILE",
            "-"};
    const auto bytes = prep::read_file(file);
    if (!bytes) return bytes.error();
    out.bytes.assign(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    out.written.clear();  // it is no file
    out.gltf_after = count_gltf_file(file);
    return notes;
}

// With the bits that were given, or those that an error takes.
prep::Result<std::vector<std::string>> save_quantized(const prep::PreparedScene& prepared,
                                                      const PrepareCommand& command,
                                                      prep::SaveOptions save, int threads,
                                                      Outcome& out) {
    const bool any = command.quantization.any();
    if (any) save.quantized = &out.quantized.emplace();
    save.quantization = command.quantization;
    if (is_standard_stream(out.job.output)) return save_for_output(prepared, save, out);
    if (!command.direction_errors.any()) return prep::save_scene(prepared, out.job.output, save);
    auto saved = save_within(prepared, out.job.output, save, command.direction_errors, threads);
    if (!saved) return saved.error();
    out.certificate = std::move(saved->certificate);
    return std::move(saved->notes);
}

// With the settings that were given, or the most accurate that fit a time.
prep::Result<prep::PreparedScene> prepared_in_time(prep::Scene scene,
                                                   const prep::PrepareOptions& options,
                                                   const PrepareCommand& command, Outcome& out) {
    if (!command.budget_ms) return prep::prepare(std::move(scene), options);
    auto within = prepare_within(std::move(scene), options, *command.budget_ms);
    if (!within) return within.error();
    out.prepare_ms = within->milliseconds;
    out.times = std::move(within->times);
    return std::move(within->prepared);
}

// Options about new normals where none were made, an angle where smoothing groups decided, tangents
// where there are no UVs: what was asked for is not in the output. A remark, as the options of a
// batch are not meant for each of its files.
void remark_unused_options(const prep::PreparedScene& prepared, const PrepareCommand& command,
                           Outcome& out) {
    const auto given = [&](const char* name) { return command.settings.count(name) > 0; };
    const auto normals = std::find_if(prepared.stages.begin(), prepared.stages.end(),
                                      [](const auto& stage) { return stage.stage == "normals"; });
    const bool made = normals != prepared.stages.end() && normals->run;
    bool kept = false, grouped = false, by_angle = false, faces = false, tangents = false;
    for (std::size_t m = 0; m < prepared.scene.meshes.size(); ++m) {
        const prep::Mesh& mesh = prepared.scene.meshes[m];
        faces |= mesh.face_count() > 0;
        tangents |= !mesh.tangents.empty();
        const bool groups =
            command.prepare.hard_edges.smoothing_groups && !mesh.face_smoothing.empty();
        if (prepared.subdivided[m] || prepared.tessellated[m])
            by_angle = true;  // of the cage's edges
        else if (!mesh.normals.empty())
            (!prepared.normals_made[m] ? kept : groups ? grouped : by_angle) = true;
    }
    std::vector<std::string> unused;
    for (const char* name : {"--hard-angle", "--smoothing-groups", "--hard-borders", "--weight"})
        if (given(name)) unused.emplace_back(name);
    const bool keeps = command.prepare.normals != prep::Authored::replace;
    if (!made && kept && keeps && !by_angle && !unused.empty())
        out.remarks.push_back(joined(unused, ", ") +
                              " changed nothing, as the file's own normals are kept: --normals "
                              "replace computes new ones");
    if (grouped && !by_angle && given("--hard-angle"))
        out.remarks.push_back(
            "--hard-angle changed nothing, as the file's smoothing groups decide: "
            "--smoothing-groups off leaves it to the angle");
    if (given("--tangents") && command.settings.at("--tangents").back().starts_with("mikktspace") &&
        faces && !tangents)
        out.remarks.push_back("--tangents made none, as no mesh has the UVs for them");
}

// With what a scene file says of its picture, where the command line says nothing.
prep::Result<prep::Scene> load_with_picture(const std::filesystem::path& path,
                                            const prep::LoadOptions& options,
                                            std::optional<prep::OrbitCamera>& orbit,
                                            prep::RenderWishes& picture) {
    if (lower_ending(path) != "json") return prep::load_scene(path, options);
    prep::Result<prep::JsonScene> loaded = prep::load_scene_json(path, options);
    if (!loaded) return loaded.error();
    orbit = loaded->orbit;
    if (!picture.has("size") && loaded->picture.has("size")) picture = loaded->picture;
    return std::move(loaded->scene);
}

// One file on its way from input to output. A step that cannot be done says why in the outcome, and
// returns false.
class FilePreparation {
  public:
    FilePreparation(const Job& job, const PrepareCommand& command, int threads,
                    const BatchSurroundings& batch, const std::string& prefix)
        : job_(job),
          command_(command),
          threads_(threads),
          batch_(batch),
          prefix_(prefix),
          load_(load_options(command.common, batch.console)),
          picture_(command.picture),
          format_(job.format.empty() ? lower_ending(job.output) : job.format),
          is_gltf_(format_ == "glb" || format_ == "gltf") {
        load_.threads = threads;
        out_.job = job;
        out_.error = job.error;
    }

    Outcome run() && {
        if (!out_.error && read() && place() && prepare() && may_be_written()) write();
        return std::move(out_);
    }

  private:
    void begin(const char* what) {
        batch_.console.progress(command_.common, prefix_ + job_.input.string() + " … " + what);
        start_ = Clock::now();
    }

    // What was used since the call before.
    MemoryUse used() {
        const prep::detail::ProcessMemory before = memory_;
        memory_ = prep::detail::process_memory();
        return {memory_.page_faults - before.page_faults, memory_.peak_bytes};
    }

    bool failed(prep::Error error) {
        out_.error = std::move(error);
        return false;
    }

    bool read() {
        begin("reading");
        memory_ = prep::detail::process_memory();
        watch_.emplace(job_.input);
        prep::Result<InputFile> input =
            InputFile::open(job_.input, command_.common.input_format, &batch_.links);
        if (!input) return failed(input.error());
        input_.emplace(*std::move(input));
        out_.gltf_before = count_gltf_file(input_->path());
        prep::Result<prep::Scene> scene =
            command_.prepare.tessellation.pixel_error
                ? load_with_picture(input_->path(), load_, orbit_, picture_)
                : prep::load_scene(input_->path(), load_);
        out_.read_ms = milliseconds_since(start_);
        out_.read_memory = used();
        if (!scene) return failed(input_->relabelled(scene.error()));
        scene_ = *std::move(scene);
        if (!command_.manifest.empty() && !command_.files.in_place)
            note_sources(*input_, scene_, command_, *watch_, out_);
        out_.bytes_before = bytes_of(input_->path(), scene_);
        batch_.sources.add(job_, *input_, scene_);
        input_->settle(scene_);
        return true;
    }

    // At the scale and with the axis that were asked for, and with something to prepare.
    bool place() {
        prep::place_scene(scene_, command_.scale, command_.up);
        // Files without nodes have points where nodes put them.
        if (command_.scale != 1 || !is_gltf_) {
            if (auto error = beyond_float(scene_, command_.scale, job_.input))
                return failed(*std::move(error));
        }
        out_.before = count_scene(scene_);
        if (out_.gltf_before.figures.empty()) out_.parts = count_parts(scene_);
        out_.placement = scene_.placement;
        out_.warnings = scene_.warnings;
        out_.remarks = scene_.remarks;
        if (const prep::Result<void> some = prep::require_geometry(scene_); !some) {
            // Cameras, lights and animations are something to convert, where the format holds them;
            // and a glTF document is whatever it is.
            const bool others = !scene_.cameras.empty() || !scene_.lights.empty() ||
                                !scene_.animations.empty() || scene_.retained_file;
            if (!others || !is_gltf_) return failed(some.error());
            out_.warnings.push_back(some.error().text);
        }
        return true;
    }

    bool prepare() {
        begin("preparing");
        prep::PrepareOptions options = prepare_options(command_.prepare, load_, threads_);
        options.request.consumer = consumer_for(command_.consumer, scene_, job_.input, job_.output);
        options.document_stays = is_gltf_;
        if (options.tessellation.pixel_error) {
            const std::uint32_t width = picture_.choices.width, height = picture_.choices.height;
            const auto views =
                screen_views({command_.camera, 0, orbit_}, scene_, double(width) / height);
            if (!views) return failed(input_->relabelled(views.error()));
            options.tessellation.screens = screen_metrics(*views, width, height);
        }
        displacement_maps_ = count_displacement_maps(scene_);
        std::vector<std::vector<prep::Call>> calls;
        if (command_.explain) calls = prep::calls_for(scene_, options.request.consumer);
        prep::Result<prep::PreparedScene> prepared =
            prepared_in_time(std::move(scene_), options, command_, out_);
        if (!out_.times) out_.prepare_ms = milliseconds_since(start_);
        out_.prepare_memory = used();
        if (!prepared) return failed(input_->relabelled(prepared.error()));
        prepared_ = *std::move(prepared);
        if (command_.explain) out_.requirements = requirements_json(prepared_, calls);
        note_prepared();
        return true;
    }

    void note_prepared() {
        out_.after = count_prepared(prepared_, format_);
        out_.splits = prepared_.splits;
        out_.stages = prepared_.stages;
        out_.findings = prepared_.findings;
        remark_unused_options(prepared_, command_, out_);
        out_.repairs = prepared_.repairs;
        out_.tessellated = prepared_.tessellated;
        out_.orders = prepared_.orders;
        out_.residual_maps = prepared_.residual_maps;
        for (const prep::ResidualMap& map : out_.residual_maps)
            out_.residual_names.push_back(prepared_.scene.materials[map.material].name);
        for (const prep::Mesh& mesh : prepared_.scene.meshes) out_.mesh_names.push_back(mesh.name);
    }

    bool may_be_written() {
        if (command_.files.in_place && format_ == "obj") {
            if (auto error = at_odds_with_libraries(prepared_, displacement_maps_, job_.input))
                return failed(*std::move(error));
        }
        if (command_.strict && out_.warning_count() > 0)
            return failed({prep::ErrorCode::invalid,
                           count_of(out_.warning_count(), "warning") +
                               ", and --strict was given: nothing was written",
                           job_.input.string()});
        return true;
    }

    prep::SaveOptions save_options() {
        prep::SaveOptions save;
        save.threads = threads_;
        const bool two_forms = format_ == "ply" || format_ == "stl";
        save.ascii =
            command_.files.ascii || (command_.files.in_place && two_forms && is_text(job_.input));
        save.compression = command_.compression;
        save.replace = command_.files.overwrite;
        save.replace_sources = command_.files.in_place;
        save.written = &out_.written;
        save.spared = [this](const std::filesystem::path& file) {
            return batch_.sources.of_another(job_, file);
        };
        return save;
    }

    bool write() {
        begin("writing");
        const prep::SaveOptions save = save_options();
        const bool stream = is_standard_stream(job_.output);
        if (!stream) {
            if (const auto made = batch_.directories.make_for(job_.output); !made)
                return failed(made.error());
        }
        prep::Result<std::vector<std::string>> notes =
            save_quantized(prepared_, command_, save, threads_, out_);
        out_.write_ms = milliseconds_since(start_);
        out_.write_memory = used();
        if (!notes) return failed(input_->relabelled(notes.error()));
        out_.notes = *std::move(notes);
        if (out_.quantized)
            out_.remarks.insert(out_.remarks.end(), out_.quantized->remarks.begin(),
                                out_.quantized->remarks.end());
        if (command_.strict && !out_.notes.empty())
            out_.error =
                prep::Error{prep::ErrorCode::invalid,
                            "the format does not hold all there is, and --strict was given; the "
                            "file is there",
                            job_.output.string()};
        // What went into a pipe cannot be looked at: opening it would wait for another writer.
        std::error_code ec;
        if (!stream && std::filesystem::is_regular_file(job_.output, ec))
            out_.gltf_after = count_gltf_file(job_.output);
        out_.bytes_after = out_.bytes.size();
        for (const std::filesystem::path& file : out_.written) out_.bytes_after += bytes_of(file);
        // In place the input is what was written by now.
        if (!command_.manifest.empty() && command_.files.in_place)
            note_sources(*input_, prepared_.scene, command_, *watch_, out_);
        return true;
    }

    const Job& job_;
    const PrepareCommand& command_;
    const int threads_;
    const BatchSurroundings batch_;
    const std::string& prefix_;
    prep::LoadOptions load_;
    prep::RenderWishes picture_;
    const std::string format_;
    const bool is_gltf_;
    Outcome out_;
    Clock::time_point start_;
    prep::detail::ProcessMemory memory_{};
    std::optional<ReadWatch> watch_;
    std::optional<InputFile> input_;
    std::optional<prep::OrbitCamera> orbit_;
    prep::Scene scene_;  // until it is prepared
    std::size_t displacement_maps_ = 0;
    prep::PreparedScene prepared_;
};

}  // namespace

std::size_t Outcome::warning_count() const {
    std::size_t count = warnings.size() + notes.size();
    for (const prep::Finding& f : findings) count += f.severity != prep::Severity::info;
    return count;
}

Outcome prepare_file(const Job& job, const PrepareCommand& command, int threads,
                     const BatchSurroundings& batch, const std::string& prefix) {
    return FilePreparation(job, command, threads, batch, prefix).run();
}

}  // namespace meshprep
