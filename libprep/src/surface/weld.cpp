#include "surface/weld.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "base/scratch_buffer.h"
#include "base/step_count.h"
#include "prep/mesh.h"
#include "prep/topology.h"
#include "surface/position_filter.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
constexpr std::size_t position_grain = 32768;
// Positions per part: with its table (twice as many slots) it is 32 kB, which nearer caches keep.
constexpr std::size_t part_size = 1024;
constexpr std::size_t most_parts = 2048;

// A position that is compared, with its number: parts then read nothing but themselves.
struct Entry {
    glm::vec3 at;
    Index number;
};
struct Slot {
    Index hash, entry;
};

// Adding 0 turns −0 into 0 and changes nothing else.
std::uint64_t hash_of(const glm::vec3& p) {
    const auto x = std::bit_cast<Index>(p.x + 0.0f), y = std::bit_cast<Index>(p.y + 0.0f),
               z = std::bit_cast<Index>(p.z + 0.0f);
    std::uint64_t h = (std::uint64_t(x) << 32 | y) * 0x9e3779b97f4a7c15u;
    h ^= h >> 32;
    h = (h + z) * 0xd6e8feb86659fd93u;
    h ^= h >> 32;
    return h * 0xd6e8feb86659fd93u;  // the upper bits depend on everything
}

bool is_number(const glm::vec3& p) {
    return !(std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z));
}

// Positions that may equal others: all that do, and a few of the rest.
class Suspects {
  public:
    Suspects(std::span<const glm::vec3> positions, SimdLevel simd, int threads)
        : positions_(positions),
          kernels_(filter_kernels(simd)),
          threads_(threads),
          words_(std::bit_ceil(positions.size() * bits_per_position / 32 + 1)) {}

    // Ascending; nothing where they are so many that looking at all is as good.
    std::optional<std::vector<Index>> find() {
        // A position whose bits are taken equals an earlier one, or has them by chance; the second
        // look finds the earlier ones. Halves have bits of their own at first.
        const std::size_t n = positions_.size();
        const std::size_t parts = threads_ == 1 || n < 2 * position_grain ? 1 : 2;
        const std::size_t half = (n + parts - 1) / parts;
        std::vector<Half> halves(parts);
        parallel_blocks(n, half, threads_, [&](std::size_t begin, std::size_t end) {
            look(halves[begin / half], begin, end);
        });
        for (const Half& one : halves)
            if (one.many) return std::nullopt;
        std::vector<Index>& shared = halves[0].shared;
        for (std::size_t p = 1; p < parts; ++p) {
            for (std::size_t w = 0; w < words_; ++w)
                shared[w] |= halves[p].shared[w] | (halves[0].taken[w] & halves[p].taken[w]);
        }
        std::vector<std::vector<Index>> found((n + position_grain - 1) / position_grain);
        parallel_blocks(n, position_grain, threads_, [&](std::size_t begin, std::size_t end) {
            std::vector<Index>& list = found[begin / position_grain];
            Index block[patience + most_filter_lanes];
            for (std::size_t i = begin; i < end; i += patience) {
                const std::size_t count =
                    kernels_.find(&positions_[i], std::min(patience, end - i), Index(words_ - 1),
                                  shared.data(), Index(i), block);
                list.insert(list.end(), block, block + count);
            }
        });
        std::vector<Index> all;
        for (const auto& list : found) all.insert(all.end(), list.begin(), list.end());
        return all;
    }

  private:
    // With two bits each, about one position in 150 finds them taken by chance.
    static constexpr std::size_t bits_per_position = 16;
    static constexpr std::size_t patience = 1024;
    struct Half {
        std::vector<Index> taken, shared;
        bool many = false;
    };
    void look(Half& half, std::size_t begin, std::size_t end) const {
        half.taken.assign(words_, 0);
        half.shared.assign(words_, 0);
        Index *const taken = half.taken.data(), *const shared = half.shared.data();
        Index words[patience], bits[patience];
        std::size_t later = 0;
        const std::size_t least = (end - begin) / 16;  // seams may all lie at the beginning
        for (std::size_t i = begin; i < end && !half.many; i += patience) {
            const std::size_t count = std::min(patience, end - i);
            kernels_.bits(&positions_[i], count, Index(words_ - 1), words, bits);
            for (std::size_t k = 0; k < count; ++k) {
                const Index word = taken[words[k]];
                if ((word & bits[k]) == bits[k]) {
                    shared[words[k]] |= bits[k];
                    ++later;
                }
                taken[words[k]] = word | bits[k];
            }
            half.many = later > std::max(i + count - begin, least) / 4;
        }
    }

    std::span<const glm::vec3> positions_;
    FilterKernels kernels_;
    int threads_;
    std::size_t words_;
};

