// The JSON forms that several subcommands print.
#pragma once

#include <nlohmann/json.hpp>

#include "meshprep/output/console.h"
#include "prep/findings.h"
#include "prep/prepared_scene.h"
#include "prep/result.h"

namespace meshprep {

using Json = nlohmann::ordered_json;

// {"code": "syntax", "text": …, "place": …}, always these three: the place may be empty.
Json to_json(const prep::Error& error);
Json to_json(const prep::Finding& finding, const prep::Scene& scene);
// `memory`: page faults and peaks too, which differ from run to run.
Json to_json(const prep::StageReport& stage, bool memory);
Json to_json(const prep::Reason& why, const prep::Scene& scene);
Json to_json(const prep::RepairStep& repair);
Json to_json(const prep::SplitCounts& splits);
// Numbers that are not finite are null.
Json to_json(const prep::TessellationCertificate& certificate);
Json to_json(const prep::OrderChange& order);
Json to_json(const prep::ResidualMap& map, const std::string& material_name);

// The document's head: command and version.
Json json_head(const char* command);
// Strings from files may hold bytes that are not UTF-8: they are replaced, never an error.
std::string json_text(const Json& json);
// The same in one line.
std::string json_line(const Json& json);

}  // namespace meshprep
