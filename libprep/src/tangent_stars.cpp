#include "tangent_stars.h"

#include <algorithm>
#include <cstring>

#include "parallel.h"
#include "tangent_key.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
constexpr std::size_t position_grain = 16384;
constexpr std::size_t triangle_grain = 65536;
// Up to this many corners at a position, classes are searched one by one; above, corners are
// sorted.
constexpr std::size_t small_star = 32;

// Cuts one position into welded vertices.
class Splitter {
  public:
    Splitter(const CornerReader& read, const TangentTriangles& triangles)
        : read_(read), triangles_(triangles) {}

    // Reorders `members` by class (classes by their first member) and gives classes[i], the class
    // of members[i] after that. One class: false, nothing changed.
    bool split(std::span<Index> members) {
        const std::size_t n = members.size();
        keys_.clear();
        for (const Index m : members)
            keys_.push_back(corner_key(read_, triangles_.corner(m >> 2, m & 3)));
        classes_.assign(n, 0);
        const Index count = n <= small_star ? search() : sort();
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
    Index search() {
        firsts_.clear();
        for (Index i = 0; i < keys_.size(); ++i) {
            Index c = 0;
            while (c < firsts_.size() && !(keys_[i] == keys_[firsts_[c]])) ++c;
            if (c == firsts_.size()) firsts_.push_back(i);
            classes_[i] = c;
        }
        return Index(firsts_.size());
    }
    Index sort() {
        const std::size_t n = keys_.size();
        order_.resize(n);
        for (Index i = 0; i < n; ++i) order_[i] = i;
        std::sort(order_.begin(), order_.end(), [&](Index a, Index b) {
            if (keys_[a] < keys_[b]) return true;
            if (keys_[b] < keys_[a]) return false;
            return a < b;
        });
        firsts_.resize(n);  // per corner: the first of its class
        for (std::size_t i = 0; i < n; ++i) {
            const bool same = i > 0 && keys_[order_[i]] == keys_[order_[i - 1]];
            firsts_[order_[i]] = same ? firsts_[order_[i - 1]] : order_[i];
        }
        Index count = 0;
        for (Index i = 0; i < n; ++i)
            classes_[i] = firsts_[i] == i ? count++ : classes_[firsts_[i]];
        return count;
    }

    const CornerReader& read_;
    const TangentTriangles& triangles_;
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

}  // namespace

TangentStars named_vertices(const TangentInput& in, const TangentTriangles& triangles,
                            std::span<const Index> lowest, int threads) {
    TangentStars stars;
    stars.positions = in.positions.size();
    if (triangles.implicit() && lowest.empty()) {
        stars.vertices = in.corner_vertices;
        return stars;
    }
    ScratchBuffer<Index> numbers;
    if (!lowest.empty()) numbers = numbers_of(lowest, stars.positions);
    stars.own_vertices = ScratchBuffer<Index>(3 * triangles.count);
    parallel_blocks(triangles.count, triangle_grain, threads,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = 3 * begin; i < 3 * end; ++i) {
                            const Index p = in.corner_vertices[triangles.corner(i)];
                            stars.own_vertices[i] = numbers.empty() ? p : numbers[p];
                        }
                    });
    stars.vertices = stars.own_vertices;
    return stars;
}

// A counting sort.
void list_members(const TangentInput& in, const TangentTriangles& triangles,
                  const MemberLists& lists, TangentStars& stars) {
    stars.offsets = ScratchBuffer<Index>(stars.positions + 2);
    stars.split = ScratchBuffer<std::uint8_t>(stars.positions);
    // Local pointers: writing bytes may change whatever is reached through others.
    const Index *const normals = in.normals.indices.data(), *const uvs = in.uv.indices.data();
    Index* const offsets = stars.offsets.data();
    ScratchBuffer<std::uint64_t> last_uses(stars.positions);  // the last corner's normal and UV
    std::uint64_t* const uses = last_uses.data();
    const auto use = [&](Index m) {
        const Index c = triangles.corner(m >> 2, m & 3);
        return std::uint64_t(normals[c]) << 32 | uvs[c];
    };
    // Counted two places further on, offsets are starts one place further on after the sums, and
    // ends after that.
    std::memset(offsets, 0, stars.offsets.size() * sizeof(Index));
    std::size_t count = 0;
    for (const auto& list : lists) {
        count += list.size();
        for (const Index m : list) {
            const Index v = stars.vertex(m);
            ++offsets[v + std::size_t(2)];
            uses[v] = use(m);
        }
    }
    for (std::size_t v = 0; v < stars.positions; ++v) offsets[v + 2] += offsets[v + 1];

    stars.members = ScratchBuffer<Index>(count);
    Index* const members = stars.members.data();
    std::uint8_t* const split = stars.split.data();
    std::memset(split, 0, stars.positions);
    bool any = false;
    for (const auto& list : lists) {
        for (const Index m : list) {
            const Index v = stars.vertex(m);
            members[offsets[v + std::size_t(1)]++] = m;
            if (uses[v] != use(m)) {
                split[v] = 1;
                any = true;
            }
        }
    }
    stars.any_split = any;
}

void split_stars(const CornerReader& read, const TangentTriangles& triangles, const Terms& terms,
                 int threads, TangentStars& stars) {
    if (terms.counts.nan) {
        std::memset(stars.split.data(), 1, stars.positions);
        stars.any_split = true;
    }
    if (!stars.any_split) return;

    if (stars.own_vertices.empty()) {
        stars.own_vertices = ScratchBuffer<Index>(3 * triangles.count);
        parallel_blocks(stars.vertices.size(), triangle_grain, threads,
                        [&](std::size_t begin, std::size_t end) {
                            std::copy(stars.vertices.begin() + std::ptrdiff_t(begin),
                                      stars.vertices.begin() + std::ptrdiff_t(end),
                                      stars.own_vertices.data() + begin);
                        });
        stars.vertices = stars.own_vertices;
    }
    parallel_blocks(stars.positions, position_grain, threads,
                    [&](std::size_t begin, std::size_t end) {
                        Splitter splitter(read, triangles);
                        for (std::size_t v = begin; v < end; ++v) {
                            if (!stars.split[v]) continue;
                            const Index first = stars.offsets[v];
                            const std::span<Index> members(stars.members.data() + first,
                                                           stars.offsets[v + 1] - first);
                            if (members.empty() || !splitter.split(members)) {
                                stars.split[v] = 0;
                                continue;
                            }
                            Index name = Index(v);
                            for (std::size_t i = 0; i < members.size(); ++i) {
                                if (i > 0 && splitter.classes()[i] != splitter.classes()[i - 1])
                                    name = Index(stars.positions + first + i);
                                const Index m = members[i];
                                stars.own_vertices[3 * std::size_t(m >> 2) + (m & 3)] = name;
                            }
                        }
                    });
}

}  // namespace prep::detail
