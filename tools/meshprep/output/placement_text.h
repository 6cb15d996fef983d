// How a file's numbers became metres with y up.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "prep/scene.h"

namespace meshprep {

// One line; empty where nothing was scaled or turned and the file says nothing of its unit.
std::string placement_text(const prep::Placement& placement);

nlohmann::ordered_json to_json(const prep::Placement& placement);

}  // namespace meshprep
