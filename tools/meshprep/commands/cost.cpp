#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <thread>

#include "cost/pages/page.h"
#include "cost/pages/plot.h"
#include "meshprep/commands/subcommand.h"
#include "meshprep/files/file_list.h"
#include "meshprep/files/input_file.h"
#include "meshprep/files/output_directories.h"
#include "meshprep/output/cost_json.h"
#include "meshprep/output/load_options.h"
#include "prep/files.h"
#include "prep/load.h"
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
    std::filesystem::path page, csv, svg, from;
    bool list = false;
    int rounds = 0;
    float seconds = 12;
};

std::vector<std::string> ladder_names() {
    std::vector<std::string> names;
    for (const cost::LadderRow& row : cost::ladder_rows()) names.emplace_back(row.name);
    return names;
}

bool wanted(const CostCommand& command, const char* name) {
    return command.ladders.empty() ||
           std::find(command.ladders.begin(), command.ladders.end(), name) != command.ladders.end();
}

// The mesh of a file that ladders are tried on: the one of most faces.
struct Tried {
    std::string name;
    prep::Mesh mesh;
};

Result<Tried> load(const std::filesystem::path& path, const CommonOptions& common,
                   Console& console) {
    if (!is_standard_stream(path))
        if (const Result<void> there = require_file(path); !there) return there.error();
    const Result<InputFile> input = InputFile::open(path, common.input_format);
    if (!input) return input.error();
    Result<prep::Scene> scene = prep::load_scene(input->path(), load_options(common, console));
    if (!scene) return input->relabelled(scene.error());
    const auto most = std::max_element(
        scene->meshes.begin(), scene->meshes.end(),
        [](const prep::Mesh& a, const prep::Mesh& b) { return a.face_count() < b.face_count(); });
    if (most == scene->meshes.end() || most->face_count() == 0)
        return Error{ErrorCode::invalid, "has no faces to try anything on", path.string()};
    Tried tried{path.filename().string(), std::move(*most)};
    if (scene->meshes.size() > 1 && !tried.mesh.name.empty())
        tried.name += ", mesh " + tried.mesh.name;
    return tried;
}

class Run {
  public:
    Run(const CostCommand& command, Console& console) : command_(command), console_(console) {}

    Result<cost::CostTable> table() {
        table_.version = std::string(prep::version());
        table_.processor = cost::processor_name();
        table_.threads = command_.common.threads > 0
                             ? command_.common.threads
                             : std::max(1, int(std::thread::hardware_concurrency()));
        std::vector<Tried> tried;
        for (const std::filesystem::path& path : command_.inputs) {
            Result<Tried> one = load(path, command_.common, console_);
            if (!one) return one.error();
            tried.push_back(*std::move(one));
        }
        for (const cost::LadderRow& row : cost::ladder_rows()) {
            if (!wanted(command_, row.name)) continue;
            if (!row.of_meshes || tried.empty()) {
                if (const Result<void> done = climb(row, {"", nullptr, table_.threads}); !done)
                    return done.error();
                continue;
            }
            for (const Tried& one : tried)
                if (const Result<void> done = climb(row, {one.name, &one.mesh, table_.threads});
                    !done)
                    return done.error();
        }
        console_.progress(command_.common, "");
        cost::derive(table_);
        return std::move(table_);
    }

  private:
    Result<void> climb(const cost::LadderRow& row, const cost::Subject& subject) {
        console_.progress(command_.common, fmt::format("{} …", row.name));
        const Result<cost::Ladder> ladder = row.make(subject);
        if (!ladder) return ladder.error();
        cost::TimingOptions options;
        options.rounds = command_.rounds;
        options.seconds = double(command_.seconds);
        if (table_.threads == 1) options.least_share = 0.95;
        cost::SystemClock clock;
        Result<cost::LadderRecord> record = cost::climb(*ladder, options, clock);
        if (!record) return record.error();
        table_.ladders.push_back(*std::move(record));
        return {};
    }

    const CostCommand& command_;
    Console& console_;
    cost::CostTable table_;
};

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

// Before anything is measured: minutes are not to be lost to a place that cannot be written.
Result<void> make_places(const CostCommand& command, OutputDirectories& directories) {
    if (!command.svg.empty())
        if (const Result<void> made = directories.make(command.svg); !made) return made.error();
    for (const std::filesystem::path& file : {command.csv, command.page}) {
        if (file.empty()) continue;
        if (const Result<void> made = directories.make_for(file); !made) return made.error();
        std::error_code ec;
        if (std::filesystem::is_directory(file, ec))
            return Error{ErrorCode::io, "a directory of this name is in the way", file.string()};
    }
    return {};
}

