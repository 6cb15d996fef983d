#include "meshprep/options/camera_options.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "meshprep/options/values.h"

namespace meshprep {
namespace {

void parse_camera(const std::string& text, CameraWishes& c) {
    const std::vector<double> n = parse_numbers(text, ',');
    if (n.size() < 2) {
        c.camera = text;
        return;
    }
    const OrbitChoice orbit{n[0], n[1], n.size() > 2 ? n[2] : 1.0};
    if (n.size() > 3 || std::abs(orbit.elevation) > 90 || orbit.distance <= 0)
        usage_error("--camera", "'" + text +
                                    "' is not AZIMUTH,ELEVATION[,DISTANCE] with an elevation from "
                                    "-90 to 90 and a distance above 0");
    c.camera = orbit;
}

glm::dvec3 parse_place(const std::string& option, const std::string& text) {
    const std::vector<double> n = parse_numbers(text, ',');
    if (n.size() != 3) usage_error(option, "'" + text + "' is not X,Y,Z");
    return {n[0], n[1], n[2]};
}

void parse_ortho(const std::string& text, CameraWishes& c) {
    const std::vector<double> n = parse_numbers(text, ',');
    if (text != "fit" && (n.size() != 1 || !(n[0] > 0)))
        usage_error("--ortho", "'" + text + "' is not a height above 0 in world units, or fit");
    c.ortho_height = text == "fit" ? 0 : n[0];
}

PlaceChoice& place_of(CameraWishes& c) {
    if (!std::holds_alternative<PlaceChoice>(c.camera)) c.camera = PlaceChoice{};
    return std::get<PlaceChoice>(c.camera);
}

}  // namespace

Option add_camera_options(OptionSet& options, CameraWishes& c) {
    const Option camera = options.value(
        "--camera", "AZ,EL[,D]|NAME|N", [&c](const std::string& text) { parse_camera(text, c); },
        "AZIMUTH,ELEVATION[,DISTANCE]: degrees around the scene, distance 1 fits it; or "
        "the name or number of a camera in the file. Default: the file's camera, else "
        "30,20");
    const Option from = options
                            .value(
                                "--look-from", "X,Y,Z",
                                [&c](const std::string& text) {
                                    PlaceChoice place;
                                    place.from = parse_place("--look-from", text);
                                    c.camera = place;
                                },
                                "The camera's place in the world")
                            .excludes(camera);
    // Read after --look-from, whatever their order on the command line: options are taken in the
    // order of their definition.
    options
        .value(
            "--look-at", "X,Y,Z",
            [&c](const std::string& text) { place_of(c).at = parse_place("--look-at", text); },
            "What it looks at (default: the scene's centre)")
        .needs(from);
    options.value(
        "--fov", "DEG",
        [&c](const std::string& text) {
            const std::vector<double> degrees = parse_numbers(text, ',');
            if (degrees.size() != 1 || !(degrees[0] >= 0.01 && degrees[0] <= 179))
                usage_error("--fov", "not an angle from 0.01 to 179 degrees");
            c.yfov = degrees[0] * std::numbers::pi / 180;
        },
        "Angle of view from the picture's bottom to its top");
    options.value(
        "--ortho", "HEIGHT|fit", [&c](const std::string& text) { parse_ortho(text, c); },
        "No perspective: this height in world units fills the picture; fit: the scene does");
    return from;
}

void add_camera_up_option(OptionSet& options, CameraWishes& c, const Option& from) {
    options
        .value(
            "--up", "X,Y,Z",
            [&c](const std::string& text) {
                // As long as it may be; zero stays zero.
                const glm::dvec3 up = parse_place("--up", text);
                const double longest = std::max({std::abs(up.x), std::abs(up.y), std::abs(up.z)});
                place_of(c).up = longest > 0 ? up / longest : up;
                place_of(c).up_given = true;
            },
            "Which way is up in the picture (default 0,1,0)")
        .needs(from);
}

void check_camera(const CameraWishes& c) {
    const auto* const place = std::get_if<PlaceChoice>(&c.camera);
    if (place && place->at && *place->at == place->from)
        usage_error("--look-at", "is where the camera stands");
    if (place && place->up_given) {
        const glm::dvec3& up = place->up;
        if (!(glm::length(up) > 0)) usage_error("--up", "has no length; choose a direction");
        const glm::dvec3 view = place->at ? *place->at - place->from : glm::dvec3(0);
        if (place->at &&
            !(glm::length(glm::cross(view, up)) > 1e-9 * glm::length(view) * glm::length(up)))
            usage_error("--up", "points along the view; choose another");
    }
    if (c.yfov && c.ortho_height)
        usage_error("--fov", "is an angle of perspective; --ortho has none, give one of them");
}

}  // namespace meshprep
