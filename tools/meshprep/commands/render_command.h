// The options of `meshprep render`.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "meshprep/files/render_outputs.h"
#include "meshprep/options/shared_options.h"
#include "rast/render.h"

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

// What `--light` gives: a direction from which light comes, seen from the camera, in degrees.
struct LightChoice {
    double azimuth = 0, elevation = 0;
    float intensity = 1;
};

struct RenderCommand {
    CommonOptions common;
    std::filesystem::path input, output;
    std::string format;  // of a picture on standard output
    bool explain = false;
    prep::RenderWishes wishes;
    CameraChoice camera;
    std::optional<double> yfov;          // radians
    std::optional<double> ortho_height;  // world units; 0: the scene fits
    std::uint32_t turntable = 0;         // pictures around the scene; 0: one, as it stands
    std::optional<rast::Crop> crop;
    std::vector<Buffer> buffers;
    std::filesystem::path buffer_file;  // all of them in one file; empty: a file each
    bool overwrite = true;
    std::vector<LightChoice> lights;
    std::optional<float> ambient;
    std::uint32_t band_mib = 64;
    bool textures = true;
    prep::PrepareOptions prepare;
};

void define_render(OptionSet& options, RenderCommand& command);
// What single options cannot see. Ends the parse with a usage error.
void check_render(const RenderCommand& command);

}  // namespace meshprep