// Calls found(part, lowest, equal to it) for `n` positions, the i-th of which is number(i),
// ascending; for many parts at once.
template <class Number, class Found>
void equal_pairs(std::span<const glm::vec3> positions, std::size_t n, const Number& number,
                 const Found& found, int threads) {
    const int part_bits =
        std::countr_zero(std::min(most_parts, std::bit_ceil((n + part_size - 1) / part_size)));
    const std::size_t parts = std::size_t(1) << part_bits;
    const std::size_t blocks = (n + position_grain - 1) / position_grain;
    const auto part_of = [&](const glm::vec3& p) {
        return part_bits == 0 ? 0 : hash_of(p) >> (64 - part_bits);
    };

    // A stable sort by part: blocks in order within a part.
    std::vector<Index> starts(parts * blocks + 1, 0);
    parallel_blocks(n, position_grain, threads, [&](std::size_t begin, std::size_t end) {
        std::vector<Index> counts(parts, 0);
        for (std::size_t i = begin; i < end; ++i) ++counts[part_of(positions[number(i)])];
        const std::size_t block = begin / position_grain;
        for (std::size_t p = 0; p < parts; ++p) starts[p * blocks + block] = counts[p];
    });
    Index total = 0;
    for (Index& start : starts) start = std::exchange(total, total + start);
    ScratchBuffer<Entry> entries(n);
    parallel_blocks(n, position_grain, threads, [&](std::size_t begin, std::size_t end) {
        const std::size_t block = begin / position_grain;
        std::vector<Index> cursors(parts);
        for (std::size_t p = 0; p < parts; ++p) cursors[p] = starts[p * blocks + block];
        for (std::size_t i = begin; i < end; ++i) {
            const Entry entry{positions[number(i)], Index(number(i))};
            entries[cursors[part_of(entry.at)]++] = entry;
        }
    });

    parallel_blocks(parts, 16, threads, [&](std::size_t first, std::size_t last) {
        std::vector<Slot> table;
        std::size_t steps = 0;
        for (std::size_t p = first; p < last; ++p) {
            const Index begin = starts[p * blocks], end = starts[(p + 1) * blocks];
            const std::size_t capacity = std::bit_ceil(std::size_t(end - begin) * 2 + 1);
            table.assign(capacity, {0, no_index});
            for (Index e = begin; e < end; ++e) {
                const Entry& entry = entries[e];
                const auto hash = Index(hash_of(entry.at) >> 32);
                std::size_t slot = hash & (capacity - 1);
                for (;; slot = (slot + 1) & (capacity - 1)) {
                    ++steps;
                    if (table[slot].entry == no_index) {
                        if (is_number(entry.at)) table[slot] = {hash, e};
                        break;
                    }
                    const Entry& other = entries[table[slot].entry];
                    if (table[slot].hash == hash && other.at == entry.at) {
                        found(p, other.number, entry.number);
                        break;
                    }
                }
            }
        }
        count_steps(steps);
    });
}

std::vector<Index> all_by_themselves(std::size_t n) {
    std::vector<Index> lowest(n);
    for (Index i = 0; i < n; ++i) lowest[i] = i;
    return lowest;
}

}  // namespace

std::vector<Index> equal_positions(std::span<const glm::vec3> positions, int threads,
                                   SimdLevel simd) {
    const std::size_t n = positions.size();
    if (n < 2) return {};
    if (const auto suspects = Suspects(positions, simd, threads).find()) {
        std::vector<std::vector<std::pair<Index, Index>>> equals(most_parts);
        equal_pairs(
            positions, suspects->size(), [&](std::size_t i) { return (*suspects)[i]; },
            [&](std::size_t part, Index low, Index position) {
                equals[part].emplace_back(low, position);
            },
            threads);
        const auto none = [](const auto& list) { return list.empty(); };
        if (std::all_of(equals.begin(), equals.end(), none)) return {};
        std::vector<Index> lowest = all_by_themselves(n);
        for (const auto& list : equals)
            for (const auto& [low, position] : list) lowest[position] = low;
        return lowest;
    }
    std::vector<Index> lowest = all_by_themselves(n);
    equal_pairs(
        positions, n, [](std::size_t i) { return Index(i); },
        [&](std::size_t, Index low, Index position) { lowest[position] = low; }, threads);
    return lowest;
}

}  // namespace prep::detail

namespace prep {

std::vector<std::uint32_t> weld_exact(std::span<const glm::vec3> positions, int threads) {
    std::vector<std::uint32_t> welded = detail::equal_positions(positions, threads);
    return welded.empty() ? detail::all_by_themselves(positions.size()) : welded;
}

}  // namespace prep
