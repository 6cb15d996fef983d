// What can be asked of a picture: by a program (rast::RenderRequest), in a scene file ("picture",
// docs/scene-format.md) and on the command line (`meshprep render`). One struct, and one row for
// each choice; scene files and the command line read the rows.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "prep/enum_names.h"

namespace prep {

enum class Shading : std::uint8_t { flat, gouraud, phong, normal_mapped };
constexpr auto names_of(Shading) {
    return std::to_array<EnumName<Shading>>({{"flat", Shading::flat},
                                             {"gouraud", Shading::gouraud},
                                             {"phong", Shading::phong},
                                             {"normal-mapped", Shading::normal_mapped}});
}

enum class Cull : std::uint8_t {
    by_material,  // back, unless double-sided
    back,
    front,
    none
};
constexpr auto names_of(Cull) {
    return std::to_array<EnumName<Cull>>({{"by-material", Cull::by_material},
                                          {"back", Cull::back},
                                          {"front", Cull::front},
                                          {"none", Cull::none}});
}

// How textures are read between their texels, and from which mip levels. `by_sampler`: each texture
// as its own sampler asks (prep::Texture::mag, min and mip; trilinear unless it says otherwise).
enum class TextureFilter : std::uint8_t {
    by_sampler,
    nearest,
    bilinear,
    nearest_mip,  // bilinear, on the mip level nearest to the footprint
    trilinear,
    bicubic,
    anisotropic,
    ripmap,
    ewa
};
constexpr auto names_of(TextureFilter) {
    return std::to_array<EnumName<TextureFilter>>({{"sampler", TextureFilter::by_sampler},
                                                   {"nearest", TextureFilter::nearest},
                                                   {"bilinear", TextureFilter::bilinear},
                                                   {"nearest-mip", TextureFilter::nearest_mip},
                                                   {"trilinear", TextureFilter::trilinear},
                                                   {"bicubic", TextureFilter::bicubic},
                                                   {"anisotropic", TextureFilter::anisotropic},
                                                   {"ripmap", TextureFilter::ripmap},
                                                   {"ewa", TextureFilter::ewa}});
}

// How much of a pixel a surface fills: by samples, or by the exact area that is seen of it, for
// reference pictures (librast/src/passes/area_resolve.h says what that is and what it costs).
enum class Coverage : std::uint8_t { samples, area };
constexpr auto names_of(Coverage) {
    return std::to_array<EnumName<Coverage>>(
        {{"samples", Coverage::samples}, {"area", Coverage::area}});
}

// How depths are kept: reversed float (1 near, 0 far, so that float's fine steps lie where the
// projection's are coarse), or fixed point of n bits, k / 2^n, for comparison. With a near plane n
// and no far one, surfaces at distance d are told apart from a gap of d · 2^-23 (float) or
// d² / n · 2^-bits on. Exact areas use double.
enum class DepthFormat : std::uint8_t { float32, fixed24, fixed16 };
constexpr auto names_of(DepthFormat) {
    return std::to_array<EnumName<DepthFormat>>({{"float", DepthFormat::float32},
                                                 {"fixed24", DepthFormat::fixed24},
                                                 {"fixed16", DepthFormat::fixed16}});
}

// How light above 1 is shown: clipped, or by Reinhard's x/(1+x) (2002, eq. 3) per channel.
enum class ToneMap : std::uint8_t { off, reinhard };
constexpr auto names_of(ToneMap) {
    return std::to_array<EnumName<ToneMap>>(
        {{"off", ToneMap::off}, {"reinhard", ToneMap::reinhard}});
}

inline constexpr int max_supersample = 16;
inline constexpr std::uint32_t max_picture_extent = 32768;

struct RenderChoices {
    std::uint32_t width = 1024, height = 768;
    Shading shading = Shading::normal_mapped;
    glm::vec3 background{0.0f};  // linear
    Cull cull = Cull::by_material;
    TextureFilter filter = TextureFilter::by_sampler;
    int samples = 1;  // per pixel: 1, 2, 4, 8 or 16
    // Each pixel is the mean of N × N finer ones, in linear light: 1 … max_supersample. Colours
    // alone: other buffers are those of the picture without it.
    int supersample = 1;
    Coverage coverage = Coverage::samples;
    DepthFormat depth_format = DepthFormat::float32;
    int max_anisotropy = 8;  // 1 … 16: anisotropic and EWA filters
    // Of the picture in 8 bits (rast::to_srgb); a frame's colours are linear and before these.
    ToneMap tone_map = ToneMap::off;
    // automatic_exposure: found from the picture (rast/exposure.h), by whoever draws.
    float exposure = 1;
    // Of linear light, before the exposure: lights are left out that together add at most so much
    // to any channel of any pixel, beside the rounding of sums (2⁻²⁰ of a pixel's value). 0: what
    // is left out changes no bit.
    float allow_error = 0;
};
inline constexpr float automatic_exposure = 0;

// Which values a choice has.
struct Named {};  // an enum with names
struct Pixels {
    std::uint32_t greatest;
};
struct Linear {};  // a colour
struct OneOf {
    std::vector<int> values;
};
struct Range {
    double least, greatest;
};

struct RangeOrAuto {  // a number, or the word "auto", which is 0
    double least, greatest;
};

// A row for each choice: its key in scene files (on the command line "max_anisotropy" is
// --max-anisotropy), its member, which values there are, and the command line's help.
template <class Row>
void for_each_render_choice(Row&& row) {
    using C = RenderChoices;
    row("size", std::pair(&C::width, &C::height), Pixels{max_picture_extent},
        "Pixels (default 1024x768)");
    row("shading", &C::shading, Named{}, "Shading frequency (default normal-mapped)");
    row("background", &C::background, Linear{}, "#rrggbb, or linear R,G,B");
    row("cull", &C::cull, Named{},
        "Faces left out (default by-material: back faces, unless double-sided)");
    row("filter", &C::filter, Named{},
        "Texture filter (default sampler: as each texture's own sampler asks)");
    row("samples", &C::samples, OneOf{{1, 2, 4, 8, 16}},
        "Samples a pixel: 1 (default), 2, 4, 8 or 16");
    row("supersample", &C::supersample, Range{1, max_supersample},
        "Each pixel is the mean of N x N finer ones, in linear light (default 1)");
    row("coverage", &C::coverage, Named{},
        "What decides how much of a pixel a surface fills: samples (default), or the exact area "
        "that is seen of it (slow; for reference pictures)");
    row("depth", &C::depth_format, Named{},
        "How depths are kept: reversed float (default), or fixed point, to see what it costs");
    row("max_anisotropy", &C::max_anisotropy, Range{1, 16},
        "1 to 16: probes of the anisotropic filter, longest ellipse of ewa (default 8)");
    row("tone_map", &C::tone_map, Named{}, "How light above 1 is shown (default off: clipped)");
    row("exposure", &C::exposure, RangeOrAuto{1e-6, 1e6},
        "Light is multiplied by this; auto: found from the picture (default for files, scene files "
        "aside, that bring lights of their own; else 1)");
    row("allow_error", &C::allow_error, Range{0, 1e6},
        "Lights may be left out that together add at most so much linear light to any channel, "
        "before the exposure (default 0: nothing that changes the picture)");
}

// Some of the choices: those of a scene file, those of a command line.
struct RenderWishes {
    RenderChoices choices;
    std::set<std::string_view> given;  // the keys of those that are made

    bool has(std::string_view key) const { return given.count(key) != 0; }
};

// `choices` with what `wishes` gives.
RenderChoices with_wishes(RenderChoices choices, const RenderWishes& wishes);

// "#ff8800", sRGB-encoded, as linear light; nothing where it is no such text.
std::optional<glm::vec3> color_from_hex(std::string_view text);

}  // namespace prep
