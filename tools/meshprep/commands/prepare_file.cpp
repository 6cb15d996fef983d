#include "meshprep/commands/prepare_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <string_view>

#include "base/process_memory.h"
#include "formats/picture_search.h"
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

// Where a picture would have been found before it was found at `file`: it was absent there, and
// what appears there takes its place. The order is that of formats/picture_search.h; `folder` is
// the model's, and as the name in the model is not known, the part below the directory stands for
// it.
void note_passed_over(const std::filesystem::path& file, const std::filesystem::path& folder,
                      const std::vector<std::filesystem::path>& texture_directories, Outcome& out) {
    namespace fs = std::filesystem;
    std::vector<fs::path> sought{folder / "."};
    for (const char* const above : {".", ".."})
        for (const std::string_view name : prep::detail::picture_folders)
            sought.push_back(folder / above / name);
    sought.insert(sought.end(), texture_directories.begin(), texture_directories.end());
    for (fs::path& directory : sought) directory = directory.lexically_normal();
    std::error_code ec;
    for (std::size_t at = 1; at < sought.size(); ++at) {
        const fs::path name = file.lexically_normal().lexically_relative(sought[at]);
        if (name.empty() || *name.begin() == ".." || name == ".") continue;
        for (std::size_t before = 0; before < at; ++before)
            if (const fs::path passed = sought[before] / name; !fs::exists(passed, ec))
                out.absent.insert(passed.string());
    }
}

// Files that were read for the scene, with their hashes; one that was named and not found makes the
// result one that may change, and so does a pipe, which nobody can look at again, and a file that
// was changed since reading began, unless it is one of those written.
void note_sources(const InputFile& input, const prep::Scene& scene, const PrepareCommand& command,
                  const ReadWatch& watch, Outcome& out) {
    const prep::DisplaceOptions& displacement = command.prepare.displacement;
    std::set<std::filesystem::path> written;
    for (const std::filesystem::path& file : out.written) written.insert(identity(file));
    const auto add = [&](const std::filesystem::path& file) {
        out.sources.push_back(hashed(file));
        out.complete &= out.sources.back().sha256.has_value() &&
                        (watch.unchanged(file) || written.count(identity(file)) != 0);
    };
    std::vector<std::filesystem::path> files;
    std::set<std::filesystem::path> folders{
        std::filesystem::path(input.relabelled(input.path().string())).parent_path()};
    for (const std::filesystem::path& library : scene.libraries)
        folders.insert(std::filesystem::path(input.relabelled(library.string())).parent_path());
    for (const std::filesystem::path& library : scene.libraries)
        if (!input.passing(library)) files.push_back(library);
    for (const prep::ImageRef& image : scene.images) {
        for (const std::filesystem::path& file : prep::files_of(image))
            if (!input.passing(file)) {
                files.push_back(file);
                for (const std::filesystem::path& folder : folders)
                    note_passed_over(input.relabelled(file.string()), folder,
                                     command.common.load.texture_directories, out);
            }
        out.complete &= !image.path.empty() || !image.bytes.empty() || !image.channels.empty();
    }
    for (const std::string& text : scene.warnings)
        out.complete &= text.find("cannot be read") == std::string::npos;
    if (displacement.map) files.push_back(displacement.map->path);
    if (const auto source = input.source())
        add(*source);
    else
        out.complete = false;
    // Beside an unpacked file are links to what lies beside the packed one.
    for (const std::filesystem::path& file : files) add(input.relabelled(file.string()));
}

