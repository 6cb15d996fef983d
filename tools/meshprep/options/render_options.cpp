#include "meshprep/options/render_options.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "meshprep/files/file_list.h"
#include "meshprep/files/render_outputs.h"
#include "meshprep/options/render_names.h"

namespace meshprep {
namespace {

void parse_size(const std::string& text, RenderCommand& c) {
    const std::vector<double> n = parse_numbers(text, 'x');
    if (n.size() != 2 || n[0] != std::floor(n[0]) || n[1] != std::floor(n[1]) ||
        std::min(n[0], n[1]) < 1 || std::max(n[0], n[1]) > rast::max_picture_extent)
        usage_error("--size", "'" + text + "' is not a size such as 1280x720, up to 32768x32768");
    c.size = glm::uvec2(static_cast<std::uint32_t>(n[0]), static_cast<std::uint32_t>(n[1]));
}

void parse_camera(const std::string& text, RenderCommand& c) {
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

void parse_lights(const std::vector<std::string>& texts, RenderCommand& c) {
    for (const std::string& text : texts) {
        const std::vector<double> n = parse_numbers(text, ',');
        if (n.size() < 2 || n.size() > 3 || (n.size() > 2 && n[2] < 0))
            usage_error("--light", "'" + text + "' is not AZIMUTH,ELEVATION[,INTENSITY]");
        c.lights.push_back({n[0], n[1], static_cast<float>(n.size() > 2 ? n[2] : 1.0)});
    }
}

glm::dvec3 parse_place(const std::string& option, const std::string& text) {
    const std::vector<double> n = parse_numbers(text, ',');
    if (n.size() != 3) usage_error(option, "'" + text + "' is not X,Y,Z");
    return {n[0], n[1], n[2]};
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
    std::istringstream in(text);
    std::string word, list;
    if (text.empty()) usage_error("--buffers", "names no buffer; 'all' is a choice");
    for (const auto& entry : buffer_words()) list += (list.empty() ? "" : ", ") + entry.first;
    while (std::getline(in, word, ',')) {
        bool known = false;
        for (const auto& [name, buffer] : buffer_words()) {
            if (word != name && word != "all") continue;
            known = true;
            if (std::find(c.buffers.begin(), c.buffers.end(), buffer) == c.buffers.end())
                c.buffers.push_back(buffer);
        }
        if (!known) usage_error("--buffers", "'" + word + "' is not one of " + list + ", all");
    }
}

void parse_ortho(const std::string& text, RenderCommand& c) {
    const std::vector<double> n = parse_numbers(text, ',');
    if (text != "fit" && (n.size() != 1 || !(n[0] > 0)))
        usage_error("--ortho", "'" + text + "' is not a height above 0 in world units, or fit");
    c.ortho_height = text == "fit" ? 0 : n[0];
}

void add_camera_options(CLI::App* sub, RenderCommand& c) {
    const std::string group = "Camera";
    CLI::Option* camera =
        sub->add_option_function<std::string>(
               "--camera", [&c](const std::string& text) { parse_camera(text, c); },
               "AZIMUTH,ELEVATION[,DISTANCE]: degrees around the scene, distance 1 fits it; or "
               "the name or number of a camera in the file. Default: the file's camera, else "
               "30,20")
            ->type_name("AZ,EL[,D]|NAME|N")
            ->group(group);
    CLI::Option* from = sub->add_option_function<std::string>(
                               "--look-from",
                               [&c](const std::string& text) {
                                   PlaceChoice place;
                                   place.from = parse_place("--look-from", text);
                                   c.camera = place;
                               },
                               "The camera's place in the world")
                            ->type_name("X,Y,Z")
                            ->group(group)
                            ->excludes(camera);
    const auto place = [&c]() -> PlaceChoice& {
        if (!std::holds_alternative<PlaceChoice>(c.camera)) c.camera = PlaceChoice{};
        return std::get<PlaceChoice>(c.camera);
    };
    // Read after --look-from, whatever their order on the command line: options are taken in the
    // order of their definition.
    sub->add_option_function<std::string>(
           "--look-at",
           [place](const std::string& text) { place().at = parse_place("--look-at", text); },
           "What it looks at (default: the scene's centre)")
        ->type_name("X,Y,Z")
        ->group(group)
        ->needs(from);
    sub->add_option_function<std::string>(
           "--up",
           [place](const std::string& text) {
               place().up = parse_place("--up", text);
               place().up_given = true;
           },
           "Which way is up in the picture (default 0,1,0)")
        ->type_name("X,Y,Z")
        ->group(group)
        ->needs(from);
    sub->add_option_function<double>(
           "--fov",
           [&c](double degrees) {
               if (!(degrees >= 0.01 && degrees <= 175))
                   usage_error("--fov", "not an angle from 0.01 to 175 degrees");
               c.yfov = degrees * std::numbers::pi / 180;
           },
           "Angle of view from the picture's bottom to its top")
        ->type_name("DEG")
        ->group(group);
    sub->add_option_function<std::string>(
           "--ortho", [&c](const std::string& text) { parse_ortho(text, c); },
           "No perspective: this height in world units fills the picture; fit: the scene does")
        ->type_name("HEIGHT|fit")
        ->group(group);
    sub->add_option("--turntable", c.turntable,
                    "N pictures from all around the scene, NAME_000.png and so on; or -o with a "
                    "pattern, as in name.%04d.png")
        ->check(CLI::Range(1, 10000))
        ->type_name("N")
        ->group(group);
}

void add_output_options(CLI::App* sub, RenderCommand& c) {
    const std::string group = "Outputs";
    sub->add_option_function<std::string>(
           "--size", [&c](const std::string& text) { parse_size(text, c); },
           "Pixels (default 1024x768)")
        ->type_name("WxH")
        ->group(group);
    sub->add_option_function<std::string>(
           "--crop", [&c](const std::string& text) { parse_crop(text, c); },
           "Only this part of the picture: column and row of its top left pixel, then its size. "
           "Parts join without a seam, bit for bit")
        ->type_name("X,Y,WxH")
        ->group(group);
    sub->add_option_function<std::string>(
           "--buffers", [&c](const std::string& text) { parse_buffers(text, c); },
           "Beside the picture, as NAME.BUFFER.exr: depth (Z along the view, and the depth "
           "buffer), id (triangle and node), normal, uv, barycentric, position; all")
        ->type_name("LIST")
        ->group(group);
    sub->add_option("--buffer-file", c.buffer_file, "The buffers in one EXR file instead")
        ->type_name("FILE")
        ->group(group);
    sub->add_flag_callback(
           "--no-overwrite", [&c] { c.overwrite = false; },
           "An output file that exists is an error instead of being replaced")
        ->group(group);
    sub->add_option_function<std::uint32_t>(
           "--band-memory", [&c](std::uint32_t mib) { c.band_bytes = std::uint64_t(mib) << 20; },
           "MiB of pixels held at a time (default 64); larger pictures are drawn and written in "
           "bands of rows")
        ->check(CLI::Range(1, 1 << 20))
        ->type_name("MIB")
        ->group(group);
}

}  // namespace

CLI::App* define_render(CLI::App& app, RenderCommand& c) {
    CLI::App* sub = app.add_subcommand("render", "Draw a scene or a mesh");
    sub->add_option("input", c.input, "A scene or mesh file")->required()->type_name("FILE");
    sub->add_option("-o,--output", c.output, "The picture: .png, .jpg, .exr and others")
        ->required()
        ->type_name("IMAGE");
    add_words<rast::Shading>(
        sub, "--shading", shading_words(), [&c](rast::Shading s) { c.shading = s; },
        "Shading frequency (default normal-mapped)");
    sub->add_option_function<std::vector<std::string>>(
           "--light", [&c](const std::vector<std::string>& texts) { parse_lights(texts, c); },
           "Instead of the file's lights: a directional one from this direction, in degrees seen "
           "from the camera (0,0 a headlight; 90,0 from the right); may be repeated")
        ->type_name("AZ,EL[,I]")
        ->expected(1)
        ->take_all();
    sub->add_option("--ambient", c.ambient, "Ambient light beside --light (default 0.1)")
        ->check(number_from_to(0, 100))
        ->type_name("I");
    sub->add_option_function<std::string>(
           "--background",
           [&c](const std::string& text) { c.background = parse_color("--background", text); },
           "#rrggbb, or linear R,G,B")
        ->type_name("COLOUR");
    add_words<rast::Cull>(
        sub, "--cull", cull_words(), [&c](rast::Cull v) { c.cull = v; },
        "Faces left out (default by-material: back faces, unless double-sided)");
    add_words<rast::TextureFilter>(
        sub, "--filter", filter_words(), [&c](rast::TextureFilter v) { c.filter = v; },
        "Texture filter (default sampler: as each texture's own sampler asks)");
    sub->add_option("--samples", c.samples, "Samples a pixel: 1 (default), 2, 4, 8 or 16")
        ->check(CLI::IsMember({1, 2, 4, 8, 16}))
        ->type_name("N");
    sub->add_option("--supersample", c.supersample,
                    "Each pixel is the mean of N x N finer ones, in linear light (default 1)")
        ->check(CLI::Range(1, rast::max_supersample))
        ->type_name("N");
    add_words<rast::Coverage>(
        sub, "--coverage", coverage_words(), [&c](rast::Coverage v) { c.coverage = v; },
        "What decides how much of a pixel a surface fills: samples (default), or the exact area "
        "that is seen of it (slow; for reference pictures)");
    add_words<rast::DepthFormat>(
        sub, "--depth",
        {{"float", rast::DepthFormat::float32},
         {"fixed24", rast::DepthFormat::fixed24},
         {"fixed16", rast::DepthFormat::fixed16}},
        [&c](rast::DepthFormat v) { c.depth_format = v; },
        "How depths are kept: reversed float (default), or fixed point, to see what it costs");
    sub->add_option("--max-anisotropy", c.max_anisotropy,
                    "1 to 16: probes of the anisotropic filter, longest ellipse of ewa (default 8)")
        ->check(CLI::Range(1, 16))
        ->type_name("N");
    add_words<bool>(
        sub, "--tone-map", {{"off", false}, {"reinhard", true}}, [&c](bool on) { c.tone_map = on; },
        "How light above 1 is shown (default off: clipped)");
    sub->add_option("--exposure", c.exposure, "Light is multiplied by this (default 1)")
        ->check(number_from_to(1e-6, 1e6))
        ->type_name("E");
    sub->add_flag_callback(
        "--no-textures", [&c] { c.textures = false; }, "Material colours only");
    sub->add_flag("--explain", c.explain, "Print the plan: each step, run or skipped, and why");
    add_camera_options(sub, c);
    add_output_options(sub, c);
    add_preparation_options(sub, c.prepare);
    add_common_options(sub, c.common);
    sub->footer(
        "Examples:\n"
        "  meshprep render spot.obj -o spot.png --shading phong --camera 40,15\n"
        "  meshprep render room.json -o room.png --explain\n"
        "  meshprep render rock.glb -o rock.exr --size 1920x1080 --light 45,30 --light=-60,10,0.3\n"
        "  meshprep render rock.glb -o rock.png --buffers depth,normal   rock.depth.exr, …\n"
        "  meshprep render rock.glb -o rock.png --look-from 3,2,5 --look-at 0,1,0 --fov 35\n"
        "  meshprep render part.stl -o part.png --camera 0,90 --ortho fit\n"
        "  meshprep render rock.glb -o truth.exr --coverage area         exact edges, slowly\n"
        "  meshprep render rock.glb -o fine.png --supersample 4 --filter anisotropic\n"
        "  meshprep render rock.glb -o turn.png --turntable 36           turn_000.png, …\n"
        "  meshprep render rock.glb -o wall.png --size 16384x16384       drawn in bands\n"
        "  meshprep render rock.glb -o part.png --size 8192x8192 --crop 4096,0,512x512");
    return sub;
}

void check_render(const RenderCommand& c) {
    if (!c.buffer_file.empty() && c.buffers.empty())
        usage_error("--buffer-file", "says where; give --buffers to say which");
    if (!c.buffer_file.empty() && lower_ending(c.buffer_file) != "exr")
        usage_error("--buffer-file",
                    "'" + c.buffer_file.filename().string() + "' holds no buffers; name it .exr");
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
    const std::string name = c.output.filename().string();
    if (c.tone_map.value_or(false) && keeps_float(c.output))
        usage_error("--tone-map", "'" + name + "' keeps linear light as it is; leave one of them");
    if (c.turntable == 0 && pattern_digits(name))
        usage_error("--output", "'" + name + "' numbers pictures; give --turntable N");
    if (c.turntable > 0 && !c.buffer_file.empty() &&
        !pattern_digits(c.buffer_file.filename().string()))
        usage_error("--buffer-file",
                    "needs a number in its name for --turntable, as in b.%04d.exr");
    if (c.coverage == rast::Coverage::area && c.samples.value_or(1) != 1)
        usage_error("--coverage", "area takes the place of --samples");
    if (const auto n = static_cast<std::uint32_t>(c.supersample.value_or(1));
        c.size && std::max(c.size->x, c.size->y) > rast::max_picture_extent / n)
        usage_error("--supersample", std::to_string(n) + " needs a --size of at most " +
                                         std::to_string(rast::max_picture_extent / n) +
                                         " pixels a side");
    if (c.crop && c.size &&
        (c.crop->x + c.crop->width > c.size->x || c.crop->y + c.crop->height > c.size->y))
        usage_error("--crop", "leaves the picture of --size");
}

}  // namespace meshprep
