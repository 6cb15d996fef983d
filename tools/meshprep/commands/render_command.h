// The options of `meshprep render`.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "meshprep/files/render_outputs.h"
#include "meshprep/options/camera_options.h"
#include "meshprep/options/option_set.h"
#include "meshprep/options/shared_options.h"
#include "rast/render.h"

namespace meshprep {

// What `--light` gives: a direction from which light comes, seen from the camera, in degrees.
struct LightChoice {
    double azimuth = 0, elevation = 0;
    float intensity = 1;
};

struct RenderCommand : CameraWishes {
    CommonOptions common;
    std::filesystem::path input, output;
    std::string format;  // of a picture on standard output
    bool explain = false;
    prep::RenderWishes wishes;
    std::uint32_t turntable = 0;  // pictures around the scene; 0: one, as it stands
    std::optional<rast::Crop> crop;
    std::vector<Buffer> buffers;
    std::filesystem::path buffer_file;  // all of them in one file; empty: a file each
    bool overwrite = true;
    std::vector<LightChoice> lights;
    std::optional<float> ambient;
    std::uint32_t band_mib = 64;
    bool textures = true;
    std::optional<double> image_error;  // levels: the sampling is chosen by it
    std::optional<double> budget_ms;    // to draw in: the same
    bool cost_cache = true;             // whether measured costs are kept, and read
    Settings settings;                  // what was given, for the command that is printed
    prep::PrepareOptions prepare;
};

void define_render(OptionSet& options, RenderCommand& command);
// What single options cannot see. Ends the parse with a usage error.
void check_render(const RenderCommand& command);

}  // namespace meshprep
