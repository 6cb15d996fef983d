// How pixel values are stored, shared by the writers.
#pragma once

#include <OpenImageIO/typedesc.h>

#include <cstdint>
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

inline OIIO::TypeDesc type_of(PixelType type) {
    switch (type) {
        case PixelType::u8:
            return OIIO::TypeDesc::UINT8;
        case PixelType::u16:
            return OIIO::TypeDesc::UINT16;
        case PixelType::f16:
            return OIIO::TypeDesc::HALF;
        case PixelType::f32:
            break;
    }
    return OIIO::TypeDesc::FLOAT;
}

}  // namespace prep::detail
