// By which conventions a mesh's own tangents and its normal map were made: told from the data, with
// the figures that the verdict rests on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "prep/enum_names.h"
#include "prep/image.h"
#include "prep/mesh.h"

namespace prep {

enum class TangentMethod : std::uint8_t {
    undecided,   // fewer than 12 corners to compare
    mikktspace,  // 99 % of the corners within 1° (what signed bytes round by) of MikkTSpace
    similar,     // 95 % within 5°: the same gradients, weighted or grouped in another way
    other,
};
constexpr auto names_of(TangentMethod) {
    return std::to_array<EnumName<TangentMethod>>({{"undecided", TangentMethod::undecided},
                                                   {"mikktspace", TangentMethod::mikktspace},
                                                   {"similar", TangentMethod::similar},
                                                   {"other", TangentMethod::other}});
}

enum class TangentSign : std::uint8_t {
    undecided,
    as_gltf,   // w · cross(normal, tangent) runs against growing v, whose origin is at the top
    inverted,  // the other way round; either at 90 % of the corners
    mixed,
};
constexpr auto names_of(TangentSign) {
    return std::to_array<EnumName<TangentSign>>({{"undecided", TangentSign::undecided},
                                                 {"as-gltf", TangentSign::as_gltf},
                                                 {"inverted", TangentSign::inverted},
                                                 {"mixed", TangentSign::mixed}});
}

struct TangentConventions {
    TangentMethod method = TangentMethod::undecided;
    TangentSign sign = TangentSign::undecided;
    // Corners with a finite tangent, a normal and UVs that have a gradient.
    std::uint64_t compared = 0;
    std::uint64_t identical = 0;               // of those: MikkTSpace's x, y, z to the last bit
    std::uint64_t within_1 = 0, within_5 = 0;  // degrees of MikkTSpace's direction
    std::uint64_t opposite = 0;                // over 175°: dP/du the other way round
    std::uint64_t same_sign = 0;               // w as MikkTSpace gives it in glTF's convention
    double median_degrees = 0, largest_degrees = 0;
};

// Compares a mesh's own tangents with MikkTSpace's for its normals and the given UVs, by corner.
// Without tangents, normals or UVs nothing is compared and both verdicts are undecided.
// Cost: that of corner_tangents, and O(corners · log(corners)).
TangentConventions tangent_conventions(const Mesh& mesh, const CornerLayerView<glm::vec2>& uvs,
                                       int threads = 0);
TangentConventions tangent_conventions(const Mesh& mesh, std::size_t uv_set = 0, int threads = 0);

enum class GreenDirection : std::uint8_t { undecided, up, down };
constexpr auto names_of(GreenDirection) {
    return std::to_array<EnumName<GreenDirection>>({{"undecided", GreenDirection::undecided},
                                                    {"up", GreenDirection::up},
                                                    {"down", GreenDirection::down}});
}

struct GreenChannel {
    static constexpr std::size_t scales = 5;
    GreenDirection direction = GreenDirection::undecided;
    double correlation = 0;  // the mean of those below: near 1 green points up, near −1 down
    std::array<double, scales> correlations{};   // at full size, half, … 1/16; 0 where nothing is
    std::array<std::uint64_t, scales> texels{};  // that had a say there: bumpy ones
};

// Whether green of a tangent-space normal map points up in the picture (as OpenGL and glTF have it)
// or down (DirectX). Slopes of a surface have no curl: with p and q the slopes to the right and up,
// dp/dy = dq/dx. The correlation of the two over the picture is near 1 for maps whose green points
// up, and near −1 for those whose green is flipped. Maps are not quite surfaces (seams, filling,
// details laid over them, maybe flipped ones), so five sizes are asked: undecided where their mean
// is within ±0.3, or one is beyond 0.3 on the other side, and for flat maps. Red pointing to the
// left looks the same as flipped green, but is not in use.
// Source: the integrability condition of Frankot and Chellappa 1988. O(texels).
GreenChannel green_channel(const Image& normal_map);

}  // namespace prep
