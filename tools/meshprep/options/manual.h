// Manual pages, as man(7) source, from the tables of options.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "meshprep/options/option_table.h"

namespace meshprep {

// Names ("meshprep.1", "meshprep-prepare.1", …) and texts. The same tables give the same bytes:
// there is no date in them.
std::vector<std::pair<std::string, std::string>> manual_pages(const CommandTables& tables,
                                                              const std::string& version);

}  // namespace meshprep
