// The JSON form of what `meshprep cost` measured, written and read again.
#pragma once

#include <string_view>

#include "cost/pages/cost_table.h"
#include "meshprep/output/report_json.h"

namespace meshprep {

Json to_json(const cost::CostTable& table);

// What the table was before: what follows from the measurements is derived anew, so that pages made
// from it have the same bytes. Errors: syntax (no JSON), invalid (another document, members that
// are missing or of another kind, lists of other lengths; with the JSON pointer).
prep::Result<cost::CostTable> cost_table_from(std::string_view text);

}  // namespace meshprep
