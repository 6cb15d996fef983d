#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <optional>

#include "base/parallel.h"
#include "tangents/accumulate.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
// A multiple of 64, so that no two blocks have bits in one word.
constexpr std::size_t vertex_grain = 65536;
constexpr std::size_t least_share = 4096, least_piece = 32768;  // triangles
constexpr std::size_t most_ranges = 64;
constexpr std::size_t pieces_of_share = 3;
constexpr std::size_t sampled_triangles = 1024;
constexpr std::size_t copied_at_once = 8192;  // corners: they stay in the first-level cache

// A share for each thread, in pieces that become smaller: one that is done early takes what another
// has not begun, and what comes last is short.
std::vector<Valences::Range> cut_ranges(const TangentTriangles& triangles, int threads) {
    const std::size_t count = triangles.count;
    const std::size_t shares =
        threads == 1
            ? 1
            : std::clamp<std::size_t>(count / least_share, 1,
                                      std::min(most_ranges, std::size_t(parallel_width())));
    const std::size_t pieces =
        shares == 1 ? 1
                    : std::clamp<std::size_t>(count / shares / least_piece, 1,
                                              std::min(pieces_of_share, most_ranges / shares));
    const std::size_t parts = pieces * (pieces + 1) / 2;
    std::vector<Valences::Range> ranges;
    std::size_t begin = 0;
    for (std::size_t share = 0; share < shares; ++share) {
        for (std::size_t part = 0, piece = pieces; piece > 0; --piece) {
            part += piece;
            const std::size_t end =
                triangles.cut(count * (share * parts + part) / (shares * parts));
            ranges.push_back({begin, end});
            begin = end;
        }
    }
    return ranges;
}

void count_off(const Index* first, const Index* last, Index* words) {
    for (; first < last; ++first) ++words[*first];
}

// Each 64 vertices belong to the range that comes to them first; only that one counts.
class ClaimedCounts {
  public:
    ClaimedCounts(std::size_t vertices, Index* words)
        : words_(words), owners_(vertices / 64 + 1, none), contested_(owners_.size(), 0) {}

    void count_off(std::uint8_t range, const Index* first, const Index* last) {
        // Local pointers: writing bytes may change whatever is reached through others.
        Index* const words = words_;
        std::uint8_t* const owners = owners_.data();
        for (; first < last; ++first) {
            const Index v = *first;
            const std::atomic_ref word(words[v]);
            if (std::atomic_ref(owners[v / 64]).load(std::memory_order_relaxed) == range ||
                is_own(range, v / 64))
                word.store(word.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
            else
                // The owner may write at once what it has counted: not 0 either.
                word.store(VertexWord::apart, std::memory_order_relaxed);
        }
    }
    bool contested(std::size_t word) const { return contested_[word] != 0; }

  private:
    static constexpr std::uint8_t none = 0xff;
    static_assert(most_ranges < none);

    bool is_own(std::uint8_t range, std::size_t word) {
        const std::atomic_ref owner(owners_[word]);
        std::uint8_t found = owner.load(std::memory_order_relaxed);
        if (found == range) return true;
        if (found == none && owner.compare_exchange_strong(found, range, std::memory_order_relaxed))
            return true;
        const std::atomic_ref contested(contested_[word]);
        if (contested.load(std::memory_order_relaxed) == 0)
            contested.store(1, std::memory_order_relaxed);
        return false;
    }

    Index* words_;
    std::vector<std::uint8_t> owners_, contested_;
};

}  // namespace

bool are_scattered(std::span<const Index> vertices, std::size_t count) {
    const std::size_t triangles = vertices.size() / 3;
    if (triangles < sampled_triangles || count > vertices.size()) return false;
    std::uint64_t distance = 0;
    for (std::size_t i = 0; i < sampled_triangles; ++i) {
        const std::size_t t = i * (triangles - 1) / sampled_triangles;
        const Index a = vertices[3 * t], b = vertices[3 * t + 3];
        distance += a < b ? b - a : a - b;
    }
    // A third of all is what chance gives.
    return distance / sampled_triangles > count / 16;
}

Valences uncounted_valences(const TangentTriangles& triangles, std::size_t count, int threads) {
    Valences result;
    result.ranges = cut_ranges(triangles, threads);
    result.states = ScratchBuffer<std::uint8_t>(count);
    std::memset(result.states.data(), unused_vertex, count);
    return result;
}

Valences count_valences(const TangentTriangles& triangles, std::span<const Index> vertices,
                        std::size_t count, int threads, std::vector<Index>* copy) {
    Valences result;
    result.ranges = cut_ranges(triangles, threads);
    const std::size_t n = result.ranges.size();
    result.states = ScratchBuffer<std::uint8_t>(count);
    result.words = ScratchBuffer<Index>(count);
    const bool any_shared = n > 1;
    std::optional<ClaimedCounts> claimed;
    parallel_blocks(count, vertex_grain, threads, [&](std::size_t begin, std::size_t end) {
        std::memset(result.words.data() + begin, 0, (end - begin) * sizeof(Index));
    });
    if (copy != nullptr) {
        for (std::size_t i = 0; i < vertices.size(); i += copied_at_once) {
            const auto part = vertices.subspan(i, std::min(copied_at_once, vertices.size() - i));
            count_off(part.data(), part.data() + part.size(), result.words.data());
            copy->insert(copy->end(), part.begin(), part.end());
        }
    } else if (!any_shared) {
        count_off(vertices.data(), vertices.data() + vertices.size(), result.words.data());
    } else {
        claimed.emplace(count, result.words.data());
        parallel_blocks(n, 1, threads, [&](std::size_t r, std::size_t) {
            claimed->count_off(std::uint8_t(r), vertices.data() + 3 * result.ranges[r].begin,
                               vertices.data() + 3 * result.ranges[r].end);
        });
        result.shared.resize(count / 64 + 1);
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
            if (!claimed->contested(first / 64)) {
                look(first, last);
                continue;
            }
            std::uint64_t shared = 0;
            for (std::size_t v = first; v < last; ++v) {
                const bool met = words[v] != 0;
                used += met;
                states[v] = met ? pending_vertex : unused_vertex;
                words[v] = met ? VertexWord::apart : 0;
                shared |= std::uint64_t(met) << (v % 64);
            }
            result.shared[first / 64] = shared;
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
