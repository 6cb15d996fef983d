#include "meshprep/options/completions.h"

#include <algorithm>

namespace meshprep {
namespace {

// The start of a help text, as one remark: shells show a line.
std::string remark(const std::string& help) {
    constexpr std::size_t longest = 72;
    const std::string sentence = help.substr(0, help.find(". "));
    if (sentence.size() <= longest) return sentence;
    return sentence.substr(0, sentence.rfind(' ', longest)) + " …";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
    return text;
}

std::vector<std::string> all_names(const CommandTable& table) {
    std::vector<std::string> names;
    for (const OptionRow& row : table.options)
        if (!row.positional) names.insert(names.end(), row.names.begin(), row.names.end());
    return names;
}

// --- bash ---

// The arms of "SUBCOMMAND OPTION": what its value may be.
std::string bash_values(const CommandTable& table) {
    std::string text, files, none;
    for (const OptionRow& row : table.options) {
        if (row.positional || row.type.empty()) continue;
        std::vector<std::string> patterns;
        for (const std::string& name : row.names)
            patterns.push_back("\"" + table.name + " " + name + "\"");
        const std::string pattern = joined(patterns, "|");
        if (row.takes_files())
            files += (files.empty() ? "" : "|") + pattern;
        else if (const auto words = row.words(); !words.empty())
            text += "        " + pattern + ")\n            _meshprep_words \"" + joined(words) +
                    "\"\n            return ;;\n";
        else
            none += (none.empty() ? "" : "|") + pattern;
    }
    if (!files.empty())
        text += "        " + files + ")\n            _meshprep_files\n            return ;;\n";
    if (!none.empty()) text += "        " + none + ")\n            return ;;\n";
    return text;
}

// --- zsh ---

std::string zsh_quoted(std::string text) {
    text = replaced(std::move(text), "'", "'\\''");
    for (const char* special : {"[", "]", ":"})
        text = replaced(std::move(text), special, std::string("\\") + special);
    return text;
}

std::string zsh_value(const OptionRow& row) {
    if (row.type.empty()) return {};
    const std::string what = ":" + zsh_quoted(row.type) + ":";
    if (row.takes_files()) return what + "_files";
    const std::vector<std::string> words = row.words();
    return what + (words.empty() ? "" : "(" + joined(words) + ")");
}

std::string zsh_option(const OptionRow& row) {
    const std::string tail = "[" + zsh_quoted(remark(row.help)) + "]" + zsh_value(row);
    const std::string star = row.repeated ? "*" : "";
    if (row.names.size() == 1) return "            '" + star + row.names[0] + tail + "'";
    const std::string apart = row.repeated ? "'*'" : "'(" + joined(row.names) + ")'";
    return "            " + apart + "{" + joined(row.names, ",") + "}'" + tail + "'";
}

// --- fish ---

std::string fish_quoted(std::string text) {
    return "'" + replaced(replaced(std::move(text), "\\", "\\\\"), "'", "\\'") + "'";
}

}  // namespace

std::string bash_completion(const CommandTables& tables) {
    const std::string names = joined(tables.names());
    std::string text =
        "# bash completion of meshprep\n"
        "_meshprep_words() {\n"
        "    mapfile -t COMPREPLY < <(compgen -W \"$1\" -- \"${COMP_WORDS[COMP_CWORD]}\")\n"
        "}\n"
        "_meshprep_files() {\n"
        "    mapfile -t COMPREPLY < <(compgen -f -- \"${COMP_WORDS[COMP_CWORD]}\")\n"
        "    compopt -o filenames 2>/dev/null\n"
        "}\n"
        "_meshprep() {\n"
        "    local subcommand=${COMP_WORDS[1]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
        "    COMPREPLY=()\n"
        "    if ((COMP_CWORD == 1)); then\n"
        "        _meshprep_words \"" +
        names + " help " + joined(all_names(tables.command)) +
        "\"\n"
        "        return\n"
        "    fi\n"
        "    if [[ $subcommand == help ]]; then\n"
        "        _meshprep_words \"" +
        names +
        "\"\n"
        "        return\n"
        "    fi\n"
        "    case \"$subcommand $before\" in\n";
    for (const CommandTable& table : tables.subcommands) text += bash_values(table);
    text +=
        "    esac\n"
        "    if [[ ${COMP_WORDS[COMP_CWORD]} != -* ]]; then\n"
        "        _meshprep_files\n"
        "        return\n"
        "    fi\n"
        "    case \"$subcommand\" in\n";
    for (const CommandTable& table : tables.subcommands)
        text += "        " + table.name + ")\n            _meshprep_words \"" +
                joined(all_names(table)) + "\" ;;\n";
    return text + "    esac\n}\ncomplete -F _meshprep meshprep\n";
}

std::string zsh_completion(const CommandTables& tables) {
    std::string text =
        "#compdef meshprep\n"
        "# zsh completion of meshprep\n"
        "_meshprep() {\n"
        "    local curcontext=\"$curcontext\" state line\n"
        "    local -a subcommands\n"
        "    subcommands=(\n";
    for (const CommandTable& table : tables.subcommands)
        text += "        '" + table.name + ":" + zsh_quoted(table.summary) + "'\n";
    text +=
        "        'help:What a subcommand takes'\n"
        "    )\n"
        "    _arguments -C";
    for (const OptionRow& row : tables.command.options)
        if (!row.positional) text += " \\\n" + zsh_option(row);
    text +=
        " \\\n            '1:subcommand:->subcommand' \\\n            '*::argument:->argument'\n"
        "    case $state in\n"
        "        subcommand)\n"
        "            _describe subcommand subcommands ;;\n"
        "        argument)\n"
        "            case $words[1] in\n";
    for (const CommandTable& table : tables.subcommands) {
        text += "        " + table.name + ")\n            _arguments -s";
        for (const OptionRow& row : table.options)
            if (!row.positional) text += " \\\n" + zsh_option(row);
        text += " \\\n            '*:file:_files' ;;\n";
    }
    return text +
           "        help)\n            _describe subcommand subcommands ;;\n"
           "            esac ;;\n"
           "    esac\n"
           "}\n"
           "_meshprep \"$@\"\n";
}

std::string fish_completion(const CommandTables& tables) {
    std::string text = "# fish completion of meshprep\n";
    const std::string none =
        "-n " + fish_quoted("not __fish_seen_subcommand_from " + joined(tables.names()) + " help");
    const auto option = [&text](const std::string& when, const OptionRow& row) {
        text += "complete -c meshprep " + when;
        for (const std::string& name : row.names)
            text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
        if (row.takes_files())
            text += " -r -F";
        else if (!row.type.empty())
            text += " -x";
        if (const auto words = row.words(); !words.empty() && !row.takes_files())
            text += " -a " + fish_quoted(joined(words));
        text += " -d " + fish_quoted(remark(row.help)) + "\n";
    };
    for (const CommandTable& table : tables.subcommands)
        text += "complete -c meshprep " + none + " -f -a " + table.name + " -d " +
                fish_quoted(table.summary) + "\n";
    text += "complete -c meshprep " + none + " -f -a help -d 'What a subcommand takes'\n";
    text += "complete -c meshprep -n '__fish_seen_subcommand_from help' -f -a " +
            fish_quoted(joined(tables.names())) + "\n";
    for (const OptionRow& row : tables.command.options)
        if (!row.positional) option(none, row);
    for (const CommandTable& table : tables.subcommands)
        for (const OptionRow& row : table.options)
            if (!row.positional)
                option("-n " + fish_quoted("__fish_seen_subcommand_from " + table.name), row);
    return text;
}

}  // namespace meshprep
