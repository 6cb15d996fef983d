// What a sheet is of.
#pragma once

#include <optional>
#include <string>

#include "prep/prepared_scene.h"
#include "sheets/surfaces/displacement_views.h"

namespace report {

// What is drawn on one sheet: a scene of its own, changed while drawing.
struct Subject {
    std::string name;
    prep::PreparedScene scene;
    std::optional<DisplacementViews> beside = {};  // of displaced scenes
};

// The whole scene, or one mesh alone under the transform of its first instance.
Subject whole_subject(const prep::PreparedScene& prepared, std::string name);
Subject mesh_subject(const prep::PreparedScene& prepared, std::uint32_t mesh);

}  // namespace report
