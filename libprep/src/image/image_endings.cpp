#include <algorithm>
#include <span>
#include <string_view>

#include "prep/formats.h"
#include "prep/image.h"

namespace prep {
namespace {

constexpr unsigned bit(PixelType type) {
    return 1u << unsigned(type);
}
constexpr unsigned u8 = bit(PixelType::u8), u16 = bit(PixelType::u16), f16 = bit(PixelType::f16),
                   f32 = bit(PixelType::f32);

// What libpng and OpenImageIO 2.4 write so that it can be read again (SaveImage.*), and tells a
// full disk of. Not JPEG 2000, whose writer leaves an empty file, nor the endings of its texture
// files (.tx), nor .pgm, whose name promises greys, nor .dpx and .gif, whose bytes differ from one
// time to the next.
struct WrittenEnding {
    std::string_view ending;
    unsigned types;
};
constexpr WrittenEnding written[] = {{".png", u8 | u16},
                                     {".jpg", u8},
                                     {".exr", f16 | f32},
                                     {".tif", u8 | u16 | f32},
                                     {".tiff", u8 | u16 | f32},
                                     {".hdr", f32},
                                     {".webp", u8},
                                     {".tga", u8},
                                     {".bmp", u8},
                                     {".ppm", u8},
                                     {".pnm", u8},
                                     {".jpeg", u8},
                                     {".jpe", u8},
                                     {".jif", u8},
                                     {".jfif", u8},
                                     {".jfi", u8}};
constexpr const char* named = ".png, .jpg, .exr, .tif, .hdr, .webp, .tga, .bmp or .ppm";

// Others that are read (image.cpp; known_formats of openimageio/read.cpp).
constexpr std::string_view read_only[] = {
    ".dds", ".pgm",   ".pbm",  ".pfm", ".psd", ".pdd",  ".sgi",  ".rgb",  ".rgba", ".bw",
    ".int", ".inta",  ".rla",  ".cin", ".pic", ".jp2",  ".j2k",  ".heic", ".heif", ".avif",
    ".ico", ".zfile", ".fits", ".dpx", ".gif", ".tpic", ".rgbe", ".tx",   ".env",  ".sm"};

unsigned types_of(const std::string& ending) {
    for (const WrittenEnding& w : written)
        if (w.ending == ending) return w.types;
    return 0;
}

}  // namespace

bool is_image_name(const std::filesystem::path& path) {
    const std::string ending = lower_ending(path);
    return types_of(ending) != 0 ||
           std::find(std::begin(read_only), std::end(read_only), ending) != std::end(read_only);
}

Result<void> check_writable_image(const std::filesystem::path& path) {
    const std::string ending = lower_ending(path);
    if (types_of(ending) != 0) return {};
    return Error{ErrorCode::unsupported,
                 ending.empty() ? "the image's name has no ending; name it .png, .jpg or .exr"
                                : "images are not written as '" + ending + "'; use " + named,
                 path.string()};
}

bool image_holds(const std::filesystem::path& path, PixelType type) {
    return (types_of(lower_ending(path)) & bit(type)) != 0;
}

Result<PixelType> stored_type(const std::filesystem::path& path, PixelType type) {
    if (auto writable = check_writable_image(path); !writable) return writable.error();
    constexpr PixelType u8_in[] = {PixelType::u8, PixelType::u16, PixelType::f16, PixelType::f32};
    constexpr PixelType u16_in[] = {PixelType::u16, PixelType::f32};
    constexpr PixelType f16_in[] = {PixelType::f16, PixelType::f32};
    constexpr PixelType f32_in[] = {PixelType::f32};
    const std::span<const PixelType> in[] = {u8_in, u16_in, f16_in, f32_in};
    for (const PixelType held : in[std::size_t(type)])
        if (image_holds(path, held)) return held;
    constexpr const char* words[] = {"8 bits", "16 bits", "half floats", "floats"};
    return Error{
        ErrorCode::unsupported,
        "'" + lower_ending(path) + "' files do not hold " + words[std::size_t(type)] + " a channel",
        path.string()};
}

}  // namespace prep
