#include "tessellation/limit/bezier_patch.h"

#include <cmath>

#include "tessellation/limit/normal_net.h"

namespace prep::detail {
namespace {

std::array<double, 4> polar(double a, double b, double c) {
    // P0 = f(−2,−1,0), P1 = f(−1,0,1), P2 = f(0,1,2), P3 = f(1,2,3): mixed by a in threes, by b in
    // twos, and by c.
    const double a0 = (a + 2) / 3, a1 = (a + 1) / 3, a2 = a / 3;
    const double b0 = (b + 1) / 2, b1 = b / 2;
    return {(1 - c) * ((1 - b0) * (1 - a0)),
            (1 - c) * ((1 - b0) * a0 + b0 * (1 - a1)) + c * ((1 - b1) * (1 - a1)),
            (1 - c) * (b0 * a1) + c * ((1 - b1) * a1 + b1 * (1 - a2)), c * (b1 * a2)};
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

std::array<double, 3> second_derivative_bounds(const BezierPatch& patch) {
    const auto& p = patch.p;
    double size = 0, uu = 0, uv = 0, vv = 0;
    for (const glm::dvec3& at : p)
        size = std::max({size, std::abs(at.x), std::abs(at.y), std::abs(at.z)});
    const auto widen = [](double& most, const glm::dvec3& d) {
        most = std::max(most, glm::dot(d, d));
    };
    for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t l = 0; l < 2; ++l) {
            const std::size_t u = 4 * k + l, v = 4 * l + k;
            widen(uu, p[u] - 2.0 * p[u + 1] + p[u + 2]);
            widen(vv, p[v] - 2.0 * p[v + 4] + p[v + 8]);
        }
    for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t k = 4 * j + i;
            widen(uv, (p[k] - p[k + 1]) - (p[k + 4] - p[k + 5]));
        }
    // Points carry errors of some roundings; a second difference adds up 4 of them, times 9.
    const double slack = size * 0x1p-45;
    return {6 * std::sqrt(uu) + slack, 9 * std::sqrt(uv) + slack, 6 * std::sqrt(vv) + slack};
}

NormalNet normal_net(const BezierPatch& patch) {
    NormalNet net;
    bicubic_normal_net(patch.p.data(), net.n.data());
    double size = 0, most_u = 0, most_v = 0;
    for (const glm::dvec3& at : patch.p)
        size = std::max({size, std::abs(at.x), std::abs(at.y), std::abs(at.z)});
    const auto widen = [](double& most, const glm::dvec3& d) {
        most = std::max(most, glm::dot(d, d));
    };
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 3; ++i) {
            widen(most_u, 3.0 * (patch.p[4 * j + i + 1] - patch.p[4 * j + i]));
            widen(most_v, 3.0 * (patch.p[4 * (i + 1) + j] - patch.p[4 * i + j]));
        }
    const double lengths = std::sqrt(most_u) + std::sqrt(most_v);
    net.error = lengths * (size * net_error_by_size + lengths * net_error_by_length);
    return net;
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
