// The page that people read, and the same numbers as comma-separated values.
#pragma once

#include <string>
#include <vector>

#include "cost/pages/cost_table.h"

namespace cost {

// One self-contained HTML page, without script and without anything from elsewhere. The same table
// gives the same bytes.
std::string cost_page(const CostTable& table);

// RFC 4180, a line for each rung and metric: ladder, rung, command, metric, unit, domain, error,
// seconds, their interval, the ratio to the default and its interval, standing.
std::string cost_csv(const CostTable& table);

// Rows for a terminal: a head, then a row for each rung.
std::vector<std::vector<std::string>> cost_rows(const LadderRecord& ladder);

}  // namespace cost
