#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cost/measure/flip.h"
#include "meshprep/commands/diff_gate.h"
#include "meshprep/commands/mesh_diff.h"
#include "meshprep/commands/subcommand.h"
#include "meshprep/files/file_list.h"
#include "meshprep/files/input_file.h"
#include "meshprep/files/output_directories.h"
#include "meshprep/output/load_options.h"
#include "meshprep/output/report_json.h"
#include "prep/files.h"
#include "prep/image.h"
#include "prep/load.h"
#include "sheets/image_diff.h"

namespace meshprep {
namespace {

struct DiffCommand {
    CommonOptions common;
    std::filesystem::path a, b;
    bool tangents = false, normals = false;  // neither: what both files have
    std::filesystem::path heat_map;          // written when set
    std::optional<double> tolerance;         // degrees (meshes) or RMSE (pictures): above it exit 1
    std::filesystem::path gate, page;        // judged by these limits, written when set
    int views = -1;                          // outlines from so many places; -1: the gate's number
    bool flip = false;

    // Meshes are compared in all they are, not by directions alone.
    bool judges() const { return !gate.empty() || !page.empty() || views >= 0; }
};

using prep::Error;
using prep::ErrorCode;
using prep::Result;

// Whether the tolerance or the gate holds, and what was found.
struct Verdict {
    bool within = true;
    Json json;
    std::string beyond = {};  // which limits of a gate are not held
};

// The gate's limits, and what the command line has in their place. Without a gate file, its
// defaults.
Result<Gate> gate_of(const DiffCommand& command) {
    Gate gate;
    if (!command.gate.empty()) {
        if (const Result<void> there = require_file(command.gate); !there) return there.error();
        const Result<std::vector<std::byte>> bytes = prep::read_file(command.gate);
        if (!bytes) return bytes.error();
        Result<Gate> read =
            gate_from({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
        if (!read)
            return Error{read.error().code, read.error().text,
                         command.gate.string() + read.error().place};
        gate = *std::move(read);
    }
    if (command.views >= 0) gate.views = std::uint32_t(command.views);
    if (command.tolerance) {
        gate.limits.normals = gate.limits.tangents = command.tolerance;
        gate.rmse = command.tolerance;
    }
    return gate;
}

// As FLIP takes them: three channels, sRGB-encoded. What is not a number counts as black.
Result<cost::Pixels> flip_pixels(const prep::Image& image, const std::filesystem::path& path) {
    if (image.channels > 4 || image.integer_channels != 0)
        return Error{ErrorCode::invalid,
                     "FLIP compares colours, and this file's channels are others", path.string()};
    cost::Pixels pixels{image.width, image.height, 3, {}};
    pixels.values.reserve(std::size_t(image.width) * image.height * 3);
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const double v = double(image.at(x, y)[image.channels < 3 ? 0 : k]);
                pixels.values.push_back(std::isnan(v) ? 0 : v);
            }
    return image.srgb ? pixels : cost::srgb_encoded(pixels);
}

Verdict report_pictures(const DiffCommand& command, const report::ImageDiff& d,
                        const std::optional<cost::Flip>& flip, const Gate& gate, Console& console) {
    const auto say = [&](const std::string& line) { console.result(command.common, line); };
    if (d.different == 0) {
        say(fmt::format("identical: {} pixels", with_commas(d.pixels)));
    } else {
        say(fmt::format("{} of {} pixels differ ({:.2f} %)", with_commas(d.different),
                        with_commas(d.pixels),
                        100.0 * static_cast<double>(d.different) / static_cast<double>(d.pixels)));
        if (d.different_integers > 0)
            say(fmt::format("  integers differ in {}", count_of(d.different_integers, "pixel")));
        const auto figures = [&](const char* head, const std::string& tail) {
            say(fmt::format("  {}RMSE {:.6f}, PSNR {:.2f} dB, mean {:.6f}, largest {:.6f}{}", head,
                            d.rmse, d.psnr, d.mean, d.largest, tail));
        };
        const std::string where = fmt::format(" at ({}, {})", d.worst_x, d.worst_y);
        if (d.infinite > 0) {
            say(fmt::format(
                "  largest infinite{}: {} infinite or not a number in one picture alone", where,
                count_of(d.infinite, "value")));
            figures("the others: ", "");
        } else if (d.different_integers > 0) {
            say("  first" + where);
            if (d.measured) figures("the other channels: ", "");
        } else {
            figures("", where);
        }
    }
    if (flip) say(fmt::format("  FLIP mean {:.6f}, largest {:.6f}", flip->mean, flip->largest));
    Verdict verdict;
    const auto hold = [&](bool holds, const char* name) {
        if (holds) return;
        verdict.within = false;
        verdict.beyond += (verdict.beyond.empty() ? "" : ", ") + std::string(name);
    };
    if (command.tolerance || !command.gate.empty()) {
        const bool judged = gate.rmse.has_value();
        hold(!judged || (d.rmse <= *gate.rmse && d.infinite == 0 && d.different_integers == 0),
             "rmse");
        // FLIP knows no infinity and no missing number: what either picture alone has holds none.
        hold(!flip || !gate.limits.flip || (flip->mean <= *gate.limits.flip && d.infinite == 0),
             "flip");
    }
    // JSON knows no infinity: null, and the number of such values beside it.
    const auto figure = [&](double value) {
        return d.measured && d.infinite == 0 && std::isfinite(value) ? Json(value) : Json(nullptr);
    };
    verdict.json = {{"kind", "pictures"},
                    {"pixels", d.pixels},
                    {"different", d.different},
                    {"infinite", d.infinite},
                    {"different_integers", d.different_integers},
                    {"rmse", figure(d.rmse)},
                    {"psnr", figure(d.psnr)},
                    {"mean", figure(d.mean)},
                    {"largest", figure(d.largest)},
                    {"worst", {d.worst_x, d.worst_y}}};
    if (flip) verdict.json["flip"] = {{"mean", flip->mean}, {"largest", flip->largest}};
    return verdict;
}

report::Page picture_page(const DiffCommand& command, const prep::Image& a, const prep::Image& b,
                          const report::ImageDiff& d, const cost::Flip& flip,
                          const Verdict& verdict) {
    report::Page page;
    page.title = command.b.string() + " against " + command.a.string();
    page.subtitle = !verdict.within        ? "Beyond its limit: " + verdict.beyond + "."
                    : d.different == 0     ? "Identical."
                    : command.gate.empty() ? "What differs."
                                           : "Within the limits of " + command.gate.string() + ".";
    report::Sheet sheet;
    const auto panel = [&](const char* id, const char* title, const std::string& caption,
                           const prep::Image& picture) {
        report::Panel p;
        p.id = id;
        p.title = p.alt = title;
        p.caption = caption;
        p.picture = picture;
        sheet.panels.push_back(std::move(p));
    };
    prep::Image seen{a.width, a.height, 3, {}, true};
    for (const double e : flip.errors) seen.pixels.insert(seen.pixels.end(), 3, float(e));
    panel("first", "First", command.a.string(), a);
    panel("second", "Second", command.b.string(), b);
    panel("heat", "Values", "from black for equal over blue, red and yellow to white", d.heat);
    panel("flip", "FLIP", "black is equal, white as different as can be", seen);
    page.sheets.push_back(std::move(sheet));
    page.tables.push_back(
        {"Figures",
         {"figure", "value"},
         {{"pixels that differ",
           fmt::format("{} of {}", with_commas(d.different), with_commas(d.pixels))},
          {"RMSE", fmt::format("{:.6g}", d.rmse)},
          {"largest", fmt::format("{:.6g} at ({}, {})", d.largest, d.worst_x, d.worst_y)},
          {"FLIP mean", fmt::format("{:.6g}", flip.mean)},
          {"FLIP largest", fmt::format("{:.6g}", flip.largest)}}});
    return page;
}

const char* name_of(Attribute attribute) {
    return attribute == Attribute::tangents ? "tangents" : "normals";
}

Verdict report_attribute(const DiffCommand& command, const AttributeDiff& d, Console& console) {
    const auto say = [&](const std::string& line) { console.result(command.common, line); };
    const bool tangents = d.attribute == Attribute::tangents;
    const char* const name = name_of(d.attribute);
    say(fmt::format("{}: {} corners compared{}", name, with_commas(d.compared),
                    d.same_order ? "" : ", triangles matched by position"));
    if (d.unmatched > 0)
        say(fmt::format("  {} without a partner in the other file",
                        count_of(d.unmatched, "triangle")));
    say(fmt::format("  identical to the last bit: {}", with_commas(d.identical)));
    say(fmt::format(
        "  degrees: mean {:.4g}, RMS {:.4g}, median {:.4g}, 99 % {:.4g}, largest {:.4g}", d.mean,
        d.rms, d.median, d.p99, d.largest));
    if (tangents) say(fmt::format("  signs that differ: {}", with_commas(d.sign_differences)));
    if (d.invalid > 0)
        say(fmt::format("  zero, missing or not finite in a file: {}", with_commas(d.invalid)));
    for (const WorstCorner& w : d.worst)
        say(fmt::format("    {:.4g}° at mesh {}, face {}, corner {}", w.degrees, w.mesh, w.face,
                        w.corner));
    Verdict verdict;
    verdict.within =
        !command.tolerance || (d.largest <= *command.tolerance && d.sign_differences == 0 &&
                               d.unmatched == 0 && d.invalid == 0);
    verdict.json = {{"kind", name},
                    {"same_order", d.same_order},
                    {"compared", d.compared},
                    {"unmatched_triangles", d.unmatched},
                    {"identical", d.identical},
                    {"invalid", d.invalid},
                    {"degrees",
                     {{"mean", d.mean},
                      {"rms", d.rms},
                      {"median", d.median},
                      {"p99", d.p99},
                      {"largest", d.largest}}}};
    if (tangents) verdict.json["sign_differences"] = d.sign_differences;
    verdict.json["worst"] = Json::array();
    for (const WorstCorner& w : d.worst)
        verdict.json["worst"].push_back(
            {{"mesh", w.mesh}, {"face", w.face}, {"corner", w.corner}, {"degrees", w.degrees}});
    return verdict;
}

Result<Verdict> diff_pictures(const DiffCommand& command, Console& console) {
    if (command.tangents || command.normals)
        return Error{ErrorCode::invalid, "pictures have no normals or tangents to compare",
                     command.a.string()};
    if (command.views >= 0)
        return Error{ErrorCode::invalid, "--views draws meshes, and these are pictures",
                     command.a.string()};
    const Result<Gate> gate = gate_of(command);
    if (!gate) return gate.error();
    const prep::LoadOptions load = load_options(command.common, console);
    prep::ImageOptions options;
    options.channels = prep::ImageChannels::all;
    options.reader_process = load.reader_process;
    options.reader_log = load.reader_log;
    const Result<prep::Image> a = prep::load_image(command.a, options);
    if (!a) return a.error();
    const Result<prep::Image> b = prep::load_image(command.b, options);
    if (!b) return b.error();
    const Result<report::ImageDiff> diff = report::diff_images(*a, *b);
    if (!diff) return Error{diff.error().code, diff.error().text, command.b.string()};
    std::optional<cost::Flip> flip;
    const bool gated = !command.gate.empty() && gate->limits.flip;
    if (command.flip || gated || !command.page.empty()) {
        const Result<cost::Pixels> pa = flip_pixels(*a, command.a);
        if (!pa) return pa.error();
        const Result<cost::Pixels> pb = flip_pixels(*b, command.b);
        if (!pb) return pb.error();
        flip = cost::flip(*pa, *pb);
    }
    // After all that can fail.
    if (!command.heat_map.empty()) {
        OutputDirectories directories;
        if (const Result<void> made = directories.make_for(command.heat_map); !made)
            return made.error();
        if (const Result<void> saved = prep::save_image(command.heat_map, diff->heat); !saved)
            return saved.error();
    }
    Verdict verdict = report_pictures(command, *diff, flip, *gate, console);
    if (!command.page.empty())
        if (const Result<void> written =
                write_page(command.page, picture_page(command, *a, *b, *diff, *flip, verdict));
            !written)
            return written.error();
    return verdict;
}

// Refused where the page would replace what the mesh is read from.
Result<prep::Scene> load_mesh(const std::filesystem::path& path, const DiffCommand& command,
                              Console& console) {
    const Result<InputFile> input = InputFile::open(path, command.common.input_format);
    if (!input) return input.error();
    Result<prep::Scene> scene =
        prep::load_scene(input->path(), load_options(command.common, console));
    if (!scene) return input->relabelled(scene.error());
    input->settle(*scene);
    if (!command.page.empty())
        for (const std::filesystem::path& file : read_beside(*scene))
            if (file == identity_of(command.page))
                return Error{ErrorCode::invalid, "the output is also an input; give another name",
                             command.page.string()};
    return scene;
}

bool has_faces(const prep::Scene& scene) {
    return std::any_of(scene.meshes.begin(), scene.meshes.end(),
                       [](const prep::Mesh& mesh) { return mesh.face_count() > 0; });
}

Result<Verdict> judge_meshes(const DiffCommand& command, const prep::Scene& a, const prep::Scene& b,
                             Console& console) {
    const Result<Gate> gate = gate_of(command);
    if (!gate) return gate.error();
    if (!has_faces(a) && !has_faces(b))
        return Error{ErrorCode::invalid,
                     "there is nothing to compare: neither file has faces, and lines and points "
                     "are not compared",
                     command.a.string()};
    if (gate->views == 0 && !gate->drawn_limit.empty())
        return Error{ErrorCode::invalid, "is a limit of what is drawn, and there are 0 views",
                     command.gate.string() + "#/limits/" + gate->drawn_limit};
    judge::JudgeOptions options;
    options.limits = gate->limits;
    options.meshes = gate->meshes;
    options.views = gate->views;
    options.size = gate->size;
    options.always_views = command.views > 0;
    options.pictures = !command.page.empty();
    options.threads = command.common.threads;
    const Result<judge::Judgement> judgement = judge::judge(a, b, options);
    if (!judgement) return judgement.error();
    say_judgement(command.common, *judgement, a, console);
    if (!command.page.empty())
        if (const Result<void> written = write_page(
                command.page,
                judgement_page({command.a.string(), command.b.string(), command.gate.string()},
                               *judgement, a, gate->replay));
            !written)
            return written.error();
    Verdict verdict;
    if (!command.gate.empty() || command.tolerance) {
        verdict.within = judgement->within();
        verdict.beyond = failed_causes(*judgement);
    }
    verdict.json = to_json(*judgement, a);
    if (!gate->replay.empty()) {
        verdict.json["replay"] = gate->replay;
        if (!verdict.within)
            console.result(command.common, "the second file is made again by: " + gate->replay);
    }
    return verdict;
}

Result<Verdict> diff_meshes(const DiffCommand& command, Console& console) {
    if (!command.heat_map.empty())
        return Error{ErrorCode::invalid, "a heat map shows how pictures differ; these are meshes",
                     command.heat_map.string()};
    if (command.flip)
        return Error{ErrorCode::invalid,
                     "--flip compares pictures; of meshes, a gate's limit \"flip\" does",
                     command.a.string()};
    const Result<prep::Scene> a = load_mesh(command.a, command, console);
    if (!a) return a.error();
    const Result<prep::Scene> b = load_mesh(command.b, command, console);
    if (!b) return b.error();
    if (command.judges()) return judge_meshes(command, *a, *b, console);
    std::vector<Attribute> attributes;
    if (command.normals) attributes.push_back(Attribute::normals);
    if (command.tangents) attributes.push_back(Attribute::tangents);
    if (attributes.empty()) {
        for (const Attribute attribute : {Attribute::normals, Attribute::tangents}) {
            const bool in_a = has_attribute(*a, attribute), in_b = has_attribute(*b, attribute);
            if (in_a && in_b) attributes.push_back(attribute);
            if (in_a != in_b)
                console.warning(
                    command.common,
                    fmt::format("{} has {}, and {} has none: they are not compared",
                                (in_a ? command.a : command.b).string(), name_of(attribute),
                                (in_a ? command.b : command.a).string()));
        }
        if (attributes.empty())
            return Error{
                ErrorCode::invalid,
                "there is nothing to compare: the files share neither normals nor tangents; "
                "--views 6 or --gate compares all that they are",
                command.a.string()};
    }
    Verdict all;
    all.json = Json::array();
    for (const Attribute attribute : attributes) {
        const Result<AttributeDiff> diff = diff_attribute(*a, *b, attribute);
        if (!diff) return diff.error();
        Verdict one = report_attribute(command, *diff, console);
        all.within &= one.within;
        all.json.push_back(std::move(one.json));
    }
    return all;
}

int run(const DiffCommand& command, Console& console) {
    Json document = json_head("diff");
    document["a"] = command.a.string();
    document["b"] = command.b.string();
    const auto compare = [&]() -> Result<Verdict> {
        for (const std::filesystem::path& path : {command.a, command.b})
            if (!is_standard_stream(path))
                if (const Result<void> there = require_file(path); !there) return there.error();
        if (is_standard_stream(command.a) && is_standard_stream(command.b))
            return Error{ErrorCode::invalid,
                         "both are standard input, which is read once; name a file for one of them",
                         "-"};
        if (const Result<void> fresh = require_unread({command.a, command.b}, 1); !fresh)
            return fresh.error();
        if (prep::is_image_name(command.a) != prep::is_image_name(command.b))
            return Error{ErrorCode::invalid,
                         "one is a picture, the other a mesh; give two of a kind",
                         command.b.string()};
        std::vector<std::filesystem::path> inputs{command.a, command.b}, outputs;
        if (!command.gate.empty()) inputs.push_back(command.gate);
        for (const std::filesystem::path& file : {command.heat_map, command.page})
            if (!file.empty()) outputs.push_back(file);
        if (const Result<void> apart = keep_apart(inputs, outputs); !apart) return apart.error();
        return prep::is_image_name(command.a) ? diff_pictures(command, console)
                                              : diff_meshes(command, console);
    };
    const Result<Verdict> verdict = compare();
    if (!verdict) {
        console.error(verdict.error());
        document["error"] = to_json(verdict.error());
        if (command.common.json) console.json(json_text(document));
        return exit_failed;
    }
    document["differences"] =
        verdict->json.is_array() ? verdict->json : Json::array({verdict->json});
    document["within_tolerance"] = verdict->within;
    if (command.common.json) console.json(json_text(document));
    if (!verdict->within)
        console.error(command.gate.empty() && !command.judges()
                          ? fmt::format("they are further apart than the tolerance of {:g}",
                                        *command.tolerance)
                          : "the gate is not passed: " + verdict->beyond);
    return verdict->within ? exit_done : exit_failed;
}

void define(OptionSet& options, DiffCommand& c) {
    options.path("a", c.a, "A", "A mesh file or a picture; - for a mesh on standard input")
        .required();
    options.path("b", c.b, "B", "Another of the same kind").required();
    options.flag("--tangents", c.tangents,
                 "Compare tangents: angles and signs (default: normals and tangents that both "
                 "have)");
    options.flag("--normals", c.normals, "Compare normals: angles");
    options.path("--heat-map", c.heat_map, "IMAGE", "Pictures: write where they differ");
    options.not_negative(
        "--tolerance", c.tolerance, "T",
        "Exit 1 when the largest angle (degrees) or the pictures' RMSE is above this, or "
        "a tangent's sign or an ID differs, a triangle has no partner, a direction is none, or a "
        "value is infinite in one picture alone");
    options.flag("--flip", c.flip, "Pictures: how different they look, by LDR-FLIP");
    options.path("--gate", c.gate, "GATE.json",
                 "Compare all that meshes are, or pictures, by these limits: exit 1 beyond one");
    options.number("--views", c.views, 0, 64, "N",
                   "Meshes: compare all that they are, outlines from N sides (default 6) among it");
    options.path("--report", c.page, "PAGE.html", "The same, and write a page of what was found");
    add_input_options(options, c.common);
    add_loading_options(options, c.common.load);
    add_common_options(options, c.common);
    options.examples(
        "  meshprep diff --tangents baked.glb prepared.glb\n"
        "  meshprep diff before.png after.png --heat-map difference.png --tolerance 0.004\n"
        "  meshprep diff accepted.glb new.glb --gate gate.json --report difference.html");
}

void check(const DiffCommand& c) {
    if (c.judges() && (c.normals || c.tangents))
        usage_error(c.normals ? "--normals" : "--tangents",
                    "compares directions alone; --gate, --views and --report compare everything");
}

}  // namespace

Subcommand diff_subcommand() {
    return subcommand<DiffCommand>(
        "diff", "How far two meshes' normals and tangents, or two pictures, are apart", define, run,
        check);
}

}  // namespace meshprep
