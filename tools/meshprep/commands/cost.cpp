#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <thread>

#include "cost/pages/page.h"
#include "cost/pages/plot.h"
#include "cost/pages/plot_image.h"
#include "meshprep/commands/cost_picture.h"
#include "meshprep/commands/subcommand.h"
#include "meshprep/files/file_list.h"
#include "meshprep/files/input_file.h"
#include "meshprep/files/output_directories.h"
#include "meshprep/output/cost_json.h"
#include "meshprep/output/load_options.h"
#include "prep/files.h"
#include "prep/image.h"
#include "prep/version.h"
#include "text/suggestions.h"

namespace meshprep {
namespace {

using prep::Error;
using prep::ErrorCode;
using prep::Result;

struct CostCommand {
    CommonOptions common;
    std::vector<std::filesystem::path> inputs;
    std::vector<std::string> ladders;  // none: all
    std::filesystem::path page, csv, svg, png, from;
    bool list = false;
    int rounds = 0;  // 0: not given
    std::optional<float> seconds;
};

struct Failure {
    std::string ladder, subject;
    Error error;
};

// What could be measured, and what could not.
struct Measured {
    cost::CostTable table;
    std::vector<Failure> failures;
};

std::vector<std::string> ladder_names() {
    std::vector<std::string> names;
    for (const cost::LadderRow& row : cost::ladder_rows()) names.emplace_back(row.name);
    return names;
}

constexpr const char* scene_ladder = "scene-sampling";

int threads_of(const CostCommand& command) {
    return command.common.threads > 0 ? command.common.threads
                                      : std::max(1, int(std::thread::hardware_concurrency()));
}

bool wanted(const CostCommand& command, const char* name) {
    return command.ladders.empty() ||
           std::find(command.ladders.begin(), command.ladders.end(), name) != command.ladders.end();
}

// What ladders are tried on of a file: its mesh of most faces, and the picture of all of it.
struct Tried {
    std::string name, file;
    prep::Mesh mesh;
    Result<cost::ScenePicture> picture = cost::ScenePicture();
    std::vector<std::filesystem::path> sources;  // what it was read from beside it: identities
};

Result<Tried> load(const std::filesystem::path& path, const CostCommand& command,
                   Console& console) {
    const CommonOptions& common = command.common;
    if (!is_standard_stream(path))
        if (const Result<void> there = require_file(path); !there) return there.error();
    const Result<InputFile> input = InputFile::open(path, common.input_format);
    if (!input) return input.error();
    Result<prep::JsonScene> loaded = load_json_scene(input->path(), load_options(common, console));
    if (!loaded) return input->relabelled(loaded.error());
    prep::Scene* const scene = &loaded->scene;
    const auto most = std::max_element(
        scene->meshes.begin(), scene->meshes.end(),
        [](const prep::Mesh& a, const prep::Mesh& b) { return a.face_count() < b.face_count(); });
    if (most == scene->meshes.end() || most->face_count() == 0)
        return Error{ErrorCode::invalid, "has no faces to try anything on", path.string()};
    Tried tried;
    tried.name = tried.file = path.filename().string();
    tried.mesh = *most;
    tried.sources = read_beside(*scene);
    if (scene->meshes.size() > 1 && !tried.mesh.name.empty())
        tried.name += ", mesh " + tried.mesh.name;
    if (wanted(command, scene_ladder))
        tried.picture = scene_picture(*std::move(loaded), lower_ending(input->path()) == "json",
                                      threads_of(command));
    return tried;
}

Result<cost::LadderRecord> measured(const cost::LadderRow& row, const cost::Subject& subject,
                                    const CostCommand& command) {
    const Result<cost::Ladder> ladder = row.make(subject);
    if (!ladder) return ladder.error();
    cost::TimingOptions options;
    options.rounds = command.rounds;
    options.seconds = double(command.seconds.value_or(12.0f));
    options.one_processor = subject.threads == 1;
    if (subject.threads == 1) options.least_share = 0.95;
    cost::SystemClock clock;
    return cost::climb(*ladder, subject.threads, options, clock);
}

// Before anything is measured. Errors: files that cannot be read.
Result<std::vector<Tried>> load_all(const CostCommand& command, Console& console) {
    std::vector<Tried> tried;
    for (std::size_t i = 0; i < command.inputs.size(); ++i) {
        if (const Result<void> fresh = require_unread(command.inputs, i); !fresh)
            return fresh.error();
        Result<Tried> one = load(command.inputs[i], command, console);
        if (!one) return one.error();
        tried.push_back(*std::move(one));
    }
    return tried;
}

// What a ladder cannot be tried on is a failure of that ladder; the others go on.
Result<Measured> measured_table(const CostCommand& command, const std::vector<Tried>& tried,
                                Console& console) {
    Measured out;
    out.table.version = std::string(prep::version());
    out.table.processor = cost::processor_name();
    out.table.threads = threads_of(command);
    for (const cost::LadderRow& row : cost::ladder_rows()) {
        if (!wanted(command, row.name)) continue;
        std::vector<cost::Subject> subjects;
        const bool of_scenes = row.name == std::string_view(scene_ladder);
        for (const Tried& one : tried) {
            if (!row.of_meshes) break;
            if (of_scenes && !one.picture)
                out.failures.push_back({row.name, one.file, one.picture.error()});
            else
                subjects.push_back({of_scenes ? one.file : one.name, &one.mesh, out.table.threads,
                                    of_scenes ? &*one.picture : nullptr});
        }
        if (row.of_meshes && !tried.empty() && subjects.empty()) continue;
        if (subjects.empty()) subjects.push_back({"", nullptr, out.table.threads});
        for (const cost::Subject& subject : subjects) {
            console.progress(command.common, fmt::format("{} …", row.name));
            Result<cost::LadderRecord> record = measured(row, subject, command);
            if (record)
                out.table.ladders.push_back(*std::move(record));
            else
                out.failures.push_back({row.name, subject.name, record.error()});
        }
    }
    console.progress(command.common, "");
    cost::derive(out.table);
    return out;
}

Result<cost::CostTable> read_table(const std::filesystem::path& path) {
    if (const Result<void> there = require_file(path); !there) return there.error();
    const auto bytes = prep::read_file(path);
    if (!bytes) return bytes.error();
    Result<cost::CostTable> table = cost_table_from(
        std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size()));
    if (!table)
        return Error{table.error().code, table.error().text, path.string() + table.error().place};
    return table;
}

// The plots that --svg and --png write, by the order of the table.
std::vector<std::filesystem::path> plot_files(const std::filesystem::path& directory,
                                              const std::vector<std::string>& ladders,
                                              const char* ending) {
    std::vector<std::filesystem::path> files;
    std::map<std::string, int> times;  // several meshes: the ladder once for each
    for (const std::string& ladder : ladders) {
        const int before = times[ladder]++;
        files.push_back(directory /
                        (ladder + (before > 0 ? fmt::format("-{}", before + 1) : "") + ending));
    }
    return files;
}

// Beside the plots.
std::vector<std::filesystem::path> named_outputs(const CostCommand& command) {
    std::vector<std::filesystem::path> files;
    for (const std::filesystem::path& file : {command.csv, command.page})
        if (!file.empty()) files.push_back(file);
    return files;
}

// `ladders`: whose plots will be written, as far as that is known.
std::vector<std::filesystem::path> all_outputs(const CostCommand& command,
                                               const std::vector<std::string>& ladders) {
    std::vector<std::filesystem::path> files = named_outputs(command);
    for (const auto& [directory, ending] :
         {std::pair(&command.svg, ".svg"), std::pair(&command.png, ".png")})
        if (!directory->empty())
            for (std::filesystem::path& plot : plot_files(*directory, ladders, ending))
                files.push_back(std::move(plot));
    return files;
}

// Before anything is measured: minutes are not to be lost to a file that cannot be written.
Result<void> prepare_outputs(const CostCommand& command, const std::vector<std::string>& ladders,
                             OutputDirectories& directories) {
    std::vector<std::filesystem::path> inputs = command.inputs;
    if (!command.from.empty()) inputs.push_back(command.from);
    if (const Result<void> apart = keep_apart(inputs, all_outputs(command, ladders)); !apart)
        return apart.error();
    for (const std::filesystem::path& directory : {command.svg, command.png})
        if (!directory.empty())
            if (const Result<void> made = directories.make(directory); !made) return made.error();
    for (const std::filesystem::path& file : named_outputs(command)) {
        if (const Result<void> made = directories.make_for(file); !made) return made.error();
        std::error_code ec;
        if (std::filesystem::is_directory(file, ec))
            return Error{ErrorCode::io, "a directory of this name is in the way", file.string()};
    }
    return {};
}

// By the command: of several meshes, a ladder of meshes has a plot for each.
std::vector<std::string> ladders_to_come(const CostCommand& command) {
    std::vector<std::string> names;
    for (const cost::LadderRow& row : cost::ladder_rows())
        if (wanted(command, row.name))
            names.insert(names.end(),
                         row.of_meshes ? std::max<std::size_t>(command.inputs.size(), 1) : 1,
                         row.name);
    return names;
}

std::vector<std::string> ladders_of(const cost::CostTable& table) {
    std::vector<std::string> names;
    for (const cost::LadderRecord& ladder : table.ladders) names.push_back(ladder.name);
    return names;
}

Result<void> write_text(const std::filesystem::path& path, const std::string& text) {
    return prep::write_file(path, std::as_bytes(std::span<const char>(text.data(), text.size())));
}

Result<void> write_outputs(const CostCommand& command, const cost::CostTable& table) {
    if (!command.svg.empty()) {
        const auto files = plot_files(command.svg, ladders_of(table), ".svg");
        for (std::size_t i = 0; i < files.size(); ++i)
            if (const Result<void> written =
                    write_text(files[i], cost::plot_svg(table.ladders[i], true));
                !written)
                return written.error();
    }
    if (!command.png.empty()) {
        const auto files = plot_files(command.png, ladders_of(table), ".png");
        for (std::size_t i = 0; i < files.size(); ++i)
            if (const Result<void> written =
                    prep::save_image(files[i], cost::plot_image(table.ladders[i]));
                !written)
                return written.error();
    }
    if (!command.csv.empty())
        if (const Result<void> written = write_text(command.csv, cost::cost_csv(table)); !written)
            return written.error();
    if (!command.page.empty())
        if (const Result<void> written = write_text(command.page, cost::cost_page(table)); !written)
            return written.error();
    return {};
}

void print_tables(const CostCommand& command, const cost::CostTable& table, Console& console) {
    for (const cost::LadderRecord& ladder : table.ladders) {
        console.result(command.common, fmt::format("{}: {}", ladder.title, ladder.subject));
        const auto rows = cost::cost_rows(ladder);
        std::vector<bool> right(rows[0].size(), true);
        std::fill_n(right.begin(), 1 + cost::name_headings(ladder).size(), false);
        console.table(command.common, rows, right);
        for (const std::string& sentence : cost::rises(ladder))
            console.result(command.common, "  " + sentence);
        for (const std::string& note : ladder.notes) console.result(command.common, "  " + note);
        console.result(command.common, "");
    }
}

int list_ladders(const CostCommand& command, Console& console) {
    Json document = json_head("cost");
    document["known"] = Json::array();
    std::vector<std::vector<std::string>> rows;
    for (const cost::LadderRow& row : cost::ladder_rows()) {
        rows.push_back({row.name, row.summary, row.of_meshes ? "FILE" : "a shape of its own",
                        row.grid ? "grid" : ""});
        document["known"].push_back({{"name", row.name},
                                     {"summary", row.summary},
                                     {"of_files", row.of_meshes},
                                     {"grid", row.grid}});
    }
    console.table(command.common, rows, {false, false, false, false});
    if (command.common.json) console.json(json_text(document));
    return exit_done;
}

int fail(const CostCommand& command, const Error& error, Json document, Console& console) {
    console.error(error);
    document["error"] = to_json(error);
    if (command.common.json) console.json(json_text(document));
    return exit_failed;
}

int run(const CostCommand& command, Console& console) {
    if (command.list) return list_ladders(command, console);
    OutputDirectories directories;
    const auto made = [&]() -> Result<Measured> {
        Measured out;
        if (!command.from.empty()) {
            Result<cost::CostTable> table = read_table(command.from);
            if (!table) return table.error();
            out.table = *std::move(table);
        }
        const std::vector<std::string> ladders =
            command.from.empty() ? ladders_to_come(command) : ladders_of(out.table);
        if (const Result<void> good = prepare_outputs(command, ladders, directories); !good)
            return good.error();
        if (!command.from.empty()) return out;
        const Result<std::vector<Tried>> tried = load_all(command, console);
        if (!tried) return tried.error();
        std::vector<std::filesystem::path> sources;
        for (const Tried& one : *tried)
            sources.insert(sources.end(), one.sources.begin(), one.sources.end());
        if (const Result<void> apart = keep_apart(sources, all_outputs(command, ladders)); !apart)
            return apart.error();
        return measured_table(command, *tried, console);
    };
    const Result<Measured> result = made();
    console.progress(command.common, "");
    if (!result) return fail(command, result.error(), json_head("cost"), console);
    const cost::CostTable& table = result->table;
    if (table.ladders.empty() && !result->failures.empty())
        return fail(command, result->failures[0].error, json_head("cost"), console);
    // What was measured is shown, even if not all of it was, or it cannot be written.
    print_tables(command, table, console);
    Json document = to_json(table);
    for (const Failure& failure : result->failures) {
        console.error(failure.error);
        document["failed"].push_back({{"ladder", failure.ladder},
                                      {"subject", failure.subject},
                                      {"error", to_json(failure.error)}});
    }
    if (const Result<void> written = write_outputs(command, table); !written)
        return fail(command, written.error(), std::move(document), console);
    if (!command.page.empty()) console.result(command.common, "page: " + command.page.string());
    if (command.common.json) console.json(json_text(document));
    return result->failures.empty() ? exit_done : exit_failed;
}

void define(OptionSet& options, CostCommand& c) {
    options.paths(
        "input", c.inputs, "FILE",
        "Meshes and scenes that normals, silhouettes and pictures are tried on; none: shapes of "
        "its own");
    options.values(
        "--ladder", "NAME,…",
        [&c](const std::string& text) {
            const std::vector<std::string> names = ladder_names();
            for (std::size_t at = 0; at <= text.size();) {
                const std::size_t comma = std::min(text.find(',', at), text.size());
                const std::string name = text.substr(at, comma - at);
                if (std::find(names.begin(), names.end(), name) == names.end())
                    usage_error("--ladder",
                                "'" + name + "' is none" + prep::detail::suggestion(name, names));
                c.ladders.push_back(name);
                at = comma + 1;
            }
        },
        "Only these ladders and grids; --list names them (default all)");
    options.flag("--list", c.list, "Say which ladders and grids there are, and measure nothing");
    options.path("-o,--output", c.page, "PAGE.html", "Write one page with plots and tables");
    options.path("--csv", c.csv, "FILE", "Write the numbers as comma-separated values");
    options.path("--svg", c.svg, "DIR", "Write each ladder's plot as a file of its own");
    options.path("--png", c.png, "DIR", "The same plots as PNG files");
    options.path("--from", c.from, "TIMES.json",
                 "Measure nothing: make everything again from what --json wrote");
    options.number("--rounds", c.rounds, 1, 1000, "N",
                   "As many rounds (default: 8 or more, until ratios are known to 5 %)");
    options.number("--seconds", c.seconds, 0.0, 86400.0, "S",
                   "Stop a ladder's rounds after so long, but not before eight (default 12)");
    add_input_options(options, c.common);
    add_loading_options(options, c.common.load);
    add_common_options(options, c.common);
    options.examples(
        "  meshprep cost -o cost.html\n"
        "  meshprep cost scan.ply --ladder normal-precision,anti-aliasing --threads 1\n"
        "  meshprep cost --json > times.json && meshprep cost --from times.json -o cost.html");
}

void check(const CostCommand& c) {
    if (!c.from.empty() && (!c.inputs.empty() || !c.ladders.empty() || c.list))
        usage_error("--from", "measures nothing; it takes no files, no --ladder and no --list");
    if (!c.from.empty() && (c.rounds > 0 || c.seconds || c.common.threads > 0))
        usage_error("--from", "measures nothing; it takes no --rounds, --seconds or --threads");
    if (c.list && (!c.inputs.empty() || c.rounds > 0 || c.seconds || c.common.threads > 0))
        usage_error("--list",
                    "measures nothing; it takes no files, --rounds, --seconds or --threads");
    if (c.list && !all_outputs(c, {""}).empty())
        usage_error("--list", "measures nothing; it takes no -o, --csv, --svg or --png");
    if (c.list || c.inputs.empty()) return;
    for (const cost::LadderRow& row : cost::ladder_rows())
        if (row.of_meshes && wanted(c, row.name)) return;
    usage_error(c.inputs[0].string(),
                "none of these ladders is tried on files; --list says which are");
}

}  // namespace

Subcommand cost_subcommand() {
    return subcommand<CostCommand>(
        "cost", "What accuracy costs in time: the error of settings against measured times", define,
        run, check);
}

}  // namespace meshprep
