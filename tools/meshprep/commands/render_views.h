// Where the pictures of `meshprep render` are taken from.
#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include "meshprep/commands/render_command.h"
#include "prep/prepared_scene.h"
#include "prep/scene_json.h"
#include "rast/view.h"

namespace meshprep {

constexpr double radians_per_degree = std::numbers::pi / 180;

// One view, or those of the turntable; unset: the renderer's choice. `orbit`: the scene file's.
// Errors: invalid (no such camera).
prep::Result<std::vector<std::optional<rast::View>>> views_of(
    const RenderCommand& command, const std::optional<prep::OrbitCamera>& orbit,
    const prep::PreparedScene& prepared, double aspect);

}  // namespace meshprep
