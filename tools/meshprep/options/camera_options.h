// Where a camera stands, as command lines say it.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <variant>

#include "meshprep/options/option_set.h"

namespace meshprep {

// Where the camera stands: nothing (the file's, else a view that fits), a circle around the scene,
// or a camera of the file by name or number.
struct OrbitChoice {
    double azimuth = 30, elevation = 20, distance = 1;  // degrees; times the fitting distance
};
// A place to look from, and what at (unset: the scene's centre).
struct PlaceChoice {
    glm::dvec3 from{0, 0, 1};
    std::optional<glm::dvec3> at;
    glm::dvec3 up{0, 1, 0};
    bool up_given = false;
};
using CameraChoice = std::variant<std::monostate, OrbitChoice, std::string, PlaceChoice>;

struct CameraWishes {
    CameraChoice camera;
    std::optional<double> yfov;          // radians
    std::optional<double> ortho_height;  // world units; 0: the scene fits

    bool any() const { return camera.index() != 0 || yfov || ortho_height; }
};

// All but --up, which is of --look-from, what is returned.
Option add_camera_options(OptionSet& options, CameraWishes& camera);
void add_camera_up_option(OptionSet& options, CameraWishes& camera, const Option& from);
// What single options cannot see. Ends the parse with a usage error.
void check_camera(const CameraWishes& camera);

}  // namespace meshprep
