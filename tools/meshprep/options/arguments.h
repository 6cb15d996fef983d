// The command line, read into one options struct per subcommand.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "prep/prepare.h"
#include "prep/save.h"
#include "rast/render.h"

namespace meshprep {

enum ExitCode : int { exit_done = 0, exit_failed = 1, exit_usage = 2 };

struct CommonOptions {
    bool json = false;   // machine-readable results on stdout
    bool quiet = false;  // no results in words, no progress; errors still go to stderr
    int threads = 0;     // 0: all cores
};

struct PrepareCommand {
    CommonOptions common;
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path output;
    bool in_place = false;
    bool recursive = false;
    bool overwrite = true;
    bool explain = false;
    std::string format;  // of files in an output directory; empty: glb
    prep::PrepareOptions prepare;
    prep::SaveOptions save;
};

struct InspectCommand {
    CommonOptions common;
    std::vector<std::filesystem::path> inputs;
    bool strict = false;
    bool selftest = false;     // instead of inputs
    std::uint32_t places = 4;  // shown per finding
};

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

// What can be written beside the colours, at each pixel's first sample.
enum class Buffer : std::uint8_t { depth, id, normal, uv, barycentric, position };

// What `--light` gives: a direction from which light comes, seen from the camera, in degrees.
struct LightChoice {
    double azimuth = 0, elevation = 0;
    float intensity = 1;
};

struct RenderCommand {
    CommonOptions common;
    std::filesystem::path input, output;
    bool explain = false;
    std::optional<glm::uvec2> size;
    std::optional<rast::Shading> shading;
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
    std::optional<glm::vec3> background;  // linear
    std::optional<rast::Cull> cull;
    std::optional<rast::TextureFilter> filter;
    std::optional<int> max_anisotropy, samples, supersample;
    std::optional<rast::Coverage> coverage;
    rast::DepthFormat depth_format = rast::DepthFormat::float32;
    std::optional<std::uint64_t> band_bytes;
    std::optional<bool> tone_map;
    std::optional<float> exposure;
    bool textures = true;
    prep::PrepareOptions prepare;
};

struct ValidateCommand {
    CommonOptions common;
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path output;
    std::vector<std::string> meshes;  // names or numbers; none: all
    OrbitChoice camera;               // its distance is not used: each mesh is framed
    std::uint32_t panel = 480;        // pixels, each picture's width and height
    std::uint32_t max_meshes = 64;
    prep::PrepareOptions prepare;
};

struct DiffCommand {
    CommonOptions common;
    std::filesystem::path a, b;
    bool tangents = false, normals = false;  // neither: what both files have
    std::filesystem::path heat_map;          // written when set
    std::optional<double> tolerance;         // degrees (meshes) or RMSE (pictures): above it exit 1
};

using Command =
    std::variant<PrepareCommand, InspectCommand, RenderCommand, ValidateCommand, DiffCommand>;

// A command to run, or the exit code of what was already said (help, version, a usage error).
struct Arguments {
    std::optional<Command> command;
    int exit_code = exit_done;
    std::string out;  // to stdout: help, version
    std::string err;  // to stderr: the usage error
};

Arguments parse_arguments(int argc, const char* const* argv);

}  // namespace meshprep
