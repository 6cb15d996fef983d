#include "tessellation/bezier_patch.h"

#include <cmath>

namespace prep::detail {
namespace {

std::array<double, 4> polar(double a, double b, double c) {
    // P0 = f(−2,−1,0), P1 = f(−1,0,1), P2 = f(0,1,2), P3 = f(1,2,3).
    std::array<double, 4> weights{};
    for (std::size_t k = 0; k < 4; ++k) {
        const auto p = [&](std::size_t i) { return i == k ? 1.0 : 0.0; };
        const auto mix = [](double x, double y, double t) { return (1 - t) * x + t * y; };
        const double q0 = mix(p(0), p(1), (a + 2) / 3);
        const double q1 = mix(p(1), p(2), (a + 1) / 3);
        const double q2 = mix(p(2), p(3), a / 3);
        weights[k] = mix(mix(q0, q1, (b + 1) / 2), mix(q1, q2, b / 2), c);
    }
    return weights;
}

}  // namespace

CubicWeights bezier_weights(double a, double b) {
    return {polar(a, a, a), polar(a, a, b), polar(a, b, b), polar(b, b, b)};
}

std::array<glm::dvec3, 16> transformed(const std::array<glm::dvec3, 16>& in,
                                       const CubicWeights& along_u, const CubicWeights& along_v) {
    std::array<glm::dvec3, 16> half, out;
    for (std::size_t l = 0; l < 4; ++l)
        for (std::size_t i = 0; i < 4; ++i)
            half[4 * l + i] = ((along_u[i][0] * in[4 * l] + along_u[i][1] * in[4 * l + 1]) +
                               along_u[i][2] * in[4 * l + 2]) +
                              along_u[i][3] * in[4 * l + 3];
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 4; ++i)
            out[4 * j + i] = ((along_v[j][0] * half[i] + along_v[j][1] * half[4 + i]) +
                              along_v[j][2] * half[8 + i]) +
                             along_v[j][3] * half[12 + i];
    return out;
}

DerivativeBounds derivative_bounds(const BezierPatch& patch, const glm::dvec3& along) {
    DerivativeBounds bounds;
    constexpr double factors[4] = {1, 3, 6, 6};
    double size = 0;
    for (const glm::dvec3& p : patch.p)
        size = std::max({size, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    // Points carry errors of some roundings; a third difference adds up 8 of them, times 18.
    const double slack = size * 0x1p-45;
    std::array<glm::dvec3, 16> across = patch.p;  // differenced by v so far
    for (std::size_t b = 0; b < 4; ++b) {
        if (b > 0)
            for (std::size_t j = 0; j + b < 4; ++j)
                for (std::size_t i = 0; i < 4; ++i)
                    across[4 * j + i] = across[4 * (j + 1) + i] - across[4 * j + i];
        std::array<glm::dvec3, 16> both = across;
        for (std::size_t a = 0; a + b < 4; ++a) {
            double most = 0, steepest = 0;
            for (std::size_t j = 0; j + b < 4; ++j)
                for (std::size_t i = 0; i + a < 4; ++i) {
                    glm::dvec3& d = both[4 * j + i];
                    if (a > 0) d = both[4 * j + i + 1] - d;
                    most = std::max(most, glm::dot(d, d));
                    steepest = std::max(steepest, std::abs(glm::dot(d, along)));
                }
            const double factor = factors[a] * factors[b];
            bounds.length[a][b] = factor * std::sqrt(most) + slack;
            bounds.rise[a][b] = factor * steepest + slack;
        }
    }
    return bounds;
}

std::array<glm::dvec3, 2> middle_derivatives(const BezierPatch& patch) {
    constexpr double value[4] = {0.125, 0.375, 0.375, 0.125};
    constexpr double slope[4] = {-0.75, -0.75, 0.75, 0.75};
    std::array<glm::dvec3, 2> d{glm::dvec3(0.0), glm::dvec3(0.0)};
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 4; ++i) {
            d[0] += slope[i] * value[j] * patch.p[4 * j + i];
            d[1] += value[i] * slope[j] * patch.p[4 * j + i];
        }
    return d;
}

}  // namespace prep::detail
