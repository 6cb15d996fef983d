// What is said of a command line that cannot be followed: what is wrong with which word of it, and
// what may have been meant.
#pragma once

#include <string>
#include <vector>

#include "meshprep/options/option_table.h"

namespace CLI {
class ParseError;
}  // namespace CLI

namespace meshprep {

struct UsageError {
    std::string option;  // "--output"; empty where it is about no single one
    std::string text;    // what is wrong, what may have been meant
    std::string advice;  // where to read on
};

std::string to_string(const UsageError& error);  // "--output: is missing; …\n'meshprep help …"

// `words`: the command line without the program's name. The parser's own words are the last resort.
UsageError explain(const CLI::ParseError& error, const CommandTables& tables,
                   const std::vector<std::string>& words);

// For a first word that is no subcommand.
UsageError unknown_subcommand(const std::string& word, const CommandTables& tables);

}  // namespace meshprep
