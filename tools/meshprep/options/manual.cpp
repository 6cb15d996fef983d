#include "meshprep/options/manual.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace meshprep {
namespace {

// Text as it is to be seen: backslashes, dashes that are typed, dots that would be requests.
std::string roff(const std::string& text) {
    std::string out;
    bool line_start = true;
    for (const char c : text) {
        if (line_start && (c == '.' || c == '\'')) out += "\\&";
        line_start = c == '\n';
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else if (c == '\'')
            out += "\\(aq";
        else
            out += c;
    }
    return out;
}

std::string upper(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return text;
}

std::string head(const std::string& name, const std::string& version) {
    return ".TH " + roff(upper(name)) + " 1 \"\" \"meshprep " + roff(version) +
           "\" \"User Commands\"\n";
}

std::string names_of(const OptionRow& row) {
    std::string text;
    for (const std::string& name : row.names)
        text += (text.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
    if (!row.type.empty()) text += " \\fI" + roff(row.type) + "\\fR";
    return text;
}

std::string synopsis(const CommandTable& table) {
    std::string text = ".B meshprep " + roff(table.name) + "\n[\\fIOPTION\\fR]...\n";
    for (const OptionRow& row : table.options)
        if (row.positional)
            text += "\\fI" + roff(row.type) + "\\fR" + (row.repeated ? "..." : "") + "\n";
    return text;
}

// Groups in the order of their first option, each under its name.
std::string options(const CommandTable& table) {
    std::vector<std::string> groups;
    for (const OptionRow& row : table.options)
        if (!row.positional && std::find(groups.begin(), groups.end(), row.group) == groups.end())
            groups.push_back(row.group);
    std::string text = ".SH OPTIONS\n";
    for (const std::string& group : groups) {
        if (group != "Options") text += ".SS " + roff(group) + "\n";
        for (const OptionRow& row : table.options)
            if (!row.positional && row.group == group)
                text += ".TP\n" + names_of(row) + "\n" + roff(row.help) + "\n";
    }
    return text;
}

std::string arguments(const CommandTable& table) {
    std::string text;
    for (const OptionRow& row : table.options)
        if (row.positional) text += ".TP\n\\fI" + roff(row.type) + "\\fR\n" + roff(row.help) + "\n";
    return text;
}

constexpr const char* exit_status =
    ".SH \"EXIT STATUS\"\n.TP\n0\nDone.\n.TP\n1\nAn input or a check failed; what could be done "
    "was "
    "done.\n.TP\n2\nThe command line cannot be followed.\n";

std::string subcommand_page(const CommandTable& table, const std::string& version) {
    const std::string name = "meshprep-" + table.name;
    std::string text = head(name, version);
    text += ".SH NAME\n" + roff(name) + " \\- " + roff(table.summary) + "\n";
    text += ".SH SYNOPSIS\n" + synopsis(table);
    text += ".SH DESCRIPTION\n" + roff(table.summary) +
            ".\nResults go to standard output, messages to standard error.\n" + arguments(table);
    text += options(table);
    if (!table.examples.empty()) text += ".SH EXAMPLES\n.nf\n" + roff(table.examples) + "\n.fi\n";
    text += exit_status;
    text += ".SH \"SEE ALSO\"\n.BR meshprep (1)\n";
    return text;
}

std::string command_page(const CommandTables& tables, const std::string& version) {
    std::string text = head("meshprep", version);
    text += ".SH NAME\nmeshprep \\- get meshes ready for shading, and prove that they are\n";
    text +=
        ".SH SYNOPSIS\n.B meshprep\n\\fISUBCOMMAND\\fR [\\fIOPTION\\fR]... "
        "[\\fIFILE\\fR]...\n.br\n.B meshprep help\n[\\fISUBCOMMAND\\fR]\n";
    text += ".SH DESCRIPTION\n" + roff(tables.command.summary) + "\n.SH SUBCOMMANDS\n";
    for (const CommandTable& table : tables.subcommands)
        text += ".TP\n\\fB" + roff(table.name) + "\\fR\n" + roff(table.summary) + "\n";
    text += options(tables.command) + exit_status;
    text += ".SH \"SEE ALSO\"\n";
    for (const CommandTable& table : tables.subcommands)
        text += ".BR meshprep\\-" + roff(table.name) + " (1)" +
                (&table == &tables.subcommands.back() ? "\n" : ",\n");
    return text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> manual_pages(const CommandTables& tables,
                                                              const std::string& version) {
    std::vector<std::pair<std::string, std::string>> pages;
    pages.emplace_back("meshprep.1", command_page(tables, version));
    for (const CommandTable& table : tables.subcommands)
        pages.emplace_back("meshprep-" + table.name + ".1", subcommand_page(table, version));
    return pages;
}

}  // namespace meshprep
