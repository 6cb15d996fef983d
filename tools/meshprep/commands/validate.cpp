#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "meshprep/commands/batch_sources.h"
#include "meshprep/commands/subcommand.h"
#include "meshprep/files/file_list.h"
#include "meshprep/files/input_file.h"
#include "meshprep/files/output_directories.h"
#include "meshprep/files/sheet_names.h"
#include "meshprep/options/values.h"
#include "meshprep/output/file_records.h"
#include "meshprep/output/findings_text.h"
#include "meshprep/output/load_options.h"
#include "meshprep/output/report_json.h"
#include "prep/check.h"
#include "prep/files.h"
#include "prep/image.h"
#include "prep/load.h"
#include "prep/requirements.h"
#include "prep/version.h"
#include "sheets/figures.h"
#include "sheets/page.h"
#include "sheets/panels.h"
#include "sheets/surfaces/tessellation_errors.h"

namespace meshprep {
namespace {

struct ValidateCommand {
    CommonOptions common;
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path output;
    std::vector<std::string> meshes;      // names or numbers; none: all
    double azimuth = 30, elevation = 20;  // degrees; each mesh is framed
    std::uint32_t panel = 480;            // pixels, each picture's width and height
    std::uint32_t max_meshes = 64;
    prep::PrepareOptions prepare;
};

using prep::Error;
using prep::ErrorCode;
using prep::Result;

// What one file's sheets are of.
struct Choice {
    bool whole = false;
    std::vector<std::uint32_t> meshes;
    std::size_t left_out = 0;
};

Result<Choice> choose(const prep::Scene& scene, const ValidateCommand& command) {
    Choice choice;
    if (!command.meshes.empty()) {
        for (const std::string& text : command.meshes) {
            bool found = false;
            for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
                if (scene.meshes[m].name != text && std::to_string(m) != text) continue;
                if (std::find(choice.meshes.begin(), choice.meshes.end(), m) == choice.meshes.end())
                    choice.meshes.push_back(m);
                found = true;
                break;
            }
            if (!found) {
                std::string names;
                for (std::uint32_t m = 0; m < scene.meshes.size() && m < 12; ++m)
                    names +=
                        (m == 0 ? "" : ", ") + std::to_string(m) +
                        (scene.meshes[m].name.empty() ? "" : " '" + scene.meshes[m].name + "'");
                return Error{ErrorCode::invalid, "no mesh '" + text + "'; the file has " + names,
                             scene.source.string()};
            }
        }
        return choice;
    }
    choice.whole = scene.meshes.size() != 1;
    if (choice.whole && scene.meshes.empty()) return choice;
    const std::size_t most = command.max_meshes;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
        if (choice.meshes.size() < most)
            choice.meshes.push_back(m);
        else
            ++choice.left_out;
    }
    return choice;
}

struct Outcome {
    std::filesystem::path input, page;
    std::vector<std::filesystem::path> sheets;
    std::optional<Error> error;
    std::vector<std::string> warnings;
    std::vector<prep::Finding> findings;
    std::vector<std::string> mesh_names;
    Json numbers = Json::array();
    double milliseconds = 0;
};

// A figure as the sheet shows it: "1,956" and "1.2e-07" are numbers, "yes" and "no" are true and
// false; what has a unit or several parts stays text.
Json figure_json(const std::string& text) {
    if (text == "yes" || text == "no") return text == "yes";
    std::string plain;
    for (const char c : text)
        if (c != ',') plain += c;
    const std::vector<double> number = parse_numbers(plain, ' ');
    if (number.size() != 1) return text;
    const bool whole = plain.find_first_not_of("0123456789") == std::string::npos;
    if (whole && plain.size() < 19) return std::stoull(plain);
    return number[0];
}

// What the inputs of one command line share.
struct Shared {
    OutputDirectories directories;
    SiblingLinks links;
    BatchSources sources;
    std::set<std::filesystem::path> written = {};  // or about to be, by identity
};

class Validator {
  public:
    Validator(const ValidateCommand& command, Shared& shared, Console& console)
        : command_(command), shared_(shared), console_(console) {}

    Outcome run(const Job& job, const std::string& stem) {
        const Clock::time_point start = Clock::now();
        out_ = {};
        out_.input = job.input;
        out_.page = job.output;
        const Result<InputFile> opened =
            InputFile::open(job.input, command_.common.input_format, &shared_.links);
        out_.error = opened ? validate(*opened, job, stem) : opened.error();
        if (opened && out_.error) out_.error = opened->relabelled(*std::move(out_.error));
        out_.milliseconds = milliseconds_since(start);
        return std::move(out_);
    }

