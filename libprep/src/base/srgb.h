// The sRGB transfer functions (IEC 61966-2-1:1999), 0 … 1, in double.
#pragma once

#include <cmath>

namespace prep::detail {

inline double srgb_to_linear(double s) {
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}
inline double linear_to_srgb(double x) {
    return x <= 0.0031308 ? x * 12.92 : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

}  // namespace prep::detail
