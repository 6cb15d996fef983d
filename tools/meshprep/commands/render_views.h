// Where pictures are taken from.
#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include "meshprep/options/camera_options.h"
#include "prep/prepared_scene.h"
#include "prep/scene_json.h"
#include "rast/view.h"

namespace meshprep {

constexpr double radians_per_degree = std::numbers::pi / 180;

struct ViewChoices {
    const CameraWishes& camera;
    std::uint32_t turntable = 0;             // views from all around; 0: one
    std::optional<prep::OrbitCamera> orbit;  // the scene file's
};

// One view, or those of the turntable; unset: the renderer's choice. Errors: invalid (no such
// camera).
prep::Result<std::vector<std::optional<rast::View>>> views_of(const ViewChoices& choices,
                                                              const prep::PreparedScene& prepared,
                                                              double aspect);

// The views, before the scene is prepared, that pixel errors are meant in: of the scene as it was
// read, and with near planes that what is moved towards them does not cross soon; those of the
// file's cameras are their own.
prep::Result<std::vector<rast::View>> screen_views(const ViewChoices& choices,
                                                   const prep::Scene& scene, double aspect);
std::vector<prep::ScreenMetric> screen_metrics(const std::vector<rast::View>& views,
                                               std::uint32_t width, std::uint32_t height);
// The same views of the scene that was prepared: depths of orthographic ones, which reach as far as
// the scene, are its.
std::vector<std::optional<rast::View>> drawn_views(const std::vector<rast::View>& views,
                                                   const ViewChoices& choices,
                                                   const prep::PreparedScene& prepared,
                                                   double aspect);

}  // namespace meshprep