// Lengths are floats where they are written, and wherever they are read.
std::optional<prep::Error> beyond_float(const prep::Scene& scene,
                                        const std::filesystem::path& input) {
    struct Bounds {
        glm::dvec3 low{std::numeric_limits<double>::infinity()};
        glm::dvec3 high{-std::numeric_limits<double>::infinity()};
    };
    std::vector<Bounds> bounds(scene.meshes.size());
    for (std::size_t m = 0; m < scene.meshes.size(); ++m)
        for (const glm::dvec3 p : scene.meshes[m].positions)
            if (std::isfinite(p.x + p.y + p.z)) {
                bounds[m].low = glm::min(bounds[m].low, p);
                bounds[m].high = glm::max(bounds[m].high, p);
            }
    const std::vector<glm::dmat4> world = prep::world_transforms(scene);
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
                           "coordinates are beyond the range of float (3.4e38) with this --scale",
                           input.string()};
    if (largest > 0 && largest < double(Limits::min()))
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

}  // namespace

std::size_t Outcome::warning_count() const {
    std::size_t count = warnings.size() + notes.size();
    for (const prep::Finding& f : findings) count += f.severity != prep::Severity::info;
    return count;
}

Outcome prepare_file(const Job& job, const PrepareCommand& command, int threads,
                     OutputDirectories& directories, SiblingLinks& links, BatchSources& sources,
                     Console& console, const std::string& prefix) {
    Outcome out;
    out.job = job;
    out.error = job.error;
    if (out.error) return out;
    const auto show = [&](const char* what) {
        console.progress(command.common, prefix + job.input.string() + " … " + what);
    };

    show("reading");
    Clock::time_point start = Clock::now();
    prep::detail::ProcessMemory memory = prep::detail::process_memory();
    // What the step since the last call used.
    const auto used = [&memory] {
        const prep::detail::ProcessMemory now = prep::detail::process_memory();
        const MemoryUse use{now.page_faults - memory.page_faults, now.peak_bytes};
        memory = now;
        return use;
    };
    const ReadWatch watch(job.input);
    const prep::Result<InputFile> input =
        InputFile::open(job.input, command.common.input_format, &links);
    if (!input) {
        out.error = input.error();
        return out;
    }
    out.gltf_before = count_gltf_file(input->path());
    prep::LoadOptions load = load_options(command.common, console);
    load.threads = threads;
    std::optional<prep::OrbitCamera> orbit;
    prep::RenderWishes picture = command.picture;
    prep::Result<prep::Scene> scene = command.prepare.tessellation.pixel_error
                                          ? load_with_picture(input->path(), load, orbit, picture)
                                          : prep::load_scene(input->path(), load);
    out.read_ms = milliseconds_since(start);
    out.read_memory = used();
    if (!scene) {
        out.error = input->relabelled(scene.error());
        return out;
    }
    if (!command.manifest.empty() && !command.files.in_place)
        note_sources(*input, *scene, command, watch, out);
    out.bytes_before = bytes_of(input->path(), *scene);
    sources.add(job, *input, *scene);
    input->settle(*scene);
    prep::place_scene(*scene, command.scale, command.up);
    if (command.scale != 1) {
        if (out.error = beyond_float(*scene, job.input); out.error) return out;
    }
    out.before = count_scene(*scene);
    if (out.gltf_before.figures.empty()) out.parts = count_parts(*scene);
    out.placement = scene->placement;
    out.warnings = scene->warnings;
    out.remarks = scene->remarks;
    const std::string format = job.format.empty() ? lower_ending(job.output) : job.format;
    const bool is_gltf = format == "glb" || format == "gltf";
    if (const prep::Result<void> some = prep::require_geometry(*scene); !some) {
        // Cameras, lights and animations are something to convert, where the format holds them; and
        // a glTF document is whatever it is.
        const bool others = !scene->cameras.empty() || !scene->lights.empty() ||
                            !scene->animations.empty() || scene->retained_file;
        if (!others || !is_gltf) {
            out.error = some.error();
            return out;
        }
        out.warnings.push_back(some.error().text);
    }

    show("preparing");
    start = Clock::now();
    prep::PrepareOptions options = prepare_options(command.prepare, load, threads);
    options.request.consumer = consumer_for(command.consumer, *scene, job.input, job.output);
    options.document_stays = is_gltf;
    if (options.tessellation.pixel_error) {
        const std::uint32_t width = picture.choices.width, height = picture.choices.height;
        const auto views = screen_views({command.camera, 0, orbit}, *scene, double(width) / height);
        if (!views) {
            out.error = input->relabelled(views.error());
            return out;
        }
        options.tessellation.screens = screen_metrics(*views, width, height);
    }
    const std::size_t displacement_maps = count_displacement_maps(*scene);
    std::vector<std::vector<prep::Call>> calls;
    if (command.explain) calls = prep::calls_for(*scene, options.request.consumer);
    prep::Result<prep::PreparedScene> prepared =
        prepared_in_time(*std::move(scene), options, command, out);
    if (!out.times) out.prepare_ms = milliseconds_since(start);
    out.prepare_memory = used();
    if (!prepared) {
        out.error = input->relabelled(prepared.error());
        return out;
    }
    out.after = count_prepared(*prepared, format);
    out.splits = prepared->splits;
    out.stages = prepared->stages;
    out.findings = prepared->findings;
    remark_unused_options(*prepared, command, out);
    out.repairs = prepared->repairs;
    out.tessellated = prepared->tessellated;
    out.orders = prepared->orders;
    out.residual_maps = prepared->residual_maps;
    for (const prep::ResidualMap& map : out.residual_maps)
        out.residual_names.push_back(prepared->scene.materials[map.material].name);
    for (const prep::Mesh& mesh : prepared->scene.meshes) out.mesh_names.push_back(mesh.name);
    if (command.explain) out.requirements = requirements_json(*prepared, calls);
    if (command.files.in_place && format == "obj") {
        out.error = at_odds_with_libraries(*prepared, displacement_maps, job.input);
        if (out.error) return out;
    }
    if (command.strict && out.warning_count() > 0) {
        out.error = prep::Error{prep::ErrorCode::invalid,
                                count_of(out.warning_count(), "warning") +
                                    ", and --strict was given: nothing was written",
                                job.input.string()};
        return out;
    }

    show("writing");
    start = Clock::now();
    prep::SaveOptions save;
    save.threads = threads;
    const bool two_forms = format == "ply" || format == "stl";
    save.ascii = command.files.ascii || (command.files.in_place && two_forms && is_text(job.input));
    save.compression = command.compression;
    save.replace = command.files.overwrite;
    save.replace_sources = command.files.in_place;
    save.written = &out.written;
    save.spared = [&](const std::filesystem::path& file) { return sources.of_another(job, file); };
    const bool stream = is_standard_stream(job.output);
    if (const auto made = stream ? prep::Result<void>() : directories.make_for(job.output); !made) {
        out.error = made.error();
        return out;
    }
    prep::Result<std::vector<std::string>> notes =
        save_quantized(*prepared, command, save, threads, out);
    out.write_ms = milliseconds_since(start);
    out.write_memory = used();
    if (!notes) {
        out.error = input->relabelled(notes.error());
        return out;
    }
    out.notes = *std::move(notes);
    if (out.quantized)
        out.remarks.insert(out.remarks.end(), out.quantized->remarks.begin(),
                           out.quantized->remarks.end());
    if (command.strict && !out.notes.empty())
        out.error =
            prep::Error{prep::ErrorCode::invalid,
                        "the format does not hold all there is, and --strict was given; the "
                        "file is there",
                        job.output.string()};
    // What went into a pipe cannot be looked at: opening it would wait for another writer.
    std::error_code ec;
    if (!stream && std::filesystem::is_regular_file(job.output, ec))
        out.gltf_after = count_gltf_file(job.output);
    out.bytes_after = out.bytes.size();
    for (const std::filesystem::path& file : out.written) out.bytes_after += bytes_of(file);
    // In place the input is what was written by now.
    if (!command.manifest.empty() && command.files.in_place)
        note_sources(*input, prepared->scene, command, watch, out);
    return out;
}

}  // namespace meshprep
