#include "tangents/degenerate.h"

#include <algorithm>

#include "tangents/key.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// The corners of degenerate triangles by value, to be met by the first good corner equal to them.
class Wanted {
  public:
    explicit Wanted(std::size_t corners) : table_(std::bit_ceil(2 * corners + 1), no_index) {
        entries_.reserve(corners);
    }
    Index add(const CornerKey& key) {
        if (!key.number) return no_index;
        Index& entry = table_[slot(key)];
        if (entry == no_index) {
            entry = Index(entries_.size());
            entries_.push_back({key, no_index});
        }
        return entry;
    }
    void offer(const CornerKey& key, Index corner) {
        if (!key.number) return;
        const Index entry = table_[slot(key)];
        if (entry != no_index && entries_[entry].good == no_index) entries_[entry].good = corner;
    }
    Index good(Index entry) const { return entry == no_index ? no_index : entries_[entry].good; }

  private:
    std::size_t slot(const CornerKey& key) const {
        const std::size_t mask = table_.size() - 1;
        std::size_t at = std::size_t(hash_of(key)) & mask;
        while (table_[at] != no_index && !(entries_[table_[at]].key == key)) at = (at + 1) & mask;
        return at;
    }
    struct Entry {
        CornerKey key;
        Index good;
    };
    std::vector<Index> table_;
    std::vector<Entry> entries_;
};

}  // namespace

std::vector<Index> copy_to_degenerate(const CornerReader& read, const TangentTriangles& triangles,
                                      const Terms& terms, std::span<Index> indices) {
    if (terms.counts.degenerate == 0) return {};
    Wanted wanted(3 * std::size_t(terms.counts.degenerate));
    std::vector<Index> entries;  // three per degenerate triangle
    const auto takes_part = [&](std::size_t t) {
        return (terms.flags(t) & (degenerate_triangle | half_degenerate_quad)) ==
               degenerate_triangle;
    };
    for (std::size_t t = 0; t < triangles.count; ++t) {
        if (!takes_part(t)) continue;
        for (std::size_t k = 0; k < 3; ++k)
            entries.push_back(wanted.add(corner_key(read, triangles.corner(t, k))));
    }
    for (std::size_t t = 0; t < triangles.count; ++t) {
        if (terms.flags(t) & degenerate_triangle) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index corner = triangles.corner(t, k);
            wanted.offer(corner_key(read, corner), corner);
        }
    }
    std::size_t next = 0;
    for (std::size_t t = 0; t < triangles.count; ++t) {
        if (!takes_part(t)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index good = wanted.good(entries[next++]);
            if (good != no_index) indices[triangles.corner(t, k)] = indices[good];
        }
    }

    std::vector<Index> by_position;
    for (std::size_t t = 0; t < triangles.count; ++t) {
        const std::uint32_t flags = terms.flags(t);
        if (!(flags & half_degenerate_quad) || (flags & degenerate_triangle)) continue;
        // The other half's corner that this one does not have is missing.
        const std::size_t other = (flags & quad_first) ? t + 1 : t - 1;
        const Index have[3] = {triangles.corner(t, 0), triangles.corner(t, 1),
                               triangles.corner(t, 2)};
        Index missing = no_index;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index c = triangles.corner(other, k);
            if (std::find(have, have + 3, c) == have + 3) missing = c;
        }
        for (const Index c : have) {
            if (read.position(c) != read.position(missing)) continue;
            indices[missing] = indices[c];
            by_position.push_back(missing);
            break;
        }
    }
    return by_position;
}

}  // namespace prep::detail
