#include "meshprep/options/shared_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "meshprep/options/values.h"
#include "prep/formats.h"
#include "text/suggestions.h"

namespace meshprep {
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
    for (const std::string& word : parse_list(text)) {
        if (word == "uv")
            hard.uv_borders = true;
        else if (word == "material")
            hard.material_borders = true;
        else
            usage_error("--hard-borders", "'" + word + "' is not one of uv, material");
    }
}

constexpr std::pair<std::string_view, bool prep::RepairOptions::*> repair_choices[] = {
    {"degenerate", &prep::RepairOptions::degenerate_faces},
    {"duplicates", &prep::RepairOptions::duplicate_faces},
    {"edges", &prep::RepairOptions::non_manifold_edges},
    {"vertices", &prep::RepairOptions::non_manifold_vertices},
    {"orientation", &prep::RepairOptions::orientation},
    {"outward", &prep::RepairOptions::outward},
    {"isolated", &prep::RepairOptions::isolated_vertices},
};

// "weld=1e-5,degenerate,holes=50", or "all": everything but welding, which joins what only touches.
void parse_repair(const std::string& text, prep::RepairOptions& repair) {
    constexpr std::uint32_t default_hole_edges = 100;
    if (text.empty()) usage_error("--repair", "names nothing to mend; 'all' is a choice");
    for (const std::string& word : parse_list(text)) {
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
        if (valued && name == "holes" &&
            !(value[0] >= 3 && value[0] <= 1000 && value[0] == std::floor(value[0])))
            usage_error("--repair", "'" + word + "': holes of 3 to 1000 edges can be filled");
        const bool all = name == "all";
        bool known = all || name == "weld" || name == "holes";
        if (name == "weld") repair.weld_tolerance = valued ? value[0] : 0;
        if (all || name == "holes")
            repair.hole_edges = valued ? static_cast<std::uint32_t>(value[0]) : default_hole_edges;
        for (const auto& [choice_name, choice] : repair_choices)
            if (all || name == choice_name) known = repair.*choice = true;
        if (!known)
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

// "max_anisotropy" → "--max-anisotropy".
std::string option_name(std::string_view key) {
    std::string name = "--" + std::string(key);
    std::replace(name.begin(), name.end(), '_', '-');
    return name;
}

// Adds the option of one choice, whose values are of the last parameter's kind.
struct ChoiceOption {
    OptionSet& options;
    prep::RenderChoices& to;
    const std::string name;
    const char* const help;

    template <class E>
    Option add(E prep::RenderChoices::*member, const prep::Named&) const {
        return options.named(name, to.*member, help);
    }
    Option add(int prep::RenderChoices::*member, const prep::Range& range) const {
        return options.number(name, to.*member, int(range.least), int(range.greatest), "N", help);
    }
    Option add(float prep::RenderChoices::*member, const prep::Range& range) const {
        return options.number(name, to.*member, range.least, range.greatest, "X", help);
    }
    Option add(float prep::RenderChoices::*member, const prep::RangeOrAuto& range) const {
        return options.value(
            name, "X|auto",
            [&out = to.*member, range, option = name](const std::string& text) {
                if (text == "auto") {
                    out = 0;
                    return;
                }
                const std::vector<double> n = parse_numbers(text, ',');
                if (n.size() != 1 || !(n[0] >= range.least && n[0] <= range.greatest))
                    usage_error(option,
                                fmt::format("'{}' is neither auto nor a number from {} to {}", text,
                                            range.least, range.greatest));
                out = static_cast<float>(n[0]);
            },
            help);
    }
    Option add(int prep::RenderChoices::*member, const prep::OneOf& offered) const {
        return options.one_of(name, to.*member, offered.values, "N", help);
    }
    Option add(glm::vec3 prep::RenderChoices::*member, const prep::Linear&) const {
        return options.value(
            name, "COLOUR",
            [&out = to.*member, option = name](const std::string& text) {
                out = parse_color(option, text);
            },
            help);
    }
    using Extent = std::uint32_t prep::RenderChoices::*;
    Option add(std::pair<Extent, Extent> extent, const prep::Pixels& pixels) const {
        return options.value(
            name, "WxH",
            [&width = to.*extent.first, &height = to.*extent.second, pixels,
             option = name](const std::string& text) {
                const glm::uvec2 size = parse_size(option, text, pixels.greatest);
                width = size.x;
                height = size.y;
            },
            help);
    }
};

}  // namespace

void add_common_options(OptionSet& options, CommonOptions& common) {
    options.group("Common");
    options.flag("--json", common.json, "Results as JSON on standard output");
    options.flag("-q,--quiet", common.quiet, "No results in words, no progress; errors still show");
    options.number("--threads", common.threads, 0, 4096, "N",
                   "Threads to use; 0: all cores. Results do not depend on it");
    options.flag("-v,--verbose", common.verbose,
                 "Also what the readers of other libraries (Assimp) print, on standard error");
    // Both make the process anew, which starts nothing before a file needs it.
    const auto limits = std::make_shared<prep::ReaderProcessOptions>();
    const auto limit = [&options, &common, limits](const std::string& name, const char* type,
                                                   double least, double most, auto set,
                                                   const char* help) {
        options.value(
            name, type,
            [=, &common](const std::string& text) {
                const std::vector<double> n = parse_numbers(text, ',');
                if (n.size() != 1 || !(n[0] == 0 || (n[0] >= least && n[0] <= most)))
                    usage_error(name, fmt::format("'{}' is neither 0 nor a number from {} to {}",
                                                  text, least, most));
                set(*limits, n[0]);
                common.reader_process = std::make_shared<prep::ReaderProcess>(*limits);
            },
            help);
    };
    limit(
        "--reader-seconds", "S", 0.1, 1e6,
        [](prep::ReaderProcessOptions& to, double seconds) { to.seconds = seconds; },
        "Processor time that the reader of another library may take for a file, and four times as "
        "much by the clock (default 120; 0: any)");
    limit(
        "--reader-memory", "MIB", 256, 1e6,
        [](prep::ReaderProcessOptions& to, double mebibytes) {
            to.memory = std::uint64_t(mebibytes * double(1 << 20));
        },
        "MiB of memory that it may take (default 8192; 0: any)");
}

void add_json_lines_option(OptionSet& options, CommonOptions& common) {
    options.group("Common");
    options.flag("--json-lines", common.json_lines,
                 "Results as JSON, a line for each file as soon as it is done, a summary last");
}

void add_input_options(OptionSet& options, CommonOptions& common) {
    options.value(
        "--input-format", "ENDING",
        [&common](const std::string& text) {
            const std::string ending = text.starts_with(".") ? text.substr(1) : text;
            std::vector<std::string> known;
            for (const prep::FileFormat& format : prep::file_formats())
                for (const std::string_view other : format.endings)
                    known.emplace_back(other.substr(1));
            if (std::find(known.begin(), known.end(), ending) == known.end()) {
                const std::string near = prep::detail::nearest_name(ending, known);
                usage_error("--input-format",
                            "'" + text + "' is no ending of a file that is read" +
                                (near.empty() ? ", such as glb, obj or fbx"
                                              : "; did you mean '" + near + "'?"));
            }
            common.input_format = ending;
        },
        "Inputs are of this format whatever their ending, as in fbx; needed for - (standard input) "
        "where the first bytes do not tell");
}

void add_reading_options(OptionSet& options, prep::LoadOptions& load) {
    options.group("Reading");
    options.values(
        "--texture-dir", "DIR",
        [&load](const std::string& text) {
            std::error_code ec;
            if (!std::filesystem::is_directory(text, ec))
                usage_error("--texture-dir", "'" + text + "' is no directory");
            load.texture_directories.emplace_back(text);
        },
        "Where pictures are sought that are neither where the file says nor beside it; repeatable");
    options.named("--transparency", load.transparency,
                  "Files whose materials are all wholly transparent: auto (default) makes them "
                  "opaque, with a warning; file: as it says");
}

void add_loading_options(OptionSet& options, prep::LoadOptions& load) {
    add_reading_options(options, load);
    options.texts(
        "--allow-extension", load.allowed_extensions, "NAME|all",
        "Carry this glTF extension though a file requires it and it is not known or may no "
        "longer fit");
}

void add_preparation_options(OptionSet& options, prep::PrepareOptions& p) {
    add_surface_options(options, p);
    options.group("Preparation");
    options.named(
        "--normals", p.normals,
        "The file's own normals: keep (default; computed where there are none), replace, or repair "
        "those that are zero, not finite, not unit or against their face");
    options.named("--weight", p.normal.weight,
                  "What a face counts for in a corner's normal (default area)");
    options.named(
        "--precision", p.normal.precision,
        "Arithmetic of normals: float, compensated double (default) or exact rationals (slow)");
    options.value(
        "--repair", "LIST", [&p](const std::string& text) { parse_repair(text, p.repair); },
        "Mends before anything else, with a log: weld[=DISTANCE] (default 0: equal positions), "
        "degenerate faces, duplicates, non-manifold edges and vertices, orientation, "
        "holes[=EDGES] (of at most 100), outward, isolated vertices; all: these but weld");
    options.value(
        "--hard-angle", "DEG|off|auto",
        [&p](const std::string& text) { parse_hard_angle(text, p.hard_edges); },
        "Edges that turn by more than this many degrees are hard; auto: 60, off: none is");
    options.word(
        "--smoothing-groups", {"on", "off"},
        [&p](const std::string& word) { p.hard_edges.smoothing_groups = word == "on"; },
        "Whether the file's smoothing groups decide instead of the angle (default on)");
    options.value(
        "--hard-borders", "uv,material",
        [&p](const std::string& text) { parse_hard_borders(text, p.hard_edges); },
        "Also hard: edges where UVs or materials meet");
    options.word(
        "--tangents", {"auto", "mikktspace", "mikktspace-exact", "none"},
        [&p](const std::string& word) { set_tangents(word, p); },
        "auto (default): where a material has a normal map; mikktspace: wherever there are UVs; "
        "mikktspace-exact: every bit of the C reference, its zeros included; none");
    options.value(
        "--tangent-angle", "DEG",
        [&p](const std::string& text) {
            const std::vector<double> degrees = parse_numbers(text, ',');
            if (degrees.size() != 1 || !(degrees[0] >= 0 && degrees[0] <= 180))
                usage_error("--tangent-angle", "not an angle from 0 to 180 degrees");
            p.tangent.angular_threshold = degrees[0] * std::numbers::pi / 180;
        },
        "Gradients that differ by more than this many degrees are not averaged (default 180, as "
        "bakers have it)");
    options.named("--authored-tangents", p.tangents,
                  "The file's own tangents: keep (default), replace, or repair the bad ones");
    options.named(
        "--weld", p.weld,
        "Whether equal positions are one point for adjacency; auto (default): where the file "
        "repeats vertices at seams");
}

void add_render_choices(OptionSet& options, prep::RenderWishes& wishes) {
    prep::for_each_render_choice(
        [&](std::string_view key, auto member, const auto& values, const char* help) {
            ChoiceOption{options, wishes.choices, option_name(key), help}
                .add(member, values)
                .when_given([&given = wishes.given, key] { given.insert(key); });
        });
}

}  // namespace meshprep
