#include <bit>
#include <cmath>

#include "prep/topology.h"

namespace prep {
namespace {

std::uint32_t bits_of(float x) {
    return x == 0.0f ? 0u : std::bit_cast<std::uint32_t>(x);
}

std::uint64_t mix(std::uint64_t h) {  // the finaliser of SplitMix64 (Steele et al. 2014)
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

}  // namespace

std::vector<std::uint32_t> weld_exact(std::span<const glm::vec3> positions, int) {
    const std::size_t n = positions.size();
    std::vector<std::uint32_t> welded(n);
    const std::size_t capacity = std::bit_ceil(n * 2 + 2);
    std::vector<std::uint32_t> table(capacity, no_index);
    for (std::uint32_t v = 0; v < n; ++v) {
        const glm::vec3& p = positions[v];
        welded[v] = v;
        if (std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z)) continue;
        const std::uint64_t xy = std::uint64_t(bits_of(p.x)) << 32 | bits_of(p.y);
        std::size_t slot = mix(mix(xy) ^ bits_of(p.z)) & (capacity - 1);
        for (; table[slot] != no_index; slot = (slot + 1) & (capacity - 1)) {
            if (positions[table[slot]] == p) {
                welded[v] = table[slot];
                break;
            }
        }
        if (welded[v] == v) table[slot] = v;
    }
    return welded;
}

}  // namespace prep