Result<void> write_text(const std::filesystem::path& path, const std::string& text) {
    return prep::write_file(path, std::as_bytes(std::span<const char>(text.data(), text.size())));
}

Result<void> write_outputs(const CostCommand& command, const cost::CostTable& table) {
    if (!command.svg.empty()) {
        std::map<std::string, int> times;  // several meshes: the ladder once for each
        for (const cost::LadderRecord& ladder : table.ladders) {
            const int before = times[ladder.name]++;
            const std::string name =
                ladder.name + (before > 0 ? fmt::format("-{}", before + 1) : "") + ".svg";
            if (const Result<void> written =
                    write_text(command.svg / name, cost::plot_svg(ladder, true));
                !written)
                return written.error();
        }
    }
    if (!command.csv.empty())
        if (const Result<void> written = write_text(command.csv, cost::cost_csv(table)); !written)
            return written.error();
    if (!command.page.empty())
        if (const Result<void> written = write_text(command.page, cost::cost_page(table)); !written)
            return written.error();
    return {};
}

void say(const CostCommand& command, const cost::CostTable& table, Console& console) {
    for (const cost::LadderRecord& ladder : table.ladders) {
        console.result(command.common, fmt::format("{}: {}", ladder.title, ladder.subject));
        const auto rows = cost::cost_rows(ladder);
        std::vector<bool> right(rows[0].size(), true);
        right[0] = right[1] = false;
        console.table(command.common, rows, right);
        for (const std::string& note : ladder.notes) console.result(command.common, "  " + note);
        console.result(command.common, "");
    }
    if (!command.page.empty()) console.result(command.common, "page: " + command.page.string());
}

int list_ladders(const CostCommand& command, Console& console) {
    Json document = json_head("cost");
    document["known"] = Json::array();
    std::vector<std::vector<std::string>> rows;
    for (const cost::LadderRow& row : cost::ladder_rows()) {
        rows.push_back({row.name, row.summary, row.of_meshes ? "FILE" : "a shape of its own"});
        document["known"].push_back(
            {{"name", row.name}, {"summary", row.summary}, {"of_files", row.of_meshes}});
    }
    console.table(command.common, rows, {false, false, false});
    if (command.common.json) console.json(json_text(document));
    return exit_done;
}

int run(const CostCommand& command, Console& console) {
    if (command.list) return list_ladders(command, console);
    OutputDirectories directories;
    const auto made = [&]() -> Result<cost::CostTable> {
        if (const Result<void> places = make_places(command, directories); !places)
            return places.error();
        Result<cost::CostTable> table =
            command.from.empty() ? Run(command, console).table() : read_table(command.from);
        if (!table) return table;
        if (const Result<void> written = write_outputs(command, *table); !written)
            return written.error();
        return table;
    };
    const Result<cost::CostTable> table = made();
    console.progress(command.common, "");
    if (!table) {
        console.error(table.error());
        if (command.common.json) {
            Json document = json_head("cost");
            document["error"] = to_json(table.error());
            console.json(json_text(document));
        }
        return exit_failed;
    }
    say(command, *table, console);
    if (command.common.json) console.json(json_text(to_json(*table)));
    return exit_done;
}

void define(OptionSet& options, CostCommand& c) {
    options.paths("input", c.inputs, "FILE",
                  "Meshes that normals and silhouettes are tried on; none: shapes of its own");
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
        "Only these; --list names them (default all)");
    options.flag("--list", c.list, "Say which ladders there are, and measure nothing");
    options.path("-o,--output", c.page, "PAGE.html", "Write one page with plots and tables");
    options.path("--csv", c.csv, "FILE", "Write the numbers as comma-separated values");
    options.path("--svg", c.svg, "DIR", "Write each ladder's plot as a file of its own");
    options.path("--from", c.from, "TIMES.json",
                 "Measure nothing: make everything again from what --json wrote");
    options.number("--rounds", c.rounds, 1, 1000, "N",
                   "As many rounds (default: 7 or more, until ratios are known to 5 %)");
    options.number("--seconds", c.seconds, 0.0, 86400.0, "S",
                   "Stop a ladder's rounds after so long, but not before three (default 12)");
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
}

}  // namespace

Subcommand cost_subcommand() {
    return subcommand<CostCommand>(
        "cost", "What accuracy costs in time: the error of settings against measured times", define,
        run, check);
}

}  // namespace meshprep
