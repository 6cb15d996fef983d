// What is done at the visible points of a draw: a list of stages in their order, and where the
// values lie that pass from one to another.
//
// Values lie in planes, a float per point each. Planes are assigned by liveness: a value takes its
// planes when the first stage writes it and gives them back when the last one has read it. What no
// stage reads has none: it is neither interpolated nor stored, and maps of which nothing is read
// are not sampled.
#pragma once

#include <array>
#include <bitset>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "plan/draw_choice.h"
#include "prep/material.h"

namespace rast::detail {

using prep::MapKind;

// Kinds of maps that are drawn, the first of prep::material_maps.
inline constexpr std::size_t drawn_maps = [] {
    std::size_t count = 0;
    for (const prep::MaterialMap& map : prep::material_maps)
        count += map.use != prep::MapUse::not_drawn;
    return count;
}();

// What is known of a point while it is shaded.
enum class PointValue : std::uint8_t {
    id,            // of its triangle
    normal,        // as it is interpolated, then unit
    tangent,       // and the sign of the bitangent
    uv_gradients,  // of the bump map's u and v over the triangle, mesh axes
    color,         // of the vertices
    position,      // from the eye
    vertex_light,  // Gouraud: diffuse and specular
    weights,       // of the second and the third corner
    uv,
    light,        // sums over the lights
    gloss,        // the same of highlights
    eye,          // towards it, and how long that is
    angle,        // of one light: cosine to the normal; squared cosine of the half vector
    half,         // its squared sine; squared length of both vectors
    exponent,     // logarithm of the highlight
    coordinates,  // UV and its derivatives, of each place
    texels = coordinates + drawn_maps,  // of each kind of map
    count = texels + drawn_maps
};
inline constexpr std::size_t point_values = std::size_t(PointValue::count);
constexpr PointValue coordinates_of(std::size_t place) {
    return PointValue(std::size_t(PointValue::coordinates) + place);
}
constexpr PointValue texels_of(MapKind kind) {
    return PointValue(std::size_t(PointValue::texels) + std::size_t(kind));
}
// How many planes it takes.
constexpr std::size_t planes_of(PointValue value) {
    constexpr std::uint8_t planes[] = {1, 3, 4, 6, 3, 3, 6, 2, 2, 3, 3, 4, 2, 2, 1};
    static_assert(sizeof planes == std::size_t(PointValue::coordinates));
    if (value >= PointValue::texels) return 3;
    if (value >= PointValue::coordinates) return 6;
    return planes[std::size_t(value)];
}
// Of all values at once: no assignment takes more.
inline constexpr std::size_t most_planes = [] {
    std::size_t sum = 0;
    for (std::size_t v = 0; v < point_values; ++v) sum += planes_of(PointValue(v));
    return sum;
}();

enum class StageKind : std::uint8_t {
    interpolation,  // what the vertices have, at the points
    maps,           // texels of some maps on the same texels
    normals,        // as they are lit
    eye,            // the direction to it
    light,          // what one light sends, and the angles of its highlight
    matte_light,    // the same without highlights
    exponents,      // logarithms of one light's highlights
    gloss,          // the sum of highlights up to one light's
    color,          // what is reflected
    attributes,     // what is kept beside colours
    count
};
inline constexpr std::size_t stage_kinds = std::size_t(StageKind::count);
// What counts points names all of those that colours go through.
static_assert(shade_stages == std::size_t(StageKind::attributes));

struct Stage {
    StageKind kind = StageKind::color;
    std::uint32_t begin = 0, end = 0;  // light: its number; maps: of ShadeDraw::used
    friend bool operator==(const Stage&, const Stage&) = default;
};

// What the points of a draw are asked for.
struct StageRequest {
    bool color = true;  // else attributes:
    bool normals = false, uvs = false, weights = false, positions = false;
    // Of the draw.
    NormalSource source = NormalSource::interpolated;
    bool unlit = false, highlights = true, metallic_roughness = false, glows = false;
    bool vertex_light = false, vertex_colors = false;
    bool in_full = false;  // nothing is left out
    struct Map {           // as ShadeDraw::used lists them
        MapKind kind = {};
        std::uint8_t place = 0;
        bool same_texels = false;  // as the one before
        friend auto operator<=>(const Map&, const Map&) = default;
    };
    std::array<Map, drawn_maps> maps;
    std::uint8_t map_count = 0;
    friend auto operator<=>(const StageRequest&, const StageRequest&) = default;
};

struct StageList {
    static constexpr std::uint8_t no_plane = 255;
    static_assert(most_planes < no_plane);
    std::vector<Stage> stages;
    // After each: the planes that a later one reads before it writes them.
    std::vector<std::bitset<most_planes>> live;
    std::array<std::uint8_t, point_values> first{};  // plane of each value
    std::uint32_t planes = 0;                        // that a point takes
    std::array<std::uint32_t, stage_kinds> times{};  // how often each kind runs
    std::uint32_t map_count = 0;                     // maps that are sampled
    bool normal_maps = false;                        // its normals are bent by one
    bool has(PointValue value) const { return first[std::size_t(value)] != no_plane; }
};

// `local_lights`: for each light that is drawn, whether it is at a place.
StageList stages_for(const StageRequest& request, const std::vector<bool>& local_lights);

}  // namespace rast::detail
