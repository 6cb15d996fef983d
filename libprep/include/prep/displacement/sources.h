// Sources of displacement: height maps, vector maps and noise in space (docs/displacement.md).
//
// A height is (texel − midlevel) · scale along the surface's normal, in the units of positions.
// Texels are linear whatever their file says. The map as read, with its filter, is the truth that
// errors are measured against.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "prep/enum_names.h"
#include "prep/image.h"
#include "prep/material.h"
#include "prep/result.h"

namespace prep {

// Between texels. Both go through every texel; bicubic has a continuous gradient, as normals want
// it, and exceeds the texels around it by up to 9/32 of their range.
enum class HeightFilter : std::uint8_t {
    bilinear,
    bicubic,  // Catmull-Rom: Keys (1981), a = −½
};
constexpr auto names_of(HeightFilter) {
    return std::to_array<EnumName<HeightFilter>>(
        {{"bilinear", HeightFilter::bilinear}, {"bicubic", HeightFilter::bicubic}});
}

struct HeightMapOptions {
    std::uint32_t channel = 0;
    HeightFilter filter = HeightFilter::bilinear;
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;  // border is taken for clamp
    double scale = 1;  // height of a texel of 1, in units of the mesh
    // The texel that moves nothing. In files of 8 and 16 bits it is the code nearest to it, halves
    // up: 0.5 stands for 128/255 and for 32768/65535, as no such file can hold 0.5.
    double midlevel = 0.5;
    // Of the mesh's UVs, as TextureRef has it: its offset, scale and rotation are applied; its
    // texture, UV set and strength are not read.
    TextureRef placement = {};
    // What samples of the surface so far apart cannot carry is left out (docs/displacement.md, band
    // limits): read where heights move a surface, in its mesh's units or, without a mesh, by UVs.
    // 0: the map as it is.
    double sample_spacing = 0;
    int threads = 0;  // 0: all cores; the result does not depend on it
};

// What the three channels of a vector map stand for. Results are always in the order (tangent,
// bitangent, normal), or (x, y, z) in object space.
enum class VectorAxes : std::uint8_t {
    tangent_normal_bitangent,  // normal in green: Blender (Cycles), Mudbox
    tangent_bitangent_normal,  // normal in blue, as in normal maps
    object,                    // x, y, z of the mesh's own space
};
constexpr auto names_of(VectorAxes) {
    return std::to_array<EnumName<VectorAxes>>(
        {{"tangent-normal-bitangent", VectorAxes::tangent_normal_bitangent},
         {"tangent-bitangent-normal", VectorAxes::tangent_bitangent_normal},
         {"object", VectorAxes::object}});
}

struct VectorMapOptions {
    HeightMapOptions map;  // its channel is the first of three; midlevel is that of all three
    VectorAxes axes = VectorAxes::tangent_normal_bitangent;
    // Signs of the results, for programs that count an axis the other way.
    std::array<bool, 3> flip{false, false, false};
};

enum class NoiseKind : std::uint8_t {
    perlin,   // gradient noise with the fifth-degree fade (Perlin 2002)
    simplex,  // Perlin 2001, as Gustavson 2005 has it, with a kernel that is continuous
};
constexpr auto names_of(NoiseKind) {
    return std::to_array<EnumName<NoiseKind>>(
        {{"perlin", NoiseKind::perlin}, {"simplex", NoiseKind::simplex}});
}

// Noise in the mesh's own space: Σ gainⁱ noiseᵢ(frequency · lacunarityⁱ · p), i below `octaves`,
// minus midlevel, times scale.
struct NoiseOptions {
    NoiseKind kind = NoiseKind::perlin;
    double frequency = 1;  // lattice cells in a unit of length
    int octaves = 1;       // 1 … 32
    double lacunarity = 2, gain = 0.5;
    std::uint32_t seed = 0;
    double scale = 1, midlevel = 0;
    // Octaves that samples so far apart cannot carry are left out: those of more than 1/(2 spacing)
    // cells, and from 1/(4 spacing) on they fade.
    double sample_spacing = 0;
};

struct HeightToNormalOptions {
    HeightMapOptions map;
    // World units that a unit of u and of v cover: slopes are heights over lengths.
    glm::dvec2 uv_size{1.0};
    double strength = 1;      // slopes times this
    bool flip_green = false;  // for readers whose green points down
};

// A tangent-space normal map of the map's size, three channels in 0…1, 0.5 for zero: normals of
// the bicubic surface through the texels, at their centres. `bits`, where not null: those that the
// heights use, 8 also for a map of 8 bits that was saved with 16 or as floats; 0 for other floats.
// Errors: those of a height map.
Result<Image> height_to_normal(const Image& heights, const HeightToNormalOptions& options = {},
                               int* bits = nullptr);

}  // namespace prep
