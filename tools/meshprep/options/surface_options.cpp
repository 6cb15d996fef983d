// Options of what takes a mesh's place: subdivision surfaces, and triangles as fine as an error
// asks.
#include <fmt/format.h>

#include <cmath>

#include "meshprep/options/shared_options.h"
#include "meshprep/options/values.h"

namespace meshprep {
namespace {

template <class E>
std::vector<std::string> words_of() {
    std::vector<std::string> words;
    for (const auto& entry : names_of(E{})) words.emplace_back(entry.name);
    return words;
}

// "catmark", "loop:3".
void parse_subdivide(const std::string& text, prep::SubdivideOptions& to) {
    const std::size_t colon = text.find(':');
    const auto scheme = prep::enum_named<prep::SubdivisionScheme>(text.substr(0, colon));
    if (!scheme)
        usage_error("--subdivide", "'" + text.substr(0, colon) +
                                       "' is no scheme; there are catmark, loop and bilinear");
    to.scheme = *scheme;
    if (colon == std::string::npos) return;
    const std::vector<double> level = parse_numbers(text.substr(colon + 1), ',');
    if (level.size() != 1 || level[0] != std::floor(level[0]) || !(level[0] >= 0) ||
        level[0] > prep::max_subdivision_level)
        usage_error("--subdivide",
                    fmt::format("'{}' is no level from 0 to {}", text.substr(colon + 1),
                                prep::max_subdivision_level));
    to.level = int(level[0]);
}

void add_subdivision_options(OptionSet& options, prep::PrepareOptions& p) {
    options.group("Subdivision");
    prep::SubdivideOptions& s = p.subdivision;
    const Option subdivide = options.value(
        "--subdivide", "SCHEME[:LEVEL]",
        [&p](const std::string& text) {
            parse_subdivide(text, p.subdivision);
            p.subdivide = true;
        },
        "Meshes are cages: catmark, loop or bilinear surfaces take their place, refined LEVEL "
        "times "
        "(default 2), every point and normal on the limit surface");
    options.flag("--control-points", s.control_points, "The refined cage's points instead")
        .needs(subdivide);
    options
        .word(
            "--subdivide-boundary", words_of<prep::BoundaryRule>(),
            [&s](const std::string& word) {
                s.boundary = prep::enum_named<prep::BoundaryRule>(word).value();
            },
            "Borders: none (faces there are left out), edge-and-corner or edge-only creases "
            "(default: what the file says, else edge-and-corner)")
        .needs(subdivide);
    options
        .word(
            "--face-varying", words_of<prep::FaceVaryingRule>(),
            [&s](const std::string& word) {
                s.face_varying = prep::enum_named<prep::FaceVaryingRule>(word).value();
            },
            "Where UVs are linear rather than smooth, OpenSubdiv's six rules (default: what the "
            "file says, else corners-only)")
        .needs(subdivide);
    options
        .named("--creasing", s.creasing, "How sharpness wears off along creases (default uniform)")
        .needs(subdivide);
    options
        .flag("--smooth-triangles", s.smooth_triangles,
              "catmark: edges between triangles get the weights of Stam and Loop (2003), which "
              "leave fewer dents")
        .needs(subdivide);
    options
        .word(
            "--crease-from", {"hard-edges"},
            [&p](const std::string&) { p.crease_hard_edges = true; },
            "Edges that angle, smoothing groups or marks call hard are infinitely sharp creases")
        .needs(subdivide);
    options
        .flag("--quads", p.recover_quads,
              "First make quads of the pairs of triangles that fit no other neighbour as well")
        .needs(subdivide);
    options
        .number("--max-influences", s.max_influences, 1, 64, "N",
                "Joints that move a refined vertex (default: as many sets of four as the file "
                "has); the largest share that was dropped is told")
        .needs(subdivide);
}

// What every option that asks for a tessellation begins with. Options of a refinement level by
// level, which are read before these, would do nothing beside it.
void take_tessellation(const std::string& option, const Option& subdivide,
                       prep::PrepareOptions& p) {
    const prep::SubdivideOptions plain, &s = p.subdivision;
    const bool has_level = subdivide.given().find(':') != std::string::npos;
    const char* const other = has_level                                  ? "a level of --subdivide"
                              : s.control_points                         ? "--control-points"
                              : s.face_varying.has_value()               ? "--face-varying"
                              : s.max_influences != plain.max_influences ? "--max-influences"
                                                                         : nullptr;
    if (other)
        usage_error(option, std::string("cannot stand beside ") + other +
                                ", which is for cages that are refined level by level; its "
                                "triangles are cut from the limit surface, as fine as is asked");
    p.tessellate = true;
}

// "200000", "200k", "1.5M".
std::uint64_t parse_count(const std::string& option, const std::string& text) {
    std::string digits = text;
    double unit = 1;
    if (text.ends_with('k'))
        unit = 1e3;
    else if (text.ends_with('M'))
        unit = 1e6;
    if (unit != 1) digits.pop_back();
    const std::vector<double> numbers = parse_numbers(digits, ',');
    constexpr double most = 1e9;
    if (numbers.size() != 1 || !(numbers[0] * unit >= 1 && numbers[0] * unit <= most))
        usage_error(option, "'" + text + "' is not a number from 1 to 1000M, as in 20000 or 200k");
    return std::uint64_t(numbers[0] * unit);
}

// Options are read in the order in which they are added: what --displace says is known here.
void require_map(const std::string& option, const prep::DisplaceOptions& d) {
    if (d.noise && !d.map && !d.from_materials)
        usage_error(option, "says how a map is read, and --displace noise reads none");
}

// Options of noise make it, with a map for all as well.
void add_noise_options(OptionSet& options, prep::DisplaceOptions& d, const Option& displace) {
    const auto noise = [&d]() -> prep::NoiseOptions& {
        if (d.from_materials)
            usage_error("--noise",
                        "and its other options move all faces, alone or with one map for all: "
                        "noise is not added to the maps of --displace materials");
        if (!d.noise) d.noise.emplace();
        return *d.noise;
    };
    options
        .word(
            "--noise", words_of<prep::NoiseKind>(),
            [noise](const std::string& word) {
                noise().kind = prep::enum_named<prep::NoiseKind>(word).value();
            },
            "The kind of --displace noise: perlin (default) or simplex; it is added to a map's "
            "heights. Its height is --noise-scale times a value between about -1 and 1")
        .needs(displace);
    const auto number = [&](const char* name, const char* type, double prep::NoiseOptions::*member,
                            const char* help) {
        options
            .value(
                name, type,
                [noise, member, name](const std::string& text) {
                    noise().*member = parse_number(name, text);
                },
                help)
            .needs(displace);
    };
    number("--noise-scale", "LENGTH", &prep::NoiseOptions::scale,
           "In the mesh's units (default 1)");
    number("--noise-frequency", "F", &prep::NoiseOptions::frequency,
           "Cells of the noise in a unit of length (default 1)");
    options
        .value(
            "--noise-octaves", "N[,LACUNARITY[,GAIN]]",
            [noise](const std::string& text) {
                const std::vector<double> n = parse_numbers(text, ',');
                constexpr double most = 32;
                if (n.empty() || n.size() > 3 || n[0] != std::floor(n[0]) || !(n[0] >= 1) ||
                    n[0] > most)
                    usage_error("--noise-octaves",
                                "'" + text +
                                    "' is not a number of octaves from 1 to 32, as in 6 "
                                    "or 6,2,0.5");
                noise().octaves = int(n[0]);
                if (n.size() > 1) noise().lacunarity = n[1];
                if (n.size() > 2) noise().gain = n[2];
            },
            "So many copies are added, each LACUNARITY times finer (default 2) and GAIN times as "
            "high (default 0.5) as the one before (default 1)")
        .needs(displace);
    options
        .value(
            "--noise-seed", "N",
            [noise](const std::string& text) {
                const std::vector<double> n = parse_numbers(text, ',');
                constexpr double most = 4294967295.0;
                if (n.size() != 1 || n[0] != std::floor(n[0]) || !(n[0] >= 0 && n[0] <= most))
                    usage_error("--noise-seed",
                                "'" + text + "' is not a number from 0 to 2^32 - 1");
                noise().seed = std::uint32_t(n[0]);
            },
            "Another noise (default 0)")
        .needs(displace);
}

void add_residual_options(OptionSet& options, const Option& subdivide, prep::PrepareOptions& p) {
    prep::DisplaceOptions& d = p.displacement;
    const Option residual = options.value(
        "--residual-normal-map", "SIZE",
        [&p, &d, subdivide](const std::string& text) {
            const std::vector<double> n = parse_numbers(text, ',');
            if (n.size() != 1 || n[0] != std::floor(n[0]) ||
                !(n[0] >= 1 && n[0] <= double(prep::max_residual_size)))
                usage_error("--residual-normal-map",
                            fmt::format("'{}' is not a number of texels from 1 to {}", text,
                                        prep::max_residual_size));
            take_tessellation("--residual-normal-map", subdivide, p);
            if (!d.residual) d.residual.emplace();
            d.residual->size = std::uint32_t(n[0]);
        },
        "What the triangles do not carry of the surface becomes a tangent-space normal map of SIZE "
        "by SIZE texels in each material that is tessellated, written with the mesh");
    options
        .word(
            "--residual-bits", {"8", "16"},
            [&d](const std::string& word) {
                if (!d.residual) d.residual.emplace();
                d.residual->bits = word == "8" ? 8 : 16;
            },
            "Of each channel of these maps (default 16)")
        .needs(residual);
}

// How the texels of a map become heights.
void add_height_options(OptionSet& options, prep::DisplaceOptions& d, const Option& displace) {
    const auto height = [&](const char* name, const char* type, double& to, const char* help) {
        options
            .value(
                name, type,
                [&d, &to, name](const std::string& text) {
                    require_map(name, d);
                    to = parse_number(name, text);
                },
                help)
            .needs(displace);
    };
    height(
        "--height-scale", "LENGTH", d.heights.scale,
        "Height of a white texel over a black one, in the mesh's units (default 1); a material's "
        "own is multiplied by it");
    options
        .value(
            "--height-midlevel", "VALUE",
            [&d](const std::string& text) {
                require_map("--height-midlevel", d);
                d.midlevel = parse_number("--height-midlevel", text);
            },
            "The texel that moves nothing (default: the material's; of --displace FILE 0.5, but 0 "
            "for vectors in a file of floats; in files of 8 and 16 bits the code nearest to it)")
        .needs(displace);
    options
        .named("--height-filter", d.heights.filter,
               "Between texels: bilinear (default) or bicubic, whose slopes are continuous")
        .needs(displace)
        .when_given([&d] { require_map("--height-filter", d); });
    options
        .number("--height-channel", d.heights.channel, 0, 3, "N",
                "Which channel of the map holds heights (default 0, the first)")
        .needs(displace)
        .when_given([&d] { require_map("--height-channel", d); });
}

// What the texels of a map are: heights or vectors, and along what.
void add_vector_options(OptionSet& options, prep::DisplaceOptions& d, const Option& displace) {
    options
        .word(
            "--displace-kind", words_of<prep::DisplacementKind>(),
            [&d](const std::string& word) {
                if (!d.map && (d.noise || d.from_materials))
                    usage_error("--displace-kind",
                                "says what the map of --displace FILE holds; materials say it of "
                                "their own maps, noise has none");
                d.kind = prep::enum_named<prep::DisplacementKind>(word).value();
            },
            "What the map holds: heights along the normal (default), or vectors in its first three "
            "channels, times --height-scale: along the tangent, the normal and the bitangent, or "
            "x, y, z of the mesh's own space")
        .needs(displace);
    options
        .word(
            "--displace-axes",
            {std::string(name_of(prep::VectorAxes::tangent_normal_bitangent)),
             std::string(name_of(prep::VectorAxes::tangent_bitangent_normal))},
            [&d](const std::string& word) {
                require_map("--displace-axes", d);
                if (d.map && d.kind != prep::DisplacementKind::vector_tangent)
                    usage_error("--displace-axes",
                                "orders the channels of --displace-kind vector-tangent");
                d.axes = prep::enum_named<prep::VectorAxes>(word).value();
            },
            "What the channels of vector-tangent maps are along: tangent-normal-bitangent "
            "(default: "
            "green is up, as Blender has it) or tangent-bitangent-normal (blue is up, as in normal "
            "maps)")
        .needs(displace);
}

void add_displacement_options(OptionSet& options, prep::PrepareOptions& p) {
    options.group("Displacement");
    prep::DisplaceOptions& d = p.displacement;
    const Option subdivide = options.added("--subdivide");
    const Option displace = options.value(
        "--displace", "FILE|materials|noise",
        [&p, &d, subdivide](const std::string& text) {
            take_tessellation("--displace", subdivide, p);
            if (text == "materials") {
                d.from_materials = true;
                return;
            }
            if (text == "noise") {
                if (!d.noise) d.noise.emplace();
                return;
            }
            std::error_code ec;
            if (!std::filesystem::is_regular_file(text, ec))
                usage_error("--displace",
                            "'" + text + "' is neither a file nor 'materials' nor 'noise'");
            d.map.emplace();
            d.map->path = text;
            d.map->name = d.map->path.filename().string();
        },
        "The surface (of polygons, or with --subdivide of the cage) is moved along its normals by "
        "this height map, by each material's displacement map, or by noise, and cut into triangles "
        "as fine as the options below ask");
    add_height_options(options, d, displace);
    add_vector_options(options, d, displace);
    add_noise_options(options, d, displace);
    options
        .value(
            "--band-limit", "LENGTH",
            [&d](const std::string& text) {
                d.band_limit = parse_number("--band-limit", text, true);
            },
            "Leaves out of heights, vectors and noise what samples of the surface so far apart "
            "cannot carry, in the mesh's units: with few triangles coarse waves instead of what "
            "fine ones happen to be at their corners. Errors are measured against what is left; "
            "--residual-normal-map has all of it")
        .needs(displace);
}

void add_tessellation_options(OptionSet& options, prep::PrepareOptions& p) {
    const Option subdivide = options.added("--subdivide");
    options.group("Tessellation");
    prep::TessellateOptions& t = p.tessellation;
    const auto length = [&](const char* name, std::optional<double>& to, const char* help) {
        options.value(
            name, "LENGTH",
            [&p, &to, name, subdivide](const std::string& text) {
                take_tessellation(name, subdivide, p);
                to = parse_number(name, text, true);
            },
            help);
    };
    length("--chord-error", t.chord_error,
           "Triangles nowhere further than this from the surface, in the mesh's units; proved, and "
           "told. With --displace and none of these: a thousandth of the mesh's diagonal, at most "
           "1M triangles");
    length("--edge-length", t.edge_length, "No edge is longer, in the mesh's units");
    options.value(
        "--max-triangles", "N",
        [&p, &t, subdivide](const std::string& text) {
            take_tessellation("--max-triangles", subdivide, p);
            t.max_triangles = parse_count("--max-triangles", text);
        },
        "At most so many in a mesh, spent where the error is largest (20000, 200k, 1.5M); one a "
        "triangle and two a quad there are in any case");
    add_residual_options(options, subdivide, p);
}

}  // namespace

void add_surface_options(OptionSet& options, prep::PrepareOptions& p) {
    add_subdivision_options(options, p);
    add_displacement_options(options, p);
    add_tessellation_options(options, p);
}

Option add_pixel_error_option(OptionSet& options, prep::PrepareOptions& p) {
    options.group("Tessellation");
    return options.value(
        "--pixel-error", "PIXELS",
        [&p, subdivide = options.added("--subdivide")](const std::string& text) {
            take_tessellation("--pixel-error", subdivide, p);
            p.tessellation.pixel_error = parse_number("--pixel-error", text, true);
        },
        "In the picture that the camera takes, triangles nowhere further than this from the "
        "surface; what it does not show stays coarse");
}

}  // namespace meshprep
