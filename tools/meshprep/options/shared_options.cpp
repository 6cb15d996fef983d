#include "meshprep/options/shared_options.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace meshprep {

void usage_error(const std::string& option, const std::string& text) {
    throw CLI::ValidationError(option, text);
}

std::vector<double> parse_numbers(const std::string& text, char separator) {
    std::vector<double> numbers;
    std::istringstream in(text);
    std::string item;
    while (std::getline(in, item, separator)) {
        char* end = nullptr;
        const double value = std::strtod(item.c_str(), &end);
        if (item.empty() || *end != '\0' || !std::isfinite(value)) return {};
        numbers.push_back(value);
    }
    if (!text.empty() && text.back() == separator) return {};
    return numbers;
}

glm::vec3 parse_color(const std::string& option, const std::string& text) {
    const auto linear = [](long level) {
        const double c = static_cast<double>(level & 255) / 255.0;
        return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    };
    if (text.size() == 7 && text[0] == '#' &&
        text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos) {
        const long value = std::strtol(text.c_str() + 1, nullptr, 16);
        return {linear(value >> 16), linear(value >> 8), linear(value)};
    }
    std::vector<double> numbers = parse_numbers(text, ',');
    if (numbers.size() == 1) numbers.assign(3, numbers[0]);
    if (numbers.size() != 3)
        usage_error(option, "'" + text +
                                "' is not a colour; give #rrggbb, or linear R,G,B such as 1,0.5,0");
    for (const double n : numbers)
        if (n < 0 || n > 1000)
            usage_error(option, "'" + text + "' has a component outside 0 to 1000");
    return {numbers[0], numbers[1], numbers[2]};
}

CLI::Validator number_from_to(double least, double most) {
    return CLI::Validator(
        [least, most](std::string& text) -> std::string {
            const std::vector<double> numbers = parse_numbers(text, ',');
            if (numbers.size() == 1 && numbers[0] >= least && numbers[0] <= most) return {};
            std::ostringstream message;
            message << "'" << text << "' is not a number from " << least << " to " << most;
            return message.str();
        },
        "");
}

void add_common_options(CLI::App* app, CommonOptions& common) {
    const std::string group = "Common";
    app->add_flag("--json", common.json, "Results as JSON on standard output")->group(group);
    app->add_flag("-q,--quiet", common.quiet, "No results in words, no progress; errors still show")
        ->group(group);
    app->add_option("--threads", common.threads,
                    "Threads to use; 0: all cores. Results do not depend on it")
        ->check(CLI::Range(0, 4096))
        ->type_name("N")
        ->group(group);
}

namespace {

void parse_hard_angle(const std::string& text, prep::HardEdgeOptions& hard) {
    if (text == "auto") {
        hard.angle_degrees = prep::HardEdgeOptions{}.angle_degrees;
        return;
    }
    if (text == "off") {
        hard.angle_degrees.reset();
        return;
    }
    const std::vector<double> numbers = parse_numbers(text, ',');
    if (numbers.size() != 1 || numbers[0] < 0 || numbers[0] > 180)
        usage_error("--hard-angle",
                    "'" + text + "' is not an angle from 0 to 180 degrees, off or auto");
    hard.angle_degrees = numbers[0];
}

void parse_hard_borders(const std::string& text, prep::HardEdgeOptions& hard) {
    std::istringstream in(text);
    std::string word;
    while (std::getline(in, word, ',')) {
        if (word == "uv")
            hard.uv_borders = true;
        else if (word == "material")
            hard.material_borders = true;
        else
            usage_error("--hard-borders", "'" + word + "' is not one of uv, material");
    }
}

// "weld=1e-5,degenerate,holes=50", or "all": everything but welding, which joins what only touches.
void parse_repair(const std::string& text, prep::RepairOptions& repair) {
    constexpr std::uint32_t default_hole_edges = 100;
    if (text.empty()) usage_error("--repair", "names nothing to mend; 'all' is a choice");
    std::istringstream in(text);
    std::string word;
    while (std::getline(in, word, ',')) {
        const std::size_t equals = word.find('=');
        const std::string name = word.substr(0, equals);
        const bool valued = equals != std::string::npos;
        const std::vector<double> value =
            valued ? parse_numbers(word.substr(equals + 1), ',') : std::vector<double>{};
        const bool known_value = name == "weld" || name == "holes";
        if (valued && (!known_value || value.size() != 1 || value[0] < 0))
            usage_error("--repair", "'" + word +
                                        "': only weld=DISTANCE and holes=EDGES take a value, "
                                        "not negative");
        if (valued && name == "holes" && !(value[0] >= 3 && value[0] <= 1000))
            usage_error("--repair", "'" + word + "': holes of 3 to 1000 edges can be filled");
        const bool all = name == "all";
        if (name == "weld") repair.weld_tolerance = valued ? value[0] : 0;
        if (all || name == "degenerate") repair.degenerate_faces = true;
        if (all || name == "duplicates") repair.duplicate_faces = true;
        if (all || name == "edges") repair.non_manifold_edges = true;
        if (all || name == "vertices") repair.non_manifold_vertices = true;
        if (all || name == "orientation") repair.orientation = true;
        if (all || name == "outward") repair.outward = true;
        if (all || name == "holes")
            repair.hole_edges = valued ? static_cast<std::uint32_t>(value[0]) : default_hole_edges;
        if (all || name == "isolated") repair.isolated_vertices = true;
        static constexpr std::string_view names[] = {
            "all",      "weld",        "degenerate", "duplicates", "edges",
            "vertices", "orientation", "outward",    "holes",      "isolated"};
        if (std::find(std::begin(names), std::end(names), name) == std::end(names))
            usage_error("--repair",
                        "'" + name +
                            "' is not one of weld[=DISTANCE], degenerate, "
                            "duplicates, edges, vertices, orientation, holes[=EDGES], outward, "
                            "isolated, all");
    }
}

void set_tangents(const std::string& word, prep::PrepareOptions& p) {
    using Level = prep::Request::Level;
    p.request.tangents = word == "auto"   ? Level::as_called_for
                         : word == "none" ? Level::never
                                          : Level::always;
    p.tangent.mode = word == "mikktspace-exact" ? prep::TangentMode::mikktspace_exact
                                                : prep::TangentMode::mikktspace;
}

}  // namespace

