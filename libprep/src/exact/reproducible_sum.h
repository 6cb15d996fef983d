// A sum of vectors whose bits do not depend on the order of the terms.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace prep::detail {

// 2^floor(log2 x) for finite x > 0 that is not denormal.
inline double power_of_two_below(double x) {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & 0x7ff0000000000000u);
}

struct OrderFreeSum {
    glm::dvec3 value{0.0};
    double size = 0;   // sum of the terms' absolute components
    double error = 0;  // bound on the length of the error of `value`
};

// Every component is rounded to a multiple of one quantum that depends only on the largest
// component and the number of terms, so that all partial sums are exact (Demmel and Nguyen 2015,
// one bin; where the error would be large, the rest is summed in a second bin likewise). x, y, z of
// a term are the vector, w the sum of their absolute values. Terms must be below 2^900 and the
// largest above 2^-900.
inline OrderFreeSum order_free_sum(std::span<const glm::dvec4> terms) {
    double largest = 0;
    for (const glm::dvec4& t : terms) largest = std::max(largest, t.w);
    if (!(largest > 0)) return {};
    const double count = double(std::bit_ceil(terms.size()));
    // Above every partial sum by a factor of two; adding and subtracting 1.5 times it rounds to
    // multiples of its 2⁻⁵².
    const double bound = power_of_two_below(largest) * 4 * count;
    const double shift = 1.5 * bound;
    glm::dvec4 sum(0.0);
    for (const glm::dvec4& t : terms) sum += (t + shift) - shift;
    // √3 · half a quantum a term.
    const double error = 0x1p-52 * bound * double(terms.size());
    const double length = std::max({std::abs(sum.x), std::abs(sum.y), std::abs(sum.z)});
    if (error <= 0x1p-45 * length) return {glm::dvec3(sum), sum.w, error};

    // What is left of each term is exact and at most half a quantum.
    const double rest_bound = 0x1p-52 * bound * 2 * count;
    const double rest_shift = 1.5 * rest_bound;
    glm::dvec4 rest(0.0);
    for (const glm::dvec4& t : terms) {
        const glm::dvec4 left = t - ((t + shift) - shift);
        rest += (left + rest_shift) - rest_shift;
    }
    sum += rest;
    const double total = std::max({std::abs(sum.x), std::abs(sum.y), std::abs(sum.z)});
    return {glm::dvec3(sum), sum.w, 0x1p-52 * rest_bound * double(terms.size()) + 0x1p-52 * total};
}

}  // namespace prep::detail
