#include "meshprep/options/arguments.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "meshprep/files/file_list.h"
#include "meshprep/options/render_options.h"
#include "meshprep/options/shared_options.h"
#include "meshprep/output/version_text.h"

namespace meshprep {
namespace {

CLI::App* define_prepare(CLI::App& app, PrepareCommand& c) {
    CLI::App* sub =
        app.add_subcommand("prepare", "Load, check, prepare what the materials call for, write");
    sub->add_option("input", c.inputs, "Mesh or scene files, or directories of them")
        ->required()
        ->type_name("FILE|DIR");
    sub->add_option("-o,--output", c.output, "A file (its ending says the format) or a directory")
        ->type_name("FILE|DIR");
    Words<std::string> formats;
    for (const std::string& ending : output_endings()) formats.emplace_back(ending, ending);
    add_words<std::string>(
        sub, "--format", formats, [&c](const std::string& word) { c.format = word; },
        "Format of files written to a directory (default glb)");
    sub->add_flag("--ascii", c.save.ascii, "PLY and STL as text");
    sub->add_flag("--in-place", c.in_place, "Write each result over its input");
    sub->add_flag(
        "-r,--recursive", c.recursive,
        "Also what lies in directories below, kept apart in directories of the same names");
    sub->add_flag_callback(
        "--no-overwrite", [&c] { c.overwrite = false; },
        "An output file that exists is an error instead of being replaced");
    sub->add_flag("--explain", c.explain,
                  "Each stage: run or skipped, its reason, its milliseconds");
    add_preparation_options(sub, c.prepare);
    add_common_options(sub, c.common);
    sub->footer(
        "Examples:\n"
        "  meshprep prepare spot.obj -o spot.glb\n"
        "  meshprep prepare part.stl -o part.glb --hard-angle 30 --explain\n"
        "  meshprep prepare *.obj more/*.fbx -o out/        many files; a bad one stops no other\n"
        "  meshprep prepare assets -r -o out --format gltf  a tree of files\n"
        "  meshprep prepare rock.glb --in-place --tangents mikktspace");
    return sub;
}

CLI::App* define_inspect(CLI::App& app, InspectCommand& c) {
    CLI::App* sub =
        app.add_subcommand("inspect", "Say what is in a file and what is wrong with it");
    sub->add_option("input", c.inputs, "Mesh or scene files")->type_name("FILE");
    sub->add_flag("--selftest", c.selftest,
                  "Instead of files: hard cases in short form on this machine, with the errors "
                  "found; exit 1 when one fails");
    sub->add_flag("--strict", c.strict, "Exit 1 when there is a warning or worse");
    sub->add_option("--places", c.places, "Places shown per finding (default 4)")
        ->check(CLI::Range(0, 8))
        ->type_name("N");
    add_common_options(sub, c.common);
    sub->footer(
        "Examples:\n"
        "  meshprep inspect teapot.obj\n"
        "  meshprep inspect model.glb --strict --quiet && echo clean\n"
        "  meshprep inspect model.glb --json | jq '.files[0].findings'\n"
        "  meshprep inspect --selftest");
    return sub;
}

CLI::App* define_validate(CLI::App& app, ValidateCommand& c) {
    CLI::App* sub = app.add_subcommand(
        "validate", "Prove the result: sheets of pictures and numbers, as PNG and one HTML page");
    sub->add_option("input", c.inputs, "Mesh or scene files")->required()->type_name("FILE");
    sub->add_option("-o,--output", c.output, "Directory for the sheets; made if it is not there")
        ->required()
        ->type_name("DIR");
    sub->add_option("--mesh", c.meshes, "Only this mesh, by name or number; may be repeated")
        ->expected(1)
        ->take_all()
        ->type_name("NAME|N");
    sub->add_option_function<std::string>(
           "--camera",
           [&c](const std::string& text) {
               const std::vector<double> n = parse_numbers(text, ',');
               if (n.size() != 2 || std::abs(n[1]) > 90)
                   usage_error("--camera", "'" + text +
                                               "' is not AZIMUTH,ELEVATION with an elevation from "
                                               "-90 to 90");
               c.camera = {n[0], n[1], 1.0};
           },
           "Where the pictures are taken from, in degrees (default 30,20)")
        ->type_name("AZ,EL");
    sub->add_option("--panel", c.panel, "Width and height of each picture (default 480)")
        ->check(CLI::Range(64, 2048))
        ->type_name("PIXELS");
    sub->add_option("--max-meshes", c.max_meshes,
                    "Sheets for at most so many meshes of a file, beside the whole scene's "
                    "(default 64)")
        ->check(CLI::Range(1, 100000))
        ->type_name("N");
    add_preparation_options(sub, c.prepare);
    add_common_options(sub, c.common);
    sub->footer(
        "Examples:\n"
        "  meshprep validate spot.obj -o sheets\n"
        "  meshprep validate helmet.gltf -o sheets --mesh visor --hard-angle 45");
    return sub;
}

CLI::App* define_diff(CLI::App& app, DiffCommand& c) {
    CLI::App* sub = app.add_subcommand(
        "diff", "How far two meshes' normals and tangents, or two pictures, are apart");
    sub->add_option("a", c.a, "A mesh file or a picture")->required()->type_name("A");
    sub->add_option("b", c.b, "Another of the same kind")->required()->type_name("B");
    sub->add_flag("--tangents", c.tangents, "Compare tangents: angles and signs");
    sub->add_flag("--normals", c.normals, "Compare normals: angles");
    sub->add_option("--heat-map", c.heat_map, "Pictures: write where they differ")
        ->type_name("IMAGE");
    sub->add_option(
           "--tolerance", c.tolerance,
           "Exit 1 when the largest angle (degrees) or the pictures' RMSE is above this, or "
           "a tangent's sign or an ID differs, or a value is infinite in one picture alone")
        ->check(CLI::NonNegativeNumber)
        ->type_name("T");
    add_common_options(sub, c.common);
    sub->footer(
        "Examples:\n"
        "  meshprep diff --tangents baked.glb prepared.glb\n"
        "  meshprep diff before.png after.png --heat-map difference.png --tolerance 0.004");
    return sub;
}

}  // namespace

Arguments parse_arguments(int argc, const char* const* argv) {
    CLI::App app(
        "meshprep gets meshes ready for shading and proves, by pictures and by numbers, that they "
        "are.",
        "meshprep");
    app.require_subcommand(1);
    app.get_formatter()->column_width(36);
    app.set_version_flag(
        "--version", [] { return version_text(); },
        "This version, and those of what it is built on");
    app.footer("'meshprep SUBCOMMAND --help' tells more.\nFiles in: " + input_endings_text() +
               ".\nFiles out: " + output_endings_text() + ".");

    PrepareCommand prepare;
    InspectCommand inspect;
    RenderCommand render;
    ValidateCommand validate;
    DiffCommand diff;
    const CLI::App* prepare_app = define_prepare(app, prepare);
    const CLI::App* inspect_app = define_inspect(app, inspect);
    const CLI::App* render_app = define_render(app, render);
    const CLI::App* validate_app = define_validate(app, validate);
    const CLI::App* diff_app = define_diff(app, diff);

    Arguments out;
    if (argc <= 1) {
        out.err = app.help();
        out.exit_code = exit_usage;
        return out;
    }
    if (const std::string_view first = argv[1]; !first.empty() && first[0] != '-') {
        std::vector<std::string> names;
        for (const CLI::App* sub : app.get_subcommands({})) names.push_back(sub->get_name());
        if (std::find(names.begin(), names.end(), first) == names.end()) {
            std::string known;
            for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
            out.err = "'" + std::string(first) + "' is no subcommand; there are " + known +
                      ".\nRun with --help for more information.\n";
            out.exit_code = exit_usage;
            return out;
        }
    }
    try {
        app.parse(argc, argv);
        if (prepare_app->parsed() && prepare.output.empty() && !prepare.in_place)
            usage_error("--output", "is missing; give -o FILE or -o DIR (or --in-place)");
        if (inspect_app->parsed() && inspect.inputs.empty() != inspect.selftest)
            usage_error("input", inspect.selftest ? "--selftest takes no files"
                                                  : "is missing; give files (or --selftest)");
        if (prepare_app->parsed() && !prepare.output.empty() && prepare.in_place)
            usage_error("--in-place", "writes over the inputs; it takes no --output");
        if (render_app->parsed()) check_render(render);
    } catch (const CLI::ParseError& error) {
        std::ostringstream to_out, to_err;
        const bool asked = app.exit(error, to_out, to_err) == 0;
        out.out = to_out.str();
        out.err = to_err.str();
        out.exit_code = asked ? exit_done : exit_usage;
        return out;
    }
    if (prepare_app->parsed()) out.command = std::move(prepare);
    if (inspect_app->parsed()) out.command = std::move(inspect);
    if (render_app->parsed()) out.command = std::move(render);
    if (validate_app->parsed()) out.command = std::move(validate);
    if (diff_app->parsed()) out.command = std::move(diff);
    return out;
}

}  // namespace meshprep
