#include <algorithm>
#include <cmath>
#include <numbers>

#include "meshprep/commands/render_command.h"
#include "meshprep/files/file_list.h"
#include "meshprep/options/values.h"

namespace meshprep {
namespace {

void parse_light(const std::string& text, RenderCommand& c) {
    constexpr double most = 1e9;  // as in scene files
    const std::vector<double> n = parse_numbers(text, ',');
    if (n.size() < 2 || n.size() > 3 || (n.size() > 2 && !(n[2] >= 0 && n[2] <= most)))
        usage_error("--light", "'" + text +
                                   "' is not AZIMUTH,ELEVATION[,INTENSITY] with an intensity from "
                                   "0 to 1e9");
    c.lights.push_back({n[0], n[1], static_cast<float>(n.size() > 2 ? n[2] : 1.0)});
}

void parse_crop(const std::string& text, RenderCommand& c) {
    const auto extent = text.find(',', text.find(',') + 1);
    const std::vector<double> at = parse_numbers(text.substr(0, extent), ',');
    const std::vector<double> size = extent == std::string::npos
                                         ? std::vector<double>{}
                                         : parse_numbers(text.substr(extent + 1), 'x');
    bool good = at.size() == 2 && size.size() == 2;
    for (const auto* numbers : {&at, &size})
        for (const double n : *numbers)
            good = good && n == std::floor(n) && n >= 0 && n <= rast::max_picture_extent;
    if (!good || size[0] < 1 || size[1] < 1)
        usage_error("--crop", "'" + text +
                                  "' is not X,Y,WxH: the first column and row, then the size in "
                                  "pixels of the whole picture");
    c.crop = rast::Crop{std::uint32_t(at[0]), std::uint32_t(at[1]), std::uint32_t(size[0]),
                        std::uint32_t(size[1])};
}

void parse_buffers(const std::string& text, RenderCommand& c) {
    if (text.empty()) usage_error("--buffers", "names no buffer; 'all' is a choice");
    for (const std::string& word : parse_list(text)) {
        bool known = false;
        for (const auto& [name, buffer] : names_of(Buffer{})) {
            if (word != name && word != "all") continue;
            known = true;
            if (std::find(c.buffers.begin(), c.buffers.end(), buffer) == c.buffers.end())
                c.buffers.push_back(buffer);
        }
        if (!known)
            usage_error("--buffers",
                        "'" + word + "' is not one of " + prep::names_text<Buffer>(", ") + ", all");
    }
}

void add_output_options(OptionSet& options, RenderCommand& c) {
    options.group("Outputs");
    options.value(
        "--format", "ENDING", [&c](const std::string& text) { c.format = text; },
        "Of a picture on standard output, as in png or exr");
    options.value(
        "--crop", "X,Y,WxH", [&c](const std::string& text) { parse_crop(text, c); },
        "Only this part of the picture: column and row of its top left pixel, then its size. "
        "Parts join without a seam, bit for bit");
    options.value(
        "--buffers", "LIST", [&c](const std::string& text) { parse_buffers(text, c); },
        "Beside the picture, as NAME.BUFFER.exr: depth (Z along the view, and the depth "
        "buffer), id (triangle and node), normal, uv, barycentric, position; all");
    options.path("--buffer-file", c.buffer_file, "FILE", "The buffers in one EXR file instead");
    options.flag("--no-overwrite", c.overwrite,
                 "An output file that exists is an error instead of being replaced", false);
    options.number("--band-memory", c.band_mib, 1, 1 << 20, "MIB",
                   "MiB of pixels held at a time (default 64); larger pictures are drawn and "
                   "written in bands of rows");
}

}  // namespace

void define_render(OptionSet& options, RenderCommand& c) {
    options
        .path("input", c.input, "FILE",
              "A scene or mesh file, .gz or .zip too, or - for standard input")
        .required();
    options
        .path("-o,--output", c.output, "IMAGE",
              "The picture: .png, .jpg, .exr and others, or - for standard output")
        .required();
    add_render_choices(options, c.wishes);
    options.not_negative(
        "--image-error", c.image_error, "LEVELS",
        "The cheapest --samples or --supersample whose picture is within so many levels of 8 bits "
        "(RMSE), measured; exit 1 with the best found where none is");
    options.not_negative(
        "--budget-ms", c.budget_ms, "MS",
        "The --samples or --supersample with the least error of edges that is predicted to draw "
        "within so many milliseconds, as smaller pictures drawn with it say; exit 1 with the "
        "fastest where none is");
    options.flag("--no-cache", c.cost_cache,
                 "Measure the costs for --budget-ms anew, and keep none", false);
    options.values(
        "--light", "AZ,EL[,I]", [&c](const std::string& text) { parse_light(text, c); },
        "Instead of the file's lights: a directional one from this direction, in degrees seen "
        "from the camera (0,0 a headlight; 90,0 from the right); may be repeated");
    options.number("--ambient", c.ambient, 0, 100, "I",
                   "Ambient light beside --light (default 0.1); without --light it replaces the "
                   "file's");
    options.flag("--no-textures", c.textures, "Material colours only", false);
    options.flag("--explain", c.explain,
                 "Print the plan: each step, run or skipped, why, and what it cost");
    options.group("Camera");
    add_camera_up_option(options, c, add_camera_options(options, c));
    options.number("--turntable", c.turntable, 1, 10000, "N",
                   "N pictures from all around the scene, NAME_000.png and so on; or -o with a "
                   "pattern, as in name.%04d.png");
    add_output_options(options, c);
    add_input_options(options, c.common);
    add_preparation_options(options, c.prepare);
    add_pixel_error_option(options, c.prepare);
    add_loading_options(options, c.common.load);
    add_common_options(options, c.common);
    options.keep_settings(c.settings, {"--output", "--image-error", "--budget-ms", "--no-cache",
                                       "--explain", "--no-overwrite"});
    options.examples(
        "  meshprep render spot.obj -o spot.png --shading phong --camera 40,15\n"
        "  meshprep render room.json -o room.png --explain\n"
        "  meshprep render rock.glb -o rock.exr --size 1920x1080 --light 45,30 --light=-60,10,0.3\n"
        "  meshprep render rock.glb -o rock.png --buffers depth,normal   rock.depth.exr, …\n"
        "  meshprep render rock.glb -o rock.png --look-from 3,2,5 --look-at 0,1,0 --fov 35\n"
        "  meshprep render part.stl -o part.png --camera 0,90 --ortho fit\n"
        "  meshprep render rock.glb -o truth.exr --coverage area         exact edges, slowly\n"
        "  meshprep render rock.glb -o fine.png --supersample 4 --filter anisotropic\n"
        "  meshprep render rock.glb -o rock.png --image-error 2          as fine as that takes\n"
        "  meshprep render rock.glb -o rock.png --budget-ms 40           as fine as fits\n"
        "  meshprep render rock.glb -o turn.png --turntable 36           turn_000.png, …\n"
        "  meshprep render rock.glb -o wall.png --size 16384x16384       drawn in bands\n"
        "  meshprep render rock.glb -o part.png --size 8192x8192 --crop 4096,0,512x512");
}

void check_render(const RenderCommand& c) {
    const prep::RenderChoices& choices = c.wishes.choices;
    if (!c.buffer_file.empty() && c.buffers.empty())
        usage_error("--buffer-file", "says where; give --buffers to say which");
    if (!c.buffer_file.empty() && lower_ending(c.buffer_file) != "exr")
        usage_error("--buffer-file",
                    "'" + c.buffer_file.filename().string() + "' holds no buffers; name it .exr");
    check_camera(c);
    if (c.image_error && c.budget_ms)
        usage_error("--budget-ms", "and --image-error both choose the sampling; leave one out");
    if (!c.cost_cache && !c.budget_ms)
        usage_error("--no-cache", "is about the costs that --budget-ms reads; it is not given");
    if (c.image_error || c.budget_ms)
        for (const char* const chosen : {"samples", "supersample", "coverage"})
            if (c.wishes.has(chosen))
                usage_error(c.image_error ? "--image-error" : "--budget-ms",
                            std::string("chooses --") + chosen + "; leave one of them out");
    const std::string name = c.output.filename().string();
    if (const bool stream = is_standard_stream(c.output); stream || !c.format.empty()) {
        if (!stream) usage_error("--format", "is for -o -; the picture's ending says it otherwise");
        if (c.format.empty())
            usage_error("--format",
                        "is missing; standard output has no ending, as in --format png");
        if (c.common.json)
            usage_error("--output", "- takes standard output, and so does JSON; leave one out");
        if (c.turntable > 0 || !c.buffers.empty())
            usage_error("--output", "- takes one picture; --turntable and --buffers make several");
    }
    if (choices.tone_map == prep::ToneMap::reinhard && keeps_float(c.output))
        usage_error("--tone-map", "'" + name + "' keeps linear light as it is; leave one of them");
    if (c.turntable == 0 && pattern_digits(name))
        usage_error("--output", "'" + name + "' numbers pictures; give --turntable N");
    if (c.turntable > 0 && !c.buffer_file.empty() &&
        !pattern_digits(c.buffer_file.filename().string()))
        usage_error("--buffer-file",
                    "needs a number in its name for --turntable, as in b.%04d.exr");
    if (choices.coverage == prep::Coverage::area && choices.samples != 1)
        usage_error("--coverage", "area takes the place of --samples");
    if (!c.wishes.has("size")) return;
    const std::uint32_t most =
        prep::max_picture_extent / static_cast<std::uint32_t>(choices.supersample);
    if (std::max(choices.width, choices.height) > most)
        usage_error("--supersample", std::to_string(choices.supersample) +
                                         " needs a --size of at most " + std::to_string(most) +
                                         " pixels a side");
    if (c.crop &&
        (c.crop->x + c.crop->width > choices.width || c.crop->y + c.crop->height > choices.height))
        usage_error("--crop", "leaves the picture of --size");
}

}  // namespace meshprep
