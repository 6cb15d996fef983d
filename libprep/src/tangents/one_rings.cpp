#include "tangents/one_rings.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>

#include "base/parallel.h"
#include "tangents/accumulate.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
constexpr std::size_t ring_grain = 2048;
constexpr std::size_t ring_triangle_grain = 65536;  // a multiple of 64
// Up to this many corners at a position, classes are searched one by one; above, corners are
// sorted.
constexpr std::size_t searched_ring = 32;

// Cuts one position into welded vertices.
class Splitter {
  public:
    Splitter(const CornerReader& read, const TangentTriangles& triangles, bool nan)
        : read_(read), triangles_(triangles), nan_(nan) {}

    // Reorders `members` by class (classes by their first member) and gives classes[i], the class
    // of members[i] after that. One class: false, nothing changed.
    bool split(std::span<Index> members) {
        const std::size_t n = members.size();
        classes_.resize(n);
        const Index count = n > searched_ring || nan_ ? sort(members) : search(members);
        if (count == 1) return false;
        starts_.assign(count + 1, 0);
        for (const Index c : classes_) ++starts_[c + 1];
        for (std::size_t c = 0; c < count; ++c) starts_[c + 1] += starts_[c];
        moved_.resize(n);
        sorted_classes_.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
            const Index to = starts_[classes_[i]]++;
            moved_[to] = members[i];
            sorted_classes_[to] = classes_[i];
        }
        std::copy(moved_.begin(), moved_.end(), members.begin());
        return true;
    }
    const std::vector<Index>& classes() const { return sorted_classes_; }

  private:
    // Where nothing is NaN: equal indices have equal values.
    Index search(std::span<const Index> members) {
        const Index* const normals = read_.in.normals.indices.data();
        const Index* const uvs = read_.in.uv.indices.data();
        std::array<Use, searched_ring> firsts;
        Index count = 0;
        for (std::size_t i = 0; i < members.size(); ++i) {
            const Index corner = triangles_.corner(members[i] >> 2, members[i] & 3);
            const Use use{normals[corner], uvs[corner]};
            Index c = 0;
            while (c < count && !same(use, firsts[c])) ++c;
            if (c == count) firsts[count++] = use;
            classes_[i] = c;
        }
        return count;
    }
    struct Use {
        Index normal, uv;
    };
    bool same(const Use& a, const Use& b) const {
        return (a.normal == b.normal ||
                read_.in.normals.values[a.normal] == read_.in.normals.values[b.normal]) &&
               (a.uv == b.uv || read_.in.uv.values[a.uv] == read_.in.uv.values[b.uv]);
    }
    Index sort(std::span<const Index> members) {
        const std::size_t n = members.size();
        const auto corner = [&](Index i) {
            return triangles_.corner(members[i] >> 2, members[i] & 3);
        };
        keys_.clear();
        for (Index i = 0; i < n; ++i) keys_.push_back(corner_key(read_, corner(i)));
        order_.resize(n);
        for (Index i = 0; i < n; ++i) order_[i] = i;
        std::sort(order_.begin(), order_.end(), [&](Index a, Index b) {
            if (keys_[a] < keys_[b]) return true;
            if (keys_[b] < keys_[a]) return false;
            if (keys_[a].number || corner(a) == corner(b)) return a < b;
            return corner(a) < corner(b);
        });
        // NaN equals nothing, but a corner of a quad's two triangles is one corner all the same.
        const auto same = [&](Index a, Index b) {
            return keys_[a] == keys_[b] || corner(a) == corner(b);
        };
        firsts_.resize(n);  // per corner: the first of its class
        for (std::size_t i = 0; i < n; ++i) {
            const bool joins = i > 0 && same(order_[i], order_[i - 1]);
            firsts_[order_[i]] = joins ? firsts_[order_[i - 1]] : order_[i];
        }
        Index count = 0;
        for (Index i = 0; i < n; ++i)
            classes_[i] = firsts_[i] == i ? count++ : classes_[firsts_[i]];
        return count;
    }

    const CornerReader& read_;
    const TangentTriangles& triangles_;
    bool nan_;
    std::vector<CornerKey> keys_;
    std::vector<Index> classes_, firsts_, order_, starts_, moved_, sorted_classes_;
};

// Per position the number of its lowest equal one among all that are.
ScratchBuffer<Index> numbers_of(std::span<const Index> lowest, std::size_t& count) {
    ScratchBuffer<Index> numbers(lowest.size());
    count = 0;
    for (std::size_t p = 0; p < lowest.size(); ++p)
        numbers[p] = lowest[p] == p ? Index(count++) : numbers[lowest[p]];
    return numbers;
}