  private:
    std::optional<Error> validate(const InputFile& input, const Job& job, const std::string& stem) {
        const int threads = command_.common.threads;
        progress("reading");
        Result<prep::Scene> scene =
            prep::load_scene(input.path(), load_options(command_.common, console_));
        if (!scene) return scene.error();
        if (const Result<void> some = prep::require_geometry(*scene); !some) return some.error();
        shared_.sources.add(job, input, *scene);
        input.settle(*scene);
        out_.warnings = scene->warnings;
        for (const prep::Mesh& mesh : scene->meshes) out_.mesh_names.push_back(mesh.name);
        progress("checking");
        prep::SceneCheck check = prep::check(*scene, {threads});
        // What the materials call for, before the sheet asks for tangents everywhere.
        std::vector<prep::MeshRequirements> called_for =
            prep::requirements(*scene, command_.prepare.request);
        progress("preparing");
        prep::PrepareOptions options =
            prepare_options(command_.prepare, load_options(command_.common, console_), threads);
        options.keep_cages = true;
        // The sheet shows tangents wherever there can be some, unless they are switched off.
        if (options.request.tangents == prep::Request::Level::as_called_for)
            options.request.tangents = prep::Request::Level::always;
        std::optional<prep::Scene> as_read;
        if (is_displaced(options)) as_read = *scene;
        Result<prep::PreparedScene> prepared = prep::prepare(*std::move(scene), options);
        if (!prepared) return prepared.error();
        for (std::size_t m = 0; m < called_for.size(); ++m)
            if (prepared->requirements[m].tangents.why.code == prep::ReasonCode::residual_map)
                called_for[m] = prepared->requirements[m];
        Result<Choice> choice = choose(prepared->scene, command_);
        if (!choice) return choice.error();
        if (choice->left_out > 0)
            out_.warnings.push_back(fmt::format("{} left out; --max-meshes N draws more",
                                                count_of(choice->left_out, "mesh", "meshes")));
        out_.findings = findings_of(check, *prepared, *choice);
        const std::vector<std::string> stems = sheet_stems(*choice, prepared->scene, stem);
        if (std::optional<Error> refused = claim(stems)) return refused;
        if (const Result<void> made = shared_.directories.make(command_.output); !made)
            return made.error();
        std::optional<report::DisplacementViews> beside;
        if (as_read) {
            progress("preparing bump and normal maps beside it");
            beside = report::make_displacement_views(*as_read, options, *prepared, command_.panel);
        }
        report::Page page;
        page.title = out_.input.filename().string();
        page.subtitle = subtitle(*prepared, check.meshes);
        const Checked checked{check.meshes, called_for};
        if (std::optional<Error> error =
                add_sheets(page, *prepared, *choice, checked, beside, options, stems))
            return error;
        add_tables(page, *prepared);
        return write(page);
    }

    // What the check and the preparation found of the meshes that are shown, each kind once.
    static std::vector<prep::Finding> findings_of(const prep::SceneCheck& check,
                                                  const prep::PreparedScene& prepared,
                                                  const Choice& choice) {
        std::vector<prep::Finding> findings = check.findings;
        for (const prep::Finding& f : prepared.findings) {
            bool known = false;
            for (const prep::Finding& other : check.findings)
                known |= other.kind == f.kind && other.mesh == f.mesh;
            if (!known) findings.push_back(f);
        }
        std::erase_if(findings, [&](const prep::Finding& f) {
            return !choice.whole && f.mesh != prep::no_index &&
                   std::find(choice.meshes.begin(), choice.meshes.end(), f.mesh) ==
                       choice.meshes.end();
        });
        return findings;
    }

    // Of each mesh, as it was read.
    struct Checked {
        const std::vector<prep::MeshSummary>& meshes;
        const std::vector<prep::MeshRequirements>& called_for;
    };

