// Angles from sine and cosine, by basic arithmetic alone: the C library's atan2 differs in its last
// bits between processors and versions, and results must not.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace prep::detail {

inline constexpr double pi = 0x1.921fb54442d18p+1;

// atan(k/8), rounded.
inline constexpr std::array<double, 9> arc_tangents{0x0.0p+0,
                                                    0x1.fd5ba9aac2f6ep-4,
                                                    0x1.f5b75f92c80ddp-3,
                                                    0x1.6f61941e4def1p-2,
                                                    0x1.dac670561bb4fp-2,
                                                    0x1.1e00babdefeb4p-1,
                                                    0x1.4978fa3269ee1p-1,
                                                    0x1.700a7c5784634p-1,
                                                    0x1.921fb54442d18p-1};

// atan2(sine, cosine) for sine ≥ 0, not both zero: 0 … π. The two may be scaled alike. Relative
// error at most 2⁻⁵¹ (ArcTangent.StaysWithinItsBound). The quotient is brought to |t| ≤ 1/16 by a
// table; the Taylor series to t¹³ is then good to 2⁻⁶⁰.
inline double angle_of(double sine, double cosine) {
    const double c = std::abs(cosine);
    const double low = std::min(sine, c), high = std::max(sine, c);
    const double q = low / high;
    const int k = int(q * 8 + 0.5);
    const double step = double(k) * 0.125;
    const double t = (low - step * high) / (high + step * low);
    const double s = t * t;
    const double series =
        t - t * s *
                (1.0 / 3 -
                 s * (1.0 / 5 - s * (1.0 / 7 - s * (1.0 / 9 - s * (1.0 / 11 - s * (1.0 / 13))))));
    double angle = arc_tangents[std::size_t(k)] + series;
    if (sine > c) angle = pi / 2 - angle;
    return cosine < 0 ? pi - angle : angle;
}

}  // namespace prep::detail
