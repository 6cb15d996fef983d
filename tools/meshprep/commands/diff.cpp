#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "meshprep/commands/mesh_diff.h"
#include "meshprep/commands/subcommand.h"
#include "meshprep/files/file_list.h"
#include "meshprep/files/input_file.h"
#include "meshprep/files/output_directories.h"
#include "meshprep/output/load_options.h"
#include "meshprep/output/report_json.h"
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
};

using prep::Error;
using prep::ErrorCode;
using prep::Result;

bool is_picture(const std::filesystem::path& path) {
    static const char* const endings[] = {"png", "jpg", "jpeg", "exr", "tif", "tiff", "tga",
                                          "bmp", "hdr", "webp", "gif", "pfm", "ppm"};
    const std::string ending = lower_ending(path);
    return std::any_of(std::begin(endings), std::end(endings),
                       [&](const char* e) { return ending == e; });
}

// Whether the tolerance holds, and what was found.
struct Verdict {
    bool within = true;
    Json json;
};

Verdict report_pictures(const DiffCommand& command, const report::ImageDiff& d, Console& console) {
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
    Verdict verdict;
    verdict.within = !command.tolerance ||
                     (d.rmse <= *command.tolerance && d.infinite == 0 && d.different_integers == 0);
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
    return verdict;
}

Verdict report_attribute(const DiffCommand& command, const AttributeDiff& d, Console& console) {
    const auto say = [&](const std::string& line) { console.result(command.common, line); };
    const bool tangents = d.attribute == Attribute::tangents;
    const char* name = tangents ? "tangents" : "normals";
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
    if (!command.heat_map.empty()) {
        OutputDirectories directories;
        if (const Result<void> made = directories.make_for(command.heat_map); !made)
            return made.error();
        if (const Result<void> saved = prep::save_image(command.heat_map, diff->heat); !saved)
            return saved.error();
    }
    return report_pictures(command, *diff, console);
}

Result<prep::Scene> load_mesh(const std::filesystem::path& path, const CommonOptions& common,
                              Console& console) {
    const Result<InputFile> input = InputFile::open(path, common.input_format);
    if (!input) return input.error();
    Result<prep::Scene> scene = prep::load_scene(input->path(), load_options(common, console));
    if (!scene) return input->relabelled(scene.error());
    input->settle(*scene);
    return scene;
}

Result<Verdict> diff_meshes(const DiffCommand& command, Console& console) {
    if (!command.heat_map.empty())
        return Error{ErrorCode::invalid, "a heat map shows how pictures differ; these are meshes",
                     command.heat_map.string()};
    const Result<prep::Scene> a = load_mesh(command.a, command.common, console);
    if (!a) return a.error();
    const Result<prep::Scene> b = load_mesh(command.b, command.common, console);
    if (!b) return b.error();
    std::vector<Attribute> attributes;
    if (command.normals) attributes.push_back(Attribute::normals);
    if (command.tangents) attributes.push_back(Attribute::tangents);
    if (attributes.empty()) {
        for (const Attribute attribute : {Attribute::normals, Attribute::tangents})
            if (has_attribute(*a, attribute) && has_attribute(*b, attribute))
                attributes.push_back(attribute);
        if (attributes.empty())
            return Error{
                ErrorCode::invalid,
                "there is nothing to compare: the files share neither normals nor tangents",
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
        if (is_picture(command.a) != is_picture(command.b))
            return Error{ErrorCode::invalid,
                         "one is a picture, the other a mesh; give two of a kind",
                         command.b.string()};
        return is_picture(command.a) ? diff_pictures(command, console)
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
        console.error(
            fmt::format("they are further apart than the tolerance of {:g}", *command.tolerance));
    return verdict->within ? exit_done : exit_failed;
}

void define(OptionSet& options, DiffCommand& c) {
    options.path("a", c.a, "A", "A mesh file or a picture; - for a mesh on standard input")
        .required();
    options.path("b", c.b, "B", "Another of the same kind").required();
    options.flag("--tangents", c.tangents, "Compare tangents: angles and signs");
    options.flag("--normals", c.normals, "Compare normals: angles");
    options.path("--heat-map", c.heat_map, "IMAGE", "Pictures: write where they differ");
    options.not_negative(
        "--tolerance", c.tolerance, "T",
        "Exit 1 when the largest angle (degrees) or the pictures' RMSE is above this, or "
        "a tangent's sign or an ID differs, or a value is infinite in one picture alone");
    add_input_options(options, c.common);
    add_loading_options(options, c.common.load);
    add_common_options(options, c.common);
    options.examples(
        "  meshprep diff --tangents baked.glb prepared.glb\n"
        "  meshprep diff before.png after.png --heat-map difference.png --tolerance 0.004");
}

}  // namespace

Subcommand diff_subcommand() {
    return subcommand<DiffCommand>(
        "diff", "How far two meshes' normals and tangents, or two pictures, are apart", define,
        run);
}

}  // namespace meshprep
