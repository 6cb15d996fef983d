// Which positions are equal (== per component: −0 equals 0, NaN equals nothing, not even itself,
// and stays alone). weld_exact (prep/topology.h) gives the same with every position named.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "prep/simd.h"

namespace prep::detail {

// Per position the lowest index of an equal one. Empty when no two are equal. Expected O(n): a
// filter drops most positions that equal no other; hashes of the rest are sorted into parts of the
// cache's size, each part then has a table of its own.
std::vector<std::uint32_t> equal_positions(std::span<const glm::vec3> positions, int threads,
                                           SimdLevel simd = SimdLevel::automatic);

}  // namespace prep::detail
