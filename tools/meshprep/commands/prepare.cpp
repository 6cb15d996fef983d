#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <thread>

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
          manifest_(command.settings) {}

    int run() {
        for (const Job& job : list_.jobs)
            for (const std::filesystem::path& file : {job.input, job.output})
                if (!command_.manifest.empty() &&
                    file.lexically_normal() == command_.manifest.lexically_normal())
                    return records_.fail({prep::ErrorCode::invalid,
                                          "the manifest would be written over this file; give it "
                                          "another name",
                                          file.string()},
                                         exit_usage);
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
        return failed_ > 0 || !written ? exit_failed : exit_done;
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
            const auto done =
                !job.error && command_.skip_unchanged ? earlier_.finished(job) : std::nullopt;
            if (done) {
                outcome.skipped = true;
                std::vector<std::filesystem::path> files;
                for (const HashedFile& source : done->sources) files.emplace_back(source.path);
                sources_.add(job, files);
                return outcome;
            }
            return prepare_file(job, command_, threads, directories_, links_, sources_, console_,
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
            console_.warning(common_, outcome.job.input.string() + ": " + text);
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
        if (!outcome.bytes.empty()) console_.bytes(outcome.bytes);
        warned_ += outcome.warning_count() > 0;
        if (records_.wanted()) records_.add(outcome_json(outcome));
        if (command_.manifest.empty() || outcome.skipped) return;
        manifest_.set(manifest_entry(outcome));
        // A run that is ended later has lost a few seconds' work, not all of it.
        constexpr double milliseconds_between = 5000;
        if (milliseconds_since(last_written_) > milliseconds_between && write_manifest())
            last_written_ = Clock::now();
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
    std::size_t failed_ = 0, skipped_ = 0, warned_ = 0;
};

int run(const PrepareCommand& command, Console& console) {
    if (is_standard_stream(command.files.output)) console.keep_output_for_bytes();
    const prep::Result<JobList> list = plan_jobs(command.files);
    if (!list)
        return FileRecords("prepare", command.common, console)
            .fail(list.error(),
                  list.error().code == prep::ErrorCode::io ? exit_failed : exit_usage);
    const int code = Batch(command, *list, console).run();
    // Where nothing could be begun and no file is to blame, the command line is.
    const bool mistaken = std::all_of(list->jobs.begin(), list->jobs.end(), [](const Job& job) {
        return job.error && job.error->code != prep::ErrorCode::io;
    });
    return mistaken ? exit_usage : code;
}

void define(OptionSet& options, PrepareCommand& c) {
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
    options.named("--compress", c.compression,
                  "Vertices and triangles of glTF files: as the glTF input has them (keep, the "
                  "default), as they are, by Draco, or by meshopt. No value is changed, but where "
                  "Draco rounded the input's: there its steps are kept");
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
                 "Each stage: run or skipped, its reason, its milliseconds");
    options.value(
        "--scale", "FACTOR",
        [&c](const std::string& text) {
            const std::vector<double> numbers = parse_numbers(text, ',');
            if (numbers.size() != 1 || !(numbers[0] > 0) || !std::isfinite(numbers[0]))
                usage_error("--scale", "not a number over 0");
            c.scale = numbers[0];
        },
        "Multiplies all lengths, on top of the unit that the file states (FBX, DAE: metres "
        "result)");
    options.named("--up", c.up,
                  "The axis that points up, after what the file states of it: it is turned to y "
                  "(default y)");
    add_input_options(options, c.common);
    add_preparation_options(options, c.prepare);
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
    add_loading_options(options, c.common.load);
    add_common_options(options, c.common);
    add_json_lines_option(options, c.common);
    options.keep_settings(c.settings, {"--output", "--jobs", "--manifest", "--skip-unchanged",
                                       "--explain", "--recursive", "--no-overwrite"});
    options.examples(
        "  meshprep prepare spot.obj -o spot.glb\n"
        "  meshprep prepare part.stl -o part.glb --hard-angle 30 --explain\n"
        "  meshprep prepare *.obj more/*.fbx -o out/        many files; a bad one stops no other\n"
        "  meshprep prepare assets -r -o out --format gltf  a tree of files\n"
        "  meshprep prepare part.stl -o part.glb --scale 0.001 --up z   millimetres, z up\n"
        "  meshprep prepare assets -r -o out --jobs 0 --manifest out/made.json --skip-unchanged\n"
        "  curl -s $URL | meshprep prepare - -o - --format glb > chair.glb\n"
        "  meshprep prepare rock.glb --in-place --tangents mikktspace");
}

void check(const PrepareCommand& c) {
    if (c.files.output.empty() && !c.files.in_place)
        usage_error("--output", "is missing; give -o FILE or -o DIR (or --in-place)");
    if (!c.files.output.empty() && c.files.in_place)
        usage_error("--in-place", "writes over the inputs; it takes no --output");
    if (is_standard_stream(c.files.output) && (c.common.json || c.common.json_lines))
        usage_error("--output", "- takes standard output, and so does JSON; leave one of them out");
    if (c.common.json && c.common.json_lines)
        usage_error("--json",
                    "is one document, --json-lines a line for each file; give one of them");
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
