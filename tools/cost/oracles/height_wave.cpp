#include "cost/oracles/height_wave.h"

#include <cmath>
#include <numbers>

namespace cost {

Real wave_at(Real u, Real v) {
    constexpr Real turn = 2 * std::numbers::pi_v<Real>;
    return (std::sin(turn * (2 * u + Real(0.1))) + std::sin(turn * (u - v)) +
            std::cos(turn * (u + v + Real(0.3)))) /
           3;
}

Vector wave_normal(Real u, Real v, Real height) {
    constexpr Real turn = 2 * std::numbers::pi_v<Real>;
    const Real a = std::cos(turn * (2 * u + Real(0.1))), b = std::cos(turn * (u - v)),
               c = std::sin(turn * (u + v + Real(0.3)));
    const Real along_u = height * turn * (2 * a + b - c) / 3,
               along_v = height * turn * (-b - c) / 3;
    return glm::normalize(Vector(-along_u, -along_v, 1));
}

WaveTexels::WaveTexels(int size) : size_(size) {
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i)
            texels_.push_back(
                float(wave_at((Real(i) + Real(0.5)) / size, (Real(j) + Real(0.5)) / size)));
}

Real WaveTexels::texel(long i, long j) const {
    const long a = (i % size_ + size_) % size_, b = (j % size_ + size_) % size_;
    return Real(texels_[std::size_t(b * size_ + a)]);
}

Real WaveTexels::bilinear(Real u, Real v) const {
    const Real x = u * size_ - Real(0.5), y = v * size_ - Real(0.5);
    const long i = std::lround(std::floor(x)), j = std::lround(std::floor(y));
    const Real s = x - Real(i), t = y - Real(j);
    return (texel(i, j) * (1 - s) + texel(i + 1, j) * s) * (1 - t) +
           (texel(i, j + 1) * (1 - s) + texel(i + 1, j + 1) * s) * t;
}

}  // namespace cost
