// What is said of a prepared file: on the console, as JSON, in the manifest.
#pragma once

#include "meshprep/commands/prepare_file.h"
#include "meshprep/output/report_json.h"

namespace meshprep {

Json outcome_json(const Outcome& outcome);
// For the manifest, which holds no times.
ManifestEntry manifest_entry(const Outcome& outcome);
// Everything about the only file.
void print_details(const Outcome& outcome, const PrepareCommand& command, Console& console);
// One line of many.
void print_row(const Outcome& outcome, const PrepareCommand& command, Console& console);

}  // namespace meshprep
