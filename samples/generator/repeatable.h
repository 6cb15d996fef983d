// Mathematics whose bits depend on nothing but the arguments: the C library's sine and cosine may
// differ in the last bit from one processor to the next.
#pragma once

#include <cmath>
#include <cstdint>

namespace samples {

inline constexpr double pi = 3.14159265358979323846;

// Taylor's series after reduction to a quarter turn around zero: below 1e-15 off for |x| < 100.
inline double sine(double x) {
    const double turns = std::floor(x / (2 * pi) + 0.5);
    x -= turns * 2 * pi;
    if (x > pi / 2) x = pi - x;
    if (x < -pi / 2) x = -pi - x;
    double term = x, sum = x;
    for (int k = 1; k < 14; ++k) {
        term *= -x * x / ((2 * k) * (2 * k + 1));
        sum += term;
    }
    return sum;
}

inline double cosine(double x) {
    return sine(x + pi / 2);
}

inline double clamp01(double x) {
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

// 0 below a, 1 above b, smooth between (Hermite).
inline double smooth_step(double a, double b, double x) {
    const double t = clamp01((x - a) / (b - a));
    return t * t * (3 - 2 * t);
}

inline double mix(double a, double b, double t) {
    return a + (b - a) * t;
}

// Uniform in 0…1 from two integers.
inline double hash01(std::int64_t x, std::int64_t y) {
    std::uint64_t h = std::uint64_t(x) * 0x9E3779B97F4A7C15u ^ (std::uint64_t(y) + 0x7F4A7C15u);
    h ^= h >> 32;
    h *= 0xD6E8FEB86659FD93u;
    h ^= h >> 32;
    h *= 0xD6E8FEB86659FD93u;
    h ^= h >> 32;
    return double(h >> 11) / 9007199254740992.0;
}

// Value noise of period `period` cells in both directions, 0…1, smooth.
inline double periodic_noise(double x, double y, int period, int seed) {
    const double fx = std::floor(x), fy = std::floor(y);
    const auto cell = [&](double cx, double cy) {
        const auto wrap = [&](double c) {
            const auto i = std::int64_t(c) % period;
            return i < 0 ? i + period : i;
        };
        return hash01(wrap(cx) + 1000 * seed, wrap(cy));
    };
    const double tx = smooth_step(0, 1, x - fx), ty = smooth_step(0, 1, y - fy);
    return mix(mix(cell(fx, fy), cell(fx + 1, fy), tx),
               mix(cell(fx, fy + 1), cell(fx + 1, fy + 1), tx), ty);
}

}  // namespace samples
