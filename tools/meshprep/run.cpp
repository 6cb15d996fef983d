#include "meshprep/run.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>

#include "meshprep/commands/subcommand.h"
#include "meshprep/files/file_list.h"
#include "meshprep/output/version_text.h"

namespace meshprep {
namespace {

// The subcommand that was parsed; null where all was said in parsing: help, the version, a usage
// error.
const Subcommand* parse(int argc, const char* const* argv, const std::vector<Subcommand>& known,
                        std::ostream& out, std::ostream& err, int& exit_code) {
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
    std::string names;
    for (const Subcommand& subcommand : known) {
        OptionSet options(*app.add_subcommand(subcommand.name, subcommand.summary));
        subcommand.define(options);
        names += (names.empty() ? "" : ", ") + subcommand.name;
    }

    exit_code = exit_usage;
    if (argc <= 1) {
        err << app.help();
        return nullptr;
    }
    const std::string first = argv[1];
    const auto is_first = [&](const Subcommand& subcommand) { return subcommand.name == first; };
    const auto found = std::find_if(known.begin(), known.end(), is_first);
    if (!first.empty() && first[0] != '-' && found == known.end()) {
        err << "'" << first << "' is no subcommand; there are " << names
            << ".\nRun with --help for more information.\n";
        return nullptr;
    }
    try {
        app.parse(argc, argv);
        for (const Subcommand& subcommand : known)
            if (app.get_subcommand(subcommand.name)->parsed()) {
                subcommand.check();
                return &subcommand;
            }
    } catch (const CLI::ParseError& error) {
        if (app.exit(error, out, err) == 0) exit_code = exit_done;
    }
    return nullptr;
}

}  // namespace

int run(int argc, const char* const* argv, std::ostream& out, std::ostream& err,
        bool err_is_terminal) {
    const std::vector<Subcommand> known = subcommands();
    int code = exit_usage;
    if (const Subcommand* const subcommand = parse(argc, argv, known, out, err, code)) {
        Console console(out, err, err_is_terminal);
        code = exit_failed;
        try {
            code = subcommand->run(console);
        } catch (const std::bad_alloc&) {
            console.error("out of memory; nothing was half written");
        }
    }
    out.flush();
    if (!out) {
        err << "meshprep: error: standard output cannot be written\n";
        return exit_failed;
    }
    return code;
}

}  // namespace meshprep
