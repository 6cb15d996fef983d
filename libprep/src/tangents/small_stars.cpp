#include "tangents/small_stars.h"

#include <bit>

#include "tangents/math.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

struct Members {
    std::array<Index, most_small> next, previous;  // vertices
    std::array<const CornerTerm*, most_small> terms;
};

// Per member its neighbours. Over one edge the n-th triangle that leaves the vertex meets the n-th
// that enters it.
void find_neighbours(const Members& members, std::size_t n, std::uint32_t* neighbours) {
    std::uint32_t entered = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Index wanted = members.next[i];
        std::size_t found = n;
        for (std::size_t j = n; j-- > 0;) found = members.previous[j] == wanted ? j : found;
        // Met already: the next one.
        while (found < n && (members.previous[found] != wanted || (entered >> found & 1))) ++found;
        if (found == n) continue;
        entered |= 1u << found;
        neighbours[i] |= 1u << found;
        neighbours[found] |= 1u << i;
    }
}

}  // namespace

bool find_small_groups(const TangentStars& stars, const Terms& terms, std::span<const Index> star,
                       SmallGroups& result) {
    const std::size_t n = star.size();
    Members members;
    std::uint32_t preserving = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t triangle = star[i] >> 2, k = star[i] & 3, place = terms.place(triangle);
        const Index* const names = stars.names_at(triangle, place);
        members.next[i] = names[k == 2 ? 0 : k + 1];
        members.previous[i] = names[k == 0 ? 2 : k - 1];
        members.terms[i] = terms.planes[k].data() + place;
        preserving |= std::uint32_t((members.terms[i]->code & orientation_preserving) != 0) << i;
    }
    std::uint32_t neighbours[most_small] = {};
    if (n > 1) find_neighbours(members, n, neighbours);

    result.count = 0;
    const std::uint32_t all = (1u << n) - 1;
    for (std::uint32_t rest = all; rest != 0;) {
        const int first = std::countr_zero(rest);
        const bool preserves = (preserving >> first & 1) != 0;
        const std::uint32_t same = preserves ? preserving : ~preserving;
        std::uint32_t group = 1u << first;
        for (std::uint32_t ahead = group; ahead != 0;) {
            const std::uint32_t found = neighbours[std::countr_zero(ahead)] & same & ~group;
            ahead &= ahead - 1;
            group |= found;
            ahead |= found;
        }
        glm::vec3 sum(0.0f);
        std::uint32_t code = ~0u;
        for (std::uint32_t left = group; left != 0; left &= left - 1) {
            const CornerTerm& term = *members.terms[std::size_t(std::countr_zero(left))];
            sum += glm::vec3(term.x, term.y, term.z);
            code &= term.code;
        }
        const bool single = (group & (group - 1)) == 0;
        if (!single && !((code & s_directions) && (code & t_directions))) return false;
        result.groups[result.count++] = {group, preserves, mikk::normalized_or_zero(sum)};
        rest &= ~group;
    }
    return true;
}

}  // namespace prep::detail
