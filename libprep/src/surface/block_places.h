// Where items go that are written behind the last one of their block: "propagation blocking"
// (Beamer, Asanović and Patterson, 2017). Items whose keys are in random order would be written
// anywhere in memory; blocks of keys are few enough to write to all of them, and small enough that
// what is done with one of them stays in a cache.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace prep::detail {

// keys[i] >> shift is the block of item i, below `blocks`. Items are gone through range by range:
// range r ends at range_ends[r], where the next one begins. Per range, then per block, the place of
// the range's first item of that block: blocks lie one after the other, and within each its ranges
// in order. What is written there in the ranges' order has the order of the items, whatever the
// threads.
std::vector<std::size_t> block_places(std::span<const std::uint32_t> keys, int shift,
                                      std::size_t blocks, std::span<const std::size_t> range_ends,
                                      int threads);

// Ends of ranges of `grain` items each, the last shorter.
std::vector<std::size_t> even_range_ends(std::size_t items, std::size_t grain);

}  // namespace prep::detail