    std::optional<Error> add_sheets(report::Page& page, const prep::PreparedScene& prepared,
                                    const Choice& choice, const Checked& checked,
                                    const std::optional<report::DisplacementViews>& beside,
                                    const prep::PrepareOptions& options,
                                    const std::vector<std::string>& stems) {
        std::size_t sheet = 0;
        if (choice.whole) {
            report::Subject whole = report::whole_subject(prepared, "whole scene");
            whole.beside = beside;
            if (std::optional<Error> error =
                    add_sheet(page, std::move(whole), checked.meshes, checked.called_for,
                              out_.findings, options, stems[sheet++]))
                return error;
        }
        for (const std::uint32_t m : choice.meshes) {
            std::vector<prep::Finding> findings;
            for (const prep::Finding& f : out_.findings)
                if (f.mesh == m) findings.push_back(f);
            report::Subject subject = report::mesh_subject(prepared, m);
            if (beside && m < prepared.tessellated.size() && prepared.tessellated[m])
                subject.beside = report::views_of_mesh(*beside, m);
            if (std::optional<Error> error =
                    add_sheet(page, std::move(subject), {checked.meshes[m]},
                              {checked.called_for[m]}, findings, options, stems[sheet++]))
                return error;
        }
        return {};
    }

    std::optional<Error> write(const report::Page& page) {
        progress("writing the page");
        const Result<std::string> html = report::html_page(page);
        if (!html) return html.error();
        const Result<void> written = prep::write_file(
            out_.page, std::as_bytes(std::span<const char>(html->data(), html->size())));
        if (!written) return written.error();
        return {};
    }

    static bool is_displaced(const prep::PrepareOptions& options) {
        const prep::DisplaceOptions& d = options.displacement;
        return options.tessellate && (d.from_materials || d.map || d.noise);
    }

    // The whole scene's first, where it has one.
    static std::vector<std::string> sheet_stems(const Choice& choice, const prep::Scene& scene,
                                                const std::string& stem) {
        std::vector<std::string> stems;
        if (choice.whole) stems.push_back(stem);
        for (const std::uint32_t m : choice.meshes)
            stems.push_back(scene.meshes.size() == 1 ? stem
                                                     : sheet_stem(stem, m, scene.meshes[m].name));
        return stems;
    }

    // Pictures of a model often have its name: no sheet is drawn over one, nor over another sheet.
    std::optional<Error> claim(const std::vector<std::string>& stems) {
        std::vector<std::filesystem::path> files{out_.page};
        for (const std::string& stem : stems) files.push_back(command_.output / (stem + ".png"));
        for (const std::filesystem::path& file : files) {
            std::error_code ec;
            if (std::filesystem::exists(file, ec) && shared_.sources.of_any(file))
                return Error{ErrorCode::io,
                             "a model is read from this file, and a sheet would be written over "
                             "it; give a directory of its own",
                             file.string()};
            if (!shared_.written.insert(identity_of(file)).second)
                return Error{ErrorCode::invalid,
                             "another sheet has this name; validate the inputs into directories of "
                             "their own",
                             file.string()};
        }
        return {};
    }

    // What the file has, and what was made of it: the scene's meshes may have been changed since.
    static std::string subtitle(const prep::PreparedScene& prepared,
                                const std::vector<prep::MeshSummary>& summaries) {
        std::uint64_t faces = 0, triangles = 0, before = 0, after = 0;
        for (const prep::MeshSummary& mesh : summaries) {
            faces += mesh.faces;
            before += mesh.vertices;
        }
        for (const prep::VertexMesh& mesh : prepared.meshes) {
            triangles += mesh.triangle_count();
            after += mesh.vertex_count();
        }
        return fmt::format("{}, {}, {}; {} → {} vertices",
                           count_of(summaries.size(), "mesh", "meshes"), count_of(faces, "face"),
                           count_of(triangles, "triangle"), with_commas(before),
                           with_commas(after));
    }

