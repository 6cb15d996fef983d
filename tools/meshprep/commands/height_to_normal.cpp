#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "meshprep/commands/subcommand.h"
#include "meshprep/files/file_list.h"
#include "meshprep/files/output_directories.h"
#include "meshprep/options/values.h"
#include "meshprep/output/load_options.h"
#include "meshprep/output/report_json.h"
#include "prep/displacement/sources.h"
#include "prep/image.h"

namespace meshprep {
namespace {

struct HeightToNormalCommand {
    CommonOptions common;
    std::filesystem::path input, output;
    prep::HeightToNormalOptions options;
    prep::Wrap wrap = prep::Wrap::repeat;
    int bits = 0;  // 0: as pixel_type() chooses
    bool replace = true;
};

using prep::Error;
using prep::ErrorCode;
using prep::Result;

constexpr double degrees = 180 / std::numbers::pi;

// By the ending and what was asked for. If nothing was, 16 bits, which hold more than the heights
// of most maps do; if the format has none, floats, then 8.
Result<prep::PixelType> pixel_type(const HeightToNormalCommand& command) {
    using prep::PixelType;
    if (auto writable = prep::check_writable_image(command.output); !writable)
        return writable.error();
    const std::string ending = lower_ending(command.output);
    if (ending == "hdr")
        return Error{ErrorCode::unsupported,
                     "the channels of .hdr pictures share an exponent, and have fewer than 8 bits "
                     "of a normal; use .png or .exr",
                     command.output.string()};
    std::string held;
    for (const auto& [bits, type] :
         {std::pair{16, PixelType::u16}, {32, PixelType::f32}, {8, PixelType::u8}}) {
        if (!prep::image_holds(command.output, type)) continue;
        if (command.bits == 0 || command.bits == bits) return type;
        held += (held.empty() ? "" : " or ") + std::to_string(bits);
    }
    return Error{ErrorCode::unsupported,
                 fmt::format("{} pictures have {} bits a channel here, not {}: leave --bits out, "
                             "or write another format",
                             ending, held, command.bits),
                 command.output.string()};
}

struct Slopes {
    double mean = 0, steepest = 0;  // degrees, of the picture's normals against straight up
};
Slopes slopes_of(const prep::Image& normals) {
    Slopes slopes;
    const std::size_t count = normals.pixels.size() / 3;
    for (std::size_t i = 0; i < count; ++i) {
        const float* const c = &normals.pixels[3 * i];
        const double across = std::hypot(2 * double(c[0]) - 1, 2 * double(c[1]) - 1);
        const double tilt = std::atan2(across, 2 * double(c[2]) - 1) * degrees;
        slopes.mean += tilt;
        slopes.steepest = std::max(slopes.steepest, tilt);
    }
    if (count > 0) slopes.mean /= double(count);
    return slopes;
}

// The least tilt above none that a step of 1/255 makes: from one texel to the one after the next.
double coarsest_tilt(const prep::Image& heights, const prep::HeightToNormalOptions& options) {
    const double step = std::abs(options.map.scale * options.strength) / 255 / 2;
    return std::atan(step * std::min(heights.width / options.uv_size.x,
                                     heights.height / options.uv_size.y)) *
           degrees;
}

Result<Json> convert(const HeightToNormalCommand& command, Console& console) {
    const Result<prep::PixelType> type = pixel_type(command);
    if (!type) return type.error();
    if (const Result<void> there = require_file(command.input); !there) return there.error();
    std::error_code ec;
    if (std::filesystem::equivalent(command.input, command.output, ec))
        return Error{ErrorCode::invalid, "the normal map would be written over the heights",
                     command.output.string()};
    if (!command.replace && std::filesystem::exists(command.output, ec))
        return Error{ErrorCode::io, "the file exists, and --no-overwrite was given",
                     command.output.string()};
    const prep::LoadOptions load = load_options(command.common, console);
    prep::ImageOptions reading;
    reading.channels = prep::ImageChannels::all;
    reading.reader_process = load.reader_process;
    reading.reader_log = load.reader_log;
    const Result<prep::Image> heights = prep::load_image(command.input, reading);
    if (!heights) return heights.error();
    prep::HeightToNormalOptions options = command.options;
    options.map.wrap_u = options.map.wrap_v = command.wrap;
    options.map.threads = command.common.threads;
    int height_bits = 0;
    const Result<prep::Image> normals = prep::height_to_normal(*heights, options, &height_bits);
    if (!normals) return Error{normals.error().code, normals.error().text, command.input.string()};
    OutputDirectories directories;
    if (const Result<void> made = directories.make_for(command.output); !made) return made.error();
    if (const Result<void> saved = prep::save_image(command.output, *normals, *type); !saved)
        return saved.error();
    const Slopes slopes = slopes_of(*normals);
    const int bits = *type == prep::PixelType::u8 ? 8 : *type == prep::PixelType::u16 ? 16 : 32;
    console.result(command.common,
                   fmt::format("{} → {}: {} × {}, {} bits; tilted by {:.3g}° in the mean, {:.3g}° "
                               "at most",
                               command.input.string(), command.output.string(), normals->width,
                               normals->height, bits, slopes.mean, slopes.steepest));
    Json json{{"width", normals->width},
              {"height", normals->height},
              {"bits", bits},
              {"mean_degrees", slopes.mean},
              {"steepest_degrees", slopes.steepest}};
    if (height_bits == 8) {
        const double coarsest = coarsest_tilt(*heights, options);
        console.warning(command.common,
                        fmt::format("{}: heights of 8 bits make slopes of steps: flat or at least "
                                    "{:.3g}° steep; save it with 16 bits or as floats",
                                    command.input.string(), coarsest));
        json["coarsest_degrees"] = coarsest;
    }
    return json;
}

int run(const HeightToNormalCommand& command, Console& console) {
    Json document = json_head("height-to-normal");
    document["input"] = command.input.string();
    document["output"] = command.output.string();
    const Result<Json> made = convert(command, console);
    if (made)
        document.update(*made);
    else
        document["error"] = to_json(made.error());
    if (!made) console.error(made.error());
    if (command.common.json) console.json(json_text(document));
    return made ? exit_done : exit_failed;
}

void define(OptionSet& options, HeightToNormalCommand& c) {
    options.path("heights", c.input, "HEIGHTS", "A height map: PNG, EXR, TIFF, …; read linearly")
        .required();
    options
        .path("-o,--output", c.output, "IMAGE",
              "The tangent-space normal map, as large; its ending says the format")
        .required();
    options.value(
        "--size", "WIDTH[,HEIGHT]",
        [&c](const std::string& text) {
            const std::vector<double> n = parse_numbers(text, ',');
            if (n.empty() || n.size() > 2 || !std::all_of(n.begin(), n.end(), [](double x) {
                    return x > 0 && std::isfinite(x);
                }))
                usage_error("--size", "'" + text + "' is not one or two lengths over 0");
            c.options.uv_size = {n[0], n.back()};
        },
        "What the picture covers on the surface, in the units of heights (default 1,1): slopes are "
        "heights over lengths");
    options.value(
        "--height-scale", "LENGTH",
        [&c](const std::string& text) {
            c.options.map.scale = parse_number("--height-scale", text);
        },
        "Height of a white texel over a black one (default 1)");
    options.number("--height-channel", c.options.map.channel, 0, 31, "N",
                   "Which channel holds heights (default 0, the first)");
    options.value(
        "--strength", "FACTOR",
        [&c](const std::string& text) { c.options.strength = parse_number("--strength", text); },
        "Slopes times this (default 1)");
    options.flag("--flip-green", c.options.flip_green,
                 "Green points down (DirectX) instead of up (glTF, OpenGL)");
    options.word(
        "--wrap", {"repeat", "mirror", "clamp"},
        [&c](const std::string& word) { c.wrap = prep::enum_named<prep::Wrap>(word).value(); },
        "What lies beyond the picture's border: the other side (default), itself turned over, or "
        "its last texels");
    options.one_of("--bits", c.bits, {8, 16, 32}, "N",
                   "Of each channel (default: 16 for PNG and TIFF, 32 for EXR, 8 for others)");
    options.flag("--no-overwrite", c.replace,
                 "An output file that exists is an error instead of being replaced", false);
    add_common_options(options, c.common);
    options.examples(
        "  meshprep height-to-normal bricks.exr -o bricks-normal.png --size 2,2 --height-scale "
        "0.05\n"
        "  meshprep height-to-normal bricks.png -o bricks-normal.png --strength 2 --flip-green "
        "--bits 8");
}

}  // namespace

Subcommand height_to_normal_subcommand() {
    return subcommand<HeightToNormalCommand>(
        "height-to-normal", "A tangent-space normal map of a height map", define, run);
}

}  // namespace meshprep
