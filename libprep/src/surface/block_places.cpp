#include "surface/block_places.h"

#include <algorithm>

#include "base/parallel.h"

namespace prep::detail {

std::vector<std::size_t> block_places(std::span<const std::uint32_t> keys, int shift,
                                      std::size_t blocks, std::span<const std::size_t> range_ends,
                                      int threads) {
    const std::size_t ranges = range_ends.size();
    std::vector<std::size_t> places(ranges * blocks, 0);
    parallel_blocks(ranges, 1, threads, [&](std::size_t r, std::size_t) {
        std::size_t* const counts = places.data() + r * blocks;
        for (std::size_t i = r == 0 ? 0 : range_ends[r - 1]; i < range_ends[r]; ++i)
            ++counts[keys[i] >> shift];
    });
    std::size_t place = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
        for (std::size_t r = 0; r < ranges; ++r) {
            const std::size_t count = places[r * blocks + b];
            places[r * blocks + b] = place;
            place += count;
        }
    }
    return places;
}

std::vector<std::size_t> even_range_ends(std::size_t items, std::size_t grain) {
    std::vector<std::size_t> ends;
    for (std::size_t begin = 0; begin < items; begin += grain)
        ends.push_back(std::min(items, begin + grain));
    return ends;
}

}  // namespace prep::detail
