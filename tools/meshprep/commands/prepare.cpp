#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <new>
#include <thread>

#include "meshprep/budgets/prepare_budget.h"
#include "meshprep/commands/in_order.h"
#include "meshprep/commands/prepare_file.h"
#include "meshprep/commands/prepare_report.h"
#include "meshprep/commands/subcommand.h"
#include "meshprep/files/manifest.h"
#include "meshprep/files/output_directories.h"
#include "meshprep/options/values.h"
#include "meshprep/output/file_records.h"

namespace meshprep {
namespace {

// The files of one command line, and what is said of them.
class Batch {
  public:
    Batch(const PrepareCommand& command, const JobList& list, Console& console)
        : command_(command),
          common_(command.common),
          list_(list),
          console_(console),
          records_("prepare", common_, console),
          sources_(list.jobs, common_, console),
          earlier_(command.settings),
          manifest_(command.settings) {
        if (command.prepare.displacement.map) sources_.add(command.prepare.displacement.map->path);
    }

    int run() {
        if (const auto file = under_manifest())
            return records_.fail(
                {prep::ErrorCode::invalid,
                 "the manifest would be written over this file; give it another name",
                 file->string()},
                exit_usage);
        // That of an earlier run is no output's to replace.
        if (!command_.manifest.empty()) sources_.add(command_.manifest);
        if (command_.skip_unchanged) {
            if (const prep::Result<void> read = earlier_.read(command_.manifest); !read)
                return records_.fail(read.error(), exit_failed);
            manifest_ = earlier_;
        }
        const Clock::time_point start = Clock::now();
        last_written_ = start;
        const std::size_t total = list_.jobs.size();
        const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
        const std::size_t at_once =
            std::min(total, std::size_t(command_.jobs > 0 ? command_.jobs : int(cores)));
        // The threads there are, shared out; results do not depend on it.
        int threads = common_.threads;
        if (at_once > 1) threads = std::max(1, (threads > 0 ? threads : int(cores)) / int(at_once));
        in_order(
            total, at_once,
            [&](std::size_t i) {
                return one(list_.jobs[i], threads, at_once > 1 ? "" : prefix(i));
            },
            [&](const Outcome& outcome) { report(outcome); });
        console_.progress(common_, "");
        const double milliseconds = milliseconds_since(start);
        if (total > 1)
            console_.result(common_,
                            fmt::format("{}: {} ok, {}{} failed, {} with warnings, {}",
                                        count_of(total, "file"), total - failed_ - skipped_,
                                        skipped_ > 0 ? fmt::format("{} skipped, ", skipped_) : "",
                                        failed_, warned_, duration(milliseconds)));
        bool written = true;
        if (!command_.manifest.empty()) written = write_manifest();
        records_.finish({{"files", total},
                         {"ok", total - failed_ - skipped_},
                         {"skipped", skipped_},
                         {"failed", failed_},
                         {"with_warnings", warned_},
                         {"milliseconds", milliseconds}});
        return failed_ > 0 || unmet_ > 0 || !written ? exit_failed : exit_done;
    }

  private:
    std::string prefix(std::size_t i) const {
        const std::size_t total = list_.jobs.size();
        return total > 1 ? fmt::format("[{}/{}] ", i + 1, total) : "";
    }

    Outcome one(const Job& job, int threads, const std::string& prefix) {
        Outcome outcome;
        outcome.job = job;
        try {
            const bool may_be_done = !job.error || job.output_stands;
            const auto done =
                may_be_done && command_.skip_unchanged ? earlier_.finished(job) : std::nullopt;
            if (done) {
                outcome.skipped = true;
                std::vector<std::filesystem::path> files;
                for (const HashedFile& source : done->sources) files.emplace_back(source.path);
                sources_.add(job, files);
                return outcome;
            }
            return prepare_file(job, command_, threads, {directories_, links_, sources_, console_},
                                prefix);
        } catch (const std::bad_alloc&) {
            outcome.error = prep::Error{
                prep::ErrorCode::limit,
                "out of memory; nothing was half written" +
                    std::string(command_.jobs == 1 ? "" : "; fewer --jobs need less of it"),
                job.input.string()};
        } catch (const std::exception& e) {
            // No thread to be had, for one: this file's error, not the end of the others.
            outcome.error =
                prep::Error{prep::ErrorCode::limit, std::string("the system refused: ") + e.what(),
                            job.input.string()};
        }
        return outcome;
    }