    std::optional<Error> add_sheet(report::Page& page, report::Subject subject,
                                   const std::vector<prep::MeshSummary>& summaries,
                                   const std::vector<prep::MeshRequirements>& called_for,
                                   const std::vector<prep::Finding>& findings,
                                   const prep::PrepareOptions& prepare, const std::string& stem) {
        progress("drawing " + subject.name);
        report::Sheet sheet;
        const bool only = subject.scene.scene.meshes.size() == 1 && page.sheets.empty() &&
                          out_.mesh_names.size() == 1;
        sheet.title = out_.input.filename().string() + (only ? "" : " · " + subject.name);
        sheet.subtitle = (only ? subject.name + ": " : "") + subtitle(subject.scene, summaries);
        sheet.footer = fmt::format("meshprep {} · hard angle {} · weight {}", prep::version(),
                                   angle_text(), weight_text());
        std::string reason = "no";
        for (const prep::MeshRequirements& need : called_for)
            if (need.tangents.needed) reason = "yes";
        sheet.groups = report::make_figures(subject.scene, summaries, reason);
        report::FigureGroup tessellation =
            report::tessellation_group(subject.scene, command_.common.threads);
        if (!tessellation.figures.empty()) sheet.groups.push_back(std::move(tessellation));

        report::PanelOptions options;
        options.size = command_.panel;
        options.azimuth = command_.azimuth;
        options.elevation = command_.elevation;
        options.prepare = prepare;
        options.threads = command_.common.threads;
        Result<report::PanelSet> panels = report::make_panels(std::move(subject), options);
        if (!panels) return panels.error();
        for (const std::string& text : panels->warnings) out_.warnings.push_back(text);
        sheet.panels = std::move(panels->panels);
        if (!panels->edges.figures.empty()) sheet.groups.push_back(panels->edges);
        if (!panels->differences.figures.empty()) sheet.groups.push_back(panels->differences);
        sheet.groups.push_back(report::findings_group(findings, 8));

        Json numbers;
        numbers["sheet"] = sheet.title;
        for (const report::FigureGroup& group : sheet.groups)
            for (const report::Figure& f : group.figures)
                numbers["figures"][group.title][f.name] = figure_json(f.value);
        numbers["panels"] = Json::array();
        for (const report::Panel& p : sheet.panels)
            numbers["panels"].push_back({{"id", p.id},
                                         {"drawn", p.picture.has_value()},
                                         {"text", p.picture ? p.caption : p.note}});
        out_.numbers.push_back(std::move(numbers));

        const std::filesystem::path path = command_.output / (stem + ".png");
        const Result<void> saved =
            prep::save_image(path, report::draw_sheet(sheet, command_.panel));
        if (!saved) return saved.error();
        out_.sheets.push_back(path);
        page.sheets.push_back(std::move(sheet));
        return {};
    }

    void add_tables(report::Page& page, const prep::PreparedScene& prepared) const {
        // Without times: the same input gives the same page.
        report::Table stages{"Stages", {"stage", "", "reason"}, {}};
        for (const prep::StageReport& s : prepared.stages)
            stages.rows.push_back({s.stage, s.run ? "run" : "skipped", s.reason});
        page.tables.push_back(std::move(stages));
        if (out_.findings.empty()) return;
        report::Table findings{
            "Findings", {"severity", "count", "kind", "mesh", "what", "where"}, {}};
        for (const prep::Finding& f : out_.findings) {
            const bool named = f.mesh < out_.mesh_names.size() && !out_.mesh_names[f.mesh].empty();
            findings.rows.push_back({std::string(prep::name_of(f.severity)), with_commas(f.count),
                                     f.kind,
                                     named ? out_.mesh_names[f.mesh] : std::to_string(f.mesh),
                                     f.text, places_text(f, 8)});
        }
        page.tables.push_back(std::move(findings));
    }

    std::string angle_text() const {
        const auto& angle = command_.prepare.hard_edges.angle_degrees;
        return angle ? fmt::format("{:g}°", *angle) : "off";
    }
    std::string weight_text() const {
        switch (command_.prepare.normal.weight) {
            case prep::NormalWeight::uniform:
                return "uniform";
            case prep::NormalWeight::angle:
                return "angle";
            case prep::NormalWeight::area_angle:
                return "area × angle";
            case prep::NormalWeight::edge_length:
                return "edge length";
            case prep::NormalWeight::area:
                break;
        }
        return "area";
    }
    void progress(const std::string& what) {
        console_.progress(command_.common, out_.input.string() + " … " + what);
    }

    const ValidateCommand& command_;
    Shared& shared_;
    Console& console_;
    Outcome out_;
};

Json outcome_json(const Outcome& outcome) {
    Json file;
    file["input"] = outcome.input.string();
    file["status"] = outcome.error ? "failed" : "ok";
    if (outcome.error) {
        file["error"] = to_json(*outcome.error);
    } else {
        file["page"] = outcome.page.string();
        file["sheets"] = Json::array();
        for (const std::filesystem::path& sheet : outcome.sheets)
            file["sheets"].push_back(sheet.string());
    }
    file["numbers"] = outcome.numbers;
    file["findings"] = Json::array();
    for (const prep::Finding& f : outcome.findings) {
        Json finding = to_json(f, {});
        if (f.mesh < outcome.mesh_names.size() && !outcome.mesh_names[f.mesh].empty())
            finding["mesh_name"] = outcome.mesh_names[f.mesh];
        file["findings"].push_back(std::move(finding));
    }
    file["warnings"] = outcome.warnings;
    file["milliseconds"] = outcome.milliseconds;
    return file;
}

