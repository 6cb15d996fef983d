// Elementary functions of our own: the C library picks implementations by processor, and their last
// bits differ. These use only +, −, ×, ÷ in double and give the same bits everywhere.
#pragma once

#include <bit>
#include <cstdint>

namespace rast {

// Natural logarithm of a positive normal double; relative error below 1e-13
// (Elementary.LogAndExpKeepThirteenDigits). x = 2^k · m with m in [√½, √2); log m =
// 2·atanh((m−1)/(m+1)) by its series to the 21st power.
inline double log_portable(double x) {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(x);
    int k = int(bits >> 52) - 1023;
    double m = std::bit_cast<double>((bits & 0x000fffffffffffffu) | 0x3ff0000000000000u);
    if (m > 1.4142135623730951) {
        m *= 0.5;
        ++k;
    }
    const double t = (m - 1) / (m + 1), t2 = t * t;
    double p = 1.0 / 21;
    p = p * t2 + 1.0 / 19;
    p = p * t2 + 1.0 / 17;
    p = p * t2 + 1.0 / 15;
    p = p * t2 + 1.0 / 13;
    p = p * t2 + 1.0 / 11;
    p = p * t2 + 1.0 / 9;
    p = p * t2 + 1.0 / 7;
    p = p * t2 + 1.0 / 5;
    p = p * t2 + 1.0 / 3;
    return k * 0.6931471805599453 + 2 * t + 2 * t * (t2 * p);
}

// Base-2 logarithm of a positive normal float by the kernels' own operations (math-inl.h).
inline float log2_portable(float x) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
    const float exponent = float(std::int32_t(bits >> 23) - 126);
    const float f = std::bit_cast<float>((bits & 0x007fffffu) | 0x3f000000u) - 1.0f;
    const float t = f / (2.0f + f), s = t * t, s2 = s * s;
    const float p0 = 2.0f / 3.0f * s + 2.0f, p2 = 2.0f / 7.0f * s + 2.0f / 5.0f;
    const float p4 = 2.0f / 11.0f * s + 2.0f / 9.0f, p6 = 2.0f / 15.0f * s + 2.0f / 13.0f;
    const float p = ((p6 * s2 + p4) * (s2 * s2)) + (p2 * s2 + p0);
    return exponent + p * t * 1.44269504088896341f;
}

// e^x for x in [−700, 700], 0 below; relative error below 1e-13.
inline double exp_portable(double x) {
    if (x < -700) return 0;
    if (x > 700) x = 700;
    const double scaled = x * 1.4426950408889634;
    const int k = int(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
    const double r = (x - k * 0.693147180369123816490) - k * 1.90821492927058770002e-10;
    double p = 1.0 / 479001600;
    p = p * r + 1.0 / 39916800;
    p = p * r + 1.0 / 3628800;
    p = p * r + 1.0 / 362880;
    p = p * r + 1.0 / 40320;
    p = p * r + 1.0 / 5040;
    p = p * r + 1.0 / 720;
    p = p * r + 1.0 / 120;
    p = p * r + 1.0 / 24;
    p = p * r + 1.0 / 6;
    p = p * r + 0.5;
    p = p * r + 1;
    p = p * r + 1;
    return p * std::bit_cast<double>(std::uint64_t(k + 1023) << 52);
}

}  // namespace rast
