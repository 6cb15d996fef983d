#include "tangents/neighbours.h"

#include <algorithm>
#include <cassert>

namespace prep::detail {
namespace {

using Index = std::uint32_t;
// Up to this many triangles at a vertex neighbours are searched one by one, above it by sorting.
constexpr std::size_t small_star = 24;
// A table may have this many entries to a member.
constexpr std::size_t most_table_entries = 4;

}  // namespace

const EdgeOverrides::Entry* EdgeOverrides::find(Index half_edge) const {
    const auto at =
        std::lower_bound(entries.begin(), entries.end(), half_edge,
                         [](const Entry& e, Index wanted) { return e.half_edge < wanted; });
    return at != entries.end() && at->half_edge == half_edge ? &*at : nullptr;
}

void EdgeOverrides::name_vertices(const TangentStars& stars) {
    vertices.clear();
    for (const Entry& entry : entries) {
        vertices.push_back(stars.vertex(entry.half_edge));
        vertices.push_back(stars.vertex(next_corner(entry.half_edge)));
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
}

void Neighbours::find(const TangentStars& stars, std::span<const Index> star,
                      const EdgeOverrides& overrides) {
    const std::size_t n = star.size();
    leaving_.assign(n, no_index);
    entering_.assign(n, no_index);
    next_.resize(n);
    previous_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const Index triangle = star[i] >> 2, k = star[i] & 3;
        const Index* const names = stars.names_of(triangle);
        next_[i] = names[k == 2 ? 0 : k + 1];
        previous_[i] = names[k == 0 ? 2 : k - 1];
    }
    if (n <= small_star)
        search();
    else if (!look_up())
        sort();
    if (overrides.touch(stars, star)) apply(star, overrides);
}

void Neighbours::link(std::size_t leaves, std::size_t enters) {
    leaving_[leaves] = Index(enters);
    entering_[enters] = Index(leaves);
}

void Neighbours::search() {
    const std::size_t n = next_.size();
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            if (previous_[j] == next_[i] && entering_[j] == no_index) {
                link(i, j);
                break;
            }
        }
    }
}

// With a table of the vertices that edges enter from, where their numbers are close enough: per
// vertex its members, lower ones first.
bool Neighbours::look_up() {
    const std::size_t n = next_.size();
    const auto [low, high] = std::minmax_element(previous_.begin(), previous_.end());
    const Index least = *low;
    const std::size_t range = std::size_t(*high) - least + 1;
    if (range > most_table_entries * n) return false;
    firsts_.assign(range, no_index);
    followers_.resize(n);
    for (std::size_t j = n; j-- > 0;) {
        Index& first = firsts_[previous_[j] - least];
        followers_[j] = first;
        first = Index(j);
    }
    for (std::size_t i = 0; i < n; ++i) {
        if (next_[i] < least || next_[i] - least >= range) continue;
        Index& first = firsts_[next_[i] - least];
        if (first == no_index) continue;
        link(i, first);
        first = followers_[first];
    }
    return true;
}

void Neighbours::order_by(const std::vector<Index>& keys, std::vector<std::uint64_t>& order) {
    const std::size_t n = keys.size();
    order.resize(n);
    for (std::size_t i = 0; i < n; ++i) order[i] = std::uint64_t(keys[i]) << 32 | i;
    if (!std::is_sorted(order.begin(), order.end())) std::sort(order.begin(), order.end());
}

void Neighbours::sort() {
    const std::size_t n = next_.size();
    order_by(next_, by_next_);
    order_by(previous_, by_previous_);
    for (std::size_t i = 0, j = 0; i < n && j < n;) {
        const Index a = Index(by_next_[i] >> 32), b = Index(by_previous_[j] >> 32);
        if (a < b) {
            ++i;
        } else if (b < a) {
            ++j;
        } else {
            link(Index(by_next_[i++]), Index(by_previous_[j++]));
        }
    }
}

void Neighbours::apply(std::span<const Index> star, const EdgeOverrides& overrides) {
    // A mate's ends are this edge's, so it is one of the star.
    const auto place = [&](Index member) {
        const auto at = std::lower_bound(star.begin(), star.end(), member);
        assert(at != star.end() && *at == member);
        return Index(at - star.begin());
    };
    for (std::size_t i = 0; i < star.size(); ++i) {
        if (const auto* e = overrides.find(star[i]))
            leaving_[i] = e->mate == no_index ? no_index : place(next_corner(e->mate));
        if (const auto* e = overrides.find(previous_corner(star[i])))
            entering_[i] = e->mate == no_index ? no_index : place(e->mate);
    }
}

}  // namespace prep::detail
