// sRGB (IEC 61966-2-1) to linear light and back.
#pragma once

#include <cmath>

namespace rast {

inline float srgb_to_linear(float x) {
    return x <= 0.04045f ? x / 12.92f : float(std::pow((double(x) + 0.055) / 1.055, 2.4));
}

inline float linear_to_srgb(float x) {
    if (!(x > 0)) return 0;  // NaN too
    if (x >= 1) return 1;
    return x <= 0.0031308f ? x * 12.92f : float(1.055 * std::pow(double(x), 1 / 2.4) - 0.055);
}

}  // namespace rast
