// `meshprep --generate man|bash|zsh|fish DIR`: what the build installs beside the command. Not in
// the help: nobody types it.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "meshprep/options/option_table.h"

namespace meshprep {

// `words`: what follows --generate. Returns the exit code.
int generate(const std::vector<std::string>& words, const CommandTables& tables, std::ostream& err);

}  // namespace meshprep
