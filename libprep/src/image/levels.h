// Values from 0 to 1 as the integers that pictures store, and back.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "prep/image.h"

namespace prep::detail {

// 0…1 to the whole range of integers. Here, so that the bytes do not depend on the library's
// version.
template <class T>
std::vector<T> quantise(std::span<const float> pixels) {
    constexpr float top = float(std::numeric_limits<T>::max());
    std::vector<T> out(pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        // Written so that NaN becomes 0.
        const float v = pixels[i] > 0.0f ? (pixels[i] < 1.0f ? pixels[i] : 1.0f) : 0.0f;
        // Half upwards: in doubles, where no sum is rounded up to the next whole number.
        out[i] = T(int(double(v * top) + 0.5));
    }
    return out;
}

// Where an image's levels of `bytes` bytes are read to before spread_levels(): the end of the
// floats' memory. (Float i ends before level i + 1 begins.)
inline std::byte* place_of_levels(Image& image, std::size_t bytes) {
    return reinterpret_cast<std::byte*>(image.pixels.data()) +
           image.pixels.size() * (sizeof(float) - bytes);
}

// Levels of 8 or 16 bits as quotients by the largest one. (OpenImageIO multiplies by 1/255 or
// 1/65535 in floats: the last bit of a third of the values is another, and a level of 8 bits is not
// that of the same value in 16.)
template <class Level>
void spread_levels(Image& image) {
    const std::byte* const levels = place_of_levels(image, sizeof(Level));
    const std::size_t count = image.pixels.size();
    constexpr std::size_t at_once = 4096;
    std::array<Level, at_once> block;
    for (std::size_t begin = 0; begin < count; begin += at_once) {
        const std::size_t size = std::min(at_once, count - begin);
        std::memcpy(block.data(), levels + begin * sizeof(Level), size * sizeof(Level));
        for (std::size_t k = 0; k < size; ++k)
            image.pixels[begin + k] = float(block[k]) / float(std::numeric_limits<Level>::max());
    }
}

}  // namespace prep::detail