    void report(const Outcome& outcome) {
        const bool only = list_.jobs.size() == 1;
        for (const std::string& text : outcome.warnings)
            console_.warning(common_, said_of(outcome.job.input, text));
        for (const std::string& text : outcome.notes)
            console_.warning(common_, outcome.job.output.string() + ": " + text);
        if (outcome.error) {
            ++failed_;
            console_.error(*outcome.error);
            if (!only) console_.result(common_, "failed  " + outcome.job.input.string());
        } else if (outcome.skipped) {
            ++skipped_;
            console_.result(common_,
                            fmt::format("skipped {} → {}  unchanged", outcome.job.input.string(),
                                        outcome.job.output.string()));
        } else if (!only) {
            print_row(outcome, command_, console_);
        } else {
            print_details(outcome, command_, console_);
        }
        if (outcome.certificate && !outcome.certificate->met()) console_.error(unmet_text(outcome));
        if (outcome.times && !outcome.error)
            say_time(common_, *outcome.times, preparing_work, again_text(outcome, command_),
                     console_);
        unmet_ += !outcome.met();
        if (!outcome.bytes.empty()) console_.bytes(outcome.bytes);
        warned_ += outcome.warning_count() > 0;
        if (records_.wanted()) records_.add(outcome_json(outcome, command_));
        if (command_.manifest.empty() || outcome.skipped) return;
        // The file that stands in the way is the one that an earlier run made: what was said of it
        // is still so.
        if (outcome.error && outcome.job.output_stands && earlier_.has_done(outcome.job)) return;
        manifest_.set(manifest_entry(outcome, command_));
        // A run that is ended later has lost a few seconds' work, not all of it.
        constexpr double milliseconds_between = 5000;
        if (milliseconds_since(last_written_) > milliseconds_between && write_manifest())
            last_written_ = Clock::now();
    }

    // A file that is read or written otherwise, and has the manifest's name. Outputs beside a mesh
    // are known when they are written.
    std::optional<std::filesystem::path> under_manifest() {
        if (command_.manifest.empty()) return std::nullopt;
        std::error_code ec;
        const std::filesystem::path own = identity_of(command_.manifest);
        for (const Job& job : list_.jobs)
            for (const std::filesystem::path& file : {job.input, job.output})
                if (!is_standard_stream(file) &&
                    (identity_of(file) == own ||
                     std::filesystem::equivalent(file, command_.manifest, ec)))
                    return file;
        // Inputs are not loaded for a manifest of an earlier run.
        const bool there = std::filesystem::is_regular_file(command_.manifest, ec) &&
                           std::filesystem::file_size(command_.manifest, ec) > 0;
        if (there && !Manifest::is_one(command_.manifest) && sources_.of_any(command_.manifest))
            return command_.manifest;
        return std::nullopt;
    }

    bool write_manifest() {
        prep::Result<void> done = directories_.make_for(command_.manifest);
        if (done) done = manifest_.write(command_.manifest);
        if (!done) console_.error(done.error());
        return bool(done);
    }

