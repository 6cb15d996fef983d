// What a subcommand's command line has, as data: the one source of its manual page, of completions
// and of what is said of a misspelt option.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace meshprep {

std::string joined(const std::vector<std::string>& words, const std::string& separator = " ");

struct OptionRow {
    std::vector<std::string> names;  // "-o", "--output"; of an argument by its place its one name
    std::string type;                // the word for its value, "on|off"; empty: it takes none
    std::string help, group;
    bool positional = false, required = false, repeated = false;

    const std::string& longest_name() const { return names.back(); }
    // What stands for the value in `type` in lower case: words to be typed as they are.
    std::vector<std::string> words() const;
    bool takes_files() const;  // FILE, DIR, IMAGE, or the diff's A and B
};

struct CommandTable {
    std::string name, summary;
    std::string examples;  // lines, each indented
    std::vector<OptionRow> options;

    const OptionRow* find(const std::string& name) const;  // "--output" or "-o"
    std::vector<std::string> long_names() const;
};

CommandTable table_of(const CLI::App& app);

// All that the command has: its own options first, then each subcommand's.
struct CommandTables {
    CommandTable command;
    std::vector<CommandTable> subcommands;

    const CommandTable* find(const std::string& name) const;
    std::vector<std::string> names() const;
};

CommandTables tables_of(const CLI::App& app);

}  // namespace meshprep
