#include <bit>
#include <cassert>

#include "tangents/one_rings.h"

namespace prep::detail {

using Index = std::uint32_t;

const EdgeOverrides::Entry* EdgeOverrides::find(Index half_edge) const {
    const auto at =
        std::lower_bound(entries.begin(), entries.end(), half_edge,
                         [](const Entry& e, Index wanted) { return e.half_edge < wanted; });
    return at != entries.end() && at->half_edge == half_edge ? &*at : nullptr;
}

void EdgeOverrides::name_vertices(const OneRings& rings) {
    vertices.clear();
    for (const Entry& entry : entries) {
        vertices.push_back(rings.vertex(entry.half_edge));
        vertices.push_back(rings.vertex(next_corner(entry.half_edge)));
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
}

void EdgePairs::find(const OneRings& rings, std::span<const Index> ring,
                     const EdgeOverrides& overrides) {
    const std::size_t n = ring.size();
    leaving_.assign(n, no_index);
    entering_.assign(n, no_index);
    next_.resize(n);
    previous_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const Index triangle = ring[i] >> 2, k = ring[i] & 3;
        const Index* const names = rings.names_of(triangle);
        next_[i] = names[k == 2 ? 0 : k + 1];
        previous_[i] = names[k == 0 ? 2 : k - 1];
    }
    // A table of the vertices that edges enter from: per vertex its members, lower ones first, and
    // the lowest that no edge has met.
    const int bits = int(std::bit_width(2 * n - 1));
    const std::size_t mask = (std::size_t(1) << bits) - 1;
    heads_.assign(mask + 1, no_index);
    followers_.resize(n);
    cursors_.resize(n);
    const auto head_of = [&](Index vertex) -> Index& {
        // Knuth's multiplicative hash.
        std::size_t slot = (vertex * 0x9e3779b1u) >> (32 - bits);
        while (heads_[slot] != no_index && previous_[heads_[slot]] != vertex)
            slot = (slot + 1) & mask;
        return heads_[slot];
    };
    for (Index j = Index(n); j-- > 0;) {
        Index& head = head_of(previous_[j]);
        followers_[j] = head;
        cursors_[j] = head = j;
    }
    for (Index i = 0; i < n; ++i) {
        const Index head = head_of(next_[i]);
        if (head == no_index || cursors_[head] == no_index) continue;
        const Index j = cursors_[head];
        cursors_[head] = followers_[j];
        leaving_[i] = j;
        entering_[j] = i;
    }
    if (overrides.touch(rings, ring)) apply(ring, overrides);
}

void EdgePairs::apply(std::span<const Index> ring, const EdgeOverrides& overrides) {
    // A mate's ends are this edge's, so it is one of the ring.
    const auto place = [&](Index member) {
        const auto at = std::lower_bound(ring.begin(), ring.end(), member);
        assert(at != ring.end() && *at == member);
        return Index(at - ring.begin());
    };
    for (std::size_t i = 0; i < ring.size(); ++i) {
        if (const auto* e = overrides.find(ring[i]))
            leaving_[i] = e->mate == no_index ? no_index : place(next_corner(e->mate));
        if (const auto* e = overrides.find(previous_corner(ring[i])))
            entering_[i] = e->mate == no_index ? no_index : place(e->mate);
    }
}

}  // namespace prep::detail