// Three for each triangle that has contributions, all positions so far.
ScratchBuffer<Index> names_of(std::span<const Index> vertices, const ContributionStore& store,
                              int threads) {
    const std::size_t triangles = vertices.size() / 3;
    ScratchBuffer<Index> names(3 * (store.chosen.empty() ? triangles : store.planes[0].size()));
    parallel_blocks(
        triangles, ring_triangle_grain, threads, [&](std::size_t begin, std::size_t end) {
            if (store.chosen.empty()) {
                std::copy_n(vertices.data() + 3 * begin, 3 * (end - begin),
                            names.data() + 3 * begin);
                return;
            }
            Index* to = names.data() + 3 * std::size_t(store.chosen_before[begin / 64]);
            for (std::size_t w = begin / 64; w < (end + 63) / 64; ++w) {
                for (std::uint64_t rest = store.chosen[w]; rest != 0; rest &= rest - 1, to += 3) {
                    const std::size_t t = 64 * w + std::size_t(std::countr_zero(rest));
                    std::copy_n(vertices.data() + 3 * t, 3, to);
                }
            }
        });
    return names;
}

}  // namespace

OneRings welded_vertices(const TangentInput& in, const TangentTriangles& triangles,
                         std::span<const Index> lowest, int threads) {
    OneRings rings;
    rings.positions = in.positions.size();
    if (triangles.implicit() && lowest.empty()) {
        rings.vertices = in.corner_vertices;
        return rings;
    }
    ScratchBuffer<Index> numbers;
    if (!lowest.empty()) numbers = numbers_of(lowest, rings.positions);
    rings.own_vertices = ScratchBuffer<Index>(3 * triangles.count);
    parallel_blocks(triangles.count, ring_triangle_grain, threads,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = 3 * begin; i < 3 * end; ++i) {
                            const Index p = in.corner_vertices[triangles.corner(i)];
                            rings.own_vertices[i] = numbers.empty() ? p : numbers[p];
                        }
                    });
    rings.vertices = rings.own_vertices;
    return rings;
}

// A counting sort.
void fill_rings(const TangentInput& in, const TangentTriangles& triangles, const MemberLists& lists,
                OneRings& rings) {
    const Index* const vertices = rings.vertices.data();
    const auto position = [&](Index m) { return vertices[3 * std::size_t(m >> 2) + (m & 3)]; };
    // A bit for each listed position, and how many there are before each 64.
    const std::size_t words = rings.positions / 64 + 1;
    std::vector<std::uint64_t> bits(words, 0);
    std::size_t count = 0;
    for (const auto& list : lists) {
        count += list.size();
        Index last = no_index;
        for (const Index m : list) {
            const Index v = position(m);
            if (v == last) continue;  // a pole's
            bits[v / 64] |= std::uint64_t(1) << (v % 64);
            last = v;
        }
    }
    std::vector<Index> before(words);
    rings.count = 0;
    for (std::size_t w = 0; w < words; ++w) {
        before[w] = Index(rings.count);
        rings.count += std::size_t(std::popcount(bits[w]));
    }
    const auto number = [&](Index m) -> std::size_t {
        const Index v = position(m);
        const std::uint64_t below = (std::uint64_t(1) << (v % 64)) - 1;
        return before[v / 64] + std::size_t(std::popcount(bits[v / 64] & below));
    };
    // Of members that follow one another many may be of one position: calls body(position's
    // number, first, last) for those of each list.
    const bool large = count > std::size_t{16} * rings.count;
    const auto for_runs = [&](const std::vector<Index>& list, const auto& body) {
        for (auto first = list.begin(); first != list.end();) {
            const Index v = position(*first);
            auto last = first + 1;
            while (large && last != list.end() && position(*last) == v) ++last;
            body(number(*first), first, last);
            first = last;
        }
    };
    rings.listed = ScratchBuffer<Index>(rings.count);
    Index* next_listed = rings.listed.data();
    for (std::size_t w = 0; w < words; ++w)
        for (std::uint64_t rest = bits[w]; rest != 0; rest &= rest - 1)
            *next_listed++ = Index(64 * w + std::size_t(std::countr_zero(rest)));

    rings.offsets = ScratchBuffer<Index>(rings.count + 2);
    rings.split = ScratchBuffer<std::uint8_t>(rings.count);
    // Local pointers: writing bytes may change whatever is reached through others.
    const Index *const normals = in.normals.indices.data(), *const uvs = in.uv.indices.data();
    Index* const offsets = rings.offsets.data();
    ScratchBuffer<std::uint64_t> last_uses(rings.count);  // the last corner's normal and UV
    std::uint64_t* const uses = last_uses.data();
    const auto use = [&](Index m) {
        const Index c = triangles.corner(m >> 2, m & 3);
        return std::uint64_t(normals[c]) << 32 | uvs[c];
    };
    // Counted two places further on, offsets are starts one place further on after the sums, and
    // ends after that.
    std::memset(offsets, 0, rings.offsets.size() * sizeof(Index));
    for (const auto& list : lists) {
        for_runs(list, [&](std::size_t i, auto first, auto last) {
            offsets[i + 2] += Index(last - first);
            uses[i] = use(*(last - 1));
        });
    }
    for (std::size_t i = 0; i < rings.count; ++i) offsets[i + 2] += offsets[i + 1];

    rings.members = ScratchBuffer<Index>(count);
    Index* const members = rings.members.data();
    std::uint8_t* const split = rings.split.data();
    std::memset(split, 0, rings.count);
    bool any = false;
    for (const auto& list : lists) {
        for_runs(list, [&](std::size_t i, auto first, auto last) {
            Index* to = members + offsets[i + 1];
            offsets[i + 1] += Index(last - first);
            const std::uint64_t known = uses[i];
            for (; first != last; ++first) {
                *to++ = *first;
                if (known != use(*first)) {
                    split[i] = 1;
                    any = true;
                }
            }
        });
    }
    rings.any_split = any;
}

