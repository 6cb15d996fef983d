// Which positions are one: step 2 of the definition, as far as positions go.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "prep/simd.h"

namespace prep::detail {

// Per position the lowest index of an equal one (== per component: −0 equals 0, NaN equals nothing,
// not even itself, and stays alone). Empty when no two are equal. Expected O(n): hashes are sorted
// into parts of the cache's size, each part then has a table of its own.
std::vector<std::uint32_t> equal_positions(std::span<const glm::vec3> positions, int threads,
                                           SimdLevel simd = SimdLevel::automatic);

}  // namespace prep::detail
