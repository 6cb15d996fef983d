#include "meshprep/options/option_table.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace meshprep {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::size_t from = 0;
    for (std::size_t at; (at = text.find(separator, from)) != std::string::npos; from = at + 1)
        parts.push_back(text.substr(from, at - from));
    parts.push_back(text.substr(from));
    return parts;
}

bool is_word(const std::string& text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    });
}

}  // namespace

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
    return text;
}

std::vector<std::string> OptionRow::words() const {
    std::vector<std::string> words;
    for (const std::string& part : split(type, '|'))
        if (is_word(part)) words.push_back(part);
    return words;
}

bool OptionRow::takes_files() const {
    const std::vector<std::string> parts = split(type, '|');
    return std::any_of(parts.begin(), parts.end(), [this](const std::string& part) {
        return part == "FILE" || part == "DIR" || part == "IMAGE" ||
               (positional && (part == "A" || part == "B"));
    });
}

const OptionRow* CommandTable::find(const std::string& option) const {
    for (const OptionRow& row : options)
        if (!row.positional &&
            std::find(row.names.begin(), row.names.end(), option) != row.names.end())
            return &row;
    return nullptr;
}

std::vector<std::string> CommandTable::long_names() const {
    std::vector<std::string> names;
    for (const OptionRow& row : options)
        for (const std::string& option : row.names)
            if (option.starts_with("--")) names.push_back(option);
    return names;
}

CommandTable table_of(const CLI::App& app) {
    CommandTable table;
    table.name = app.get_name();
    table.summary = app.get_description();
    table.examples = app.get_footer();
    if (const std::string head = "Examples:\n"; table.examples.starts_with(head))
        table.examples.erase(0, head.size());
    for (const CLI::Option* const option : app.get_options()) {
        OptionRow row;
        row.positional = option->get_positional();
        for (const std::string& name : option->get_snames()) row.names.push_back("-" + name);
        for (const std::string& name : option->get_lnames()) row.names.push_back("--" + name);
        if (row.positional) row.names = {option->get_name(true)};
        if (option->get_items_expected_max() > 0) row.type = option->get_type_name();
        row.help = option->get_description();
        row.group = option->get_group();
        row.required = option->get_required();
        row.repeated = option->get_items_expected_max() > 1 ||
                       option->get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
        table.options.push_back(std::move(row));
    }
    return table;
}

CommandTables tables_of(const CLI::App& app) {
    CommandTables tables;
    tables.command = table_of(app);
    for (const CLI::App* const subcommand :
         app.get_subcommands([](const CLI::App*) { return true; }))
        tables.subcommands.push_back(table_of(*subcommand));
    return tables;
}

const CommandTable* CommandTables::find(const std::string& name) const {
    for (const CommandTable& table : subcommands)
        if (table.name == name) return &table;
    return nullptr;
}

std::vector<std::string> CommandTables::names() const {
    std::vector<std::string> list;
    for (const CommandTable& table : subcommands) list.push_back(table.name);
    return list;
}

}  // namespace meshprep