void add_preparation_options(CLI::App* app, prep::PrepareOptions& p) {
    using prep::Authored;
    const std::string group = "Preparation";
    const Words<Authored> authored = {
        {"keep", Authored::keep}, {"replace", Authored::replace}, {"repair", Authored::repair}};
    add_words<Authored>(
        app, "--normals", authored, [&p](Authored a) { p.normals = a; },
        "The file's own normals: keep (default; computed where there are none), replace, or repair "
        "those that are zero, not finite, not unit or against their face")
        ->group(group);
    add_words<prep::NormalWeight>(
        app, "--weight",
        {{"area", prep::NormalWeight::area},
         {"uniform", prep::NormalWeight::uniform},
         {"angle", prep::NormalWeight::angle},
         {"area-angle", prep::NormalWeight::area_angle},
         {"edge-length", prep::NormalWeight::edge_length}},
        [&p](prep::NormalWeight w) { p.normal.weight = w; },
        "What a face counts for in a corner's normal (default area)")
        ->group(group);
    add_words<prep::Precision>(
        app, "--precision",
        {{"fast", prep::Precision::fast},
         {"accurate", prep::Precision::accurate},
         {"exact", prep::Precision::exact}},
        [&p](prep::Precision v) { p.normal.precision = v; },
        "Arithmetic of normals: float, compensated double (default) or exact rationals (slow)")
        ->group(group);
    app->add_option_function<std::string>(
           "--repair", [&p](const std::string& text) { parse_repair(text, p.repair); },
           "Mends before anything else, with a log: weld[=DISTANCE] (default 0: equal positions), "
           "degenerate faces, duplicates, non-manifold edges and vertices, orientation, "
           "holes[=EDGES] (of at most 100), outward, isolated vertices; all: these but weld")
        ->type_name("LIST")
        ->group(group);
    app->add_option_function<std::string>(
           "--hard-angle", [&p](const std::string& text) { parse_hard_angle(text, p.hard_edges); },
           "Edges that turn by more than this many degrees are hard; auto: 60, off: none is")
        ->type_name("DEG|off|auto")
        ->group(group);
    add_words<bool>(
        app, "--smoothing-groups", {{"on", true}, {"off", false}},
        [&p](bool on) { p.hard_edges.smoothing_groups = on; },
        "Whether the file's smoothing groups decide instead of the angle (default on)")
        ->group(group);
    app->add_option_function<std::string>(
           "--hard-borders",
           [&p](const std::string& text) { parse_hard_borders(text, p.hard_edges); },
           "Also hard: edges where UVs or materials meet")
        ->type_name("uv,material")
        ->group(group);
    Words<std::string> modes;
    for (const char* mode : {"auto", "mikktspace", "mikktspace-exact", "none"})
        modes.emplace_back(mode, mode);
    add_words<std::string>(
        app, "--tangents", modes, [&p](const std::string& word) { set_tangents(word, p); },
        "auto (default): where a material has a normal map; mikktspace: wherever there are UVs; "
        "mikktspace-exact: every bit of the C reference, its zeros included; none")
        ->group(group);
    app->add_option_function<double>(
           "--tangent-angle",
           [&p](double degrees) {
               if (!(degrees >= 0 && degrees <= 180))
                   usage_error("--tangent-angle", "not an angle from 0 to 180 degrees");
               p.tangent.angular_threshold = degrees * std::numbers::pi / 180;
           },
           "Gradients that differ by more than this many degrees are not averaged (default 180, as "
           "bakers have it)")
        ->type_name("DEG")
        ->group(group);
    add_words<Authored>(
        app, "--authored-tangents", authored, [&p](Authored a) { p.tangents = a; },
        "The file's own tangents: keep (default), replace, or repair the bad ones")
        ->group(group);
    add_words<prep::WeldMode>(
        app, "--weld",
        {{"auto", prep::WeldMode::automatic},
         {"none", prep::WeldMode::none},
         {"exact", prep::WeldMode::exact}},
        [&p](prep::WeldMode w) { p.weld = w; },
        "Whether equal positions are one point for adjacency; auto (default): where the file "
        "repeats vertices at seams")
        ->group(group);
}

}  // namespace meshprep
