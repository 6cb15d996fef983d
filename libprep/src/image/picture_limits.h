// What is read of what a picture's header promises.
#pragma once

#include <cstdint>
#include <string>

#include "prep/image.h"
#include "prep/result.h"

namespace prep::detail {

// Small pictures are exempt from promised_in(), because some formats store a constant picture in a
// hundred bytes.
inline constexpr std::uint64_t always_allowed_bytes = std::uint64_t(1) << 28;

inline std::uint64_t bytes_of_pixels(std::uint64_t width, std::uint64_t height,
                                     std::uint64_t channels) {
    return width * height * channels * sizeof(float);
}

// Errors: limit.
inline Result<void> check_extent(std::int64_t width, std::int64_t height,
                                 const std::string& place) {
    if (width <= std::int64_t(max_image_extent) && height <= std::int64_t(max_image_extent))
        return {};
    return Error{ErrorCode::limit,
                 "the image is " + std::to_string(width) + " x " + std::to_string(height) +
                     " pixels, at most " + std::to_string(max_image_extent) +
                     " each way are read; scale it down",
                 place};
}

// Whether a file of so many bytes can hold the pixels. `largest_compression`: the worst honest
// ratio of bytes of pixels, which are floats, to bytes of the file; LZW reaches 2730 from bytes to
// bytes. Errors: invalid.
inline Result<void> check_promise(std::uint64_t width, std::uint64_t height, std::uint64_t channels,
                                  std::uint64_t file_bytes, const std::string& place,
                                  std::uint64_t largest_compression = 4096) {
    const std::uint64_t need = bytes_of_pixels(width, height, channels);
    if (need <= always_allowed_bytes || need / largest_compression <= file_bytes) return {};
    return Error{ErrorCode::invalid,
                 "the header promises " + std::to_string(width) + " x " + std::to_string(height) +
                     " pixels, but the file has only " + std::to_string(file_bytes) +
                     " bytes; it is truncated or damaged",
                 place};
}
inline Result<void> check_promise(const Image& image, std::uint64_t file_bytes,
                                  const std::string& place,
                                  std::uint64_t largest_compression = 4096) {
    return check_promise(image.width, image.height, image.channels, file_bytes, place,
                         largest_compression);
}

}  // namespace prep::detail