    const PrepareCommand& command_;
    const CommonOptions& common_;
    const JobList& list_;
    Console& console_;
    FileRecords records_;
    OutputDirectories directories_;
    SiblingLinks links_;
    BatchSources sources_;
    Manifest earlier_, manifest_;
    Clock::time_point last_written_;
    std::size_t failed_ = 0, skipped_ = 0, warned_ = 0, unmet_ = 0;
};

int run(const PrepareCommand& command, Console& console) {
    if (is_standard_stream(command.files.output)) console.keep_output_for_bytes();
    const prep::Result<JobList> list = plan_jobs(command.files);
    if (!list)
        return FileRecords("prepare", command.common, console)
            .fail(list.error(),
                  list.error().code == prep::ErrorCode::io ? exit_failed : exit_usage);
    const prep::Result<ConsumerWish> consumer = read_scene_file(command.consumer);
    if (!consumer)
        return FileRecords("prepare", command.common, console).fail(consumer.error(), exit_failed);
    PrepareCommand read = command;
    read.consumer = *consumer;
    const int code = Batch(read, *list, console).run();
    // Where nothing could be begun and no file is to blame, the command line is.
    const bool mistaken = std::all_of(list->jobs.begin(), list->jobs.end(), [](const Job& job) {
        return job.error && job.error->code != prep::ErrorCode::io;
    });
    return mistaken ? exit_usage : code;
}

void parse_quantization(const std::string& text, PrepareCommand& c) {
    c.choose_bits = text == "auto";
    if (c.choose_bits) {
        c.quantization = usual_quantization();
        return;
    }
    const auto wrong = [](const std::string& why) { usage_error("--quantize", why); };
    c.quantization = {};
    for (const std::string& word : parse_list(text)) {
        const std::size_t at = word.find('=');
        const auto* row =
            std::find_if(std::begin(prep::quantization_rows), std::end(prep::quantization_rows),
                         [&](const auto& r) { return word.substr(0, at) == r.name; });
        if (row == std::end(prep::quantization_rows) || at == std::string::npos)
            return wrong("'" + word +
                         "' is not one of positions=BITS, normals=BITS, tangents=BITS, uvs=BITS, "
                         "or auto");
        const std::vector<double> bits = parse_numbers(word.substr(at + 1), ',');
        if (bits.size() != 1 || bits[0] != std::floor(bits[0]) || bits[0] < row->least ||
            bits[0] > row->most)
            return wrong(fmt::format("{} have {} to {} bits, not '{}'", row->name, row->least,
                                     row->most, word.substr(at + 1)));
        int& to = c.quantization.*row->bits;
        if (to != 0) return wrong(std::string(row->name) + " are given twice");
        to = int(bits[0]);
    }
    if (!c.quantization.any()) wrong("names nothing");
}

// What bits are chosen by is measured on a file that stays.
void check_direction_errors(const PrepareCommand& c) {
    if (!c.direction_errors.any()) return;
    const char* const given = c.direction_errors.normals ? "--normal-error" : "--tangent-error";
    if (!c.choose_bits)
        usage_error(given, "chooses how directions are rounded; give --quantize auto as well");
    if (c.files.in_place || is_standard_stream(c.files.output))
        usage_error(given, "is measured on the file that is written; give -o FILE or -o DIR");
}

// What is chosen by a time is said by nothing else.
void check_budget(const PrepareCommand& c) {
    if (!c.budget_ms) return;
    const auto given = [&c](const char* name) { return c.settings.count(name) > 0; };
    if (given("--precision"))
        usage_error("--budget-ms", "and --precision both choose the precision; leave one out");
    if (c.prepare.tessellate)
        usage_error("--budget-ms",
                    "chooses no error of triangles; limit their time with --max-triangles");
    if (c.prepare.subdivide && c.settings.at("--subdivide").back().find(':') != std::string::npos)
        usage_error("--budget-ms",
                    "chooses the level of --subdivide; give the scheme alone, as in catmark");
    if (c.jobs != 1) usage_error("--budget-ms", "works on one file at a time; leave --jobs out");
}

// Which files, and of which format.
void add_file_options(OptionSet& options, PrepareCommand& c) {
    options
        .paths(
            "input", c.files.inputs, "FILE|DIR",
            "Mesh or scene files, .gz and .zip too, directories of them, or - for standard input")
        .required();
    options.path("-o,--output", c.files.output, "FILE|DIR",
                 "A file (its ending says the format), a directory, or - for standard output");
    options.word(
        "--format", output_endings(), [&c](const std::string& word) { c.files.format = word; },
        "Format of files written to a directory (default glb) or to standard output");
    options.flag("--ascii", c.files.ascii, "PLY and STL as text");
}

// How glTF files hold their vertices and triangles.
void add_encoding_options(OptionSet& options, PrepareCommand& c) {
    options.named("--compress", c.compression,
                  "Vertices and triangles of glTF files: as the glTF input has them (keep, the "
                  "default), as they are, by Draco, or by meshopt. No value is changed, but where "
                  "Draco rounded the input's: there its steps are kept");
    options.flag("--optimize", c.prepare.optimize,
                 "Triangles and vertices of glTF files in an order that graphics hardware reads "
                 "with less work (vertex cache, overdraw, fetch); no value is changed, and "
                 "triangles that blend keep their order");
    options.value(
        "--quantize", "NAME=BITS,…|auto",
        [&c](const std::string& text) { parse_quantization(text, c); },
        "Vertices of glTF files as whole numbers (KHR_mesh_quantization): positions and uvs of 4 "
        "to 16 bits, normals and tangents of 8 to 16; auto: 16 and 12, or what the errors below "
        "take. Values are rounded before they are compressed, and the error is told");
    options.not_negative("--normal-error", c.direction_errors.normals, "DEG",
                         "With --quantize auto: the fewest bits that turn no normal by more, "
                         "measured; exit 1 with the best found where none do");
    options.not_negative("--tangent-error", c.direction_errors.tangents, "DEG",
                         "The same of tangents");
}

// Which inputs become outputs, and what is told of them.
void add_batch_options(OptionSet& options, PrepareCommand& c) {
    options.flag("--in-place", c.files.in_place, "Write each result over its input");
    options.flag(
        "-r,--recursive", c.files.recursive,
        "Also what lies in directories below, kept apart in directories of the same names");
    options.flag("--no-overwrite", c.files.overwrite,
                 "An output file that exists is an error instead of being replaced", false);
    options.flag(
        "--strict", c.strict,
        "A warning is an error: such an input is not written, or, where the output's format "
        "cannot hold something, told as failed");
    options.number("--jobs", c.jobs, 0, 256, "N",
                   "Files at once (default 1); 0: as many as there are cores. Results and their "
                   "order do not depend on it");
    const Option manifest =
        options.path("--manifest", c.manifest, "FILE",
                     "Write what was made of what, as JSON: inputs and outputs with their hashes, "
                     "settings, findings");
    options
        .flag("--skip-unchanged", c.skip_unchanged,
              "Leave out what the manifest says is done: the same input, settings and version, and "
              "outputs that are byte for byte as they were written")
        .needs(manifest);
    options.flag("--explain", c.explain,
                 "Each stage: run or skipped, its reason, its milliseconds; and for each mesh, "
                 "which material calls for which attributes");
}

// Lengths and axes.
void add_space_options(OptionSet& options, PrepareCommand& c) {
    options.value(
        "--scale", "FACTOR",
        [&c](const std::string& text) {
            const std::vector<double> numbers = parse_numbers(text, ',');
            if (numbers.size() != 1 || !(numbers[0] > 0) || !std::isfinite(numbers[0]))
                usage_error("--scale", "not a number over 0");
            using Limits = std::numeric_limits<float>;
            if (numbers[0] < double(Limits::min()) || numbers[0] > double(Limits::max()))
                usage_error("--scale", "beyond the range of float, 1.2e-38 to 3.4e38");
            c.scale = numbers[0];
        },
        "Multiplies all lengths, on top of the unit that the file states (FBX, DAE: metres "
        "result)");
    options.named("--up", c.up,
                  "The axis that points up, after what the file states of it: it is turned to y "
                  "(default y)");
}

// The picture whose pixels errors of triangles are measured in.
void add_picture_options(OptionSet& options, PrepareCommand& c) {
    const Option pixel_error = add_pixel_error_option(options, c.prepare);
    options.group("Picture of --pixel-error");
    add_camera_options(options, c.camera);
    options
        .value(
            "--size", "WxH",
            [&c](const std::string& text) {
                const glm::uvec2 size = parse_size("--size", text, prep::max_picture_extent);
                c.picture.choices.width = size.x;
                c.picture.choices.height = size.y;
                c.picture.given.insert("size");
            },
            "Its pixels (default: the scene file's, else 1024x768)")
        .needs(pixel_error);
}

constexpr const char* prepare_examples =
    "  meshprep prepare spot.obj -o spot.glb\n"
    "  meshprep prepare part.stl -o part.glb --hard-angle 30 --explain\n"
    "  meshprep prepare *.obj more/*.fbx -o out/        many files; a bad one stops no other\n"
    "  meshprep prepare assets -r -o out --format gltf  a tree of files\n"
    "  meshprep prepare spot.obj -o spot.glb --for shading=phong    no tangents for its maps\n"
    "  meshprep prepare spot.obj -o spot.glb --optimize --compress meshopt\n"
    "  meshprep prepare part.stl -o part.glb --scale 0.001 --up z   millimetres, z up\n"
    "  meshprep prepare assets -r -o out --jobs 0 --manifest out/made.json --skip-unchanged\n"
    "  curl -s $URL | meshprep prepare - -o - --format glb > chair.glb\n"
    "  meshprep prepare rock.glb -o small.glb --quantize auto --normal-error 0.1\n"
    "  meshprep prepare cage.obj -o fine.glb --subdivide catmark --budget-ms 100\n"
    "  meshprep prepare rock.glb --in-place --tangents mikktspace";

void define(OptionSet& options, PrepareCommand& c) {
    add_file_options(options, c);
    add_encoding_options(options, c);
    options.not_negative("--budget-ms", c.budget_ms, "MS",
                         "The most accurate normals, or with --subdivide SCHEME the finest level, "
                         "that are predicted to be prepared within so many milliseconds, file by "
                         "file; exit 1 with the fastest where none are");
    add_batch_options(options, c);
    add_consumer_option(options, c.consumer);
    add_space_options(options, c);
    add_input_options(options, c.common);
    add_preparation_options(options, c.prepare);
    add_picture_options(options, c);
    add_loading_options(options, c.common.load);
    add_common_options(options, c.common);
    add_json_lines_option(options, c.common);
    options.keep_settings(c.settings, {"--output", "--jobs", "--manifest", "--skip-unchanged",
                                       "--explain", "--recursive", "--no-overwrite"});
    options.examples(prepare_examples);
}

void check(const PrepareCommand& c) {
    if (c.files.output.empty() && !c.files.in_place)
        usage_error("--output", "is missing; give -o FILE or -o DIR (or --in-place)");
    if (!c.files.output.empty() && c.files.in_place)
        usage_error("--in-place", "writes over the inputs; it takes no --output");
    if (is_standard_stream(c.files.output) && (c.common.json || c.common.json_lines))
        usage_error("--output", "- takes standard output, and so does JSON; leave one of them out");
    if (is_standard_stream(c.manifest))
        usage_error("--manifest",
                    "is written to a file, - is none; --json writes to standard output");
    if (c.common.json && c.common.json_lines)
        usage_error("--json",
                    "is one document, --json-lines a line for each file; give one of them");
    if (c.skip_unchanged && !c.consumer.scene_file.empty())
        usage_error("--for",
                    "a scene file may have changed, which --skip-unchanged does not see; name the "
                    "choices instead, as in shading=phong");
    check_direction_errors(c);
    check_budget(c);
    check_camera(c.camera);
    const bool placed = std::holds_alternative<PlaceChoice>(c.camera.camera);
    const char* const given = placed                         ? "--look-from"
                              : c.camera.camera.index() != 0 ? "--camera"
                              : c.camera.yfov                ? "--fov"
                                                             : "--ortho";
    if (c.camera.any() && !c.prepare.tessellation.pixel_error)
        usage_error(
            given,
            "and the other options of a view say where --pixel-error is meant; give that as well");
}

}  // namespace

Subcommand prepare_subcommand() {
    return subcommand<PrepareCommand>(
        "prepare", "Load, check, prepare what the materials call for, write", define, run, check);
}

}  // namespace meshprep
