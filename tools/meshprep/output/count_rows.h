// Counts before and after, as rows of a table.
#pragma once

#include <string>
#include <vector>

#include "meshprep/output/counts.h"

namespace meshprep {

// Name, before, after; without those named in `skip` and those that are 0 on both sides.
void add_count_rows(std::vector<std::vector<std::string>>& rows, const Counts& before,
                    const Counts& after, const std::vector<std::string>& skip);

}  // namespace meshprep
