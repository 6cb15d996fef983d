// Completions for shells, from the tables of options: subcommands, options, words that an option
// takes, files where it takes those.
#pragma once

#include <string>

#include "meshprep/options/option_table.h"

namespace meshprep {

std::string bash_completion(const CommandTables& tables);  // needs bash alone
std::string zsh_completion(const CommandTables& tables);
std::string fish_completion(const CommandTables& tables);

}  // namespace meshprep
