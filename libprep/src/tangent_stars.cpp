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

// What is known of a position while its corners are counted.
struct Use {
    Index count = 0, normal = 0, uv = 0;
};

}  // namespace

TangentStars tangent_stars(const CornerReader& read, const TangentTriangles& triangles,
                           const Terms& terms, std::span<const Index> lowest, int threads) {
    const TangentInput& in = read.in;
    TangentStars stars;
    stars.positions = in.positions.size();
    stars.offsets = ScratchBuffer<Index>(stars.positions + 1);
    stars.split = ScratchBuffer<std::uint8_t>(stars.positions);
    // Room for reading whole vectors.
    stars.members = ScratchBuffer<Index>(3 * (triangles.count - terms.counts.degenerate) + 16);
    const bool all_good = terms.counts.degenerate == 0;

    if (triangles.implicit() && lowest.empty()) {
        stars.vertices = in.corner_vertices;
    } else {
        stars.own_vertices = ScratchBuffer<Index>(3 * triangles.count);
        parallel_blocks(triangles.count, triangle_grain, threads,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t t = begin; t < end; ++t) {
                                for (std::size_t k = 0; k < 3; ++k) {
                                    const Index p = in.corner_vertices[triangles.corner(t, k)];
                                    stars.own_vertices[3 * t + k] = lowest.empty() ? p : lowest[p];
                                }
                            }
                        });
        stars.vertices = stars.own_vertices;
    }

    ScratchBuffer<Use> uses(stars.positions);
    std::memset(static_cast<void*>(uses.data()), 0, stars.positions * sizeof(Use));
    std::memset(stars.split.data(), terms.counts.nan ? 1 : 0, stars.positions);
    bool any_split = terms.counts.nan;
    for (std::size_t t = 0; t < triangles.count; ++t) {
        if (!all_good && (terms.flags(t) & degenerate_triangle)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index corner = triangles.corner(t, k);
            const Index normal = in.normals.indices[corner], uv = in.uv.indices[corner];
            const Index position = stars.vertices[3 * t + k];
            Use& use = uses[position];
            if (use.count++ == 0) {
                use.normal = normal;
                use.uv = uv;
            } else if (use.normal != normal || use.uv != uv) {
                stars.split[position] = 1;
                any_split = true;
            }
        }
    }
    Index total = 0;
    for (std::size_t v = 0; v < stars.positions; ++v) {
        stars.offsets[v] = total;
        total += uses[v].count;
        uses[v].count = stars.offsets[v];
    }
    stars.offsets[stars.positions] = total;
    for (std::size_t t = 0; t < triangles.count; ++t) {
        if (!all_good && (terms.flags(t) & degenerate_triangle)) continue;
        for (Index k = 0; k < 3; ++k)
            stars.members[uses[stars.vertices[3 * t + k]].count++] = Index(4 * t + k);
    }
    if (!any_split) return stars;

    if (stars.own_vertices.empty()) {
        stars.own_vertices = ScratchBuffer<Index>(3 * triangles.count);
        std::copy(stars.vertices.begin(), stars.vertices.end(), stars.own_vertices.data());
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
    return stars;
}

}  // namespace prep::detail
