#include <fmt/format.h>

#include <chrono>
#include <optional>

#include "meshprep/commands/subcommand.h"
#include "meshprep/files/file_list.h"
#include "meshprep/output/counts.h"
#include "meshprep/output/findings_text.h"
#include "meshprep/output/report_json.h"
#include "prep/load.h"
#include "prep/save.h"

namespace meshprep {
namespace {

struct PrepareCommand {
    CommonOptions common;
    JobRequest files;
    bool explain = false;
    prep::PrepareOptions prepare;
};

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// What became of one file.
struct Outcome {
    Job job;
    std::optional<prep::Error> error;
    Counts before, after, gltf_before, gltf_after;
    prep::SplitCounts splits;
    std::vector<prep::StageReport> stages;
    std::vector<prep::Finding> findings;
    std::vector<prep::RepairStep> repairs;
    std::vector<std::string> mesh_names;
    std::vector<std::string> warnings, notes;
    double read_ms = 0, prepare_ms = 0, write_ms = 0;

    std::size_t warning_count() const {
        std::size_t count = warnings.size() + notes.size();
        for (const prep::Finding& f : findings) count += f.severity != prep::Severity::info;
        return count;
    }
};

Outcome prepare_file(const Job& job, const PrepareCommand& command, Console& console,
                     const std::string& prefix) {
    Outcome out;
    out.job = job;
    const auto show = [&](const char* what) {
        console.progress(command.common, prefix + job.input.string() + " … " + what);
    };

    show("reading");
    Clock::time_point start = Clock::now();
    out.gltf_before = count_gltf_file(job.input);
    prep::Result<prep::Scene> scene = prep::load_scene(job.input, {command.common.threads});
    out.read_ms = since(start);
    if (!scene) {
        out.error = scene.error();
        return out;
    }
    out.before = count_scene(*scene);
    out.warnings = scene->warnings;

    show("preparing");
    start = Clock::now();
    prep::PrepareOptions options = command.prepare;
    options.threads = command.common.threads;
    prep::Result<prep::PreparedScene> prepared = prep::prepare(*std::move(scene), options);
    out.prepare_ms = since(start);
    if (!prepared) {
        out.error = prepared.error();
        return out;
    }
    out.after = count_prepared(*prepared);
    out.splits = prepared->splits;
    out.stages = prepared->stages;
    out.findings = prepared->findings;
    out.repairs = prepared->repairs;
    for (const prep::Mesh& mesh : prepared->scene.meshes) out.mesh_names.push_back(mesh.name);

    show("writing");
    start = Clock::now();
    prep::SaveOptions save;
    save.ascii = command.files.ascii;
    save.replace = command.files.overwrite;
    save.replace_sources = command.files.in_place;
    prep::Result<std::vector<std::string>> notes = prep::save_scene(*prepared, job.output, save);
    out.write_ms = since(start);
    if (!notes) {
        out.error = notes.error();
        return out;
    }
    out.notes = *std::move(notes);
    out.gltf_after = count_gltf_file(job.output);
    return out;
}

Json outcome_json(const Outcome& o) {
    Json json;
    json["input"] = o.job.input.string();
    json["output"] = o.job.output.string();
    json["status"] = o.error ? "failed" : "ok";
    if (o.error) json["error"] = to_json(*o.error);
    json["before"] = to_json(o.before);
    json["after"] = to_json(o.after);
    if (!o.gltf_before.figures.empty()) json["gltf_before"] = to_json(o.gltf_before);
    if (!o.gltf_after.figures.empty()) json["gltf_after"] = to_json(o.gltf_after);
    json["splits"] = to_json(o.splits);
    json["stages"] = Json::array();
    for (const prep::StageReport& stage : o.stages) json["stages"].push_back(to_json(stage));
    if (!o.repairs.empty()) {
        json["repairs"] = Json::array();
        for (const prep::RepairStep& r : o.repairs) json["repairs"].push_back(to_json(r));
    }
    json["findings"] = Json::array();
    for (const prep::Finding& f : o.findings) {
        Json finding = to_json(f, {});
        if (f.mesh < o.mesh_names.size()) finding["mesh_name"] = o.mesh_names[f.mesh];
        json["findings"].push_back(std::move(finding));
    }
    json["warnings"] = o.warnings;
    json["notes"] = o.notes;
    json["milliseconds"] = {{"read", o.read_ms}, {"prepare", o.prepare_ms}, {"write", o.write_ms}};
    return json;
}

void add_count_rows(std::vector<std::vector<std::string>>& rows, const Counts& before,
                    const Counts& after, const std::vector<std::string>& skip) {
    const auto wanted = [&skip](const std::string& name) {
        for (const std::string& s : skip)
            if (s == name) return false;
        return true;
    };
    const auto cell = [](const std::uint64_t* value) {
        return value ? with_commas(*value) : std::string("–");
    };
    for (const auto& [name, value] : before.figures) {
        const std::uint64_t* to = after.find(name);
        if (!wanted(name) || (value == 0 && (!to || *to == 0))) continue;
        rows.push_back({name, with_commas(value), cell(to)});
    }
    for (const auto& [name, value] : after.figures)
        if (wanted(name) && value > 0 && !before.find(name))
            rows.push_back({name, before.figures.empty() ? "" : "–", with_commas(value)});
}

std::string split_text(const Outcome& o) {
    std::string text;
    for (const auto& [name, count] : split_list(o.splits))
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, with_commas(count));
    return text;
}

// Everything about the only file.
void print_details(const Outcome& o, const PrepareCommand& command, Console& console) {
    const CommonOptions& common = command.common;
    console.result(common, fmt::format("{} → {}", o.job.input.string(), o.job.output.string()));
    std::vector<std::vector<std::string>> rows = {{"", "before", "after"}};
    add_count_rows(rows, o.before, o.after, {});
    const bool both_gltf = !o.gltf_before.figures.empty() && !o.gltf_after.figures.empty();
    if (both_gltf)
        add_count_rows(rows, o.gltf_before, o.gltf_after, {"meshes", "materials", "textures"});
    for (const std::string& line : align_table(rows, {false, true, true}))
        console.result(common, line);
    if (both_gltf && !(o.gltf_before.extensions.empty() && o.gltf_after.extensions.empty()))
        console.result(
            common, fmt::format("  extensions  {} → {}", fmt::join(o.gltf_before.extensions, " "),
                                fmt::join(o.gltf_after.extensions, " ")));
    if (const std::string splits = split_text(o); !splits.empty())
        console.result(common, "  vertices split at: " + splits);
    if (command.explain) {
        console.result(common, "  stages");
        std::vector<std::vector<std::string>> stages;
        for (const prep::StageReport& s : o.stages)
            stages.push_back({"  " + s.stage, s.run ? "run" : "skipped",
                              s.run ? duration(s.milliseconds) : "",
                              s.exact > 0 ? fmt::format("{}; {} decided by exact arithmetic",
                                                        s.reason, with_commas(s.exact))
                                          : s.reason});
        for (const std::string& line : align_table(stages, {false, false, true}))
            console.result(common, line);
    }
    for (const std::string& line : repairs_text(o.repairs, o.mesh_names, 4))
        console.result(common, line);
    for (const std::string& line : findings_text(o.findings, o.mesh_names, 4))
        console.result(common, line);
    console.result(common, fmt::format("  read {}, prepare {}, write {}", duration(o.read_ms),
                                       duration(o.prepare_ms), duration(o.write_ms)));
}

// One line of many.
void print_row(const Outcome& o, const PrepareCommand& command, Console& console) {
    const auto figure = [](const Counts& counts, const char* name) {
        const std::uint64_t* value = counts.find(name);
        return value ? *value : 0;
    };
    const std::size_t warnings = o.warning_count();
    console.result(command.common,
                   fmt::format("ok      {} → {}  {} → {} vertices, {}, {}{}", o.job.input.string(),
                               o.job.output.string(), with_commas(figure(o.before, "vertices")),
                               with_commas(figure(o.after, "vertices")),
                               count_of(figure(o.after, "triangles"), "triangle"),
                               duration(o.read_ms + o.prepare_ms + o.write_ms),
                               warnings > 0 ? ", " + count_of(warnings, "warning") : ""));
    if (!command.explain) return;
    std::vector<std::vector<std::string>> stages;
    for (const prep::StageReport& s : o.stages)
        stages.push_back({"      " + s.stage, s.run ? "run" : "skipped",
                          s.run ? duration(s.milliseconds) : "", s.reason});
    for (const std::string& line : align_table(stages, {false, false, true}))
        console.result(command.common, line);
}

int run(const PrepareCommand& command, Console& console) {
    const CommonOptions& common = command.common;
    Json document = json_head("prepare");
    const prep::Result<JobList> list = plan_jobs(command.files);
    if (!list) {
        console.error(list.error());
        document["error"] = to_json(list.error());
        if (common.json) console.json(json_text(document));
        return list.error().code == prep::ErrorCode::io ? exit_failed : exit_usage;
    }
    for (const std::filesystem::path& directory : list->directories) {
        if (const prep::Result<void> made = make_directory(directory); !made) {
            console.error(made.error());
            document["error"] = to_json(made.error());
            if (common.json) console.json(json_text(document));
            return exit_failed;
        }
    }

    const Clock::time_point start = Clock::now();
    const std::size_t total = list->jobs.size();
    std::size_t failed = 0, warned = 0;
    Json files = Json::array();
    for (std::size_t i = 0; i < total; ++i) {
        const std::string prefix = total > 1 ? fmt::format("[{}/{}] ", i + 1, total) : "";
        const Outcome outcome = prepare_file(list->jobs[i], command, console, prefix);
        for (const std::string& text : outcome.warnings)
            console.warning(common, outcome.job.input.string() + ": " + text);
        for (const std::string& text : outcome.notes)
            console.warning(common, outcome.job.output.string() + ": " + text);
        if (outcome.error) {
            ++failed;
            console.error(*outcome.error);
            if (total > 1) console.result(common, "failed  " + outcome.job.input.string());
        } else if (total > 1) {
            print_row(outcome, command, console);
        } else {
            print_details(outcome, command, console);
        }
        warned += outcome.warning_count() > 0;
        if (common.json) files.push_back(outcome_json(outcome));
    }
    console.progress(common, "");
    const double milliseconds = since(start);
    if (total > 1)
        console.result(common, fmt::format("{}: {} ok, {} failed, {} with warnings, {}",
                                           count_of(total, "file"), total - failed, failed, warned,
                                           duration(milliseconds)));
    if (common.json) {
        document["files"] = std::move(files);
        document["summary"] = {{"files", total},
                               {"ok", total - failed},
                               {"failed", failed},
                               {"with_warnings", warned},
                               {"milliseconds", milliseconds}};
        console.json(json_text(document));
    }
    return failed > 0 ? exit_failed : exit_done;
}

void define(OptionSet& options, PrepareCommand& c) {
    options
        .paths("input", c.files.inputs, "FILE|DIR", "Mesh or scene files, or directories of them")
        .required();
    options.path("-o,--output", c.files.output, "FILE|DIR",
                 "A file (its ending says the format) or a directory");
    options.word(
        "--format", output_endings(), [&c](const std::string& word) { c.files.format = word; },
        "Format of files written to a directory (default glb)");
    options.flag("--ascii", c.files.ascii, "PLY and STL as text");
    options.flag("--in-place", c.files.in_place, "Write each result over its input");
    options.flag(
        "-r,--recursive", c.files.recursive,
        "Also what lies in directories below, kept apart in directories of the same names");
    options.flag("--no-overwrite", c.files.overwrite,
                 "An output file that exists is an error instead of being replaced", false);
    options.flag("--explain", c.explain,
                 "Each stage: run or skipped, its reason, its milliseconds");
    add_preparation_options(options, c.prepare);
    add_common_options(options, c.common);
    options.examples(
        "  meshprep prepare spot.obj -o spot.glb\n"
        "  meshprep prepare part.stl -o part.glb --hard-angle 30 --explain\n"
        "  meshprep prepare *.obj more/*.fbx -o out/        many files; a bad one stops no other\n"
        "  meshprep prepare assets -r -o out --format gltf  a tree of files\n"
        "  meshprep prepare rock.glb --in-place --tangents mikktspace");
}

void check(const PrepareCommand& c) {
    if (c.files.output.empty() && !c.files.in_place)
        usage_error("--output", "is missing; give -o FILE or -o DIR (or --in-place)");
    if (!c.files.output.empty() && c.files.in_place)
        usage_error("--in-place", "writes over the inputs; it takes no --output");
}

}  // namespace

Subcommand prepare_subcommand() {
    return subcommand<PrepareCommand>(
        "prepare", "Load, check, prepare what the materials call for, write", define, run, check);
}

}  // namespace meshprep
