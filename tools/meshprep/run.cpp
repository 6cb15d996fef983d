#include "meshprep/run.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <new>

#include "meshprep/commands/generate.h"
#include "meshprep/commands/subcommand.h"
#include "meshprep/files/file_list.h"
#include "meshprep/options/usage_errors.h"
#include "meshprep/output/report_json.h"
#include "meshprep/output/version_text.h"

namespace meshprep {
namespace {

using Words = std::vector<std::string>;

// With the options of the subcommand `only` where there is one of that name: those of all take as
// long as a small mesh does.
void define(CLI::App& app, const std::vector<Subcommand>& known, const std::string& only) {
    const bool one = std::any_of(known.begin(), known.end(), [&](const Subcommand& subcommand) {
        return subcommand.name == only;
    });
    app.require_subcommand(1);
    app.get_formatter()->column_width(36);
    app.set_version_flag(
        "-V,--version", [] { return version_text(); },
        "This version, and those of what it is built on");
    app.footer("'meshprep help SUBCOMMAND' tells more.\nFiles in: " + input_endings_text() +
               ".\nFiles out: " + output_endings_text() + ".");
    for (const Subcommand& subcommand : known) {
        OptionSet options(*app.add_subcommand(subcommand.name, subcommand.summary));
        if (!one || subcommand.name == only) subcommand.define(options);
    }
}

// Of all subcommands: what a usage error may have to tell of another.
CommandTables all_tables() {
    const std::vector<Subcommand> known = subcommands();
    CLI::App app("", "meshprep");
    define(app, known, "");
    return tables_of(app);
}

bool asks_for_json(const Words& words) {
    return std::any_of(words.begin(), words.end(), [](const std::string& word) {
        return word == "--json" || word == "--json-lines";
    });
}

// Said on the error stream; with --json also as the document that was asked for.
int refuse(const UsageError& error, const CommandTables& tables, const Words& words,
           std::ostream& out, std::ostream& err) {
    err << "meshprep: error: " << to_string(error) << '\n';
    if (!asks_for_json(words)) return exit_usage;
    Json document = json_head(tables.find(words[0]) ? words[0].c_str() : "meshprep");
    document["error"] = {{"code", "usage"}, {"text", error.text}, {"place", error.option}};
    const bool lines = std::find(words.begin(), words.end(), "--json-lines") != words.end();
    if (lines) document["record"] = "summary";
    out << (lines ? json_line(document) : json_text(document)) << '\n';
    return exit_usage;
}

// "help" and "help SUBCOMMAND" are "--help" and "SUBCOMMAND --help".
Words without_help_word(Words words) {
    if (words.empty() || words[0] != "help") return words;
    if (words.size() == 1) return {"--help"};
    return {words[1], "--help"};
}

// The option that "--" stands behind instead of its value; null where there is none.
const OptionRow* waits_for_value(const Words& words, const CommandTables& tables) {
    const auto dashes = std::find(words.begin(), words.end(), "--");
    const CommandTable* const table = tables.find(words[0]);
    if (dashes == words.end() || table == nullptr) return nullptr;
    const OptionRow* const before = table->find(*(dashes - 1));
    return before != nullptr && !before->type.empty() ? before : nullptr;
}

// What follows "--" are files, whatever they begin with. CLI11 2.1 takes them where no file stands
// before alone.
Words with_files_after_dashes(Words words) {
    const auto dashes = std::find(words.begin(), words.end(), "--");
    if (dashes == words.end()) return words;
    for (auto word = dashes + 1; word != words.end(); ++word)
        if (word->size() > 1 && word->starts_with('-')) *word = "./" + *word;
    words.erase(dashes);
    return words;
}

// CLI11 2.1 takes a file "[a,b]" for a list of two. What is no option's value is a file.
Words with_bracketed_files(Words words, const CommandTables& tables) {
    const CommandTable* const table = tables.find(words[0]);
    if (table == nullptr) return words;
    for (std::size_t n = 1; n < words.size(); ++n) {
        if (!words[n].starts_with('[') || !words[n].ends_with(']')) continue;
        const OptionRow* const before = table->find(words[n - 1]);
        if (before == nullptr || before->type.empty()) words[n] = "./" + words[n];
    }
    return words;
}

// The subcommand that was parsed; null where all was said in parsing: help, the version, a usage
// error.
const Subcommand* parse(Words words, const std::vector<Subcommand>& known, std::ostream& out,
                        std::ostream& err, int& exit_code) {
    CLI::App app(
        "meshprep gets meshes ready for shading and proves, by pictures and by numbers, that they "
        "are.",
        "meshprep");
    words = without_help_word(std::move(words));
    define(app, known, words.empty() ? "" : words[0]);
    exit_code = exit_usage;
    if (words.empty()) {
        err << app.help();
        return nullptr;
    }
    const CommandTables tables = tables_of(app);
    if (words[0] == "--generate") {
        exit_code = generate(Words(words.begin() + 1, words.end()), tables, err);
        return nullptr;
    }
    if (!words[0].starts_with("-") && !tables.find(words[0])) {
        exit_code = refuse(unknown_subcommand(words[0], tables), tables, words, out, err);
        return nullptr;
    }
    if (const OptionRow* const option = waits_for_value(words, tables)) {
        const UsageError error{option->longest_name(), "needs a value, and '--' stands there",
                               "'meshprep help " + words[0] + "' lists its options."};
        exit_code = refuse(error, tables, words, out, err);
        return nullptr;
    }
    words = with_bracketed_files(with_files_after_dashes(std::move(words)), tables);
    try {
        app.parse(Words(words.rbegin(), words.rend()));
        for (const Subcommand& subcommand : known)
            if (app.get_subcommand(subcommand.name)->parsed()) {
                subcommand.check();
                return &subcommand;
            }
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) {
            (void)app.exit(error, out, err);
            exit_code = exit_done;
        } else {
            exit_code = refuse(explain(error, all_tables(), words), tables, words, out, err);
        }
    }
    return nullptr;
}

}  // namespace

int run(int argc, const char* const* argv, std::ostream& out, std::ostream& err,
        bool err_is_terminal) {
    const std::vector<Subcommand> known = subcommands();
    int code = exit_usage;
    const Words words(argv + std::min(argc, 1), argv + argc);
    if (const Subcommand* const subcommand = parse(words, known, out, err, code)) {
        Console console(out, err, err_is_terminal);
        code = exit_failed;
        try {
            code = subcommand->run(console);
        } catch (const std::bad_alloc&) {
            console.error("out of memory; nothing was half written");
        } catch (const std::exception& e) {
            console.error(std::string("the system refused: ") + e.what());
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
