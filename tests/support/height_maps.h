// Height maps for tests: pictures from a function, and the function that a map stands for, by its
// definition.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <random>
#include <vector>

#include "displacement/height_field.h"
#include "prep/image.h"

namespace prep::test {

// One channel of floats.
inline Image picture(std::uint32_t width, std::uint32_t height,
                     const std::function<double(std::uint32_t, std::uint32_t)>& texel) {
    Image image;
    image.width = width;
    image.height = height;
    image.channels = 1;
    image.floating = true;
    image.pixels.resize(std::size_t(width) * height);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            image.pixels[std::size_t(y) * width + x] = float(texel(x, y));
    return image;
}

inline Image random_picture(std::uint32_t width, std::uint32_t height, unsigned seed) {
    std::mt19937 random(seed);
    return picture(width, height, [&](auto, auto) { return double(random() % 4096) / 4096; });
}

// Plain heights: texel · scale.
inline HeightMapOptions plain(HeightFilter filter = HeightFilter::bilinear,
                              Wrap wrap = Wrap::repeat) {
    HeightMapOptions options;
    options.filter = filter;
    options.wrap_u = options.wrap_v = wrap;
    options.midlevel = 0;
    return options;
}

inline long long wrapped(long long i, long long n, Wrap wrap) {
    if (wrap == Wrap::clamp) return i < 0 ? 0 : i >= n ? n - 1 : i;
    while (i < 0) i += 2 * n;
    i %= 2 * n;
    if (wrap == Wrap::mirror) return i < n ? i : 2 * n - 1 - i;
    return i % n;
}

// Interpolation kernels as their papers have them: the tent, and Keys (1981) with a = −½.
inline long double tent(long double x) {
    return std::fabs(x) < 1 ? 1 - std::fabs(x) : 0.0L;
}
inline long double keys(long double x) {
    const long double a = -0.5L, d = std::fabs(x);
    if (d <= 1) return (a + 2) * d * d * d - (a + 3) * d * d + 1;
    if (d < 2) return a * d * d * d - 5 * a * d * d + 8 * a * d - 4 * a;
    return 0;
}

// Σ texel · k(x − i) k(y − j) in map coordinates.
inline double by_definition(const Image& image, HeightFilter filter, Wrap wrap,
                            const glm::dvec2& uv) {
    const long double x = (long double)(uv.x) * image.width - 0.5L;
    const long double y = (long double)(uv.y) * image.height - 0.5L;
    const auto kernel = filter == HeightFilter::bicubic ? keys : tent;
    long double sum = 0;
    for (long long j = (long long)std::floor(y) - 1; j <= (long long)std::floor(y) + 2; ++j)
        for (long long i = (long long)std::floor(x) - 1; i <= (long long)std::floor(x) + 2; ++i)
            sum += (long double)(*image.at(std::uint32_t(wrapped(i, image.width, wrap)),
                                           std::uint32_t(wrapped(j, image.height, wrap)))) *
                   kernel(x - (long double)(i)) * kernel(y - (long double)(j));
    return double(sum);
}

// Barycentric coordinates (i, j, n − i − j)/n of all i + j ≤ n.
template <class Visit>
void over_triangle(int n, const Visit& visit) {
    for (int i = 0; i <= n; ++i)
        for (int j = 0; i + j <= n; ++j) visit(glm::dvec3(i, j, n - i - j) / double(n));
}

using Charts = std::vector<std::array<glm::dvec2, 3>>;

// Two triangles of one chart, wherever its corners are.
inline void add_quad(Charts& charts, const std::array<glm::dvec2, 4>& c) {
    charts.push_back({c[0], c[1], c[2]});
    charts.push_back({c[0], c[2], c[3]});
}

inline bool is_inside(const Charts& charts, const glm::dvec2& p) {
    for (const auto& t : charts) {
        const auto side = [&](std::size_t i) {
            const glm::dvec2 a = t[i], b = t[(i + 1) % 3];
            return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        };
        const double s[3] = {side(0), side(1), side(2)};
        if ((s[0] >= 0 && s[1] >= 0 && s[2] >= 0) || (s[0] <= 0 && s[1] <= 0 && s[2] <= 0))
            return true;
    }
    return false;
}

}  // namespace prep::test
