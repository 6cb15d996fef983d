// A filter for equal positions: a hash of a few bits each, many at once. What it lets through is
// all that may equal another, and some of the rest: less than one in fifty
// (PositionFilter.LetsLessThanOneInFiftyThroughThatEqualNone).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "prep/simd.h"

namespace prep::detail {

// Two bits, or one, of one among 2^k words.
struct FilterBits {
    std::uint32_t word, bits;
};

// Adding 0 turns −0 into 0 and changes nothing else.
inline FilterBits filter_bits(const glm::vec3& p, std::uint32_t last_word) {
    std::uint32_t h = std::bit_cast<std::uint32_t>(p.x + 0.0f) * 0x9e3779b1u;
    h = ((h ^ (h >> 15)) + std::bit_cast<std::uint32_t>(p.y + 0.0f)) * 0x85ebca6bu;
    h = ((h ^ (h >> 13)) + std::bit_cast<std::uint32_t>(p.z + 0.0f)) * 0xc2b2ae35u;
    h ^= h >> 16;
    const std::uint32_t other = h * 0x27d4eb2fu;
    return {h & last_word, 1u << (other >> 27) | 1u << (other >> 22 & 31)};
}

// last_word: 2^k − 1.
struct FilterKernels {
    // The bits of `count` positions.
    void (*bits)(const glm::vec3* positions, std::size_t count, std::uint32_t last_word,
                 std::uint32_t* words, std::uint32_t* bits);
    // Which of `count` positions have their bits set in the filter: their numbers from `first` on,
    // ascending; gives how many. `found` has room for `count` and most_filter_lanes more.
    std::size_t (*find)(const glm::vec3* positions, std::size_t count, std::uint32_t last_word,
                        const std::uint32_t* filter, std::uint32_t first, std::uint32_t* found);
};
inline constexpr std::size_t most_filter_lanes = 16;

FilterKernels filter_kernels(SimdLevel level);  // position_filter_kernels.cpp

}  // namespace prep::detail
