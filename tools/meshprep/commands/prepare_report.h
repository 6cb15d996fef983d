// What is said of a prepared file: on the console, as JSON, in the manifest.
#pragma once

#include "meshprep/commands/prepare_file.h"
#include "meshprep/output/report_json.h"

namespace meshprep {

// What is decided about each mesh, and the calls of prep::calls_for() that decided it.
Json requirements_json(const prep::PreparedScene& prepared,
                       const std::vector<std::vector<prep::Call>>& calls);
Json outcome_json(const Outcome& outcome, const PrepareCommand& command);
// For the manifest, which holds no times.
ManifestEntry manifest_entry(const Outcome& outcome, const PrepareCommand& command);
// Everything about the only file.
void print_details(const Outcome& outcome, const PrepareCommand& command, Console& console);
// What could not be kept of the errors that were asked for.
std::string unmet_text(const Outcome& outcome);
// The command that writes the same file without choosing.
std::string again_text(const Outcome& outcome, const PrepareCommand& command);
// One line of many.
void print_row(const Outcome& outcome, const PrepareCommand& command, Console& console);

}  // namespace meshprep
