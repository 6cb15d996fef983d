#include "meshprep/options/usage_errors.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>

#include "text/suggestions.h"

namespace meshprep {
namespace {

std::string advice_for(const std::string& subcommand) {
    return subcommand.empty() ? "'meshprep help' lists what there is."
                              : "'meshprep help " + subcommand + "' lists its options.";
}

bool looks_like_option(const std::string& word) {
    if (word.size() < 2 || word[0] != '-') return false;
    const bool number = (word[1] >= '0' && word[1] <= '9') || word[1] == '.';
    return !number;
}

// "--size=3x4" → "--size"; "-o" of "-ofile".
std::string option_of(const std::string& word) {
    return word.starts_with("--") ? word.substr(0, word.find('=')) : word.substr(0, 2);
}

std::string meant(const std::string& option, const CommandTable& table,
                  const CommandTables& tables) {
    // A letter's distance is never small; "-json" was meant to have two dashes.
    if (!option.starts_with("--")) {
        const OptionRow* const row = table.find("-" + option);
        return row ? "; did you mean '-" + option + "'?" : "";
    }
    const std::string near = prep::detail::nearest_name(option, table.long_names());
    if (!near.empty()) return "; did you mean '" + near + "'?";
    std::vector<std::string> others;
    for (const CommandTable& other : tables.subcommands)
        if (other.find(option)) others.push_back(other.name);
    if (!others.empty())
        return "; " + joined(others, ", ") + (others.size() == 1 ? " has" : " have") + " it";
    // The start of one alone was meant for it: "--thr".
    std::vector<std::string> starts;
    for (const std::string& name : table.long_names())
        if (option.size() > 3 && name.starts_with(option)) starts.push_back(name);
    if (starts.size() == 1) return "; did you mean '" + starts[0] + "'?";
    return "";
}

// The first word that names an option which the subcommand does not have.
std::optional<UsageError> unknown_option(const CommandTables& tables, const CommandTable& table,
                                         const std::vector<std::string>& words) {
    for (std::size_t i = 1; i < words.size(); ++i) {
        const std::string& word = words[i];
        if (word == "--") break;
        if (!looks_like_option(word)) continue;
        std::string option = option_of(word);
        if (const OptionRow* const row = table.find(option)) {
            const bool with_value = word.size() > option.size();
            if (row->type.empty() && word.starts_with("--") && with_value)
                return UsageError{option,
                                  "takes no value; leave '" + word.substr(option.size()) + "' out",
                                  advice_for(table.name)};
            // What follows is its value, whatever it looks like.
            if (!row->type.empty() && !with_value) ++i;
            // "-qv": letters in one word, none of which takes a value but the last.
            if (row->type.empty() && !word.starts_with("--") && with_value) {
                option = word;
                const bool all = std::all_of(word.begin() + 1, word.end(), [&](char c) {
                    return table.find(std::string("-") + c) != nullptr;
                });
                if (all) continue;
            } else {
                continue;
            }
        } else if (!word.starts_with("--")) {
            option = word;
        }
        std::error_code ec;
        if (std::filesystem::exists(word, ec))
            return UsageError{
                option,
                "is no option of " + table.name + "; the file of this name is meant by ./" + word,
                advice_for(table.name)};
        return UsageError{option, "is no option of " + table.name + meant(option, table, tables),
                          advice_for(table.name)};
    }
    return std::nullopt;
}

// The parser's name of an option, "--output" or "input", at the head of what it says.
const OptionRow* row_named(const CommandTable& table, const std::string& name) {
    for (const OptionRow& row : table.options)
        if (std::find(row.names.begin(), row.names.end(), name) != row.names.end()) return &row;
    return nullptr;
}

UsageError missing(const OptionRow& row, const CommandTable& table) {
    if (!row.positional)
        return {row.longest_name(),
                "is missing; give " + row.names.front() + " " + row.type + " (" + row.help + ")",
                advice_for(table.name)};
    return {row.longest_name(), "is missing; give " + row.type + " (" + row.help + ")",
            advice_for(table.name)};
}

}  // namespace

std::string to_string(const UsageError& error) {
    std::string text = error.option.empty() ? "" : error.option + ": ";
    text += error.text;
    if (!error.advice.empty()) text += "\n" + error.advice;
    return text;
}

UsageError unknown_subcommand(const std::string& word, const CommandTables& tables) {
    const std::string near = prep::detail::nearest_name(word, tables.names());
    std::error_code ec;
    if (near.empty() && std::filesystem::exists(word, ec))
        return {"",
                "'" + word +
                    "' is a file, and a subcommand says what to do with it: meshprep inspect " +
                    word + ", or meshprep prepare " + word + " -o OUTPUT",
                advice_for("")};
    return {"",
            "'" + word + "' is no subcommand; " +
                (near.empty() ? "" : "did you mean '" + near + "'? ") +
                (near.empty() ? "there" : "There") + " are " + joined(tables.names(), ", "),
            advice_for("")};
}

UsageError explain(const CLI::ParseError& error, const CommandTables& tables,
                   const std::vector<std::string>& words) {
    const CommandTable* const table = words.empty() ? nullptr : tables.find(words[0]);
    const std::string text = error.what();
    if (!table) {
        const bool option = !words.empty() && looks_like_option(words[0]);
        if (!option) return {"", text, advice_for("")};
        const std::string name = option_of(words[0]);
        for (const std::string& word : words)
            if (const CommandTable* const other = tables.find(word); other && other->find(name))
                return {name, "stands after the subcommand, as in meshprep " + word + " " + name,
                        advice_for(word)};
        return {name, "is no option of meshprep" + meant(name, tables.command, tables),
                advice_for("")};
    }
    if (std::optional<UsageError> unknown = unknown_option(tables, *table, words))
        return *std::move(unknown);
    const std::string head = text.substr(0, text.find_first_of(" :"));
    const OptionRow* const row = row_named(*table, head);
    if (row && dynamic_cast<const CLI::RequiredError*>(&error)) return missing(*row, *table);
    if (row && dynamic_cast<const CLI::ArgumentMismatch*>(&error) &&
        text.find("missing") != std::string::npos)
        return {row->longest_name(), "needs a value: " + row->type + " (" + row->help + ")",
                advice_for(table->name)};
    if (row && dynamic_cast<const CLI::ArgumentMismatch*>(&error))
        return {row->longest_name(), "is given more than once; leave all but one out",
                advice_for(table->name)};
    if (const std::string word = " requires "; row && text.find(word) != std::string::npos)
        return {head,
                "works only together with " + text.substr(text.find(word) + word.size()) +
                    "; give both",
                advice_for(table->name)};
    if (const std::string word = " excludes "; row && text.find(word) != std::string::npos)
        return {head,
                "cannot stand beside " + text.substr(text.find(word) + word.size()) +
                    "; give one of them",
                advice_for(table->name)};
    if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
        std::string usage;
        for (const OptionRow& option : table->options)
            if (option.positional) usage += " " + option.type;
        const std::string extra = text.substr(text.rfind(": ") + 2);
        return {"", "'" + extra + "' is more than " + table->name + " takes, which is" + usage,
                advice_for(table->name)};
    }
    if (row && text.starts_with(head + ": ")) {
        // What acts on an option that was read already names it as well.
        std::string said = text.substr(head.size() + 2);
        if (said.starts_with(head + ": ")) said.erase(0, head.size() + 2);
        return {row->longest_name(), std::move(said), advice_for(table->name)};
    }
    return {"", text, advice_for(table->name)};
}

}  // namespace meshprep