void print_outcome(const Outcome& outcome, const CommonOptions& common, Console& console) {
    for (const std::string& text : outcome.warnings)
        console.warning(common, said_of(outcome.input, text));
    if (outcome.error) {
        console.error(*outcome.error);
        return;
    }
    console.result(common, fmt::format("{} → {}  {}", outcome.input.string(), outcome.page.string(),
                                       duration(outcome.milliseconds)));
    for (const std::filesystem::path& sheet : outcome.sheets)
        console.result(common, "  " + sheet.string());
    for (const std::string& line : findings_text(outcome.findings, outcome.mesh_names, 4))
        console.result(common, line);
}

int run(const ValidateCommand& command, Console& console) {
    const CommonOptions& common = command.common;
    FileRecords records("validate", common, console);
    std::error_code ec;
    if (std::filesystem::exists(command.output, ec) &&
        !std::filesystem::is_directory(command.output, ec))
        return records.fail(
            {ErrorCode::io, "a file of this name is in the way of the output directory",
             command.output.string()},
            exit_failed);
    const std::vector<std::string> stems = page_stems(command.inputs);
    std::vector<Job> jobs;
    for (std::size_t i = 0; i < command.inputs.size(); ++i)
        jobs.push_back({command.inputs[i], command.output / (stems[i] + ".html"), "html"});
    Shared shared{{}, {}, BatchSources(jobs, common, console)};
    if (command.prepare.displacement.map)
        shared.sources.add(command.prepare.displacement.map->path);
    std::size_t failed = 0;
    for (std::size_t i = 0; i < command.inputs.size(); ++i) {
        Outcome outcome;
        outcome.input = command.inputs[i];
        if (stems[i].empty())
            outcome.error =
                Error{ErrorCode::invalid,
                      "an earlier input has the sheets of this name; validate them into "
                      "directories of their own",
                      command.inputs[i].string()};
        else if (const Result<void> fresh = require_unread(command.inputs, i); !fresh)
            outcome.error = fresh.error();
        else
            outcome = Validator(command, shared, console).run(jobs[i], stems[i]);
        failed += outcome.error.has_value();
        print_outcome(outcome, common, console);
        if (records.wanted()) records.add(outcome_json(outcome));
    }
    console.progress(common, "");
    const std::size_t total = command.inputs.size();
    records.finish({{"files", total}, {"ok", total - failed}, {"failed", failed}});
    return failed > 0 ? exit_failed : exit_done;
}

void define(OptionSet& options, ValidateCommand& c) {
    options
        .paths("input", c.inputs, "FILE",
               "Mesh or scene files, .gz and .zip too, or - for standard input")
        .required();
    options
        .path("-o,--output", c.output, "DIR", "Directory for the sheets; made if it is not there")
        .required();
    options.texts("--mesh", c.meshes, "NAME|N",
                  "Only this mesh, by name or number; may be repeated");
    options.value(
        "--camera", "AZ,EL",
        [&c](const std::string& text) {
            const std::vector<double> n = parse_numbers(text, ',');
            if (n.size() != 2 || std::abs(n[1]) > 90)
                usage_error("--camera", "'" + text +
                                            "' is not AZIMUTH,ELEVATION with an elevation from "
                                            "-90 to 90");
            c.azimuth = n[0];
            c.elevation = n[1];
        },
        "Where the pictures are taken from, in degrees (default 30,20)");
    options.number("--panel", c.panel, 64, 2048, "PIXELS",
                   "Width and height of each picture (default 480)");
    options.number("--max-meshes", c.max_meshes, 1, 100000, "N",
                   "Sheets for at most so many meshes of a file, beside the whole scene's "
                   "(default 64)");
    add_input_options(options, c.common);
    add_preparation_options(options, c.prepare);
    add_loading_options(options, c.common.load);
    add_common_options(options, c.common);
    add_json_lines_option(options, c.common);
    options.examples(
        "  meshprep validate spot.obj -o sheets\n"
        "  meshprep validate helmet.gltf -o sheets --mesh visor --hard-angle 45");
}

void check(const ValidateCommand& c) {
    if (is_standard_stream(c.output))
        usage_error("--output", "is a directory for several files, - is none; give -o DIR");
    if (c.common.json && c.common.json_lines)
        usage_error("--json",
                    "is one document, --json-lines a line for each file; give one of them");
}

}  // namespace

Subcommand validate_subcommand() {
    return subcommand<ValidateCommand>(
        "validate", "Prove the result: sheets of pictures and numbers, as PNG and one HTML page",
        define, run, check);
}

}  // namespace meshprep
