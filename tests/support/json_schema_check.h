// JSON held against a JSON Schema, of which the subset that docs/schema uses is known: type, const,
// enum, properties, required, additionalProperties, items, minItems, minimum, maximum, anyOf and
// $ref into $defs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace test {

// What is wrong with `value`, each with its place as a JSON pointer; of anyOf's branches, what is
// wrong by the nearest. A keyword that is not known is a complaint, too.
std::vector<std::string> schema_complaints(const nlohmann::json& value,
                                           const nlohmann::json& schema);

}  // namespace test
