// Images in and out (OpenImageIO behind the wall), as float or 8-bit pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "prep/result.h"

namespace prep {

struct ImageRef;

// Row-major, top row first, `channels` interleaved (1 to 4), values as stored in the file: 8- and
// 16-bit integers mapped to 0…1, floats as they are. No colour conversion.
struct Image {
    std::uint32_t width = 0, height = 0, channels = 0;
    std::vector<float> pixels;
    bool srgb =
        false;  // the file says (or its format implies) that colour channels are sRGB-encoded
    const float* at(std::uint32_t x, std::uint32_t y) const {
        return pixels.data() + (std::size_t(y) * width + x) * channels;
    }
};

// Largest image that is read: 32768² pixels. More gives ErrorCode::limit.
inline constexpr std::uint32_t max_image_extent = 32768;

// Any format OpenImageIO reads. Errors: io (missing, unreadable), syntax (broken), limit.
Result<Image> load_image(const std::filesystem::path& path);
// From memory; `name` is for messages and, by its ending, a hint at the format.
Result<Image> decode_image(std::span<const std::byte> bytes, const std::string& name);
// From the path or the embedded bytes.
Result<Image> load_image(const ImageRef& ref);

enum class PixelType : std::uint8_t { u8, u16, f16, f32 };

// Writes `pixels` as they are (encode sRGB before). The format follows the ending: png, jpg, exr, …
// The file appears complete or not at all (temporary name, then rename).
Result<void> save_image(const std::filesystem::path& path, const Image& image,
                        PixelType type = PixelType::u8);
// PNG in memory, for pages that embed their pictures. Deterministic: no time, no host in it.
Result<std::vector<std::byte>> encode_png(const Image& image, PixelType type = PixelType::u8);

}  // namespace prep
