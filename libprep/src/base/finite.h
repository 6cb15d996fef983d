// Whether numbers are neither NaN nor infinite.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace prep::detail {

template <glm::length_t n, class T>
bool is_finite(const glm::vec<n, T>& v) {
    for (glm::length_t k = 0; k < n; ++k)
        if (!std::isfinite(v[k])) return false;
    return true;
}

// The numbers of an array of vectors, one after the other.
template <glm::length_t n>
std::span<const float> floats_of(const std::vector<glm::vec<n, float>>& vectors) {
    static_assert(sizeof(glm::vec<n, float>) == n * sizeof(float));
    return {reinterpret_cast<const float*>(vectors.data()), vectors.size() * std::size_t(n)};
}

// Whether all of many numbers are: without a branch for each.
inline bool all_finite(std::span<const float> values) {
    constexpr std::size_t block = 4096;
    for (std::size_t first = 0; first < values.size(); first += block) {
        const std::size_t last = std::min(values.size(), first + block);
        std::uint32_t bits = 0;  // the sign bit of a sum: a magnitude of infinity or beyond
        for (std::size_t i = first; i < last; ++i)
            bits |= (std::bit_cast<std::uint32_t>(values[i]) & 0x7fffffffu) + 0x00800000u;
        if (bits >> 31) return false;
    }
    return true;
}

}  // namespace prep::detail
