#include <bit>
#include <cmath>

#include "base/parallel.h"
#include "prep/topology.h"
#include "step_count.h"

namespace prep {
namespace {

using Index = std::uint32_t;
constexpr std::size_t vertex_grain = 1 << 16;
constexpr std::size_t part_count = 64;  // tables of n/64 slots stay in the second-level cache

std::uint32_t bits_of(float x) {
    return x == 0.0f ? 0u : std::bit_cast<std::uint32_t>(x);  // −0 equals 0
}

std::uint64_t mix(std::uint64_t h) {  // the finaliser of SplitMix64 (Steele et al. 2014)
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

std::uint64_t hash_of(const glm::vec3& p) {
    const std::uint64_t xy = std::uint64_t(bits_of(p.x)) << 32 | bits_of(p.y);
    return mix(mix(xy) ^ bits_of(p.z));
}

bool has_nan(const glm::vec3& p) {
    return std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z);
}

struct Hashed {
    std::uint32_t hash;
    Index vertex;
};

// Vertices in ascending order, so that the first of a class is its lowest.
void weld_part(std::span<const glm::vec3> positions, std::span<const Hashed> part,
               std::vector<Index>& welded) {
    std::vector<Hashed> table(std::bit_ceil(part.size() * 2 + 2), {0, no_index});
    const std::size_t mask = table.size() - 1;
    std::size_t steps = part.size();
    for (const Hashed& h : part) {
        const glm::vec3& p = positions[h.vertex];
        if (has_nan(p)) {
            welded[h.vertex] = h.vertex;
            continue;
        }
        std::size_t slot = h.hash & mask;
        while (table[slot].vertex != no_index &&
               !(table[slot].hash == h.hash && positions[table[slot].vertex] == p))
            slot = (slot + 1) & mask, ++steps;
        if (table[slot].vertex == no_index) table[slot] = h;
        welded[h.vertex] = table[slot].vertex;
    }
    detail::count_steps(steps);
}

}  // namespace

std::vector<std::uint32_t> weld_exact(std::span<const glm::vec3> positions, int threads) {
    const std::size_t n = positions.size();
    std::vector<Index> welded(n);
    if (n == 0) return welded;
    // Cut by hash into parts that are welded apart; within a part vertices stay in order.
    const std::size_t blocks = (n + vertex_grain - 1) / vertex_grain;
    std::vector<std::uint64_t> hashes(n);
    std::vector<Index> starts(blocks * part_count, 0);
    const auto part_of = [](std::uint64_t hash) { return std::size_t(hash >> 58); };
    detail::parallel_blocks(n, vertex_grain, threads, [&](std::size_t begin, std::size_t end) {
        Index* counts = starts.data() + begin / vertex_grain * part_count;
        for (std::size_t v = begin; v < end; ++v) {
            hashes[v] = hash_of(positions[v]);
            ++counts[part_of(hashes[v])];
        }
    });
    std::vector<Index> part_starts(part_count + 1);
    Index total = 0;
    for (std::size_t p = 0; p < part_count; ++p) {
        part_starts[p] = total;
        for (std::size_t b = 0; b < blocks; ++b) {
            const Index count = starts[b * part_count + p];
            starts[b * part_count + p] = total;
            total += count;
        }
    }
    part_starts[part_count] = total;
    std::vector<Hashed> sorted(n);
    detail::parallel_blocks(n, vertex_grain, threads, [&](std::size_t begin, std::size_t end) {
        Index* cursors = starts.data() + begin / vertex_grain * part_count;
        for (std::size_t v = begin; v < end; ++v)
            sorted[cursors[part_of(hashes[v])]++] = {std::uint32_t(hashes[v]), Index(v)};
    });
    detail::parallel_blocks(part_count, 1, threads, [&](std::size_t p, std::size_t) {
        weld_part(positions, {sorted.data() + part_starts[p], part_starts[p + 1] - part_starts[p]},
                  welded);
    });
    return welded;
}

}  // namespace prep