void split_rings(const CornerReader& read, const TangentTriangles& triangles,
                 const ContributionStore& store, int threads, OneRings& rings) {
    if (store.counts.nan) {
        std::memset(rings.split.data(), 1, rings.count);
        rings.any_split = true;
    }
    rings.store = &store;
    if (!rings.any_split) return;

    if (!rings.own_vertices.empty() && store.chosen.empty()) {
        rings.names = std::move(rings.own_vertices);
    } else {
        rings.names = names_of(rings.vertices, store, threads);
    }
    parallel_blocks(rings.count, ring_grain, threads, [&](std::size_t begin, std::size_t end) {
        Splitter splitter(read, triangles, store.counts.nan);
        for (std::size_t i = begin; i < end; ++i) {
            if (!rings.split[i]) continue;
            const Index first = rings.offsets[i];
            const std::span<Index> members(rings.members.data() + first,
                                           rings.offsets[i + 1] - first);
            if (!splitter.split(members)) {
                rings.split[i] = 0;
                continue;
            }
            Index name = rings.listed[i];
            for (std::size_t k = 0; k < members.size(); ++k) {
                if (k > 0 && splitter.classes()[k] != splitter.classes()[k - 1])
                    name = Index(rings.positions + first + k);
                const Index m = members[k];
                rings.names[3 * store.place(m >> 2) + (m & 3)] = name;
            }
        }
    });
}

void list_split_neighbours(std::span<const Index> vertices, int threads,
                           std::span<std::uint8_t> states) {
    // Numbers, so that three are looked at without branches.
    const auto is_split = [&](std::size_t i) -> unsigned {
        return states[vertices[i]] == split_vertex;
    };
    const std::size_t triangles = vertices.size() / 3;
    std::vector<std::vector<Index>> found((triangles + ring_triangle_grain - 1) /
                                          ring_triangle_grain);
    parallel_blocks(triangles, ring_triangle_grain, threads,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = 3 * begin; i < 3 * end; i += 3) {
                            if (!(is_split(i) | is_split(i + 1) | is_split(i + 2))) continue;
                            for (std::size_t k = 0; k < 3; ++k)
                                if (!is_split(i + k))
                                    found[begin / ring_triangle_grain].push_back(vertices[i + k]);
                        }
                    });
    for (const auto& list : found)
        for (const Index v : list) states[v] = worklist_vertex;
}

Worklist make_worklist(const TangentTriangles& triangles, const ContributionStore& store,
                       std::span<const Index> vertices, std::span<const std::uint8_t> states,
                       std::span<const Index> places, int threads, std::span<Index> corner_values) {
    Worklist result;
    result.lists.resize((triangles.count + ring_triangle_grain - 1) / ring_triangle_grain);
    result.triangles.assign((triangles.count + 63) / 64, 0);
    const bool any_degenerate = store.counts.degenerate > 0;
    std::atomic<bool> any = false;
    const bool plain = !states.empty() && !any_degenerate && places.empty();
    constexpr std::size_t most_found = 1024;
    const auto list_block = [&](std::size_t begin, std::size_t end) {
        std::vector<Index>& list = result.lists[begin / ring_triangle_grain];
        const std::uint8_t* const state = states.data();
        std::uint64_t* const words = result.triangles.data();
        const bool all_listed = states.empty(), placed = !places.empty();
        Index members[most_found];
        std::size_t found = 0;
        const auto flush = [&] {
            list.insert(list.end(), members, members + found);
            found = 0;
        };
        for (std::size_t t = begin; t < end; ++t) {
            const Index* const v = vertices.data() + 3 * t;
            Index* const values = corner_values.data() + 3 * t;
            if (plain && (state[v[0]] | state[v[1]] | state[v[2]]) == fan_vertex) continue;
            if (any_degenerate && (store.flags(t) & degenerate_triangle)) {
                values[0] = values[1] = values[2] = no_index;
                continue;
            }
            if (placed)
                for (std::size_t k = 0; k < 3; ++k) values[k] = places[v[k]];
            bool listed[3] = {true, true, true};
            if (!all_listed)
                for (std::size_t k = 0; k < 3; ++k) listed[k] = on_worklist(state[v[k]]);
            if (!(listed[0] | listed[1] | listed[2])) continue;
            words[t / 64] |= std::uint64_t(1) << (t % 64);
            if (found + 3 > most_found) flush();
            for (std::size_t k = 0; k < 3; ++k) {
                if (!listed[k]) continue;
                values[k] = no_index;
                members[found++] = Index(4 * t + k);
            }
        }
        flush();
        if (!list.empty()) any = true;
    };
    parallel_blocks(triangles.count, ring_triangle_grain, threads, list_block);
    result.any = any;
    return result;
}

}  // namespace prep::detail
