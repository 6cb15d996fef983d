#include "tangent_vertex_counts.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>

#include "parallel.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
// A multiple of 64, so that no two blocks have bits in one word.
constexpr std::size_t vertex_grain = 65536;
constexpr std::size_t least_range = 32768;
constexpr std::size_t most_ranges = 64;
constexpr std::size_t ranges_per_thread = 4;
constexpr std::size_t copied_at_once = 8192;  // corners: they stay in the first-level cache

// Fills VertexCounts::shared: all 64 of a word where several ranges have any of them.
void find_shared(std::span<const Index> vertices, std::size_t words, int threads,
                 VertexCounts& counts) {
    std::vector<std::vector<std::uint8_t>> touched(counts.ranges.size());
    parallel_blocks(counts.ranges.size(), 1, threads, [&](std::size_t r, std::size_t) {
        touched[r].assign(words, 0);
        // Stores alone: bits would have to be read, one after the other in the same word.
        std::uint8_t* const own = touched[r].data();
        const Index* const last = vertices.data() + 3 * counts.ranges[r].end;
        for (const Index* i = vertices.data() + 3 * counts.ranges[r].begin; i < last; ++i)
            own[*i / 64] = 1;
    });
    counts.shared.resize(words);
    for (std::size_t w = 0; w < words; ++w) {
        unsigned ranges = 0;
        for (const auto& own : touched) ranges += own[w];
        counts.shared[w] = ranges > 1 ? ~std::uint64_t(0) : 0;
    }
}

// Counts in words; those of shared vertices become `apart`.
template <bool any_shared>
void count_off(const Index* first, const Index* last, Index* words, const std::uint64_t* shared) {
    for (; first < last; ++first) {
        const Index v = *first;
        if (any_shared && shared[v / 64] != 0)
            // By several threads, all with the same value.
            std::atomic_ref(words[v]).store(VertexWord::apart, std::memory_order_relaxed);
        else
            ++words[v];
    }
}

}  // namespace

VertexCounts count_triangles(const TangentTriangles& triangles, std::span<const Index> vertices,
                             std::size_t count, int threads, std::vector<Index>* copy) {
    VertexCounts result;
    const std::size_t most =
        threads == 1 ? 1 : std::min(most_ranges, ranges_per_thread * std::size_t(parallel_width()));
    const std::size_t n = std::clamp<std::size_t>(triangles.count / least_range, 1, most);
    result.ranges.resize(n);
    for (std::size_t r = 0; r < n; ++r) {
        result.ranges[r].begin = triangles.cut(triangles.count * r / n);
        result.ranges[r].end = triangles.cut(triangles.count * (r + 1) / n);
    }
    if (n > 1) find_shared(vertices, count / 64 + 1, threads, result);

    result.states = ScratchBuffer<std::uint8_t>(count + VertexCounts::behind);
    std::memset(result.states.data() + count, unused_vertex, VertexCounts::behind);
    result.words = ScratchBuffer<Index>(count);
    const bool any_shared = n > 1;
    parallel_blocks(count, vertex_grain, threads, [&](std::size_t begin, std::size_t end) {
        std::memset(result.words.data() + begin, 0, (end - begin) * sizeof(Index));
    });
    if (copy != nullptr) {
        for (std::size_t i = 0; i < vertices.size(); i += copied_at_once) {
            const auto part = vertices.subspan(i, std::min(copied_at_once, vertices.size() - i));
            count_off<false>(part.data(), part.data() + part.size(), result.words.data(), nullptr);
            copy->insert(copy->end(), part.begin(), part.end());
        }
    } else {
        parallel_blocks(n, 1, threads, [&](std::size_t r, std::size_t) {
            const Index* const first = vertices.data() + 3 * result.ranges[r].begin;
            const Index* const last = vertices.data() + 3 * result.ranges[r].end;
            if (any_shared)
                count_off<true>(first, last, result.words.data(), result.shared.data());
            else
                count_off<false>(first, last, result.words.data(), nullptr);
        });
    }

    std::vector<std::size_t> starts((count + vertex_grain - 1) / vertex_grain, 0);
    std::atomic<std::size_t> listed_corners = 0;
    parallel_blocks(count, vertex_grain, threads, [&](std::size_t begin, std::size_t end) {
        Index* const words = result.words.data();
        std::uint8_t* const states = result.states.data();
        Index used = 0, listed = 0;
        const auto look = [&](std::size_t first, std::size_t last) {
            for (std::size_t v = first; v < last; ++v) {
                const Index met = words[v];
                used += met != 0;
                listed += met > most_ring_members ? met : 0;
                states[v] = met == 0 ? unused_vertex : pending_vertex;
                words[v] = met > most_ring_members ? VertexWord::listed : met;
            }
        };
        if (!any_shared) look(begin, end);
        for (std::size_t first = begin; any_shared && first < end; first += 64) {
            const std::size_t last = std::min(first + 64, end);
            std::uint64_t& shared = result.shared[first / 64];
            if (shared == 0) {
                look(first, last);
                continue;
            }
            shared = 0;
            for (std::size_t v = first; v < last; ++v) {
                used += words[v] != 0;
                states[v] = words[v] == 0 ? unused_vertex : pending_vertex;
                shared |= std::uint64_t(words[v] != 0) << (v % 64);
            }
        }
        listed_corners += listed;
        starts[begin / vertex_grain] = used;
    });
    result.listed_corners = listed_corners;
    for (std::size_t& start : starts) {
        const std::size_t used = start;
        start = result.used;
        result.used += used;
    }
    if (result.used == count) return result;
    result.places = ScratchBuffer<Index>(count);
    parallel_blocks(count, vertex_grain, threads, [&](std::size_t begin, std::size_t end) {
        std::size_t place = starts[begin / vertex_grain];
        for (std::size_t v = begin; v < end; ++v) {
            result.places[v] = Index(place);
            place += result.states[v] != unused_vertex;
        }
    });
    return result;
}

}  // namespace prep::detail
